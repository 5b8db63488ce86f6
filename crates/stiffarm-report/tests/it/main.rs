//! All tests of the crate in one binary; a file per subject.

mod cells;
mod generic;
#[cfg(feature = "page")]
mod identified;
mod maps;
mod render;
