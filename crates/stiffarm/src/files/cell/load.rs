//! `[load]`: the kind of load and the keys that belong to it.

use super::raw::{At, RawLoad, Text};
use super::source::Source;
use crate::error::{Code, Result, did_you_mean};
use crate::model::load::{Axes, Load, Wrench};
use crate::model::robot::Robot;
use crate::units::{STANDARD_GRAVITY, mm_to_m};
use nalgebra::Vector3;
use std::ops::Range;

/// The kinds of load, and the keys that each of them has beside `kind`.
const KINDS: [(&str, &[&str]); 5] = [
    ("rope", &["magnitude_n", "anchor_mm"]),
    (
        "cylinder",
        &["magnitude_n", "acts", "anchor_mm", "direction", "axes"],
    ),
    ("weight", &["magnitude_n", "mass_kg"]),
    ("wrench", &["force_n", "moment_nm", "axes"]),
    ("measured", &[]),
];

/// The two kinds of axes of a wrench.
const AXES_HINT: &str = "axes = \"base\" (fixed) or axes = \"tool\" (turning with the flange)";

/// The load of `robot`, whose direction of gravity a weight follows.
pub(super) fn load(
    source: &Source<'_>,
    table: &Option<At<RawLoad>>,
    robot: &Robot,
) -> Result<Load> {
    let hint = "add a table [load] with kind = \"rope\", \"cylinder\", \"weight\", \"wrench\" or \"measured\"";
    let table = source.required(table, "load", None, hint)?;
    let raw = table.get();
    let hint = "kind is one of \"rope\", \"cylinder\", \"weight\", \"wrench\", \"measured\"";
    let kind = source.required(&raw.kind, "load.kind", Some(table.span()), hint)?;
    let Some((name, keys)) = KINDS.iter().find(|(name, _)| name == kind.get()) else {
        let message = format!("Loads of kind \"{}\" are not known.", kind.get());
        let nearest = did_you_mean(kind.get(), KINDS.iter().map(|(name, _)| *name));
        let error = source.error(Code::InvalidValue, "load.kind", kind.span(), message);
        return Err(error.hint(nearest.unwrap_or_else(|| hint.to_string())));
    };
    refuse_foreign_keys(source, raw, name, keys)?;
    match *name {
        "rope" => rope(source, table),
        "cylinder" => cylinder(source, table),
        "weight" => Ok(Load::Weight {
            magnitude: weight(source, table)?,
            direction: *robot.gravity_direction(),
        }),
        "wrench" => wrench(source, table),
        _ => Ok(Load::Measured),
    }
}

/// A key of another kind of load would be ignored; that is refused.
fn refuse_foreign_keys(
    source: &Source<'_>,
    raw: &RawLoad,
    kind: &str,
    keys: &[&str],
) -> Result<()> {
    let given: [(&str, Option<Range<usize>>); 8] = [
        ("mass_kg", raw.mass_kg.as_ref().map(At::span)),
        ("magnitude_n", raw.magnitude_n.as_ref().map(At::span)),
        ("anchor_mm", raw.anchor_mm.as_ref().map(At::span)),
        ("acts", raw.acts.as_ref().map(At::span)),
        ("direction", raw.direction.as_ref().map(At::span)),
        ("force_n", raw.force_n.as_ref().map(At::span)),
        ("moment_nm", raw.moment_nm.as_ref().map(At::span)),
        ("axes", raw.axes.as_ref().map(At::span)),
    ];
    for (key, span) in given {
        let Some(span) = span.filter(|_| !keys.contains(&key)) else {
            continue;
        };
        let owners: Vec<String> = KINDS
            .iter()
            .filter(|(_, keys)| keys.contains(&key))
            .map(|(name, _)| format!("\"{name}\""))
            .collect();
        let message = format!("A load of kind \"{kind}\" has no {key}.");
        let hint = format!("remove it, or set kind = {}", owners.join(" or "));
        let key = format!("load.{key}");
        return Err(source.error(Code::Conflict, &key, span, message).hint(hint));
    }
    Ok(())
}

fn magnitude(source: &Source<'_>, table: &At<RawLoad>) -> Result<f64> {
    let key = "load.magnitude_n";
    let hint = "give the force in newtons: magnitude_n = 500";
    let value = source.required(&table.get().magnitude_n, key, Some(table.span()), hint)?;
    source.positive(value, key)
}

/// The force of a weight, given as such or by its mass.
fn weight(source: &Source<'_>, table: &At<RawLoad>) -> Result<f64> {
    let raw = table.get();
    let Some(mass) = &raw.mass_kg else {
        return magnitude(source, table);
    };
    let key = "load.mass_kg";
    if raw.magnitude_n.is_some() {
        let message = "The weight is given twice: magnitude_n is there already.";
        let error = source.error(Code::Conflict, key, mass.span(), message);
        return Err(error.hint("keep one of magnitude_n and mass_kg"));
    }
    Ok(source.positive(mass, key)? * STANDARD_GRAVITY)
}

