//! What is simulated.

use crate::page::{BESIDE, EXACT, INEXACT, TWO_VARIANCE};
use nalgebra::Vector3;
use stiffarm::Control;
use stiffarm::error::Result;
use stiffarm::estimate::coverage::{CoverageCase, ErrorModel, Intervals, Outliers, Truth};
use stiffarm::estimate::identify::{Estimator, IdentifyOptions, NoiseSource, Weights};
use stiffarm::estimate::simulate::ModelErrors;
use stiffarm::internals::optimise::Options;
use stiffarm::model::cell::Cell;
use stiffarm::model::instruments::TrackerAccuracy;
use stiffarm::model::measurement::ReadingScatter;
use stiffarm::model::posture::PostureGroup;
use stiffarm::plan::index::Index;
use stiffarm::plan::select::{StartKind, random_group, select_from};
use stiffarm_files::builtin;

/// One row of the page before it is simulated.
pub struct Row {
    pub table: &'static str,
    pub situation: String,
    pub intervals: Option<Intervals>,
    pub adverse: bool,
    pub cell: Cell,
    pub group: PostureGroup,
    pub case: CoverageCase,
}

/// Experiments of a row, and of one that no claim hangs on.
const EXPERIMENTS: usize = 50_000;
const FEWER: usize = 20_000;
/// Experiments of a bootstrap, and its resamples.
const BOOTSTRAPPED: usize = 500;
const RESAMPLES: usize = 400;

/// Seed of the postures and of the first row.
const SEED: u64 = 2021;

/// The cell that all rows start from, and groups of postures drawn in it.
pub struct Bench {
    cell: Cell,
}

impl Bench {
    pub fn new() -> Result<Self> {
        let mut cell = builtin::cell("comau")?;
        // A displacement is a difference of two readings.
        cell.noise.readings_per_displacement = 2;
        Ok(Bench { cell })
    }

    /// The cell with the first `points` measuring points.
    fn cell(&self, points: usize) -> Cell {
        let mut cell = self.cell.clone();
        cell.setup.tool.measuring_points.truncate(points);
        cell
    }

    /// Random postures.
    fn random(&self, count: usize) -> Result<PostureGroup> {
        let angles = random_group(&self.cell, StartKind::Uniform, count, SEED, count as u64)?;
        Ok(PostureGroup::from_angles("random", angles))
    }

    /// Postures selected for the smallest expected error.
    fn selected(&self, count: usize) -> Result<PostureGroup> {
        let start = random_group(&self.cell, StartKind::Uniform, count, SEED, count as u64)?;
        let control = Control::default();
        let plan = select_from(&self.cell, Index::ExpectedError, &start, Options::default(), control)?;
        Ok(plan.to_group("selected"))
    }

    /// All rows, in the order of the page.
    pub fn rows(&self) -> Result<Vec<Row>> {
        let mut rows = Vec::new();
        self.exact(&mut rows)?;
        self.two_variance(&mut rows)?;
        self.inexact(&mut rows)?;
        self.beside(&mut rows)?;
        for (i, row) in rows.iter_mut().enumerate() {
            row.case.seed = SEED + i as u64;
        }
        Ok(rows)
    }

    fn row(&self, table: &'static str, estimator: Estimator, group: &PostureGroup, points: usize) -> Row {
        Row {
            table,
            situation: String::new(),
            intervals: None,
            adverse: false,
            cell: self.cell(points),
            group: group.clone(),
            case: CoverageCase {
                options: {
                    let mut options = IdentifyOptions::default();
                    options.estimator = estimator;
                    options
                },
                world: ErrorModel::default(),
                resamples: None,
                experiments: EXPERIMENTS,
                seed: SEED,
            },
        }
    }

