//! What a selection gives, and why one may give nothing.

use super::load_design::DesignedLoad;
use crate::error::{Code, Error, Result};
use crate::findings::list;
use crate::model::cell::Cell;
use crate::model::posture::PostureGroup;
use crate::numerics::control::Termination;
use crate::plan::feasibility::PostureLimits;
use crate::plan::index::{GroupEvaluation, Index, Indices, evaluate};
use serde::{Deserialize, Deserializer, Serialize};

/// Result of a selection.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
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
    /// Every index of the selected postures. A selection that was read from JSON has the indices alone.
    #[serde(rename = "indices", serialize_with = "indices_of", deserialize_with = "indices_alone")]
    #[cfg_attr(feature = "schema", schemars(with = "crate::plan::index::Indices"))]
    pub evaluation: GroupEvaluation,
    /// Selected postures, controller angles \[rad\].
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
    /// The rounds of a global search that brought something better, in their order; empty for a local one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub improvements: Vec<RoundReport>,
    /// Number of local searches.
    pub starts: usize,
    /// Evaluations of index, limits and their derivatives.
    pub evaluations: u64,
    /// Iterations of the optimiser.
    pub iterations: u64,
    /// First-order optimality: ∞-norm of the projected gradient of the
    /// Lagrangian of ln(index) \[1/rad\] at the last iterate.
    pub stationarity: Option<f64>,
    /// Smallest margin to a limit of the cell that is a length \[m\], `None` without such limits.
    pub smallest_margin_m: Option<f64>,
    /// How near each selected posture comes to the cell's limits; empty without limits.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub limits: Vec<PostureLimits>,
    /// The load, where it was chosen together with the postures.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub load: Option<DesignedLoad>,
}

/// How a search stands after a round.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RoundReport {
    /// Rounds completed.
    pub rounds: u64,
    /// Evaluations of the index with its gradient so far.
    pub evaluations: u64,
    /// Best value of the index so far, before the final polish.
    pub value: Option<f64>,
}

/// Of an evaluation, a selection's JSON holds the indices.
fn indices_of<S: serde::Serializer>(
    evaluation: &GroupEvaluation,
    serializer: S,
) -> std::result::Result<S::Ok, S::Error> {
    evaluation.indices.serialize(serializer)
}

/// The evaluation behind indices that were read: nothing but them.
fn indices_alone<'de, D: Deserializer<'de>>(deserializer: D) -> std::result::Result<GroupEvaluation, D::Error> {
    Ok(GroupEvaluation { indices: Indices::deserialize(deserializer)?, ..GroupEvaluation::default() })
}

impl Selection {
    /// The selected postures as a named group.
    pub fn to_group(&self, name: &str) -> PostureGroup {
        PostureGroup::from_angles(name, self.group.iter().cloned())
    }

    /// The same search with other angles of the selected postures (rad): in another order, rounded, or
    /// equivalent ones. Index, indices and margins are theirs; `cell` has the load that was chosen,
    /// `fixed_postures` are the postures that were given.
    ///
    /// # Errors
    /// Angles that do not fit the robot, or at which the index does not exist.
    pub fn with_group<Q: AsRef<[f64]>>(self, cell: &Cell, fixed_postures: &[Q], group: Vec<Vec<f64>>) -> Result<Self> {
        let before = fixed_postures.iter().map(AsRef::as_ref);
        let all: Vec<&[f64]> = before.chain(group.iter().map(Vec::as_slice)).collect();
        let evaluation = evaluate(cell, self.index.as_str(), &all)?;
        let value = evaluation.indices.get(self.index);
        let value = value.ok_or_else(|| no_result(cell, self.index, &evaluation, self.termination))?;
        let limits = limits_of(cell, &group)?;
        Ok(Selection { value, evaluation, smallest_margin_m: smallest_length(&limits), limits, group, ..self })
    }
}

/// Angles of one posture within this of another's, in every joint, make it the same to an
/// observation matrix \[rad\]: half a degree.
const SAME_POSTURE: f64 = 0.5_f64.to_radians();

/// Groups of positions of postures (controller angles, rad) that are the same within half a
/// degree in every joint, each group in order; empty where all differ.
///
/// A plan that is best against noise alone may hold a posture twice: its readings are
/// worth more than those of any other posture. Where more is wrong than noise, a repeat
/// shows nothing new.
///
/// ```
/// use stiffarm::plan::select::repeats;
///
/// let group = [[0.1, 0.2], [1.0, 0.2], [0.1, 0.2005]];
/// assert_eq!(repeats(&group), [[0, 2]]);
/// ```
pub fn repeats<Q: AsRef<[f64]>>(group: &[Q]) -> Vec<Vec<usize>> {
    let same = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() <= SAME_POSTURE);
    let mut out: Vec<Vec<usize>> = Vec::new();
    for (p, q) in group.iter().enumerate() {
        let alike = out.iter_mut().find(|alike| same(group[alike[0]].as_ref(), q.as_ref()));
        match alike {
            Some(alike) => alike.push(p),
            None => out.push(vec![p]),
        }
    }
    out.retain(|same| same.len() > 1);
    out
}

