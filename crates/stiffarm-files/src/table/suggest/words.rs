//! What the words of another software's headings say: quantities, units, and numbers that are not what was measured.

use crate::table::quantity::Quantity;

/// Units as they stand in headings, the usual one of a quantity first; those without a suffix of ours are none that a
/// column may have.
const UNITS: [(&[&str], Quantity, Option<&str>); 13] = [
    (&["mm", "millimetres", "millimeters"], Quantity::Length, Some("mm")),
    (&["m", "metres", "meters"], Quantity::Length, Some("m")),
    (&["um", "microns"], Quantity::Length, Some("um")),
    (&["in", "inch", "inches"], Quantity::Length, Some("in")),
    (&["cm", "dm", "km", "ft", "feet", "px", "pixel", "pixels"], Quantity::Length, None),
    (&["n", "newton", "newtons"], Quantity::Force, Some("n")),
    (&["kn"], Quantity::Force, Some("kn")),
    (&["lbf", "lb", "lbs", "kgf", "kg", "dan", "kp"], Quantity::Force, None),
    (&["nm"], Quantity::Moment, Some("nm")),
    (&["nmm"], Quantity::Moment, Some("nmm")),
    (&["lbin", "lbft", "inlb", "ftlb", "kgm"], Quantity::Moment, None),
    (&["deg", "degrees", "rad", "mrad"], Quantity::Angle, None),
    (&["s", "ms", "hz"], Quantity::Time, None),
];

/// Words for quantities.
const QUANTITIES: [(&[&str], Quantity); 4] = [
    (&["force", "forces", "kraft", "load"], Quantity::Force),
    (&["moment", "moments", "torque", "torques", "drehmoment"], Quantity::Moment),
    (&["angle", "rot", "rotation", "roll", "pitch", "yaw"], Quantity::Angle),
    (&["velocity", "vel", "speed", "acc", "accel", "acceleration"], Quantity::Feed),
];

/// Numbers of a converter, which are no forces without the calibration of the sensor.
const COUNTS: [&str; 10] = ["counts", "count", "cnts", "cnt", "cts", "adc", "raw", "bits", "lsb", "digits"];

/// Numbers that are not what was measured: what was wanted, and what differs from it.
const OTHERS: [&str; 34] = [
    "nominal",
    "nominals",
    "nom",
    "soll",
    "sollwert",
    "design",
    "cad",
    "theoretical",
    "theo",
    "target",
    "reference",
    "ref",
    "expected",
    "commanded",
    "command",
    "cmd",
    "setpoint",
    "desired",
    "planned",
    "dev",
    "deviation",
    "delta",
    "diff",
    "difference",
    "error",
    "rms",
    "sigma",
    "std",
    "uncertainty",
    "tol",
    "tolerance",
    "i",
    "j",
    "k",
];

/// What a heading says of its numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum HeadingMeaning {
    /// A component (0 to 2), or the size, of a quantity in a unit of ours.
    Measured(Quantity, Option<usize>, &'static str),
    /// Counts of a sensor of forces or moments.
    Counts(Quantity, Option<usize>),
    /// Numbers that were not measured, or in no unit of ours.
    Other,
    /// Nothing.
    Nothing,
}

/// The words of a heading, moments' units as one word.
pub(super) fn words(name: &str) -> Vec<String> {
    let split = |c: char| !c.is_alphanumeric();
    let words: Vec<&str> = name.split(split).filter(|word| !word.is_empty()).collect();
    let mut out: Vec<String> = Vec::new();
    for word in words {
        // N·m, N-mm, lb-in.
        let joined = out.last().map(|before| format!("{before}{word}"));
        let is_unit = |joined: &String| {
            let moments = UNITS.iter().filter(|unit| unit.1 == Quantity::Moment);
            moments.flat_map(|unit| unit.0).any(|unit_name| unit_name == joined)
        };
        match joined.filter(is_unit) {
            Some(joined) => {
                out.pop();
                out.push(joined);
            }
            None => out.push(word.to_string()),
        }
    }
    out
}

/// What the words of a heading say of its numbers.
pub(super) fn said(words: &[String]) -> HeadingMeaning {
    let has = |wanted: &[&str]| words.iter().any(|word| wanted.contains(&word.as_str()));
    // x, x1, fx and force of a word alone.
    let of_axis = |letter: &str| {
        let axes = ["x", "y", "z"];
        let named = |axis: &&str| has(&[&format!("{letter}{axis}"), &format!("{letter}{axis}1")]);
        axes.iter().position(named)
    };
    let [plain, force, moment, torque] = ["", "f", "m", "t"].map(of_axis);
    let unit = UNITS.iter().find(|unit| has(unit.0));
    let word = QUANTITIES.iter().find(|(words, _)| has(words));
    // A translation about x is called Tx as well.
    let torque = torque.filter(|_| unit.is_none_or(|unit| unit.1 != Quantity::Length));
    let quantity = match (force, moment.or(torque), word, unit) {
        (Some(_), ..) => Quantity::Force,
        (_, Some(_), ..) => Quantity::Moment,
        (.., Some(unit)) if [Quantity::Force, Quantity::Moment].contains(&unit.1) => unit.1,
        (_, _, Some((_, quantity)), _) => *quantity,
        (.., Some(unit)) => unit.1,
        _ => Quantity::Length,
    };
    let axis = plain.or(force).or(moment).or(torque);
    let is_load = [Quantity::Force, Quantity::Moment].contains(&quantity);
    let about = axis.is_some() || (is_load && (unit.is_some() || !has(&["load"])));
    match () {
        () if !about => HeadingMeaning::Nothing,
        () if is_load && has(&COUNTS) => HeadingMeaning::Counts(quantity, axis),
        () if has(&OTHERS) => HeadingMeaning::Other,
        () => match unit {
            Some((_, of, Some(suffix))) if *of == quantity => HeadingMeaning::Measured(quantity, axis, suffix),
            None if is_load || quantity == Quantity::Length => {
                let usual = UNITS.iter().find(|unit| unit.1 == quantity);
                let usual = usual.and_then(|unit| unit.2).unwrap_or_default();
                HeadingMeaning::Measured(quantity, axis, usual)
            }
            _ => HeadingMeaning::Other,
        },
    }
}

/// The key of a component of a quantity, without its unit.
pub(super) fn stem(quantity: Quantity, axis: Option<usize>) -> Option<&'static str> {
    match (quantity, axis) {
        (Quantity::Length, Some(axis)) => Some(["x", "y", "z"][axis]),
        (Quantity::Force, Some(axis)) => Some(["fx", "fy", "fz"][axis]),
        (Quantity::Moment, Some(axis)) => Some(["mx", "my", "mz"][axis]),
        (Quantity::Force, None) => Some("load"),
        _ => None,
    }
}
