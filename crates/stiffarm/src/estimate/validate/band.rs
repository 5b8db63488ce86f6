//! Bands about predicted displacements.

use super::{PointDeviation, Validation};
use crate::error::Result;
use crate::estimate::compliance::{IdentifiedCompliance, Spread};
use crate::estimate::freedom::SpreadQuantiles;
use crate::estimate::identify::{Block, MeasuredSystem, RowLabel};
use crate::findings::{Finding, codes};
use nalgebra::{DMatrix, Matrix3, Vector3};
use serde::{Deserialize, Serialize};

/// Shares that differ from the confidence by this many standard deviations are named.
const NAMED_DEVIATIONS: f64 = 3.0;

/// How far one displacement may lie from its prediction.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PointBand {
    /// Standard deviation of the calculated displacement, x, y, z: what the
    /// covariance of the estimates makes of it \[m\].
    pub prediction_std_m: [f64; 3],
    /// Standard deviation of the measured displacement by its noise, x, y, z \[m\].
    pub noise_std_m: [f64; 3],
    /// Half width of the band of the calculated displacement at the confidence,
    /// x, y, z \[m\].
    pub prediction_half_width_m: [f64; 3],
    /// The same for the norm of the calculated displacement, first order \[m\].
    pub norm_half_width_m: f64,
    /// Half width for a measured displacement: prediction and noise, x, y, z \[m\].
    pub half_width_m: [f64; 3],
    /// True where the measured component lies inside that.
    pub inside: [bool; 3],
}

/// How many components lie inside their bands.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct BandShare {
    /// Confidence of the bands.
    pub confidence: f64,
    /// Components inside.
    pub inside: usize,
    /// Components with a band.
    pub components: usize,
}

/// Bands about what one predictor says of the rows of a system.
pub(super) struct PointBands<'a> {
    system: &'a MeasuredSystem,
    /// Nothing where the predictor does not know how sure it is.
    spread: Option<(&'a Spread, SpreadQuantiles)>,
}

impl<'a> PointBands<'a> {
    /// # Errors
    /// No degree of freedom.
    pub(super) fn new(predictor: &'a IdentifiedCompliance, system: &'a MeasuredSystem) -> Result<Self> {
        let spread = match &predictor.spread {
            Some(spread) => Some((spread, spread.quantiles()?)),
            None => None,
        };
        Ok(PointBands { system, spread })
    }

    /// The band of the displacement behind `label`, a row triple of the system.
    pub(super) fn of(
        &self,
        block: &Block,
        label: &RowLabel,
        measured: &Vector3<f64>,
        calculated: &Vector3<f64>,
    ) -> Option<PointBand> {
        let (spread, quantiles) = self.spread.as_ref()?;
        let error = measured - calculated;
        Some(band(spread, quantiles, self.system, block, label, &error, calculated))
    }
}

fn band(
    spread: &Spread,
    quantiles: &SpreadQuantiles,
    system: &MeasuredSystem,
    block: &Block,
    label: &RowLabel,
    error: &Vector3<f64>,
    calculated: &Vector3<f64>,
) -> PointBand {
    let psi = system.psi.rows(label.rows.start, 3).into_owned();
    let with = &spread.covariance * psi.transpose();
    let prediction = cut(&(&psi * &with), 0);
    let at = label.rows.start - block.rows.start;
    // Rows of the posture share its shifts, in proportion to the load.
    let covariance = block.covariance.of_point(at);
    let shared = block.shared.rows(at, 3);
    let shared = cut(&(shared * shared.transpose()), 0);
    let noise = covariance * spread.sigma.powi(2) + shared * spread.shift.powi(2);
    let half = |direction: &Vector3<f64>, noise: f64| {
        let variance = direction.dot(&(prediction * direction)).max(0.0);
        let with = &with * direction;
        quantiles.of(&with, variance, noise) * (variance + noise).sqrt()
    };
    let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
    let predicted = axes.map(|axis| half(&axis, 0.0));
    let all: [f64; 3] = std::array::from_fn(|i| half(&axes[i], noise[(i, i)].max(0.0)));
    let std = |m: &Matrix3<f64>| m.diagonal().map(|v| v.max(0.0).sqrt());
    let along = calculated.try_normalize(0.0).unwrap_or_default();
    PointBand {
        prediction_std_m: std(&prediction).into(),
        noise_std_m: std(&noise).into(),
        prediction_half_width_m: predicted,
        norm_half_width_m: half(&along, 0.0),
        half_width_m: all,
        inside: std::array::from_fn(|i| error[i].abs() <= all[i]),
    }
}

/// The 3 × 3 block on the diagonal that begins at `at`.
fn cut(matrix: &DMatrix<f64>, at: usize) -> Matrix3<f64> {
    matrix.fixed_view::<3, 3>(at, at).into_owned()
}

/// Counts what lies inside; `None` without any band.
pub(super) fn share(points: &[PointDeviation], confidence: f64) -> Option<BandShare> {
    let bands: Vec<&PointBand> = points.iter().filter_map(|p| p.band.as_ref()).collect();
    let inside = bands.iter().flat_map(|b| b.inside).filter(|i| *i).count();
    (!bands.is_empty()).then_some(BandShare { confidence, inside, components: 3 * bands.len() })
}

/// Says when the share inside is far from the confidence.
pub(super) fn findings(result: &Validation) -> Vec<Finding> {
    let Some(band) = &result.band else {
        return Vec::new();
    };
    let mut postures: Vec<&str> = result.points.iter().map(|p| p.posture.as_str()).collect();
    postures.sort_unstable();
    postures.dedup();
    // The points of a posture err together: three independent components each.
    let independent = (3 * postures.len()).min(band.components) as f64;
    let (p, inside) = (band.confidence, band.inside as f64 / band.components as f64);
    let scatter = (p * (1.0 - p) / independent).sqrt();
    let said = format!("{} of {} components lie inside their {:.0} % bands", band.inside, band.components, 100.0 * p);
    if inside < p - NAMED_DEVIATIONS * scatter {
        return vec![Finding::caution(
            codes::OUTSIDE_BANDS,
            "measurements",
            format!(
                "Only {said}: these postures err by more than estimates and noise explain. They lie outside what the \
                 identification has seen, or the load, the angles or the readings carry an error that its residuals \
                 did not show."
            ),
        )];
    }
    // So many postures inside without exception are less likely than this.
    if band.inside == band.components && p.powf(independent) < 1e-3 {
        return vec![Finding::note(
            "bands-too-wide",
            "measurements",
            format!("{said}, all of them: the bands are wider than these readings need."),
        )];
    }
    Vec::new()
}