fn rope(source: &Source<'_>, table: &At<RawLoad>) -> Result<Load> {
    let magnitude = magnitude(source, table)?;
    let key = "load.anchor_mm";
    let hint = "give the rope's fixed end: anchor_mm = [x, y, z] in the base frame";
    let anchor = source.required(&table.get().anchor_mm, key, Some(table.span()), hint)?;
    let anchor = source.vector(anchor, key)?.map(mm_to_m);
    Ok(Load::Rope { anchor, magnitude })
}

/// A cylinder or screw: towards or away from its other end, or along a direction.
fn cylinder(source: &Source<'_>, table: &At<RawLoad>) -> Result<Load> {
    let (raw, at) = (table.get(), Some(table.span()));
    let size = magnitude(source, table)?;
    let hint = "acts = \"pulls\" or acts = \"pushes\": what the cylinder does to the robot";
    let acts = source.required(&raw.acts, "load.acts", at.clone(), hint)?;
    let magnitude = match acts.get().as_str() {
        "pulls" => size,
        "pushes" => -size,
        other => {
            let message = format!("A cylinder \"pulls\" or \"pushes\", got \"{other}\".");
            let nearest = did_you_mean(other, ["pulls", "pushes"]);
            let error = source.error(Code::InvalidValue, "load.acts", acts.span(), message);
            return Err(error.hint(nearest.unwrap_or_else(|| hint.to_string())));
        }
    };
    let ways = "give its other end (anchor_mm = [x, y, z], base frame), or the direction of its pull \
                (direction = [x, y, z] with axes) where it is guided";
    let (list, key) = match (&raw.anchor_mm, &raw.direction) {
        (Some(_), Some(direction)) => {
            let message = "The cylinder's line is given twice: anchor_mm is there already.";
            let key = "load.direction";
            let error = source.error(Code::Conflict, key, direction.span(), message);
            return Err(error.hint("keep one of anchor_mm and direction"));
        }
        (Some(anchor), None) => {
            if let Some(axes) = &raw.axes {
                let message =
                    "A cylinder with anchor_mm has no axes: the anchor is in the base frame.";
                let error = source.error(Code::Conflict, "load.axes", axes.span(), message);
                return Err(error.hint("remove it, or give direction instead of anchor_mm"));
            }
            let anchor = source.vector(anchor, "load.anchor_mm")?.map(mm_to_m);
            return Ok(Load::Rope { anchor, magnitude });
        }
        (None, list) => (
            source.required(list, "load.direction", at.clone(), ways)?,
            "load.direction",
        ),
    };
    let Some(direction) = source.vector(list, key)?.try_normalize(0.0) else {
        let message = "The direction is zero.";
        let error = source.error(Code::InvalidValue, key, list.span(), message);
        return Err(error.hint(
            "give the direction of the cylinder's pull, of any length: direction = [0, 0, 1]",
        ));
    };
    let key = "load.axes";
    let given = source.required(&raw.axes, key, at, AXES_HINT)?;
    Ok(Load::Constant {
        wrench: Wrench::force(direction * magnitude),
        axes: axes(source, given, key)?,
    })
}

fn wrench(source: &Source<'_>, table: &At<RawLoad>) -> Result<Load> {
    let (raw, at) = (table.get(), Some(table.span()));
    let key = "load.force_n";
    let hint = "give the force on the robot: force_n = [x, y, z] in newtons";
    let given = source.required(&raw.force_n, key, at.clone(), hint)?;
    let force = source.vector(given, key)?;
    let moment = match &raw.moment_nm {
        Some(moment) => source.vector(moment, "load.moment_nm")?,
        None => Vector3::zeros(),
    };
    if force == Vector3::zeros() && moment == Vector3::zeros() {
        let message = "Force and moment are zero: nothing loads the robot.";
        return Err(source.error(Code::InvalidValue, key, given.span(), message));
    }
    let key = "load.axes";
    let given = source.required(&raw.axes, key, at, AXES_HINT)?;
    let axes = axes(source, given, key)?;
    Ok(Load::Constant {
        wrench: Wrench { force, moment },
        axes,
    })
}

/// The axes of a wrench.
pub(super) fn axes(source: &Source<'_>, given: &Text, key: &str) -> Result<Axes> {
    match given.get().as_str() {
        "base" => Ok(Axes::Base),
        "tool" => Ok(Axes::Tool),
        other => {
            let message = format!("Axes \"{other}\" are not known.");
            let error = source.error(Code::InvalidValue, key, given.span(), message);
            Err(error.hint(AXES_HINT))
        }
    }
}
