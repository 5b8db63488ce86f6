//! Monte Carlo of identifications of an arm that gives way beyond its joint axes.
//!
//! The truth of each run has the cell's prior stiffness about the joint axes, and
//! springs at joints and base whose entries are drawn as the mixed model takes them to
//! scatter: N(0, ω²) with the sizes ω that the cell declares, else typical ones. Its
//! displacements follow from the linear model y = Ψ h + B u + ε. Each run is identified
//! with the joint axes alone and with the mixed model, and both predict deflections at
//! work.

mod result;
mod truth;

pub use result::{ElasticGroup, ElasticLevel, ElasticModelOutcome, ElasticSimulation, ElasticSimulationOptions};

use super::{check_amount, check_determined};
use crate::error::{Code, Error, Result};
use crate::estimate::compliance::IdentifiedCompliance;
use crate::estimate::elastic::{ElasticChoice, carried};
use crate::estimate::identify::{Fit, IdentifyOptions, estimate};
use crate::estimate::noise::draw_noise;
use crate::estimate::validate::simulate_measurements;
use crate::model::cell::Cell;
use crate::model::measurement::MeasuredPosture;
use crate::model::posture::{Posture, PostureGroup};
use crate::model::stiffness::Model;
use crate::numerics::control::Control;
use crate::numerics::jobs::in_order;
use crate::numerics::sample::{mean, median, standard_error};
use crate::numerics::streams::run_rng;
use crate::plan::check::determinable;
use crate::plan::index::posture_terms;
use crate::plan::index::prediction::PredictionModel;
use nalgebra::DVector;
use std::sync::atomic::{AtomicUsize, Ordering};
use truth::{Group, Predicted, Truth, Work};

/// Runs of a level that nobody can stop: without any there is no mean.
const AT_LEAST: usize = 3;
/// Runs of each level between two looks at whether to stop for good.
const PORTION: usize = 16;
/// Group and level whose streams are those of simulated measurements.
const MEASUREMENTS: (usize, usize) = (1 << 16, 1);

/// Simulates identifications of every group at every noise level on arms that give way
/// beyond their joint axes.
///
/// Run r of group g at level l always draws the same numbers, for any number of threads:
/// first the noise, as [`simulate`](super::simulate()) does, then the springs. Stopped, it
/// gives the runs that were made, at least some at every level.
///
/// ```
/// # fn main() -> stiffarm::Result<()> {
/// use stiffarm::estimate::simulate::{ElasticSimulationOptions, simulate_elastic};
/// use stiffarm::{Control, PostureGroup};
/// use stiffarm_files::builtin;
///
/// let cell = builtin::cell("comau")?;
/// let postures = builtin::postures("comau-group1", &cell.setup.robot)?;
/// let group = PostureGroup { name: "Group 1".to_string(), postures };
/// let mut options = ElasticSimulationOptions::default();
/// options.runs = 4;
/// let simulation = simulate_elastic(&cell, &[group], &options, Control::default())?;
/// println!("{}", simulation.verdict());
/// # assert!(simulation.groups[0].levels[0].mixed.is_some());
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// No prior, no runs, a negative factor, a group that cannot determine all joints (they
/// are named); nothing to predict.
pub fn simulate_elastic(
    cell: &Cell,
    groups: &[PostureGroup],
    options: &ElasticSimulationOptions,
    control: Control<'_>,
) -> Result<ElasticSimulation> {
    let (cell, findings) = &determinable(cell.clone());
    cell.require_prior()?;
    check_amount(options.runs, &options.variance_factors)?;
    let (sizes, sizes_from) = cell.elastic_sizes()?;
    for group in groups {
        check_determined(cell, group)?;
    }
    let truth = Truth::new(cell, &sizes)?;
    let work = Work::new(cell)?;
    let all = groups.iter().map(|group| Group::new(cell, &group.postures));
    let experiment = Experiment {
        cells: options.variance_factors.iter().map(|factor| noisier(cell, *factor)).collect(),
        groups: all.collect::<Result<_>>()?,
        truth,
        work,
        options,
    };
    let all_runs = experiment.all_runs(control)?;
    let levels = options.variance_factors.len();
    let mut out = Vec::with_capacity(groups.len());
    let mut all_runs = all_runs.into_iter();
    for group in groups {
        let level_runs = all_runs.by_ref().take(levels).zip(&experiment.cells);
        let of = |((runs, cell), factor): ((Vec<Run>, &Cell), &f64)| {
            let expected = expected_prediction(cell, group);
            summary(&runs, *factor, expected, options.elastic)
        };
        out.push(ElasticGroup {
            name: group.name.clone(),
            posture_names: group.postures.iter().map(|p| p.name.clone()).collect(),
            postures: group.postures.iter().map(|p| p.q.clone()).collect(),
            levels: level_runs.zip(&options.variance_factors).map(of).collect(),
        });
    }
    let fewest = out.iter().flat_map(|g| &g.levels).map(|l| l.runs).min();
    Ok(ElasticSimulation {
        joints: cell.setup.robot.spring_names(),
        asked: options.elastic,
        sizes,
        sizes_from,
        predicted_count: experiment.work.count(),
        predicted_tasks: !cell.tasks.is_empty(),
        runs: options.runs,
        interrupted: fewest.is_some_and(|runs| runs < options.runs),
        groups: out,
        findings: findings.clone(),
    })
}

