//! Does what the cell states of the set-up fit the readings?
//!
//! Springs beyond the axes are flexible enough to swallow an anchor or a loading point that is written down wrongly:
//! what is left looks like noise, and the stiffness is wrong. So each quantity of the set-up is freed in turn and found
//! by Gauss and Newton beside the compliances, and the explanations compete by restricted likelihood, of the axes alone
//! and of the mixed model. A quantity is rejected where the readings are far likelier with another value of it, springs
//! beyond the axes granted before and after, and the axes alone leave clearly less; it is doubtful where these do not.

mod explained;
mod free;
mod freed;
mod starts;
mod words;

pub(crate) use explained::{follows, is_doubtful, is_explained, leave_out_explained};
pub use free::free;

use crate::error::Result;
use crate::estimate::elastic::{FEWEST_POSTURES, carried};
use crate::estimate::identify::{Fit, IdentifyOptions, rms};
use crate::estimate::mixed::MixedFit;
use crate::estimate::quantity::facts::Quantity;
use crate::estimate::quantity::stated::StatedExperiment;
use crate::estimate::quantity::value::QuantityAtValue;
use crate::findings::Finding;
use crate::numerics::jobs::in_order;
use crate::numerics::order::sort_by_number;
use freed::{Linear, QuantityFit, below_zero, value};
use nalgebra::Matrix3;
use serde::{Deserialize, Serialize};

/// Fall of −2 ln L from which a quantity is rejected, from which it is doubtful, and what each of its numbers adds:
/// sound days of arms with springs beyond the axes, drift and shared shifts stay below.
const REJECTING_LIKELIHOOD: f64 = 22.0;
const DOUBTING_LIKELIHOOD: f64 = 10.0;
const LIKELIHOOD_EACH: f64 = 4.0;
/// Share of what the axes alone leave to which that falls where a quantity is wrong; where springs beyond the axes hide
/// it, −2 ln L falls by so much.
const CLEAR_RESIDUAL_SHARE: f64 = 0.85;
const CLEAR_LIKELIHOOD: f64 = 60.0;
/// Fall of −2 ln L, by derivatives at the stated value, below which nothing is looked for.
const WORTH_SEARCHING: f64 = 15.0;
/// Residuals this many times the expected noise hold more than noise.
const MORE_THAN_NOISE: f64 = 1.3;
/// Starts that are followed for each quantity.
const FOLLOWED: usize = 2;
/// Quantities that are tried beside springs beyond the axes.
const TRIED: usize = 3;
/// Standard uncertainties, of cell and readings together, within which a quantity may lie.
const PLAUSIBLE_STDS: f64 = 3.0;
/// Explanations whose −2 ln L lies within this of the best explain as well.
const ALIKE_LIKELIHOOD_RATIO: f64 = 10.0;

/// A quantity of the set-up that the readings want elsewhere.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FreedQuantity {
    /// Stable name: `anchor`, `loading-point`, `gravity`, `registration`, `force-beside`, `force-offset`, `sign`,
    /// `common-shift`, `sensor-axes`, `sensor-origin`, `sensor-in-base-axes`, `measuring-points`, `joint-angle`,
    /// `coupling`, `rows`, `base-tilt`, `lost-motion`.
    pub name: String,
    /// Key of the cell that states it, else what it is about.
    #[serde(default)]
    pub key: String,
    /// What the readings ask for, in words.
    #[serde(default)]
    pub words: String,
    /// What the cell or the table states, SI: a place, a direction, a turn vector, a force, angles.
    pub stated: Vec<f64>,
    /// What the readings ask for.
    pub asked: Vec<f64>,
    /// Its standard errors; `null` where the readings do not tell a number.
    pub standard_error: Vec<Option<f64>>,
    /// Fall of −2 ln L (restricted) of the best model, axes alone or mixed.
    pub likelihood_ratio: f64,
    /// RMS of what the joint axes alone leave of the displacements, as stated and with the quantity freed \[m\].
    pub residual_rms_m: [f64; 2],
}

