//! A constraint of the caller's own on the postures of a plan.

use crate::common::prelude::*;
use std::sync::LazyLock;
use stiffarm::ask::select::{Plan, Planned, SelectInputs, SelectOptions, plan};
use stiffarm::plan::select::Accept;

/// A plan under this constraint, or none.
fn planned(accept: Option<Accept>) -> stiffarm::Result<Planned<Plan>> {
    let cell = builtin::cell("comau").unwrap();
    let options = with(|o: &mut SelectOptions| {
        (o.index, o.rounds) = (Some(Index::ExpectedError), Some(2));
        o.no_certificate = true;
    });
    let inputs = with(|i: &mut SelectInputs| i.accept = accept);
    plan(&cell, &inputs, &options, &mut |_| {}, Control::default())
}

/// The postures and the value of the plan without a constraint.
static FREE: LazyLock<(Vec<Posture>, f64)> = LazyLock::new(|| {
    let found = planned(None).unwrap();
    (found.postures, found.result.selection.value)
});

/// The wrist turned away from the cabinet: what limits of a cell cannot say.
fn away(q: &[f64]) -> bool {
    (q[3] + q[5]).sin() > 0.25
}

#[test]
fn every_posture_of_a_plan_is_accepted_as_it_is_driven() {
    let found = planned(Some(Accept::new(away))).unwrap();
    assert_eq!(found.postures.len(), 6);
    assert!(found.postures.iter().all(|p| away(&p.q)));
    // The free plan is not: the constraint costs something here.
    let (free, best) = &*FREE;
    assert!(!free.iter().all(|p| away(&p.q)));
    let own = found.result.selection.value;
    assert!(own > *best && own < 3.0 * best, "{own} {best}");
}

#[test]
fn the_same_seed_gives_the_same_accepted_plan() {
    let found = || planned(Some(Accept::new(away))).unwrap().postures;
    assert_eq!(found(), found());
}

#[test]
fn a_constraint_that_accepts_everything_changes_nothing_but_the_turns() {
    let all = planned(Some(Accept::new(|_| true)));
    let (own, best) = (all.unwrap().result.selection.value, FREE.1);
    // Angles that are rounded elsewhere change it in the fifth digit.
    assert!((own / best - 1.0).abs() < 1e-3, "{own} {best}");
}

#[test]
fn a_constraint_that_accepts_nothing_is_named() {
    let error = planned(Some(Accept::new(|_| false)));
    let error = error.map(|found| found.postures).unwrap_err();
    assert_eq!(error.code(), Code::InvalidValue);
    assert_eq!(error.place().key.as_deref(), Some("accept"));
    assert!(error.message().contains("None of"), "{error}");
}
