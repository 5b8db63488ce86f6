//! A constraint of the caller's own on the postures of a plan.

use crate::common::prelude::*;
use std::sync::LazyLock;
use stiffarm::plan::planned::{PlanRequest, plan};
use stiffarm::plan::select::Accept;

fn request(accept: Accept) -> PlanRequest {
    with(|o: &mut PlanRequest| {
        o.index = Index::ExpectedError;
        o.rounds = Some(2);
        o.certificate = false;
        o.accept = Some(accept);
    })
}

/// The postures and the value of the plan without a constraint.
static FREE: LazyLock<(Vec<Posture>, f64)> = LazyLock::new(|| {
    let cell = builtin::cell("comau").unwrap();
    let free = changed(request(Accept::new(away)), |request| request.accept = None);
    let found = plan(&cell, &free, &mut |_| {}, Control::default()).unwrap();
    (found.postures, found.result.selection.value)
});

/// The wrist turned away from the cabinet: what limits of a cell cannot say.
fn away(q: &[f64]) -> bool {
    (q[3] + q[5]).sin() > 0.25
}

#[test]
fn every_posture_of_a_plan_is_accepted_as_it_is_driven() {
    let cell = stiffarm_files::builtin::cell("comau").unwrap();
    let found = plan(
        &cell,
        &request(Accept::new(away)),
        &mut |_| {},
        Control::default(),
    )
    .unwrap();
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
    let cell = stiffarm_files::builtin::cell("comau").unwrap();
    let found = || {
        let request = request(Accept::new(away));
        let found = plan(&cell, &request, &mut |_| {}, Control::default());
        found.unwrap().postures
    };
    assert_eq!(found(), found());
}

#[test]
fn a_constraint_that_accepts_everything_changes_nothing_but_the_turns() {
    let cell = stiffarm_files::builtin::cell("comau").unwrap();
    let all = plan(
        &cell,
        &request(Accept::new(|_| true)),
        &mut |_| {},
        Control::default(),
    );
    let (own, best) = (all.unwrap().result.selection.value, FREE.1);
    // Angles that are rounded elsewhere change it in the fifth digit.
    assert!((own / best - 1.0).abs() < 1e-3, "{own} {best}");
}

#[test]
fn a_constraint_that_accepts_nothing_is_named() {
    let cell = stiffarm_files::builtin::cell("comau").unwrap();
    let error = plan(
        &cell,
        &request(Accept::new(|_| false)),
        &mut |_| {},
        Control::default(),
    );
    let error = error.map(|found| found.postures).unwrap_err();
    assert_eq!(error.code(), Code::InvalidValue);
    assert_eq!(error.place().key.as_deref(), Some("accept"));
    assert!(error.message().contains("None of"), "{error}");
}
