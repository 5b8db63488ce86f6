//! What a study on measured readings is asked and gives.

use super::GUESS;
use crate::estimate::elastic::ElasticChoice;
use crate::findings::{Finding, Severity, length_with_error, percent};
use crate::plan::index::Index;
use serde::{Deserialize, Deserializer, Serialize};

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
    /// What the sizes behind the index `prediction`, those of the cell or typical ones, are
    /// multiplied by.
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
    /// outside the pool \[m\]; not a number where no split has a prediction.
    #[serde(deserialize_with = "null_as_nan")]
    pub mean_m: f64,
    /// Its standard error \[m\]: over splits of one experiment, which share postures.
    #[serde(deserialize_with = "null_as_nan")]
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

/// JSON has no way to write a number that is not finite.
fn null_as_nan<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    Ok(Option::<f64>::deserialize(deserializer)?.unwrap_or(f64::NAN))
}

impl MeasuredStudy {
    /// One way to choose with one model.
    pub fn get(&self, postures: usize, choice: Choice, model: ElasticChoice) -> Option<&MeasuredChoice> {
        self.choices.iter().find(|c| (c.postures, c.choice, c.model) == (postures, choice, model))
    }
}

pub(super) fn findings(study: &MeasuredStudy) -> Vec<Finding> {
    let mut out = Vec::new();
    let mut add = |code: &'static str, severity, sentence: String| {
        out.push(Finding::new(code, severity, "study", sentence));
    };
    let said = |c: &MeasuredChoice| length_with_error(c.mean_m, c.standard_error_m);
    let has_mean = |c: &&MeasuredChoice| c.mean_m.is_finite();
    for &count in &study.options.counts {
        let best = study
            .choices
            .iter()
            .filter(|c| c.postures == count && c.choice != Choice::Pool)
            .filter(has_mean)
            .min_by(|a, b| a.mean_m.total_cmp(&b.mean_m));
        let whole = study.get(study.pool_count, Choice::Pool, ElasticChoice::Axes);
        if let (Some(best), Some(whole)) = (best, whole) {
            let chance = study.get(count, Choice::Random, best.model);
            // Chance itself may be best.
            let beyond = chance.is_some_and(|chance| is_more(chance, best));
            let (code, begin) = if beyond {
                ("best-choice", format!("{count} postures predict best chosen by"))
            } else {
                (
                    "no-choice",
                    format!(
                        "With {count} postures no choice beats chance beyond the scatter of the splits; the best is"
                    ),
                )
            };
            add(
                code,
                Severity::Note,
                format!(
                    "{begin} {} with the {}: others are missed by {} (RMS, mean of {} splits); all {} of the pool with \
                     the joint axes alone miss them by {}.",
                    best.choice.as_str(),
                    best.model.in_words(),
                    said(best),
                    study.split_count,
                    study.pool_count,
                    said(whole),
                ),
            );
        }
        for &index in &study.options.indices {
            let by_index = study.get(count, Choice::Index(index), ElasticChoice::Axes);
            let random = study.get(count, Choice::Random, ElasticChoice::Axes);
            if let (Some(by_index), Some(random)) = (by_index.filter(has_mean), random.filter(has_mean))
                && is_more(by_index, random)
            {
                add(
                    "worse-than-random",
                    Severity::Caution,
                    format!(
                        "{count} postures chosen by {} predict worse with the joint axes than {count} taken at random: \
                         {} against {}; better in {} of the splits.",
                        index.as_str(),
                        said(by_index),
                        said(random),
                        percent(by_index.better_than_random.unwrap_or(0.0)),
                    ),
                );
            }
        }
    }
    if study.prior_guessed {
        add(
            "guessed-prior",
            Severity::Note,
            format!("The cell has no prior stiffness: to choose, every joint counted as {GUESS:.0e} N·m/rad."),
        );
    }
    out
}

/// True where one error is above another by more than twice the standard error of their
/// difference, as if splits were independent.
fn is_more(one: &MeasuredChoice, other: &MeasuredChoice) -> bool {
    one.mean_m - other.mean_m > 2.0 * one.standard_error_m.hypot(other.standard_error_m)
}
