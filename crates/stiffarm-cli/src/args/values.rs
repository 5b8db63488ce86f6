//! Values that several commands read alike.

/// A number of things to make: at least one, and not by a slip a million.
pub fn count() -> clap::builder::RangedU64ValueParser {
    clap::value_parser!(u64).range(1..=1_000_000)
}
