//! Slips of who types an angle.

/// How an angle was perhaps mistyped.
pub(super) fn slip(written: f64, likely: f64) -> &'static str {
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
