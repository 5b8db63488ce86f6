//! What a picture shows of a cell as marks of a view \[mm\].

use super::camera::Camera;
use super::elements::{Element, Elements, Geometry, Layer, Name, Shown};
use super::outline::{hull_of, outline};
use crate::figure::Axis;
use crate::figure::drawing::{Label, Mark, Shape, Tone, View};
use crate::scene::corners::{circle, corner_points, edges};
use crate::scene::stage::Stage;
use stiffarm::model::shape::Solid;
use stiffarm::nalgebra::{Unit, Vector3};

/// Room around what must be seen, as a share of its size.
const ROOM: f64 = 0.04;
/// The arm's axes lie within its shapes: so much farther than they are, as a share of the scene.
const WITHIN: f64 = 0.08;
/// Bodies that differ by less in how near they are \[m\] are drawn from the base to the tool.
const AS_NEAR: f64 = 1e-5;
/// Arrows shorter than this share of the scene are left out.
const SHORT: f64 = 0.02;
const MM: f64 = 1e3;

/// A view of the elements.
pub(super) fn view(title: &str, axes: Option<[&str; 2]>, camera: &Camera, stage: &Stage, all: &Elements<'_>) -> View {
    let extent = extent(camera, stage);
    let draws = Draws { camera, stage, extent };
    let mut order: Vec<&Element> = all.elements.iter().collect();
    order.sort_by_cached_key(|element| (element.layer, draws.nearness(element)));
    View {
        title: title.into(),
        axes: axes.map(|names| names.map(|name| Axis::linear(name, "mm"))),
        extent: extent.map(|ends| ends.map(|v| v * MM)),
        marks: order.iter().flat_map(|element| draws.marks(element)).collect(),
        labels: all.names.iter().filter_map(|n| draws.label(n)).collect(),
    }
}

/// What must be seen, with some room.
fn extent(camera: &Camera, stage: &Stage) -> [[f64; 2]; 2] {
    let mut ends = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
    for p in stage.points.iter().filter_map(|p| camera.point(p)) {
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
    /// How near a body is, in steps of [`AS_NEAR`].
    fn nearness(&self, element: &Element) -> i64 {
        let (points, within) = match &element.geometry {
            Geometry::Solid(solid) if element.layer == Layer::Bodies => (corner_points(solid), 0.0),
            Geometry::Line(points) if element.layer == Layer::Bodies => (points.clone(), WITHIN * self.stage.size()),
            _ => return 0,
        };
        let middle = points.iter().sum::<Vector3<f64>>() / points.len().max(1) as f64;
        ((self.camera.nearness(&middle) - within) / AS_NEAR).round() as i64
    }

    fn marks(&self, element: &Element) -> Vec<Mark> {
        let camera = self.camera;
        let shapes: Vec<Shape> = match &element.geometry {
            Geometry::Solid(Solid::HalfSpace { point, normal }) => {
                Vec::from_iter(self.half_space(point, normal).map(Shape::Area))
            }
            Geometry::Solid(solid) if element.tone == Tone::Bound && !camera.is_flat() => self.frame_of(solid),
            Geometry::Solid(solid) => Vec::from_iter(outline(solid, camera).map(Shape::Area)),
            Geometry::Hull(points) => Vec::from_iter(hull_of(points, camera).map(Shape::Area)),
            Geometry::Line(points) if camera.is_flat() => {
                vec![Shape::Line(points.iter().map(|p| camera.flat(p)).collect())]
            }
            Geometry::Line(points) => {
                let pieces = points.windows(2).filter_map(|p| camera.segment(&p[0], &p[1]));
                pieces.map(|piece| Shape::Line(piece.to_vec())).collect()
            }
            Geometry::Arrow([from, to]) => {
                let ends = camera.segment(from, to).filter(|[a, b]| self.is_long(a, b));
                Vec::from_iter(ends.map(Shape::Arrow))
            }
            Geometry::Point(at) => Vec::from_iter(camera.point(at).map(Shape::Point)),
            Geometry::Level(height) => Vec::from_iter(self.level(*height)),
        };
        let marks = shapes.into_iter().map(|shape| Mark::new(in_mm(shape), element.tone));
        marks.map(|mark| mark.with_caution(element.caution)).collect()
    }

    /// True where an arrow is long enough to be seen.
    fn is_long(&self, from: &[f64; 2], to: &[f64; 2]) -> bool {
        (to[0] - from[0]).hypot(to[1] - from[1]) > SHORT * self.stage.size()
    }

    /// Edges of a limit in perspective.
    fn frame_of(&self, solid: &Solid) -> Vec<Shape> {
        let lines: Vec<Vec<Vector3<f64>>> = match solid {
            Solid::Block { .. } => edges(&corner_points(solid)).map(Vec::from).collect(),
            // A tube without end, at the height of the base.
            Solid::Cylinder { pose, radius, .. } => {
                let axes = [Vector3::x(), Vector3::y()].map(|axis| pose.rotation * axis);
                let along = pose.rotation * Vector3::z();
                let middle = pose.translation.vector;
                let mut round = circle(middle - along * along.dot(&middle), *radius, axes);
                round.extend(round.first().copied());
                vec![round]
            }
            _ => Vec::new(),
        };
        let seen = lines.iter().map(|points| points.iter().map(|p| self.camera.point(p)).collect::<Option<Vec<_>>>());
        seen.flatten().map(Shape::Line).collect()
    }

    /// A height as a line across a view from the side.
    fn level(&self, height: f64) -> Option<Shape> {
        let up = self.camera.flat(&Vector3::z());
        if !self.camera.is_flat() || up[1] < 0.5 {
            return None;
        }
        let [[left, right], _] = self.extent;
        let reach = right - left;
        Some(Shape::Line([left - reach, right + reach].map(|x| [x, height]).to_vec()))
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
        // Beyond all that is seen to three sides; the frame cuts it off.
        let far = 2.0 * self.extent.iter().flatten().chain(&at).map(|v| v.abs()).sum::<f64>();
        let corner = |beside: f64, behind: f64| {
            [at[0] - across[1] * beside - across[0] * behind, at[1] + across[0] * beside - across[1] * behind]
        };
        Some(vec![corner(far, 0.0), corner(far, far), corner(-far, far), corner(-far, 0.0)])
    }

    /// Where a plane meets the edges of the box around the scene.
    fn slice(&self, point: &Vector3<f64>, normal: &Unit<Vector3<f64>>) -> Vec<Vector3<f64>> {
        let corners = self.stage.corners();
        let ends = edges(&corners).map(|[p, q]| (p, q, (p - point).dot(normal), (q - point).dot(normal)));
        let crossing = ends.filter(|(.., a, b)| (*a > 0.0) != (*b > 0.0));
        crossing.map(|(p, q, a, b)| p + (q - p) * (a / (a - b))).collect()
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
                self.is_long(&foot, &at).then(|| (at, name.text.clone(), ""))?
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

/// The shape in mm.
fn in_mm(shape: Shape) -> Shape {
    let mm = |p: [f64; 2]| p.map(|v| v * MM);
    match shape {
        Shape::Area(corners) => Shape::Area(corners.into_iter().map(mm).collect()),
        Shape::Line(points) => Shape::Line(points.into_iter().map(mm).collect()),
        Shape::Arrow(ends) => Shape::Arrow(ends.map(mm)),
        Shape::Point(at) => Shape::Point(mm(at)),
    }
}