/// The set-up against the readings.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SetUp {
    /// What was freed beside springs beyond the axes, the likeliest first.
    pub freed: Vec<FreedQuantity>,
    /// What is rejected or doubtful, in a sentence.
    pub finding: Option<Finding>,
    /// How far off the quantity of the finding may be, as the readings ask for: the RMS of its numbers.
    #[serde(skip)]
    pub(crate) off: Option<(Quantity, f64)>,
}

/// Tests what the cell states of the set-up behind `fit`, whose mixed model is `mixed` where it is known; the postures
/// `outlying` do not fit. `None` where the readings are too few.
///
/// # Errors
/// A decomposition that fails; stopped.
pub fn set_up(fit: &Fit, mixed: Option<&MixedFit>, outlying: &[String]) -> Result<Option<SetUp>> {
    let options = IdentifyOptions {
        extra: fit.options().extra.clone(),
        weights: fit.options().weights,
        free: fit.options().free.clone(),
        ..IdentifyOptions::default()
    };
    let matching = mixed.filter(|_| *fit.options() == options);
    let fit = fit.with(&options)?;
    let identification = fit.identification()?;
    let left = identification.total_std_m.unwrap_or(0.0);
    if fit.system().blocks.len() < FEWEST_POSTURES || identification.expected_std_m <= 0.0 || left <= 0.0 {
        return Ok(None);
    }
    let is_more = left > MORE_THAN_NOISE * identification.expected_std_m || below_zero(&fit, None) > WORTH_SEARCHING;
    let stated = StatedExperiment::of(&fit);
    let Some(linear) = Linear::new(&stated, &fit, None) else {
        return Ok(None);
    };
    let has_approach = fit.cell().route.approach.is_some();
    let is_asked = |quantity: &Quantity| quantity.is_told() && !(*quantity == Quantity::LostMotion && has_approach);
    let mut quantities = stated.quantities();
    quantities.retain(is_asked);
    let alone = in_order(&quantities, |(_, quantity)| {
        fit.control().check()?;
        Ok(freed_alone(&stated, &linear, *quantity, is_more))
    })?;
    let mut alone: Vec<QuantityFit> = alone.into_iter().flatten().collect();
    let price = |at: &QuantityFit| at.value + LIKELIHOOD_EACH * at.numbers() as f64;
    sort_by_number(&mut alone, price);
    alone.truncate(TRIED);
    // Springs beyond the axes granted on both sides.
    let grants = options.extra.is_empty();
    let carried = match matching {
        None if grants && !alone.is_empty() => carried(&fit)?.ok(),
        _ => None,
    };
    let mixed = matching.or(carried.as_ref());
    if let Some(mixed) = mixed {
        leave_out_swallowed(&stated, mixed, &mut alone);
    }
    if alone.is_empty() {
        return Ok(Some(SetUp::default()));
    }
    let before = value(&fit, mixed);
    let mut beside = in_order(&alone, |(_, at)| {
        fit.control().check()?;
        let at = QuantityFit::new(at.values.clone(), at.fit.clone(), grants, mixed.map(MixedFit::sizes))?;
        let hope = before - at.value + stated.gain(&at);
        let at = if hope > WORTH_SEARCHING { stated.refined(at) } else { at };
        Ok((described(&stated, &at, before), at.forget()))
    })?;
    sort_by_number(&mut beside, |(_, at)| price(at));
    let (described, beside): (Vec<_>, Vec<QuantityFit>) = beside.into_iter().unzip();
    let freed: Vec<FreedQuantity> = described.into_iter().flatten().collect();
    let (best, first) = (&beside[0], &freed[0]);
    let quantity = best.values[0].0;
    let finding = match judged(&fit, best, first, grants)? {
        None => None,
        // A posture that does not fit is a finding of its own.
        Some(Word::ByPosture(name)) if outlying.contains(&name) => None,
        // What gives way is no error of the set-up that could be doubtful.
        Some(word) if word != Word::Rejected && quantity.terms(0).is_some() => None,
        Some(word) => {
            let others = freed.iter().zip(&beside).skip(1);
            let alike = others
                .filter(|(other, _)| first.likelihood_ratio - other.likelihood_ratio < ALIKE_LIKELIHOOD_RATIO)
                .map(|(_, at)| at.values[0].0);
            let alike: Vec<Quantity> = alike.collect();
            Some(words::finding(fit.cell(), quantity, first, &alike, &word))
        }
    };
    let values = &best.values[0].1.values;
    let size = values.norm() / (values.len().max(1) as f64).sqrt();
    Ok(Some(SetUp { off: finding.as_ref().map(|_| (quantity, size)), freed, finding }))
}

