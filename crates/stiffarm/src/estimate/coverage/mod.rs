//! Do the intervals cover? Many simulated experiments through the estimators
//! themselves, and how often the interval of each joint held the truth.
//!
//! Coverage is counted, not promised. It runs the estimators themselves and the
//! code that makes their intervals; the table it gives is embedded, so a result
//! from an estimator without exact intervals can say what they covered. A
//! number below the table's degrees of freedom is not extrapolated.

mod error_model;
mod table;

pub use error_model::{ErrorModel, Outliers, Truth};
pub use table::{AdverseCoverage, Intervals, MeasuredCoverage, Record, measured, records};

use crate::error::{Code, Error, Result};
use crate::estimate::identify::{
    Estimator, Experiment, IdentifyOptions, JointEstimate, Prepared, Rows, Scale, assumptions, estimates,
    interval_quantile, resampled,
};
use crate::findings::{Finding, list};
use crate::model::cell::Cell;
use crate::model::posture::Posture;
use crate::numerics::control::Control;
use crate::numerics::jobs::in_order;
use crate::numerics::streams::coverage_rng;
use crate::plan::check::determinable;
use rand::RngExt;
use serde::{Deserialize, Serialize};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Experiments of one job: the sums of a job do not depend on threads.
const CHUNK: usize = 250;
/// The same where each experiment is resampled.
const RESAMPLED_CHUNK: usize = 5;
/// Largest number of experiments.
const MAX_EXPERIMENTS: usize = 100_000_000;

/// What is simulated and how it is identified.
#[derive(Debug, Clone, PartialEq)]
pub struct CoverageCase {
    /// How the displacements are identified. Of [`NoiseSource::Repeats`] only
    /// the degrees of freedom count: the scatter is drawn in each experiment.
    ///
    /// [`NoiseSource::Repeats`]: crate::estimate::identify::NoiseSource::Repeats
    pub options: IdentifyOptions,
    /// What the simulated world does that the cell does not say.
    pub world: ErrorModel,
    /// Resamples, where the intervals are those of a bootstrap over postures.
    pub resamples: Option<usize>,
    /// Number of experiments.
    pub experiments: usize,
    /// Seed of the random numbers.
    pub seed: u64,
}

/// How often the intervals of one joint held its true stiffness.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct JointCoverage {
    /// Name of the joint.
    pub name: String,
    /// Share of the experiments whose interval held the truth (fraction).
    pub coverage: f64,
    /// Mean of half the width of the intervals of the compliance over the true
    /// compliance (fraction); `None` where there was none.
    pub relative_half_width: Option<f64>,
    /// Share of the experiments that gave only a lower bound (fraction).
    pub open_above: f64,
    /// Share of the experiments without any interval, for example with a
    /// negative stiffness; they count as not covering (fraction).
    pub without_interval: f64,
}

/// How often the intervals held the truth.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Coverage {
    /// Joint by joint.
    pub joints: Vec<JointCoverage>,
    /// Share of all joints in all experiments (fraction).
    pub coverage: f64,
    /// Monte Carlo standard error of that share, with the joints of one
    /// experiment taken as dependent.
    pub standard_error: f64,
    /// Mean over the joints of their mean relative half-width (fraction);
    /// `None` where a joint has none.
    pub relative_half_width: Option<f64>,
    /// Share of all joints and experiments with only a lower bound (fraction).
    pub open_above: f64,
    /// Share of all joints and experiments without any interval (fraction).
    pub without_interval: f64,
    /// Number of experiments.
    pub experiments: usize,
    /// Degrees of freedom of the intervals; `None` for normal quantiles.
    pub degrees_of_freedom: Option<usize>,
    /// Resamples that a bootstrap skipped, as a share of all (fraction).
    pub skipped: f64,
    /// Joints that the load of the cell leaves out: nothing is counted of them.
    #[serde(default)]
    pub findings: Vec<Finding>,
}

