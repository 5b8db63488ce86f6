//! A result with what made it, and its text: what commands print with `--json` and
//! result files hold.

use super::seal::Seal;
use serde::Serialize;
use std::collections::BTreeMap;
use stiffarm::error::{Code, Error, Result};
use stiffarm::findings::is_hidden;

/// The result with what made it; [`write_result`] seals it.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Envelope<O, R> {
    /// Version of this format.
    pub format: u32,
    /// Version of the program.
    pub stiffarm: String,
    /// The command.
    pub command: String,
    /// Words of the command line that makes the result again, inputs as `{role}`; where results go
    /// and how they are shown is left out. From Python one text, `stiffarm.identify(cell, measurements)`: the call,
    /// inputs by the names of its parameters.
    pub arguments: Vec<String>,
    /// SHA-256 of each input by its role.
    pub inputs: BTreeMap<String, String>,
    /// Seed of the random numbers, where there are any.
    pub seed: Option<u64>,
    /// Options that the result depends on.
    pub options: O,
    /// The result.
    pub result: R,
}

impl<O, R> Envelope<O, R> {
    /// `result` with what made it, in this version's format; `arguments` is empty where the caller is to fill it in.
    pub fn new(
        command: &str,
        arguments: Vec<String>,
        inputs: BTreeMap<String, String>,
        seed: Option<u64>,
        options: O,
        result: R,
    ) -> Self {
        Envelope {
            format: 1,
            stiffarm: env!("CARGO_PKG_VERSION").to_string(),
            command: command.to_string(),
            arguments,
            inputs,
            seed,
            options,
            result,
        }
    }
}

/// What a result file holds: the [`Envelope`] and its seal.
#[cfg(feature = "schema")]
#[derive(schemars::JsonSchema)]
pub struct Written<O, R> {
    /// The result with what made it.
    #[serde(flatten)]
    pub envelope: Envelope<O, R>,
    /// Says that nothing of it was changed.
    pub seal: Seal,
}

/// The text of a result with its seal: what `--json` prints and result files hold.
///
/// # Errors
/// A value that JSON cannot hold.
pub fn write_result(envelope: &impl Serialize) -> Result<String> {
    let text = to_json(envelope)?;
    let seal = to_json(&Seal::of_text(&text)?)?;
    let (body, seal) = (text.trim_end(), seal.trim_end().replace('\n', "\n  "));
    let body = body.strip_suffix('}').unwrap_or(body).trim_end();
    Ok(format!("{body},\n  \"seal\": {seal}\n}}\n"))
}

/// `value` as indented JSON, lists of plain values on one line, with a line
/// end. Numbers that are not finite become `null`.
///
/// # Errors
/// A value that JSON cannot hold.
pub fn to_json(value: &impl Serialize) -> Result<String> {
    let text = serde_json::to_string_pretty(value)
        .map_err(|e| Error::new(Code::Internal, format!("The result cannot be written as JSON: {e}.")))?;
    Ok(without_hidden(join_plain_lists(&text)) + "\n")
}

/// Hidden characters as JSON writes them in letters: they stand in strings only,
/// and are read back as themselves.
fn without_hidden(json: String) -> String {
    let is_plain = |c: char| c == '\n' || !is_hidden(c);
    if json.chars().all(is_plain) {
        return json;
    }
    let mut out = String::with_capacity(json.len());
    for c in json.chars() {
        if is_plain(c) {
            out.push(c)
        } else {
            for unit in c.encode_utf16(&mut [0; 2]) {
                out += &format!("\\u{unit:04x}");
            }
        }
    }
    out
}

/// Puts each list without lists or objects inside on one line.
fn join_plain_lists(pretty: &str) -> String {
    let mut out = String::with_capacity(pretty.len());
    let mut rest = pretty;
    while let Some(at) = next_outside_strings(rest, &['[']) {
        let (before, list) = rest.split_at(at);
        out += before;
        let inside = &list[1..];
        let end = next_outside_strings(inside, &['[', ']', '{']).unwrap_or(inside.len());
        if inside[end..].starts_with(']') {
            let items: Vec<&str> = inside[..end].lines().map(str::trim).filter(|line| !line.is_empty()).collect();
            out += &format!("[{}]", items.join(" "));
            rest = &inside[end + 1..];
        } else {
            out.push('[');
            rest = inside;
        }
    }
    out + rest
}

/// Byte position of the first of `wanted` that is not inside a JSON string.
fn next_outside_strings(text: &str, wanted: &[char]) -> Option<usize> {
    let (mut in_string, mut escaped) = (false, false);
    text.char_indices()
        .find(|(_, c)| {
            if in_string {
                (in_string, escaped) = (escaped || *c != '"', !escaped && *c == '\\');
                return false;
            }
            in_string = *c == '"';
            wanted.contains(c)
        })
        .map(|(at, _)| at)
}