/// How many of `count` postures differ, of which these groups are the same ([`repeats`]).
pub fn different<P>(count: usize, repeats: &[Vec<P>]) -> usize {
    let again = repeats.iter().map(|same| same.len().saturating_sub(1));
    count - again.sum::<usize>()
}

/// Refuses bounds that no angle meets.
pub(super) fn check_bounds(cell: &Cell) -> Result<()> {
    let reversed = |b: &[f64; 2]| b[0].is_nan() || b[1].is_nan() || b[0] > b[1];
    match cell.bounds.iter().position(reversed) {
        None => Ok(()),
        Some(j) => Err(Error::invalid(format!("The bounds of {} are reversed.", cell.setup.robot.joints()[j].name))),
    }
}

/// How near each posture (controller angles, rad) comes to the cell's limits; empty without limits.
///
/// # Errors
/// As [`PostureLimits::new`].
pub fn limits_of<Q: AsRef<[f64]>>(cell: &Cell, group: &[Q]) -> Result<Vec<PostureLimits>> {
    if cell.is_unlimited() {
        return Ok(Vec::new());
    }
    group.iter().map(|q| PostureLimits::new(cell, q.as_ref())).collect()
}

/// The smallest margin of a length among them \[m\].
pub(super) fn smallest_length(limits: &[PostureLimits]) -> Option<f64> {
    limits.iter().filter_map(PostureLimits::smallest_m).reduce(f64::min)
}

/// Smallest margin of a group to the cell's limits \[m; rad for angles, share of the limit for torques\],
/// `None` without limits; not negative exactly where all are met.
///
/// ```
/// # fn main() -> stiffarm::Result<()> {
/// use stiffarm_files::builtin;
/// use stiffarm::plan::select::{StartKind, random_group, smallest_margin};
///
/// let cell = builtin::cell("comau")?;
/// let group = random_group(&cell, StartKind::Uniform, 3, 1, 0)?;
/// assert!(smallest_margin(&cell, &group)? >= Some(0.0));
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// Bounds or angles that do not fit the robot; a rope without a direction.
pub fn smallest_margin<Q: AsRef<[f64]>>(cell: &Cell, postures: &[Q]) -> Result<Option<f64>> {
    let mut smallest: Option<f64> = None;
    let mut margins = cell.posture_margins()?;
    for q in postures {
        if let Some(margin) = margins.smallest(q.as_ref())? {
            smallest = Some(smallest.map_or(margin.margin, |s| s.min(margin.margin)));
        }
    }
    Ok(smallest)
}

/// Why a search ended without a group.
pub(super) fn no_result(cell: &Cell, index: Index, at: &GroupEvaluation, termination: Termination) -> Error {
    if termination == Termination::Interrupted {
        return Error::new(Code::Interrupted, "Stopped before any posture group met the cell's limits.");
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
        .hint("add postures that differ, or measuring points, or move the load off the joint's axis");
    }
    if index == Index::DropOne && at.indices.drop_one.is_none() {
        return Error::new(
            Code::NotIdentifiable,
            format!("{} postures less one cannot determine every joint, so drop_one does not exist.", at.posture_count),
        )
        .hint("give more postures, or choose expected_error");
    }
    if index.uses_dexterity() && at.k_jn.iter().any(Option::is_none) {
        let message = "k(J_N) does not exist at some posture of the initial group: the Jacobian is singular there.";
        return Error::invalid(message).hint("start from other postures, for example with the wrist bent");
    }
    let limits = if cell.is_unlimited() { "the joint bounds" } else { "the cell's limits" };
    Error::invalid(format!("No group of {} postures that meets {limits} was found from this start.", at.posture_count))
        .hint("start from postures inside the limits, or relax [limits] and [bounds]")
}

/// Why `postures` that are all unlike were not found.
pub(super) fn too_near(postures: usize) -> Error {
    Error::invalid(format!(
        "No group of {postures} postures inside bounds and limits was found of which no two are within 15° of each \
         other in every joint."
    ))
    .hint("ask for fewer, widen [bounds] or [limits], or let the plan measure postures again (--repeats)")
}
