//! Names that may stand in files: read, written and read again they are the
//! same, and they are text wherever they are shown.

use stiffarm::error::{Error, Result};
use stiffarm::findings::is_hidden;

/// Characters of a name.
const LONGEST: usize = 200;

/// What is wrong with a name of a posture, a state, a point, …; `None` for nothing.
///
/// Tables are opened in spreadsheets, which take a text for a formula that
/// begins with `=`, `+`, `-` or `@`, quoted or not, and a formula can start
/// programs. No way of writing such a name is both harmless there and the same
/// name when it is read back, so it is refused. A sign before letters, `+z-2`, or a
/// minus before one number, `-250`, can do nothing and is allowed; `+5` would be
/// read back as 5, and `-2+3` as 1.
pub(super) fn fault_of(name: &str) -> Option<&'static str> {
    if name.chars().any(char::is_control) {
        return Some("A name must not contain line breaks or other control characters.");
    }
    if name.chars().any(is_hidden) {
        return Some("A name must not contain characters that nobody sees or that turn the direction of the text.");
    }
    if name.chars().nth(LONGEST).is_some() {
        return Some("A name must not have more than 200 characters.");
    }
    let harmless = |c: char| c.is_alphanumeric() || " _.+-".contains(c);
    let number = |text: &str| text.starts_with(|c: char| c.is_ascii_digit() || c == '.');
    let formula = match name.split_at_checked(1) {
        Some(("=" | "@", _)) => true,
        Some(("+", rest)) => number(rest) || !rest.chars().all(harmless),
        Some(("-", rest)) => (number(rest) && rest.contains(['+', '-'])) || !rest.chars().all(harmless),
        _ => false,
    };
    formula.then_some(
        "A name must not begin like a formula of a spreadsheet: with = or @, or with + or - before what \
        can be calculated (+5, -2+3).",
    )
}

/// The nearest name that may stand in files, where `name` may not: `_` for what is hidden, no sign at the
/// beginning that makes a formula of it, 200 characters.
pub(super) fn harmless(name: &str) -> Option<String> {
    fault_of(name)?;
    let is_hidden = |c: char| c.is_control() || is_hidden(c);
    let shown = name.chars().map(|c| if is_hidden(c) { '_' } else { c });
    let shown: String = shown.take(LONGEST).collect();
    let plain = match fault_of(&shown) {
        Some(_) => shown.trim_start_matches(|c: char| "=+-@".contains(c) || c.is_whitespace()),
        None => &shown,
    };
    Some(plain.trim().to_string())
}

/// Refuses a name that could not be written to a table and read again as text.
///
/// # Errors
/// An empty name, spaces around it, hidden characters, the beginning of a formula.
pub fn check_name(name: &str) -> Result<()> {
    let wrong = if name.trim().is_empty() {
        Some("A name must not be empty.")
    } else if name.trim() != name {
        Some("A name must not begin or end with a space.")
    } else {
        fault_of(name)
    };
    match wrong {
        Some(wrong) => Err(Error::invalid(wrong)),
        None => Ok(()),
    }
}
