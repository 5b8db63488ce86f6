//! Things of a cell as marks of a view \[mm\].

use super::camera::Camera;
use super::outline::{circle, corner_points, hull_of, outline};
use super::stage::Stage;
use super::things::{Layer, Name, Shown, Thing, Things, What};
use crate::figure::Axis;
use crate::figure::drawing::{Label, Mark, Shape, Tone, View};
use stiffarm::model::shape::Solid;
use stiffarm::nalgebra::{Unit, Vector3};

/// Room around what must be seen, as a share of its size.
const ROOM: f64 = 0.04;
/// The arm's axes lie within its shapes: so much farther than they are, as a share of the scene.
const WITHIN: f64 = 0.08;
/// Arrows shorter than this share of the scene are left out.
const SHORT: f64 = 0.02;
const MM: f64 = 1e3;

/// A view of the things.
pub(super) fn view(title: &str, axes: Option<[&str; 2]>, camera: &Camera, stage: &Stage, things: &Things) -> View {
    let extent = extent(camera, stage);
    let draws = Draws { camera, stage, extent };
    let mut order: Vec<(&Thing, f64)> = things.things.iter().map(|thing| (thing, draws.nearness(thing))).collect();
    order.sort_by(|(a, near), (b, nearer)| {
        a.layer.cmp(&b.layer).then(match a.layer {
            Layer::Bodies => near.total_cmp(nearer),
            _ => std::cmp::Ordering::Equal,
        })
    });
    View {
        title: title.into(),
        axes: axes.map(|names| names.map(|name| Axis::linear(name, "mm"))),
        extent: extent.map(|ends| ends.map(|v| v * MM)),
        marks: order.iter().flat_map(|(thing, _)| draws.marks(thing)).collect(),
        labels: things.names.iter().filter_map(|n| draws.label(n)).collect(),
    }
}

/// What must be seen, with some room.
fn extent(camera: &Camera, stage: &Stage) -> [[f64; 2]; 2] {
    let mut ends = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
    for p in stage.points().iter().filter_map(|p| camera.point(p)) {
        for (end, v) in ends.iter_mut().zip(p) {
            *end = [end[0].min(v), end[1].max(v)];
        }
    }
    let room = ROOM * stage.size();
    ends.map(|[low, high]| [low - room, high + room])
}

struct Draws<'a> {
    camera: &'a Camera,
    stage: &'a Stage,
    extent: [[f64; 2]; 2],
}

