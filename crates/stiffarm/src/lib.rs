//! Which postures to measure, what joint stiffness the measurements give and
//! how sure that is, and how far an industrial robot bends at work.
//!
//! The method starts from Zhang, Guo, Sun, Sun, *Method of Postures Selection
//! for Industrial Robot Joint Stiffness Identification*, IEEE Access 2021,
//! doi:10.1109/ACCESS.2021.3073671 ("the paper"; "Eq. (n)" is its numbering).
//!
//! The main job, from a cell to a deflection; here a built-in cell and a simulated
//! experiment stand in for your own (`examples/main_job.rs`):
//!
//! ```
//! use stiffarm::{Control, Fit, Index, LoadedPosture, Wrench};
//! use stiffarm::{predict, prepare, select, simulated_readings};
//! use stiffarm_files::builtin;
//!
//! fn main() -> stiffarm::Result<()> {
//!     let (cell, control) = (builtin::cell("comau")?, Control::default());
//!     let plan = select(&cell, Index::ExpectedError, 6, &Default::default(), control)?;
//!     println!("six postures: k to {:.2} % (RMS)", 100.0 * plan.value);
//!     // Stands in for a day with robot and tracker.
//!     let readings = simulated_readings(&cell, &plan.group, 1)?;
//!     let measured = prepare(&cell, readings, &Default::default())?;
//!     let fit = Fit::new(&cell, &measured, &Default::default())?;
//!     for joint in &fit.identification()?.estimates.joints {
//!         println!("{joint}");
//!     }
//!     let force = Wrench::force([0.0, 300.0, 0.0]);
//!     let work = [LoadedPosture::new("mill", plan.group[0].clone(), force)];
//!     let compliance = fit.compliance()?;
//!     let bend = predict(&cell, &compliance, &work, &Default::default(), control)?;
//!     println!("300 N bend it by {:.3} mm", 1e3 * bend.deflection_max_m);
//!     Ok(())
//! }
//! ```
//!
//! | module | answers |
//! |:--|:--|
//! | [`model`] | what is the robot, its tool, its load, its cell, and how do they bend? |
//! | [`plan`] | which postures to measure, and how good can any plan be? |
//! | [`measure`] | from raw readings to displacements, and what is wrong with them |
//! | [`estimate`] | which joint stiffness, how sure, and what limits it? |
//! | [`work`] | how far does the arm bend at work, and what to command instead? |
//! | [`study`] | the paper's comparison of indices on any cell |
//! | [`ask`] | all that a command says, in one call, with its options |
//!
//! Nothing here reads or writes a file: cell files, tables, robot programs and built-in examples are the crate
//! `stiffarm-files`.
//!
//! Everything inside is SI: m, rad, N, N·m, N·m/rad. Degrees and millimetres
//! exist only in files, on the command line and in tables.

pub mod ask;
pub mod error;
pub mod estimate;
pub mod findings;
pub mod measure;
pub mod model;
mod numerics;
pub mod plan;
pub mod study;
pub mod units;
pub mod work;

pub use error::{Code, Error, Result};
pub use estimate::compliance::IdentifiedCompliance;
pub use estimate::identify::{Fit, Identification, IdentifyOptions, identify};
pub use measure::experiment::simulated_readings;
pub use measure::{Measured, prepare};
pub use model::cell::Cell;
pub use model::load::{Load, Wrench};
pub use model::path::LoadedPosture;
pub use model::posture::{Posture, PostureGroup};
pub use model::robot::Robot;
pub use model::tool::Tool;
pub use nalgebra;
pub use plan::index::{Index, evaluate};
pub use plan::select::{GlobalOptions, Selection, select};
pub use work::compensate::compensate;
pub use work::predict::{Prediction, predict};

pub use numerics::control::{Control, Report, Stop, Termination, Watch};

/// What this project's own tests and benches measure. No promise is made about it.
#[doc(hidden)]
pub mod internals {
    pub use crate::estimate::clamped::clamped_system;
    pub use crate::estimate::identify::internals::{
        Assumptions, Block, Covariance, MeasuredSystem, Prepared, PriorKnowledge, RowLabel, Scale, Solution, Whitened,
        estimates, measured_system, quantile, solutions_without,
    };
    pub use crate::estimate::mixed::internals::MixedModel;
    pub use crate::estimate::quantity::answer::internals::{QuantityResponse, both_ways, quantities};
    pub use crate::estimate::systematic::posterior::{moments, noise, sizes};
    pub use crate::model::elastic::elastic_effects;
    pub use crate::model::observation::internals::link_axes;
    pub use crate::numerics::{
        arrangements, half_width, information, jobs, nelder_mead, optimise, sample, scalar, streams,
    };
    pub use crate::plan::index::internals::evaluate_for;
    pub use crate::plan::index::kernel::lanes::{Lanes, WIDTH, sin_cos};
    pub use crate::plan::index::kernel::{Kernel, KernelOutputs};
    pub use crate::plan::index::minimax::Minimax;
    pub use crate::plan::route::places::Places;

    /// Optimal continuous designs over any space of points.
    pub mod design {
        pub use crate::plan::certificate::continuous::optimal_design;
        pub use crate::plan::certificate::criterion::Criterion;
        pub use crate::plan::certificate::design::{ContinuousDesign, DesignOptions, DesignSpace, Effort};
        pub use crate::plan::certificate::space::PostureSpace;
        pub use crate::plan::certificate::weights::{WeightProblem, optimal_weights};
    }
}
