//! What of the cell's space a picture must show.

use super::outline::corner_points;
use stiffarm::model::cell::Cell;
use stiffarm::model::kinematics::Frames;
use stiffarm::model::load::Load;
use stiffarm::model::observation::{PostureTerms, Setup};
use stiffarm::model::scene::{Carrier, Part};
use stiffarm::model::shape::Solid;
use stiffarm::nalgebra::{Unit, Vector3};

/// How far around arm and load other things still count, as a share of their size: limits, what
/// stands around, tracker stations.
const LIMITS: f64 = 1.0;
const THINGS: f64 = 0.6;
const STATIONS: f64 = 0.3;
/// Length of a force, as a share of the same.
const FORCE: f64 = 0.2;
/// Thickness of floors and walls.
const THICK: f64 = 0.05;

/// Points that must be seen, in the base frame \[m\].
#[derive(Debug, Clone)]
pub(crate) struct Stage {
    points: Vec<Vector3<f64>>,
    low: Vector3<f64>,
    high: Vector3<f64>,
    axis: (Vector3<f64>, Unit<Vector3<f64>>),
    arm_size: f64,
}

impl Stage {
    /// Arms at all postures, shapes of the one in full, the load; of what stands around, what is near.
    pub(crate) fn of(cell: &Cell, all: &[PostureTerms], shown: Option<usize>) -> Self {
        let mut points = vec![Vector3::zeros()];
        for terms in all {
            points.extend(arm(terms));
            points.push(*terms.loading_point());
            points.extend(terms.measuring_points());
        }
        let full = shown.and_then(|shown| all.get(shown));
        if let Some(terms) = full {
            for part in cell.scene.parts().iter().filter(|part| !stands(part)) {
                let pose = part.carrier.pose(terms.frames());
                let solids = part.solids.iter();
                points.extend(solids.flat_map(|s| corner_points(&s.placed(&pose))));
            }
        }
        points.extend(cell.setup.load.anchors());
        let frames = all.first().map(PostureTerms::frames);
        let first = frames.and_then(|f| Some((*f.origins().first()?, *f.axes().first()?)));
        let axis =
            first.map_or((Vector3::zeros(), Vector3::z_axis()), |(point, axis)| (point, Unit::new_normalize(axis)));
        let (low, high) = bounds(&points);
        let mut stage = Stage { points, low, high, axis, arm_size: (high - low).max() };
        if let Some(terms) = full {
            for setup in cell.setup.cases() {
                let tip = stage.force_tip(&setup, terms.frames());
                stage.points.extend(tip);
            }
        }
        stage.add_surroundings(cell);
        (stage.low, stage.high) = bounds(&stage.points);
        stage
    }

    fn add_surroundings(&mut self, cell: &Cell) {
        let mut found = self.near_things(cell);
        let around = self.around(LIMITS);
        if let Some([a, b]) = &cell.limits.tool_box {
            found.extend(corners(&a.sup(&around.0), &b.inf(&around.1)));
        }
        if let Some(radius) = cell.limits.keep_out_radius {
            let across = Vector3::new(radius, radius, 0.0);
            let (point, _) = self.axis;
            let ends = [point - across, point + across];
            found.extend(ends.into_iter().filter(|p| within(p, &around)));
        }
        let levels = cell.limits.on_points().filter_map(|limit| limit.level());
        let levels = levels.map(|z| Vector3::new(0.0, 0.0, z));
        found.extend(levels.filter(|p| within(p, &around)));
        if let Some(sight) = cell.scene.sight() {
            let around = self.around(STATIONS);
            let stations = sight.stations.iter().map(|s| s.position);
            found.extend(stations.filter(|p| within(p, &around)));
        }
        self.points.extend(found);
    }

