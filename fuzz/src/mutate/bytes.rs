//! Changes that know nothing of what the bytes mean.

use super::numbers::WORDS;
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

fn insert(into: &mut Vec<u8>, at: usize, piece: &[u8]) {
    if into.len() + piece.len() <= LONGEST {
        into.splice(at..at, piece.iter().copied());
    }
}
