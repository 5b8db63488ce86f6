//! The rigid fit itself.

use crate::numerics::information::{Svd, svd};
use nalgebra::{DMatrix, Isometry3, Matrix3, Rotation3, Translation3, Unit, UnitQuaternion, Vector3};

/// Points nearer to a line than this share of their spread along it count as
/// on it.
pub(super) const LINE: f64 = 1e-3;
/// Rounding errors of a coordinate, in units of its last place.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// A pair without its name.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sample {
    pub(super) tracker: Vector3<f64>,
    pub(super) base: Vector3<f64>,
    pub(super) weight: f64,
}

/// Least-squares rigid transform of samples.
#[derive(Debug, Clone)]
pub(super) struct RigidFit {
    /// Base frame from tracker frame \[m\].
    pub(super) pose: Isometry3<f64>,
    /// Weighted centroids \[m\].
    pub(super) tracker_centroid: Vector3<f64>,
    pub(super) base_centroid: Vector3<f64>,
    /// Σ weight.
    pub(super) weight: f64,
    /// Σ weight·‖residual‖² \[m²\].
    pub(super) rss: f64,
    /// What Σ weight·‖residual‖² may be by rounding alone \[m²\].
    pub(super) rounding: f64,
    /// Singular values of the weighted, centred tracker positions, descending
    /// \[m\]: how far the set extends along, across and out of its plane.
    pub(super) spread: [f64; 3],
    /// Σ weight·(‖d‖² I − d dᵀ) of the turned, centred positions d, base axes \[m²\].
    pub(super) inertia: Matrix3<f64>,
}

impl RigidFit {
    /// Base position minus transformed tracker position of each sample \[m\].
    pub(super) fn residuals(&self, samples: &[Sample]) -> Vec<Vector3<f64>> {
        samples.iter().map(|s| self.residual(s)).collect()
    }

    /// Base position minus transformed tracker position \[m\], from centred
    /// coordinates: a frame far away costs no digits.
    pub(super) fn residual(&self, sample: &Sample) -> Vector3<f64> {
        (sample.base - self.base_centroid) - self.pose.rotation * (sample.tracker - self.tracker_centroid)
    }

    /// Unknowns that the samples determine: five for points on a line, whose
    /// turn about it is free.
    pub(super) fn rank(&self) -> usize {
        if self.spread[1] > LINE * self.spread[0] { 6 } else { 5 }
    }

    /// True where the residuals are rounding errors: nothing to draw conclusions from.
    pub(super) fn is_exact(&self) -> bool {
        self.rss <= self.rounding
    }

    /// Σ weight·‖residual‖², and at least what rounding makes of it.
    pub(super) fn rss_above_rounding(&self) -> f64 {
        self.rss.max(self.rounding).max(f64::MIN_POSITIVE)
    }
}

/// Fits a rigid transform; `None` where the decomposition does not converge
/// or there are no samples. Samples on a line get one of the transforms that
/// fit alike.
pub(super) fn rigid(samples: &[Sample]) -> Option<RigidFit> {
    let weight: f64 = samples.iter().map(|s| s.weight).sum();
    let mean = |of: fn(&Sample) -> Vector3<f64>| {
        let sum: Vector3<f64> = samples.iter().map(|s| of(s) * s.weight).sum();
        sum / weight
    };
    let (tracker_centroid, base_centroid) = (mean(|s| s.tracker), mean(|s| s.base));
    let mut cross = Matrix3::zeros();
    for s in samples {
        cross += (s.base - base_centroid) * (s.tracker - tracker_centroid).transpose() * s.weight;
    }
    let Svd { u, v, .. } = svd(DMatrix::from_iterator(3, 3, cross.iter().copied()))?;
    let rotation = Rotation3::from_matrix_unchecked(frame(&u) * frame(&v).transpose());
    let mut fit = RigidFit {
        pose: Isometry3::from_parts(
            Translation3::identity(),
            normalised(UnitQuaternion::from_rotation_matrix(&rotation)),
        ),
        tracker_centroid,
        base_centroid,
        weight,
        rss: 0.0,
        rounding: 0.0,
        spread: spread(samples, &tracker_centroid)?,
        inertia: Matrix3::zeros(),
    };
    fit.inertia = inertia(samples, &fit);
    if fit.rank() == 6 {
        refine(samples, &mut fit);
    }
    fit.pose.translation.vector = base_centroid - fit.pose.rotation * tracker_centroid;
    for s in samples {
        fit.rss += s.weight * fit.residual(s).norm_squared();
        let largest = s.tracker.amax().max(s.base.amax());
        fit.rounding += s.weight * (ROUNDING * largest).powi(2);
    }
    Some(fit)
}

