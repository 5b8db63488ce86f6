//! All that `validate` says: a saved stiffness at postures kept out of its
//! identification, or each posture predicted by the others.

use crate::ask::fit::FitOptions;
use crate::ask::identify::Reduced;
#[cfg(feature = "clap")]
use crate::ask::values::{MODEL, choice, number};
use crate::error::{Code, Error, Result};
use crate::estimate::elastic::{ElasticChoice, carried};
use crate::estimate::identify::{Estimator, Fit, NoiseSource};
use crate::estimate::mixed::{MixedFit, WorkRows, never_loaded};
use crate::estimate::saved::Saved;
use crate::estimate::validate::{
    Model, ValidatedPosture, Validation, cross_validate, cross_validate_mixed, validate_with,
};
use crate::findings::{Finding, codes, each_once, list};
use crate::measure::Measured;
use crate::model::cell::Cell;
use crate::model::observation::ExtraTerm;
use crate::model::posture::is_same_posture;
use crate::units::mm_to_m;
use serde::{Deserialize, Serialize};

/// Options of the result.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Options {
    /// How displacements are calculated.
    pub model: Model,
    /// Largest deviation allowed \[mm\].
    pub tolerance_mm: Option<f64>,
    /// Only these postures; all if empty.
    pub only: Vec<String>,
    /// How each fold was identified, with --folds.
    pub fit: Option<FoldOptions>,
}

/// Options of the identifications of a cross-validation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FoldOptions {
    /// Folds of postures.
    pub folds: usize,
    /// How the unknowns are estimated.
    pub estimator: Estimator,
    /// The extra terms.
    pub extra: Vec<ExtraTerm>,
    /// What gives way.
    pub elastic: ElasticChoice,
    /// Where the size of the noise comes from.
    pub noise: NoiseSource,
    /// Confidence of the bands.
    pub confidence: f64,
}

/// The validation with what else to know.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Validated {
    /// The validation.
    #[serde(flatten)]
    pub validation: Validation,
    /// From raw readings to displacements; left out for a table of displacements.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub readings: Option<Reduced>,
    /// What to know about the readings and the stiffness.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub remarks: Vec<Finding>,
}

impl Validated {
    /// Every finding of the result, each once.
    pub fn every_finding(&self) -> Vec<Finding> {
        let readings = self.readings.iter();
        let readings =
            readings.flat_map(|reduced| reduced.reduction.findings.iter().chain(&reduced.screening.findings));
        each_once(self.validation.findings.iter().chain(readings).chain(&self.remarks))
    }
}

/// Folds of a cross-validation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Folds {
    /// As many as postures.
    All,
    /// This many.
    Count(usize),
}

/// What is asked of a validation: by default the linear model, all postures, no tolerance.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "clap", derive(clap::Args))]
pub struct ValidateOptions {
    /// How displacements are calculated
    #[cfg_attr(feature = "clap", arg(long, default_value = "linear", value_parser = choice(MODEL)))]
    pub model: Model,
    /// Largest deviation allowed [mm]; beyond it the exit code is 1
    #[cfg_attr(feature = "clap", arg(long, value_name = "X", value_parser = number("tolerance_mm")))]
    pub tolerance_mm: Option<f64>,
    /// Only these postures
    #[cfg_attr(feature = "clap", arg(long, value_name = "NAME,…", value_delimiter = ','))]
    pub only: Vec<String>,
    /// Without a stiffness: leave out N folds of postures in turn, and predict each from the
    /// others; `all` leaves out one posture at a time
    #[cfg_attr(feature = "clap", arg(long, value_name = "N", value_parser = folds))]
    pub folds: Option<Folds>,
    /// Options of the fits.
    #[cfg_attr(feature = "clap", command(flatten))]
    pub fit: FitOptions,
}

impl Default for ValidateOptions {
    fn default() -> Self {
        ValidateOptions {
            model: Model::Linear,
            tolerance_mm: None,
            only: Vec::new(),
            folds: None,
            fit: FitOptions::default(),
        }
    }
}

impl ValidateOptions {
    /// Refuses what is wrong without any data.
    ///
    /// # Errors
    /// A tolerance that is negative or not finite (key `tolerance_mm`).
    pub fn check(&self) -> Result<()> {
        match self.tolerance_mm {
            Some(tolerance) if !(tolerance.is_finite() && tolerance >= 0.0) => {
                Err(Error::invalid(format!("The tolerance must be 0 mm or more, got {tolerance}.")).key("tolerance_mm"))
            }
            _ => Ok(()),
        }
    }

    /// Keeps the postures that are asked for.
    ///
    /// # Errors
    /// A name that no posture has (key `only`).
    pub fn keep_only(&self, measured: &mut Measured) -> Result<()> {
        if self.only.is_empty() { Ok(()) } else { measured.keep_only(&self.only).map_err(|e| e.key("only")) }
    }

    /// Validates a saved stiffness; `cell_hash` is the SHA-256 of the cell's file, where
    /// there is one. Of `measured` those postures count that [`ValidateOptions::only`] names.
    ///
    /// # Errors
    /// As [`ValidateOptions::check`], [`ValidateOptions::keep_only`] and [`validate_with`].
    pub fn held_out(
        &self,
        cell: &Cell,
        cell_hash: Option<&str>,
        saved: &Saved,
        mut measured: Measured,
    ) -> Result<Validated> {
        self.check()?;
        self.keep_only(&mut measured)?;
        let mut remarks = saved.predictor.doubts.clone();
        remarks.extend(measured.findings().cloned());
        let readings = Reduced::of(&measured);
        let tolerance = self.tolerance_mm.map(mm_to_m);
        let untold = untold(cell, saved, &measured)?;
        let validation = validate_with(cell, &saved.predictor, measured, self.model, tolerance)?;
        remarks.extend(untold);
        remarks.extend(saved.of_another_cell(cell_hash));
        remarks.extend(seen(saved, &validation));
        Ok(Validated { validation, readings, remarks })
    }

