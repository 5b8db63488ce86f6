//! Which postures to measure, what joint stiffness the measurements give and
//! how sure that is, and how far an industrial robot bends at work.
//!
//! The method starts from Zhang, Guo, Sun, Sun, *Method of Postures Selection
//! for Industrial Robot Joint Stiffness Identification*, IEEE Access 2021,
//! doi:10.1109/ACCESS.2021.3073671 ("the paper"; "Eq. (n)" is its numbering).
//!
//! Everything inside is SI: m, rad, N, N·m, N·m/rad. Degrees and millimetres
//! exist only in files, on the command line and in tables.

pub mod error;
pub mod estimate;
#[cfg(feature = "files")]
pub mod files;
pub mod findings;
pub mod measure;
pub mod model;
mod numerics;
pub mod plan;
pub mod study;
pub mod units;
pub mod work;

pub use error::{Code, Error, Result};
pub use numerics::control::{Control, Report, Stop, Termination};

/// What this project's own tests and benches measure. No promise is made about it.
#[doc(hidden)]
pub mod internals {
    pub use crate::estimate::clamped::clamped_system;
    pub use crate::estimate::identify::internals::{
        Assumptions, Block, MeasuredSystem, Prepared, PriorKnowledge, RowLabel, Scale, Solution,
        Whitened, measured_system,
    };
    pub use crate::numerics::{information, jobs, optimise, sample, streams};
    pub use crate::plan::index::minimax::Minimax;

    /// Optimal continuous designs over any space of points.
    pub mod design {
        pub use crate::plan::certificate::continuous::optimal_design;
        pub use crate::plan::certificate::criterion::Criterion;
        pub use crate::plan::certificate::design::{
            ContinuousDesign, DesignOptions, DesignSpace, Effort,
        };
        pub use crate::plan::certificate::space::PostureSpace;
    }
}
