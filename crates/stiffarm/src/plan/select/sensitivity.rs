//! Whether a recommended plan still is one when the prior, the postures or the
//! tool points are not quite what was assumed.

use super::global::{GlobalOptions, select};
use crate::error::Result;
use crate::model::cell::Cell;
use crate::numerics::control::Control;
use crate::numerics::streams::run_rng;
use crate::plan::index::{Index, IndexFunction};
use nalgebra::Vector3;
use rand_distr::{Distribution, StandardNormal};
use serde::{Deserialize, Serialize};

/// A plan selected for the changed prior that is better than this (fraction)
/// would change the recommendation.
pub const WORTH_CHANGING: f64 = 0.05;

/// What is assumed about errors, and how much is searched.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct SensitivityOptions {
    /// Factors on the prior stiffness of one joint at a time.
    pub prior_factors: Vec<f64>,
    /// Standard deviation of each joint angle as it is reached \[rad\].
    pub joint_angle_std: f64,
    /// Standard deviation of each coordinate of loading and measuring points \[m\].
    pub tool_point_std: f64,
    /// Random errors drawn.
    pub samples: usize,
    /// Rounds of the selection for each changed prior.
    pub rounds: u64,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Whether the index `prediction` may choose postures that are alike.
    #[serde(default)]
    pub repeats: bool,
}

impl Default for SensitivityOptions {
    fn default() -> Self {
        SensitivityOptions {
            prior_factors: vec![0.5, 2.0],
            joint_angle_std: 0.05_f64.to_radians(),
            tool_point_std: 1e-3,
            samples: 200,
            rounds: 6,
            seed: 1,
            repeats: false,
        }
    }
}

/// One joint's prior stiffness changed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PriorCase {
    /// Name of the joint.
    pub joint: String,
    /// Factor on its prior stiffness.
    pub factor: f64,
    /// The plan's index under the changed prior; `None` where it does not exist.
    pub value: Option<f64>,
    /// The index of a plan selected for the changed prior.
    pub best: Option<f64>,
    /// How much worse the plan is than that one (fraction; 0 where the search
    /// found nothing better).
    pub loss: Option<f64>,
}

/// The index under random errors, relative to the plan's (1 is no change).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Spread {
    /// Mean ratio.
    pub mean: f64,
    /// Worst ratio.
    pub worst: f64,
}

/// How a plan stands up to wrong assumptions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Sensitivity {
    /// The index.
    pub index: Index,
    /// The plan's value as assumed.
    pub value: f64,
    /// Joint by joint and factor by factor; empty where the index has no prior.
    pub priors: Vec<PriorCase>,
    /// Postures that are not quite reached; `None` where an index stopped existing.
    pub postures: Option<Spread>,
    /// Loading and measuring points that are not quite where they were thought.
    pub tool_points: Option<Spread>,
    /// True when some changed prior would make another plan better by more
    /// than [`WORTH_CHANGING`].
    pub would_change: bool,
    /// What was assumed.
    pub options: SensitivityOptions,
}

/// Examines a plan (controller angles, rad; given and selected postures).
///
/// ```
/// # fn main() -> stiffarm::Result<()> {
/// use stiffarm::Control;
/// use stiffarm_files::builtin;
/// use stiffarm::plan::index::Index;
/// use stiffarm::plan::select::{SensitivityOptions, sensitivity};
///
/// let cell = builtin::cell("comau")?;
/// let plan = builtin::postures("comau-group1", &cell.setup.robot)?;
/// let mut options = SensitivityOptions::default();
/// options.prior_factors = vec![2.0];
/// options.rounds = 1;
/// let found = sensitivity(&cell, Index::D, &plan, &options, Control::default())?;
/// assert_eq!(found.priors.len(), 6); // one per joint
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// As [`select`].
pub fn sensitivity<Q: AsRef<[f64]>>(
    cell: &Cell,
    index: Index,
    plan: &[Q],
    options: &SensitivityOptions,
    control: Control<'_>,
) -> Result<Sensitivity> {
    let flat: Vec<f64> = plan.iter().flat_map(|q| q.as_ref().to_vec()).collect();
    let value_in =
        |cell: &Cell, q: &[f64]| -> Result<f64> { Ok(IndexFunction::new(cell, index, plan.len())?.value(q)) };
    let value = value_in(cell, &flat)?;
    let mut priors = Vec::new();
    if let (Some(prior), true) = (&cell.prior, index.needs_prior()) {
        let names = cell.setup.robot.spring_names();
        let of = names.len() * options.prior_factors.len();
        for (j, joint) in names.iter().enumerate() {
            for factor in &options.prior_factors {
                if control.stopped() {
                    break;
                }
                let mut changed = cell.clone();
                let mut k = prior.clone();
                k[j] *= factor;
                changed.prior = Some(k);
                let changed_value = value_in(&changed, &flat)?;
                let search = GlobalOptions {
                    seed: options.seed,
                    rounds: Some(options.rounds),
                    repeats: options.repeats,
                    ..GlobalOptions::default()
                };
                let best = select(&changed, index, plan.len(), &search, control.quiet()).ok().map(|s| s.value);
                let changed_value = changed_value.is_finite().then(|| index.of_log(changed_value));
                priors.push(PriorCase {
                    joint: joint.clone(),
                    factor: *factor,
                    value: changed_value,
                    best,
                    loss: changed_value.zip(best).map(|(changed_value, best)| {
                        if index.larger_is_better() {
                            (best / changed_value - 1.0).max(0.0)
                        } else {
                            (changed_value / best - 1.0).max(0.0)
                        }
                    }),
                });
                control.report("changed priors", priors.len(), of);
            }
        }
    }
    let mut function = IndexFunction::new(cell, index, plan.len())?;
    let postures = spread(options.samples, value, |run| {
        let mut rng = run_rng(options.seed, 0, 0, run);
        let moved: Vec<f64> = flat
            .iter()
            .map(|q| {
                let error: f64 = StandardNormal.sample(&mut rng);
                q + options.joint_angle_std * error
            })
            .collect();
        Ok(function.value(&moved))
    })?;
    let tool_points = spread(options.samples, value, |run| {
        let mut rng = run_rng(options.seed, 1, 0, run);
        let mut error = || {
            let e: [f64; 3] = [(); 3].map(|()| StandardNormal.sample(&mut rng));
            Vector3::from(e) * options.tool_point_std
        };
        let mut moved = cell.clone();
        let tool = &mut moved.setup.tool;
        tool.loading_point += error();
        for point in &mut tool.measuring_points {
            point.position += error();
        }
        value_in(&moved, &flat)
    })?;
    let would_change = priors.iter().any(|case| case.loss.is_none_or(|loss| loss > WORTH_CHANGING));
    Ok(Sensitivity {
        index,
        value: index.of_log(value),
        priors,
        postures,
        tool_points,
        would_change,
        options: options.clone(),
    })
}

/// Mean and worst of the index under errors, relative to ln of the index `value`.
fn spread(samples: usize, value: f64, mut draw: impl FnMut(usize) -> Result<f64>) -> Result<Option<Spread>> {
    let (mut sum, mut worst) = (0.0, 0.0_f64);
    for run in 0..samples {
        // Reciprocal indices are logarithms with the sign turned: larger is worse.
        let ratio = (draw(run)? - value).exp();
        if !ratio.is_finite() {
            return Ok(None);
        }
        sum += ratio;
        worst = worst.max(ratio);
    }
    Ok((samples > 0).then(|| Spread { mean: sum / samples as f64, worst }))
}
