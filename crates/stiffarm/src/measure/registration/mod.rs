//! Registration: the rigid transform from tracker to base axes from pairs of
//! points, by least squares (Arun, Huang & Blostein, IEEE Trans. Pattern Anal.
//! 9(5), 1987, 698–700, doi:10.1109/TPAMI.1987.4767965; det = +1 after Umeyama
//! 1991, doi:10.1109/34.88573), with its covariance and what the residuals say
//! about the pairs.
//!
//! Errors of a pair are taken as independent and alike in every direction, with
//! variance σ²/weight per coordinate, whichever frame they come from.
//!
//! Convention of the covariance: to first order the true position of a point is
//! x + δ + φ × (x − c), where x is where the registration puts it, c the
//! centroid of the pairs, δ the shift of the centroid \[m\] and φ a small turn
//! \[rad\] applied on the left, both in base axes. About the centroid δ and φ
//! do not correlate.
//!
//! What cannot be seen: points in a plane look the same in a mirrored frame; a
//! shift or turn common to all pairs of one frame leaves no residual; of three
//! pairs nobody can tell which one is wrong.

mod before;
mod fit;
mod record;
mod remarks;
mod robust;
mod suspects;

pub use record::RegistrationRecord;

pub(super) use fit::is_spread;
pub(super) use robust::{Agreement, Pair, TurnSums, agreeing, all_but_the_nearest};
pub(super) use robust::{misfit, moved, rms, robust};

use crate::error::{Code, Error, Result};
use crate::findings::{Finding, Severity};
use fit::{RigidFit, Sample};
use nalgebra::{Isometry3, Matrix3, Matrix6, SMatrix, Vector3};
use suspects::Suspicion;
pub(super) use suspects::axis_slips;

/// One point in both frames.
#[derive(Debug, Clone, PartialEq)]
pub struct PointPair {
    /// Name used in messages.
    pub name: String,
    /// Position in tracker axes \[m\].
    pub tracker: Vector3<f64>,
    /// Position in the base frame \[m\].
    pub base: Vector3<f64>,
}

/// What is known about the errors of the pairs.
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
pub struct RegisterOptions {
    /// σ: standard deviation of each coordinate of a residual, both frames
    /// together, at weight 1 \[m\]; `None` estimates it from the residuals.
    pub std: Option<f64>,
    /// Weight of each pair, proportional to 1/variance; empty where all pairs
    /// are alike.
    pub weights: Vec<f64>,
}

/// A registration of tracker to base.
#[derive(Debug, Clone, PartialEq)]
pub struct Registration {
    /// Base frame from tracker frame \[m\].
    pub base_from_tracker: Isometry3<f64>,
    /// Names of the pairs.
    pub names: Vec<String>,
    /// Base position minus transformed tracker position of each pair, base axes \[m\].
    pub residuals: Vec<Vector3<f64>>,
    /// RMS of the residuals' norms \[m\].
    pub rms: f64,
    /// 3N − 6 for N pairs.
    pub degrees_of_freedom: usize,
    /// s = sqrt(Σ weight·‖residual‖²/(3N − 6)): standard deviation of a
    /// coordinate at weight 1 as the residuals have it \[m\].
    pub residual_std: f64,
    /// σ as given, where it was; the covariance then has it in place of s \[m\].
    pub known_std: Option<f64>,
    /// Centroid c of the pairs (weighted), base frame \[m\].
    pub centroid: Vector3<f64>,
    /// Covariance of \[δ; φ\], the shift of the centroid and the turn about it,
    /// base axes \[m², m·rad, rad²\]; see the module's convention.
    pub covariance: Matrix6<f64>,
    /// What to know about the pairs and the transform, the most serious first.
    pub findings: Vec<Finding>,
}

impl Registration {
    /// Where a tracker position lies in the base frame \[m\].
    pub fn to_base(&self, tracker: &Vector3<f64>) -> Vector3<f64> {
        self.base_from_tracker.rotation * tracker + self.base_from_tracker.translation.vector
    }

    /// Covariance of the base position `at` \[m\] of a transformed point that
    /// comes from the registration alone, base axes \[m²\].
    pub fn covariance_at(&self, at: &Vector3<f64>) -> Matrix3<f64> {
        let mut map = SMatrix::<f64, 3, 6>::zeros();
        map.fixed_columns_mut::<3>(0).fill_diagonal(1.0);
        map.fixed_columns_mut::<3>(3).copy_from(&-(at - self.centroid).cross_matrix());
        map * self.covariance * map.transpose()
    }

    /// Standard errors of the centroid's shift \[m\] and of the turn \[rad\],
    /// each along x, y and z of the base.
    pub fn standard_errors(&self) -> [Vector3<f64>; 2] {
        let diagonal = self.covariance.diagonal().map(|v| v.max(0.0).sqrt());
        [diagonal.fixed_rows::<3>(0).into_owned(), diagonal.fixed_rows::<3>(3).into_owned()]
    }

