//! A study as figures, tables and a page.

mod cell_picture;
mod figures;
mod markdown;
mod measured;
mod page;
mod published;
mod table;
mod tables;

pub use cell_picture::cell_picture;
pub use figures::{figures, slug};
pub use measured::{measured_figure, measured_page, measured_table};
pub use page::page;
pub use published::{PAPER, PublishedTables, published_for};
pub use table::{Cell, Table};
pub use tables::tables;