    fn exact(&self, rows: &mut Vec<Row>) -> Result<()> {
        for (count, points, dof) in [(3, 1, 3), (4, 1, 6), (6, 1, 12), (6, 4, 66)] {
            let group = self.random(count)?;
            let mut add = |situation: &str, estimator, edit: &dyn Fn(&mut Row)| {
                let mut row = self.row(EXACT, estimator, &group, points);
                row.situation = situation.to_string();
                edit(&mut row);
                rows.push(row);
            };
            add("ordinary, noise from the residuals", Estimator::Ordinary, &|_| ());
            add(
                "weighted, noise from the residuals; a posture's points share a shift as large as the noise, and the cell says so",
                Estimator::Weighted,
                &|row| {
                    row.case.world.common_ratio = 1.0;
                    row.cell.noise.posture_common_std = row.cell.noise.displacement_std();
                },
            );
            add("weighted, three loads against one unloaded reading", Estimator::Weighted, &|row| {
                row.case.world.load_states = THREE.to_vec();
            });
            add("ordinary, noise known", Estimator::Ordinary, &|row| {
                row.case.options.noise = NoiseSource::Known;
            });
            add("ordinary, noise from repeats", Estimator::Ordinary, &|row| {
                row.case.options.noise = NoiseSource::Repeats;
                row.case.options.scatter = Some(ReadingScatter {
                    reading_std_m: row.cell.noise.reading_variance.sqrt(),
                    degrees_of_freedom: dof,
                });
            });
        }
        Ok(())
    }

    fn two_variance(&self, rows: &mut Vec<Row>) -> Result<()> {
        for count in [6, 12] {
            for group in [self.random(count)?, self.selected(count)?] {
                for ratio in RATIOS {
                    let mut row = self.row(TWO_VARIANCE, Estimator::TwoVariance, &group, 4);
                    row.case.world.common_ratio = ratio;
                    row.situation = format!("{} postures, τ/σ = {ratio}", group.name);
                    rows.push(row);
                }
            }
            let group = self.random(count)?;
            for ratio in RATIOS {
                let mut row = self.row(TWO_VARIANCE, Estimator::TwoVariance, &group, 4);
                row.case.world.common_ratio = ratio;
                row.case.world.load_states = THREE.to_vec();
                row.situation = format!("random postures, three loads against one unloaded reading, τ/σ = {ratio}");
                rows.push(row);
            }
        }
        Ok(())
    }

    fn inexact(&self, rows: &mut Vec<Row>) -> Result<()> {
        let first = rows.len();
        for (count, points) in [(4, 1), (6, 1), (12, 1), (6, 4)] {
            let group = self.random(count)?;
            let mut row = self.row(INEXACT, Estimator::Huber, &group, points);
            row.intervals = Some(Intervals::Huber);
            row.situation = "normal errors".to_string();
            rows.push(row);
            let mut row = self.row(INEXACT, Estimator::Huber, &group, points);
            row.intervals = Some(Intervals::Huber);
            row.adverse = true;
            row.situation = "5 % of the displacements with thirty times the error".to_string();
            row.case.world.outliers = Some(Outliers { share: 0.05, size: 30.0 });
            rows.push(row);
        }
        for count in [4, 6, 12] {
            let group = self.random(count)?;
            let mut row = self.row(INEXACT, Estimator::NonNegative, &group, 4);
            row.intervals = Some(Intervals::NonNegative);
            row.case.world.common_ratio = 1.0;
            row.situation = "all compliances well above zero, τ/σ = 1".to_string();
            rows.push(row);
            let mut row = self.row(INEXACT, Estimator::NonNegative, &group, 4);
            row.intervals = Some(Intervals::NonNegative);
            row.adverse = true;
            row.case.world.common_ratio = 1.0;
            row.case.world.stiffness_factors = vec![1.0, 1.0, 1.0, 100.0, 1.0, 1.0];
            row.situation = "joint 4 a hundred times stiffer, τ/σ = 1".to_string();
            rows.push(row);
        }
        for count in [4, 6, 12] {
            let group = self.random(count)?;
            for (truth, adverse, words) in [
                (Truth::Drawn, false, "truth drawn from the prior"),
                (Truth::Off(2.0), true, "truth two standard deviations off the prior"),
            ] {
                let mut row = self.row(INEXACT, Estimator::Prior, &group, 4);
                row.intervals = Some(Intervals::Prior);
                row.adverse = adverse;
                row.case.world.truth = truth;
                row.case.world.common_ratio = 1.0;
                // Else the data leave the prior nothing to say.
                row.cell.noise.reading_variance *= 100.0;
                row.situation = format!("{words}, noise ten times the cell's, τ/σ = 1");
                rows.push(row);
            }
        }
        for row in &mut rows[first..] {
            row.case.experiments = FEWER;
        }
        for count in [6, 12] {
            for (group, adverse) in [(self.random(count)?, false), (self.selected(count)?, true)] {
                let mut row = self.row(INEXACT, Estimator::TwoVariance, &group, 4);
                row.intervals = Some(Intervals::Bootstrap);
                row.adverse = adverse;
                row.case.world.common_ratio = 1.0;
                row.case.resamples = Some(RESAMPLES);
                row.case.experiments = BOOTSTRAPPED;
                row.situation = format!("{} postures, τ/σ = 1", group.name);
                rows.push(row);
            }
        }
        Ok(())
    }

