//! All tests of the crate in one binary; a file per subject.

mod behaviour;
mod capsules;
mod cell_mesh;
mod clamped;
mod commands;
mod day;
mod edges;
mod errors;
mod examples;
mod export;
mod fanuc;
mod faults;
mod hostile;
mod init;
mod interrupt;
mod load_cases;
mod map;
mod numbers;
mod outputs;
mod own_robot;
#[cfg(feature = "report")]
mod papers;
mod pictures;
mod pose;
mod register;
mod report;
mod same_as_library;
mod saved;
mod select;
mod shapes;
mod sheets;
mod support;
mod validate;
mod work;
mod zones;
