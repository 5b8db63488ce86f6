//! What a plan's result holds.

use super::in_time::InTime;
use crate::findings::Finding;
use crate::plan::certificate::{Certificate, JointEfficiency};
use crate::plan::check::FurtherLoad;
use crate::plan::evaluated::EvaluatedGroup;
use crate::plan::index::GroupEvaluation;
use crate::plan::route::Route;
use crate::plan::select::{LimitPrice, Selection, Sensitivity};
use serde::{Deserialize, Serialize};

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
