//! What a plan's result holds, and what its table is made from.

use super::job::Mode;
use super::load;
use schemars::JsonSchema;
use serde::Serialize;
use stiffarm::findings::Finding;
use stiffarm::model::cell::Cell;
use stiffarm::model::posture::Posture;
use stiffarm::plan::certificate::{Certificate, JointEfficiency};
use stiffarm::plan::index::{EvaluatedGroup, GroupEvaluation};
use stiffarm::plan::route::Route;
use stiffarm::plan::select::{LimitPrice, LoadDesign, Selection, Sensitivity};

/// Options of the result.
#[derive(Serialize, JsonSchema)]
pub struct Options {
    /// `global`, `from` or `add`.
    pub mode: Mode,
    /// Number of postures selected.
    pub postures: usize,
    /// Iterations of the optimiser from an initial group; `null` without one.
    pub max_iterations: Option<u64>,
    /// Rounds asked for; `null` where the search ended by itself.
    pub rounds: Option<u64>,
    /// Time after which no further round was begun \[s\]; `null` without one.
    pub time_limit_s: Option<f64>,
    /// Steps that angles were rounded to \[deg\]; `null` where they were not.
    pub angle_step_deg: Option<f64>,
    /// What of the load might be chosen; `null` where nothing.
    pub load: Option<load::LoadOptions>,
    /// Whether a certificate was wanted.
    pub certificate: bool,
    /// Whether the plan's sensitivity was wanted.
    pub sensitivity: bool,
    /// Whether the prices of the limits were wanted.
    pub prices: bool,
    /// L of Eq. (20) \[m\].
    pub characteristic_length_m: Option<f64>,
}

/// The selected postures and what is known about them.
#[derive(Serialize, JsonSchema)]
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
    /// Whether wrong assumptions would change the plan; `null` unless asked for.
    pub sensitivity: Option<Sensitivity>,
    /// What each kind of limit costs, the dearest first; `null` unless asked for.
    pub prices: Option<Vec<LimitPrice>>,
    /// The moves between the selected postures, in their order, each given posture aside.
    pub route: Route,
    /// What to distrust about the robot of the catalogue, initial or given postures outside bounds or limits, and
    /// moves without a free way.
    pub findings: Vec<Finding>,
}

/// A plan with all that its table shows.
pub struct Planned<'a> {
    /// The result.
    pub plan: &'a Plan,
    /// The cell with the load that was chosen.
    pub cell: &'a Cell,
    /// What of the load might be chosen.
    pub design: &'a LoadDesign,
    /// The given postures.
    pub given: &'a [Posture],
    /// The selected postures.
    pub selected: &'a [Posture],
    /// Initial or given postures alone.
    pub before: Option<&'a GroupEvaluation>,
    /// Given and selected postures together.
    pub after: &'a GroupEvaluation,
}
