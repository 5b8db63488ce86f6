//! What of the cell's space a picture must show.

use super::arm::Arm;
use super::corners::{bounds, corner_points, corners};
use super::data::{BodyKind, Scene};
use stiffarm::model::shape::Solid;
use stiffarm::nalgebra::Vector3;

/// How far around arm and load other things still count, as a share of their size: limits, what
/// stands around, tracker stations.
const LIMITS: f64 = 1.0;
const STANDING: f64 = 0.6;
const STATIONS: f64 = 0.3;
/// Length of a force, as a share of the same.
const FORCE: f64 = 0.2;
/// Thickness of floors and walls.
const THICK: f64 = 0.05;

/// Points that must be seen, in the base frame \[m\].
#[derive(Debug, Clone)]
pub(crate) struct Stage {
    pub points: Vec<Vector3<f64>>,
    low: Vector3<f64>,
    high: Vector3<f64>,
    /// How long a force is drawn \[m\].
    pub force_length: f64,
}

impl Stage {
    /// All arms, shapes of the one in full, the load; of what stands around, what is near.
    pub fn of(scene: &Scene, arms: &[Arm<'_>], full: Option<&Arm<'_>>) -> Self {
        let mut points = vec![Vector3::zeros()];
        points.extend(arms.iter().flat_map(Arm::points));
        let moving = scene.parts().map(|(_, body)| body).filter(|body| body.kind != BodyKind::Standing);
        let placed = full.into_iter().flat_map(|arm| moving.clone().flat_map(|body| arm.placed(body)));
        points.extend(placed.flat_map(|solid| corner_points(&solid)));
        points.extend(scene.anchors());
        let (low, high) = bounds(&points);
        let force_length = FORCE * (high - low).max();
        let mut stage = Stage { points, low, high, force_length };
        if let Some(arm) = full {
            stage.points.extend((0..scene.loads.len()).filter_map(|load| arm.force_tip(load, force_length)));
        }
        stage.add_surroundings(scene);
        (stage.low, stage.high) = bounds(&stage.points);
        stage
    }

    fn add_surroundings(&mut self, scene: &Scene) {
        let mut near = self.standing_near(scene);
        let around = self.around(LIMITS);
        let limits = &scene.limits;
        if let Some(ends) = limits.tool_box {
            let [a, b] = ends.map(Vector3::from);
            near.extend(corners(&a.sup(&around.0), &b.inf(&around.1)));
        }
        if let Some(keep_out) = &limits.keep_out {
            let across = Vector3::new(keep_out.radius, keep_out.radius, 0.0);
            let point = Vector3::from(keep_out.origin);
            near.extend([point - across, point + across].into_iter().filter(|p| within(p, &around)));
        }
        let levels = limits.levels().map(|(_, z)| Vector3::new(0.0, 0.0, z));
        near.extend(levels.filter(|p| within(p, &around)));
        let around = self.around(STATIONS);
        let stations = scene.stations.iter().map(|station| Vector3::from(station.at));
        near.extend(stations.filter(|p| within(p, &around)));
        self.points.extend(near);
    }

    /// Points of what stands near.
    fn standing_near(&self, scene: &Scene) -> Vec<Vector3<f64>> {
        let around = self.around(STANDING);
        let (low, high) = around;
        let mut near = Vec::new();
        let standing = scene.parts().filter(|(_, body)| body.kind == BodyKind::Standing);
        for solid in standing.flat_map(|(_, body)| &body.solids) {
            if let Solid::HalfSpace { point, normal } = solid {
                let centre = self.centre();
                let foot = centre - normal.into_inner() * (centre - point).dot(normal);
                if within(&foot, &around) {
                    near.push(foot - normal.into_inner() * (THICK * self.size()));
                }
                continue;
            }
            let (a, b) = bounds(&corner_points(solid));
            if (0..3).all(|i| a[i] <= high[i] && b[i] >= low[i]) {
                near.extend(corners(&a.sup(&low), &b.inf(&high)));
            }
        }
        near
    }

    /// The box around arm and load, so much larger to each side.
    fn around(&self, share: f64) -> (Vector3<f64>, Vector3<f64>) {
        let room = Vector3::repeat(share * self.size());
        (self.low - room, self.high + room)
    }

    /// Largest extent \[m\].
    pub fn size(&self) -> f64 {
        (self.high - self.low).max().max(1e-3)
    }

    /// Middle of what must be seen.
    pub fn centre(&self) -> Vector3<f64> {
        (self.low + self.high) * 0.5
    }

    /// Corners of the box around what must be seen.
    pub fn corners(&self) -> [Vector3<f64>; 8] {
        corners(&self.low, &self.high)
    }

    /// Middle of the part of a solid that is seen; `None` where none is.
    pub fn middle(&self, solid: &Solid) -> Option<Vector3<f64>> {
        if let Solid::HalfSpace { point, normal } = solid {
            // Beside the arm, half-way into what is seen of it.
            let corner = Vector3::new(self.low.x * 0.85 + self.high.x * 0.15, self.low.y, self.low.z);
            let down = (corner - point).dot(normal) + 0.4 * THICK * self.size();
            let at = corner - normal.into_inner() * down;
            let near = (0..3).all(|i| self.low[i] - 0.1 <= at[i] && at[i] <= self.high[i] + 0.1);
            return near.then_some(at);
        }
        let (low, high) = bounds(&corner_points(solid));
        let (low, high) = (low.sup(&self.low), high.inf(&self.high));
        (0..3).all(|i| low[i] <= high[i]).then(|| (low + high) * 0.5)
    }
}

fn within(p: &Vector3<f64>, (low, high): &(Vector3<f64>, Vector3<f64>)) -> bool {
    (0..3).all(|i| low[i] <= p[i] && p[i] <= high[i])
}
