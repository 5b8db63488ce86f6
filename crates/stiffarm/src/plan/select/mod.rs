//! Choosing postures: the paper's procedure, from an initial group (Section III.B).

mod error_by_count;
mod global;
mod load_design;
mod posture_value;
mod random;
mod search;
mod sensitivity;
mod space_filling;

pub use error_by_count::{ErrorAtCount, error_by_count};
pub use global::{GlobalOptions, RoundReport, select_global, select_watched};
pub use load_design::{DesignedLoad, LoadDesign};
pub use posture_value::{Dropped, PostureValue, drop_postures};
pub use sensitivity::{
    PriorCase, Sensitivity, SensitivityOptions, Spread, WORTH_CHANGING, sensitivity,
};

pub use random::{SMALL_WRIST_RAD, StartKind, random_group};
pub use space_filling::{joint_distance, smallest_distance, space_filling};

use crate::error::{Code, Error, Result};
use crate::findings::list;
use crate::model::cell::Cell;
use crate::model::observation::{PostureTerms, check_angles};
use crate::model::posture::PostureGroup;
use crate::numerics::control::{Control, Termination};
use crate::numerics::optimise::Options;
use crate::plan::index::{GroupEvaluation, Index, Indices, evaluate};
use search::Search;
use serde::Serialize;

/// Result of a selection.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Selection {
    /// The index that was minimised (maximised for O1 to O5).
    pub index: Index,
    /// Its value at the selected postures.
    pub value: f64,
    /// Its value at the initial group, moved onto the bounds; `None` where it
    /// does not exist there. A start outside the limits may well be better than
    /// any group inside them.
    pub start_value: Option<f64>,
    /// Every index of the selected postures.
    #[serde(rename = "indices", serialize_with = "indices_of")]
    #[cfg_attr(feature = "schema", schemars(with = "Indices"))]
    pub evaluation: GroupEvaluation,
    /// Selected postures, controller angles \[rad; degrees in JSON\].
    #[serde(rename = "postures_deg", with = "crate::units::degrees")]
    #[cfg_attr(feature = "schema", schemars(with = "Vec<Vec<f64>>"))]
    pub group: Vec<Vec<f64>>,
    /// Number of postures that were given and stay as they are; `value` and
    /// `indices` are those of given and selected postures together.
    pub given: usize,
    /// Why the search ended.
    pub termination: Termination,
    /// Rounds of a global search that were completed: asking for as many gives
    /// the same result again. `None` for a local one.
    pub rounds: Option<u64>,
    /// Number of local searches.
    pub starts: usize,
    /// Evaluations of index, limits and their derivatives.
    pub evaluations: u64,
    /// Iterations of the optimiser.
    pub iterations: u64,
    /// First-order optimality: ∞-norm of the projected gradient of the
    /// Lagrangian of ln(index) \[1/rad\] at the last iterate.
    pub stationarity: Option<f64>,
    /// Smallest margin to a limit of the cell \[m\], `None` without limits.
    pub smallest_margin_m: Option<f64>,
    /// The load, where it was chosen together with the postures.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub load: Option<DesignedLoad>,
}

/// Of an evaluation, a selection's JSON holds the indices.
fn indices_of<S: serde::Serializer>(
    evaluation: &GroupEvaluation,
    serializer: S,
) -> std::result::Result<S::Ok, S::Error> {
    evaluation.indices.serialize(serializer)
}

impl Selection {
    /// The selected postures as a named group.
    pub fn to_group(&self, name: &str) -> PostureGroup {
        PostureGroup::from_angles(name, self.group.iter().cloned())
    }
}

