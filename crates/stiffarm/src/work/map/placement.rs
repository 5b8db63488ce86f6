//! The best place for a workpiece: where a given path under given loads bends
//! the arm least.

use super::options::{check_turns, grid};
use super::place_evaluation::{PlaceEvaluation, PlaceOptions, PlacementCandidate};
use super::result::{no_band, place_words, stopped, unknown_limits};
use super::search::{Part, Search, WorkpiecePlace};
use super::status::Status;
use crate::error::{Code, Error, Result};
use crate::estimate::compliance::IdentifiedCompliance;
use crate::findings::{Finding, codes, length};
use crate::model::cell::Cell;
use crate::model::implausible;
use crate::model::load::Wrench;
use crate::model::path::PathPoint;
use crate::numerics::control::Control;
use crate::numerics::jobs::as_far_as;
use crate::numerics::order::sort_by_number;
use crate::work::predict::LoadedArm;
use serde::{Deserialize, Serialize};

/// Best candidates that are tried on the whole path before giving up.
const TRIED: usize = 20;

/// Result of a search for the best place.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Placement {
    /// Points of the path.
    pub point_count: usize,
    /// Points that the search looked at.
    pub searched_points: usize,
    /// True when the user stopped the search: fewer places were tried, and given and
    /// best place may be those of the searched points alone.
    pub interrupted: bool,
    /// The place that the cell gives.
    pub given: PlaceEvaluation,
    /// The best place; `None` where the arm can go along the path nowhere.
    pub best: Option<PlaceEvaluation>,
    /// RMS of the deflections at the given place over that at the best one; `None`
    /// where one of them does not exist or nothing bends.
    pub gain: Option<f64>,
    /// Joint stiffness that the search was made with \[N·m/rad\], one per spring; `null` for one
    /// without a positive stiffness.
    pub stiffness_nm_per_rad: Vec<Option<f64>>,
    /// Name of the measuring point that stands for the tip; `null` where the cell gives the tip.
    pub tip_point: Option<String>,
    /// What to know about it, in sentences.
    pub findings: Vec<Finding>,
    /// Every place that was tried: by round, yaw, x, y, z.
    pub candidates: Vec<PlacementCandidate>,
}

/// Looks for the place of the workpiece where the path `points` (as it lies in
/// [`Work::workpiece`](crate::model::work::Work::workpiece), base frame) bends the arm
/// least by the RMS of its deflections.
///
/// At each place one branch of postures is followed along the path, from each
/// posture of the first point; the cell's bounds and limits hold at every
/// point. Loads in tool, workpiece and path axes turn with the workpiece, those in
/// base axes stay as they are. The search looks at no more than 200 points, evenly
/// along the path, by the linear model; best and given place are then those of the
/// whole path by the exact equilibrium.
///
/// # Errors
/// An empty path; a grid that is no grid; an unknown that is not determined and gives way; a load
/// in path axes where the path does not move; a load that buckles the arm. Stopped,
/// it gives the best of the places that were tried.
pub fn place(
    cell: &Cell,
    predictor: &IdentifiedCompliance,
    points: &[PathPoint],
    options: &PlaceOptions,
    control: Control<'_>,
) -> Result<Placement> {
    if points.is_empty() {
        return Err(Error::new(Code::TooFewData, "The path has no points."));
    }
    if options.yaws.is_empty() || options.yaws.iter().any(|yaw| !yaw.is_finite()) {
        return Err(Error::invalid("The turns of the workpiece must be finite numbers, at least one.").key("yaw_deg"));
    }
    check_turns(options.free_turns)?;
    let arm = LoadedArm::new(cell, predictor)?;
    let search = Search::new(cell, &arm, points, options)?;
    let mut candidates: Vec<PlacementCandidate> = Vec::new();
    let mut region =
        Region { lower: options.lower, upper: options.upper, steps: options.steps, yaws: options.yaws.clone() };
    for round in 0..=options.refinements {
        let places = region.places()?;
        let round_candidates =
            as_far_as(&places, "placing", control, |(_, place)| search.candidate(round, place, control))?;
        candidates.extend(round_candidates.into_iter().flatten());
        if control.stopped() {
            break;
        }
        let Some(best) = ranked(&candidates).first().copied() else {
            break;
        };
        match region.about(&candidates[best], options) {
            Some(finer) => region = finer,
            None => break,
        }
    }
    let (part, (given_place, best)) = match given_and_best(cell, &search, &candidates, Part::Whole, control) {
        Err(error) if error.code() == Code::Interrupted => {
            let part = Part::Searched;
            let unstopped = Control::default();
            let both = given_and_best(cell, &search, &candidates, part, unstopped)?;
            (part, both)
        }
        both => (Part::Whole, both?),
    };
    let size = |placed: Option<&PlaceEvaluation>| placed.and_then(|p| p.deflection_rms_m);
    let gain = size(Some(&given_place))
        .zip(size(best.as_ref()))
        .filter(|(_, best)| *best > 0.0)
        .map(|(given_rms, best)| given_rms / best);
    let mut out = Placement {
        point_count: points.len(),
        searched_points: search.searched.len(),
        interrupted: part == Part::Searched || control.stopped(),
        given: given_place,
        best,
        gain,
        stiffness_nm_per_rad: predictor.spring_stiffness(cell),
        tip_point: None,
        findings: Vec::new(),
        candidates,
    };
    out.findings = findings(cell, predictor, &out);
    out.findings.splice(0..0, predictor.doubts.iter().cloned());
    out.findings.extend(implausible::process(cell));
    out.tip_point = cell.work.tip_point(&cell.setup.tool);
    out.findings.extend(cell.work.tip_assumed(&cell.setup.tool));
    let point_loads = points.iter().filter_map(|point| {
        let load = point.load?;
        let wrench = Wrench { force: load.force, moment: load.moment };
        Some((&*point.name, wrench))
    });
    let point_loads: Vec<(&str, Wrench)> = point_loads.collect();
    let loads = point_loads.iter().map(|(name, wrench)| (*name, wrench));
    out.findings.extend(implausible::load(arm.robot(), loads));
    Ok(out)
}

