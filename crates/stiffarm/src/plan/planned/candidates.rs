//! The best postures out of a list.

use super::kinds::{Asked, Mode, POSTURES, Planned, SEED, check_count};
use crate::error::Result;
use crate::findings::Finding;
use crate::model::cell::Cell;
use crate::model::measurement::Candidate;
use crate::model::posture::Posture;
use crate::numerics::control::Control;
use crate::plan::check::prepared;
use crate::plan::feasibility::on_limits;
use crate::plan::index::Index;
use crate::plan::select::{CandidateOptions, CandidateSelection, limits_of, select_candidates};
use serde::{Deserialize, Serialize};

/// What is asked of a choice out of a list.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct CandidateRequest {
    /// The index to improve.
    #[serde(skip)]
    pub index: Index,
    /// Number of postures to choose.
    pub postures: usize,
    /// Random groups from which the exchange starts.
    pub starts: usize,
    /// Seed of the random numbers.
    #[serde(skip)]
    pub seed: u64,
    /// Whether bounds and limits of the cell count: not for measured postures, which the machine held.
    #[serde(skip)]
    pub limits: bool,
    /// Whether to bound how good any other choice could be.
    pub certificate: bool,
}

impl Default for CandidateRequest {
    fn default() -> Self {
        CandidateRequest {
            index: Index::Prediction,
            postures: POSTURES,
            starts: CandidateOptions::default().starts,
            seed: SEED,
            limits: true,
            certificate: true,
        }
    }
}

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

/// Chooses the best postures of a list; a stop of `control` ends it with the best so far.
///
/// # Errors
/// As [`select_candidates`].
pub fn plan_candidates(
    cell: &Cell,
    candidates: &[Candidate],
    request: &CandidateRequest,
    control: Control<'_>,
) -> Result<Planned<Chosen, Asked<CandidateRequest>>> {
    check_count(request.postures)?;
    let measured = |c: &Candidate| c.wrench.is_some() || c.states.iter().any(|s| s.1.is_some());
    let measured_wrenches = candidates.iter().any(measured);
    // The wrenches of measured postures are not the load of the cell.
    let (cell, mut findings) = prepared(cell, !measured_wrenches);
    let (index, count) = (request.index, request.postures);
    let options = CandidateOptions {
        starts: request.starts,
        seed: request.seed,
        limits: request.limits,
        bound: request.certificate,
        ..CandidateOptions::default()
    };
    let selection = select_candidates(&cell, index, count, candidates, &options, control)?;
    let chosen = selection.chosen.iter().map(|p| Posture {
        name: candidates[*p].name.clone(),
        q: candidates[*p].q.clone(),
    });
    let postures: Vec<Posture> = chosen.collect();
    let limits = limits_of(&cell, &postures)?;
    findings.extend(on_limits(&cell, &postures, &limits));
    let result = Chosen {
        joints: cell.setup.robot.spring_names(),
        candidate_names: candidates.iter().map(|c| c.name.clone()).collect(),
        measured_wrenches,
        postures: postures.iter().map(|p| p.q.clone()).collect(),
        posture_names: postures.iter().map(|p| p.name.clone()).collect(),
        findings,
        selection,
    };
    let options = Asked::new(Mode::Candidates, request, &cell);
    Ok(Planned {
        result,
        options,
        seed: Some(request.seed),
        cell,
        postures,
    })
}