/// Selects postures from an initial group under `index`, Section III.B: the
/// index is minimised over all controller angles at once, within the bounds
/// and the limits of the cell, by a local method.
///
/// `initial` holds controller angles \[rad\]; its length is the number of
/// postures. Angles outside the bounds are moved onto them first.
///
/// # Errors
/// An empty group, a cell without what the index needs, postures that cannot
/// determine all joints, or limits that the search could not meet.
pub fn select_from<Q: AsRef<[f64]>>(
    cell: &Cell,
    index: Index,
    initial: &[Q],
    options: Options,
    control: Control<'_>,
) -> Result<Selection> {
    let setup = &cell.setup;
    let n = setup.robot.joint_count();
    let count = initial.len();
    if count == 0 {
        return Err(Error::new(
            Code::TooFewData,
            "The initial group has no postures.",
        ));
    }
    for q in initial {
        check_angles(&setup.robot, q.as_ref())?;
    }
    check_bounds(cell)?;
    let mut start: Vec<f64> = initial
        .iter()
        .flat_map(|q| q.as_ref().iter().copied())
        .collect();
    for (x, b) in start.iter_mut().zip(cell.bounds.iter().cycle()) {
        *x = x.clamp(b[0], b[1]);
    }
    let start_group: Vec<&[f64]> = start.chunks_exact(n).collect();
    let start_evaluation = evaluate(cell, "start", &start_group)?;
    let solution =
        Search::new::<Vec<f64>>(cell, index, count, &[])?.run(start, options, control)?;
    if !solution.merit.is_finite() {
        return Err(no_result(
            cell,
            index,
            &start_evaluation,
            solution.termination,
        ));
    }
    let group: Vec<Vec<f64>> = solution.x[..n * count]
        .chunks_exact(n)
        .map(<[f64]>::to_vec)
        .collect();
    let evaluation = evaluate(cell, index.as_str(), &group)?;
    let value = evaluation
        .indices
        .get(index)
        .ok_or_else(|| no_result(cell, index, &evaluation, solution.termination))?;
    Ok(Selection {
        index,
        value,
        start_value: start_evaluation.indices.get(index),
        evaluation,
        given: 0,
        termination: solution.termination,
        rounds: None,
        starts: 1,
        evaluations: solution.evaluations,
        iterations: solution.iterations,
        stationarity: solution.stationarity,
        smallest_margin_m: smallest_margin(cell, &group)?,
        load: None,
        group,
    })
}

/// Refuses bounds that no angle meets.
fn check_bounds(cell: &Cell) -> Result<()> {
    let reversed = |b: &[f64; 2]| b[0].is_nan() || b[1].is_nan() || b[0] > b[1];
    match cell.bounds.iter().position(reversed) {
        None => Ok(()),
        Some(j) => Err(Error::new(
            Code::InvalidValue,
            format!(
                "The bounds of {} are reversed.",
                cell.setup.robot.joints()[j].name
            ),
        )),
    }
}

/// Smallest margin of a group to the cell's limits \[m\], `None` without limits.
///
/// # Errors
/// As [`PostureTerms::new`].
pub fn smallest_margin<Q: AsRef<[f64]>>(cell: &Cell, postures: &[Q]) -> Result<Option<f64>> {
    let mut smallest: Option<f64> = None;
    for q in postures {
        let terms = PostureTerms::new(&cell.setup, q.as_ref(), None)?;
        if let Some(margin) = cell.limits.smallest(&cell.setup, &terms) {
            smallest = Some(smallest.map_or(margin.margin, |s| s.min(margin.margin)));
        }
    }
    Ok(smallest)
}

fn no_result(cell: &Cell, index: Index, at: &GroupEvaluation, termination: Termination) -> Error {
    if termination == Termination::Interrupted {
        return Error::new(
            Code::Interrupted,
            "Stopped before any posture group met the cell's limits.",
        );
    }
    if index.uses_observation() && !at.undetermined_joints.is_empty() {
        return Error::new(
            Code::NotIdentifiable,
            format!(
                "{} with this load cannot determine {}.",
                match at.posture_count {
                    1 => "One posture".to_string(),
                    count => format!("{count} postures"),
                },
                list(&at.undetermined_joints)
            ),
        )
        .hint(
            "add postures that differ, or measuring points, or move the load off the joint's axis",
        );
    }
    if index == Index::DropOne && at.indices.drop_one.is_none() {
        return Error::new(
            Code::NotIdentifiable,
            format!(
                "{} postures less one cannot determine every joint, so drop_one does not exist.",
                at.posture_count
            ),
        )
        .hint("give more postures, or choose expected_error");
    }
    if index.uses_dexterity() && at.k_jn.iter().any(Option::is_none) {
        return Error::new(
            Code::InvalidValue,
            "k(J_N) does not exist at some posture of the initial group: the Jacobian is singular there.",
        )
        .hint("start from other postures, for example with the wrist bent");
    }
    let limits = if cell.limits.is_empty() {
        "the joint bounds"
    } else {
        "the cell's limits"
    };
    Error::new(
        Code::InvalidValue,
        format!(
            "No group of {} postures that meets {limits} was found from this start.",
            at.posture_count
        ),
    )
    .hint("start from postures inside the limits, or relax [limits] and [bounds]")
}
