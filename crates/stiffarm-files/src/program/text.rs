//! Lines, comments and numbers of programs.

use super::characters::plain;
use super::{MoveKind, Program};
use stiffarm::units::rad_to_deg;

/// A name of at most `width` characters.
pub fn name(name: &str, width: usize) -> String {
    let mut name = plain(name);
    name.truncate(width);
    name.trim_end().to_string()
}

/// What stands in a comment before a move.
pub fn marker(kind: MoveKind, posture: &str, width: usize) -> String {
    format!("{} {}", kind.as_str(), name(posture, width))
}

/// Kind and name in such a comment.
pub fn marked(comment: &str) -> Option<(MoveKind, String)> {
    let (word, name) = comment.trim().split_once(' ')?;
    let kind = MoveKind::ALL.into_iter().find(|kind| kind.as_str() == word)?;
    Some((kind, name.trim().to_string()))
}

/// Decimals of the angles in degrees: as few as lose nothing, two at least, `most` at most.
pub fn decimals(program: &Program, most: usize) -> usize {
    let angles: Vec<f64> = program.moves().flat_map(|m| m.q.iter().map(|a| rad_to_deg(*a))).collect();
    let exact = |digits: usize| {
        let factor = 10f64.powi(digits as i32);
        // Degrees of an angle in radians are off by the last bits.
        angles.iter().all(|a| (a * factor - (a * factor).round()).abs() < 1e-7)
    };
    (2..most).find(|digits| exact(*digits)).unwrap_or(most)
}

/// A number with fixed decimals; never `-0.00`.
pub fn fixed(value: f64, decimals: usize) -> String {
    // Most numbers round as the nearest whole number of their last decimal, which is written
    // three times as fast. Not those so near the middle that the product may be on its other side.
    let scaled = value.abs() * 10f64.powi(decimals as i32);
    if scaled < 1e12 && (scaled.fract() - 0.5).abs() > 1e-3 {
        let (whole, unit) = (scaled.round() as u64, 10u64.pow(decimals as u32));
        let sign = if value < 0.0 && whole > 0 { "-" } else { "" };
        return match decimals {
            0 => format!("{sign}{whole}"),
            _ => format!("{sign}{}.{:0>decimals$}", whole / unit, whole % unit),
        };
    }
    let text = format!("{value:.decimals$}");
    let digits = text.trim_start_matches('-');
    if digits.chars().all(|c| c == '0' || c == '.') {
        return digits.to_string();
    }
    text
}
