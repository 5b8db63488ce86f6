//! Which given postures are least worth their measuring time.

use super::kinds::{Mode, Planned, SelectResultOptions};
use super::options::{SelectInputs, SelectOptions};
use crate::error::{Code, Result};
use crate::findings::Finding;
use crate::model::cell::Cell;
use crate::model::posture::Posture;
use crate::numerics::control::Control;
use crate::plan::check::prepared;
use crate::plan::select::{Dropped, drop_postures};
use serde::{Deserialize, Serialize};

/// What each posture is worth, and which ones stay.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DropResult {
    /// Names of the given postures: positions elsewhere count them from 0.
    pub posture_names: Vec<String>,
    /// The given postures, controller angles \[rad\].
    #[serde(rename = "postures_deg", with = "crate::units::degrees")]
    #[cfg_attr(feature = "schema", schemars(with = "Vec<Vec<f64>>"))]
    pub postures: Vec<Vec<f64>>,
    /// Worth of each posture, and the choice.
    #[serde(flatten)]
    pub dropped: Dropped,
    /// What to distrust about the robot of the catalogue, and given postures outside bounds or limits.
    pub findings: Vec<Finding>,
}

/// Compares the ways to leave out some of the postures of a `group`.
///
/// # Errors
/// As [`drop_postures`].
pub fn plan_drop(
    cell: &Cell,
    group: &[Posture],
    options: &SelectOptions,
    control: Control<'_>,
) -> Result<Planned<DropResult>> {
    options.check(&SelectInputs { given: group.to_vec(), ..SelectInputs::default() })?;
    let (cell, mut findings) = prepared(cell, true);
    let (index, count) = (options.index(), options.drop.unwrap_or(1));
    let dropped = drop_postures(&cell, index, group, count, control);
    let dropped = dropped.map_err(|error| match (error.code(), group.len()) {
        (Code::TooFewData, 2..) => error.hint(format!("leave out {} at most", group.len() - 1)),
        _ => error,
    })?;
    let postures = dropped.kept.iter().map(|p| group[*p].clone()).collect();
    findings.extend(cell.posture_findings(group));
    let result = DropResult {
        posture_names: group.iter().map(|p| p.name.clone()).collect(),
        postures: group.iter().map(|p| p.q.clone()).collect(),
        dropped,
        findings,
    };
    Ok(Planned { result, options: SelectResultOptions::new(Mode::Drop, options, &cell), seed: None, cell, postures })
}
