//! One file or folder per command: reads, calls the library, answers.

pub mod capsules;
pub mod check;
pub mod compensate;
pub mod completions;
pub mod coverage;
pub mod docs;
mod earlier;
pub mod evaluate;
pub mod export;
#[cfg(feature = "schema")]
pub mod generated;
pub mod identify;
pub mod init;
pub mod man;
pub mod map;
pub mod measure;
pub mod pose;
pub mod predict;
pub mod register;
pub mod report;
pub mod robots;
pub mod route;
pub mod schema;
pub mod select;
pub mod simulate;
pub mod study;
pub mod validate;
pub mod zones;
