//! Denavit–Hartenberg rows to a chain of joint placements.

use crate::error::{Code, Error, Result};
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

/// Which Denavit–Hartenberg convention the rows follow.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DhConvention {
    /// Modified (Craig): T = RotX(α) TransX(a) RotZ(θ) TransZ(d).
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

/// Placements of the joints and the flange in the last joint's frame.
pub(super) fn chain(
    convention: DhConvention,
    rows: &[DhRow],
    base: Isometry3<f64>,
) -> Result<(Vec<Isometry3<f64>>, Isometry3<f64>)> {
    let mut placements = Vec::with_capacity(rows.len());
    let mut pending = base;
    for (i, row) in rows.iter().enumerate() {
        if [row.alpha, row.a, row.d, row.offset]
            .iter()
            .any(|v| !v.is_finite())
        {
            return Err(Error::new(
                Code::NotFinite,
                format!(
                    "Denavit–Hartenberg row {} has a number that is not finite.",
                    i + 1
                ),
            ));
        }
        let about_x = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), row.alpha);
        let along_z = Translation3::new(0.0, 0.0, row.d);
        match convention {
            DhConvention::Modified => {
                let before = about_x * Translation3::new(row.a, 0.0, 0.0);
                placements.push(pending * before);
                pending = Isometry3::from_parts(along_z, UnitQuaternion::identity());
            }
            DhConvention::Standard => {
                placements.push(pending);
                pending = Isometry3::from_parts(Translation3::new(row.a, 0.0, row.d), about_x);
            }
        }
    }
    Ok((placements, pending))
}