/// One Gauss–Newton step about the centroid. The decomposition squares the
/// ratio of the spreads, the residuals do not: the step gives long thin sets
/// their lost digits back.
fn refine(samples: &[Sample], fit: &mut RigidFit) {
    let mut moment = Vector3::zeros();
    for s in samples {
        let turned = fit.pose.rotation * (s.tracker - fit.tracker_centroid);
        moment += turned.cross(&fit.residual(s)) * s.weight;
    }
    if let Some(inertia) = fit.inertia.cholesky() {
        let turn = UnitQuaternion::from_scaled_axis(inertia.solve(&moment));
        fit.pose.rotation = normalised(turn * fit.pose.rotation);
    }
}

fn inertia(samples: &[Sample], fit: &RigidFit) -> Matrix3<f64> {
    let mut inertia = Matrix3::zeros();
    for s in samples {
        let d = fit.pose.rotation * (s.tracker - fit.tracker_centroid);
        inertia += (Matrix3::identity() * d.norm_squared() - d * d.transpose()) * s.weight;
    }
    inertia
}

fn normalised(rotation: UnitQuaternion<f64>) -> UnitQuaternion<f64> {
    Unit::new_normalize(rotation.into_inner())
}

/// A right-handed frame of the first two columns; det = +1 because the third
/// direction follows from them. A column that is zero, where the points lie on
/// a line, is replaced by any direction across.
pub(super) fn frame(columns: &DMatrix<f64>) -> Matrix3<f64> {
    let column = |j: usize| Vector3::new(columns[(0, j)], columns[(1, j)], columns[(2, j)]);
    let unit = |v: Vector3<f64>| v.try_normalize(0.5);
    let first = unit(column(0)).unwrap_or_else(Vector3::x);
    let second = column(1) - first * first.dot(&column(1));
    let second = unit(second).unwrap_or_else(|| {
        let axis = Vector3::ith(first.iamin(), 1.0);
        first.cross(&axis).normalize()
    });
    Matrix3::from_columns(&[first, second, first.cross(&second)])
}

/// True when a rigid transform of these points is determined: at least three
/// that are not on a line.
pub(in crate::measure) fn is_spread(points: &[Vector3<f64>]) -> bool {
    if points.len() < 3 {
        return false;
    }
    let mean = points.iter().sum::<Vector3<f64>>() / points.len() as f64;
    let rows = DMatrix::from_fn(points.len(), 3, |i, j| points[i][j] - mean[j]);
    singular_values(rows).is_some_and(|values| values[1] > LINE * values[0])
}

/// Singular values of a matrix of three columns, descending.
fn singular_values(rows: DMatrix<f64>) -> Option<[f64; 3]> {
    let small = if rows.nrows() > 12 { rows.qr().r() } else { rows };
    let values = svd(small)?.values;
    Some([values[0], values[1], values[2]])
}

/// Singular values of the weighted, centred tracker positions, descending \[m\].
fn spread(samples: &[Sample], centroid: &Vector3<f64>) -> Option<[f64; 3]> {
    let rows = samples.len().max(3);
    let mut centred = DMatrix::zeros(rows, 3);
    for (i, s) in samples.iter().enumerate() {
        let row = (s.tracker - centroid) * s.weight.sqrt();
        centred.row_mut(i).copy_from(&row.transpose());
    }
    singular_values(centred)
}

/// RMS of the norms \[m\].
pub(super) fn rms(residuals: &[Vector3<f64>]) -> f64 {
    let sum: f64 = residuals.iter().map(Vector3::norm_squared).sum();
    (sum / residuals.len() as f64).sqrt()
}
