//! A smaller input with the same fault.

use crate::input::Input;
use crate::run::{judge, signature};
use crate::targets::Target;
use std::time::{Duration, Instant};

/// Longest search.
const PATIENCE: Duration = Duration::from_secs(120);

/// The input without the lines and bytes that its fault can do without.
pub fn minimised(target: &Target, input: Input) -> Input {
    let Err(fault) = judge(target, &input) else {
        return input;
    };
    let wanted = signature(&fault);
    let start = Instant::now();
    let still = |candidate: &Input| {
        start.elapsed() < PATIENCE && judge(target, candidate).is_err_and(|fault| signature(&fault) == wanted)
    };
    match input {
        Input::File(bytes) => {
            let with = |bytes: Vec<u8>| Input::File(bytes);
            Input::File(shrunk(bytes, |bytes| still(&with(bytes))))
        }
        Input::Command { words, mut files } => {
            for i in 0..files.len() {
                let others = files.clone();
                let bytes = files[i].1.clone().into_bytes();
                let small = shrunk(bytes, |bytes| {
                    let mut files = others.clone();
                    match String::from_utf8(bytes) {
                        Ok(text) => files[i].1 = text,
                        Err(_) => return false,
                    }
                    still(&Input::Command { words: words.clone(), files })
                });
                files[i].1 = String::from_utf8(small).unwrap_or_default();
            }
            Input::Command { words, files }
        }
    }
}

/// Leaves out lines, then runs of bytes, as long as `still` holds.
fn shrunk(mut now: Vec<u8>, still: impl Fn(Vec<u8>) -> bool) -> Vec<u8> {
    let joined = |lines: &[Vec<u8>]| lines.concat();
    let mut lines: Vec<Vec<u8>> = now.split_inclusive(|b| *b == b'\n').map(<[u8]>::to_vec).collect();
    let mut size = (lines.len() / 2).max(1);
    loop {
        let mut at = 0;
        while at < lines.len() {
            let mut fewer = lines.clone();
            fewer.drain(at..(at + size).min(fewer.len()));
            if still(joined(&fewer)) { lines = fewer } else { at += size }
        }
        if size == 1 {
            break;
        }
        size /= 2;
    }
    now = joined(&lines);
    if now.len() > 4096 {
        return now;
    }
    for size in [16, 4, 1] {
        let mut at = 0;
        while at < now.len() {
            let mut fewer = now.clone();
            fewer.drain(at..(at + size).min(fewer.len()));
            if still(fewer.clone()) { now = fewer } else { at += size }
        }
    }
    now
}
