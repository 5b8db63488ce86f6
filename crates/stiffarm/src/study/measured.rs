//! Which postures and which elastic model predict a measured robot best: over random
//! splits of an experiment, postures are chosen from a pool by each index, both models
//! are identified from them alone, and both predict the postures outside the pool.
//!
//! Nothing of the postures to be predicted reaches choice, model or variances; nothing of
//! the readings reaches the choice.

use crate::error::{Code, Error, Result};
use crate::estimate::elastic::ElasticChoice;
use crate::estimate::identify::{Fit, IdentifyOptions, MeasuredSystem, missed};
use crate::estimate::mixed::MixedFit;
use crate::findings::{Finding, Severity, length_with_error, percent};
use crate::measure::Measured;
use crate::model::cell::Cell;
use crate::model::elastic::ElasticSizes;
use crate::model::measurement::Candidate;
use crate::numerics::control::Control;
use crate::numerics::jobs::as_far_as;
use crate::numerics::streams::split_rng;
use crate::plan::characteristic_length::with_characteristic_length;
use crate::plan::index::Index;
use crate::plan::select::{CandidateOptions, select_candidates};
use nalgebra::DVector;
use rand::seq::SliceRandom;
use serde::{Deserialize, Serialize};

/// Stiffness of every joint where the cell has no prior \[N·m/rad\]: a guess that no
/// index takes seriously, since only what k is relative to other joints' matters.
const GUESS: f64 = 5e5;
/// Starts of each choice: a pool of some dozens has few local minima.
const STARTS: usize = 4;

/// Options of the study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct MeasuredStudyOptions {
    /// Random splits into a pool and postures to be predicted.
    pub splits: usize,
    /// Postures of the pool; `None` takes seven of ten.
    pub pool: Option<usize>,
    /// Numbers of postures chosen.
    pub counts: Vec<usize>,
    /// Indices that choose, beside chance.
    pub indices: Vec<Index>,
    /// What the typical sizes behind the index `prediction` are multiplied by.
    pub size_factor: f64,
    /// Seed of the splits and of chance.
    pub seed: u64,
}

impl Default for MeasuredStudyOptions {
    fn default() -> Self {
        MeasuredStudyOptions {
            splits: 100,
            pool: None,
            counts: vec![6, 10, 15],
            indices: vec![Index::Novel, Index::ExpectedError, Index::Prediction],
            size_factor: 1.0,
            seed: 1,
        }
    }
}

/// How postures were chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Choice {
    /// By chance.
    Random,
    /// By an index.
    Index(Index),
    /// The whole pool.
    Pool,
}

impl Choice {
    /// Name in tables.
    pub fn as_str(self) -> &'static str {
        match self {
            Choice::Random => "random",
            Choice::Index(index) => index.as_str(),
            Choice::Pool => "whole pool",
        }
    }
}

/// One way to choose with one model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MeasuredChoice {
    /// Number of postures.
    pub postures: usize,
    /// How they were chosen.
    pub choice: Choice,
    /// The model: `axes` or `mixed`.
    pub model: ElasticChoice,
    /// Mean over the splits of the RMS error of a displacement component at the postures
    /// outside the pool \[m\].
    pub mean_m: f64,
    /// Its standard error \[m\]: over splits of one experiment, which share postures.
    pub standard_error_m: f64,
    /// Share of the splits in which this choice predicts better than chance with as many
    /// postures and the same model; `None` for chance and for the whole pool.
    pub better_than_random: Option<f64>,
    /// Splits in which the chosen postures could not carry the mixed model, and the joint
    /// axes predicted.
    pub fallbacks: usize,
    /// Splits without a prediction: the postures did not determine every joint, or the
    /// index chose none.
    pub missing: usize,
    /// The error of each split \[m\]; `None` where it is missing.
    pub errors_m: Vec<Option<f64>>,
}

/// Result of the study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MeasuredStudy {
    /// Name of the cell.
    pub cell: String,
    /// Name of the robot.
    pub robot: String,
    /// Options.
    pub options: MeasuredStudyOptions,
    /// Measured postures.
    pub posture_count: usize,
    /// Of them in the pool.
    pub pool_count: usize,
    /// Splits that were made: fewer than asked for where the study was stopped.
    pub split_count: usize,
    /// RMS of the measured displacement components \[m\].
    pub displacement_rms_m: f64,
    /// Prior stiffness behind the choices \[N·m/rad\].
    pub prior: Vec<f64>,
    /// True where the cell has no prior and a guess stands in.
    pub prior_guessed: bool,
    /// Every way to choose with every model.
    pub choices: Vec<MeasuredChoice>,
    /// What came out, in sentences.
    pub findings: Vec<Finding>,
}

