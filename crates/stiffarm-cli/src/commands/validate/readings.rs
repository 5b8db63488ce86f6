//! From a table of raw readings to displacements, with all that was noticed.

use crate::numbers::{mm, significant};
use crate::table::{serious, yellow};
use stiffarm::findings::{Finding, Severity};
use stiffarm::measure::Measured;
use stiffarm::measure::reduction::UnloadedRegistration;

/// What was done with raw readings; nothing for displacements.
pub fn done(measured: &Measured) -> String {
    let mut out = String::new();
    let Some(reduction) = &measured.reduction else {
        return out;
    };
    if let Some(registration) = &reduction.registration {
        out += &register(registration);
    }
    if let Some(repeats) = &reduction.repeatability {
        out += &format!(
            "Repeats: one reading scatters by {} mm per axis ({} degrees of freedom).\n",
            mm(repeats.std_m),
            repeats.degrees_of_freedom
        );
    }
    let largest = reduction
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
    out
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
        Severity::Serious => format!("{}\n", serious(&finding.sentence)),
        Severity::Caution => format!("{}: {}\n", yellow("caution"), finding.sentence),
        Severity::Note => format!("{}\n", finding.sentence),
    }
}
