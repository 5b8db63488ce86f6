//! Which row of a file is the heading, and units in brackets.

use crate::table::naming::{DATE, NAME, normal};
use crate::table::quantity::Quantity;
use stiffarm::model::cell::Columns;

/// Rows above a heading: titles, remarks, settings.
const MOST_ABOVE: usize = 100;

/// Columns that must be known for a row below the first to be a heading.
const ENOUGH: usize = 3;

/// Number of the first row, from 0, in which enough columns are known or mapped; `None` where
/// none of the first rows is one.
pub(in crate::table) fn find<R, F>(
    rows: impl IntoIterator<Item = R>,
    foreign: &Columns,
) -> Option<usize>
where
    R: IntoIterator<Item = F>,
    F: AsRef<str>,
{
    let mut rows = rows.into_iter().take(MOST_ABOVE);
    rows.position(|row| {
        let fields = row.into_iter();
        fields
            .filter(|field| is_known(field.as_ref(), foreign))
            .take(ENOUGH)
            .count()
            == ENOUGH
    })
}

fn is_known(field: &str, foreign: &Columns) -> bool {
    let name = normal(field);
    if name.is_empty() {
        return false;
    }
    let theirs = foreign.names.values().chain(&foreign.ignore);
    let mut theirs = theirs.chain(&foreign.name).chain(&foreign.date);
    theirs.any(|other| normal(other) == name) || is_own(&name) || own_unit(&name).is_some()
}

/// True for a heading of ours.
fn is_own(name: &str) -> bool {
    let (base, unit) = name.split_once('_').unwrap_or((name, ""));
    match quantity(base) {
        Some(quantity) => match quantity.units() {
            [] => unit.is_empty(),
            units => units.iter().any(|own| own.suffix == unit),
        },
        None => base == NAME || base == DATE,
    }
}

/// What a column of this name without unit holds.
fn quantity(base: &str) -> Option<Quantity> {
    let joint = |prefix: &str| {
        let number = base.strip_prefix(prefix);
        number.is_some_and(|n| !n.is_empty() && n.bytes().all(|b| b.is_ascii_digit()))
    };
    match base {
        "posture" | "state" | "point" => Some(Quantity::Name),
        "x" | "y" | "z" | "dx" | "dy" | "dz" | "along" => Some(Quantity::Length),
        "u95x" | "u95y" | "u95z" => Some(Quantity::Length),
        "fx" | "fy" | "fz" | "load" => Some(Quantity::Force),
        "mx" | "my" | "mz" => Some(Quantity::Moment),
        "time" => Some(Quantity::Time),
        "feed" => Some(Quantity::Feed),
        "power" => Some(Quantity::Power),
        "temperature" => Some(Quantity::Temperature),
        _ if joint("q") || joint("dq") => Some(Quantity::Angle),
        _ => None,
    }
}

/// Our heading for one whose unit stands in brackets: `X [mm]`, `x (m)`, `Fx [N]`.
pub(in crate::table) fn own_unit(name: &str) -> Option<String> {
    let inside = name
        .strip_suffix(']')
        .and_then(|name| name.split_once('['))
        .or_else(|| name.strip_suffix(')').and_then(|name| name.split_once('(')));
    let (base, unit) = inside?;
    let unit = match unit.trim() {
        "°" => "deg".to_string(),
        unit => unit
            .replace(['·', '*', ' ', '°'], "")
            .replace('/', "_per_")
            .to_lowercase(),
    };
    let base = base.trim();
    let known = quantity(base)?.units().iter().any(|own| own.suffix == unit);
    known.then(|| format!("{base}_{unit}"))
}
