//! Registration: the rigid transform from tracker to base axes from pairs of
//! points, by least squares (Arun, Huang & Blostein, IEEE Trans. Pattern Anal.
//! 9(5), 1987, 698–700, doi:10.1109/TPAMI.1987.4767965; det = +1 after Umeyama
//! 1991, doi:10.1109/34.88573).

use crate::error::{Code, Error, Result};
use crate::information::{Svd, svd};
use nalgebra::{DMatrix, Isometry3, Matrix3, Rotation3, Translation3, UnitQuaternion, Vector3};

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

/// A registration of tracker to base.
#[derive(Debug, Clone, PartialEq)]
pub struct Registration {
    /// Base frame from tracker frame \[m\].
    pub base_from_tracker: Isometry3<f64>,
    /// Base position minus transformed tracker position of each pair, base axes \[m\].
    pub residuals: Vec<Vector3<f64>>,
    /// RMS of the residuals' norms \[m\].
    pub rms: f64,
}

/// Registers tracker to base from at least three pairs that are not on a line.
///
/// # Errors
/// Fewer than three pairs, a coordinate that is not finite, points on a line, or
/// a mirrored set.
pub fn register(pairs: &[PointPair]) -> Result<Registration> {
    if pairs.len() < 3 {
        return Err(Error::new(
            Code::TooFewData,
            format!(
                "{} point pairs; a registration needs at least 3.",
                pairs.len()
            ),
        ));
    }
    let count = pairs.len() as f64;
    let mean =
        |of: fn(&PointPair) -> Vector3<f64>| pairs.iter().map(of).sum::<Vector3<f64>>() / count;
    let (from, to) = (mean(|p| p.tracker), mean(|p| p.base));
    let mut cross = Matrix3::zeros();
    for pair in pairs {
        cross += (pair.base - to) * (pair.tracker - from).transpose();
    }
    let Svd { u, v, .. } = svd(DMatrix::from_iterator(3, 3, cross.iter().copied()))
        .ok_or_else(|| Error::new(Code::NotFinite, "A coordinate is not a finite number."))?;
    let column = |m: &DMatrix<f64>, j: usize| Vector3::new(m[(0, j)], m[(1, j)], m[(2, j)]);
    // det = +1 for both: the third direction follows from the first two.
    let frame = |m: &DMatrix<f64>| {
        let (a, b) = (column(m, 0), column(m, 1));
        Matrix3::from_columns(&[a, b, a.cross(&b)])
    };
    let rotation = Rotation3::from_matrix_unchecked(frame(&u) * frame(&v).transpose());
    let rotation = UnitQuaternion::from_rotation_matrix(&rotation);
    let base_from_tracker =
        Isometry3::from_parts(Translation3::from(to - rotation * from), rotation);
    let residuals: Vec<Vector3<f64>> = pairs
        .iter()
        .map(|p| {
            p.base - (base_from_tracker.rotation * p.tracker + base_from_tracker.translation.vector)
        })
        .collect();
    let rms = (residuals.iter().map(Vector3::norm_squared).sum::<f64>() / count).sqrt();
    Ok(Registration {
        base_from_tracker,
        residuals,
        rms,
    })
}
