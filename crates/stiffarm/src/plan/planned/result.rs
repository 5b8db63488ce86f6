//! What a plan's result holds.

use super::in_time::InTime;
use super::kinds::Mode;
use crate::findings::Finding;
use crate::plan::certificate::{Certificate, JointEfficiency};
use crate::plan::check::FurtherLoad;
use crate::plan::evaluated::EvaluatedGroup;
use crate::plan::index::GroupEvaluation;
use crate::plan::route::Route;
use crate::plan::select::{LimitPrice, LoadDesign, Selection, Sensitivity};
use serde::{Deserialize, Serialize};

/// Options of the result.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "Options")
)]
pub struct PlanOptions {
    /// `global`, `from` or `add`.
    pub mode: Mode,
    /// Number of postures selected.
    pub postures: usize,
    /// Time beside the robot that was given for the plan \[s\]; absent where its number of postures was.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub measuring_time_s: Option<f64>,
    /// Whether the index `prediction` might choose postures within 15° of each other in every joint.
    #[serde(default)]
    pub repeats: bool,
    /// Iterations of the optimiser from an initial group; `null` without one.
    pub max_iterations: Option<u64>,
    /// Rounds asked for; `null` where the search ended by itself.
    pub rounds: Option<u64>,
    /// Time after which no further round was begun \[s\]; `null` without one.
    pub time_limit_s: Option<f64>,
    /// Steps that angles were rounded to \[deg\]; `null` where they were not.
    pub angle_step_deg: Option<f64>,
    /// What of the load might be chosen; `null` where nothing.
    pub load: Option<LoadOptions>,
    /// Whether a certificate was wanted.
    pub certificate: bool,
    /// Whether the plan's sensitivity was wanted.
    pub sensitivity: bool,
    /// Whether the prices of the limits were wanted.
    pub prices: bool,
    /// L of Eq. (20) \[m\].
    pub characteristic_length_m: Option<f64>,
}

/// What of the load might be chosen.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LoadOptions {
    /// Lowest and highest corner for the anchor, base axes \[m\]; `null` where it stays.
    pub anchor_box_m: Option<[[f64; 3]; 2]>,
    /// Lowest and highest corner for the loading point, flange axes \[m\]; `null` where it stays.
    pub loading_point_box_m: Option<[[f64; 3]; 2]>,
    /// Largest force allowed \[N\]; `null` where the cell's stays.
    pub largest_load_n: Option<f64>,
}

impl LoadOptions {
    /// `None` where nothing may move.
    pub(super) fn of(design: &LoadDesign) -> Option<Self> {
        (!design.is_empty()).then(|| LoadOptions {
            anchor_box_m: design.anchor.map(|corners| corners.map(Into::into)),
            loading_point_box_m: design.loading_point.map(|corners| corners.map(Into::into)),
            largest_load_n: design.magnitude,
        })
    }
}

/// The selected postures and what is known about them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Plan {
    /// The selection; its index and indices count the given postures too.
    #[serde(flatten)]
    pub selection: Selection,
    /// Names of the selected postures, in the order of `postures_deg`.
    pub posture_names: Vec<String>,
    /// Names of the joints, as in `evaluation`.
    pub joints: Vec<String>,
    /// What given and selected postures together are worth.
    pub evaluation: GroupEvaluation,
    /// What the initial or the given postures alone are worth; `null` without any.
    pub before: Option<EvaluatedGroup>,
    /// Names of selected postures that are the same within half a degree in every joint, group
    /// by group: what to measure more than once.
    pub repeats: Vec<Vec<String>>,
    /// Names of the postures that were given; empty without any.
    pub given_names: Vec<String>,
    /// The index of the given postures alone; `null` where there are none or
    /// they leave a joint undetermined.
    pub given_value: Option<f64>,
    /// How good any plan of as many postures could be; `null` where the index
    /// has no bound, or none was wanted or found.
    pub certificate: Option<Certificate>,
    /// The same for each joint on its own; `null` also beside given postures.
    pub joint_efficiencies: Option<Vec<JointEfficiency>>,
    /// Why there is no certificate, where one was wanted; else `null`.
    pub certificate_missing: Option<String>,
    /// What measuring the selected postures takes \[s\], each under all loads of the plan.
    #[serde(default)]
    pub time_s: f64,
    /// What the cell's ways to load the arm give in the time that was asked for, the best first; absent without.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub in_time: Vec<InTime>,
    /// What a weight in the same postures would add; absent where the load is no pull through one point or one way, and
    /// where it adds little.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub further_load: Option<FurtherLoad>,
    /// Whether wrong assumptions would change the plan; `null` unless asked for.
    pub sensitivity: Option<Sensitivity>,
    /// What each kind of limit costs, the dearest first; `null` unless asked for.
    pub prices: Option<Vec<LimitPrice>>,
    /// The moves between the selected postures, in their order, each given posture aside.
    pub route: Route,
    /// What to distrust about the robot of the catalogue, initial or given postures outside bounds or limits, moves
    /// without a free way, and postures on limits.
    pub findings: Vec<Finding>,
}
