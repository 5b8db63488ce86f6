//! Experiments whose base moves and carries reflectors are screened as well.

use crate::common::prelude::*;
use crate::common::readings::{base_reflectors, pose, states};
use stiffarm::measure::screening::{Cause, Screening};

/// Six random postures on a base that gives way under the load, and that sways
/// by 0.3 mm somewhere else from state to state: as much as the light load moves
/// the tool.
fn table(cell: &Cell, seed: u64) -> ReadingTable {
    let q = random_group(cell, StartKind::Uniform, 6, seed, 0).unwrap();
    let mut dice = Dice::new(seed);
    let turn: Vector3<f64> = dice.direction() * dice.between(0.0, 3.0);
    let at = dice.vector(4.0);
    let done = Experiment {
        base_from_tracker: pose(at.x, at.y, at.z, turn.into()),
        states: states(&[("unloaded", 0.0, 1), ("light", 0.1, 1), ("full", 1.0, 1)]),
        force: ForceRecord::Force,
        base_reflectors: base_reflectors(),
        base_compliance: Some(BaseCompliance { tilt: 2e-8, shift: 3e-8 }),
        tracker_noise: TrackerNoise::Isotropic,
        ..Experiment::default()
    };
    let truth = cell.require_prior().unwrap();
    let postures = numbered(q);
    let mut table = experiment(cell, &postures, truth, &done, seed, 0).unwrap();
    for posture in &mut table.postures {
        for state in &mut posture.states[1..] {
            let sway = dice.direction() * 3e-4;
            for reading in &mut state.readings {
                reading.position += sway;
            }
        }
    }
    table
}

fn postures_named(screening: &Screening, cause: Cause) -> Vec<Vec<String>> {
    let all = screening.suspicions.iter().filter(|s| s.cause == cause);
    all.map(|s| s.postures.clone()).collect()
}

#[test]
fn a_moving_base_is_no_exchange_of_loaded_and_unloaded_rows() {
    let cell = builtin::cell("comau").unwrap();
    let mut largest: Vec<f64> = Vec::new();
    for seed in 0..40 {
        let table = table(&cell, seed);
        let screening = screen(&cell, &table, None).unwrap();
        let findings = &screening.findings;
        assert!(findings.is_empty(), "seed {seed}: {findings:?}");
        let reduced = reduce(&cell, &table, &ReduceOptions::default()).unwrap();
        let motions = reduced.base_motion.iter();
        largest.push(motions.map(|m| m.largest_correction_m).fold(0.0, f64::max));
    }
    largest.sort_by(f64::total_cmp);
    let largest = largest[20];
    assert!(largest > 1.5e-4, "the base moves by 0.3 mm: {largest}");
}

#[test]
fn rows_that_are_exchanged_are_named_on_a_moving_base_too() {
    let cell = builtin::cell("comau").unwrap();
    for seed in 0..10 {
        let mut table = table(&cell, seed);
        let states = &mut table.postures[3].states;
        let first = states[0].readings.clone();
        states[0].readings = std::mem::replace(&mut states[2].readings, first);
        let screening = screen(&cell, &table, None).unwrap();
        assert_eq!(
            postures_named(&screening, Cause::ExchangedStates),
            [["4"]],
            "seed {seed}: {:?}",
            screening.findings
        );
    }
}