/// Simulated measurements of `postures` on one arm that gives way beyond its joint axes:
/// those of [`simulate_measurements`] with the prior stiffness by the exact model, and what
/// springs drawn from `seed` add to first order.
///
/// # Errors
/// No prior; as [`simulate_measurements`].
pub fn simulate_elastic_measurements(cell: &Cell, postures: &[Posture], seed: u64) -> Result<Vec<MeasuredPosture>> {
    let truth = Truth::new(cell, &cell.elastic_sizes()?.0)?;
    let model = Model::Equilibrium;
    let mut out = simulate_measurements(cell, postures, &truth.prior, model, seed, 0)?;
    let (group, level) = MEASUREMENTS;
    let mut drawn = truth.draw(&mut run_rng(seed, group, level, 0));
    // The axes are in the measurements already.
    drawn.rows_mut(0, truth.prior.len()).fill(0.0);
    let bent = Group::new(cell, postures)?.bent(&drawn);
    let values = out.iter_mut().flat_map(|m| &mut m.displacements);
    for (displacement, more) in values.zip(bent) {
        displacement.value += more;
    }
    Ok(out)
}

/// The cell with `factor` times the reading variance.
fn noisier(cell: &Cell, factor: f64) -> Cell {
    Cell { noise: cell.noise.with_variance_times(factor), ..cell.clone() }
}

fn expected_prediction(cell: &Cell, group: &PostureGroup) -> Option<f64> {
    // The index does not exist without noise.
    let model = PredictionModel::alike(cell, &cell.elastic_sizes().ok()?.0).ok()?;
    model.value(&posture_terms(cell, &group.postures).ok()?)
}

/// Everything that the runs share.
struct Experiment<'a> {
    /// The cell at each noise level.
    cells: Vec<Cell>,
    groups: Vec<Group>,
    truth: Truth,
    work: Work,
    options: &'a ElasticSimulationOptions,
}

/// One run.
struct Run {
    /// Mean square of the true deflections \[m²\].
    deflection: f64,
    axes: Outcome,
    mixed: Option<Outcome>,
}

/// One model in one run.
struct Outcome {
    /// |k̂ − k|/k.
    deviations: Vec<f64>,
    /// Whether each interval of k holds.
    holds: Vec<Option<bool>>,
    predicted: Predicted,
}

