//! What is checked before the fit: number, names, finiteness, units, lines.

use super::fit::{Sample, rigid};
use super::{PointPair, RegisterOptions};
use crate::error::{Code, Error, Result};
use crate::units::m_to_mm;
use nalgebra::Vector3;
use std::collections::HashSet;

/// Factors between the frames that are slips of a unit, and what each means:
/// the shorter set is in the first unit, the longer one in the second.
const UNITS: [(f64, &str, &str); 5] = [
    (1000.0, "metres", "millimetres"),
    (25.4, "inches", "millimetres"),
    (10.0, "centimetres", "millimetres"),
    (304.8, "feet", "millimetres"),
    (1e6, "metres", "micrometres"),
];
/// How near the ratio must be to such a factor.
const UNIT_TOLERANCE: f64 = 0.02;
/// Ratios of distances between the frames that are no longer errors of
/// measurement.
const PLAUSIBLE: std::ops::Range<f64> = 0.8..1.25;
/// Upper over lower quartile of the ratios, below which they tell one scale.
const ONE_SCALE: f64 = 1.1;
/// Points whose distances are compared: enough for a median.
const COMPARED: usize = 200;

pub(super) fn check_options(pairs: &[PointPair], options: &RegisterOptions) -> Result<()> {
    let positive = |v: f64| v.is_finite() && v > 0.0;
    if options.std.is_some_and(|std| !positive(std)) {
        return Err(Error::invalid("The standard deviation of the pairs must be above zero."));
    }
    if !options.weights.is_empty() && options.weights.len() != pairs.len() {
        let message = format!("{} weights for {} point pairs.", options.weights.len(), pairs.len());
        return Err(Error::new(Code::Dimension, message));
    }
    if options.weights.iter().any(|w| !positive(*w)) {
        return Err(Error::invalid("The weight of a point pair must be above zero.")
            .hint("leave out a pair that is not to count"));
    }
    Ok(())
}

pub(super) fn check_pairs(pairs: &[PointPair]) -> Result<()> {
    let mut names = HashSet::new();
    for pair in pairs {
        if !names.insert(pair.name.as_str()) {
            let message = format!("The point \"{}\" appears twice.", pair.name);
            return Err(Error::new(Code::Duplicate, message)
                .hint("average repeated readings of a point, or give each a name of its own"));
        }
        let mut coordinates = pair.tracker.iter().chain(pair.base.iter());
        if coordinates.any(|v| !v.is_finite()) {
            let message = format!("A coordinate of the point \"{}\" is not a finite number.", pair.name);
            return Err(Error::new(Code::NotFinite, message));
        }
    }
    if pairs.len() < 3 {
        let number = match pairs.len() {
            0 => "no point pair".to_string(),
            1 => "one point pair".to_string(),
            count => format!("{count} point pairs"),
        };
        let message = format!("There is {number}; a registration needs at least 3 that are not on a line.").replacen(
            "There is 2",
            "There are 2",
            1,
        );
        return Err(
            Error::new(Code::TooFewData, message).hint("5 or more well spread pairs also tell which one is wrong")
        );
    }
    check_line(pairs, "tracker", |pair| pair.tracker)?;
    check_line(pairs, "base", |pair| pair.base)?;
    check_units(pairs)
}

/// Refuses points on a line: the turn about it would be anything.
fn check_line(pairs: &[PointPair], axes: &str, of: fn(&PointPair) -> Vector3<f64>) -> Result<()> {
    let samples: Vec<Sample> =
        pairs.iter().map(|pair| Sample { tracker: of(pair), base: of(pair), weight: 1.0 }).collect();
    let fit = rigid(&samples).ok_or_else(|| {
        Error::new(Code::Numerical, "The singular value decomposition of the points did not converge.")
    })?;
    let is_one_point = fit.spread[0] <= fit.rounding.sqrt();
    if fit.rank() == 6 && !is_one_point {
        return Ok(());
    }
    if is_one_point {
        let message = format!("All points are one and the same in {axes} axes.");
        return Err(Error::new(Code::Registration, message));
    }
    let root = (pairs.len() as f64).sqrt();
    let [along, across, _] = fit.spread.map(|s| m_to_mm(s / root));
    let message = format!(
        "The points lie on a line in {axes} axes: {across:.2} mm off it (RMS) over {along:.0} mm along it. The turn \
         about that line cannot be determined."
    );
    Err(Error::new(Code::Registration, message)
        .hint("add a point well off that line, by a third of its length if you can"))
}

/// Compares the distances between the points in both frames, which no rigid
/// transform changes.
fn check_units(pairs: &[PointPair]) -> Result<()> {
    let Some((ratio, quartiles)) = distance_ratio(pairs) else {
        return Ok(());
    };
    if PLAUSIBLE.contains(&ratio) || quartiles[1] > ONE_SCALE * quartiles[0] {
        // Ratios that differ from pair to pair tell wrong points, not a unit.
        return Ok(());
    }
    let (longer, shorter, factor) =
        if ratio > 1.0 { ("base", "tracker", ratio) } else { ("tracker", "base", 1.0 / ratio) };
    let unit_pair = UNITS.iter().find(|(unit, ..)| (factor / unit - 1.0).abs() < UNIT_TOLERANCE);
    let shown = match unit_pair {
        Some((unit, ..)) => unit.to_string(),
        None => format!("{factor:.3}"),
    };
    let message =
        format!("Distances between the points are {shown} times longer in {longer} axes than in {shorter} axes.");
    let hint = match unit_pair {
        Some((_, small, large)) => format!(
            "the {shorter} coordinates look like {small}, the {longer} coordinates like {large}: \
             both must have the same unit"
        ),
        None => "both frames must have the same unit; are the points the same?".to_string(),
    };
    Err(Error::new(Code::Registration, message).hint(hint))
}

/// Median and quartiles of base over tracker distance between two points.
fn distance_ratio(pairs: &[PointPair]) -> Option<(f64, [f64; 2])> {
    let pairs = &pairs[..pairs.len().min(COMPARED)];
    let mut ratios = Vec::new();
    for (i, a) in pairs.iter().enumerate() {
        for b in &pairs[..i] {
            let (tracker, base) = ((a.tracker - b.tracker).norm(), (a.base - b.base).norm());
            if tracker > 0.0 && base > 0.0 {
                ratios.push(base / tracker);
            }
        }
    }
    ratios.sort_by(f64::total_cmp);
    let last = ratios.len().checked_sub(1)?;
    let at = |share: f64| ratios[(share * last as f64).round() as usize];
    Some((at(0.5), [at(0.25), at(0.75)]))
}
