//! All tests of the crate in one binary; a file per subject.

mod behaviour;
mod capsules;
mod clamped;
mod commands;
mod edges;
mod errors;
mod examples;
mod fanuc;
mod faults;
mod hostile;
mod init;
mod interrupt;
mod map;
mod numbers;
mod outputs;
mod pose;
mod register;
mod saved;
mod select;
mod shapes;
mod support;
mod validate;
mod work;
mod zones;
