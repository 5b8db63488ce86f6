//! Sentences a result comes with, in one type for terminal, page and JSON.

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
    pub fn new(
        code: &str,
        severity: Severity,
        subject: impl Into<String>,
        sentence: impl Into<String>,
    ) -> Self {
        Finding {
            code: code.to_string(),
            severity,
            subject: subject.into(),
            sentence: sentence.into(),
        }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_in_words() {
        assert_eq!(list::<&str>(&[]), "");
        assert_eq!(list(&["a"]), "a");
        assert_eq!(list(&["a", "b", "c"]), "a, b and c");
    }
}
