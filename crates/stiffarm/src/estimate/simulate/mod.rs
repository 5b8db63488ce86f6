//! Monte Carlo simulation of an identification with tracker noise, Section IV.A.

mod elastic;
mod model_errors;

pub use elastic::{
    ElasticGroup, ElasticLevel, ElasticModelOutcome, ElasticSimulation, ElasticSimulationOptions, simulate_elastic,
    simulate_elastic_measurements,
};
pub use model_errors::ModelErrors;

use crate::error::{Code, Error, Result};
use crate::estimate::noise::draw_noise;
use crate::findings::{Finding, list};
use crate::model::cell::Cell;
use crate::model::observation::{Rows, observation_matrix};
use crate::model::posture::PostureGroup;
use crate::numerics::control::Control;
use crate::numerics::information::{Factor, whiten_posture};
use crate::numerics::jobs::in_order;
use crate::numerics::sample::{mean, median, standard_error};
use crate::numerics::streams::run_rng;
use crate::plan::check::determinable;
use crate::plan::index::evaluate_for;
use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Where the closed form, first order in Ĥ, is flagged and the median printed.
pub use crate::plan::index::FIRST_ORDER_LIMIT;

/// Options of a simulation; the default is the paper's: six levels of
/// {0.5 … 3.0} times the variance, 200 runs (Table 3).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct SimulationOptions {
    /// Factors on the reading variance, one per noise level.
    pub variance_factors: Vec<f64>,
    /// Runs per group and level.
    pub runs: usize,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Errors of force, angles and geometry; none in the paper.
    #[serde(default)]
    pub model_errors: ModelErrors,
}

impl Default for SimulationOptions {
    fn default() -> Self {
        SimulationOptions {
            variance_factors: vec![0.5, 1.0, 1.5, 2.0, 2.5, 3.0],
            runs: 200,
            seed: 1,
            model_errors: ModelErrors::default(),
        }
    }
}

/// One noise level of one group; vectors have one entry per joint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LevelResult {
    /// Factor on the reading variance.
    pub variance_factor: f64,
    /// Runs made: those asked for, or fewer where the user stopped them.
    pub runs: usize,
    /// Mean of |k̂ − k|/k over the runs made (fraction), Fig. 8: a truncated mean,
    /// because the expectation is infinite at every noise level.
    pub mean_deviation: Vec<f64>,
    /// Monte Carlo standard error of that mean, from the scatter of the runs made.
    pub standard_error: Vec<f64>,
    /// Median of |k̂ − k|/k, which exists at every noise level.
    pub median_deviation: Vec<f64>,
    /// Closed form sqrt(2/π)·σ k_j sqrt([(ΨᵀΨ)⁻¹]_jj), first order.
    pub expected_deviation: Vec<f64>,
    /// Mean of |Ĥ − H|/H over the runs, which the closed form meets exactly.
    pub compliance_mean_deviation: Vec<f64>,
    /// Its Monte Carlo standard error.
    pub compliance_standard_error: Vec<f64>,
    /// True where the relative standard error is above 0.1: read the median.
    pub beyond_first_order: Vec<bool>,
    /// |k̂ − k|/k of the first run, an illustration case as in Table 4.
    pub first_run_deviation: Vec<f64>,
}

/// All levels of one group.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct GroupSimulation {
    /// Name of the group.
    pub name: String,
    /// Names of its postures.
    #[serde(default)]
    pub posture_names: Vec<String>,
    /// Its postures, controller angles \[rad\].
    #[serde(default, rename = "postures_deg", with = "crate::units::degrees")]
    #[cfg_attr(feature = "schema", schemars(with = "Vec<Vec<f64>>"))]
    pub postures: Vec<Vec<f64>>,
    /// Its noise levels.
    pub levels: Vec<LevelResult>,
}

/// Result of a simulation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Simulation {
    /// Names of the joints.
    pub joints: Vec<String>,
    /// Runs per group and level that were asked for.
    pub runs: usize,
    /// True when the user stopped it: some levels have fewer runs.
    pub interrupted: bool,
    /// The groups, in the order given.
    pub groups: Vec<GroupSimulation>,
    /// Joints that the load of the cell leaves out.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub findings: Vec<Finding>,
}

/// Simulates identifications of every group at every noise level.
///
/// Truth is the cell's prior stiffness; each run adds fresh noise to the exact
/// linear displacements and identifies from them. Run r of group g at level l
/// always draws the same numbers, for any number of threads. Stopped, it gives the
/// runs that were made, at least some at every level.
///
/// # Errors
/// No prior, no runs, a negative factor, or a group that cannot determine all
/// joints that the load can (they are named).
pub fn simulate(
    cell: &Cell,
    groups: &[PostureGroup],
    options: &SimulationOptions,
    control: Control<'_>,
) -> Result<Simulation> {
    let (cell, findings) = &determinable(cell.clone());
    let prior = cell.require_prior()?;
    check_amount(options.runs, &options.variance_factors)?;
    let mut jobs = Vec::new();
    for (g, group) in groups.iter().enumerate() {
        check_determined(cell, group)?;
        let psi = observation_matrix(&cell.setup, &group.postures, Rows::Translations)?;
        for (l, factor) in options.variance_factors.iter().enumerate() {
            jobs.push(Job { group: g, level: l, factor: *factor, psi: psi.clone() });
        }
    }
    let total = jobs.len();
    let done = AtomicUsize::new(0);
    let run = |(_, job): (usize, &Job)| {
        let level = simulate_level(cell, &groups[job.group], prior, options, job, control);
        control.report("simulating", done.fetch_add(1, Ordering::Relaxed) + 1, total);
        level
    };
    let levels: Vec<LevelResult> = in_order(&jobs, run)?;
    let per_group = options.variance_factors.len();
    let interrupted = levels.iter().any(|level| level.runs < options.runs);
    Ok(Simulation {
        joints: cell.setup.robot.spring_names(),
        runs: options.runs,
        interrupted,
        groups: groups
            .iter()
            .zip(levels.chunks(per_group))
            .map(|(group, levels)| GroupSimulation {
                name: group.name.clone(),
                posture_names: group.postures.iter().map(|p| p.name.clone()).collect(),
                postures: group.postures.iter().map(|p| p.q.clone()).collect(),
                levels: levels.to_vec(),
            })
            .collect(),
        findings: findings.clone(),
    })
}