impl Draws<'_> {
    fn nearness(&self, thing: &Thing) -> f64 {
        let mean = |points: &[Vector3<f64>]| {
            let sum: Vector3<f64> = points.iter().sum();
            sum / points.len().max(1) as f64
        };
        match &thing.what {
            What::Solid(Solid::HalfSpace { .. }) | What::Level(_) => f64::NEG_INFINITY,
            What::Solid(solid) => self.camera.nearness(&mean(&corner_points(solid))),
            What::Hull(points) => self.camera.nearness(&mean(points)),
            What::Line(points) => self.camera.nearness(&mean(points)) - WITHIN * self.stage.size(),
            What::Arrow([p, _]) | What::Point(p) => self.camera.nearness(p),
        }
    }

    fn marks(&self, thing: &Thing) -> Vec<Mark> {
        let line = |a: &Vector3<f64>, b: &Vector3<f64>| {
            let piece = self.camera.segment(a, b)?;
            Some(Shape::Line(piece.map(|p| p.map(|v| v * MM)).to_vec()))
        };
        let shapes: Vec<Shape> = match &thing.what {
            What::Solid(Solid::HalfSpace { point, normal }) => {
                self.half_space(point, normal).map(area).into_iter().collect()
            }
            What::Solid(solid) if thing.tone == Tone::Bound && !self.camera.is_flat() => self.frame_of(solid),
            What::Solid(solid) => outline(solid, self.camera).map(area).into_iter().collect(),
            What::Hull(points) => hull_of(points, self.camera).map(area).into_iter().collect(),
            What::Line(points) => {
                if self.camera.is_flat() {
                    vec![Shape::Line(points.iter().map(|p| self.camera.flat(p).map(|v| v * MM)).collect())]
                } else {
                    points.windows(2).filter_map(|p| line(&p[0], &p[1])).collect()
                }
            }
            What::Arrow([from, to]) => {
                let ends = self.camera.segment(from, to);
                let long = |[a, b]: &[[f64; 2]; 2]| (b[0] - a[0]).hypot(b[1] - a[1]) > SHORT * self.stage.size();
                let ends = ends.filter(long).map(|ends| ends.map(|p| p.map(|v| v * MM)));
                ends.map(Shape::Arrow).into_iter().collect()
            }
            What::Point(at) => {
                let at = self.camera.point(at).map(|p| p.map(|v| v * MM));
                at.map(Shape::Point).into_iter().collect()
            }
            What::Level(height) => self.level(*height).into_iter().collect(),
        };
        let marks = shapes.into_iter();
        marks.map(|s| Mark::new(s, thing.tone).with_caution(thing.caution)).collect()
    }

    /// Edges of a limit in perspective.
    fn frame_of(&self, solid: &Solid) -> Vec<Shape> {
        let rounds: Vec<Vec<Vector3<f64>>> = match solid {
            Solid::Block { .. } => {
                let c = corner_points(solid);
                let edges = (0..8_usize).flat_map(|i| {
                    let ends = [1, 2, 4].map(|bit| (i, i | bit));
                    ends.into_iter().filter(|(a, b)| a != b)
                });
                edges.map(|(a, b)| vec![c[a], c[b]]).collect()
            }
            // A tube without end, at the height of the base.
            Solid::Cylinder { pose, radius, .. } => {
                let axes = [Vector3::x(), Vector3::y()].map(|axis| pose.rotation * axis);
                let along = pose.rotation * Vector3::z();
                let middle = pose.translation.vector;
                let foot = middle - along * along.dot(&middle);
                let mut round = circle(foot, *radius, axes);
                round.extend(round.first().copied());
                vec![round]
            }
            _ => Vec::new(),
        };
        let seen = rounds.iter().filter_map(|points| {
            let points: Option<Vec<[f64; 2]>> =
                points.iter().map(|p| self.camera.point(p).map(|p| p.map(|v| v * MM))).collect();
            points.map(Shape::Line)
        });
        seen.collect()
    }

    /// A height as a line across a view from the side.
    fn level(&self, height: f64) -> Option<Shape> {
        let up = self.camera.flat(&Vector3::z());
        if !self.camera.is_flat() || up[1] < 0.5 {
            return None;
        }
        let [[left, right], _] = self.extent;
        let reach = right - left;
        Some(Shape::Line([left - reach, right + reach].map(|x| [x * MM, height * MM]).to_vec()))
    }

    /// What lies behind a plane: half of the view where it is seen edge-on, else the piece of the
    /// plane within the box around the scene. `None` where it is seen face-on.
    fn half_space(&self, point: &Vector3<f64>, normal: &Unit<Vector3<f64>>) -> Option<Vec<[f64; 2]>> {
        let across = self.camera.flat(normal);
        let length = across[0].hypot(across[1]);
        if !self.camera.is_flat() || (1e-6..1.0 - 1e-6).contains(&length) {
            return hull_of(&self.slice(point, normal), self.camera);
        }
        if length < 0.5 {
            return None;
        }
        let at = self.camera.flat(point);
        let out = |p: &[f64; 2]| across[0] * (p[0] - at[0]) + across[1] * (p[1] - at[1]);
        let [x, y] = self.extent.map(|[a, b]| [2.0 * a - b, 2.0 * b - a]);
        let around = [[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]];
        let mut kept = Vec::new();
        for (i, here) in around.iter().enumerate() {
            let before = &around[(i + 3) % 4];
            let (a, b) = (out(before), out(here));
            if (a > 0.0) != (b > 0.0) {
                let t = a / (a - b);
                kept.push([0, 1].map(|k| before[k] + t * (here[k] - before[k])));
            }
            if b <= 0.0 {
                kept.push(*here);
            }
        }
        (kept.len() > 2).then_some(kept)
    }

    /// Where a plane meets the edges of the box around the scene.
    fn slice(&self, point: &Vector3<f64>, normal: &Unit<Vector3<f64>>) -> Vec<Vector3<f64>> {
        let corners = self.stage.corners();
        let mut points = Vec::new();
        for i in 0..8_usize {
            for bit in [1, 2, 4] {
                if i & bit != 0 {
                    continue;
                }
                let (p, q) = (corners[i], corners[i | bit]);
                let (a, b) = ((p - point).dot(normal), (q - point).dot(normal));
                if (a > 0.0) != (b > 0.0) {
                    points.push(p + (q - p) * (a / (a - b)));
                }
            }
        }
        points
    }

    /// A name, where this view shows it.
    fn label(&self, name: &Name) -> Option<Label> {
        let [x, y] = self.extent;
        let inside = |p: &[f64; 2]| x[0] <= p[0] && p[0] <= x[1] && y[0] <= p[1] && p[1] <= y[1];
        let at = self.camera.point(&name.at).filter(inside);
        let (at, text, cluster) = match name.shown {
            Shown::Inside => (at?, name.text.clone(), ""),
            Shown::Cluster(cluster) => (at?, name.text.clone(), cluster),
            Shown::Arrow => {
                let (at, foot) = (at?, self.camera.point(&Vector3::zeros())?);
                let long = (at[0] - foot[0]).hypot(at[1] - foot[1]) > SHORT * self.stage.size();
                long.then(|| (at, name.text.clone(), ""))?
            }
            Shown::Plane(normal) => {
                let [a, b] = self.camera.flat(&normal);
                let seen = !self.camera.is_flat() || a.hypot(b) > 1e-6;
                seen.then_some((at?, name.text.clone(), ""))?
            }
            Shown::Far(from) => match at {
                Some(at) => (at, name.text.clone(), ""),
                None => (self.edge(&from, &name.at)?, format!("→ {}", name.text), ""),
            },
        };
        Some(Label { at: at.map(|v| v * MM), text, caution: name.caution, cluster: cluster.to_string() })
    }

    /// Where a line from a place inside leaves the view.
    fn edge(&self, from: &Vector3<f64>, to: &Vector3<f64>) -> Option<[f64; 2]> {
        let [a, b] = self.camera.segment(from, to)?;
        let mut t: f64 = 1.0;
        for axis in 0..2 {
            let [low, high] = self.extent[axis];
            let step = b[axis] - a[axis];
            let end = if step > 0.0 { high } else { low };
            if step.abs() > 1e-9 {
                t = t.min((end - a[axis]) / step);
            }
        }
        let t = 0.97 * t.max(0.0);
        Some([0, 1].map(|k| a[k] + t * (b[k] - a[k])))
    }
}

fn area(corners: Vec<[f64; 2]>) -> Shape {
    Shape::Area(corners.into_iter().map(|p| p.map(|v| v * MM)).collect())
}
