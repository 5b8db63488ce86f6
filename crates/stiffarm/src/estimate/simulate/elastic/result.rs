//! What an elastic simulation is asked and gives.

use crate::estimate::elastic::ElasticChoice;
use crate::findings::{Finding, length, percent};
use crate::model::elastic::{ElasticSizes, ElasticSource};
use serde::{Deserialize, Serialize};

/// Options of an elastic simulation, and of its result.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(rename = "Options"))]
#[non_exhaustive]
pub struct ElasticSimulationOptions {
    /// Factors on the cell's variance.
    #[serde(rename = "levels")]
    pub variance_factors: Vec<f64>,
    /// Runs per group and level.
    pub runs: usize,
    /// Seed of the random numbers.
    #[serde(skip)]
    pub seed: u64,
    /// The model beside the joint axes alone: `mixed`, or none with `axes`.
    pub elastic: ElasticChoice,
}

impl Default for ElasticSimulationOptions {
    fn default() -> Self {
        ElasticSimulationOptions { variance_factors: vec![1.0], runs: 100, seed: 1, elastic: ElasticChoice::Mixed }
    }
}

/// How well one elastic model did over the runs; vectors have one entry per joint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ElasticModelOutcome {
    /// Mean of |k̂ − k|/k (fraction): a truncated mean, as the expectation is infinite.
    pub mean_deviation: Vec<f64>,
    /// Monte Carlo standard error of that mean.
    pub standard_error: Vec<f64>,
    /// Median of |k̂ − k|/k.
    pub median_deviation: Vec<f64>,
    /// Share of the intervals of k that hold the true stiffness; `None` without intervals.
    pub interval_share: Vec<Option<f64>>,
    /// RMS error of a predicted deflection, over runs and places of work \[m\].
    pub prediction_rms_m: f64,
    /// Monte Carlo standard error of that RMS \[m\].
    pub prediction_standard_error_m: f64,
    /// Share of the components of deflections that lie inside their bands; `None` without
    /// bands.
    pub band_share: Option<f64>,
    /// Confidence of intervals and bands.
    pub confidence: f64,
}

impl ElasticModelOutcome {
    /// Share of all intervals of k that hold, where there are any.
    pub fn mean_interval_share(&self) -> Option<f64> {
        let shares: Vec<f64> = self.interval_share.iter().copied().flatten().collect();
        (!shares.is_empty()).then(|| shares.iter().sum::<f64>() / shares.len() as f64)
    }
}

/// One noise level of one group.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ElasticLevel {
    /// Factor on the reading variance.
    pub variance_factor: f64,
    /// Runs made: those asked for, or fewer where the user stopped them.
    pub runs: usize,
    /// RMS of the true deflections that are predicted \[m\].
    pub deflection_rms_m: f64,
    /// The index `prediction` of the group at this noise: what the RMS error of a predicted
    /// deflection would be with the mixed model, if the sizes of what gives way and of the
    /// noise were known \[m\]. `None` where it does not exist.
    pub expected_prediction_m: Option<f64>,
    /// With the joint axes alone.
    pub axes: ElasticModelOutcome,
    /// With the mixed model, where it was asked for.
    pub mixed: Option<ElasticModelOutcome>,
    /// Runs whose data do not carry the mixed model: the axes stand in for it.
    pub without_mixed: usize,
}

/// All levels of one group.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ElasticGroup {
    /// Name of the group.
    pub name: String,
    /// Names of its postures.
    pub posture_names: Vec<String>,
    /// Its postures, controller angles \[rad\].
    #[serde(rename = "postures_deg", with = "crate::units::degrees")]
    #[cfg_attr(feature = "schema", schemars(with = "Vec<Vec<f64>>"))]
    pub postures: Vec<Vec<f64>>,
    /// Its noise levels.
    pub levels: Vec<ElasticLevel>,
}

/// Result of an elastic simulation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ElasticSimulation {
    /// Names of the joints.
    pub joints: Vec<String>,
    /// What was asked for.
    pub asked: ElasticChoice,
    /// Standard deviations from which the springs beyond the axes were drawn.
    pub sizes: ElasticSizes,
    /// Whether the cell declares them or they are typical.
    pub sizes_from: ElasticSource,
    /// Deflections predicted in each run.
    pub predicted_count: usize,
    /// True where these are the cell's tasks; else they are at random postures inside its
    /// limits, always the same, under its load.
    pub predicted_tasks: bool,
    /// Runs per group and level that were asked for.
    pub runs: usize,
    /// True when the user stopped it: there are fewer runs.
    pub interrupted: bool,
    /// The groups, in the order given.
    pub groups: Vec<ElasticGroup>,
    /// Joints that the load of the cell leaves out.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub findings: Vec<Finding>,
}

impl ElasticSimulation {
    /// What it comes to, in a sentence or two, at the first noise level.
    pub fn verdict(&self) -> String {
        let first = |group: &ElasticGroup| group.levels.first().cloned();
        let all: Vec<(&str, ElasticLevel)> =
            self.groups.iter().filter_map(|g| Some((g.name.as_str(), first(g)?))).collect();
        let prediction_rms = |level: &ElasticLevel| {
            let model = level.mixed.as_ref().unwrap_or(&level.axes);
            model.prediction_rms_m
        };
        let best = all.iter().min_by(|a, b| prediction_rms(&a.1).total_cmp(&prediction_rms(&b.1)));
        let Some((name, level)) = best else {
            return String::new();
        };
        let from = match all.len() {
            1 => format!("From \"{name}\""),
            _ => format!("From \"{name}\", the best of these groups,"),
        };
        let axes = &level.axes;
        let by_axes = format!("{} with the joint axes alone", length(axes.prediction_rms_m));
        let Some(mixed) = &level.mixed else {
            return format!("{from} deflections of {} are predicted to {by_axes}.", length(level.deflection_rms_m));
        };
        let mut out = format!(
            "{from} deflections of {} are predicted to {} with the mixed model and to {by_axes}.",
            length(level.deflection_rms_m),
            length(mixed.prediction_rms_m),
        );
        let held = (axes.mean_interval_share(), mixed.mean_interval_share());
        if let (Some(axes_hold), Some(mixed_hold)) = held {
            out += &format!(
                " The {:.0} % intervals of joint stiffness hold the true one in {} of the cases with the axes alone, \
                 in {} with the mixed model.",
                100.0 * axes.confidence,
                percent(axes_hold),
                percent(mixed_hold)
            );
        }
        out
    }
}
