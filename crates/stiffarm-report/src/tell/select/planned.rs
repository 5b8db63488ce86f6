//! A plan as its file has it.

use serde::Deserialize;
use stiffarm::model::posture::{Posture, PostureGroup};
use stiffarm::plan::certificate::{Certificate, JointEfficiency};
use stiffarm::plan::index::{EvaluatedGroup, GroupEvaluation};
use stiffarm::plan::route::Route;
use stiffarm::plan::select::{LimitPrice, Selection, Sensitivity};

/// What `select` writes of a plan, as far as the page shows it.
#[derive(Deserialize)]
pub(super) struct Plan {
    #[serde(flatten)]
    pub selection: Selection,
    #[serde(default)]
    pub posture_names: Vec<String>,
    #[serde(default)]
    pub joints: Vec<String>,
    pub evaluation: Option<GroupEvaluation>,
    pub before: Option<EvaluatedGroup>,
    #[serde(default)]
    pub repeats: Vec<Vec<String>>,
    #[serde(default)]
    pub given_names: Vec<String>,
    pub certificate: Option<Certificate>,
    pub joint_efficiencies: Option<Vec<JointEfficiency>>,
    pub certificate_missing: Option<String>,
    pub sensitivity: Option<Sensitivity>,
    pub prices: Option<Vec<LimitPrice>>,
    pub route: Option<Route>,
}

impl Plan {
    /// The selected postures with their names.
    pub fn postures(&self) -> Vec<Posture> {
        let angles = self.selection.group.iter().cloned();
        PostureGroup::named("", &self.posture_names, angles).postures
    }
}