/// The given place, and the best one that works, by `part` of the path.
fn given_and_best(
    cell: &Cell,
    search: &Search<'_>,
    candidates: &[PlacementCandidate],
    part: Part,
    control: Control<'_>,
) -> Result<(PlaceEvaluation, Option<PlaceEvaluation>)> {
    let position = cell.work.workpiece.translation.vector.into();
    let given_place = search.placed(&WorkpiecePlace { position, yaw: 0.0 }, part, control)?;
    // A path that thinned goes along may not do so whole.
    for i in ranked(candidates).into_iter().take(TRIED) {
        let candidate = &candidates[i];
        let place = WorkpiecePlace { position: candidate.position_m, yaw: candidate.yaw };
        let placed = search.placed(&place, part, control)?;
        if placed.status == Status::Reachable {
            return Ok((given_place, Some(placed)));
        }
    }
    Ok((given_place, None))
}

/// A grid of places.
struct Region {
    lower: [f64; 3],
    upper: [f64; 3],
    steps: [usize; 3],
    yaws: Vec<f64>,
}

impl Region {
    fn places(&self) -> Result<Vec<WorkpiecePlace>> {
        let [x, y, z] = grid(self.lower, self.upper, self.steps)?;
        let mut places = Vec::new();
        for yaw in &self.yaws {
            for x in &x {
                for y in &y {
                    places.extend(z.iter().map(|z| WorkpiecePlace { position: [*x, *y, *z], yaw: *yaw }));
                }
            }
        }
        Ok(places)
    }

    /// A finer grid about `best`: to the neighbours of this one, within the box.
    fn about(&self, best: &PlacementCandidate, options: &PlaceOptions) -> Option<Region> {
        let mut finer = Region { lower: best.position_m, upper: best.position_m, steps: [1; 3], yaws: vec![best.yaw] };
        for axis in 0..3 {
            let count = self.steps[axis];
            if count < 2 {
                continue;
            }
            let spacing = (self.upper[axis] - self.lower[axis]) / (count - 1) as f64;
            let at = best.position_m[axis];
            finer.lower[axis] = (at - spacing).max(options.lower[axis]);
            finer.upper[axis] = (at + spacing).min(options.upper[axis]);
            finer.steps[axis] = count.max(3);
        }
        (finer.steps != [1; 3]).then_some(finer)
    }
}

/// Candidates that work, the best first; of equals the earlier.
fn ranked(candidates: &[PlacementCandidate]) -> Vec<usize> {
    let size = |i: &usize| candidates[*i].deflection_rms_m;
    let mut order: Vec<usize> = (0..candidates.len()).filter(|i| size(i).is_some()).collect();
    sort_by_number(&mut order, |i| size(i).unwrap_or(f64::INFINITY));
    order
}

fn findings(cell: &Cell, predictor: &IdentifiedCompliance, result: &Placement) -> Vec<Finding> {
    let mut out = Vec::new();
    if result.interrupted {
        out.push(stopped(format!(
            "Stopped: {} places were tried, spread over the grid; a better one may be among the others. Deflections \
             are those of the {} searched points of the path.",
            result.candidates.len(),
            result.searched_points
        )));
    }
    let given_place = &result.given;
    if let (Some(reason), Some(point)) = (&given_place.reason, &given_place.point) {
        out.push(Finding::caution(
            "given-place-fails",
            "workpiece",
            format!("At the given place the arm cannot go along the path: at point {point}, {reason}."),
        ));
    }
    match &result.best {
        None if result.candidates.is_empty() => {}
        None => out.push(nowhere(result)),
        Some(best) => {
            let size = length(best.deflection_rms_m.unwrap_or(0.0));
            let place = place_words(best.position_m);
            let sentence = match (result.gain, given_place.deflection_rms_m) {
                (Some(gain), Some(from)) if gain > 1.0 => format!(
                    "At {place} the path bends the arm by {size} (RMS), {gain:.2} times less than at the given place \
                     ({}).",
                    length(from)
                ),
                (Some(_), Some(from)) => format!(
                    "No place of the grid is better than the given one ({}); its best, {place}, bends by {size} (RMS).",
                    length(from)
                ),
                _ => format!("At {place} the path bends the arm by {size} (RMS)."),
            };
            out.push(Finding::note("best-place", "workpiece", sentence));
        }
    }
    if predictor.spread.is_none() && predictor.common.is_empty() {
        out.push(no_band());
    }
    if cell.setup.robot.limits_are_unknown() {
        out.push(unknown_limits());
    }
    out
}

/// Says which place gets farthest along.
fn nowhere(result: &Placement) -> Finding {
    let why = result
        .candidates
        .iter()
        .find(|c| c.status == Status::Forbidden)
        .or(result.candidates.first())
        .and_then(|c| Some((place_words(c.position_m), c.point.as_ref()?, c.reason.as_ref()?)))
        .map_or_else(String::new, |(place, point, reason)| format!(" At {place}, for one, point {point}: {reason}."));
    Finding::serious(
        codes::NOWHERE,
        "workpiece",
        format!("At no place of the grid can the arm go along the path.{why}"),
    )
}
