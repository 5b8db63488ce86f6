//! Postures along a path: one branch of the arm without a jump, and, where the
//! turn about the tool axis is free, the postures that bend least.
//!
//! The idea to spend a free turn on stiffness is that of Y. Guo, H. Dong, Y. Ke,
//! *Stiffness-oriented posture optimization in robotic machining applications*,
//! Robot. Comput.-Integr. Manuf. 35, 2015, 69–76, doi:10.1016/j.rcim.2015.02.006.
//! They maximise the volume of a stiffness ellipsoid point by point; here the
//! deflection under the load of each point is minimised along the whole path.
//!
//! The way that bends least is looked for within the machine's limits. Where
//! bounds, limits or shapes of the cell forbid some of it, the search is made
//! again for the way that they forbid least, of equals the one that bends least.

mod findings;
mod free_turn;
mod shortfall;
mod tracks;
mod turned_round;

use crate::error::{Code, Error, Result};
use crate::estimate::identify::rms;
use crate::findings::Finding;
use crate::model::inverse::{InverseKinematics, Method, Outcome};
use crate::model::load::Wrench;
use crate::model::observation::PostureTerms;
use crate::model::path::{LoadedPosture, PathPoint, PathTarget, tip_wrenches};
use crate::model::process::ProcessLoad;
use crate::numerics::control::Control;
use crate::numerics::jobs::in_blocks;
use crate::units::deg_to_rad;
use crate::work::predict::LoadedArm;
use nalgebra::{Isometry3, Matrix3, Rotation3, UnitQuaternion, UnitVector3, Vector3};
use serde::{Deserialize, Serialize};
use tracks::Branches;

/// How to find the postures of a path.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct PosturePathOptions {
    /// Posture \[rad\] that the first one should be near; without one the branch
    /// that bends least is taken.
    pub start: Option<Vec<f64>>,
    /// Largest change of a joint from one point to the next \[rad\]: more is a jump.
    pub largest_step: f64,
    /// Whether the turn about the tool axis is free where the path gives it, too.
    pub free_turn: bool,
    /// Turns about the tool axis that are tried at each point.
    pub turns: usize,
    /// The load where the path's points have none.
    pub process: Option<ProcessLoad>,
    /// Pose of the workpiece frame in the base frame \[m\].
    pub workpiece: Isometry3<f64>,
}

impl Default for PosturePathOptions {
    fn default() -> Self {
        PosturePathOptions {
            start: None,
            largest_step: deg_to_rad(30.0),
            free_turn: false,
            turns: 72,
            process: None,
            workpiece: Isometry3::identity(),
        }
    }
}

/// The postures of a path, with what is to be known about them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PosturePathSummary {
    /// Where the postures come from.
    pub origin: Origin,
    /// Largest change of a joint from one point to the next \[rad\].
    #[serde(rename = "largest_step_deg", with = "crate::units::degrees::all_digits")]
    #[cfg_attr(feature = "schema", schemars(with = "f64"))]
    pub largest_step: f64,
    /// RMS of the deflections, linear model \[m\].
    pub deflection_rms_m: f64,
    /// The same of the path as given, where its turn was freed and it can be
    /// followed as it is.
    pub given_rms_m: Option<f64>,
    /// RMS of the deflections of the way that bends least, where the cell's bounds,
    /// limits or shapes forbid some of it and another was taken \[m\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unkept_rms_m: Option<f64>,
    /// Turn about the tool axis at each point, from the given one or, where only
    /// the axis is given, from one carried along without twist \[rad\].
    #[serde(rename = "turn_deg", with = "crate::units::degrees::all_digits")]
    #[cfg_attr(feature = "schema", schemars(with = "Option<Vec<f64>>"))]
    pub turn: Option<Vec<f64>>,
    /// What to know, in sentences.
    pub findings: Vec<Finding>,
}

/// Where postures come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Origin {
    /// The path gives the joint angles.
    Given,
    /// Inverse kinematics in closed form.
    ClosedForm,
    /// Inverse kinematics by iteration.
    Numeric,
}

/// What all steps of the search share.
struct Search<'a> {
    arm: &'a LoadedArm,
    inverse: &'a InverseKinematics,
    points: &'a [PathPoint],
    options: &'a PosturePathOptions,
    /// Whether the cell's bounds, limits and shapes count before the deflection.
    keeps: bool,
}

