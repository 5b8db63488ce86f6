//! Which row of a file is the heading, and units in brackets.

use super::beside::RowQuantity;
use super::naming::{DATE, NAME, normal};
use super::place::place_of;
use super::quantity::Quantity;
use stiffarm::model::cell::Columns;

/// Rows above a heading: titles, remarks, settings.
const MOST_ABOVE: usize = 100;

/// Columns that must be known for a row below the first to be a heading.
const FEWEST_COLUMNS: usize = 3;

/// Number of the first row, from 0, in which enough columns are known or mapped; `None` where
/// none of the first rows is one.
pub(super) fn find<R, F>(rows: impl IntoIterator<Item = R>, foreign: &Columns) -> Option<usize>
where
    R: IntoIterator<Item = F>,
    F: AsRef<str>,
{
    let mut rows = rows.into_iter().take(MOST_ABOVE);
    rows.position(|row| {
        let fields = row.into_iter();
        fields.filter(|field| is_known(field.as_ref(), foreign)).take(FEWEST_COLUMNS).count() == FEWEST_COLUMNS
    })
}

fn is_known(field: &str, foreign: &Columns) -> bool {
    let name = normal(field);
    if name.is_empty() {
        return false;
    }
    // A number is the place of a column.
    let is_name = |ignored: &&String| ignored.parse::<usize>().is_err();
    let theirs = foreign.ignore.iter().filter(is_name);
    let theirs = foreign.names.values().chain(theirs);
    let mut theirs = theirs.chain(&foreign.name).chain(&foreign.date);
    theirs.any(|other| normal(other) == name) || is_own(&name) || own_unit(&name).is_some()
}

/// True for a heading of ours.
fn is_own(name: &str) -> bool {
    let (base, unit) = name.split_once('_').unwrap_or((name, ""));
    match quantity(base) {
        Some(quantity) => match quantity.units() {
            [] => unit.is_empty(),
            units => units.iter().any(|allowed| allowed.suffix == unit),
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
        "feed" => Some(Quantity::Feed),
        "power" => Some(Quantity::Power),
        _ if joint("q") || joint("dq") => Some(Quantity::Angle),
        _ => RowQuantity::quantity_of(base),
    }
}

/// Signs between a name and its unit, and around it.
const AROUND_UNIT: [char; 14] = [' ', '_', '/', '[', ']', '(', ')', '{', '}', '<', '>', ',', ':', '.'];

/// Our heading for one whose unit stands in brackets or behind a sign: `X [mm]`, `x (m)`, `Fx / N`,
/// `x_(mm)`, `y in mm`, and `x..mm.` as R makes of brackets.
pub(super) fn own_unit(name: &str) -> Option<String> {
    let end = name.find(|c: char| !c.is_ascii_alphanumeric())?;
    let (base, unit) = name.split_at(end);
    // Torques about x, y and z; with a unit of length they are something else.
    let torques = [("tx", "mx"), ("ty", "my"), ("tz", "mz")];
    let torque = torques.iter().find(|(theirs, _)| *theirs == base);
    let base = torque.map_or(base, |(_, ours)| ours);
    let unit = unit.trim_matches(AROUND_UNIT);
    let unit = match unit.strip_prefix("in ").unwrap_or(unit).trim_matches(AROUND_UNIT) {
        "°" => "deg".to_string(),
        unit => unit.replace(['·', '*', ' ', '°', '-'], "").replace('/', "_per_").to_lowercase(),
    };
    let is_unit = quantity(base)?.units().iter().any(|allowed| allowed.suffix == unit);
    is_unit.then(|| format!("{base}_{unit}"))
}

/// The columns with which a sheet of our own begins; the last three have a unit.
const OWN_SHEET: [&str; 6] = ["posture", "state", "point", "x", "y", "z"];

/// What counts for a file whose heading is that of a sheet of our own, beside which another
/// software's export may be read: its names are ours, whatever `[columns]` calls so there.
pub(super) fn of_own_sheet<R, F>(rows: impl IntoIterator<Item = R>, foreign: &Columns) -> Option<Columns>
where
    R: IntoIterator<Item = F>,
    F: AsRef<str>,
{
    let rows = rows.into_iter().take(MOST_ABOVE);
    let names = |row: R| -> Vec<String> {
        let fields = row.into_iter().take(OWN_SHEET.len());
        fields.map(|field| normal(field.as_ref())).collect()
    };
    let is_sheet = |row: &Vec<String>| {
        let mut pairs = row.iter().zip(OWN_SHEET);
        row.len() == OWN_SHEET.len()
            && pairs.all(|(name, stem)| {
                is_own(name) && (name == stem || name.strip_prefix(stem).is_some_and(|u| u.starts_with('_')))
            })
    };
    let heading = rows.map(names).find(is_sheet)?;
    let is_ours = |theirs: &String| heading.contains(&normal(theirs));
    let mut columns = foreign.clone();
    columns.ignore.retain(|theirs| !is_ours(theirs) && place_of(theirs).is_none());
    columns.names.retain(|_, theirs| !is_ours(theirs));
    columns.name.take_if(|theirs| is_ours(theirs));
    columns.date.take_if(|theirs| is_ours(theirs));
    columns.separator = None;
    Some(columns)
}
