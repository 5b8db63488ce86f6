//! The XML of a URDF, and what is wrong with a text that is none.

use roxmltree::{Document, Error as XmlError, ParsingOptions};
use stiffarm::error::{Code, Error};

/// Attributes of an element: the parser compares each with every other one.
const MOST_ATTRIBUTES: usize = 1000;

/// The elements of `text`, which begins with the first of them; else what is wrong, and the byte it stands at.
///
/// # Errors
/// Text that is no XML, and XML with a document type, whose entities may grow without end.
pub(super) fn parsed(text: &str) -> Result<Document<'_>, (Error, usize)> {
    if !text.starts_with('<') {
        return Err((no_xml("The text has no XML elements."), 0));
    }
    let mut at = 0_usize;
    for piece in text.split_inclusive('<') {
        // A value has two quotes.
        if piece.matches(['"', '\'']).count() > 2 * MOST_ATTRIBUTES {
            let message = format!("An element has more than {MOST_ATTRIBUTES} attributes.");
            return Err((no_xml(message), at.saturating_sub(1)));
        }
        at += piece.len();
    }
    let options = ParsingOptions { allow_dtd: false, ..ParsingOptions::default() };
    Document::parse_with_options(text, options).map_err(|e| (said(&e), place(text, &e)))
}

/// Commands of xacro in the text.
pub(super) fn commands() -> Error {
    let message = "The file has commands of xacro, which must be carried out first.";
    Error::new(Code::Unsupported, message).hint("name the file ….xacro, or expand it yourself: xacro FILE > robot.urdf")
}

fn no_xml(message: impl Into<String>) -> Error {
    Error::new(Code::Urdf, message).hint("a URDF is an XML text: <robot name=\"…\"> … </robot>")
}

/// What the parser finds wrong, in words.
fn said(error: &XmlError) -> Error {
    match error {
        XmlError::UnknownNamespace(prefix, _) if prefix == "xacro" => commands(),
        XmlError::UnknownNamespace(prefix, _) => {
            Error::new(Code::Urdf, format!("The prefix {prefix} is not declared."))
                .hint(format!("declare it: <robot xmlns:{prefix}=\"{prefix}\" …>"))
        }
        XmlError::DtdDetected => {
            let message = "A document type (<!DOCTYPE …>) is not supported.";
            Error::new(Code::Unsupported, message).hint("leave it out")
        }
        XmlError::NoRootNode => no_xml("The text has no XML elements."),
        XmlError::UnclosedRootNode => no_xml("<robot> is not closed."),
        XmlError::UnexpectedEndOfStream => no_xml("The text ends within an element."),
        XmlError::UnexpectedCloseTag(expected, actual, _) => {
            no_xml(format!("</{actual}> stands where </{expected}> must."))
        }
        other => {
            // The place is said apart.
            let place = format!(" at {}", other.pos());
            let said = other.to_string().replace(&place, "");
            no_xml(format!("The text is no XML: {said}."))
        }
    }
}

/// The byte at which an error stands.
fn place(text: &str, error: &XmlError) -> usize {
    match error {
        XmlError::UnclosedRootNode => text.find("<robot").unwrap_or_default(),
        XmlError::DtdDetected => text.find("<!DOCTYPE").unwrap_or_default(),
        XmlError::UnexpectedEndOfStream => text.len(),
        _ => {
            let [row, column] = [error.pos().row, error.pos().col].map(|count| count as usize);
            let above = text.split_inclusive('\n').take(row - 1);
            let start: usize = above.map(str::len).sum();
            let before = text[start..].chars().take(column - 1);
            start + before.map(char::len_utf8).sum::<usize>()
        }
    }
}
