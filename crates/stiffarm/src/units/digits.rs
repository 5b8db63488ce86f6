//! Numbers with the digits that people read, and with one minus sign.

use std::borrow::Cow;

/// The double nearest to `value` rounded to so many decimals, which may be below zero; never −0.
pub fn rounded(value: f64, decimals: i32) -> f64 {
    // Powers of ten up to 22 are exact, so that each way rounds once.
    let step = 10f64.powi(decimals.abs());
    let number = if decimals >= 0 { (value * step).round() / step } else { (value / step).round() * step };
    number + 0.0
}

/// `value` rounded to so many significant digits; never −0.
pub fn significant(value: f64, digits: usize) -> f64 {
    let behind = digits.saturating_sub(1);
    let decimals = behind as f64 - value.abs().log10().floor();
    // As above, where the digits are few enough to be exact. Text takes a hundred times as long.
    if (0.0..=22.0).contains(&decimals) && behind < 15 {
        return rounded(value, decimals as i32);
    }
    format!("{value:.behind$e}").parse().unwrap_or(value) + 0.0
}

/// So many significant digits as text, `0.001230` with four; very large and very small numbers with a power of ten.
pub fn significant_text(value: f64, digits: usize) -> String {
    if value == 0.0 {
        return "0".to_string();
    }
    // The exponent after rounding: 9.999 with three digits is 10.0.
    let scientific = format!("{value:.*e}", digits.saturating_sub(1));
    let exponent = scientific.split('e').nth(1);
    let exponent: i32 = exponent.and_then(|e| e.parse().ok()).unwrap_or(0);
    let places = digits as i32 - 1 - exponent;
    match exponent {
        -4..6 => format!("{value:.*}", places.max(0) as usize),
        _ => scientific,
    }
}

/// The text of a number as people read it: a minus sign is as wide as a plus, and a rounded −0.004 is 0.00.
pub fn with_minus(number: String) -> String {
    match number.strip_prefix('-') {
        Some(rest) if rest.chars().all(|c| c == '0' || c == '.') => rest.to_string(),
        Some(rest) => format!("−{rest}"),
        None => number,
    }
}

/// A sentence with the minus signs of [`with_minus`]; what one types, in backticks, stays as it is typed.
pub fn sentence_with_minus(sentence: &str) -> Cow<'_, str> {
    let mut out = String::new();
    let mut is_code = false;
    let mut before = ' ';
    let mut rest = sentence.chars().peekable();
    while let Some(c) = rest.next() {
        is_code ^= c == '`';
        let is_minus =
            c == '-' && !is_code && " \u{a0}(,[=±".contains(before) && rest.peek().is_some_and(char::is_ascii_digit);
        out.push(if is_minus { '−' } else { c });
        before = c;
    }
    if out == sentence { Cow::Borrowed(sentence) } else { Cow::Owned(out) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_are_those_asked_for() {
        assert_eq!(significant_text(0.0012345, 4), "0.001234");
        assert_eq!(significant_text(9.9996, 4), "10.00");
        assert_eq!(significant_text(999.96, 4), "1000");
        assert_eq!(significant_text(942_757.6, 4), "942758");
        assert_eq!(significant_text(1_234_567.0, 4), "1.235e6");
        assert_eq!(significant_text(1.5e-9, 3), "1.50e-9");
        assert_eq!(significant_text(0.0, 3), "0");
        for (value, digits, number) in [(942_757.6, 4, 942_800.0), (-1.2345e-7, 3, -1.23e-7), (0.0, 4, 0.0)] {
            assert_eq!(significant(value, digits), number);
        }
        assert_eq!(rounded(1234.5678, 2), 1234.57);
        assert_eq!(rounded(1250.0, -2), 1300.0);
    }

    #[test]
    fn nothing_is_less_than_zero_that_is_shown_as_zero() {
        for zero in [rounded(-0.004, 2), significant(-0.0, 3), rounded(-0.0, 0)] {
            assert!(zero.is_sign_positive());
        }
        assert_eq!(with_minus(format!("{:.2}", -0.004)), "0.00");
        assert_eq!(with_minus("-3.5".to_string()), "−3.5");
    }

    #[test]
    fn sentences_have_the_minus_of_numbers() {
        let sentence = sentence_with_minus(
            "The rope from [-3, 0, -1200] mm, q = -7.5 ±-1: `--q-deg -3`, p-4, 2026-11-29, 1e-9 m, x -",
        );
        assert_eq!(
            sentence,
            "The rope from [−3, 0, −1200] mm, q = −7.5 ±−1: `--q-deg -3`, p-4, 2026-11-29, 1e-9 m, x -"
        );
    }
}
