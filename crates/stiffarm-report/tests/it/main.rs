//! All tests of the crate in one binary; a file per subject.

mod cells;
#[path = "../../examples/gallery/figures.rs"]
mod gallery;
mod generic;
#[cfg(feature = "page")]
mod identified;
#[cfg(feature = "page")]
mod maps;
#[cfg(feature = "page")]
mod page;
#[cfg(feature = "page")]
mod pages;
mod paper;
mod render;
mod scenes;
mod tell;
