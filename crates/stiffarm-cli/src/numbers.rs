//! Numbers as tables show them.

use stiffarm::units::m_to_mm;
use stiffarm_report::tell;
pub use stiffarm_report::tell::counted;

/// Shown where a value does not exist.
pub const NONE: &str = "-";

/// Percentages below this are rounding.
const ROUNDING: f64 = 1e-6;

/// `value` with `digits` significant digits, in powers of ten where it is very
/// large or small.
pub fn significant(value: f64, digits: usize) -> String {
    if value.is_finite() {
        tell::significant(value, digits)
    } else {
        NONE.to_string()
    }
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

/// Metres in millimetres, to a tenth of a micrometre.
pub fn mm(m: f64) -> String {
    format!("{:.4}", m_to_mm(m))
}

/// Metres in whole millimetres, or to a tenth where that is needed.
pub fn coarse_mm(m: f64) -> String {
    let tenths = (m_to_mm(m) * 10.0).round() / 10.0 + 0.0;
    tenths.to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn significant_digits() {
        assert_eq!(significant(13.3456, 4), "13.35");
        assert_eq!(significant(f64::INFINITY, 4), "-");
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
