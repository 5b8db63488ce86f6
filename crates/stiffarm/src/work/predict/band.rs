//! How sure a predicted deflection is.
//!
//! To first order the true deflection is the predicted one plus s (h − ĥ), with s
//! the deflection's derivative by the unknowns, plus what acts at work and is not
//! modelled. While a part of a common error is there with c standard uncertainties,
//! ĥ is off by R c, and a lost motion or a tilting base moves the tip by W c more, at
//! the posture and under the load of the work: the deflection is off by D c with
//! D = W − s R. The two have opposite signs, and partly cancel where work and
//! identification load the arm alike.

use super::LoadedArm;
use crate::error::Result;
use crate::estimate::common::CommonErrors;
use crate::estimate::compliance::IdentifiedCompliance;
use crate::estimate::freedom::SpreadQuantiles;
use crate::model::observation::{ExtraTerm, PostureTerms};
use crate::model::path::LoadedPosture;
use crate::numerics::control::Control;
use crate::numerics::half_width::Level;
use crate::numerics::jobs::in_blocks;
use nalgebra::{DMatrix, DMatrixView, Matrix3, Matrix3xX, Vector3};
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
    /// From errors common to that experiment, as far as its readings leave them,
    /// in the stiffness and again at work, x, y, z \[m\].
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
    /// Covariance of the unknowns, with the quantile that goes with it.
    statistical: Option<(DMatrix<f64>, SpreadQuantiles)>,
    /// Errors common to the experiment.
    common: Common,
    /// Relative standard uncertainty of the load.
    load: f64,
    level: Level,
    /// Confidence of the half widths.
    pub(crate) confidence: f64,
}

/// Common errors, ready for many postures.
#[derive(Debug, Clone)]
struct Common {
    errors: CommonErrors,
    /// Changes of the unknowns, unknowns × parts.
    changes: DMatrix<f64>,
    /// Parts that act again at work: number, term and size.
    at_work: Vec<(usize, ExtraTerm, f64)>,
}

impl Common {
    fn new(predictor: &IdentifiedCompliance) -> Self {
        let errors = predictor.common.clone();
        let (unknowns, parts) = (predictor.values.len(), &errors.parts);
        let at_work = parts.iter().enumerate().filter_map(|(i, part)| {
            let (term, size) = part.at_work?;
            // What the predictor has among its unknowns is in the prediction.
            (!predictor.extra.contains(&term)).then_some((i, term, size))
        });
        Common {
            changes: DMatrix::from_fn(unknowns, parts.len(), |j, i| parts[i].change[j]),
            at_work: at_work.collect(),
            errors,
        }
    }

    /// Mean and covariance of the error of a shift with this derivative by the
    /// unknowns, at the posture and load of `terms`.
    fn of(&self, sensitivity: &DMatrix<f64>, terms: &PostureTerms) -> (Vector3<f64>, Matrix3<f64>) {
        let mut moved = Matrix3xX::zeros(self.changes.ncols());
        moved.gemm(-1.0, &sensitivity.rows(0, 3), &self.changes, 0.0);
        let tip = terms.measuring_points()[0];
        for (i, term, size) in &self.at_work {
            let shift = term.twist(terms, &tip).fixed_rows::<3>(0) * *size;
            let mut column = moved.column_mut(*i);
            column += shift;
        }
        let spread = &moved * &self.errors.covariance * moved.transpose();
        let mean = &moved * &self.errors.mean;
        (Vector3::new(mean[0], mean[1], mean[2]), spread.fixed_view::<3, 3>(0, 0).into_owned())
    }
}

/// Points whose bands are found together.
const TOGETHER: usize = 8;

