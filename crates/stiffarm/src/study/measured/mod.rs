//! Which postures and which elastic model predict a measured robot best: over random
//! splits of an experiment, postures are chosen from a pool by each index, both models
//! are identified from them alone, and both predict the postures outside the pool.
//!
//! Nothing of the postures to be predicted reaches choice, model or variances; nothing of
//! the readings reaches the choice.

mod result;

pub use result::{Choice, MeasuredChoice, MeasuredStudy, MeasuredStudyOptions};

use crate::error::{Code, Error, Result};
use crate::estimate::elastic::ElasticChoice;
use crate::estimate::identify::{Fit, IdentifyOptions, MeasuredSystem, missed};
use crate::estimate::mixed::MixedFit;
use crate::measure::Measured;
use crate::model::cell::Cell;
use crate::model::measurement::Candidate;
use crate::numerics::control::Control;
use crate::numerics::jobs::as_far_as;
use crate::numerics::streams::split_rng;
use crate::plan::characteristic_length::with_characteristic_length;
use crate::plan::select::{CandidateOptions, select_candidates};
use nalgebra::DVector;
use rand::seq::SliceRandom;
use result::findings;

/// Stiffness of every joint where the cell has no prior \[N·m/rad\]. The other indices see
/// only how joints compare; `prediction` takes its sizes from it, and a factor of ten
/// either way hardly moves what comes out (docs/measured.md).
const GUESS: f64 = 5e5;
/// Starts of each choice: a pool of some dozens has few local minima.
const STARTS: usize = 4;

/// Runs the study on an experiment.
///
/// ```no_run
/// # fn main() -> stiffarm::Result<()> {
/// use stiffarm::study::{MeasuredStudyOptions, measured_study};
/// use stiffarm::{Control, prepare, simulated_readings};
/// use stiffarm_files::builtin;
///
/// let cell = builtin::cell("comau")?;
/// let plan = stiffarm::plan::select::random_group(&cell, stiffarm::plan::select::StartKind::Uniform, 30, 1, 0)?;
/// let postures = stiffarm::PostureGroup::from_angles("all", plan).postures;
/// let measured = prepare(&cell, simulated_readings(&cell, &postures, 1)?, &Default::default())?;
/// let found = measured_study(&cell, measured, &MeasuredStudyOptions::default(), Control::default())?;
/// println!("{}", found.findings[0].sentence);
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// Too few postures for the pool or the counts, options that make no sense, readings that
/// the mixed model cannot use, stopped before the first split.
pub fn measured_study(
    cell: &Cell,
    measured: impl Into<Measured>,
    options: &MeasuredStudyOptions,
    control: Control<'_>,
) -> Result<MeasuredStudy> {
    let cell = &with_characteristic_length(cell.clone())?;
    let fit = Fit::watched(cell, measured.into(), &IdentifyOptions::default(), Default::default())?;
    let study = Setting::new(cell, fit, options)?;
    let numbers: Vec<u64> = (0..options.splits as u64).collect();
    let splits = as_far_as(&numbers, "splitting the experiment", control, |(_, number)| study.split(*number, control))?;
    let splits: Vec<Vec<Outcome>> = splits.into_iter().flatten().collect();
    if splits.is_empty() {
        control.check()?;
    }
    Ok(study.gathered(&splits))
}

/// Error of one choice with both models, in one split.
#[derive(Debug, Clone, Copy)]
struct Outcome {
    axes: Option<f64>,
    mixed: Option<f64>,
    fell_back: bool,
}

struct Setting<'a> {
    /// With a prior, and without tasks: what is predicted are the pool's postures.
    cell: Cell,
    options: &'a MeasuredStudyOptions,
    mixed: MixedFit,
    /// By position of its block in the system.
    candidates: Vec<Candidate>,
    pool: usize,
    guessed: bool,
    /// Ways to choose: (postures, choice).
    ways: Vec<(usize, Choice)>,
}

impl<'a> Setting<'a> {
    fn new(cell: &Cell, fit: Fit, options: &'a MeasuredStudyOptions) -> Result<Self> {
        let count = fit.system().blocks.len();
        let pool = options.pool.unwrap_or((7 * count).div_ceil(10));
        let most = options.counts.iter().copied().max().unwrap_or(0);
        if options.splits == 0 || most == 0 || options.counts.contains(&0) {
            return Err(Error::invalid("The study needs at least one split and numbers of postures above zero."));
        }
        if pool >= count || most > pool {
            return Err(Error::new(
                Code::TooFewData,
                format!(
                    "{count} measured postures are too few: {most} are to be chosen from a pool of {pool}, and the \
                     others predicted."
                ),
            )
            .hint("choose fewer, or make the pool smaller than the experiment"));
        }
        if !(options.size_factor > 0.0 && options.size_factor.is_finite()) {
            return Err(Error::invalid("The factor of the sizes must be above zero."));
        }
        let mut cell = cell.clone();
        cell.tasks.clear();
        let guessed = cell.prior.is_none();
        let springs = cell.setup.robot.spring_count();
        cell.prior.get_or_insert_with(|| vec![GUESS; springs]);
        let measured = Candidate::of_measured(&fit.cell().setup, fit.postures());
        let candidates = fit
            .system()
            .blocks
            .iter()
            .filter_map(|block| measured.iter().find(|c| c.name == block.posture).cloned())
            .collect();
        let ways = options.counts.iter().flat_map(|count| {
            let indices = options.indices.iter().map(|index| Choice::Index(*index));
            let each = std::iter::once(Choice::Random).chain(indices);
            each.map(|choice| (*count, choice)).collect::<Vec<_>>()
        });
        let ways = ways.chain([(pool, Choice::Pool)]).collect();
        Ok(Setting { mixed: MixedFit::new(&fit)?, cell, options, candidates, pool, guessed, ways })
    }

