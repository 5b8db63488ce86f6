//! The best place for a workpiece: where a given path under given loads bends
//! the arm least.

use super::follow::{Stopped, follow};
use super::node::Status;
use super::options::{check_turns, grid, turns};
use super::prepared::Prepared;
use super::reach::{Reach, Refusal, is_better};
use super::result::{no_band, place_words, unknown_limits};
use crate::cell::Cell;
use crate::error::{Code, Error, Result};
use crate::findings::{Finding, Severity, length};
use crate::identify::rms;
use crate::jobs::in_order_watched;
use crate::load::Wrench;
use crate::optimise::Control;
use crate::path::{PathPoint, Target};
use crate::predict::{ArmAtWork, Predictor};
use crate::units::{deg_to_rad, rad_to_deg, rad_to_shortest_deg, roll_pitch_yaw};
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

/// Points of a path that a search looks at.
const SEARCHED_POINTS: usize = 200;
/// Best candidates that are tried on the whole path before giving up.
const TRIED: usize = 20;

/// Where the workpiece may be.
#[derive(Debug, Clone, PartialEq)]
pub struct PlaceOptions {
    /// Lower corner of the box for the workpiece's origin, base frame \[m\].
    pub lower: [f64; 3],
    /// Upper corner \[m\].
    pub upper: [f64; 3],
    /// Places along x, y, z in the first round; 1 takes the middle.
    pub steps: [usize; 3],
    /// Turns of the workpiece about the base's z that are tried, added to its own
    /// orientation \[rad\]; in finer rounds the best alone.
    pub yaws: Vec<f64>,
    /// Turns about the tool axis that are tried where the path leaves it free.
    pub free_turns: usize,
    /// Finer grids, each about the best place so far.
    pub refinements: usize,
}

impl Default for PlaceOptions {
    fn default() -> Self {
        PlaceOptions {
            lower: [0.0; 3],
            upper: [0.0; 3],
            steps: [1; 3],
            yaws: vec![0.0],
            free_turns: 12,
            refinements: 2,
        }
    }
}

/// One place that was tried.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PlacementCandidate {
    /// Round of the search: 0 is the first grid.
    pub round: usize,
    /// Origin of the workpiece, base frame \[m\].
    pub position_m: [f64; 3],
    /// Turn about the base's z, added to the given orientation \[deg\].
    pub yaw_deg: f64,
    /// Whether the arm can go along the path there.
    pub status: Status,
    /// RMS of the deflections along the path, linear model, thinned path \[m\].
    pub deflection_rms_m: Option<f64>,
    /// Largest deflection, the same way \[m\].
    pub deflection_max_m: Option<f64>,
    /// Why the arm cannot go along.
    pub reason: Option<String>,
    /// Point of the path where that is.
    pub point: Option<String>,
}

/// A place of the workpiece with the whole path there.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Placed {
    /// Origin of the workpiece, base frame \[m\].
    pub position_m: [f64; 3],
    /// Its orientation: turns about x, then y, then z of the base \[deg\].
    pub rpy_deg: [f64; 3],
    /// Turn about the base's z, added to the given orientation \[deg\].
    pub yaw_deg: f64,
    /// Turn about the tool axis, where the path leaves it free \[deg\].
    pub turn_deg: Option<f64>,
    /// Whether the arm can go along the path.
    pub status: Status,
    /// Why not.
    pub reason: Option<String>,
    /// Point of the path where that is.
    pub point: Option<String>,
    /// RMS of the deflections along the whole path, exact equilibrium \[m\].
    pub deflection_rms_m: Option<f64>,
    /// Largest deflection \[m\].
    pub deflection_max_m: Option<f64>,
    /// Point of the largest deflection.
    pub deflection_max_point: Option<String>,
    /// Posture at the first point, controller angles \[deg\].
    pub start_deg: Option<Vec<f64>>,
}

/// Result of a search for the best place.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Placement {
    /// Points of the path.
    pub point_count: usize,
    /// Points that the search looked at.
    pub searched_points: usize,
    /// The place that the cell gives.
    pub given: Placed,
    /// The best place; `None` where the arm can go along the path nowhere.
    pub best: Option<Placed>,
    /// RMS of the deflections at the given place over that at the best one; `None`
    /// where one of them does not exist or nothing bends.
    pub gain: Option<f64>,
    /// What to know about it, in sentences.
    pub findings: Vec<Finding>,
    /// Every place that was tried: by round, yaw, x, y, z.
    pub candidates: Vec<PlacementCandidate>,
}

