//! A study as figures and tables.

mod cell_picture;
mod figures;
mod measured;
mod published;
mod table;
mod tables;

pub use cell_picture::cell_picture;
pub use figures::{figures, slug};
pub use measured::{measured_figure, measured_table};
pub use published::{PAPER, PublishedTables, published_for};
pub use table::{Cell, Table};
pub(crate) use tables::index_name;
pub use tables::tables;
