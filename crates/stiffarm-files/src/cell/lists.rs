//! Values of a cell file as they are written.

/// A list of degrees as TOML.
pub(super) fn degrees(values: &[f64]) -> String {
    let values: Vec<String> = values.iter().map(f64::to_string).collect();
    format!("[{}]", values.join(", "))
}

/// A text as TOML; it has no control characters.
pub(super) fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""))
}

/// Pairs as lines of TOML.
pub(super) fn rows(rows: &[[f64; 2]]) -> String {
    rows.iter().map(|row| format!("    {},\n", degrees(row))).collect()
}