/// Looks for the place of the workpiece where the path `points` (as it lies in
/// [`Work::workpiece`](crate::work::Work::workpiece), base frame) bends the arm
/// least by the RMS of its deflections.
///
/// At each place one branch of postures is followed along the path, from each
/// posture of the first point; the machine's limits and the cell's hold at every
/// point. Loads in tool, workpiece and path axes turn with the workpiece, those in
/// base axes stay as they are. The search looks at no more than 200 points, evenly
/// along the path, by the linear model; best and given place are then those of the
/// whole path by the exact equilibrium.
///
/// # Errors
/// An empty path; a grid that is no grid; an unknown without positive value; a load
/// in path axes where the path does not move; a load that buckles the arm;
/// interrupted.
pub fn place(
    cell: &Cell,
    predictor: &Predictor,
    points: &[PathPoint],
    options: &PlaceOptions,
    control: Control<'_>,
) -> Result<Placement> {
    if points.is_empty() {
        return Err(Error::new(Code::TooFewData, "The path has no points."));
    }
    if options.yaws.is_empty() || options.yaws.iter().any(|yaw| !yaw.is_finite()) {
        return Err(Error::new(
            Code::InvalidValue,
            "The turns of the workpiece must be finite numbers, at least one.",
        )
        .key("yaws"));
    }
    check_turns(options.free_turns)?;
    let arm = ArmAtWork::new(cell, predictor)?;
    let search = Search::new(cell, &arm, points, options)?;
    let mut candidates: Vec<PlacementCandidate> = Vec::new();
    let mut region = Region {
        lower: options.lower,
        upper: options.upper,
        steps: options.steps,
        yaws: options.yaws.clone(),
    };
    for round in 0..=options.refinements {
        let places = region.places()?;
        let found = in_order_watched(&places, "placing", control, |(_, place)| {
            search.candidate(round, place)
        })?;
        candidates.extend(found);
        let Some(best) = ranked(&candidates).first().copied() else {
            break;
        };
        match region.about(&candidates[best], options) {
            Some(finer) => region = finer,
            None => break,
        }
    }
    let given = search.whole(&Place {
        position: cell.work.workpiece.translation.vector.into(),
        yaw: 0.0,
    })?;
    let mut best = None;
    // A path that thinned goes along may not do so whole.
    for i in ranked(&candidates).into_iter().take(TRIED) {
        let candidate = &candidates[i];
        let placed = search.whole(&Place {
            position: candidate.position_m,
            yaw: deg_to_rad(candidate.yaw_deg),
        })?;
        if placed.status == Status::Reachable {
            best = Some(placed);
            break;
        }
    }
    let size = |placed: Option<&Placed>| placed.and_then(|p| p.deflection_rms_m);
    let gain = size(Some(&given))
        .zip(size(best.as_ref()))
        .filter(|(_, best)| *best > 0.0)
        .map(|(given, best)| given / best);
    let mut out = Placement {
        point_count: points.len(),
        searched_points: search.kept.len(),
        given,
        best,
        gain,
        findings: Vec::new(),
        candidates,
    };
    out.findings = findings(cell, predictor, &out);
    Ok(out)
}

/// A place of the workpiece.
#[derive(Debug, Clone, Copy)]
struct Place {
    position: [f64; 3],
    yaw: f64,
}

/// A grid of places.
struct Region {
    lower: [f64; 3],
    upper: [f64; 3],
    steps: [usize; 3],
    yaws: Vec<f64>,
}

impl Region {
    fn places(&self) -> Result<Vec<Place>> {
        let [x, y, z] = grid(self.lower, self.upper, self.steps)?;
        let mut places = Vec::new();
        for yaw in &self.yaws {
            for x in &x {
                for y in &y {
                    places.extend(z.iter().map(|z| Place {
                        position: [*x, *y, *z],
                        yaw: *yaw,
                    }));
                }
            }
        }
        Ok(places)
    }

