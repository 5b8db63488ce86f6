//! What a picture shows of a cell, in the base frame \[m\]: the same for every view.

use crate::figure::drawing::Tone;
use crate::scene::arm::Arm;
use crate::scene::corners::circle;
use crate::scene::limits::{BEAMS, DISPLACEMENT, PLACES, ROPE};
use crate::scene::stage::Stage;
use crate::scene::{Body, BodyKind, Scene};
use stiffarm::model::cell::LimitKind;
use stiffarm::model::shape::Solid;
use stiffarm::nalgebra::{Isometry3, Translation3, Unit, UnitQuaternion, Vector3};

/// Length of the base frame's axes and of a rope's cone, as shares of the picture.
const TRIAD: f64 = 0.1;
const CONE: f64 = 0.22;

/// What is drawn first lies behind the rest.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Layer {
    Ground,
    Bounds,
    /// Sorted by how near they are.
    Bodies,
    Others,
    Lines,
    Points,
}

/// The shape of an element in space.
#[derive(Debug, Clone)]
pub(super) enum Geometry {
    Solid(Solid),
    /// The convex hull of points.
    Hull(Vec<Vector3<f64>>),
    Line(Vec<Vector3<f64>>),
    Arrow([Vector3<f64>; 2]),
    Point(Vector3<f64>),
    /// A height, seen from the side.
    Level(f64),
}

/// Something to be drawn and how it looks.
#[derive(Debug, Clone)]
pub(super) struct Element {
    pub geometry: Geometry,
    pub tone: Tone,
    pub caution: bool,
    pub layer: Layer,
}

/// A name in space.
#[derive(Debug, Clone)]
pub(super) struct Name {
    pub at: Vector3<f64>,
    pub text: String,
    pub caution: bool,
    pub shown: Shown,
}

/// Where a name is shown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Shown {
    /// Where its place is in view.
    Inside,
    /// Joined with others of its cluster.
    Cluster(&'static str),
    /// Where its arrow from the base is long enough to be seen.
    Arrow,
    /// Where the plane of this normal is not seen face-on.
    Plane(Unit<Vector3<f64>>),
    /// At the edge of the view, looked at from here, where its place is outside.
    Far(Vector3<f64>),
}

/// All that is drawn of a scene with one of its postures in full, or none.
pub(super) struct Elements<'a> {
    scene: &'a Scene,
    stage: &'a Stage,
    full: Option<&'a Arm<'a>>,
    pub elements: Vec<Element>,
    pub names: Vec<Name>,
}

impl<'a> Elements<'a> {
    /// What stands around; `others` are numbers of postures that are lines, with whether they violate a limit.
    pub(super) fn of(
        scene: &'a Scene,
        stage: &'a Stage,
        full: Option<&'a Arm<'a>>,
        others: impl Iterator<Item = (usize, &'a Arm<'a>, bool)>,
    ) -> Self {
        let mut all = Elements { scene, stage, full, elements: Vec::new(), names: Vec::new() };
        all.add_surroundings();
        others.for_each(|(number, arm, red)| all.add_other(number, arm, red));
        if let Some(arm) = full {
            all.add_full(arm);
        }
        all
    }

    fn add(&mut self, layer: Layer, tone: Tone, geometry: Geometry, caution: bool) {
        self.elements.push(Element { geometry, tone, caution, layer });
    }

    fn name(&mut self, at: Vector3<f64>, text: &str, caution: bool, shown: Shown) {
        self.names.push(Name { at, text: text.to_string(), caution, shown });
    }

    /// A point, with its name where it is red.
    fn add_point(&mut self, tone: Tone, at: Vector3<f64>, name: &str, red: bool, shown: Shown) {
        self.add(Layer::Points, tone, Geometry::Point(at), red);
        if red {
            self.name(at, name, true, shown);
        }
    }

    fn is_red(&self, body: usize) -> bool {
        self.full.is_some_and(|arm| arm.posture.caution.contains(&body))
    }

    /// A limit, in red where the posture in full violates this kind.
    fn add_bound(&mut self, geometry: Geometry, kind: LimitKind) {
        let red = self.full.is_some_and(|arm| arm.posture.violates(&[kind]));
        self.add(Layer::Bounds, Tone::Bound, geometry, red);
    }

