//! Numbers as tables show them.

use stiffarm::units::m_to_mm;

/// Shown where a value does not exist.
pub const NONE: &str = "-";

/// Percentages below this are rounding.
const ROUNDING: f64 = 1e-6;

/// `value` with `digits` significant digits, in powers of ten where it is very
/// large or small.
pub fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 {
        return "0".to_string();
    }
    if !value.is_finite() {
        return NONE.to_string();
    }
    let scientific = format!("{value:.*e}", digits.saturating_sub(1));
    let exponent: i32 = scientific
        .rsplit('e')
        .next()
        .and_then(|e| e.parse().ok())
        .unwrap_or(0);
    if !(-4..6).contains(&exponent) {
        return scientific;
    }
    let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
    format!("{value:.decimals$}")
}

/// An optional value with `digits` significant digits.
pub fn optional(value: Option<f64>, digits: usize) -> String {
    value.map_or_else(|| NONE.to_string(), |v| significant(v, digits))
}

/// 95 for 0.95, without the last bits of a binary fraction.
pub fn confidence(fraction: f64) -> String {
    let text = format!("{:.6}", fraction * 100.0);
    text.trim_end_matches('0').trim_end_matches('.').to_string()
}

/// Joint stiffness \[N·m/rad\], always four digits and a power of ten.
pub fn stiffness(value: f64) -> String {
    format!("{value:.3e}")
}

/// A fraction in percent, without the sign for it.
pub fn percent(fraction: f64) -> String {
    let percent = fraction * 100.0;
    if percent.abs() < ROUNDING {
        "0".to_string()
    } else if percent.abs() < 0.1 {
        significant(percent, 2)
    } else {
        format!("{percent:.2}")
    }
}

/// An optional fraction in percent.
pub fn optional_percent(fraction: Option<f64>) -> String {
    fraction.map_or_else(|| NONE.to_string(), percent)
}

/// A fraction and its standard error in percent, with the same decimals.
pub fn percent_with_error(fraction: f64, error: f64) -> String {
    let (percent, error) = (fraction * 100.0, error * 100.0);
    let decimals = if error < 0.0995 { 3 } else { 2 };
    format!("{percent:.decimals$} ± {error:.decimals$}")
}

/// Metres in millimetres, to a tenth of a micrometre.
pub fn mm(m: f64) -> String {
    format!("{:.4}", m_to_mm(m))
}

/// Metres in whole millimetres, or to a tenth where that is needed.
pub fn coarse_mm(m: f64) -> String {
    let tenths = (m_to_mm(m) * 10.0).round() / 10.0 + 0.0;
    tenths.to_string()
}

/// `1 posture`, `6 postures`.
pub fn counted(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn significant_digits() {
        assert_eq!(significant(13.3456, 4), "13.35");
        assert_eq!(significant(0.0092484, 3), "0.00925");
        assert_eq!(significant(999.96, 4), "1000");
        assert_eq!(significant(1.2e7, 3), "1.20e7");
        assert_eq!(significant(3.2e-9, 2), "3.2e-9");
        assert_eq!(significant(0.0, 4), "0");
        assert_eq!(optional(None, 4), "-");
    }

    #[test]
    fn units_at_the_door() {
        assert_eq!(stiffness(950e3), "9.500e5");
        assert_eq!(percent(0.0123), "1.23");
        assert_eq!(mm(1.39e-5), "0.0139");
        assert_eq!(coarse_mm(0.773), "773");
    }
}
