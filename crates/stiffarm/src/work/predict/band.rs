//! How sure a predicted deflection is.

use crate::error::Result;
use crate::estimate::compliance::IdentifiedCompliance;
use crate::estimate::identify::quantile;
use nalgebra::{DMatrix, Matrix3, Vector3};
use serde::{Deserialize, Serialize};

/// Confidence of bands that know no statistical part.
const CONFIDENCE: f64 = 0.95;

/// How far the true deflection may lie from the predicted one, base axes:
/// half widths at the confidence of the prediction.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TipBand {
    /// From the scatter of the readings behind the joint stiffness, x, y, z \[m\].
    pub statistical_m: [f64; 3],
    /// From errors common to that experiment, which its residuals do not show,
    /// x, y, z \[m\].
    pub common_m: [f64; 3],
    /// From the uncertainty of the load at work, x, y, z \[m\].
    pub load_m: [f64; 3],
    /// All three together, x, y, z \[m\].
    pub total_m: [f64; 3],
    /// The same for the size of the deflection, to first order: statistical,
    /// common, load, total \[m\].
    pub size_m: [f64; 4],
    /// Root mean square of the error, all parts and axes together \[m\].
    pub rms_m: f64,
}

/// Turns what is known of the unknowns into bands.
#[derive(Debug, Clone)]
pub(crate) struct Bands {
    /// Square roots of the covariance, one column per direction; with the
    /// quantile that goes with it.
    statistical: Option<(DMatrix<f64>, f64)>,
    /// Changes of the unknowns by common errors of one standard uncertainty.
    common: Vec<nalgebra::DVector<f64>>,
    /// Relative standard uncertainty of the load.
    load: f64,
    /// Quantile of the normal.
    normal: f64,
    /// Confidence of the half widths.
    pub(crate) confidence: f64,
}

impl Bands {
    /// `None` where nothing is known about the unknowns or the load.
    pub(crate) fn new(predictor: &IdentifiedCompliance, load: f64) -> Result<Option<Self>> {
        let spread = predictor.spread.as_ref();
        let common: Vec<_> = predictor
            .common
            .iter()
            .flat_map(|c| c.parts.clone())
            .collect();
        if spread.is_none() && common.is_empty() && load == 0.0 {
            return Ok(None);
        }
        let confidence = spread.map_or(CONFIDENCE, |s| s.confidence);
        let statistical = match spread {
            Some(spread) => Some((spread.covariance.clone(), spread.quantile()?)),
            None => None,
        };
        Ok(Some(Bands {
            statistical,
            common,
            load,
            normal: quantile(None, confidence)?,
            confidence,
        }))
    }

    /// The band of a shift (m) whose derivative by the unknowns is
    /// `sensitivity`, 3 × unknowns.
    pub(crate) fn of(&self, shift: &Vector3<f64>, sensitivity: &DMatrix<f64>) -> TipBand {
        let (statistical, t) = match &self.statistical {
            Some((covariance, t)) => {
                let full = sensitivity * covariance * sensitivity.transpose();
                (full.fixed_view::<3, 3>(0, 0).into_owned(), *t)
            }
            None => (Matrix3::zeros(), 0.0),
        };
        let mut common = Matrix3::zeros();
        for change in &self.common {
            let moved = sensitivity * change;
            let moved = Vector3::new(moved[0], moved[1], moved[2]);
            common += moved * moved.transpose();
        }
        // A load too large by a fraction bends more by that fraction.
        let load = shift * shift.transpose() * self.load.powi(2);
        let std = |m: &Matrix3<f64>| m.diagonal().map(|v| v.max(0.0).sqrt());
        let parts = [
            std(&statistical) * t,
            std(&common) * self.normal,
            std(&load) * self.normal,
        ];
        let total = Vector3::from_fn(|i, _| parts.iter().map(|p| p[i] * p[i]).sum::<f64>().sqrt());
        let along = shift.try_normalize(0.0).unwrap_or_default();
        let size = |m: &Matrix3<f64>, q: f64| q * along.dot(&(m * along)).max(0.0).sqrt();
        let sizes = [
            size(&statistical, t),
            size(&common, self.normal),
            size(&load, self.normal),
        ];
        TipBand {
            statistical_m: parts[0].into(),
            common_m: parts[1].into(),
            load_m: parts[2].into(),
            total_m: total.into(),
            size_m: [
                sizes[0],
                sizes[1],
                sizes[2],
                sizes.iter().map(|s| s * s).sum::<f64>().sqrt(),
            ],
            rms_m: (statistical + common + load).trace().max(0.0).sqrt(),
        }
    }
}
