//! All tests of the crate in one binary; a file per subject.

mod cells;
mod generic;
mod maps;
#[cfg(feature = "page")]
mod page;
#[cfg(feature = "page")]
mod pages;
mod render;
mod scenes;