    /// What stands in the cell, its limits and the base frame.
    fn add_surroundings(&mut self) {
        let (scene, stage) = (self.scene, self.stage);
        for (number, body) in scene.parts().filter(|(_, body)| body.kind == BodyKind::Standing) {
            let red = self.is_red(number);
            body.solids.iter().for_each(|solid| self.add_solid(body, *solid, red));
            let mut seen = body.solids.iter().filter_map(|s| Some((stage.middle(s)?, s)));
            if let Some((at, solid)) = seen.next() {
                let shown = match solid {
                    Solid::HalfSpace { normal, .. } => Shown::Plane(*normal),
                    _ => Shown::Inside,
                };
                self.name(at, &body.name, red, shown);
            }
        }
        self.add_limits();
        for anchor in scene.anchors() {
            self.add(Layer::Points, Tone::Fixed, Geometry::Point(anchor), false);
            self.add_cone(anchor);
        }
        for (axis, name) in ["x", "y", "z"].iter().enumerate() {
            let tip = Vector3::ith(axis, TRIAD * stage.size());
            self.add(Layer::Lines, Tone::Triad, Geometry::Arrow([Vector3::zeros(), tip]), false);
            self.name(tip, name, false, Shown::Arrow);
        }
        let from = self.full.map_or(stage.centre(), Arm::loading_point);
        for station in &scene.stations {
            let at = Vector3::from(station.at);
            self.add(Layer::Points, Tone::Ray, Geometry::Point(at), false);
            self.name(at, &station.name, false, Shown::Far(from));
        }
    }

    fn add_limits(&mut self) {
        let limits = &self.scene.limits;
        if let Some(ends) = limits.tool_box {
            let [low, high] = ends.map(Vector3::from);
            let pose = Isometry3::from_parts(Translation3::from((low + high) * 0.5), UnitQuaternion::identity());
            if let Ok(block) = Solid::block(pose, high - low) {
                self.add_bound(Geometry::Solid(block), LimitKind::ToolBox);
            }
        }
        for (kind, height) in limits.levels() {
            self.add_bound(Geometry::Level(height), kind);
        }
        if let Some(keep_out) = &limits.keep_out {
            // Without end as the limit is: far beyond what is seen.
            let (point, axis) = (Vector3::from(keep_out.origin), Vector3::from(keep_out.axis));
            let along = |z: f64| point + axis * (z - point.dot(&axis));
            let (low, high) = (-4.0 * self.stage.size(), 4.0 * self.stage.size());
            if let Ok(tube) = Solid::cylinder(along(low), along(high), keep_out.radius) {
                self.add_bound(Geometry::Solid(tube), LimitKind::KeepOut);
            }
        }
    }

    /// The cone in which the rope's loading device may pull.
    fn add_cone(&mut self, anchor: Vector3<f64>) {
        let Some((axis, angle)) = self.scene.limits.rope_cone else {
            return;
        };
        let length = CONE * self.stage.size();
        let across = axis.cross(&if axis.x.abs() < 0.9 { Vector3::x() } else { Vector3::y() });
        let Some(u) = Unit::try_new(across, 1e-9) else {
            return;
        };
        let v = axis.cross(&u);
        let centre = anchor + axis.into_inner() * (length * angle.cos());
        let mut points = vec![anchor];
        points.extend(circle(centre, length * angle.sin(), [u.into_inner(), v]));
        self.add_bound(Geometry::Hull(points), LimitKind::RopeCone);
    }

    fn add_solid(&mut self, body: &Body, solid: Solid, red: bool) {
        let (layer, tone) = match (solid, body.kind) {
            (Solid::HalfSpace { .. }, _) => (Layer::Ground, Tone::Ground),
            (_, BodyKind::Tool) => (Layer::Bodies, Tone::Attached),
            (_, BodyKind::Standing) => (Layer::Bodies, Tone::Fixed),
            (_, BodyKind::Arm) => (Layer::Bodies, Tone::Body),
        };
        self.add(layer, tone, Geometry::Solid(solid), red);
    }