    /// A finer grid about `best`: to the neighbours of this one, within the box.
    fn about(&self, best: &PlacementCandidate, options: &PlaceOptions) -> Option<Region> {
        let mut finer = Region {
            lower: best.position_m,
            upper: best.position_m,
            steps: [1; 3],
            yaws: vec![deg_to_rad(best.yaw_deg)],
        };
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
    let mut order: Vec<usize> = (0..candidates.len())
        .filter(|i| size(i).is_some())
        .collect();
    order.sort_by(|a, b| {
        let of = |i| size(i).unwrap_or(f64::INFINITY);
        of(a).total_cmp(&of(b))
    });
    order
}

/// What every place shares.
struct Search<'a> {
    reach: Reach<'a>,
    given: &'a Isometry3<f64>,
    points: &'a [PathPoint],
    /// The path for each turn about the tool axis \[rad\], whole and thinned.
    turned: Vec<(f64, Prepared, Prepared)>,
    kept: Vec<usize>,
    has_free_turn: bool,
}

/// What goes along the path at a place.
struct Along {
    turn: f64,
    path: Vec<Vec<f64>>,
    wrenches: Vec<Wrench>,
    sizes: Vec<f64>,
}

impl<'a> Search<'a> {
    fn new(
        cell: &'a Cell,
        arm: &'a ArmAtWork,
        points: &'a [PathPoint],
        options: &PlaceOptions,
    ) -> Result<Self> {
        // A turn at the first point is carried along to the others.
        let has_free_turn = matches!(points[0].target, Target::Axis { .. });
        let count = has_free_turn.then_some(options.free_turns);
        let mut kept = Vec::new();
        let mut turned = Vec::new();
        for turn in turns(count) {
            let whole = Prepared::new(cell, arm, points, turn)?;
            if kept.is_empty() {
                kept = whole.evenly(SEARCHED_POINTS);
            }
            let thinned = whole.thinned(&kept);
            turned.push((turn, whole, thinned));
        }
        Ok(Search {
            reach: Reach::new(cell, arm),
            given: &cell.work.workpiece,
            points,
            turned,
            kept,
            has_free_turn,
        })
    }

    /// Pose of the workpiece at `place`.
    fn workpiece(&self, place: &Place) -> Isometry3<f64> {
        let yaw = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), place.yaw);
        Isometry3::from_parts(
            Translation3::from(place.position),
            yaw * self.given.rotation,
        )
    }

    /// The branch that bends least at `place`, or what stops the one that gets
    /// farthest.
    fn along(
        &self,
        place: &Place,
        path: fn(&(f64, Prepared, Prepared)) -> &Prepared,
    ) -> Result<std::result::Result<Along, Stopped>> {
        let workpiece = self.workpiece(place);
        let mut best: Option<((f64, f64), Along)> = None;
        let mut farthest: Option<Stopped> = None;
        let mut stop = |stopped: Stopped| {
            let farther = |f: &Stopped| stopped.at > f.at;
            if farthest.as_ref().is_none_or(farther) {
                farthest = Some(stopped);
            }
        };
        for entry in &self.turned {
            let (poses, wrenches) = path(entry).at(&workpiece);
            let starts = match self.reach.postures(&poses[0])? {
                Ok(starts) => starts,
                Err(refusal) => {
                    stop(Stopped { at: 0, refusal });
                    continue;
                }
            };
            for start in starts {
                let path = match follow(&self.reach, &poses, &start)? {
                    Ok(path) => path,
                    Err(stopped) => {
                        stop(stopped);
                        continue;
                    }
                };
                let sizes = self.linear(&path, &wrenches)?;
                let size = rms(&sizes);
                let strains = path.iter().map(|q| self.reach.strain(q));
                let strain = strains.fold(0.0, f64::max);
                if best
                    .as_ref()
                    .is_none_or(|(than, _)| is_better(size, strain, *than))
                {
                    let along = Along {
                        turn: entry.0,
                        path,
                        wrenches: wrenches.clone(),
                        sizes,
                    };
                    best = Some(((size, strain), along));
                }
            }
        }
        Ok(match (best, farthest) {
            (Some((_, along)), _) => Ok(along),
            (None, Some(stopped)) => Err(stopped),
            // A pose has postures or a refusal.
            (None, None) => Err(Stopped {
                at: 0,
                refusal: Refusal::discontinuous(),
            }),
        })
    }

    /// Deflections by the linear model \[m\].
    fn linear(&self, path: &[Vec<f64>], wrenches: &[Wrench]) -> Result<Vec<f64>> {
        let arm = self.reach.arm;
        let pairs = path.iter().zip(wrenches);
        pairs
            .map(|(q, wrench)| {
                let terms = arm.terms(q, wrench)?;
                Ok(arm.linear(&terms).fixed_rows::<3>(0).norm())
            })
            .collect()
    }

    /// The thinned path at `place`.
    fn candidate(&self, round: usize, place: &Place) -> Result<PlacementCandidate> {
        let along = self.along(place, |(_, _, thinned)| thinned)?;
        let mut out = PlacementCandidate {
            round,
            position_m: place.position,
            yaw_deg: rad_to_shortest_deg(place.yaw),
            status: Status::Reachable,
            deflection_rms_m: None,
            deflection_max_m: None,
            reason: None,
            point: None,
        };
        match along {
            Ok(along) => {
                out.deflection_rms_m = Some(rms(&along.sizes));
                out.deflection_max_m = Some(along.sizes.iter().copied().fold(0.0, f64::max));
            }
            Err(stopped) => {
                out.status = stopped.refusal.status;
                out.reason = Some(stopped.refusal.reason);
                out.point = Some(self.points[self.kept[stopped.at]].name.clone());
            }
        }
        Ok(out)
    }

    /// The whole path at `place`, by the exact equilibrium.
    fn whole(&self, place: &Place) -> Result<Placed> {
        let workpiece = self.workpiece(place);
        let along = self.along(place, |(_, whole, _)| whole)?;
        let mut out = Placed {
            position_m: place.position,
            rpy_deg: roll_pitch_yaw(&workpiece.rotation).map(rad_to_shortest_deg),
            yaw_deg: rad_to_shortest_deg(place.yaw),
            turn_deg: None,
            status: Status::Reachable,
            reason: None,
            point: None,
            deflection_rms_m: None,
            deflection_max_m: None,
            deflection_max_point: None,
            start_deg: None,
        };
        match along {
            Ok(along) => {
                let mut sizes = Vec::with_capacity(along.path.len());
                for (q, wrench) in along.path.iter().zip(&along.wrenches) {
                    let bent = self.reach.arm.bend(q, wrench)?;
                    sizes.push(bent.displacement.fixed_rows::<3>(0).norm());
                }
                let pairs = sizes.iter().zip(self.points);
                let largest = pairs.reduce(|a, b| if b.0 > a.0 { b } else { a });
                out.turn_deg = self.has_free_turn.then(|| rad_to_deg(along.turn));
                out.deflection_rms_m = Some(rms(&sizes));
                out.deflection_max_m = largest.map(|(size, _)| *size);
                out.deflection_max_point = largest.map(|(_, point)| point.name.clone());
                out.start_deg = along
                    .path
                    .first()
                    .map(|q| q.iter().map(|q| rad_to_shortest_deg(*q)).collect());
            }
            Err(stopped) => {
                out.status = stopped.refusal.status;
                out.reason = Some(stopped.refusal.reason);
                out.point = Some(self.points[stopped.at].name.clone());
            }
        }
        Ok(out)
    }
}