/// Refuses a simulation without runs or levels, or with more than there are streams for.
fn check_amount(runs: usize, variance_factors: &[f64]) -> Result<()> {
    let message = if runs == 0 || variance_factors.is_empty() {
        "A simulation needs at least one run and one noise level.".to_string()
    } else if runs > MAX_RUNS || variance_factors.len() > MAX_LEVELS {
        format!("A simulation has at most {MAX_RUNS} runs and {MAX_LEVELS} noise levels.")
    } else if !variance_factors.iter().all(|f| f.is_finite() && *f >= 0.0) {
        "A factor on the noise variance must be 0 or above.".to_string()
    } else {
        return Ok(());
    };
    Err(Error::invalid(message))
}

/// Refuses a group that leaves joints undetermined.
fn check_determined(cell: &Cell, group: &PostureGroup) -> Result<()> {
    let evaluation = evaluate_for(cell, &group.name, &group.postures, None)?;
    if evaluation.undetermined_joints.is_empty() {
        return Ok(());
    }
    Err(Error::new(
        Code::NotIdentifiable,
        format!("\"{}\" cannot determine {}.", group.name, list(&evaluation.undetermined_joints)),
    )
    .hint("evaluate shows which joints each group determines"))
}

/// Largest number of noise levels and of runs whose random numbers stay apart.
const MAX_LEVELS: usize = 1 << 10;
const MAX_RUNS: usize = 1 << 34;
/// Runs of a level that nobody can stop: without any there is no mean.
const AT_LEAST: usize = 20;
/// One noise level of one group.
struct Job {
    group: usize,
    level: usize,
    factor: f64,
    psi: DMatrix<f64>,
}

fn simulate_level(
    cell: &Cell,
    group: &PostureGroup,
    prior: &[f64],
    options: &SimulationOptions,
    job: &Job,
    control: Control<'_>,
) -> Result<LevelResult> {
    let (psi, factor) = (&job.psi, job.factor);
    let n = prior.len();
    let points = cell.setup.tool.point_count();
    let rows = 3 * points;
    let postures = psi.nrows() / rows;
    let noise = cell.noise.with_variance_times(factor);
    let weight = noise.common_weight(points);
    let whiten = |matrix: &mut DMatrix<f64>| {
        if weight > 0.0 {
            for p in 0..postures {
                let mut block = matrix.rows(rows * p, rows).into_owned();
                whiten_posture(&mut block, weight);
                matrix.rows_mut(rows * p, rows).copy_from(&block);
            }
        }
    };
    let mut whitened = psi.clone();
    whiten(&mut whitened);
    let factor_of_psi = Factor::new(&whitened)?;
    let inverse = factor_of_psi.pseudo_inverse(psi.nrows());
    let relative: Vec<f64> = factor_of_psi
        .standard_errors()
        .iter()
        .zip(prior)
        .map(|(e, k)| e.unwrap_or(f64::INFINITY) * k * noise.displacement_std())
        .collect();
    let compliance = DVector::from_iterator(n, prior.iter().map(|k| 1.0 / k));
    let mut deviations = vec![Vec::new(); n];
    let mut compliance_deviations = vec![Vec::new(); n];
    let mut made = 0;
    for run in 0..options.runs {
        if run >= AT_LEAST && control.stopped() {
            break;
        }
        made += 1;
        let mut rng = run_rng(options.seed, job.group, job.level, run);
        let mut error = draw_noise(&mut rng, &noise, postures, points);
        if !options.model_errors.is_exact() {
            error += options.model_errors.draw(cell, &group.postures, &compliance, &mut rng)?;
        }
        let mut error = DMatrix::from_columns(&[error]);
        whiten(&mut error);
        // Ĥ = Ψ⁺(ΨH + ε) = H + Ψ⁺ε: the exact part cancels.
        let shift = &inverse * error;
        for j in 0..n {
            let relative_shift = shift[j] * prior[j];
            compliance_deviations[j].push(relative_shift.abs());
            // |1/Ĥ − k|/k with Ĥ = H(1 + relative shift).
            deviations[j].push((1.0 / (1.0 + relative_shift) - 1.0).abs());
        }
    }
    let mean_deviation: Vec<f64> = deviations.iter().map(|d| mean(d)).collect();
    Ok(LevelResult {
        variance_factor: factor,
        runs: made,
        standard_error: deviations.iter().map(|d| standard_error(d)).collect(),
        median_deviation: deviations.iter().map(|d| median(d)).collect(),
        expected_deviation: relative.iter().map(|e| crate::plan::index::expected_deviation(*e)).collect(),
        compliance_mean_deviation: compliance_deviations.iter().map(|d| mean(d)).collect(),
        compliance_standard_error: compliance_deviations.iter().map(|d| standard_error(d)).collect(),
        beyond_first_order: relative.iter().map(|e| *e > FIRST_ORDER_LIMIT).collect(),
        first_run_deviation: deviations.iter().map(|d| d[0]).collect(),
        mean_deviation,
    })
}
