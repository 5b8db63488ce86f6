//! Readings that were rounded before they came here are told, and the step is part of their noise.

use super::*;
use stiffarm::findings::{Severity, codes};
use stiffarm::{Measured, prepare, simulated_readings};
use stiffarm_files::builtin;

/// What is made of the readings of a built-in experiment, rounded to `step` \[m\].
fn rounded(step: Option<f64>) -> stiffarm::Result<(Cell, Measured)> {
    let cell = builtin::cell("comau")?;
    let postures = builtin::postures("comau-group1", &cell.setup.robot)?;
    let mut table = simulated_readings(&cell, &postures, 1)?;
    let states = table.postures.iter_mut().flat_map(|posture| &mut posture.states);
    for reading in states.flat_map(|state| &mut state.readings) {
        let round = |value: f64| step.map_or(value, |step| (value / step).round() * step);
        reading.position = reading.position.map(round);
    }
    let measured = prepare(&cell, table, &Default::default())?;
    Ok((cell, measured))
}

#[test]
fn a_step_of_the_readings_is_said_and_is_part_of_their_noise() -> Check {
    let mut report = String::new();
    for (step, severity) in
        [(1e-3, Severity::Caution), (1e-4, Severity::Caution), (1e-5, Severity::Note), (25.4e-6, Severity::Caution)]
    {
        let (cell, measured) = rounded(Some(step))?;
        let said: Vec<_> = measured.findings().filter(|f| f.code == codes::READING_RESOLUTION).collect();
        assert_eq!(said.len(), 1, "{step}");
        assert_eq!(said[0].severity, severity, "{step}");
        report += &format!("{step}: {}\n", said[0].sentence);
        // Nothing else is told of it: no drift, no base that moves, no copied rows.
        let others: Vec<_> = measured.findings().filter(|f| f.code != codes::READING_RESOLUTION).collect();
        assert!(others.iter().all(|f| f.severity == Severity::Note), "{step}: {others:?}");
        let (with, stated) = (measured.noise(&cell), cell.noise);
        let added = with.reading_variance - stated.reading_variance;
        assert!((added - step * step / 12.0).abs() < 1e-9 * added, "{step}");
    }
    insta::assert_snapshot!(report, @"
    0.001: All 300 readings are multiples of 1 mm: they were rounded before they came here. That is a noise of 0.289 mm in each coordinate (step/√12) beside 9.6 µm of the tracker, with which it is counted. Export the readings with all their digits.
    0.0001: All 300 readings are multiples of 0.1 mm: they were rounded before they came here. That is a noise of 0.029 mm in each coordinate (step/√12) beside 9.6 µm of the tracker, with which it is counted. Export the readings with all their digits.
    0.00001: All 300 readings are multiples of 0.01 mm: they were rounded before they came here. That is a noise of 2.9 µm in each coordinate (step/√12) beside 9.6 µm of the tracker, with which it is counted.
    0.0000254: All 300 readings are multiples of 0.001 in: they were rounded before they came here. That is a noise of 7.3 µm in each coordinate (step/√12) beside 9.6 µm of the tracker, with which it is counted. Export the readings with all their digits.
    ");
    let (cell, measured) = rounded(None)?;
    assert!(measured.findings().all(|finding| finding.code != codes::READING_RESOLUTION));
    assert_eq!(measured.noise(&cell).reading_variance, cell.noise.reading_variance);
    Ok(())
}