    /// Predicts each posture of `fit` from fits without it, with the elastic model that is
    /// asked for, by default the mixed one where it can be fitted; [`ValidateOptions::keep_only`] comes before the fit.
    ///
    /// # Errors
    /// As [`ValidateOptions::check`]; another model than the linear one (key `model`); an elastic model
    /// that the data do not carry (key `elastic`); and as [`cross_validate`].
    pub fn by_folds(&self, fit: &Fit, folds: Folds) -> Result<(Validated, FoldOptions)> {
        self.check()?;
        if self.model != Model::Linear {
            let message = "Fold by fold only the linear model can be used.";
            return Err(Error::new(Code::Unsupported, message).key("model"));
        }
        let count = folds.count(fit.measured());
        let tolerance = self.tolerance_mm.map(mm_to_m);
        let (validation, model) = crossed(fit, self.fit.elastic, count, tolerance)?;
        let options = fit.options();
        let described = FoldOptions {
            folds: count,
            estimator: options.estimator,
            extra: options.extra.clone(),
            elastic: model,
            noise: options.noise,
            confidence: options.confidence,
        };
        let validated = Validated {
            validation,
            readings: Reduced::of(fit.measured()),
            remarks: fit.measured().findings().cloned().collect(),
        };
        Ok((validated, described))
    }

    /// The options as the result holds them; `fit` as [`ValidateOptions::by_folds`] gave it.
    pub fn options(&self, fit: Option<FoldOptions>) -> Options {
        Options { model: self.model, tolerance_mm: self.tolerance_mm, only: self.only.clone(), fit }
    }
}

impl Folds {
    /// How many these are of what was measured.
    fn count(self, measured: &Measured) -> usize {
        match self {
            Folds::Count(count) => count,
            Folds::All => {
                let postures = measured.postures.iter();
                let mut names: Vec<&str> = postures.map(|m| m.posture.name.as_str()).collect();
                names.sort_unstable();
                names.dedup();
                names.len()
            }
        }
    }
}

/// Predicts fold by fold with the elastic model asked for; which one it was.
fn crossed(
    fit: &Fit,
    choice: Option<ElasticChoice>,
    count: usize,
    tolerance: Option<f64>,
) -> Result<(Validation, ElasticChoice)> {
    let mixed = match (choice, ElasticChoice::or_default(choice, fit.options())) {
        (_, ElasticChoice::Axes) => None,
        (Some(_), _) => Some(MixedFit::new(fit).map_err(|e| e.key("elastic"))?),
        (None, _) => carried(fit)?.ok(),
    };
    Ok(match &mixed {
        Some(mixed) => (cross_validate_mixed(mixed, count, tolerance)?, ElasticChoice::Mixed),
        None => (cross_validate(fit, count, tolerance)?, ElasticChoice::Axes),
    })
}

/// That the errors of these displacements come mostly from directions in which no reading of the identification has
/// loaded the arm.
///
/// # Errors
/// As [`never_loaded`].
fn untold(cell: &Cell, saved: &Saved, measured: &Measured) -> Result<Option<Finding>> {
    let predictor = &saved.predictor;
    let Some(spread) = predictor.spread.as_ref().filter(|spread| spread.doubt.is_some()) else {
        return Ok(None);
    };
    let noise = 3.0 * (spread.sigma.powi(2) + spread.shift.powi(2));
    let each = measured.postures.iter().filter(|m| !m.displacements.is_empty());
    let work = each.map(|m| {
        let setup = cell.setup.of_state(&m.state)?;
        let terms = m.terms(&setup, m.wrench.as_ref())?;
        let rows = terms.block_with(&cell.setup.robot, &predictor.extra);
        let squares = m.displacements.iter().map(|d| d.value.norm_squared()).sum::<f64>();
        let points = (rows.nrows() / 3) as f64;
        Ok(WorkRows { squares: squares * points / m.displacements.len() as f64, other: noise * points, rows, terms })
    });
    never_loaded(cell, saved, &work.collect::<Result<Vec<_>>>()?)
}

/// That postures took part in the identification, where some did: by their angles, by their names where these are not
/// known. Plans of two days both begin at posture 1.
fn seen(saved: &Saved, result: &Validation) -> Option<Finding> {
    let is_seen = |posture: &ValidatedPosture| match saved.angles.is_empty() {
        true => saved.postures.contains(&posture.posture),
        false => saved.angles.iter().any(|q| is_same_posture(q, &posture.angles)),
    };
    let seen = result.postures.iter().filter(|posture| is_seen(posture));
    let seen: Vec<&str> = seen.map(|posture| posture.posture.as_str()).collect();
    let seen = each_once(&seen);
    let (verb, them) = match seen.len() {
        0 => return None,
        1 => ("Posture", "its deviations"),
        _ => ("Postures", "their deviations"),
    };
    let sentence = format!("{verb} {} took part in the identification: {them} say little.", list(&seen));
    Some(Finding::caution(codes::SEEN_POSTURES, "stiffness", sentence))
}

#[cfg(feature = "clap")]
fn folds(text: &str) -> std::result::Result<Folds, String> {
    if text.eq_ignore_ascii_case("all") {
        return Ok(Folds::All);
    }
    match text.parse() {
        Ok(count) if count >= 2 => Ok(Folds::Count(count)),
        _ => Err("a number from 2, or `all`, is needed".to_string()),
    }
}
