//! The only part of the library that reads and writes text and bytes: cell files,
//! tables, saved results, built-in examples.

pub mod builtin;
pub mod cell;
mod json;
pub mod registration;
pub mod stiffness;
pub mod table;