/// What `run` finds at each of the postures, in memory for the terms of `arm`; `place` is the shift of the tip of `arm`
/// (m) in it, and where the band of that shift goes.
///
/// # Errors
/// The first of `run`, by order; stopped.
pub(crate) fn with_bands<T: Send>(
    (arm, bands): (&LoadedArm, Option<&Bands>),
    postures: &[LoadedPosture],
    (what, control): (&str, Control<'_>),
    run: impl Fn(&LoadedPosture, &mut PostureTerms) -> Result<T> + Sync + Send,
    place: fn(&mut T) -> ([f64; 3], &mut Option<TipBand>),
) -> Result<Vec<T>> {
    in_blocks(postures, what, control, |_, block| {
        let mut terms = arm.memory();
        let mut points: Vec<T> = block.iter().map(|posture| run(posture, &mut terms)).collect::<Result<_>>()?;
        let Some(bands) = bands else {
            return Ok(points);
        };
        for (points, postures) in points.chunks_mut(TOGETHER).zip(block.chunks(TOGETHER)) {
            let shifts = points.iter_mut().zip(postures).map(|(point, posture)| {
                let terms = arm.terms(&posture.q, &posture.wrench)?;
                Ok((place(point).0.into(), terms))
            });
            let bands = bands.of(arm, &shifts.collect::<Result<Vec<_>>>()?);
            for (point, band) in points.iter_mut().zip(bands) {
                *place(point).1 = Some(band);
            }
        }
        Ok(points)
    })
}

impl Bands {
    /// `None` where nothing is known about the unknowns or the load.
    pub(crate) fn new(predictor: &IdentifiedCompliance, load: f64) -> Result<Option<Self>> {
        let spread = predictor.spread.as_ref();
        if spread.is_none() && predictor.common.is_empty() && load == 0.0 {
            return Ok(None);
        }
        let confidence = spread.map_or(CONFIDENCE, |s| s.confidence);
        let statistical = match spread {
            Some(spread) => Some((spread.covariance.clone(), spread.quantiles()?)),
            None => None,
        };
        Ok(Some(Bands {
            statistical,
            common: Common::new(predictor),
            load,
            level: Level::new(confidence)?,
            confidence,
        }))
    }

    /// The bands of shifts (m) of the tip of `arm`, each at the posture and under the load of
    /// its terms.
    pub(crate) fn of(&self, arm: &LoadedArm, points: &[(Vector3<f64>, PostureTerms)]) -> Vec<TipBand> {
        let derivative = |(_, terms): &(_, PostureTerms)| arm.sensitivity(terms);
        let sensitivities: Vec<DMatrix<f64>> = points.iter().map(derivative).collect();
        // One product for all of them; with fewer than six columns it goes without vector
        // instructions.
        let with = self.statistical.as_ref().map(|(covariance, _)| {
            let mut columns = DMatrix::zeros(covariance.nrows(), (3 * points.len()).max(6));
            for (i, sensitivity) in sensitivities.iter().enumerate() {
                let mut three = columns.columns_mut(3 * i, 3);
                three.tr_copy_from(&sensitivity.rows(0, 3));
            }
            covariance * columns
        });
        let all = points.iter().zip(&sensitivities).enumerate();
        all.map(|(i, ((shift, terms), sensitivity))| {
            let with = with.as_ref().map(|with| with.columns(3 * i, 3));
            self.one(shift, sensitivity, with, terms)
        })
        .collect()
    }

    /// The band of a shift whose derivative by the unknowns is `sensitivity`, 3 × unknowns, and
    /// whose covariances with them are `with`, unknowns × 3.
    ///
    /// The parts are independent. What the readings say of the common errors is not
    /// taken out of the prediction, so their mean is not zero, and the half widths
    /// are those of a normal quantity with that mean; Student's t of the statistical
    /// part counts as normal scatter of the same half width.
    fn one(
        &self,
        shift: &Vector3<f64>,
        sensitivity: &DMatrix<f64>,
        with: Option<DMatrixView<'_, f64>>,
        terms: &PostureTerms,
    ) -> TipBand {
        let normal = self.level.quantile();
        let statistical = with.map_or_else(Matrix3::zeros, |with| {
            let full = sensitivity * with;
            full.fixed_view::<3, 3>(0, 0).into_owned()
        });
        let (mean, common) = self.common.of(sensitivity, terms);
        // A load too large by a fraction bends more by that fraction.
        let load = shift * shift.transpose() * self.load.powi(2);
        let along = |direction: &Vector3<f64>| -> [f64; 4] {
            let std = |m: &Matrix3<f64>| direction.dot(&(m * direction)).max(0.0).sqrt();
            let statistical_std = std(&statistical);
            let t = match self.statistical.as_ref().zip(with) {
                Some(((_, quantiles), with)) => {
                    quantiles.of(&(with * direction), statistical_std * statistical_std, 0.0)
                }
                None => 0.0,
            };
            let scatter = [statistical_std * t / normal, std(&common), std(&load)];
            let offset = direction.dot(&mean);
            let all = scatter.iter().map(|s| s * s).sum::<f64>().sqrt();
            [
                scatter[0] * normal,
                self.level.half_width(offset, scatter[1]),
                scatter[2] * normal,
                self.level.half_width(offset, all),
            ]
        };
        let axes = [Vector3::x(), Vector3::y(), Vector3::z()].map(|axis| along(&axis));
        let part = |i: usize| axes.map(|axis| axis[i]);
        let squares = (statistical + common + load).trace() + mean.norm_squared();
        TipBand {
            statistical_m: part(0),
            common_m: part(1),
            load_m: part(2),
            total_m: part(3),
            size_m: along(&shift.try_normalize(0.0).unwrap_or_default()),
            rms_m: squares.max(0.0).sqrt(),
        }
    }
}