fn findings(cell: &Cell, predictor: &Predictor, result: &Placement) -> Vec<Finding> {
    let mut out = Vec::new();
    let given = &result.given;
    if let (Some(reason), Some(point)) = (&given.reason, &given.point) {
        out.push(Finding::new(
            "given-place-fails",
            Severity::Caution,
            "workpiece",
            format!(
                "At the given place the arm cannot go along the path: at point {point}, {reason}."
            ),
        ));
    }
    match &result.best {
        None => out.push(nowhere(result)),
        Some(best) => {
            let size = length(best.deflection_rms_m.unwrap_or(0.0));
            let place = place_words(best.position_m);
            let sentence = match (result.gain, given.deflection_rms_m) {
                (Some(gain), Some(from)) if gain > 1.0 => format!(
                    "At {place} the path bends the arm by {size} (RMS), {gain:.2} times less than at the given place ({}).",
                    length(from)
                ),
                (Some(_), Some(from)) => format!(
                    "No place of the grid is better than the given one ({}); its best, {place}, bends by {size} (RMS).",
                    length(from)
                ),
                _ => format!("At {place} the path bends the arm by {size} (RMS)."),
            };
            out.push(Finding::new(
                "best-place",
                Severity::Note,
                "workpiece",
                sentence,
            ));
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
        .and_then(|c| {
            Some((
                place_words(c.position_m),
                c.point.as_ref()?,
                c.reason.as_ref()?,
            ))
        })
        .map_or_else(String::new, |(place, point, reason)| {
            format!(" At {place}, for one, point {point}: {reason}.")
        });
    Finding::new(
        "nowhere",
        Severity::Serious,
        "workpiece",
        format!("At no place of the grid can the arm go along the path.{why}"),
    )
}