    /// The arm, its tool, its load and its beams at the posture that is shown in full.
    fn add_full(&mut self, arm: &Arm<'_>) {
        let (scene, posture) = (self.scene, arm.posture);
        for (number, body) in scene.parts().filter(|(_, body)| body.kind != BodyKind::Standing) {
            let red = self.is_red(number);
            arm.placed(body).for_each(|solid| self.add_solid(body, solid, red));
            if let (true, Some(solid)) = (red, arm.placed(body).next()) {
                let middle = self.stage.middle(&solid);
                self.name(middle.unwrap_or_default(), &body.name, true, Shown::Inside);
            }
        }
        for piece in arm.skeleton().windows(2) {
            self.add(Layer::Bodies, Tone::Skeleton, Geometry::Line(piece.to_vec()), false);
        }
        for (at, joint) in arm.joints().zip(&scene.joints) {
            let red = posture.violates_at(&[LimitKind::Torque], joint);
            self.add_point(Tone::Skeleton, at, joint, red, Shown::Cluster("joints"));
        }
        if posture.violates_at(&PLACES, "wrist centre") {
            self.add_point(Tone::Skeleton, arm.wrist_centre(), "wrist centre", true, Shown::Inside);
        }
        for point in arm.measuring_points.iter().chain([&arm.loading_point()]) {
            self.add(Layer::Lines, Tone::Attached, Geometry::Line(vec![arm.flange(), *point]), false);
        }
        let red = posture.violates_at(&PLACES, "flange");
        self.add_point(Tone::Attached, arm.flange(), "flange", red, Shown::Inside);
        for (at, point) in arm.measuring_points.iter().zip(&scene.measuring_points) {
            let place = format!("measuring point {}", point.name);
            let red = posture.violates(&DISPLACEMENT) || posture.violates_at(&PLACES, &place);
            self.add(Layer::Points, Tone::Target, Geometry::Point(*at), red);
            self.name(*at, &point.name, red, Shown::Cluster("measuring points"));
        }
        self.add_loads(arm);
        self.add_beams(arm);
    }

    fn add_loads(&mut self, arm: &Arm<'_>) {
        let red = arm.posture.violates_at(&PLACES, "loading point");
        for (number, (load, at)) in self.scene.loads.iter().zip(&arm.loading_points).enumerate() {
            let anchor = load.anchor.map(Vector3::from);
            let tip = arm.force_tip(number, self.stage.force_length);
            if let Some(anchor) = anchor {
                let rope = Geometry::Line(vec![*at, anchor]);
                self.add(Layer::Lines, Tone::Pull, rope, arm.posture.violates(&ROPE));
            }
            if let Some(tip) = tip {
                self.add(Layer::Lines, Tone::Pull, Geometry::Arrow([*at, tip]), false);
            }
            // A single load has no name.
            let place = anchor.map(|anchor| (anchor, Shown::Inside)).or(tip.map(|tip| (tip, Shown::Arrow)));
            if let Some((place, shown)) = place.filter(|_| !load.name.is_empty()) {
                self.name(place, &load.name, false, shown);
            }
            if !arm.loading_points[..number].contains(at) {
                self.add_point(Tone::Pull, *at, "loading point", red, Shown::Inside);
            }
        }
    }

    /// From each station to what it sees; from the one that sees most also to what is hidden.
    fn add_beams(&mut self, arm: &Arm<'_>) {
        let posture = arm.posture;
        for (number, (station, seen)) in self.scene.stations.iter().zip(&posture.seen).enumerate() {
            for (point, at) in arm.measuring_points.iter().enumerate() {
                let (tone, red) = match (seen.contains(&point), posture.best_station == Some(number)) {
                    (true, _) => (Tone::Ray, false),
                    (false, true) => (Tone::FaintRay, posture.violates(&BEAMS)),
                    (false, false) => continue,
                };
                self.add(Layer::Lines, tone, Geometry::Line(vec![station.at.into(), *at]), red);
            }
        }
    }

    /// The arm of one of several postures as a thin line with its marker, ringed in red where a limit is violated.
    fn add_other(&mut self, number: usize, arm: &Arm<'_>, red: bool) {
        let mut line = arm.skeleton();
        line.push(arm.loading_point());
        self.add(Layer::Others, Tone::Item(number), Geometry::Line(line), false);
        self.add(Layer::Points, Tone::Item(number), Geometry::Point(arm.loading_point()), red);
    }
}