/// Postures of a path.
struct PathPostures {
    q: Vec<Vec<f64>>,
    turn: Option<Vec<f64>>,
    /// RMS of the deflections \[m\].
    rms: f64,
    /// The same of the path as given, where its turn was freed.
    given_rms: Option<f64>,
    /// Loads at the tip.
    wrenches: Vec<Wrench>,
}

/// Finds the postures of `points`.
///
/// Without a free turn all branches of the first pose are followed along the
/// path; the one nearest to `options.start`, or else the one that bends least,
/// is taken. With a free turn the turns and branches of all points form a graph
/// whose cheapest way, by the squares of the deflections, is found by dynamic
/// programming and refined between the turns tried. Deflections of the search
/// are those of the linear model. Postures that the cell's bounds, limits or shapes
/// forbid are avoided where that can be done; they are looked at point by point, not
/// on the way between two points.
///
/// # Errors
/// Each with the line of the point: a pose that the arm does not reach, one that
/// it reaches outside its limits only, a jump that cannot be avoided; a load in
/// the axes of the path where there is no feed; interrupted.
pub fn posture_path(
    arm: &LoadedArm,
    inverse: &InverseKinematics,
    points: &[PathPoint],
    options: &PosturePathOptions,
    control: Control<'_>,
) -> Result<(Vec<LoadedPosture>, PosturePathSummary)> {
    if points.is_empty() {
        return Err(Error::new(Code::TooFewData, "The path has no points."));
    }
    let mut search = Search { arm, inverse, points, options, keeps: false };
    let axis_only = points.iter().any(|p| matches!(p.target, PathTarget::Axis { .. }));
    let free = options.free_turn || axis_only;
    let angles: Option<Vec<Vec<f64>>> = points
        .iter()
        .map(|p| match &p.target {
            PathTarget::Angles(q) => Some(q.clone()),
            _ => None,
        })
        .collect();
    let poses = poses(arm, points);
    let origin = match (&angles, free, inverse.method()) {
        (Some(_), false, _) => Origin::Given,
        (_, _, Method::ClosedForm) => Origin::ClosedForm,
        (_, _, Method::Numeric) => Origin::Numeric,
    };
    let angles = angles.as_deref();
    let with_hint = |error| turned_round::with_hint(&search, &poses, free, error);
    let branches = match angles.is_some() || axis_only {
        true => None,
        false => match tracks::branches(&search, &poses, control) {
            // Whoever frees the turn may do so because it cannot be kept.
            Err(error) if free && error.code() != Code::Interrupted => None,
            branches => Some(branches.map_err(with_hint)?),
        },
    };
    let way = search.way(angles, free, branches.as_ref(), &poses, control);
    let mut way = way.map_err(with_hint)?;
    let (mut unkept_rms_m, mut about_limits) = (None, Vec::new());
    if origin != Origin::Given {
        let mut missing = search.missing_along(&way.q, control)?;
        let sum = |missing: &[f64]| missing.iter().sum::<f64>();
        if sum(&missing) > 0.0 {
            search.keeps = true;
            // Where the other search ends at a jump, what is known stays.
            match search.way(angles, free, branches.as_ref(), &poses, control) {
                Err(error) if error.code() == Code::Interrupted => return Err(error),
                Err(_) => {}
                Ok(other) => {
                    let others = search.missing_along(&other.q, control)?;
                    if sum(&others) < sum(&missing) {
                        let left = search.left(&way, &missing, &other);
                        unkept_rms_m = left.is_some().then_some(way.rms);
                        about_limits.extend(left);
                        (way, missing) = (other, others);
                    }
                }
            }
            about_limits.extend(search.nothing_free(&poses, free, &way, &missing)?);
        }
    }
    drop((branches, poses));
    let PathPostures { q, turn, rms, given_rms, wrenches } = way;
    let mut summary = PosturePathSummary {
        origin,
        largest_step: largest_step(&q, points),
        deflection_rms_m: rms,
        given_rms_m: given_rms,
        unkept_rms_m,
        turn,
        findings: Vec::new(),
    };
    summary.findings = findings::findings(&search, &q, &summary, control)?;
    summary.findings.extend(about_limits);
    let postures = points
        .iter()
        .zip(q)
        .zip(wrenches)
        .map(|((point, q), wrench)| LoadedPosture {
            name: point.name.clone(),
            line: point.line,
            feature: point.feature.clone(),
            q,
            wrench,
        })
        .collect();
    Ok((postures, summary))
}

