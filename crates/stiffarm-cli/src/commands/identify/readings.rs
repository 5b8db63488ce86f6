//! From a table of raw readings to displacements, with all that was noticed.

use crate::numbers::{mm, significant};
use crate::table::{red, yellow};
use schemars::JsonSchema;
use serde::Serialize;
use stiffarm::estimate::identify::ReadingScatter;
use stiffarm::files::table::Measurements;
use stiffarm::findings::{Finding, Severity};
use stiffarm::measure::reduction::{ReduceOptions, Reduction, UnloadedRegistration, reduce};
use stiffarm::measure::screening::{Screening, screen};
use stiffarm::model::cell::Cell;
use stiffarm::model::measurement::MeasuredPosture;
use stiffarm::{Error, Result};

/// What became of raw readings on their way to displacements.
#[derive(Serialize, JsonSchema)]
pub struct Reduced {
    /// Registration, drift, motion of the base, repeats, wrenches.
    pub reduction: Reduction,
    /// What is suspicious about the readings themselves.
    pub sanity: Screening,
}

/// Displacements of a table, which is reduced first where it holds raw
/// readings. Differences of two readings count as such in the cell's noise then.
///
/// # Errors
/// As [`reduce`]; where the readings themselves explain the failure, that is said.
pub fn displacements(
    cell: &mut Cell,
    measurements: Measurements,
    options: &ReduceOptions,
) -> Result<(Vec<MeasuredPosture>, Option<Reduced>)> {
    let table = match measurements {
        Measurements::Displacements(measured) => return Ok((measured, None)),
        Measurements::Readings(table) => table,
    };
    let sanity = screen(cell, &table, options.base_from_tracker.as_ref())?;
    let mut reduction = reduce(cell, &table, options).map_err(|error| {
        let cause = sanity
            .findings
            .iter()
            .find(|f| f.severity == Severity::Serious);
        match cause {
            Some(cause) => Error::new(error.code(), cause.sentence.clone()).hint(error.message()),
            None => error,
        }
    })?;
    cell.noise.readings_per_displacement = 2;
    let measured = std::mem::take(&mut reduction.measured);
    Ok((measured, Some(Reduced { reduction, sanity })))
}

impl Reduced {
    /// Scatter of repeated readings.
    pub fn scatter(&self) -> Option<ReadingScatter> {
        let repeats = self.reduction.repeatability.as_ref()?;
        Some(ReadingScatter {
            reading_std_m: repeats.std_m,
            degrees_of_freedom: repeats.degrees_of_freedom,
        })
    }

    /// All findings, those about the readings themselves first.
    pub fn findings(&self) -> impl Iterator<Item = &Finding> {
        self.sanity.findings.iter().chain(&self.reduction.findings)
    }

    /// The most serious finding.
    pub fn worst(&self) -> Option<Severity> {
        self.findings().map(|f| f.severity).max()
    }

    /// What was done, and what was found.
    pub fn words(&self) -> String {
        let mut out = String::new();
        if let Some(registration) = &self.reduction.registration {
            out += &register(registration);
        }
        if let Some(repeats) = &self.reduction.repeatability {
            out += &format!(
                "Repeats: one reading scatters by {} mm per axis ({} degrees of freedom).\n",
                mm(repeats.std_m),
                repeats.degrees_of_freedom
            );
        }
        let largest = self
            .reduction
            .base_motion
            .iter()
            .map(|m| m.largest_correction_m)
            .fold(0.0, f64::max);
        if largest > 0.0 {
            out += &format!(
                "Base reflectors: their motion is subtracted, up to {} mm.\n",
                significant(largest * 1e3, 2)
            );
        }
        for finding in self.findings() {
            out += &marked(finding);
        }
        out
    }
}

/// The registration in a sentence.
fn register(registration: &UnloadedRegistration) -> String {
    let used = registration.postures.iter().filter(|p| p.used).count();
    let mut text = match registration.given {
        true => "Registration: as given; the unloaded points of ".to_string(),
        false => "Registration: from the unloaded points of ".to_string(),
    };
    text += &format!(
        "{used} of {} postures, {} mm RMS from the kinematic model",
        registration.postures.len(),
        mm(registration.rms_m)
    );
    if let Some(turn) = registration.turn_standard_error_rad {
        let largest = turn.into_iter().fold(0.0, f64::max);
        text += &format!("; turn known to {} mrad", significant(largest * 1e3, 2));
    }
    text + ".\n"
}

/// A finding as a line, with its weight.
pub fn marked(finding: &Finding) -> String {
    match finding.severity {
        Severity::Serious => format!("{}\n", red(&finding.sentence)),
        Severity::Caution => format!("{}: {}\n", yellow("caution"), finding.sentence),
        Severity::Note => format!("{}\n", finding.sentence),
    }
}
