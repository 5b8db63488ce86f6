//! What the sentences of findings are made of: lengths, angles and ratios, places, causes as half a sentence, units.

use super::units::{DISPLACEMENTS, ENTRIES, FORCES, MOMENTS, PRIORS, Unit};
use super::{Cause, Suspicion};
use crate::findings::list;
use crate::model::cell::Cell;
use crate::units::m_to_mm;

/// Length in mm with about three digits.
pub(super) fn mm(length: f64) -> String {
    let value = m_to_mm(length);
    match value.abs() {
        v if v >= 100.0 => format!("{value:.0} mm"),
        v if v >= 1.0 => format!("{value:.1} mm"),
        v if v >= 0.1 => format!("{value:.2} mm"),
        _ => format!("{value:.3} mm"),
    }
}

/// An angle in degrees as one would type it.
pub(super) fn degrees(angle: f64) -> String {
    let text = format!("{angle:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    match text {
        "-0" => "0°".to_string(),
        text => format!("{text}°"),
    }
}

/// A ratio in words: how many times too large or small.
pub(super) fn times(factor: Option<f64>) -> (String, &'static str) {
    let factor = factor.unwrap_or(1.0);
    let (value, size) = if factor < 1.0 { (1.0 / factor, "small") } else { (factor, "large") };
    let digits = usize::from((value - value.round()).abs() > 0.05 && value < 100.0);
    (format!("{value:.digits$}"), size)
}

/// How an angle was perhaps mistyped.
pub(super) fn mistyped(written: f64, likely: f64) -> &'static str {
    const CLOSE: f64 = 0.06;
    let near = |a: f64| (a - likely).abs() < CLOSE;
    if near(written * 10.0) || near(written / 10.0) {
        return " (decimal point misplaced?)";
    }
    let text: Vec<char> = format!("{written}").chars().collect();
    let digits: Vec<usize> = (0..text.len()).filter(|i| text[*i].is_ascii_digit()).collect();
    // Angles in radians and back leave endless digits; only typed ones count.
    if digits.len() > 6 {
        return "";
    }
    for (n, i) in digits.iter().enumerate() {
        for j in &digits[n + 1..] {
            let mut other = text.clone();
            other.swap(*i, *j);
            let other: String = other.into_iter().collect();
            if other.parse().is_ok_and(near) {
                return " (digits exchanged?)";
            }
        }
    }
    ""
}

/// `posture 3, loaded`, or `postures 2 and 5`; empty for all.
pub(super) fn place(s: &Suspicion) -> String {
    let mut out = match &s.postures[..] {
        [] => return String::new(),
        [one] => format!("posture {one}"),
        more => format!("postures {}", list(more)),
    };
    if !s.states.is_empty() {
        out += &format!(", {}", list(&s.states));
    }
    out
}

/// The place at the beginning of a sentence.
pub(super) fn opening(s: &Suspicion) -> String {
    let place = place(s);
    match place.strip_prefix('p') {
        Some(rest) => format!("P{rest}"),
        None => "All postures".to_string(),
    }
}

/// ` (lines 4 and 5)`.
pub(super) fn lines(s: &Suspicion) -> String {
    let numbers: Vec<String> = s.lines.iter().map(usize::to_string).collect();
    match &numbers[..] {
        [] => String::new(),
        [one] => format!(" (line {one})"),
        more => format!(" (lines {})", list(more)),
    }
}

/// `from 152 mm to 0.03 mm`.
pub(super) fn fall(s: &Suspicion) -> String {
    match (s.before_m, s.after_m) {
        (Some(before), Some(after)) => format!("from {} to {}", mm(before), mm(after)),
        _ => "clearly".to_string(),
    }
}

/// What else explains it, where there is something.
pub(super) fn alternatives(s: &Suspicion) -> String {
    if s.alternatives.is_empty() {
        String::new()
    } else if s.evidence.is_some() {
        let all = s.alternatives.join("; or by ");
        format!(" It would also be explained by {all}.")
    } else {
        format!(" Explains it as well: {}.", list(&s.alternatives))
    }
}

