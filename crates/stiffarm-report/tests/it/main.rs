//! All tests of the crate in one binary; a file per subject.

mod cells;
#[path = "../../examples/gallery/figures.rs"]
mod gallery;
mod generic;
mod maps;
#[cfg(feature = "print")]
mod print;
mod render;
mod scenes;
