//! A study as figures, tables and a page.

mod figures;
mod page;
mod published;
mod table;
mod tables;

pub use figures::figures;
pub use page::page;
pub use published::{PAPER, PublishedTables, published_for};
pub use table::{Cell, Table};
pub use tables::tables;

use stiffarm::study::Study;

/// Index of the noise level nearest to variance factor 1, the one of Table 4.
pub(crate) fn illustration_level(study: &Study) -> usize {
    let factors = &study.options.simulation.variance_factors;
    let distance = |l: &usize| (factors[*l] - 1.0).abs();
    (0..factors.len())
        .min_by(|a, b| distance(a).total_cmp(&distance(b)))
        .unwrap_or(0)
}