    /// Points of what stands near.
    fn near_things(&self, cell: &Cell) -> Vec<Vector3<f64>> {
        let around = self.around(THINGS);
        let (low, high) = around;
        let mut found = Vec::new();
        let parts = cell.scene.parts().iter().filter(|part| stands(part));
        for solid in parts.flat_map(|part| &part.solids) {
            if let Solid::HalfSpace { point, normal } = solid {
                let centre = self.centre();
                let foot = centre - normal.into_inner() * (centre - point).dot(normal);
                if within(&foot, &around) {
                    found.push(foot - normal.into_inner() * (THICK * self.size()));
                }
                continue;
            }
            let (a, b) = bounds(&corner_points(solid));
            if (0..3).all(|i| a[i] <= high[i] && b[i] >= low[i]) {
                found.extend(corners(&a.sup(&low), &b.inf(&high)));
            }
        }
        found
    }

    /// The box around arm and load, so much larger to each side.
    fn around(&self, share: f64) -> (Vector3<f64>, Vector3<f64>) {
        let room = Vector3::repeat(share * self.size());
        (self.low - room, self.high + room)
    }

    /// Largest extent \[m\].
    pub(crate) fn size(&self) -> f64 {
        (self.high - self.low).max().max(1e-3)
    }

    /// Middle of what must be seen.
    pub(super) fn centre(&self) -> Vector3<f64> {
        (self.low + self.high) * 0.5
    }

    /// Corners of the box around what must be seen.
    pub(crate) fn corners(&self) -> [Vector3<f64>; 8] {
        corners(&self.low, &self.high)
    }

    /// Where a force on the loading point is drawn to; `None` without one, and for a rope, which
    /// pulls towards its anchor.
    pub(super) fn force_tip(&self, setup: &Setup, frames: &Frames) -> Option<Vector3<f64>> {
        let drawn = match setup.load {
            Load::Weight { .. } | Load::Constant { .. } => true,
            Load::Rope { magnitude, .. } => magnitude < 0.0,
            Load::Measured | Load::Cases(_) => false,
        };
        let at = frames.point(&setup.tool.loading_point);
        let wrench = setup.load.wrench(frames, &at).filter(|_| drawn)?;
        let unit = Unit::try_new(wrench.force, 1e-9)?;
        Some(at + unit.into_inner() * self.force_length())
    }

    /// How long a force is drawn \[m\].
    pub(crate) fn force_length(&self) -> f64 {
        FORCE * self.arm_size
    }

    /// What must be seen.
    pub(super) fn points(&self) -> &[Vector3<f64>] {
        &self.points
    }

    /// A point on axis 1 and its direction.
    pub(crate) fn first_axis(&self) -> (Vector3<f64>, Unit<Vector3<f64>>) {
        self.axis
    }

    /// Middle of the part of a solid that is seen; `None` where none is.
    pub(super) fn middle(&self, solid: &Solid) -> Option<Vector3<f64>> {
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

/// Corners of a box, its smallest first and its largest last.
pub(super) fn corners(low: &Vector3<f64>, high: &Vector3<f64>) -> [Vector3<f64>; 8] {
    let ends = [low, high];
    [0_usize, 1, 2, 3, 4, 5, 6, 7].map(|i| {
        let pick = |axis: usize| ends[i >> axis & 1][axis];
        Vector3::new(pick(0), pick(1), pick(2))
    })
}

fn within(p: &Vector3<f64>, (low, high): &(Vector3<f64>, Vector3<f64>)) -> bool {
    (0..3).all(|i| low[i] <= p[i] && p[i] <= high[i])
}

/// Corners of the box around points.
fn bounds(points: &[Vector3<f64>]) -> (Vector3<f64>, Vector3<f64>) {
    let none = (Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY));
    let finite = points.iter().filter(|p| p.iter().all(|v| v.is_finite()));
    finite.fold(none, |(low, high), p| (low.inf(p), high.sup(p)))
}

/// What is neither arm nor tool.
pub(crate) fn stands(part: &Part) -> bool {
    part.carrier == Carrier::World && part.name != "base"
}

/// From the base over the joints to the flange.
pub(crate) fn arm(terms: &PostureTerms) -> Vec<Vector3<f64>> {
    let frames = terms.frames();
    let mut points = vec![Vector3::zeros()];
    points.extend(frames.origins());
    points.push(frames.flange().translation.vector);
    points.dedup_by(|a, b| (*a - *b).norm() < 1e-6);
    points
}