    fn split(&self, number: u64, control: Control<'_>) -> Result<Vec<Outcome>> {
        let mut rng = split_rng(self.options.seed, number);
        let mut order: Vec<usize> = (0..self.candidates.len()).collect();
        order.shuffle(&mut rng);
        let (pool, test) = order.split_at(self.pool);
        let mut pool = pool.to_vec();
        pool.sort_unstable();
        let list: Vec<Candidate> = pool.iter().map(|b| self.candidates[*b].clone()).collect();
        let mut out = Vec::with_capacity(self.ways.len());
        for (count, choice) in &self.ways {
            control.check()?;
            let chosen = match choice {
                Choice::Pool => Some(pool.clone()),
                Choice::Random => {
                    let mut all = pool.clone();
                    all.shuffle(&mut rng);
                    all.truncate(*count);
                    all.sort_unstable();
                    Some(all)
                }
                Choice::Index(index) => {
                    let mut options = CandidateOptions::default();
                    options.starts = STARTS;
                    options.seed = self.options.seed;
                    options.bound = false;
                    options.size_factor = self.options.size_factor;
                    options.limits = false;
                    match select_candidates(&self.cell, *index, *count, &list, &options, control) {
                        Ok(selection) => Some(selection.chosen.iter().map(|p| pool[*p]).collect()),
                        Err(error) if error.code() == Code::NotIdentifiable => None,
                        Err(error) => return Err(error),
                    }
                }
            };
            out.push(match chosen {
                Some(chosen) => self.outcome(&chosen, test)?,
                None => Outcome { axes: None, mixed: None, fell_back: false },
            });
        }
        Ok(out)
    }

    /// Both models from the postures `chosen`, at the postures `test`.
    fn outcome(&self, chosen: &[usize], test: &[usize]) -> Result<Outcome> {
        let fit = self.mixed.fit();
        let models = self.mixed.alone(chosen)?;
        let rms = |system: &MeasuredSystem, values: &DVector<f64>| {
            let (mut squares, mut rows) = (0.0, 0);
            for b in test {
                let errors = missed(system, *b, values);
                squares += errors.norm_squared();
                rows += errors.len();
            }
            (squares / rows as f64).sqrt()
        };
        let axes = models.axes.as_ref().map(|values| rms(fit.system(), values));
        let mixed = models.mixed.as_ref().map(|c| rms(self.mixed.system(), &c.values));
        Ok(Outcome { axes, mixed: mixed.or(axes), fell_back: mixed.is_none() && axes.is_some() })
    }

    fn gathered(&self, splits: &[Vec<Outcome>]) -> MeasuredStudy {
        let mut choices = Vec::new();
        for model in [ElasticChoice::Axes, ElasticChoice::Mixed] {
            let error = |outcome: &Outcome| match model {
                ElasticChoice::Mixed => outcome.mixed,
                _ => outcome.axes,
            };
            for (w, (postures, choice)) in self.ways.iter().enumerate() {
                let errors: Vec<Option<f64>> = splits.iter().map(|s| error(&s[w])).collect();
                let chance = self.ways.iter().position(|way| *way == (*postures, Choice::Random));
                let better = chance.filter(|_| *choice != Choice::Random).map(|chance| {
                    let both = splits.iter().filter_map(|s| error(&s[w]).zip(error(&s[chance])));
                    share(both.map(|(chosen, random)| chosen < random))
                });
                let (mean_m, standard_error_m) = mean(&errors);
                choices.push(MeasuredChoice {
                    postures: *postures,
                    choice: *choice,
                    model,
                    mean_m,
                    standard_error_m,
                    better_than_random: better,
                    fallbacks: match model {
                        ElasticChoice::Mixed => splits.iter().filter(|s| s[w].fell_back).count(),
                        _ => 0,
                    },
                    missing: errors.iter().filter(|e| e.is_none()).count(),
                    errors_m: errors,
                });
            }
        }
        let delta = &self.mixed.fit().system().delta;
        let mut out = MeasuredStudy {
            cell: self.cell.name.clone(),
            robot: self.cell.setup.robot.name().to_string(),
            options: self.options.clone(),
            posture_count: self.candidates.len(),
            pool_count: self.pool,
            split_count: splits.len(),
            displacement_rms_m: (delta.norm_squared() / delta.len() as f64).sqrt(),
            prior: self.cell.prior.clone().unwrap_or_default(),
            prior_guessed: self.guessed,
            choices,
            findings: Vec::new(),
        };
        out.findings = findings(&out);
        out
    }
}

/// Mean with its standard error.
fn mean(errors: &[Option<f64>]) -> (f64, f64) {
    let present: Vec<f64> = errors.iter().flatten().copied().collect();
    let count = present.len() as f64;
    let mean = present.iter().sum::<f64>() / count;
    let squares: f64 = present.iter().map(|e| (e - mean).powi(2)).sum();
    let error = (squares / (count - 1.0).max(1.0) / count).sqrt();
    (mean, error)
}

fn share(flags: impl Iterator<Item = bool>) -> f64 {
    let all: Vec<bool> = flags.collect();
    all.iter().filter(|yes| **yes).count() as f64 / all.len().max(1) as f64
}
