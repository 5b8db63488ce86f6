//! The only part of stiffarm that reads and writes text and bytes: cell files,
//! tables, robot programs, tool paths, saved results, built-in examples.
//!
//! ```
//! use stiffarm_files::{builtin, table::read_postures};
//!
//! let cell = builtin::cell("comau")?;
//! let text = "posture;q1_deg;q2_deg;q3_deg;q4_deg;q5_deg;q6_deg\np1;10,5;20;-100;0;45;0\n";
//! let postures = read_postures(text.as_bytes(), "plan.csv", &cell.setup.robot)?;
//! assert!((postures[0].q[0] - 10.5_f64.to_radians()).abs() < 1e-15);
//! # Ok::<(), stiffarm::Error>(())
//! ```

mod binary;
pub mod builtin;
pub mod cell;
pub mod envelope;
mod json;
pub mod mesh;
mod names;
pub mod program;
pub mod registration;
pub mod result;
pub mod seal;
pub mod source;
pub mod stiffness;
pub mod table;
mod text;
pub mod tool_path;
pub mod urdf;

pub use names::check_name;

/// What this project's own tests measure. No promise is made about it.
#[doc(hidden)]
pub mod internals {
    pub use crate::program::characters::{plain, wrapped};
    pub use crate::program::text::fixed;
}