/// Tip poses of all points, base frame \[m\]; where only the axis is given, x is
/// carried from point to point without twist about it.
fn poses(arm: &LoadedArm, points: &[PathPoint]) -> Vec<Isometry3<f64>> {
    let mut last = Vector3::x();
    points
        .iter()
        .map(|point| {
            let pose = match &point.target {
                PathTarget::Angles(q) => arm.tip_pose(q),
                PathTarget::Pose(pose) => *pose,
                PathTarget::Axis { position, axis } => Isometry3::from_parts((*position).into(), about(axis, &last)),
            };
            last = pose.rotation * Vector3::x();
            pose
        })
        .collect()
}

/// Axes with z along `axis` and x as near as possible to `x`.
fn about(axis: &UnitVector3<f64>, x: &Vector3<f64>) -> UnitQuaternion<f64> {
    let across = |v: &Vector3<f64>| (v - axis.as_ref() * axis.dot(v)).try_normalize(1e-6);
    let x = [*x, Vector3::x(), Vector3::y()].iter().find_map(across);
    let x = x.unwrap_or_else(Vector3::z);
    let axes = Matrix3::from_columns(&[x, axis.cross(&x), axis.into_inner()]);
    UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes))
}

/// `pose` turned about its own z by `turn` \[rad\].
fn turned(pose: &Isometry3<f64>, turn: f64) -> Isometry3<f64> {
    pose * UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn)
}

/// Largest change of a joint from one posture to the next but by rapid moves \[rad\].
fn largest_step(q: &[Vec<f64>], points: &[PathPoint]) -> f64 {
    let pairs = q.windows(2).zip(&points[1..]);
    let pairs = pairs.filter(|(_, to)| !to.rapid);
    pairs.map(|(pair, _)| change(&pair[0], &pair[1]).1).fold(0.0, f64::max)
}

/// The joint that changes most, and by how much \[rad\].
fn change(from: &[f64], to: &[f64]) -> (usize, f64) {
    let changes = from.iter().zip(to).map(|(a, b)| (b - a).abs());
    changes.enumerate().fold((0, 0.0), |most, (j, c)| if c > most.1 { (j, c) } else { most })
}