/// The cause as half a sentence, for lists of alternatives.
pub(super) fn cause(cell: &Cell, s: &Suspicion) -> String {
    let [joints, points, postures] = [&s.joints, &s.points, &s.postures].map(|of| list(of));
    let [written, likely] = [0, 1].map(|i| angle(s, i));
    let turn = if s.joints.len() == 1 { "turns" } else { "turn" };
    match s.cause {
        Cause::ExchangedPoints if s.points.len() == 2 => format!("points {points} are exchanged"),
        Cause::ExchangedPoints => format!("points {points} are mixed up"),
        Cause::MirroredFrame => "an axis has the wrong sign, or two columns are exchanged".to_string(),
        Cause::JointSign => format!("{joints} {turn} the other way"),
        Cause::Coupling => {
            let names = cell.setup.robot.joints().iter().map(|j| j.name.as_str());
            let names: Vec<&str> = names.collect();
            let [two, three] = [1, 2].map(|j| names.get(j).copied().unwrap_or_default());
            let mut out = match (cell.setup.robot.coupling()[(2, 1)], s.factor.unwrap_or(0.0)) {
                (0.0, likely) => format!(
                    "{three} were coupled to {two} (its serial angle contains {likely:+} times the other's; in the \
                     cell it does not)"
                ),
                (stated, 0.0) => format!(
                    "{three} were not coupled to {two} (in the cell its serial angle contains {stated:+} times the \
                     other's)"
                ),
                (stated, likely) => format!(
                    "the serial angle of {three} contained {likely:+} times that of {two}, not {stated:+} times"
                ),
            };
            if !s.joints.is_empty() {
                out += &format!(" and {joints} {turn} the other way");
            }
            out
        }
        Cause::JointOffset if is_last(cell, s) => format!(
            "the tool sat turned by {written} about the axis of {joints} on the flange, or {joints} were off by that \
             throughout"
        ),
        Cause::JointOffset => format!("{joints} is off by {written} throughout"),
        Cause::Radians => "the angles are in radians".to_string(),
        Cause::Degrees => "the angles are in degrees".to_string(),
        Cause::AngleSign | Cause::MistypedAngle => format!("{joints} is {likely}, not {written}"),
        Cause::DhConvention => {
            let other = cell.setup.robot.convention().other().name();
            format!("its rows were {other} ones")
        }
        Cause::ExchangedPostures => format!("postures {postures} are exchanged"),
        Cause::OtherPosture => match s.postures.get(1) {
            Some(other) => format!("the angles of posture {other}"),
            None => "the angles of another posture".to_string(),
        },
        Cause::ToolPlace => tool_place(s),
        _ => phrase(s),
    }
}

/// How all measuring points sit elsewhere:
/// `moved by (0.0, 0.0, 100.0) mm and turned by 90.0° about (0.00, 0.00, 1.00)`.
fn tool_place(s: &Suspicion) -> String {
    let vector = |of: &[f64], digits: usize| {
        let all = of.iter().map(|v| format!("{:.digits$}", v + 0.0));
        all.collect::<Vec<_>>().join(", ")
    };
    let size = s.angles_deg.iter().map(|a| a * a).sum::<f64>().sqrt();
    let axis: Vec<f64> = s.angles_deg.iter().map(|a| a / size).collect();
    let mut out = format!("moved by ({}) mm", vector(&s.tool_shift_mm, 1));
    if size > 0.05 {
        out += &format!(" and turned by {size:.1}° about ({})", vector(&axis, 2));
    }
    out
}

/// True where the last joint alone is meant.
pub(super) fn is_last(cell: &Cell, s: &Suspicion) -> bool {
    let last = cell.setup.robot.joints().last();
    last.is_some_and(|last| s.joints == [last.name.as_str()])
}

pub(super) fn angle(s: &Suspicion, i: usize) -> String {
    s.angles_deg.get(i).map_or_else(String::new, |a| degrees(*a))
}

/// A factor as people know it: `9.81`, `4.448`, `1000`, `25.4`, `1/9.81`.
pub(super) fn number(factor: f64) -> String {
    let digits = |f: f64| match f {
        f if (f - 9.806_65).abs() < 1e-3 => "9.81".to_string(),
        f if f >= 1000.0 || (f - f.round()).abs() < 1e-9 => format!("{f:.0}"),
        f if f >= 10.0 => format!("{f:.1}"),
        f => format!("{f:.3}"),
    };
    if factor < 1.0 { format!("1/{}", digits(1.0 / factor)) } else { digits(factor) }
}

/// How many times too small or large a stiffness is, with two digits.
pub(super) fn below_or_above(ratio: f64) -> String {
    let (size, word) = if ratio < 1.0 { (1.0 / ratio, "below") } else { (ratio, "above") };
    let digits = if size < 9.95 { 1 } else { 0 };
    format!("{size:.digits$} times {word}")
}

/// What is typed, and the factor on it: `kilograms (kgf), factor 9.81`.
pub(super) fn typed(s: &Suspicion) -> String {
    let units: &[Unit] = match s.cause {
        Cause::LoadUnits => &FORCES,
        Cause::LoadEntry => &ENTRIES,
        Cause::MomentUnits => &MOMENTS,
        Cause::PriorUnits => &PRIORS,
        _ => &DISPLACEMENTS,
    };
    let factor = s.factor.unwrap_or(1.0);
    let mut units = units.iter();
    let unit = units.find(|u| (u.factor / factor - 1.0).abs() < 1e-6);
    unit.map_or("another unit", |u| u.typed).to_string()
}

/// A scale beside others that explain alike.
pub(super) fn phrase(s: &Suspicion) -> String {
    let (typed, factor) = (typed(s), number(s.factor.unwrap_or(1.0)));
    let what = match s.cause {
        Cause::LoadUnits => "loads typed in ",
        Cause::PriorUnits => "a prior stiffness ",
        Cause::DisplacementUnits if s.postures.is_empty() => "displacements in ",
        _ => "",
    };
    format!("{what}{typed}, factor {factor}")
}

/// What says where loads stand.
pub(super) fn where_loads_stand(cell: &Cell) -> &'static str {
    match (&cell.sensor, cell.setup.load.size()) {
        (Some(_), _) => "fx_n, fy_n, fz_n (N) and mx_nm, my_nm, mz_nm (N·m)",
        (None, Some(_)) => "load_n and load.magnitude_n (N)",
        _ => "the forces of the table and [load] (N)",
    }
}