/// What the readings say of a quantity with which they are clearly likelier elsewhere.
#[derive(Debug, Clone, PartialEq)]
enum Word {
    /// It is rejected as stated.
    Rejected,
    /// Doubtful: the readings are not so much likelier.
    Likely,
    /// Doubtful: the axes alone leave hardly less, so that springs beyond them may be the reason.
    BySprings,
    /// Doubtful: one posture says most of it.
    ByPosture(String),
}

/// What the readings say of the best quantity; `None` where they are not clearly likelier with it where they want it.
fn judged(fit: &Fit, best: &QuantityFit, first: &FreedQuantity, grants: bool) -> Result<Option<Word>> {
    let each = LIKELIHOOD_EACH * best.numbers() as f64;
    let is_strong = first.likelihood_ratio > REJECTING_LIKELIHOOD + each;
    let least = each + if is_strong { REJECTING_LIKELIHOOD } else { DOUBTING_LIKELIHOOD };
    if first.likelihood_ratio <= least || is_within_stated(fit, &best.values[0], &first.standard_error) {
        return Ok(None);
    }
    let [all, left] = first.residual_rms_m;
    let is_clear = left < CLEAR_RESIDUAL_SHARE * all || first.likelihood_ratio > CLEAR_LIKELIHOOD;
    let (without, worst) = without_worst(fit, best, grants)?;
    Ok(Some(match (is_strong, is_clear) {
        _ if without <= 0.5 * least => Word::ByPosture(worst),
        (false, _) => Word::Likely,
        (true, false) => Word::BySprings,
        (true, true) => Word::Rejected,
    }))
}

/// What the readings ask for of each quantity at `at`, where −2 ln L was `before` with all as stated.
fn described(stated: &StatedExperiment<'_>, at: &QuantityFit, before: f64) -> Vec<FreedQuantity> {
    let (fit, cell) = (stated.fit, stated.cell());
    let mut errors = stated.errors(at).into_iter();
    let one = |(quantity, place): &QuantityAtValue| FreedQuantity {
        words: String::new(),
        name: quantity.name().to_string(),
        key: words::key(cell, *quantity),
        stated: words::stated(cell, *quantity),
        asked: words::asked(cell, *quantity, place),
        standard_error: errors.by_ref().take(place.values.len()).collect(),
        likelihood_ratio: before - at.value,
        residual_rms_m: [fit, &at.fit].map(|fit| rms(fit.residual().as_slice())),
    };
    let mut freed: Vec<FreedQuantity> = at.values.iter().map(one).collect();
    for (freed_quantity, valued) in freed.iter_mut().zip(&at.values) {
        freed_quantity.words = words::wanted(cell, valued, freed_quantity);
    }
    freed
}

