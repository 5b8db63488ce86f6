//! Where a workpiece may be, and one place that was tried.

use super::status::Status;
use serde::{Deserialize, Serialize};

/// Where the workpiece may be.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct PlaceOptions {
    /// Lower corner of the box for the workpiece's origin, base frame \[m\].
    pub lower: [f64; 3],
    /// Upper corner \[m\].
    pub upper: [f64; 3],
    /// Places along x, y, z in the first round; 1 takes the middle.
    pub steps: [usize; 3],
    /// Turns of the workpiece about the base's z that are tried, added to its own
    /// orientation \[rad\]; in finer rounds the best alone.
    pub yaws: Vec<f64>,
    /// Turns about the tool axis that are tried where the path leaves it free.
    pub free_turns: usize,
    /// Finer grids, each about the best place so far.
    pub refinements: usize,
}

impl Default for PlaceOptions {
    fn default() -> Self {
        PlaceOptions {
            lower: [0.0; 3],
            upper: [0.0; 3],
            steps: [1; 3],
            yaws: vec![0.0],
            free_turns: 12,
            refinements: 2,
        }
    }
}

/// One place that was tried.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PlacementCandidate {
    /// Round of the search: 0 is the first grid.
    pub round: usize,
    /// Origin of the workpiece, base frame \[m\].
    pub position_m: [f64; 3],
    /// Turn about the base's z, added to the given orientation \[rad\].
    #[serde(rename = "yaw_deg", with = "crate::units::degrees")]
    #[cfg_attr(feature = "schema", schemars(with = "f64"))]
    pub yaw: f64,
    /// Whether the arm can go along the path there.
    pub status: Status,
    /// RMS of the deflections along the path, linear model, thinned path \[m\].
    pub deflection_rms_m: Option<f64>,
    /// Largest deflection, the same way \[m\].
    pub deflection_max_m: Option<f64>,
    /// Why the arm cannot go along.
    pub reason: Option<String>,
    /// Point of the path where that is.
    pub point: Option<String>,
}

/// A place of the workpiece with the whole path there.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PlaceEvaluation {
    /// Origin of the workpiece, base frame \[m\].
    pub position_m: [f64; 3],
    /// Its orientation: turns about x, then y, then z of the base \[rad\].
    #[serde(rename = "rpy_deg", with = "crate::units::degrees")]
    #[cfg_attr(feature = "schema", schemars(with = "[f64; 3]"))]
    pub roll_pitch_yaw: [f64; 3],
    /// Turn about the base's z, added to the given orientation \[rad\].
    #[serde(rename = "yaw_deg", with = "crate::units::degrees")]
    #[cfg_attr(feature = "schema", schemars(with = "f64"))]
    pub yaw: f64,
    /// Turn about the tool axis, where the path leaves it free \[rad\].
    #[serde(rename = "turn_deg", with = "crate::units::degrees::all_digits")]
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub turn: Option<f64>,
    /// Whether the arm can go along the path.
    pub status: Status,
    /// Why not.
    pub reason: Option<String>,
    /// Point of the path where that is.
    pub point: Option<String>,
    /// RMS of the deflections along the whole path, exact equilibrium \[m\].
    pub deflection_rms_m: Option<f64>,
    /// Largest deflection \[m\].
    pub deflection_max_m: Option<f64>,
    /// Point of the largest deflection.
    pub deflection_max_point: Option<String>,
    /// Posture at the first point, controller angles \[rad\].
    #[serde(rename = "start_deg", with = "crate::units::degrees")]
    #[cfg_attr(feature = "schema", schemars(with = "Option<Vec<f64>>"))]
    pub start: Option<Vec<f64>>,
    /// The path there at the points that the search looks at, and where it bends most; empty where the arm
    /// cannot go along.
    pub along: Vec<PlacedPoint>,
}

/// A point of a path at a place of the workpiece.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PlacedPoint {
    /// Name of the point.
    pub point: String,
    /// Controller angles \[rad\].
    #[serde(rename = "q_deg", with = "crate::units::degrees")]
    #[cfg_attr(feature = "schema", schemars(with = "Vec<f64>"))]
    pub q: Vec<f64>,
    /// Position of the unloaded tip, base frame \[m\].
    pub tip_m: [f64; 3],
    /// Force on the robot at the tip, base axes \[N\].
    pub force_n: [f64; 3],
    /// Moment about the tip, base axes \[N·m\].
    pub moment_nm: [f64; 3],
    /// Shift of the tip, exact equilibrium, base axes \[m\].
    pub shift_m: [f64; 3],
}
