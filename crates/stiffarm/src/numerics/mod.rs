//! Mathematics that knows nothing of robots but the error type: information
//! matrices and their factorisation, minimisation, random streams, jobs on all
//! cores, statistics of a sample.

pub mod control;
pub(crate) mod half_width;
pub mod information;
pub mod jobs;
pub(crate) mod lists;
pub(crate) mod nelder_mead;
pub mod optimise;
pub(crate) mod order;
pub mod sample;
pub(crate) mod scalar;
pub mod streams;
