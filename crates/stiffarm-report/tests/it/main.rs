//! All tests of the crate in one binary; a file per subject.

mod agreement;
mod at_work;
mod cells;
mod common;
mod day;
mod gallery;
mod generic;
mod identified;
mod maps;
mod page;
mod pages;
mod paper;
mod render;
mod scenes;
mod summary;
