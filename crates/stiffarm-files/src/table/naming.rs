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
