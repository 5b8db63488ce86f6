//! Numbers as tables show them.

use stiffarm::units::{m_to_mm, rounded, significant_text};
pub use stiffarm_report::summary::counted;

/// Shown where a value does not exist.
pub const NONE: &str = "-";

/// `value` with `digits` significant digits, in powers of ten where it is very
/// large or small.
pub fn significant(value: f64, digits: usize) -> String {
    if value.is_finite() { significant_text(value, digits) } else { NONE.to_string() }
}

/// Joint stiffness \[N·m/rad\], always four digits and a power of ten.
pub fn stiffness(value: f64) -> String {
    format!("{value:.3e}")
}

/// Metres in whole millimetres, or to a tenth where that is needed.
pub fn coarse_mm(m: f64) -> String {
    rounded(m_to_mm(m), 1).to_string()
}

/// A count from the command line as a number of things in memory.
pub fn to_usize(count: u64) -> usize {
    usize::try_from(count).unwrap_or(usize::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn significant_digits() {
        assert_eq!(significant(13.3456, 4), "13.35");
        assert_eq!(significant(f64::INFINITY, 4), "-");
    }

    #[test]
    fn units_at_the_door() {
        assert_eq!(stiffness(950e3), "9.500e5");
        assert_eq!(coarse_mm(0.773), "773");
    }
}
