//! Lengths, angles and ratios in the words of findings, and how an angle was mistyped.

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
    let (value, size) = if factor < 1.0 {
        (1.0 / factor, "small")
    } else {
        (factor, "large")
    };
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
    let digits: Vec<usize> = (0..text.len())
        .filter(|i| text[*i].is_ascii_digit())
        .collect();
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
