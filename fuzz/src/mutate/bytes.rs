//! Changes that know nothing of what the bytes mean.

use super::numbers::{WORDS, edge_number};
use crate::random::Random;

/// No input grows beyond this \[bytes\].
const LONGEST: usize = 1 << 16;

/// One change; pieces come from `seed` too.
pub fn change(mut now: Vec<u8>, seed: &[u8], random: &mut Random) -> Vec<u8> {
    let at = random.below(now.len() + 1);
    let length = 1 + random.below(32);
    let end = (at + length).min(now.len());
    match random.below(9) {
        0 if at < now.len() => now[at] ^= 1 << random.below(8),
        1 if at < now.len() => now[at] = random.next() as u8,
        2 => {
            now.drain(at..end);
        }
        3 => now.truncate(at),
        4 => insert(&mut now, at, random.pick(&WORDS).as_bytes()),
        5 => {
            let piece = now[at..end].to_vec();
            let to = random.below(now.len() + 1);
            insert(&mut now, to, &piece);
        }
        6 => {
            let from = random.below(seed.len() + 1);
            let piece = &seed[from..(from + length * 8).min(seed.len())];
            insert(&mut now, at, piece);
        }
        7 => {
            let times = 1 + random.below(200);
            let piece = now[at..(at + 4).min(end)].repeat(times);
            insert(&mut now, at, &piece);
        }
        _ => insert(&mut now, at, &[random.next() as u8]),
    }
    now
}

/// Marks of the grammars, and lines that change the meaning of what follows.
const MARKS: [&str; 16] =
    ["\n", "\r", "[", "]", "[[", "{", "}", ",", ";", "=", ".", "'", "\"\"\"", "#", "[robot]\n", "sep=;\n"];

/// No file at all: marks, words and numbers in any order, or any bytes.
pub fn scraps(random: &mut Random) -> Vec<u8> {
    let of_bytes = random.one_in(3);
    let mut out = Vec::new();
    for _ in 0..random.below(400) {
        match random.below(4) {
            _ if of_bytes => out.push(random.next() as u8),
            0 => out.extend(random.pick(&WORDS).bytes()),
            1 => out.extend(edge_number(None, random).bytes()),
            _ => out.extend(random.pick(&MARKS).bytes()),
        }
    }
    out
}

fn insert(into: &mut Vec<u8>, at: usize, piece: &[u8]) {
    if into.len() + piece.len() <= LONGEST {
        into.splice(at..at, piece.iter().copied());
    }
}
