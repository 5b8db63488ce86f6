//! How sure each joint's stiffness is with everything together.

use super::posterior::Parts;
use super::predicting_model::PredictingModel;
use super::{SystematicErrors, SystematicSource};
use crate::error::Result;
use crate::estimate::identify::{IntervalHolds, JointEstimate};
use crate::numerics::half_width::Level;
use serde::{Deserialize, Serialize};

/// How sure the stiffness of one joint is, at the confidence of the fit.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct JointUncertainty {
    /// Half width by the scatter of the readings (fraction of k, first order).
    pub statistical: Option<f64>,
    /// Half width by the common errors that the readings leave (fraction of k,
    /// first order).
    pub systematic: Option<f64>,
    /// Half width by both together (fraction of k, first order).
    pub total: Option<f64>,
    /// Ends of the interval of k that holds both \[N·m/rad\]: 1/(H ± half width of H);
    /// open above where that reaches zero compliance.
    pub interval_nm_per_rad: [Option<f64>; 2],
    /// The source of common error that contributes most.
    pub largest_source: Option<String>,
}

/// One for each joint.
///
/// Half widths are about the estimate, which the mean of the common errors does
/// not correct: they hold a normal quantity whose mean is not zero. Student's t of
/// the statistical part counts as the normal scatter of the same half width.
///
/// # Errors
/// A quantile that cannot be computed.
pub(super) fn uncertainty(
    believed: &PredictingModel<'_>,
    sources: &[SystematicSource],
    parts: &Parts,
) -> Result<Vec<JointUncertainty>> {
    let level = Level::new(believed.fit.options().confidence)?;
    let of = |j: usize| {
        let h = believed.joints[j];
        if believed.fit.solution().undetermined.contains(&j) {
            return JointUncertainty::default();
        }
        let row = parts.joints.row(j);
        let mean = (row * &parts.mean)[(0, 0)];
        let std = (row * &parts.covariance * row.transpose())[(0, 0)].max(0.0).sqrt();
        let scatter = believed.half_widths[j];
        let total = scatter.map(|s| level.half_width(mean, std.hypot(s / level.quantile())));
        let interval = |w: f64| [Some(1.0 / (h + w)), (h > w).then(|| 1.0 / (h - w))];
        // Beyond the scatter of the readings a negative compliance is a fault of sign or model.
        let explained = scatter.is_some_and(|s| h + s > 0.0);
        let interval = total.filter(|_| explained).map_or([None, None], interval);
        if !believed.has_stiffness(j) {
            return JointUncertainty { interval_nm_per_rad: interval, ..JointUncertainty::default() };
        }
        let largest = sources
            .iter()
            .filter_map(|s| Some((s, s.bounded.get(j).copied().flatten()?)))
            .filter(|(_, bounded)| *bounded > 0.0)
            .max_by(|a, b| a.1.total_cmp(&b.1));
        JointUncertainty {
            statistical: scatter.map(|s| s / h),
            systematic: Some(level.half_width(mean, std) / h),
            total: total.map(|w| w / h),
            interval_nm_per_rad: interval,
            largest_source: largest.map(|(source, _)| source.name.clone()),
        }
    };
    Ok((0..believed.fit.system().springs).map(of).collect())
}

impl SystematicErrors {
    /// Makes estimates, which hold the scatter of the readings, hold all errors. Where these are not known, they
    /// stay what they are.
    pub(crate) fn widen(&self, joints: &mut [JointEstimate]) {
        for ((joint, uncertainty), total) in joints.iter_mut().zip(&self.uncertainty).zip(&self.total) {
            let holds_readings = joint.interval_holds == IntervalHolds::Readings;
            if !holds_readings || uncertainty.interval_nm_per_rad[0].is_none() {
                continue;
            }
            joint.readings_interval = joint.interval;
            joint.readings_standard_error = joint.standard_error;
            joint.interval_holds = IntervalHolds::AllErrors;
            joint.interval = uncertainty.interval_nm_per_rad;
            joint.standard_error = joint.stiffness.zip(*total).map(|(k, part)| k * part);
            joint.judge();
            joint.half_width = uncertainty.total;
        }
    }
}