impl Search<'_> {
    /// The way that bends least, of those that are forbidden least where that counts.
    fn way(
        &self,
        angles: Option<&[Vec<f64>]>,
        free: bool,
        branches: Option<&Branches>,
        poses: &[Isometry3<f64>],
        control: Control<'_>,
    ) -> Result<PathPostures> {
        let unturned_postures = match (angles, branches) {
            (Some(q), _) => Some(q.to_vec()),
            (None, None) => None,
            (None, Some(branches)) => match tracks::postures(self, poses, branches, control) {
                Err(error) if free && error.code() != Code::Interrupted => None,
                other => Some(other?),
            },
        };
        let unturned_way = unturned_postures.map(|q| self.bent(q, None, control)).transpose()?;
        let unturned_way = match unturned_way {
            Some(way) if !free => return Ok(way),
            unturned_way => unturned_way,
        };
        let q = unturned_way.as_ref().map(|way| way.q.as_slice());
        let turned_postures = free_turn::postures(self, poses, q, control)?;
        let mut turned_way = self.bent(turned_postures.q, Some(turned_postures.turns), control)?;
        let Some(mut unturned_way) = unturned_way else {
            return Ok(turned_way);
        };
        turned_way.given_rms = Some(unturned_way.rms);
        // A price on joint motion, or the interpolation between knots, may cost
        // more than the turn gains.
        if self.rank(&turned_way)? >= self.rank(&unturned_way)? {
            unturned_way.turn = Some(vec![0.0; unturned_way.q.len()]);
            unturned_way.given_rms = Some(unturned_way.rms);
            return Ok(unturned_way);
        }
        Ok(turned_way)
    }

    /// The postures `q` with their deflections.
    fn bent(&self, q: Vec<Vec<f64>>, turn: Option<Vec<f64>>, control: Control<'_>) -> Result<PathPostures> {
        let tips = self.arm.tip_poses(&q, control.quiet())?;
        let wrenches = self.wrenches(&tips)?;
        let rms = self.rms(&self.deflections(&q, &wrenches, control)?);
        Ok(PathPostures { q, turn, rms, given_rms: None, wrenches })
    }

    /// The postures that stand one after the other in `q`.
    fn each(&self, q: &[f64]) -> Vec<Vec<f64>> {
        q.chunks(self.arm.robot().joint_count()).map(<[f64]>::to_vec).collect()
    }

    /// What ways are compared by: what is missing, where it counts, then the deflection.
    fn rank(&self, way: &PathPostures) -> Result<(f64, f64)> {
        let mut missing = 0.0;
        for q in &way.q {
            missing += self.counted(q)?;
        }
        Ok((missing, way.rms))
    }

    fn flange(&self, tip: &Isometry3<f64>) -> Isometry3<f64> {
        tip * self.arm.tip().inverse()
    }

    /// Largest change of a joint on the way to point `i` from the one before, or from `from` \[rad\].
    fn largest_step(&self, from: usize, i: usize) -> f64 {
        if self.points[(from + 1).min(i)..=i].iter().any(|point| point.rapid) {
            f64::INFINITY
        } else {
            self.options.largest_step
        }
    }

    fn wrenches(&self, tips: &[Isometry3<f64>]) -> Result<Vec<Wrench>> {
        tip_wrenches(self.points, tips, self.options.process.as_ref(), &self.options.workpiece)
    }

    /// RMS of deflections; rapid moves, which carry no load, do not dilute it.
    fn rms(&self, sizes: &[f64]) -> f64 {
        let sizes = sizes.iter().zip(self.points);
        let sizes = sizes.filter(|(_, point)| !point.rapid);
        rms(&sizes.map(|(size, _)| *size).collect::<Vec<f64>>())
    }

    /// Sizes of the deflections by the linear model \[m\].
    fn deflections(&self, q: &[Vec<f64>], wrenches: &[Wrench], control: Control<'_>) -> Result<Vec<f64>> {
        in_blocks(q, "bending", control.quiet(), |start, block| {
            let mut terms = self.arm.memory();
            let sizes = (start..).zip(block).map(|(i, q)| {
                self.arm.stand_at(q, &wrenches[i], &mut terms).map_err(|e| self.at(i, e))?;
                Ok(self.shift(&terms))
            });
            sizes.collect()
        })
    }

    fn deflection(&self, q: &[f64], wrench: &Wrench) -> Result<f64> {
        Ok(self.shift(&self.arm.terms(q, wrench)?))
    }

    /// Size of the shift of the tip at the posture and under the load of `terms` \[m\].
    fn shift(&self, terms: &PostureTerms) -> f64 {
        self.arm.linear(terms).fixed_rows::<3>(0).norm()
    }

    /// Postures of point `i` at the tip pose `tip`, inside and outside the limits.
    fn branches(&self, i: usize, tip: &Isometry3<f64>) -> Result<Vec<Vec<f64>>> {
        match self.inverse.solve(&self.flange(tip)).map_err(|e| self.at(i, e))? {
            Outcome::Reachable(branches) => Ok(branches.into_iter().map(|b| b.q).collect()),
            Outcome::Unreachable(far) => Err(self.named(i, &far.error(self.arm.robot()))),
        }
    }

    /// How far the joint that is farthest from the middle of its limits is from it \[rad\].
    fn off_centre(&self, q: &[f64]) -> f64 {
        let ranges = q.iter().zip(self.arm.robot().joints());
        ranges.map(|(a, j)| (a - 0.5 * (j.limits[0] + j.limits[1])).abs()).fold(0.0, f64::max)
    }

    /// `error` with the line of point `i`.
    fn at(&self, i: usize, error: Error) -> Error {
        self.points[i].at(error)
    }

    /// `error` in a sentence that names point `i`, with its line.
    fn named(&self, i: usize, error: &Error) -> Error {
        let message = format!("Point {}: {}", self.points[i].name, error.message());
        let named = Error::new(error.code(), message);
        let named = named.hint_if(error.hint_text());
        self.at(i, named)
    }
}
