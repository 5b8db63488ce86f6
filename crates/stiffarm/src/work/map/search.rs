//! The path at one place of the workpiece: its best branch, thinned and whole.

use super::follow::{Stopped, follow};
use super::options::turns;
use super::place_evaluation::{PlaceEvaluation, PlaceOptions, PlacedPoint, PlacementCandidate};
use super::prepared::Prepared;
use super::reach::{Reach, Refusal, is_better};
use super::status::Status;
use crate::error::Result;
use crate::estimate::identify::rms;
use crate::model::cell::Cell;
use crate::model::load::Wrench;
use crate::model::path::{PathPoint, PathTarget};
use crate::numerics::control::Control;
use crate::units::roll_pitch_yaw;
use crate::work::predict::LoadedArm;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

/// Points of a path that a search looks at.
const SEARCHED_POINTS: usize = 200;

/// A place of the workpiece.
#[derive(Debug, Clone, Copy)]
pub(super) struct WorkpiecePlace {
    pub position: [f64; 3],
    pub yaw: f64,
}

/// How much of the path is looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Part {
    /// The points that the search looks at.
    Searched,
    /// All of it.
    Whole,
}

/// What every place shares.
pub(super) struct Search<'a> {
    reach: Reach<'a>,
    cell_workpiece: &'a Isometry3<f64>,
    points: &'a [PathPoint],
    /// The path for each turn about the tool axis \[rad\], whole and thinned.
    turned: Vec<(f64, Prepared, Prepared)>,
    pub searched: Vec<usize>,
    has_free_turn: bool,
}

/// What goes along the path at a place.
struct PathAtPlace {
    turn: f64,
    path: Vec<Vec<f64>>,
    wrenches: Vec<Wrench>,
    sizes: Vec<f64>,
}

impl<'a> Search<'a> {
    pub(super) fn new(
        cell: &'a Cell,
        arm: &'a LoadedArm,
        points: &'a [PathPoint],
        options: &PlaceOptions,
    ) -> Result<Self> {
        // A turn at the first point is carried along to the others.
        let has_free_turn = matches!(points[0].target, PathTarget::Axis { .. });
        let count = has_free_turn.then_some(options.free_turns);
        let mut searched = Vec::new();
        let mut turned = Vec::new();
        for turn in turns(count) {
            let whole = Prepared::new(cell, arm, points, turn)?;
            if searched.is_empty() {
                searched = whole.evenly(SEARCHED_POINTS);
            }
            let thinned = whole.thinned(&searched);
            turned.push((turn, whole, thinned));
        }
        Ok(Search {
            reach: Reach::new(cell, arm),
            cell_workpiece: &cell.work.workpiece,
            points,
            turned,
            searched,
            has_free_turn,
        })
    }