/// Runs the study on an experiment.
///
/// ```no_run
/// # #[cfg(feature = "files")] fn main() -> stiffarm::Result<()> {
/// use stiffarm::study::{MeasuredStudyOptions, measured_study};
/// use stiffarm::{Cell, Control, prepare, simulated_readings};
///
/// let cell = Cell::built_in("comau")?;
/// let plan = stiffarm::plan::select::random_group(&cell, stiffarm::plan::select::StartKind::Uniform, 30, 1, 0)?;
/// let postures = stiffarm::PostureGroup::from_angles("all", plan).postures;
/// let measured = prepare(&cell, simulated_readings(&cell, &postures, 1)?, &Default::default())?;
/// let found = measured_study(&cell, measured, &MeasuredStudyOptions::default(), Control::default())?;
/// println!("{}", found.findings[0].sentence);
/// # Ok(())
/// # }
/// # #[cfg(not(feature = "files"))] fn main() {}
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
    let fit = Fit::watched(
        cell,
        measured.into(),
        &IdentifyOptions::default(),
        Default::default(),
    )?;
    let study = Setting::new(cell, fit, options)?;
    let numbers: Vec<u64> = (0..options.splits as u64).collect();
    let splits = as_far_as(
        &numbers,
        "splitting the experiment",
        control,
        |(_, number)| study.split(*number, control),
    )?;
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
    sizes: ElasticSizes,
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
            return Err(Error::new(
                Code::InvalidValue,
                "The study needs at least one split and numbers of postures above zero.",
            ));
        }
        if pool >= count || most > pool {
            return Err(Error::new(
                Code::TooFewData,
                format!(
                    "{count} measured postures are too few: {most} are to be chosen from a pool of {pool}, and the others \
                     predicted."
                ),
            )
            .hint("choose fewer, or make the pool smaller than the experiment"));
        }
        if !(options.size_factor > 0.0 && options.size_factor.is_finite()) {
            return Err(Error::new(
                Code::InvalidValue,
                "The factor of the sizes must be above zero.",
            ));
        }
        let mut cell = cell.clone();
        cell.tasks.clear();
        let guessed = cell.prior.is_none();
        let springs = cell.setup.robot.spring_count();
        let prior = cell.prior.get_or_insert_with(|| vec![GUESS; springs]);
        let sizes = ElasticSizes::typical(&cell.setup, prior)?.times(options.size_factor);
        let known = Candidate::of_measured(fit.postures());
        let candidates = fit
            .system()
            .blocks
            .iter()
            .filter_map(|block| known.iter().find(|c| c.name == block.posture).cloned())
            .collect();
        let ways = options.counts.iter().flat_map(|count| {
            let indices = options.indices.iter().map(|index| Choice::Index(*index));
            let each = std::iter::once(Choice::Random).chain(indices);
            each.map(|choice| (*count, choice)).collect::<Vec<_>>()
        });
        let ways = ways.chain([(pool, Choice::Pool)]).collect();
        Ok(Setting {
            mixed: MixedFit::new(&fit)?,
            cell,
            options,
            candidates,
            pool,
            sizes,
            guessed,
            ways,
        })
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
                    options.sizes = Some(self.sizes);
                    match select_candidates(&self.cell, *index, *count, &list, &options, control) {
                        Ok(found) => Some(found.chosen.iter().map(|p| pool[*p]).collect()),
                        Err(error) if error.code() == Code::NotIdentifiable => None,
                        Err(error) => return Err(error),
                    }
                }
            };
            out.push(match chosen {
                Some(chosen) => self.outcome(&chosen, test)?,
                None => Outcome {
                    axes: None,
                    mixed: None,
                    fell_back: false,
                },
            });
        }
        Ok(out)
    }

    /// Both models from the postures `chosen`, at the postures `test`.
    fn outcome(&self, chosen: &[usize], test: &[usize]) -> Result<Outcome> {
        let fit = self.mixed.fit();
        let found = self.mixed.alone(chosen)?;
        let rms = |system: &MeasuredSystem, values: &DVector<f64>| {
            let (mut squares, mut rows) = (0.0, 0);
            for b in test {
                let errors = missed(system, *b, values);
                squares += errors.norm_squared();
                rows += errors.len();
            }
            (squares / rows as f64).sqrt()
        };
        let axes = found.axes.as_ref().map(|values| rms(fit.system(), values));
        let mixed = found
            .mixed
            .as_ref()
            .map(|c| rms(self.mixed.system(), &c.values));
        Ok(Outcome {
            axes,
            mixed: mixed.or(axes),
            fell_back: mixed.is_none() && axes.is_some(),
        })
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
                let chance = self
                    .ways
                    .iter()
                    .position(|way| *way == (*postures, Choice::Random));
                let better = chance.filter(|_| *choice != Choice::Random).map(|chance| {
                    let both = splits
                        .iter()
                        .filter_map(|s| error(&s[w]).zip(error(&s[chance])));
                    share(both.map(|(own, random)| own < random))
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
    let known: Vec<f64> = errors.iter().flatten().copied().collect();
    let count = known.len() as f64;
    let mean = known.iter().sum::<f64>() / count;
    let squares: f64 = known.iter().map(|e| (e - mean).powi(2)).sum();
    let error = (squares / (count - 1.0).max(1.0) / count).sqrt();
    (mean, error)
}

fn share(found: impl Iterator<Item = bool>) -> f64 {
    let all: Vec<bool> = found.collect();
    all.iter().filter(|yes| **yes).count() as f64 / all.len().max(1) as f64
}

impl MeasuredStudy {
    /// One way to choose with one model.
    pub fn get(
        &self,
        postures: usize,
        choice: Choice,
        model: ElasticChoice,
    ) -> Option<&MeasuredChoice> {
        self.choices
            .iter()
            .find(|c| (c.postures, c.choice, c.model) == (postures, choice, model))
    }
}

fn findings(study: &MeasuredStudy) -> Vec<Finding> {
    let mut out = Vec::new();
    let mut add = |code: &'static str, severity, sentence: String| {
        out.push(Finding::new(code, severity, "study", sentence));
    };
    let said = |c: &MeasuredChoice| length_with_error(c.mean_m, c.standard_error_m);
    let known = |c: &&MeasuredChoice| c.mean_m.is_finite();
    for &count in &study.options.counts {
        let best = study
            .choices
            .iter()
            .filter(|c| c.postures == count && c.choice != Choice::Pool)
            .filter(known)
            .min_by(|a, b| a.mean_m.total_cmp(&b.mean_m));
        let whole = study.get(study.pool_count, Choice::Pool, ElasticChoice::Axes);
        if let (Some(best), Some(whole)) = (best, whole) {
            add(
                "best-choice",
                Severity::Note,
                format!(
                    "{count} postures predict best chosen by {} with the {}: others are missed by {} (RMS, mean of {} \
                     splits); all {} of the pool with the joint axes alone miss them by {}.",
                    best.choice.as_str(),
                    model_name(best.model),
                    said(best),
                    study.split_count,
                    study.pool_count,
                    said(whole),
                ),
            );
        }
        for &index in &study.options.indices {
            let own = study.get(count, Choice::Index(index), ElasticChoice::Axes);
            let random = study.get(count, Choice::Random, ElasticChoice::Axes);
            if let (Some(own), Some(random)) = (own.filter(known), random.filter(known))
                && own.mean_m - random.mean_m
                    > 2.0 * own.standard_error_m.hypot(random.standard_error_m)
            {
                add(
                    "worse-than-random",
                    Severity::Caution,
                    format!(
                        "{count} postures chosen by {} predict worse with the joint axes than {count} taken at random: {} \
                         against {}; better in {} of the splits.",
                        index.as_str(),
                        said(own),
                        said(random),
                        percent(own.better_than_random.unwrap_or(0.0)),
                    ),
                );
            }
        }
    }
    if study.prior_guessed {
        add(
            "guessed-prior",
            Severity::Note,
            format!(
                "The cell has no prior stiffness: to choose, every joint counted as {GUESS:.0e} N·m/rad."
            ),
        );
    }
    out
}

/// The model in words.
fn model_name(model: ElasticChoice) -> &'static str {
    match model {
        ElasticChoice::Mixed => "mixed model",
        _ => "joint axes alone",
    }
}
