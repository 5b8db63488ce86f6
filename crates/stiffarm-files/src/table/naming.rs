//! Names of columns as they are compared, and those that become others.

/// The column whose text is split into posture, state and point.
pub(super) const NAME: &str = "name";

/// A column of dates beside one of times.
pub(super) const DATE: &str = "date";

/// A name of a column without case, outer and double spaces and the two signs for micro.
pub(super) fn normal(name: &str) -> String {
    let words: Vec<&str> = name.split_whitespace().collect();
    words.join(" ").to_lowercase().replace(['µ', 'μ'], "u")
}

/// k and the unit of `q3`, `q3_rad`, `joint 3`, `theta3`, `a3`, `axis_3`, …
pub(super) fn joint_number(name: &str) -> Option<(usize, &str)> {
    let letters = name.split(|c: char| !c.is_alphabetic()).next()?;
    if !["q", "j", "a", "joint", "axis", "theta", "angle"].contains(&letters) {
        return None;
    }
    let rest = name[letters.len()..].trim_start_matches(|c: char| !c.is_alphanumeric());
    let end = rest.find(|c: char| !c.is_ascii_digit()).unwrap_or(rest.len());
    Some((rest[..end].parse().ok()?, &rest[end..]))
}
