//! A registration as JSON holds it.

use super::Registration;
use crate::error::{Code, Error, Result};
use crate::findings::Finding;
use crate::units::roll_pitch_yaw;
use nalgebra::{Isometry3, Matrix3, Matrix6, Rotation3, Translation3, Unit, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

/// A rotation matrix may differ from an orthogonal one by this.
const ORTHOGONAL: f64 = 1e-9;

/// A [`Registration`] as JSON holds it: matrices by rows, SI units.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RegistrationRecord {
    /// Rotation of tracker into base axes, row by row.
    pub rotation: [[f64; 3]; 3],
    /// Origin of the tracker frame in the base frame \[m\].
    pub translation_m: [f64; 3],
    /// The rotation as roll, pitch, yaw: turns about the base's x, then y, then z
    /// axis \[rad\].
    #[serde(rename = "rpy_deg", with = "crate::units::degrees::all_digits")]
    #[cfg_attr(feature = "schema", schemars(with = "[f64; 3]"))]
    pub roll_pitch_yaw: [f64; 3],
    /// Names of the pairs.
    pub pairs: Vec<String>,
    /// Base position minus transformed tracker position of each pair, base axes \[m\].
    pub residuals_m: Vec<[f64; 3]>,
    /// RMS of the residuals' norms \[m\].
    pub rms_m: f64,
    /// 3N − 6 for N pairs.
    pub degrees_of_freedom: usize,
    /// Standard deviation of a coordinate as the residuals have it \[m\].
    pub residual_std_m: f64,
    /// Standard deviation of a coordinate as given, which the covariance then uses \[m\].
    pub known_std_m: Option<f64>,
    /// Centroid of the pairs, base frame \[m\].
    pub centroid_m: [f64; 3],
    /// Covariance, row by row, of the shift of the centroid \[m\] and the turn about it \[rad\],
    /// along x, y, z of the base.
    pub covariance: [[f64; 6]; 6],
    /// What to know about the pairs and the transform, the most serious first.
    pub findings: Vec<Finding>,
}

impl From<&Registration> for RegistrationRecord {
    fn from(registration: &Registration) -> Self {
        let pose = &registration.base_from_tracker;
        let rotation = pose.rotation.to_rotation_matrix();
        let covariance = &registration.covariance;
        RegistrationRecord {
            rotation: std::array::from_fn(|i| std::array::from_fn(|j| rotation[(i, j)])),
            translation_m: pose.translation.vector.into(),
            roll_pitch_yaw: roll_pitch_yaw(&pose.rotation),
            pairs: registration.names.clone(),
            residuals_m: registration.residuals.iter().map(|r| (*r).into()).collect(),
            rms_m: registration.rms,
            degrees_of_freedom: registration.degrees_of_freedom,
            residual_std_m: registration.residual_std,
            known_std_m: registration.known_std,
            centroid_m: registration.centroid.into(),
            covariance: std::array::from_fn(|i| std::array::from_fn(|j| covariance[(i, j)])),
            findings: registration.findings.clone(),
        }
    }
}

/// No base frame is farther from its tracker, no residual larger \[m\].
const FARTHEST: f64 = 1e4;

impl TryFrom<RegistrationRecord> for Registration {
    type Error = Error;

    /// # Errors
    /// Numbers that are not finite, a matrix that is no rotation, or a
    /// covariance that is none.
    fn try_from(record: RegistrationRecord) -> Result<Self> {
        let fault = |message: &str, key: &str| Error::new(Code::ResultFile, message).key(key);
        let residuals = record.residuals_m.iter().flatten().copied();
        let stds = [record.residual_std_m].into_iter().chain(record.known_std_m);
        let lengths: [(&str, f64, Vec<f64>); 5] = [
            ("translation_m", -FARTHEST, record.translation_m.to_vec()),
            ("centroid_m", -FARTHEST, record.centroid_m.to_vec()),
            ("residuals_m", -FARTHEST, residuals.collect()),
            ("rms_m", 0.0, vec![record.rms_m]),
            ("residual_std_m", 0.0, stds.collect()),
        ];
        for (key, least, values) in lengths {
            if let Some(value) = values.iter().find(|v| !(least..=FARTHEST).contains(*v)) {
                let message =
                    format!("A length of {value:e} m cannot be meant: it must lie between {least} and {FARTHEST} m.");
                return Err(fault(&message, key));
            }
        }
        let matrix = Matrix3::from_fn(|i, j| record.rotation[i][j]);
        let square = (matrix.transpose() * matrix - Matrix3::identity()).amax();
        // NaN is no rotation either.
        if !(square < ORTHOGONAL && matrix.determinant() > 0.0) {
            return Err(fault(
                "The matrix is not a rotation: its rows must be orthonormal and right-handed.",
                "rotation",
            ));
        }
        let covariance = Matrix6::from_fn(|i, j| record.covariance[i][j]);
        let symmetric = (covariance - covariance.transpose()).amax() <= 1e-9 * covariance.amax();
        let variances = covariance.diagonal();
        let positive = variances.iter().all(|v| (0.0..=FARTHEST * FARTHEST).contains(v));
        let within = |(i, j): (usize, usize)| covariance[(i, j)].powi(2) <= variances[i] * variances[j] * (1.0 + 1e-9);
        let mut pairs = (0..6).flat_map(|i| (0..6).map(move |j| (i, j)));
        // NaN is none of it.
        if !(symmetric && positive && pairs.all(within)) {
            return Err(fault(
                "The covariance is not symmetric, has a variance that none can be, or a correlation beyond ±1.",
                "covariance",
            ));
        }
        if record.pairs.len() != record.residuals_m.len() {
            return Err(fault("The number of residuals must be that of the pairs.", "residuals_m"));
        }
        let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(matrix));
        Ok(Registration {
            base_from_tracker: Isometry3::from_parts(
                Translation3::from(Vector3::from(record.translation_m)),
                Unit::new_normalize(rotation.into_inner()),
            ),
            names: record.pairs,
            residuals: record.residuals_m.into_iter().map(Vector3::from).collect(),
            rms: record.rms_m,
            degrees_of_freedom: record.degrees_of_freedom,
            residual_std: record.residual_std_m,
            known_std: record.known_std_m,
            centroid: Vector3::from(record.centroid_m),
            covariance,
            findings: record.findings,
        })
    }
}
