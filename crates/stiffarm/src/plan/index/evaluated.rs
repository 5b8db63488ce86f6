//! What a group of postures is worth, with the postures.

use super::evaluate::{GroupEvaluation, evaluate};
use crate::error::Result;
use crate::model::cell::Cell;
use crate::model::posture::{Posture, PostureGroup};
use serde::{Deserialize, Serialize};

/// A group of postures with its indices and expected errors.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct EvaluatedGroup {
    /// What the group is worth.
    #[serde(flatten)]
    pub evaluation: GroupEvaluation,
    /// Names of the postures.
    #[serde(default)]
    pub posture_names: Vec<String>,
    /// The postures, controller angles \[rad\].
    #[serde(default, rename = "postures_deg", with = "crate::units::degrees")]
    #[cfg_attr(
        feature = "schema",
        schemars(
            with = "Vec<Vec<f64>>",
            description = "The postures, controller angles \\[deg\\]."
        )
    )]
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
        PostureGroup::named(
            &self.evaluation.name,
            &self.posture_names,
            self.postures.iter().cloned(),
        )
    }
}
