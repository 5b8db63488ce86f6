//! Tables in CSV: postures and displacements.
//!
//! Read: UTF-8 with or without byte order mark, LF or CRLF, columns separated
//! by commas (decimal point), or by semicolons or tabs (decimal comma or point,
//! as Excel writes in much of Europe). Blank lines and lines that begin with `#`
//! are skipped. Columns are found by their names, in any order; an unknown
//! column is an error, so that a slip in a heading is never ignored. Angles
//! are degrees, lengths millimetres, forces newtons, moments newton metres.
//!
//! Written: UTF-8, LF, commas, and the shortest decimals that are read back as
//! the same values: a written table, read and written again, is the same text.

mod displacements;
mod heading;
mod postures;
mod text;
mod write;

pub use displacements::read_displacements;
pub use postures::read_postures;
pub(crate) use text::decode;
pub use write::{reading_sheet, write_displacements, write_postures};

use sha2::{Digest, Sha256};

/// SHA-256 of `bytes` in lower-case hexadecimal: names an input in a result.
pub fn sha256_hex(bytes: &[u8]) -> String {
    let digest = Sha256::digest(bytes);
    digest.iter().map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    #[test]
    fn sha256_of_the_standard_example() {
        // FIPS 180-4 example: "abc".
        assert_eq!(
            super::sha256_hex(b"abc"),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"
        );
    }
}
