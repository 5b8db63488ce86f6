//! All tests of the crate in one binary; a file per subject.

mod cells;
mod generic;
mod maps;
mod render;
mod scenes;
