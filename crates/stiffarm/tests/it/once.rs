//! A whole identification computes nothing twice.

use crate::common::prelude::*;
use std::collections::BTreeSet;
use stiffarm::estimate::identify::{bootstrap, profile};

fn measured(cell: &Cell) -> Measured {
    let postures = numbered(group1());
    let truth = cell.require_prior().unwrap().to_vec();
    let done = Experiment::as_measured(cell);
    let table = experiment(cell, &postures, &truth, &done, 3, 0).unwrap();
    prepare(cell, table, &ReduceOptions::default()).unwrap()
}

/// Everything that `identify` prints.
fn whole(fit: &Fit) {
    fit.identification().unwrap();
    profile(fit).unwrap();
    systematic_errors(fit).unwrap();
    diagnose(fit).unwrap();
    bootstrap(fit, 200, 1, 0.95).unwrap();
    let search = rounds(1);
    next_posture(fit, &search, Control::default()).unwrap();
    let count = fit.measured().postures.len() / 3;
    cross_validate(fit, count, None).unwrap();
    fit.leave_one_out().unwrap();
}

#[test]
fn one_assembly_and_one_fit_per_options_and_data() {
    let cell = default_cell();
    let clean = measured(&cell);
    let mut odd = clean.clone();
    // One displacement that the search for outliers sets aside.
    odd.postures[4].displacements[1].value.x += 1e-3;
    for (measured, estimator) in [
        (&clean, Estimator::TwoVariance),
        (&clean, Estimator::Weighted),
        (&clean, Estimator::Huber),
        (&odd, Estimator::TwoVariance),
        (&odd, Estimator::Ordinary),
    ] {
        let options = by(estimator);
        let fit = Fit::new(&cell, measured, &options).unwrap();
        whole(&fit);
        let journal = fit.journal();
        let different: BTreeSet<&String> = journal.iter().collect();
        assert_eq!(different.len(), journal.len(), "{estimator:?}: {journal:#?}");
        let count = |what: &str| journal.iter().filter(|e| e.starts_with(what)).count();
        assert_eq!((count("terms"), count("system")), (1, 1), "{journal:#?}");
        // The model as it is, and each extra term beside it.
        assert!(count("fit") > 7 && count("6 folds") > 7, "{journal:#?}");
    }
}

#[test]
fn other_options_use_the_same_terms() {
    let cell = default_cell();
    let measured = measured(&cell);
    let two = Fit::new(&cell, &measured, &IdentifyOptions::default()).unwrap();
    for estimator in Estimator::ALL {
        let options = by(estimator);
        let again = two.with(&options).unwrap();
        let alone = identify(&cell, &measured, &options).unwrap();
        assert_eq!(*again.identification().unwrap(), alone, "{estimator:?}");
    }
    let journal = two.journal();
    let count = |what: &str| journal.iter().filter(|e| e.starts_with(what)).count();
    assert_eq!((count("terms"), count("system"), count("fit")), (1, 1, 6));
}

#[test]
fn the_count_of_readings_travels_with_the_measurements() {
    // The cell counts one reading per displacement; raw readings are two.
    let cell = default_cell();
    assert_eq!(cell.noise.readings_per_displacement, 1);
    let measured = measured(&cell);
    assert_eq!(measured.readings_per_displacement, Some(2));
    let known_noise = with(|o: &mut IdentifyOptions| {
        o.estimator = Estimator::Weighted;
        o.noise = NoiseSource::Known;
    });
    let identification = identify(&cell, &measured, &known_noise).unwrap();
    let mut two = cell.clone();
    two.noise.readings_per_displacement = 2;
    let by_cell = identify(&two, &measured.postures, &known_noise).unwrap();
    assert_eq!(identification, by_cell);
    assert_eq!(identification.expected_std_m, two.noise.displacement_std());
    let repeats = changed(known_noise, |o| o.noise = NoiseSource::Repeats);
    let fit = Fit::new(&cell, &measured, &repeats).unwrap();
    // Folds see the repeats too.
    cross_validate(&fit, 6, None).unwrap();
}
