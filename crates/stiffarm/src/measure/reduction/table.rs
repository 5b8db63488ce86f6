//! What a table of readings must fulfil before anything is computed from it.

use crate::error::{Code, Error, Result};
use crate::model::cell::Cell;
use crate::model::measurement::{PostureReadings, Reading, ReadingTable, ReadingTarget, StateReadings};
use crate::model::observation::check_angles;
use nalgebra::{Isometry3, Vector3};
use std::collections::BTreeSet;

/// Checks names, indices and numbers.
///
/// # Errors
/// An empty table, a posture or state twice, a point the tool does not have, a
/// wrong number of angles, or a number that is not finite.
pub(super) fn check(cell: &Cell, table: &ReadingTable, stated_transform: Option<&Isometry3<f64>>) -> Result<()> {
    if table.postures.iter().all(|p| p.states.iter().all(|s| s.readings.is_empty())) {
        return Err(Error::new(Code::TooFewData, "There are no readings."));
    }
    let finite = |v: &Vector3<f64>| v.iter().all(|x| x.is_finite());
    if let Some(pose) = stated_transform
        && !(finite(&pose.translation.vector) && pose.rotation.coords.iter().all(|x| x.is_finite()))
    {
        return Err(Error::new(Code::NotFinite, "The transform from tracker to base has a number that is not finite."));
    }
    let mut names = BTreeSet::new();
    for posture in &table.postures {
        if !names.insert(posture.posture.name.as_str()) {
            let message = format!("Posture {} appears twice.", posture.posture.name);
            return Err(Error::new(Code::Duplicate, message));
        }
        check_angles(&cell.setup.robot, &posture.posture.q)?;
        let mut states = BTreeSet::new();
        for state in &posture.states {
            if !states.insert(state.state.as_str()) {
                let message = format!("Posture {} has the state {} twice.", posture.posture.name, state.state);
                return Err(Error::new(Code::Duplicate, message));
            }
            check_state(cell, posture, state)?;
        }
    }
    Ok(())
}

fn check_state(cell: &Cell, posture: &PostureReadings, state: &StateReadings) -> Result<()> {
    let finite = |v: &Vector3<f64>| v.iter().all(|x| x.is_finite());
    if let Some(q) = &state.angles {
        check_angles(&cell.setup.robot, q)?;
    }
    let wrench = state.wrench.is_none_or(|w| finite(&w.force) && finite(&w.moment));
    if !(wrench && state.load.is_none_or(f64::is_finite)) {
        let message = format!("The force of {} is not a finite number.", place(posture, state));
        return Err(at_line(Error::new(Code::NotFinite, message), state.readings.first()));
    }
    for reading in &state.readings {
        if !reading.numbers().all(f64::is_finite) {
            let message = format!("A reading of {} is not a finite number.", place(posture, state));
            return Err(at_line(Error::new(Code::NotFinite, message), Some(reading)));
        }
        if matches!(reading.target, ReadingTarget::Point(index) if index >= cell.setup.tool.point_count()) {
            let message = "A reading names a point the tool does not have.";
            return Err(at_line(Error::new(Code::UnknownName, message), Some(reading)));
        }
    }
    Ok(())
}

fn place(posture: &PostureReadings, state: &StateReadings) -> String {
    format!("posture {}, state {},", posture.posture.name, state.state)
}

fn at_line(error: Error, reading: Option<&Reading>) -> Error {
    match reading.map(|r| r.line) {
        Some(line) if line > 0 => error.line(line, None),
        _ => error,
    }
}