    /// Pose of the workpiece at `place`.
    fn workpiece(&self, place: &WorkpiecePlace) -> Isometry3<f64> {
        let yaw = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), place.yaw);
        Isometry3::from_parts(Translation3::from(place.position), yaw * self.cell_workpiece.rotation)
    }

    /// The branch that bends least at `place`, or what stops the one that gets
    /// farthest.
    fn along(
        &self,
        place: &WorkpiecePlace,
        part: Part,
        control: Control<'_>,
    ) -> Result<std::result::Result<PathAtPlace, Stopped>> {
        let workpiece = self.workpiece(place);
        let mut best: Option<((f64, f64), PathAtPlace)> = None;
        let mut farthest: Option<Stopped> = None;
        let mut stop = |stopped: Stopped| {
            let farther = |f: &Stopped| stopped.at > f.at;
            if farthest.as_ref().is_none_or(farther) {
                farthest = Some(stopped);
            }
        };
        for (turn, whole, thinned) in &self.turned {
            let prepared = match part {
                Part::Searched => thinned,
                Part::Whole => whole,
            };
            control.check()?;
            let (poses, wrenches) = prepared.at(&workpiece);
            let starts = match self.reach.postures(&poses[0])? {
                Ok(starts) => starts,
                Err(refusal) => {
                    stop(Stopped { at: 0, refusal });
                    continue;
                }
            };
            for start in starts {
                let path = match follow(&self.reach, &poses, &start, control)? {
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
                if best.as_ref().is_none_or(|(than, _)| is_better(size, strain, *than)) {
                    let along = PathAtPlace { turn: *turn, path, wrenches: wrenches.clone(), sizes };
                    best = Some(((size, strain), along));
                }
            }
        }
        Ok(match (best, farthest) {
            (Some((_, along)), _) => Ok(along),
            (None, Some(stopped)) => Err(stopped),
            // A pose has postures or a refusal.
            (None, None) => Err(Stopped { at: 0, refusal: Refusal::discontinuous() }),
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
    pub(super) fn candidate(
        &self,
        round: usize,
        place: &WorkpiecePlace,
        control: Control<'_>,
    ) -> Result<PlacementCandidate> {
        let along = self.along(place, Part::Searched, control)?;
        let mut out = PlacementCandidate {
            round,
            position_m: place.position,
            yaw: place.yaw,
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
                out.point = Some(self.points[self.searched[stopped.at]].name.to_string());
            }
        }
        Ok(out)
    }

    /// The path at `place`, by the exact equilibrium.
    pub(super) fn placed(&self, place: &WorkpiecePlace, part: Part, control: Control<'_>) -> Result<PlaceEvaluation> {
        let workpiece = self.workpiece(place);
        let along = self.along(place, part, control)?;
        let name = |i: usize| match part {
            Part::Searched => self.points[self.searched[i]].name.to_string(),
            Part::Whole => self.points[i].name.to_string(),
        };
        let mut out = PlaceEvaluation {
            position_m: place.position,
            roll_pitch_yaw: roll_pitch_yaw(&workpiece.rotation),
            yaw: place.yaw,
            turn: None,
            status: Status::Reachable,
            reason: None,
            point: None,
            deflection_rms_m: None,
            deflection_max_m: None,
            deflection_max_point: None,
            start: None,
            along: Vec::new(),
        };
        match along {
            Ok(along) => {
                let mut sizes = Vec::with_capacity(along.path.len());
                let mut points = Vec::with_capacity(along.path.len());
                for (i, (q, wrench)) in along.path.iter().zip(&along.wrenches).enumerate() {
                    control.check()?;
                    let bent = self.reach.arm.deflect(q, wrench)?;
                    let shift = bent.displacement.fixed_rows::<3>(0).into_owned();
                    sizes.push(shift.norm());
                    points.push(PlacedPoint {
                        point: name(i),
                        q: q.clone(),
                        tip_m: bent.before.translation.vector.into(),
                        force_n: wrench.force.into(),
                        moment_nm: wrench.moment.into(),
                        shift_m: shift.into(),
                    });
                }
                let sizes_in_order = sizes.iter().enumerate();
                let largest = sizes_in_order.reduce(|a, b| if b.1 > a.1 { b } else { a });
                out.turn = self.has_free_turn.then_some(along.turn);
                out.deflection_rms_m = Some(rms(&sizes));
                out.deflection_max_m = largest.map(|(_, size)| *size);
                out.deflection_max_point = largest.map(|(i, _)| name(i));
                out.start = along.path.first().cloned();
                let worst = largest.map(|(i, _)| i);
                let is_shown = |i: usize| match part {
                    Part::Searched => true,
                    Part::Whole => self.searched.binary_search(&i).is_ok() || worst == Some(i),
                };
                let shown = points.into_iter().enumerate().filter(|(i, _)| is_shown(*i));
                out.along = shown.map(|(_, point)| point).collect();
            }
            Err(stopped) => {
                out.status = stopped.refusal.status;
                out.reason = Some(stopped.refusal.reason);
                out.point = Some(name(stopped.at));
            }
        }
        Ok(out)
    }
}