/// A quantity freed beside the axes alone, whose fit with all as stated is `linear`; `None` where that is not worth a
/// second look.
fn freed_alone(
    stated: &StatedExperiment<'_>,
    linear: &Linear<'_>,
    quantity: Quantity,
    is_more: bool,
) -> Option<QuantityFit> {
    let mut places = stated.starts(quantity).into_iter();
    let as_stated = vec![(quantity, places.next()?)];
    let score = stated.score(&as_stated[0], linear);
    let as_stated = QuantityFit::new(as_stated, stated.fit.clone(), false, None).ok()?;
    let before = as_stated.value;
    let mut starts: Vec<QuantityFit> = Vec::new();
    if is_more {
        starts.extend(places.filter_map(|place| stated.at(vec![(quantity, place)], false, None)));
        starts.retain(|at| at.value < before);
        sort_by_number(&mut starts, |at| at.value);
        starts.truncate(FOLLOWED);
    }
    starts.extend((score > WORTH_SEARCHING).then_some(as_stated));
    let ends = starts.into_iter().map(|at| stated.refined(at));
    let best = ends.min_by(|a, b| a.value.total_cmp(&b.value))?;
    (before - best.value > WORTH_SEARCHING).then_some(best)
}

/// Leaves out what springs beyond the axes explain as well: what helps the axes alone by little, and by the derivatives
/// of the mixed model helps that no more. The dear fits beside them are spared.
fn leave_out_swallowed(stated: &StatedExperiment<'_>, mixed: &MixedFit, alone: &mut Vec<QuantityFit>) {
    let before = value(stated.fit, None);
    let mut linear = None;
    alone.retain(|at| {
        // Derivatives at the stated value know nothing of a sign or an exchange of axes, and little of what is far off
        // and leaves clearly less.
        let [all, left] = [stated.fit, &at.fit].map(|fit| rms(fit.residual().as_slice()));
        let is_far = left < CLEAR_RESIDUAL_SHARE * all || at.values[0].1.turn != Matrix3::identity();
        if before - at.value > CLEAR_LIKELIHOOD && is_far {
            return true;
        }
        let quantity = at.values[0].0;
        let linear = linear.get_or_insert_with(|| Linear::new(stated, stated.fit, Some(mixed)));
        let first = stated.starts(quantity).into_iter().next();
        let both = linear.as_ref().zip(first);
        both.is_none_or(|(linear, first)| stated.score(&(quantity, first), linear) > WORTH_SEARCHING)
    });
}

/// Whether the quantity lies within what the cell states of it, or what is assumed: then the total ± has it. A force
/// along the load is known as well as its scale.
fn is_within_stated(fit: &Fit, (quantity, place): &QuantityAtValue, errors: &[Option<f64>]) -> bool {
    let uncertainty = &fit.cell().uncertainty;
    let size = match quantity {
        Quantity::Offset => {
            let largest = fit.experiment().largest_force().unwrap_or(0.0);
            Quantity::ForceScale.size(uncertainty, false).0 * largest
        }
        // What gives way is no error of the set-up.
        quantity if quantity.terms(0).is_some() => 0.0,
        quantity => quantity.size(uncertainty, false).0,
    };
    let mut both = place.values.iter().zip(errors);
    size > 0.0
        && place.turn == Matrix3::identity()
        && both.all(|(value, error)| value.abs() <= PLAUSIBLE_STDS * size.hypot(error.unwrap_or(0.0)))
}

/// By how much −2 ln L falls without the posture that gains most, and its name: one bad posture is no set-up.
fn without_worst(fit: &Fit, at: &QuantityFit, grants: bool) -> Result<(f64, String)> {
    let squares = |fit: &Fit, block: usize| {
        let rows = fit.system().blocks[block].rows.clone();
        fit.residual().rows(rows.start, rows.len()).norm_squared()
    };
    let gain = |block: &usize| squares(fit, *block) - squares(&at.fit, *block);
    let blocks = 0..fit.system().blocks.len();
    let Some(worst) = blocks.max_by(|a, b| gain(a).total_cmp(&gain(b))) else {
        return Ok((0.0, String::new()));
    };
    let value = |fit: &Fit| {
        let rows = fit.system().blocks[worst].rows.clone();
        match fit.filtered(|label| !rows.contains(&label.rows.start))? {
            Some(fit) => Ok(QuantityFit::new(at.values.clone(), fit, grants, at.sizes.as_ref())?.value),
            None => Ok(f64::INFINITY),
        }
    };
    let name = fit.system().blocks[worst].posture.clone();
    Ok((value(fit)? - value(&at.fit)?, name))
}