/// Counts of some experiments.
#[derive(Clone)]
struct Counts {
    covered: Vec<u64>,
    open: Vec<u64>,
    missing: Vec<u64>,
    width: Vec<f64>,
    /// Sum and sum of squares of the covered joints of an experiment.
    together: [u64; 2],
    skipped: u64,
}

impl Counts {
    fn new(joints: usize) -> Self {
        Counts {
            covered: vec![0; joints],
            open: vec![0; joints],
            missing: vec![0; joints],
            width: vec![0.0; joints],
            together: [0; 2],
            skipped: 0,
        }
    }

    fn count(&mut self, joints: &[JointEstimate], truth: &[f64]) {
        let mut covered = 0;
        for (j, joint) in joints.iter().enumerate() {
            let k = 1.0 / truth[j];
            let [low, high] = joint.interval;
            match (low, high, joint.compliance) {
                (Some(low), Some(high), _) => {
                    self.width[j] += 0.5 * (1.0 / low - 1.0 / high) * k;
                }
                (Some(low), None, Some(compliance)) => {
                    self.open[j] += 1;
                    self.width[j] += (1.0 / low - compliance) * k;
                }
                _ => self.missing[j] += 1,
            }
            if low.is_some_and(|low| low <= k) && high.is_none_or(|high| k <= high) {
                self.covered[j] += 1;
                covered += 1;
            }
        }
        self.together[0] += covered;
        self.together[1] += covered * covered;
    }

    fn add(&mut self, other: &Counts) {
        for j in 0..self.covered.len() {
            self.covered[j] += other.covered[j];
            self.open[j] += other.open[j];
            self.missing[j] += other.missing[j];
            self.width[j] += other.width[j];
        }
        self.together[0] += other.together[0];
        self.together[1] += other.together[1];
        self.skipped += other.skipped;
    }
}

/// Simulates experiments on `postures` and counts how often the intervals hold
/// the truth, of the springs that the cell's load can determine. Experiment e
/// draws the same numbers for any number of threads and of experiments.
///
/// The displacements are those of the linear model with the cell's noise and
/// what the case's world adds; they are identified by the cell as it stands.
///
/// # Errors
/// No prior stiffness, postures that do not determine each of these joints (they are
/// named), a case that contradicts itself, or as [`crate::estimate::identify::identify`].
pub fn coverage(cell: &Cell, postures: &[Posture], case: &CoverageCase, control: Control<'_>) -> Result<Coverage> {
    if case.experiments == 0 || case.experiments > MAX_EXPERIMENTS {
        let message = format!("Coverage is counted in 1 to {MAX_EXPERIMENTS} experiments.");
        return Err(Error::invalid(message));
    }
    let options = &case.options;
    crate::estimate::identify::check(options)?;
    let (cell, findings) = determinable(cell.clone());
    let cell = &cell;
    let scene = error_model::Scene::new(cell, postures, case)?;
    let experiment = Experiment::new(cell, scene.measured().into())?;
    let system = experiment.system(&options.extra, options.weights)?;
    let prepared = Prepared::new(&system, options.estimator)?;
    let blind = prepared.whitened().factor().undetermined();
    if !blind.is_empty() {
        let names: Vec<&str> = blind.iter().map(|j| system.unknowns[*j].as_str()).collect();
        let message = format!("These postures cannot determine {}.", list(&names));
        return Err(Error::new(Code::NotIdentifiable, message));
    }
    let assumed = assumptions(cell, options)?;
    // Student's quantile depends on Ψ only, and is dear.
    let first = prepared.solve(&scene.exact(&system), &assumed)?;
    let quantile = interval_quantile(&first, options.confidence)?;
    let degrees_of_freedom = first.t_degrees_of_freedom;

    let chunk = match case.resamples {
        Some(_) => RESAMPLED_CHUNK,
        None => CHUNK,
    };
    let starts: Vec<usize> = (0..case.experiments).step_by(chunk).collect();
    let done = AtomicUsize::new(0);
    let parts = in_order(&starts, |(_, start)| {
        if control.stopped() {
            return Err(Error::new(Code::Interrupted, "The simulation was stopped."));
        }
        let mut counts = Counts::new(system.springs);
        for experiment in *start..(start + chunk).min(case.experiments) {
            let mut rng = coverage_rng(case.seed, experiment);
            let truth = scene.truth(&mut rng);
            let delta = scene.displacements(&system, &truth, &mut rng)?;
            if let Some(resamples) = case.resamples {
                let rows = Rows {
                    system: &system,
                    prepared: &prepared,
                    assumed: &assumed,
                    control: Control { progress: None, ..control },
                };
                let all = prepared.solve(&delta, &assumed)?;
                let (seed, level) = (rng.random(), options.confidence);
                let bootstrap = resampled(&rows, &delta, &all, resamples, seed, level)?;
                counts.skipped += bootstrap.skipped as u64;
                counts.count(&bootstrap.joints, &truth);
                continue;
            }
            let mut with_scatter = assumed.clone();
            if let Scale::Repeats { sigma, degrees_of_freedom } = &mut with_scatter.scale {
                *sigma = scene.scatter(*degrees_of_freedom, &mut rng);
            }
            let solution = prepared.solve(&delta, &with_scatter)?;
            let quantile = if solution.t_degrees_of_freedom == degrees_of_freedom {
                quantile
            } else {
                interval_quantile(&solution, options.confidence)?
            };
            let joints = estimates(&system.unknowns, 0..system.springs, &solution, quantile);
            counts.count(&joints, &truth);
        }
        let now = done.fetch_add(1, Ordering::Relaxed) + 1;
        control.report("counting coverage", now, starts.len());
        Ok(counts)
    })?;
    let mut counts = Counts::new(system.springs);
    for part in &parts {
        counts.add(part);
    }
    let degrees_of_freedom = match case.resamples {
        Some(_) => Some(system.shifts().min(system.psi.nrows()) - first.factor.rank()),
        None => degrees_of_freedom,
    };
    Ok(Coverage { findings, ..shares(&system.unknowns, &counts, case, degrees_of_freedom) })
}

