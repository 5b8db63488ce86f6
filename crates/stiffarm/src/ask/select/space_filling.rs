//! Postures that cover the joint space evenly, as a baseline.

use super::driven::driven;
use super::kinds::{Mode, Planned, SelectResultOptions};
use super::options::{SelectInputs, SelectOptions};
use crate::error::Result;
use crate::findings::Finding;
use crate::model::cell::Cell;
use crate::model::posture::PostureGroup;
use crate::numerics::control::{Control, Termination};
use crate::plan::check::prepared;
use crate::plan::index::{GroupEvaluation, evaluate};
use crate::plan::route::{Route, RouteOptions, route_findings};
use crate::plan::select::{smallest_distance, smallest_margin, space_filling};
use serde::{Deserialize, Serialize};

/// Evenly spread postures with what they are worth.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(rename = "SpaceFilling"))]
pub struct SpaceFillingPlan {
    /// Names of the joints, as in `evaluation`.
    pub joints: Vec<String>,
    /// Selected postures, controller angles \[rad\].
    #[serde(rename = "postures_deg", with = "crate::units::degrees")]
    #[cfg_attr(feature = "schema", schemars(with = "Vec<Vec<f64>>"))]
    pub postures: Vec<Vec<f64>>,
    /// Names of the selected postures, in the order of `postures_deg`.
    pub posture_names: Vec<String>,
    /// Smallest distance of two postures, relative to the joints' ranges: 0 to
    /// the root of their number; `null` for one posture.
    pub smallest_distance: Option<f64>,
    /// Why the search ended.
    pub termination: Termination,
    /// Smallest margin to a limit of the cell \[m\], `null` without limits.
    pub smallest_margin_m: Option<f64>,
    /// Every index and expected deviation of the postures.
    pub evaluation: GroupEvaluation,
    /// The moves between the postures, in their order.
    pub route: Route,
    /// What to distrust about the robot of the catalogue, and moves without a free way.
    pub findings: Vec<Finding>,
}

/// Spreads postures evenly and says what they are worth; a stop of `control` ends it with the best so far.
///
/// # Errors
/// As [`space_filling`]; a step of the angles that is not above zero; a cell whose postures cannot be evaluated.
pub fn plan_space_filling(
    cell: &Cell,
    options: &SelectOptions,
    control: Control<'_>,
) -> Result<Planned<SpaceFillingPlan>> {
    let nothing = SelectInputs::default();
    let options = &SelectOptions { space_filling: true, ..options.clone() };
    options.check(&nothing)?;
    let (cell, mut findings) = prepared(cell, true);
    let filling = space_filling(&cell, options.postures(&nothing), options.seed(), control)?;
    // A search that was stopped keeps its order.
    let keep = filling.termination == Termination::Interrupted;
    let driving = RouteOptions {
        keep_order: keep,
        keep_angles: keep,
        step_deg: options.angle_step(),
        seed: options.seed(),
        ..RouteOptions::default()
    };
    let (angles, route) = driven(&cell, &filling.postures, &driving, None, control)?;
    let group = PostureGroup::from_angles("space-filling", angles.iter().cloned());
    let postures = group.postures;
    findings.extend(route_findings(&cell, &postures, &route)?);
    let result = SpaceFillingPlan {
        joints: cell.setup.robot.spring_names(),
        posture_names: postures.iter().map(|p| p.name.clone()).collect(),
        smallest_distance: smallest_distance(&cell.bounds, &postures),
        termination: filling.termination,
        smallest_margin_m: smallest_margin(&cell, &postures)?,
        evaluation: evaluate(&cell, &group.name, &postures)?,
        postures: angles,
        route,
        findings,
    };
    Ok(Planned {
        result,
        options: SelectResultOptions::new(Mode::SpaceFilling, options, &cell),
        seed: Some(options.seed()),
        cell,
        postures,
    })
}
