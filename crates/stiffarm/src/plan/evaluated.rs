//! What groups of postures are worth, with the postures.

use super::index::{GroupEvaluation, evaluate};
use crate::error::Result;
use crate::findings::{Finding, list};
use crate::model::cell::Cell;
use crate::model::posture::{Posture, PostureGroup};
use crate::plan::check::{determinable, start_touches};
use crate::plan::feasibility::on_machine_limits;
use serde::{Deserialize, Serialize};

/// A group of postures with its indices and expected errors.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct EvaluatedGroup {
    /// What the group is worth.
    #[serde(flatten)]
    pub evaluation: GroupEvaluation,
    /// Names of the postures.
    pub posture_names: Vec<String>,
    /// The postures, controller angles \[rad\].
    #[serde(rename = "postures_deg", with = "crate::units::degrees")]
    #[cfg_attr(feature = "schema", schemars(with = "Vec<Vec<f64>>"))]
    pub postures: Vec<Vec<f64>>,
}

impl EvaluatedGroup {
    /// [`evaluate`] of named postures.
    ///
    /// # Errors
    /// As [`evaluate`].
    pub fn new(cell: &Cell, name: &str, postures: &[Posture]) -> Result<Self> {
        Ok(EvaluatedGroup {
            evaluation: evaluate(cell, name, postures)?,
            posture_names: postures.iter().map(|p| p.name.clone()).collect(),
            postures: postures.iter().map(|p| p.q.clone()).collect(),
        })
    }

    /// The postures with their names.
    pub fn group(&self) -> PostureGroup {
        PostureGroup::named(&self.evaluation.name, &self.posture_names, self.postures.iter().cloned())
    }
}

/// Options of the result.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(rename = "Options"))]
pub struct EvaluatedOptions {
    /// L of Eq. (20) \[m\]; `null` where k(J_N) does not exist.
    pub characteristic_length_m: Option<f64>,
}

impl EvaluatedOptions {
    /// The options of an evaluation in `cell`.
    pub fn of(cell: &Cell) -> Self {
        EvaluatedOptions { characteristic_length_m: cell.characteristic_length }
    }
}

/// Groups of postures beside each other, as `evaluate` gives them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Evaluated {
    /// Names of the joints.
    pub joints: Vec<String>,
    /// The groups, in the order given.
    pub groups: Vec<EvaluatedGroup>,
    /// Joints that a group cannot determine, postures outside bounds or limits, and what the cell lacks.
    pub findings: Vec<Finding>,
}

impl Evaluated {
    /// Evaluates groups of postures, of the joints that the cell's load can determine.
    ///
    /// # Errors
    /// As [`evaluate`].
    pub fn new(cell: &Cell, groups: &[PostureGroup]) -> Result<Self> {
        let (cell, mut left_out) = determinable(cell.clone());
        let evaluated =
            groups.iter().map(|g| EvaluatedGroup::new(&cell, &g.name, &g.postures)).collect::<Result<Vec<_>>>()?;
        left_out.extend(start_touches(&cell));
        left_out.extend(findings(&cell, groups, &evaluated));
        Ok(Evaluated { joints: cell.setup.robot.spring_names(), findings: left_out, groups: evaluated })
    }
}

/// What to know before relying on the numbers.
fn findings(cell: &Cell, groups: &[PostureGroup], evaluated: &[EvaluatedGroup]) -> Vec<Finding> {
    let mut findings = Vec::new();
    for (group, evaluated) in groups.iter().zip(evaluated) {
        let evaluation = &evaluated.evaluation;
        if !evaluation.undetermined_joints.is_empty() {
            let sentence = format!(
                "{} cannot determine {}; `stiffarm check` looks for the reason.",
                group.name,
                list(&evaluation.undetermined_joints)
            );
            let code = "undetermined-joints";
            findings.push(Finding::serious(code, &group.name, sentence));
        }
        let outside = cell.posture_findings(&group.postures);
        let on_limits = on_machine_limits(cell, &group.postures);
        for mut finding in outside.into_iter().chain(on_limits) {
            finding.subject.clone_from(&group.name);
            finding.sentence = format!("{}: {}", group.name, finding.sentence);
            findings.push(finding);
        }
    }
    let mut lacks = |code: &str, sentence: &str| {
        findings.push(Finding::note(code, "cell", sentence));
    };
    if cell.prior.is_none() {
        lacks("no-prior", "The cell has no prior stiffness, so there are no expected errors.");
    }
    if cell.tasks.is_empty() {
        lacks("no-tasks", "The cell has no [[task]], so there is no task index.");
    }
    findings
}