fn shares(names: &[String], counts: &Counts, case: &CoverageCase, degrees_of_freedom: Option<usize>) -> Coverage {
    let experiments = case.experiments as f64;
    let springs = counts.covered.len();
    let joints: Vec<JointCoverage> = (0..springs)
        .map(|j| JointCoverage {
            name: names[j].clone(),
            coverage: counts.covered[j] as f64 / experiments,
            relative_half_width: (counts.missing[j] < case.experiments as u64)
                .then(|| counts.width[j] / (experiments - counts.missing[j] as f64)),
            open_above: counts.open[j] as f64 / experiments,
            without_interval: counts.missing[j] as f64 / experiments,
        })
        .collect();
    let mean =
        |value: &dyn Fn(&JointCoverage) -> f64| -> f64 { joints.iter().map(value).sum::<f64>() / springs as f64 };
    let widths: Option<Vec<f64>> = joints.iter().map(|j| j.relative_half_width).collect();
    // Variance of the number of covered joints of an experiment. Where all experiments are alike, the standard error is
    // that with four experiments more, half of them otherwise (Agresti and Coull 1998,
    // doi:10.1080/00031305.1998.10480550).
    let [sum, squares] = counts.together.map(|v| v as f64);
    let variance = (squares / experiments - (sum / experiments).powi(2)).max(0.0);
    let standard_error = match variance {
        0.0 => (2.0 * (experiments + 2.0)).sqrt() / (experiments + 4.0).powf(1.5),
        variance => (variance / experiments).sqrt() / springs as f64,
    };
    let resamples = case.resamples.unwrap_or(0).max(1) as f64;
    Coverage {
        coverage: mean(&|j| j.coverage),
        standard_error,
        relative_half_width: widths.map(|w| w.iter().sum::<f64>() / springs as f64),
        open_above: mean(&|j| j.open_above),
        without_interval: mean(&|j| j.without_interval),
        experiments: case.experiments,
        degrees_of_freedom,
        skipped: counts.skipped as f64 / (experiments * resamples),
        joints,
        findings: Vec::new(),
    }
}
