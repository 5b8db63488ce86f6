//! All tests of the crate in one binary; a file per subject.

mod behaviour;
mod capsules;
mod cell_mesh;
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
mod own_robot;
mod pictures;
mod pose;
mod register;
mod saved;
mod select;
mod support;
mod validate;
mod work;
mod zones;
