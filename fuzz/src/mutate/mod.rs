//! Changes of an input: those that know its grammar, and those of bytes.

mod bytes;
mod json;
mod numbers;
mod table;
mod toml;

pub use bytes::scraps;
pub use numbers::{COUNTS, NUMBERS, WORDS, edge_number};

use crate::random::Random;

/// How a text is built.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Grammar {
    /// `key = value` under headings.
    Toml,
    /// Rows and columns.
    Table,
    /// Objects and lists.
    Json,
}

/// `text` after some changes: most often one, so that it is still nearly right.
pub fn mutate(text: &[u8], grammar: Grammar, random: &mut Random) -> Vec<u8> {
    let changes = match random.below(8) {
        0..=3 => 1,
        4 | 5 => 2,
        6 => 3,
        _ => 4 + random.below(5),
    };
    let mut now = text.to_vec();
    for _ in 0..changes {
        now = once(now, text, grammar, random);
    }
    now
}

fn once(now: Vec<u8>, seed: &[u8], grammar: Grammar, random: &mut Random) -> Vec<u8> {
    let Ok(text) = std::str::from_utf8(&now) else {
        return bytes::change(now, seed, random);
    };
    match random.below(10) {
        0 => bytes::change(now, seed, random),
        1..=3 => numbers::change(text, random).into_bytes(),
        _ => match grammar {
            Grammar::Toml => toml::change(text, random),
            Grammar::Table => table::change(text, random),
            Grammar::Json => json::change(text, random),
        }
        .into_bytes(),
    }
}

/// Changes bytes alone, for what has no text.
pub fn mutate_bytes(content: &[u8], random: &mut Random) -> Vec<u8> {
    let mut now = content.to_vec();
    for _ in 0..=random.below(4) {
        now = bytes::change(now, content, random);
    }
    now
}