impl Experiment<'_> {
    /// The runs of every group and level, group by group.
    fn all_runs(&self, control: Control<'_>) -> Result<Vec<Vec<Run>>> {
        let (levels, runs) = (self.cells.len(), self.options.runs);
        let series: Vec<(usize, usize)> =
            (0..self.groups.len()).flat_map(|group| (0..levels).map(move |level| (group, level))).collect();
        let total = series.len() * runs;
        let done = AtomicUsize::new(0);
        let mut out: Vec<Vec<Run>> = series.iter().map(|_| Vec::new()).collect();
        let mut start = 0;
        while start < runs && !(start >= AT_LEAST && control.stopped()) {
            let end = runs.min(start + PORTION);
            let jobs: Vec<(usize, usize)> =
                (start..end).flat_map(|run| (0..series.len()).map(move |s| (s, run))).collect();
            let portion = in_order(&jobs, |(_, &(s, run))| {
                if run >= AT_LEAST && control.stopped() {
                    return Ok(None);
                }
                let made = self.run(series[s].0, series[s].1, run)?;
                let so_far = done.fetch_add(1, Ordering::Relaxed) + 1;
                control.report("simulating", so_far, total);
                Ok(Some(made))
            })?;
            for ((s, _), made) in jobs.into_iter().zip(portion) {
                out[s].extend(made);
            }
            start = end;
        }
        Ok(out)
    }

    fn run(&self, group: usize, level: usize, run: usize) -> Result<Run> {
        let cell = &self.cells[level];
        let mut rng = run_rng(self.options.seed, group, level, run);
        let group = &self.groups[group];
        let (postures, points) = group.size();
        let noise = draw_noise(&mut rng, &cell.noise, postures, points);
        let compliance = self.truth.draw(&mut rng);
        let measured = group.measured(&compliance, &noise);
        let fit = Fit::new(cell, measured, &IdentifyOptions::default())?;
        let confidence = fit.options().confidence;
        let by_axes = IdentifiedCompliance::from_solution(fit.system(), fit.solution(), confidence);
        let truth = self.truth.reproduced.of(&compliance);
        let outcome = |predictor: &IdentifiedCompliance| self.outcome(predictor, &compliance, &truth);
        let mixed = match self.options.elastic {
            ElasticChoice::Axes => None,
            ElasticChoice::Mixed => carried(&fit)?.ok(),
        };
        Ok(Run {
            deflection: self.work.square(&compliance),
            axes: outcome(&by_axes)?,
            mixed: mixed.map(|m| outcome(m.compliance())).transpose()?,
        })
    }

    fn outcome(
        &self,
        predictor: &IdentifiedCompliance,
        compliance: &DVector<f64>,
        truth: &DVector<f64>,
    ) -> Result<Outcome> {
        let spread = predictor.spread.as_ref();
        let scatter = match spread {
            Some(spread) => Some((spread, spread.quantiles()?)),
            None => None,
        };
        let mut deviations = Vec::with_capacity(self.truth.prior.len());
        let mut holds = Vec::with_capacity(self.truth.prior.len());
        // The axes alone are what reproduces the arm; a mixed model is to be reproduced.
        let is_mixed = predictor.values.len() > truth.len();
        let reproduced = Some(&self.truth.reproduced).filter(|_| is_mixed);
        let values = reproduced.map_or(predictor.values.clone(), |r| r.of(&predictor.values));
        for (j, h) in truth.iter().enumerate() {
            let (value, k) = (values[j], 1.0 / h);
            let deviation = (1.0 / (value * k) - 1.0).abs();
            if !deviation.is_finite() {
                return Err(Error::new(Code::Numerical, "A stiffness came out infinite in a simulated run.")
                    .hint("give more postures, or less noise"));
            }
            deviations.push(deviation);
            // An interval on the wrong side of zero does not hold either.
            let held = scatter.as_ref().map(|(spread, all)| {
                let (with, variance) = match reproduced {
                    Some(reproduced) => reproduced.covariance(spread, j),
                    None => (spread.covariance.column(j).into_owned(), spread.covariance[(j, j)].max(0.0)),
                };
                let quantile = all.of(&with, variance, 0.0);
                let error = Some(variance.sqrt());
                let [low, high] = estimate("", Some(value), error, Some(quantile)).interval;
                low.is_some_and(|low| low <= k) && high.is_none_or(|high| k <= high)
            });
            holds.push(held);
        }
        Ok(Outcome {
            deviations,
            holds,
            predicted: self.work.predicted(&predictor.values, scatter.as_ref(), compliance)?,
        })
    }
}

fn summary(runs: &[Run], factor: f64, expected: Option<f64>, choice: ElasticChoice) -> ElasticLevel {
    let axes: Vec<&Outcome> = runs.iter().map(|run| &run.axes).collect();
    let mixed: Vec<&Outcome> = runs.iter().map(|run| run.mixed.as_ref().unwrap_or(&run.axes)).collect();
    let deflections: Vec<f64> = runs.iter().map(|run| run.deflection).collect();
    let has_mixed = choice != ElasticChoice::Axes;
    let without = runs.iter().filter(|run| run.mixed.is_none()).count();
    ElasticLevel {
        variance_factor: factor,
        runs: runs.len(),
        deflection_rms_m: mean(&deflections).sqrt(),
        expected_prediction_m: expected,
        axes: over_runs(&axes),
        mixed: has_mixed.then(|| over_runs(&mixed)),
        without_mixed: if has_mixed { without } else { 0 },
    }
}

fn over_runs(all: &[&Outcome]) -> ElasticModelOutcome {
    let joints = all.first().map_or(0, |o| o.deviations.len());
    let of_joint = |j: usize| all.iter().map(|o| o.deviations[j]).collect::<Vec<f64>>();
    let each = |of: &dyn Fn(&[f64]) -> f64| (0..joints).map(|j| of(&of_joint(j))).collect();
    let share = |held: Vec<f64>| (!held.is_empty()).then(|| mean(&held));
    let holds = |j: usize| {
        let intervals = all.iter().filter_map(|o| o.holds[j]);
        share(intervals.map(|held| f64::from(u8::from(held))).collect())
    };
    let squares: Vec<f64> = all.iter().map(|o| o.predicted.square).collect();
    let rms = mean(&squares).sqrt();
    ElasticModelOutcome {
        mean_deviation: each(&mean),
        standard_error: each(&standard_error),
        median_deviation: each(&median),
        interval_share: (0..joints).map(holds).collect(),
        prediction_rms_m: rms,
        // To first order: the error of a root is that of its square over twice the root.
        prediction_standard_error_m: if rms > 0.0 { standard_error(&squares) / (2.0 * rms) } else { 0.0 },
        band_share: share(all.iter().filter_map(|o| o.predicted.inside).collect()),
        confidence: IdentifyOptions::default().confidence,
    }
}
