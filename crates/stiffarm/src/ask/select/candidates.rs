//! The best postures out of a list.

use super::kinds::{Mode, Planned, SelectResultOptions};
use super::options::{SelectInputs, SelectOptions};
use crate::error::Result;
use crate::estimate::forecast::add_forecast;
use crate::findings::Finding;
use crate::model::cell::Cell;
use crate::model::measurement::Candidate;
use crate::model::posture::Posture;
use crate::numerics::control::Control;
use crate::plan::check::prepared;
use crate::plan::feasibility::on_limits;
use crate::plan::select::{CandidateOptions, CandidateSelection, limits_of, select_candidates};
use serde::{Deserialize, Serialize};

/// The chosen postures and what is known about them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Chosen {
    /// The choice.
    #[serde(flatten)]
    pub selection: CandidateSelection,
    /// Names of the joints, as in `evaluation`.
    pub joints: Vec<String>,
    /// Names of all candidates: positions elsewhere count them from 0.
    pub candidate_names: Vec<String>,
    /// True where some candidates count under measured wrenches.
    pub measured_wrenches: bool,
    /// Chosen postures, controller angles \[rad\].
    #[serde(rename = "postures_deg", with = "crate::units::degrees")]
    #[cfg_attr(feature = "schema", schemars(with = "Vec<Vec<f64>>"))]
    pub postures: Vec<Vec<f64>>,
    /// Their names.
    pub posture_names: Vec<String>,
    /// What to distrust about the robot of the catalogue, and what sits on a limit.
    pub findings: Vec<Finding>,
}

/// Chooses the best postures of a list, `within` bounds and limits of the cell (not for measured postures, which the
/// machine held); a stop of `control` ends it with the best so far.
///
/// # Errors
/// As [`select_candidates`].
pub fn plan_candidates(
    cell: &Cell,
    candidates: &[Candidate],
    within: bool,
    options: &SelectOptions,
    control: Control<'_>,
) -> Result<Planned<Chosen>> {
    let nothing = SelectInputs::default();
    options.check(&nothing)?;
    let measured = |c: &Candidate| c.wrench.is_some() || c.states.iter().any(|s| s.1.is_some());
    let measured_wrenches = candidates.iter().any(measured);
    // The wrenches of measured postures are not the load of the cell.
    let (cell, mut findings) = prepared(cell, !measured_wrenches);
    let (index, count) = (options.index(), options.postures(&nothing));
    let exchange = CandidateOptions {
        seed: options.seed(),
        limits: within,
        bound: !options.no_certificate,
        ..CandidateOptions::default()
    };
    let mut selection = select_candidates(&cell, index, count, candidates, &exchange, control)?;
    let chosen =
        selection.chosen.iter().map(|p| Posture { name: candidates[*p].name.clone(), q: candidates[*p].q.clone() });
    let postures: Vec<Posture> = chosen.collect();
    let limits = limits_of(&cell, &postures)?;
    findings.extend(on_limits(&cell, &postures, &limits));
    // Measured wrenches are not the load of the cell.
    if !measured_wrenches {
        add_forecast(&cell, &postures, &mut selection.evaluation);
    }
    let result = Chosen {
        joints: cell.setup.robot.spring_names(),
        candidate_names: candidates.iter().map(|c| c.name.clone()).collect(),
        measured_wrenches,
        postures: postures.iter().map(|p| p.q.clone()).collect(),
        posture_names: postures.iter().map(|p| p.name.clone()).collect(),
        findings,
        selection,
    };
    Ok(Planned {
        result,
        options: SelectResultOptions::new(Mode::Candidates, options, &cell),
        seed: Some(options.seed()),
        cell,
        postures,
    })
}
