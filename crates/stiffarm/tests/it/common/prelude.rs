//! What most tests use, by one import.

#![allow(unused_imports)]

pub(crate) use crate::common;
pub use crate::common::random::Dice;
pub use crate::common::runs::{most, runs, slack, standard_error};
pub use crate::common::set_ups::*;
pub use crate::common::{cases, default_cell, group1, reference_cell, relative_error};
pub use nalgebra::{DMatrix, DVector, Isometry3, Matrix6, Translation3, UnitQuaternion, Vector3, Vector6};
pub use std::f64::consts::{FRAC_PI_2, PI};
pub use stiffarm::estimate::compliance::IdentifiedCompliance;
pub use stiffarm::estimate::diagnose::diagnose;
pub use stiffarm::estimate::elastic::ElasticChoice;
pub use stiffarm::estimate::identify::{Estimator, Fit, IdentifyOptions, NoiseSource, Verdict, Weights, identify};
pub use stiffarm::estimate::next_posture::next_posture;
pub use stiffarm::estimate::simulate::{SimulationOptions, simulate};
pub use stiffarm::estimate::systematic::systematic_errors;
pub use stiffarm::estimate::validate::{
    Model, calculated_displacements, cross_validate, simulate_measurements, validate_with,
};
pub use stiffarm::findings::{Finding, Severity};
pub use stiffarm::internals::information::Factor;
pub use stiffarm::internals::measured_system;
pub use stiffarm::internals::optimise::Options;
pub use stiffarm::measure::experiment::{
    BaseCompliance, DisplacementModel, Experiment, ExperimentState, ForceRecord, ToolWeight, TrackerNoise, experiment,
};
pub use stiffarm::measure::reduction::{ReduceOptions, reduce};
pub use stiffarm::measure::registration::{PointPair, register};
pub use stiffarm::measure::screening::screen;
pub use stiffarm::measure::{Measured, prepare};
pub use stiffarm::model::cell::{Cell, LimitKind, Limits};
pub use stiffarm::model::instruments::{Mount, Sensor, TrackerAccuracy};
pub use stiffarm::model::inverse::InverseKinematics;
pub use stiffarm::model::kinematics::Frames;
pub use stiffarm::model::load::{Axes, Load, Wrench};
pub use stiffarm::model::measurement::{
    Candidate, Displacement, MeasuredPosture, ReadingTable, ReadingTarget, ReferencePart,
};
pub use stiffarm::model::observation::{ExtraTerm, PostureTerms, Rows, observation_matrix};
pub use stiffarm::model::path::LoadedPosture;
pub use stiffarm::model::posture::{Posture, PostureGroup};
pub use stiffarm::model::process::ForceAxes;
pub use stiffarm::model::robot::{DhConvention, DhRow, Robot, find_in_catalogue};
pub use stiffarm::model::shape::{Capsule, TriangleMesh};
pub use stiffarm::model::stiffness::{
    equilibrium, equilibrium_displacement, joint_compliance, linear_displacement, stiffness_correction,
};
pub use stiffarm::model::tool::SeriesCompliance;
pub use stiffarm::plan::certificate::{CertificateOptions, certify};
pub use stiffarm::plan::index::{Index, IndexFunction, evaluate};
pub use stiffarm::plan::route::rounded;
pub use stiffarm::plan::select::{
    CandidateOptions, GlobalOptions, LoadDesign, LocalOptions, Selection, StartKind, random_group, select,
    select_candidates, select_from, smallest_margin,
};
pub use stiffarm::work::predict::{LoadedArm, PredictOptions, predict};
pub use stiffarm::{Code, Control, Error, Termination, simulated_readings};
pub use stiffarm_files::builtin;
pub use stiffarm_files::cell::parse_cell;
