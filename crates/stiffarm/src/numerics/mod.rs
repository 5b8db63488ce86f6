//! Mathematics that knows nothing of robots but the error type: information
//! matrices and their factorisation, minimisation, random streams, jobs on all
//! cores, statistics of a sample.

pub mod arrangements;
pub mod control;
pub mod half_width;
pub mod information;
pub mod jobs;
pub(crate) mod lists;
pub mod nelder_mead;
pub mod optimise;
pub(crate) mod order;
pub mod sample;
pub mod scalar;
pub mod streams;