    fn beside(&self, rows: &mut Vec<Row>) -> Result<()> {
        let group = self.random(6)?;
        for (estimator, name) in [(Estimator::TwoVariance, "two-variance"), (Estimator::Ordinary, "ordinary")] {
            let exact = ModelErrors::default();
            let errors = [
                ("force of each posture wrong by 1 %", ModelErrors { force_per_posture: 0.01, ..exact }),
                ("force scale wrong by 1 %", ModelErrors { force_scale: 0.01, ..exact }),
                ("loading point wrong by 1 mm in each coordinate", ModelErrors { loading_point_m: 1e-3, ..exact }),
            ];
            for (words, model_errors) in errors {
                let mut row = self.row(BESIDE, estimator, &group, 4);
                row.case.world.model_errors = model_errors;
                row.case.experiments = FEWER;
                row.situation = format!("{name}: {words}");
                rows.push(row);
            }
            let mut row = self.row(BESIDE, estimator, &group, 4);
            row.case.world.lost_motion_rad = 0.1_f64.to_radians() / 60.0;
            row.case.experiments = FEWER;
            row.situation = format!("{name}: lost motion of 0.1 arc-minutes in each joint");
            rows.push(row);
        }
        for (estimator, weights, words) in [
            (
                Estimator::TwoVariance,
                Weights::Readings,
                "two-variance: tracker's range and angle noise, all readings alike",
            ),
            (
                Estimator::TwoVariance,
                Weights::Tracker,
                "two-variance: tracker's range and angle noise, tracker weights",
            ),
            (Estimator::Weighted, Weights::Readings, "weighted: tracker's range and angle noise, all readings alike"),
            (Estimator::Weighted, Weights::Tracker, "weighted: tracker's range and angle noise, tracker weights"),
        ] {
            let mut row = self.row(BESIDE, estimator, &group, 4);
            row.cell.tracker.accuracy = Some(TRACKER);
            row.case.world.tracker_errors = true;
            row.case.options.weights = weights;
            row.case.experiments = FEWER;
            row.situation = words.to_string();
            rows.push(row);
        }
        Ok(())
    }
}

/// τ/σ of the shift that a posture's points share.
const RATIOS: [f64; 4] = [0.0, 0.5, 1.0, 3.0];
/// Three load states as fractions of the load.
const THREE: [f64; 3] = [1.0 / 3.0, 2.0 / 3.0, 1.0];
/// A tracker beside the cell: 2 µm and 0.5 µm/m along the beam, 15 µm at 4 m across.
const TRACKER: TrackerAccuracy =
    TrackerAccuracy { station: Vector3::new(2.0, -4.0, 1.5), range: 2e-6, range_per_metre: 0.5e-6, angle: 3.75e-6 };