    /// True when a finding says that the registration cannot be used as it is.
    pub fn is_serious(&self) -> bool {
        self.findings.iter().any(|f| f.severity == Severity::Serious)
    }
}

/// The rigid transform alone, second position from first, without checks: at
/// least squares over pairs of positions \[m\]. Points on a line get one of the
/// transforms that fit alike; `None` without pairs or for numbers that are not
/// finite.
pub(crate) fn rigid_transform(pairs: impl Iterator<Item = (Vector3<f64>, Vector3<f64>)>) -> Option<Isometry3<f64>> {
    let samples: Vec<Sample> = pairs.map(|(tracker, base)| Sample { tracker, base, weight: 1.0 }).collect();
    fit::rigid(&samples).map(|fit| fit.pose)
}

/// Registers tracker to base from at least three pairs that are not on a line,
/// with σ estimated from the residuals and all pairs alike.
///
/// ```
/// use nalgebra::Vector3;
/// use stiffarm::measure::registration::{PointPair, register};
///
/// // A tracker 4 m in front of the robot, turned by half a turn about z.
/// let to_tracker = |p: Vector3<f64>| Vector3::new(4.0 - p.x, -p.y, p.z);
/// let points = [[1.0, 0.0, 0.5], [0.0, 1.0, 0.5], [0.5, 0.5, 1.5], [0.2, -0.4, 0.9]];
/// let pairs = points.map(Vector3::from).map(|base| PointPair {
///     name: format!("{base:?}"),
///     tracker: to_tracker(base),
///     base,
/// });
/// let found = register(&pairs)?;
/// assert!((found.to_base(&Vector3::zeros()) - Vector3::new(4.0, 0.0, 0.0)).norm() < 1e-12);
/// # Ok::<(), stiffarm::Error>(())
/// ```
///
/// # Errors
/// As [`register_with`].
pub fn register(pairs: &[PointPair]) -> Result<Registration> {
    register_with(pairs, &RegisterOptions::default())
}

/// Registers tracker to base from at least three pairs that are not on a line.
///
/// Wrong pairs are findings of the result: the transform is still that of the
/// pairs as they stand.
///
/// # Errors
/// Fewer than three pairs, a name that appears twice, a coordinate that is not
/// finite, points on or too near a line, frames in different units, a mirrored
/// frame, and options that make no sense.
pub fn register_with(pairs: &[PointPair], options: &RegisterOptions) -> Result<Registration> {
    before::check_options(pairs, options)?;
    before::check_pairs(pairs)?;
    let samples: Vec<Sample> = pairs
        .iter()
        .enumerate()
        .map(|(i, pair)| Sample {
            tracker: pair.tracker,
            base: pair.base,
            weight: options.weights.get(i).copied().unwrap_or(1.0),
        })
        .collect();
    let fit = fit::rigid(&samples).ok_or_else(|| {
        Error::new(Code::Numerical, "The singular value decomposition of the registration did not converge.")
    })?;
    let suspicion = Suspicion::of(&samples, &fit, options.std);
    let names: Vec<&str> = pairs.iter().map(|pair| pair.name.as_str()).collect();
    suspicion.refuse_mirrored(&names, &samples)?;

    let residuals = fit.residuals(&samples);
    let degrees_of_freedom = 3 * pairs.len() - 6;
    let residual_std = (fit.rss / degrees_of_freedom as f64).sqrt();
    let covariance = covariance(&fit, options.std.unwrap_or(residual_std))?;
    let mut findings = suspicion.findings(&names, &samples);
    if findings.is_empty() {
        findings = remarks::remarks(&samples, &fit, &suspicion, options.std)?;
    }
    findings.sort_by_key(|finding| std::cmp::Reverse(finding.severity));
    Ok(Registration {
        base_from_tracker: fit.pose,
        names: names.into_iter().map(String::from).collect(),
        rms: fit::rms(&residuals),
        residuals,
        degrees_of_freedom,
        residual_std,
        known_std: options.std,
        centroid: fit.base_centroid,
        covariance,
        findings,
    })
}

/// (Σ AᵀA·weight/σ²)⁻¹ with A = \[I, −(x − c)×\] for every pair.
fn covariance(fit: &RigidFit, std: f64) -> Result<Matrix6<f64>> {
    let turn = fit
        .inertia
        .cholesky()
        .ok_or_else(|| Error::new(Code::Numerical, "The covariance of the registration cannot be computed."))?;
    let mut covariance = Matrix6::zeros();
    let shift = Matrix3::identity() / fit.weight;
    covariance.fixed_view_mut::<3, 3>(0, 0).copy_from(&shift);
    let turn = turn.inverse();
    // Rounding leaves the inverse symmetric to the last bit only.
    let turn = (turn + turn.transpose()) * 0.5;
    covariance.fixed_view_mut::<3, 3>(3, 3).copy_from(&turn);
    Ok(covariance * std.powi(2))
}
