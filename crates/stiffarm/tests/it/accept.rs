//! A constraint of the caller's own holds for every posture of a plan as it is driven, and is named where it accepts
//! none.

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
    let free = planned(None).unwrap();
    (free.postures, free.result.selection.value)
});

/// The wrist turned away from the cabinet: what limits of a cell cannot say.
fn away(q: &[f64]) -> bool {
    (q[3] + q[5]).sin() > 0.25
}

#[test]
fn every_posture_of_a_plan_is_accepted_as_it_is_driven() {
    let accepted = planned(Some(Accept::new(away))).unwrap();
    assert_eq!(accepted.postures.len(), 6);
    assert!(accepted.postures.iter().all(|p| away(&p.q)));
    // The free plan is not: the constraint costs something here.
    let (free, best) = &*FREE;
    assert!(!free.iter().all(|p| away(&p.q)));
    let value = accepted.result.selection.value;
    assert!(value > *best && value < 3.0 * best, "{value} {best}");
}

#[test]
fn the_same_seed_gives_the_same_accepted_plan() {
    let postures = || planned(Some(Accept::new(away))).unwrap().postures;
    assert_eq!(postures(), postures());
}

#[test]
fn a_constraint_that_accepts_everything_changes_nothing_but_the_turns() {
    let all = planned(Some(Accept::new(|_| true)));
    let (value, best) = (all.unwrap().result.selection.value, FREE.1);
    // Angles that are rounded elsewhere change it in the fifth digit.
    assert!((value / best - 1.0).abs() < 1e-3, "{value} {best}");
}

#[test]
fn a_constraint_that_accepts_nothing_is_named() {
    let error = planned(Some(Accept::new(|_| false)));
    let error = error.map(|plan| plan.postures).unwrap_err();
    assert_eq!(error.code(), Code::InvalidValue);
    assert_eq!(error.place().key.as_deref(), Some("accept"));
    insta::assert_snapshot!(error, @"accept: None of 53977 random postures inside bounds and limits is accepted by your own constraint.");
}
