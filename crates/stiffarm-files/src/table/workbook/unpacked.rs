//! What an archive unpacks to, counted before anything is read from it.
//!
//! The sizes that an archive declares are its maker's word. They refuse a file
//! at once; what they let pass is unpacked once into nothing and counted.

use super::HINT;
use std::io::{Cursor, Read};
use stiffarm::error::{Code, Error, Result};
use zip::ZipArchive;

/// Any workbook may unpack to this many bytes …
const ALWAYS: u64 = 16 << 20;

/// … and for each byte of the file to this many more. Numbers are packed to a
/// fifth, empty cells with a format to a thirtieth.
const FOLD: u64 = 40;

/// No workbook may unpack to more.
const MOST_BYTES: u64 = 512 << 20;

/// The attribute that says how many shared texts follow, for which the reader
/// of the format takes memory at once.
const COUNT: &[u8] = b"uniqueCount";

/// Refuses an archive that unpacks to more than a workbook of its size can.
///
/// # Errors
/// Too large, or a declared number of shared texts that cannot be true.
pub(super) fn check(bytes: &[u8]) -> Result<()> {
    let limit = (ALWAYS + FOLD * bytes.len() as u64).min(MOST_BYTES);
    // What is no archive is answered by the reader of the format.
    let Ok(mut archive) = ZipArchive::new(Cursor::new(bytes)) else {
        return Ok(());
    };
    let mut declared = 0_u64;
    for i in 0..archive.len() {
        if let Ok(entry) = archive.by_index_raw(i) {
            declared = declared.saturating_add(entry.size());
        }
    }
    if declared > limit {
        return Err(too_large(bytes, limit));
    }
    let mut unpacked = 0;
    let mut block = vec![0; 1 << 16];
    for i in 0..archive.len() {
        let Ok(mut entry) = archive.by_index(i) else {
            continue;
        };
        let mut count = Count::default();
        // An entry that is damaged is answered by the reader of the format.
        while let Ok(length @ 1..) = entry.read(&mut block) {
            unpacked += length as u64;
            if unpacked > limit {
                return Err(too_large(bytes, limit));
            }
            block[..length].iter().for_each(|byte| count.see(*byte));
        }
        if count.largest > limit {
            let message = "The workbook says that it holds more texts than it can.";
            return Err(Error::new(Code::FileRead, message).hint(HINT));
        }
    }
    Ok(())
}

fn too_large(bytes: &[u8], limit: u64) -> Error {
    let message = format!(
        "The file has {} kB and unpacks to more than {} MB, which no table does.",
        bytes.len().div_ceil(1000),
        limit / 1_000_000
    );
    Error::new(Code::Unsupported, message).hint("save the sheet as \"CSV UTF-8\"")
}

/// Finds the numbers of [`COUNT`] in a stream of bytes, UTF-8 or UTF-16.
#[derive(Default)]
struct Count {
    /// Bytes of the name that have been seen.
    seen: usize,
    /// The number behind it so far.
    number: Option<u64>,
    largest: u64,
}

impl Count {
    fn see(&mut self, byte: u8) {
        match byte {
            // Every second byte of UTF-16.
            0 => {}
            _ if self.seen < COUNT.len() => {
                // The first letter stands nowhere else in the name but at "uniqueCo·u·nt".
                self.seen = match byte {
                    byte if byte == COUNT[self.seen] => self.seen + 1,
                    b'u' => 1,
                    _ => 0,
                };
            }
            b'0'..=b'9' => {
                let number = self.number.unwrap_or(0).saturating_mul(10);
                let number = number.saturating_add(u64::from(byte - b'0'));
                self.number = Some(number);
                self.largest = self.largest.max(number);
            }
            b' ' | b'\t' | b'\r' | b'\n' | b'=' | b'"' | b'\'' | b'+' if self.number.is_none() => {}
            _ => {
                self.seen = 0;
                self.number = None;
            }
        }
    }
}
