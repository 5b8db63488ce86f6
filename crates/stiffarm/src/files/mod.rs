//! The only part of the library that reads and writes text and bytes: cell files,
//! tables, saved results, built-in examples.

pub mod builtin;
pub mod cell;
mod json;
mod names;
pub mod registration;
pub mod stiffness;
pub mod table;

pub use names::check_name;
