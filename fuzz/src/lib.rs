//! Mutated inputs for every reader and every command, and what must hold for each of them.
//!
//! Input `i` of a target follows from the seed alone, so that a fault is told by three words:
//! `cargo xtask fuzz --target T --seed S --input I`. A target makes an input ([`mutate`] knows
//! the grammars, [`seeds`] the files to start from) and judges what became of it ([`oracle`]):
//!
//! - no panic, and no error that is a fault of the program;
//! - no number that is not finite in a result;
//! - what was written reads back, and is written again as the same text;
//! - an error says something, in characters that can be seen;
//! - no input takes more than [`run::LONGEST`] or [`memory::LARGEST`].
//!
//! `fuzz/regressions/TARGET/` holds an input for each fault found; the tests replay them.

pub mod input;
pub mod memory;
pub mod minimise;
pub mod mutate;
pub mod oracle;
pub mod random;
pub mod run;
pub mod seeds;
pub mod targets;
