//! What the linear model leaves out: K_C and the equilibrium, posture by posture.

use crate::error::Result;
use crate::findings::{Finding, Severity, length, percent};
use crate::model::cell::Cell;
use crate::model::measurement::MeasuredPosture;
use crate::model::stiffness::second_order;
use crate::numerics::control::Control;
use crate::numerics::jobs::in_order_watched;
use serde::{Deserialize, Serialize};

/// Share of the displacement above which the linear model is not enough.
const NONLINEAR_SHARE: f64 = 0.02;

/// What the linear model leaves out at one posture and load.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SecondOrderShare {
    /// Posture.
    pub posture: String,
    /// Load state.
    pub state: String,
    /// Largest change of a measuring point's displacement by K_C alone \[m\].
    pub correction_m: f64,
    /// The same as a share of that point's displacement.
    pub correction_share: f64,
    /// Largest difference of the exact equilibrium to the linear model \[m\].
    pub linearisation_m: f64,
    /// The same as a share of that point's displacement.
    pub linearisation_share: f64,
}

/// Shares of K_C and of the equilibrium with the joint stiffness `stiffness`
/// \[N·m/rad\], the largest over the measuring points.
///
/// # Errors
/// As [`second_order`].
pub fn second_order_shares(
    cell: &Cell,
    measured: &[MeasuredPosture],
    stiffness: &[f64],
) -> Result<Vec<SecondOrderShare>> {
    watched_shares(cell, measured, stiffness, Control::default())
}

/// The same, which can be stopped.
pub(super) fn watched_shares(
    cell: &Cell,
    measured: &[MeasuredPosture],
    stiffness: &[f64],
    control: Control<'_>,
) -> Result<Vec<SecondOrderShare>> {
    in_order_watched(measured, "checking the equilibrium", control, |(_, m)| {
        let setup = cell.setup.of_state(&m.state)?;
        let parts = second_order(&setup, &m.posture.q, stiffness, m.wrench.as_ref())?;
        let largest = |changes: &[f64]| {
            let mut best = (0.0, 0.0);
            for (change, displacement) in changes.iter().zip(&parts.displacement) {
                if *change > best.0 {
                    let share = if *displacement > 0.0 { change / displacement } else { 0.0 };
                    best = (*change, share);
                }
            }
            best
        };
        let (correction_m, correction_share) = largest(&parts.correction);
        let (linearisation_m, linearisation_share) = largest(&parts.linearisation);
        Ok(SecondOrderShare {
            posture: m.posture.name.clone(),
            state: m.state.clone(),
            correction_m,
            correction_share,
            linearisation_m,
            linearisation_share,
        })
    })
}

/// The identified joints are so soft that the load has no equilibrium.
pub(super) fn unstable() -> Finding {
    let sentence = "With joints as soft as these the arm has no stable equilibrium under its load: something is off by \
                    a factor. Check the units of displacements and forces.";
    Finding::serious("no-equilibrium", "model", sentence)
}

/// Whether the linear model is enough, at displacements with noise `sigma` \[m\].
pub(super) fn finding(shares: &[SecondOrderShare], sigma: f64) -> Option<Finding> {
    let largest = |of: fn(&SecondOrderShare) -> f64| shares.iter().max_by(|a, b| of(a).total_cmp(&of(b)));
    let correction = largest(|s| s.correction_m)?;
    let equilibrium = largest(|s| s.linearisation_m)?;
    let matters = equilibrium.linearisation_m > sigma && equilibrium.linearisation_share > NONLINEAR_SHARE;
    let (severity, verdict) = if matters {
        (Severity::Caution, "predict with the equilibrium there")
    } else {
        (Severity::Note, "the linear model is enough")
    };
    let message = format!(
        "K_C changes a displacement by at most {} ({}, posture {}), and the exact equilibrium differs from the linear \
         model by at most {} ({}, posture {}): {verdict}.",
        length(correction.correction_m),
        percent(correction.correction_share),
        correction.posture,
        length(equilibrium.linearisation_m),
        percent(equilibrium.linearisation_share),
        equilibrium.posture,
    );
    Some(Finding::new("second-order", severity, "model", message))
}
