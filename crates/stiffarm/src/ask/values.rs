//! Values that several commands read alike. Each number is refused where it cannot be
//! meant: nothing that is computed from an option is infinite.

use crate::estimate::elastic::ElasticChoice;
use crate::model::process::ForceAxes;
use crate::model::stiffness::Model;
use crate::units::Sense;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use std::ops::RangeInclusive;
use std::time::Duration;

/// A number of things to make: at least one, and not by a slip a million.
pub fn count<T: TryFrom<u64>>() -> impl Fn(&str) -> Result<T, String> + Clone {
    within(1..=1_000_000)
}

/// The same for a number that may be zero.
pub fn count_or_none() -> impl Fn(&str) -> Result<usize, String> + Clone {
    within(0..=1_000_000)
}

/// Any seed of random numbers.
pub fn seed() -> impl Fn(&str) -> Result<u64, String> + Clone {
    within(0..=u64::MAX)
}

/// A whole number of a range; one up to the last u64 is said to have no end.
pub fn within<T: TryFrom<u64>>(range: RangeInclusive<u64>) -> impl Fn(&str) -> Result<T, String> + Clone {
    move |text| {
        let whole = text.parse().ok().filter(|whole| range.contains(whole));
        let number = whole.and_then(|whole| T::try_from(whole).ok());
        number.ok_or_else(|| match range.clone().into_inner() {
            (low, u64::MAX) => format!("a whole number from {low} on is needed"),
            (low, high) => format!("a whole number from {low} to {high} is needed"),
        })
    }
}

/// One of the library's values by its name; `shown` is the name, and what is said of it.
pub fn one_of<T: Copy + Send + Sync + 'static>(
    all: &'static [T],
    shown: fn(T) -> PossibleValue,
) -> impl TypedValueParser<Value = T> {
    let names = all.iter().map(|value| shown(*value));
    PossibleValuesParser::new(names).try_map(move |name| {
        let selected = all.iter().find(|value| shown(**value).matches(&name, false));
        selected.copied().ok_or("it is none of these")
    })
}

/// A value's name, what is said of it, and the value.
pub type Choice<T> = (&'static str, &'static str, T);

/// One of these values by its name.
pub fn choice<T: Copy + Send + Sync + 'static>(all: &'static [Choice<T>]) -> impl TypedValueParser<Value = T> {
    let shown = |(name, about, _): Choice<T>| PossibleValue::new(name).help(about);
    one_of(all, shown).map(|(.., value)| value)
}

/// A number in a unit, which is the end of its option's name.
pub fn number(unit: &'static str) -> impl Fn(&str) -> Result<f64, String> + Clone {
    move |text| one(text, unit)
}

/// A number above zero.
pub fn above_zero(unit: &'static str) -> impl Fn(&str) -> Result<f64, String> + Clone {
    move |text| {
        let smallest = Sense::of(unit).map_or(f64::MIN_POSITIVE, |sense| sense.smallest);
        match one(text, unit)? {
            value if value >= smallest => Ok(value),
            value if value > 0.0 => Err(format!("the number must be {smallest:e} or more")),
            _ => Err("a number above zero is needed, with a point for decimals".to_string()),
        }
    }
}

/// Numbers in a unit with commas between them.
pub fn numbers<const N: usize>(
    unit: &'static str,
    wanted: &'static str,
) -> impl Fn(&str) -> Result<[f64; N], String> + Clone {
    move |text| {
        let mut numbers = Vec::new();
        for part in text.split(',') {
            match part.trim().parse::<f64>() {
                Ok(value) if value.is_finite() => numbers.push(meant(value, unit)?),
                _ => return Err(wanted.to_string()),
            }
        }
        numbers.try_into().map_err(|_| wanted.to_string())
    }
}

/// Three numbers in a unit.
pub fn triple(unit: &'static str) -> impl Fn(&str) -> Result<[f64; 3], String> + Clone {
    numbers(unit, "three numbers with commas between them are needed")
}

fn one(text: &str, unit: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(value) if value.is_finite() => meant(value, unit),
        _ => Err("a finite number is needed, with a point for decimals".to_string()),
    }
}

/// The number, where it can be meant.
fn meant(value: f64, unit: &str) -> Result<f64, String> {
    match Sense::of(unit).and_then(|sense| sense.refuse(value)) {
        Some(sentence) => Err(sentence.trim_end_matches('.').to_string()),
        None => Ok(value),
    }
}

/// Steps of angles: 0, or what a pendant may take.
pub fn angle_step() -> impl Fn(&str) -> Result<f64, String> + Clone {
    |text| {
        let step = number("deg")(text)?;
        if step == 0.0 || (1e-6..=1.0).contains(&step) {
            Ok(step)
        } else {
            Err("give a step from 0.000001 to 1 degree, or 0 to leave the angles as they are".to_string())
        }
    }
}

/// A pause between two things, in seconds.
pub fn pause() -> impl Fn(&str) -> Result<Duration, String> + Clone {
    |text| match text.trim().parse::<f64>() {
        Ok(seconds) if (0.02..=3600.0).contains(&seconds) => Ok(Duration::from_secs_f64(seconds)),
        _ => Err("give seconds from 0.02 to 3600".to_string()),
    }
}

/// How displacements are calculated.
pub const MODEL: &[Choice<Model>] =
    &[("linear", "Linear in the load", Model::Linear), ("equilibrium", "Exact static equilibrium", Model::Equilibrium)];

/// What gives way.
pub const ELASTIC: &[Choice<ElasticChoice>] = &[
    ("axes", "The joint axes alone", ElasticChoice::Axes),
    ("mixed", "Joints and base in all directions, as far as the data show", ElasticChoice::Mixed),
];

/// Axes of a path's forces.
pub const AXES: &[Choice<ForceAxes>] = &[
    ("base", "The robot's base", ForceAxes::Base),
    ("tool", "The tip frame; its z is the tool axis", ForceAxes::Tool),
    ("workpiece", "The workpiece frame of the cell", ForceAxes::Workpiece),
    ("path", "The path: z the tool axis, x the feed direction across it", ForceAxes::Path),
];
