//! Sentences a result comes with, in one type for terminal, page and JSON.

pub mod codes;

pub use crate::error::{is_hidden, visible};
use crate::units::{m_to_mm, rounded};
use serde::{Deserialize, Serialize};

/// How much a finding matters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Severity {
    /// Good to know.
    Note,
    /// Look at it before relying on the result.
    Caution,
    /// The result, or the set-up, cannot be used as it is.
    Serious,
}

/// One finding: a stable code, what it is about, and a full sentence.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Finding {
    /// Stable name for scripts, for example `recommended-index`.
    pub code: String,
    /// How much it matters.
    pub severity: Severity,
    /// What it is about: a joint, a group, a key path of the cell file.
    pub subject: String,
    /// The sentence.
    pub sentence: String,
}

impl Finding {
    /// A finding from its parts.
    pub fn new(code: &str, severity: Severity, subject: impl Into<String>, sentence: impl Into<String>) -> Self {
        Finding { code: code.to_string(), severity, subject: subject.into(), sentence: sentence.into() }
    }

    /// What is good to know.
    pub fn note(code: &str, subject: impl Into<String>, sentence: impl Into<String>) -> Self {
        Finding::new(code, Severity::Note, subject, sentence)
    }

    /// What to look at before relying on the result.
    pub fn caution(code: &str, subject: impl Into<String>, sentence: impl Into<String>) -> Self {
        Finding::new(code, Severity::Caution, subject, sentence)
    }

    /// Whether the result, or the set-up, cannot be used as it is.
    pub fn is_serious(&self) -> bool {
        self.severity == Severity::Serious
    }

    /// Why the result, or the set-up, cannot be used as it is.
    pub fn serious(code: &str, subject: impl Into<String>, sentence: impl Into<String>) -> Self {
        Finding::new(code, Severity::Serious, subject, sentence)
    }
}

/// A list in words: `a, b and c`.
pub fn list<S: AsRef<str>>(names: &[S]) -> String {
    let names: Vec<&str> = names.iter().map(AsRef::as_ref).collect();
    match names.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} and {last}", rest.join(", ")),
        _ => names.concat(),
    }
}

/// How many more there are than are named: ` and 3 more`, nothing where there is none.
pub(crate) fn more(count: usize) -> String {
    match count {
        0 => String::new(),
        count => format!(" and {count} more"),
    }
}

/// Fraction as a percentage with three digits.
pub(crate) fn percent(fraction: f64) -> String {
    let p = 100.0 * fraction;
    match p.abs() {
        size if size >= 100.0 => format!("{p:.0} %"),
        size if size >= 10.0 => format!("{p:.1} %"),
        _ => format!("{p:.2} %"),
    }
}

/// A length in words: millimetres, below 0.01 mm micrometres.
pub fn length(metres: f64) -> String {
    match metres.abs() {
        size if size >= 1e-2 => format!("{:.1} mm", m_to_mm(metres)),
        size if size >= 9.995e-6 => format!("{:.3} mm", m_to_mm(metres)),
        size if size >= 9.95e-8 => format!("{:.1} µm", 1e6 * metres),
        _ => format!("{:.3} µm", 1e6 * metres),
    }
}

/// A time \[s\] in minutes, to a tenth of one.
pub fn minutes(seconds: f64) -> String {
    let minutes = rounded(seconds / 60.0, 1);
    let unit = if minutes == 1.0 { "minute" } else { "minutes" };
    format!("{minutes} {unit}")
}

/// A length with its standard error, in one unit.
pub(crate) fn length_with_error(metres: f64, error: f64) -> String {
    if metres.abs().max(error) >= 9.995e-6 {
        format!("{:.3} ± {:.3} mm", m_to_mm(metres), m_to_mm(error))
    } else {
        format!("{:.1} ± {:.1} µm", 1e6 * metres, 1e6 * error)
    }
}

/// A probability in words.
pub(crate) fn probability(p: f64) -> String {
    match p {
        p if p < 0.001 => "p < 0.001".to_string(),
        p if p < 0.095 => format!("p = {p:.3}"),
        p => format!("p = {p:.2}"),
    }
}

/// Each of these once, in their order: findings of several parts of a result, or names that need not stand together.
pub fn each_once<'a, T: PartialEq + Clone + 'a>(all: impl IntoIterator<Item = &'a T>) -> Vec<T> {
    let mut out: Vec<T> = Vec::new();
    for one in all {
        if !out.contains(one) {
            out.push(one.clone());
        }
    }
    out
}

/// Names from files as they are shown.
pub fn shown<'a>(names: impl IntoIterator<Item = &'a String>) -> Vec<String> {
    let names = names.into_iter();
    names.map(|name| visible(name).into_owned()).collect()
}
