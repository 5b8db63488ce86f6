//! The text of a file: UTF-8, or UTF-16 that says so at its beginning, as the Windows PowerShell
//! writes what is sent into a file by `>`.

use std::borrow::Cow;
use stiffarm::error::{Code, Error, Result};

/// Byte order marks of UTF-16.
const LITTLE: &[u8] = &[0xff, 0xfe];
const BIG: &[u8] = &[0xfe, 0xff];

/// Whether a text begins like a table: with a row of names.
pub(super) fn is_table(text: &str) -> bool {
    let heading = text.lines().find(|line| !line.trim().is_empty());
    heading.is_some_and(|line| line.contains([',', ';']) && !line.contains(['=', '[', '{', '#']))
}

/// The bytes as text. That of UTF-8 keeps its byte order mark, so that places count in the bytes.
///
/// # Errors
/// Bytes that are neither, with line and column of the first.
pub(super) fn decode(bytes: &[u8]) -> Result<Cow<'_, str>> {
    if let Some(units) = bytes.strip_prefix(LITTLE) {
        return utf16(units, u16::from_le_bytes).map(Cow::Owned);
    }
    if let Some(units) = bytes.strip_prefix(BIG) {
        return utf16(units, u16::from_be_bytes).map(Cow::Owned);
    }
    if let Some(error) = crate::binary::refused(bytes) {
        return Err(error);
    }
    std::str::from_utf8(bytes).map(Cow::Borrowed).map_err(|error| {
        let good = String::from_utf8_lossy(&bytes[..error.valid_up_to()]);
        fault("A character here is not UTF-8.", &good)
    })
}

/// The text of pairs of bytes.
fn utf16(bytes: &[u8], unit: fn([u8; 2]) -> u16) -> Result<String> {
    let pairs = bytes.chunks_exact(2);
    let whole = pairs.remainder().is_empty();
    let units = pairs.map(|pair| unit([pair[0], pair[1]]));
    let mut text = String::with_capacity(bytes.len());
    for character in char::decode_utf16(units) {
        match character {
            Ok(character) => text.push(character),
            Err(_) => return Err(fault("A character here is not UTF-16.", &text)),
        }
    }
    if whole { Ok(text) } else { Err(fault("The file is UTF-16 text that ends within a character.", &text)) }
}

/// An error behind the text that could be read.
fn fault(message: &str, good: &str) -> Error {
    let line = good.matches('\n').count() + 1;
    let last = good.rsplit('\n').next().unwrap_or_default();
    let last = last.trim_start_matches('\u{feff}');
    Error::new(Code::Encoding, message)
        .line(line, Some(last.chars().count() + 1))
        .hint("save the file as UTF-8 (in Excel: \"CSV UTF-8\")")
}
