//! Denavit–Hartenberg rows to a chain of joint placements.

use crate::error::{Code, Error, Result};
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use serde::Serialize;

/// Which Denavit–Hartenberg convention the rows follow.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum DhConvention {
    /// Modified (Craig): T = RotX(α) TransX(a) RotZ(θ) TransZ(d).
    #[default]
    Modified,
    /// Standard: T = RotZ(θ) TransZ(d) TransX(a) RotX(α).
    Standard,
}

/// One row; `offset` is the part of θ that does not move \[rad\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DhRow {
    /// Link twist α \[rad\].
    pub alpha: f64,
    /// Link length a \[m\].
    pub a: f64,
    /// Link offset d \[m\].
    pub d: f64,
    /// Constant part of the serial angle \[rad\].
    pub offset: f64,
}

impl DhRow {
    /// The frame that the row ends in, in the frame of its joint after the turn \[m\].
    pub(super) fn after_turn(&self, convention: DhConvention) -> Isometry3<f64> {
        match convention {
            DhConvention::Modified => Isometry3::translation(0.0, 0.0, self.d),
            DhConvention::Standard => Isometry3::from_parts(
                Translation3::new(self.a, 0.0, self.d),
                UnitQuaternion::from_axis_angle(&Vector3::x_axis(), self.alpha),
            ),
        }
    }
}

/// Placements of the joints and the flange in the last joint's frame.
pub(super) fn chain(
    convention: DhConvention,
    rows: &[DhRow],
    base: Isometry3<f64>,
) -> Result<(Vec<Isometry3<f64>>, Isometry3<f64>)> {
    let mut placements = Vec::with_capacity(rows.len());
    let mut pending = base;
    for (i, row) in rows.iter().enumerate() {
        if [row.alpha, row.a, row.d, row.offset].iter().any(|v| !v.is_finite()) {
            return Err(Error::new(
                Code::NotFinite,
                format!("Denavit–Hartenberg row {} has a number that is not finite.", i + 1),
            ));
        }
        placements.push(match convention {
            DhConvention::Modified => {
                let about_x = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), row.alpha);
                pending * (about_x * Translation3::new(row.a, 0.0, 0.0))
            }
            DhConvention::Standard => pending,
        });
        pending = row.after_turn(convention);
    }
    Ok((placements, pending))
}
