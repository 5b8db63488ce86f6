//! Cartesian stiffness of the tip and its principal axes.

use super::LoadedArm;
use crate::error::Result;
use crate::model::dexterity::condition_number;
use crate::model::load::Wrench;
use crate::model::observation::PostureTerms;
use crate::model::stiffness::{corrected, stiffness_correction};
use crate::numerics::order::sort_by_number;
use nalgebra::{Matrix3, Matrix6, Vector3};
use serde::{Deserialize, Serialize};

/// One principal axis of the translational compliance of the tip.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PrincipalAxis {
    /// Force per shift along the axis, the tip being free to turn \[N/m\];
    /// `None` where the tip does not give way.
    pub stiffness_n_per_m: Option<f64>,
    /// Direction, base axes; the component of largest size is positive.
    pub direction: [f64; 3],
}

/// Cartesian stiffness and compliance of the tip at one posture, base axes,
/// rows and columns \[linear; angular\] at the tip.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CartesianStiffness {
    /// K, blocks \[N/m\], \[N/rad\], \[N·m/m\], \[N·m/rad\], Eq. (2); `None` where
    /// the posture is singular.
    pub matrix: Option<[[f64; 6]; 6]>,
    /// The same with the load's K_C (Chen & Kao).
    pub matrix_with_k_c: Option<[[f64; 6]; 6]>,
    /// Compliance, the inverse of K; it exists at singular postures as well.
    pub compliance: [[f64; 6]; 6],
    /// The same with the load's K_C.
    pub compliance_with_k_c: [[f64; 6]; 6],
    /// Principal axes of a force without moment, softest first.
    pub principal: [PrincipalAxis; 3],
}

/// Where along a path the tip gives way in which direction.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PointStiffness {
    /// Number of the point, from 0.
    pub at: usize,
    /// Principal axes of a force without moment there, softest first.
    pub principal: [PrincipalAxis; 3],
}

/// The points of a path at which the tip bends least and most; of equals the first.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PathExtremes {
    /// Where the tip bends least.
    pub best: PointStiffness,
    /// Where it bends most.
    pub worst: PointStiffness,
}

impl LoadedArm {
    /// The extremes of a path with these postures and deflections \[m\]; `None` for a path without points,
    /// and where something that gives way is not determined.
    pub(crate) fn extremes<'q>(&self, points: impl Iterator<Item = (&'q [f64], f64)>) -> Result<Option<PathExtremes>> {
        let points: Vec<(&[f64], f64)> = points.collect();
        if !self.is_determined() {
            return Ok(None);
        }
        let first_of = |better: fn(f64, f64) -> bool| {
            let all = points.iter().enumerate();
            // What carries no load bends nowhere.
            let loaded = all.filter(|(_, (_, size))| *size > 0.0);
            loaded.reduce(|a, b| if better(b.1.1, a.1.1) { b } else { a })
        };
        let stiffness = |(at, (q, _)): (usize, &(&[f64], f64))| {
            let unloaded = Wrench::force(Vector3::zeros());
            Ok(PointStiffness { at, principal: self.principal(&self.terms(q, &unloaded)?) })
        };
        match (first_of(|a, b| a < b), first_of(|a, b| a > b)) {
            (Some(best), Some(worst)) => Ok(Some(PathExtremes { best: stiffness(best)?, worst: stiffness(worst)? })),
            _ => Ok(None),
        }
    }

    /// Principal axes of a force without moment at the posture of `terms`, softest first.
    pub(crate) fn principal(&self, terms: &PostureTerms) -> [PrincipalAxis; 3] {
        let compliance = self.tip_compliance(terms);
        principal_axes(&compliance.fixed_view::<3, 3>(0, 0).into_owned())
    }

    /// Compliance of the tip at the posture of `terms`, 6 × 6: J K_θ⁻¹ Jᵀ of the
    /// joints, and what series compliance and tilts add. Lost motion is no
    /// compliance and left out.
    pub fn tip_compliance(&self, terms: &PostureTerms) -> Matrix6<f64> {
        let jacobian = terms.frames().jacobian(&terms.measuring_points()[0]);
        let joints: Matrix6<f64> = {
            let full = &jacobian * self.compliance() * jacobian.transpose();
            full.fixed_view::<6, 6>(0, 0).into_owned()
        };
        let added = if self.has_more_than_joints() { self.added_compliance(terms) } else { Matrix6::zeros() };
        // Products in another order differ by rounding.
        let sum = joints + added;
        (sum + sum.transpose()) * 0.5
    }

    /// Cartesian stiffness at the controller angles `q` \[rad\] under `wrench` (at
    /// the loaded point, base axes), which K_C depends on.
    ///
    /// # Errors
    /// Angles of the wrong number or not finite; a load that buckles the arm; something that
    /// gives way and is not determined.
    pub fn cartesian(&self, q: &[f64], wrench: &Wrench) -> Result<CartesianStiffness> {
        self.check_all_determined("the stiffness of the tip depends on it")?;
        let terms = self.terms(q, wrench)?;
        let compliance = self.tip_compliance(&terms);
        // J (K_θ − K_C)⁻¹ Jᵀ − J K_θ⁻¹ Jᵀ on top of all that gives way.
        let jacobian = terms.frames().jacobian(&terms.measuring_points()[0]);
        let k_c = stiffness_correction(&terms);
        let change = corrected(self.compliance(), Some(&k_c))? - self.compliance();
        let change = &jacobian * change * jacobian.transpose();
        let with_k_c = compliance + change.fixed_view::<6, 6>(0, 0);
        let regular = condition_number(terms.frames(), &terms.measuring_points()[0], 1.0).is_some();
        let inverse = |m: &Matrix6<f64>| regular.then(|| m.try_inverse()).flatten().map(|k| rows(&k));
        let symmetric =
            |m: &Matrix6<f64>| regular.then(|| m.try_inverse()).flatten().map(|k| rows(&((k + k.transpose()) * 0.5)));
        Ok(CartesianStiffness {
            matrix: symmetric(&compliance),
            matrix_with_k_c: inverse(&with_k_c),
            compliance: rows(&compliance),
            compliance_with_k_c: rows(&with_k_c),
            principal: principal_axes(&compliance.fixed_view::<3, 3>(0, 0).into_owned()),
        })
    }
}

/// A matrix as rows.
fn rows(matrix: &Matrix6<f64>) -> [[f64; 6]; 6] {
    std::array::from_fn(|i| std::array::from_fn(|j| matrix[(i, j)]))
}

/// Principal axes of a translational compliance \[m/N\], softest first.
pub(crate) fn principal_axes(compliance: &Matrix3<f64>) -> [PrincipalAxis; 3] {
    let eigen = compliance.symmetric_eigen();
    let mut order = [0, 1, 2];
    sort_by_number(&mut order, |a| -eigen.eigenvalues[*a]);
    let least = f64::EPSILON * eigen.eigenvalues.amax();
    order.map(|i| {
        let value = eigen.eigenvalues[i];
        let axis: Vector3<f64> = eigen.eigenvectors.column(i).into_owned();
        let largest = axis[axis.iamax()];
        PrincipalAxis {
            stiffness_n_per_m: (value > least).then(|| 1.0 / value),
            direction: (axis * largest.signum()).into(),
        }
    })
}
