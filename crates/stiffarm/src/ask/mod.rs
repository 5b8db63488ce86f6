//! What the commands ask: for each a struct with its options as they are typed, and a function that does all of its
//! work between reading and writing.
//!
//! An option is a field here and nowhere else. Its comment is the help of the command and of Python and the description
//! in the JSON Schema, its type is its default and its limits, and the result echoes the struct as it is. So lengths
//! are mm and angles degrees here, as their names say; what is calculated with is SI. With the feature `clap` the
//! structs are arguments of a command line.

// Comments of options are help texts: [mm] there is a unit, and no link.
#![allow(rustdoc::broken_intra_doc_links)]

pub mod compensate;
pub mod coverage;
pub mod fit;
pub mod identify;
pub mod map;
pub mod measure;
pub mod path;
pub mod place;
pub mod pose;
pub mod predict;
pub mod region;
pub mod register;
pub mod route;
pub mod rules;
pub mod select;
pub mod simulate;
pub mod validate;
pub mod zones;

#[cfg(feature = "clap")]
pub mod values;
