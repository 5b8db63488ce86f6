//! Where arm, tool and loads are at a posture.

use super::data::{Body, LoadKind, Scene, ScenePosture};
use super::numbers::{Triple, isometry};
use stiffarm::model::shape::Solid;
use stiffarm::nalgebra::{Isometry3, Point3, Unit, Vector3};

/// Joints that are nearer to each other are one point of the arm \[m\].
const SAME: f64 = 1e-6;

/// A posture with its places in the base frame \[m\].
#[derive(Debug, Clone)]
pub(crate) struct Arm<'a> {
    pub posture: &'a ScenePosture,
    /// Frames of base, links and flange, as bodies count their carriers.
    frames: Vec<Isometry3<f64>>,
    pub measuring_points: Vec<Vector3<f64>>,
    /// By number of load case.
    pub loading_points: Vec<Vector3<f64>>,
    /// Where a force is drawn to by number of load case; `None` where none is, and for a rope, which pulls towards its
    /// anchor.
    forces: Vec<Option<Unit<Vector3<f64>>>>,
}

impl<'a> Arm<'a> {
    pub fn of(scene: &Scene, posture: &'a ScenePosture) -> Self {
        let mut frames = vec![Isometry3::identity()];
        frames.extend(posture.links.iter().map(isometry));
        let flange = frames.last().copied().unwrap_or_default() * isometry(&scene.flange);
        frames.push(flange);
        let on_flange = |at: &Triple| (flange * Point3::from(*at)).coords;
        let force = |(number, load): (usize, &LoadKind)| {
            let drawn = matches!(load.kind, "weight" | "wrench" | "cylinder");
            let load = posture.loads.get(number).filter(|_| drawn)?;
            Unit::try_new(Vector3::from(load.force), 1e-9)
        };
        Arm {
            posture,
            measuring_points: scene.measuring_points.iter().map(|point| on_flange(&point.at)).collect(),
            loading_points: scene.loads.iter().map(|load| on_flange(&load.at)).collect(),
            forces: scene.loads.iter().enumerate().map(force).collect(),
            frames,
        }
    }

    /// Solids of a body.
    pub fn placed<'b>(&'b self, body: &'b Body) -> impl Iterator<Item = Solid> + 'b {
        body.solids.iter().map(|solid| solid.placed(&self.frames[body.carrier]))
    }

    /// A point on each joint's axis.
    pub fn joints(&self) -> impl Iterator<Item = Vector3<f64>> {
        self.frames[1..self.frames.len() - 1].iter().map(|frame| frame.translation.vector)
    }

    /// The point on the axis of the last joint but one.
    pub fn wrist_centre(&self) -> Vector3<f64> {
        self.frames[self.frames.len().saturating_sub(3).max(1)].translation.vector
    }

    pub fn flange(&self) -> Vector3<f64> {
        self.frames[self.frames.len() - 1].translation.vector
    }

    /// The loading point, of several loads that of the first.
    pub fn loading_point(&self) -> Vector3<f64> {
        self.loading_points[0]
    }

    /// From the base over the joints to the flange.
    pub fn skeleton(&self) -> Vec<Vector3<f64>> {
        let mut points: Vec<Vector3<f64>> = self.frames.iter().map(|frame| frame.translation.vector).collect();
        points.dedup_by(|a, b| (*a - *b).norm() < SAME);
        points
    }

    /// Arm and points of the tool.
    pub fn points(&self) -> Vec<Vector3<f64>> {
        let mut points = self.skeleton();
        points.push(self.loading_point());
        points.extend(&self.measuring_points);
        points
    }

    /// Where the arrow of a load's force ends, of this length \[m\].
    pub fn force_tip(&self, load: usize, length: f64) -> Option<Vector3<f64>> {
        self.forces[load].map(|force| self.loading_points[load] + force.into_inner() * length)
    }
}
