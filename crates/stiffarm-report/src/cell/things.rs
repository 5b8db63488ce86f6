//! What a picture shows of a cell, in the base frame \[m\]: the same for every view.

use super::cautions::Cautions;
use super::stage::{Stage, arm, stands};
use crate::figure::drawing::Tone;
use stiffarm::model::cell::{Cell, LimitKind};
use stiffarm::model::load::Load;
use stiffarm::model::observation::PostureTerms;
use stiffarm::model::scene::{Carrier, Part};
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

/// Something to be drawn.
#[derive(Debug, Clone)]
pub(super) enum What {
    Solid(Solid),
    /// The convex hull of points.
    Hull(Vec<Vector3<f64>>),
    Line(Vec<Vector3<f64>>),
    Arrow([Vector3<f64>; 2]),
    Point(Vector3<f64>),
    /// A height, seen from the side.
    Level(f64),
}

/// Something and how it looks.
#[derive(Debug, Clone)]
pub(super) struct Thing {
    pub what: What,
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

/// All that is drawn.
#[derive(Debug, Clone, Default)]
pub(super) struct Things {
    pub things: Vec<Thing>,
    pub names: Vec<Name>,
}

impl Things {
    fn add(&mut self, layer: Layer, tone: Tone, what: What, caution: bool) {
        self.things.push(Thing { what, tone, caution, layer });
    }

    fn name(&mut self, at: Vector3<f64>, text: &str, caution: bool, shown: Shown) {
        self.names.push(Name { at, text: text.to_string(), caution, shown });
    }

    /// What stands in the cell, its limits and the base frame.
    /// What is outside of a view is looked at from `from`.
    pub(super) fn add_surroundings(&mut self, cell: &Cell, stage: &Stage, cautions: &Cautions, from: Vector3<f64>) {
        for (number, part) in cell.scene.parts().iter().enumerate() {
            if stands(part) {
                let red = cautions.parts.get(number).is_some_and(|red| *red);
                self.add_part(part, &Isometry3::identity(), red);
                let mut seen = part.solids.iter().filter_map(|s| Some((stage.middle(s)?, s)));
                if let Some((at, solid)) = seen.next() {
                    let shown = match solid {
                        Solid::HalfSpace { normal, .. } => Shown::Plane(*normal),
                        _ => Shown::Inside,
                    };
                    self.name(at, &part.name, red, shown);
                }
            }
        }
        self.add_limits(cell, stage, cautions);
        for anchor in cell.setup.load.anchors() {
            self.add(Layer::Points, Tone::Fixed, What::Point(*anchor), false);
            self.add_cone(cell, stage, anchor, cautions);
        }
        for (axis, name) in ["x", "y", "z"].iter().enumerate() {
            let tip = Vector3::ith(axis, TRIAD * stage.size());
            let arrow = What::Arrow([Vector3::zeros(), tip]);
            self.add(Layer::Lines, Tone::Triad, arrow, false);
            self.name(tip, name, false, Shown::Arrow);
        }
        if let Some(sight) = cell.scene.sight() {
            for station in &sight.stations {
                let at = What::Point(station.position);
                self.add(Layer::Points, Tone::Ray, at, false);
                self.name(station.position, &station.name, false, Shown::Far(from));
            }
        }
    }

    fn add_limits(&mut self, cell: &Cell, stage: &Stage, cautions: &Cautions) {
        let bound = |things: &mut Things, what, kind| {
            things.add(Layer::Bounds, Tone::Bound, what, cautions.has(kind));
        };
        let limits = &cell.limits;
        if let Some([low, high]) = &limits.tool_box {
            let pose = Isometry3::from_parts(Translation3::from((low + high) * 0.5), UnitQuaternion::identity());
            if let Ok(block) = Solid::block(pose, high - low) {
                bound(self, What::Solid(block), LimitKind::ToolBox);
            }
        }
        for limit in limits.on_points() {
            if let Some(height) = limit.level() {
                bound(self, What::Level(height), limit.kind);
            }
        }
        if let Some(radius) = limits.keep_out_radius {
            // Without end as the limit is: far beyond what is seen.
            let (point, axis) = stage.first_axis();
            let along = |z: f64| point + axis.into_inner() * (z - point.dot(&axis));
            let (low, high) = (-4.0 * stage.size(), 4.0 * stage.size());
            if let Ok(tube) = Solid::cylinder(along(low), along(high), radius) {
                bound(self, What::Solid(tube), LimitKind::KeepOut);
            }
        }
    }

    /// The cone in which the rope's loading device may pull.
    fn add_cone(&mut self, cell: &Cell, stage: &Stage, anchor: &Vector3<f64>, red: &Cautions) {
        let Some((axis, angle)) = cell.scene.rope().and_then(|rope| rope.cone) else {
            return;
        };
        let length = CONE * stage.size();
        let across = axis.cross(&if axis.x.abs() < 0.9 { Vector3::x() } else { Vector3::y() });
        let Some(u) = Unit::try_new(across, 1e-9) else {
            return;
        };
        let v = axis.cross(&u);
        let centre = anchor + axis.into_inner() * (length * angle.cos());
        let rim = super::outline::circle(centre, length * angle.sin(), [u.into_inner(), v]);
        let mut points = vec![*anchor];
        points.extend(rim);
        let red = red.has(LimitKind::RopeCone);
        self.add(Layer::Bounds, Tone::Bound, What::Hull(points), red);
    }

    fn add_part(&mut self, part: &Part, pose: &Isometry3<f64>, red: bool) {
        for solid in &part.solids {
            let (layer, tone) = match (solid, part.carrier) {
                (Solid::HalfSpace { .. }, _) => (Layer::Ground, Tone::Ground),
                (_, Carrier::Flange) => (Layer::Bodies, Tone::Attached),
                (_, Carrier::World) if stands(part) => (Layer::Bodies, Tone::Fixed),
                _ => (Layer::Bodies, Tone::Body),
            };
            self.add(layer, tone, What::Solid(solid.placed(pose)), red);
        }
    }

    /// The arm, its tool, its load and its beams at the posture that is shown in full.
    pub(super) fn add_shown(&mut self, cell: &Cell, stage: &Stage, terms: &PostureTerms, cautions: &Cautions) {
        let frames = terms.frames();
        for (number, part) in cell.scene.parts().iter().enumerate() {
            if !stands(part) {
                let red = cautions.parts.get(number).is_some_and(|red| *red);
                let pose = part.carrier.pose(frames);
                self.add_part(part, &pose, red);
                if let (true, Some(solid)) = (red, part.solids.first()) {
                    let middle = stage.middle(&solid.placed(&pose));
                    self.name(middle.unwrap_or_default(), &part.name, true, Shown::Inside);
                }
            }
        }
        let arm = arm(terms);
        for piece in arm.windows(2) {
            let line = What::Line(piece.to_vec());
            self.add(Layer::Bodies, Tone::Skeleton, line, false);
        }
        let joints = cell.setup.robot.joints().iter().zip(&cautions.joints);
        for (origin, (joint, red)) in frames.origins().iter().zip(joints) {
            self.add(Layer::Points, Tone::Skeleton, What::Point(*origin), *red);
            if *red {
                self.name(*origin, &joint.name, true, Shown::Cluster("joints"));
            }
        }
        if cautions.wrist {
            let wrist = What::Point(frames.wrist_centre());
            self.add(Layer::Points, Tone::Skeleton, wrist, true);
            self.name(frames.wrist_centre(), "wrist centre", true, Shown::Inside);
        }
        let flange = frames.flange().translation.vector;
        let points = terms.measuring_points();
        for point in points.iter().chain([terms.loading_point()]) {
            let line = What::Line(vec![flange, *point]);
            self.add(Layer::Lines, Tone::Attached, line, false);
        }
        self.add(Layer::Points, Tone::Attached, What::Point(flange), cautions.flange);
        if cautions.flange {
            self.name(flange, "flange", true, Shown::Inside);
        }
        let names = cell.setup.tool.measuring_points.iter();
        for ((point, name), red) in points.iter().zip(names).zip(&cautions.measuring) {
            self.add(Layer::Points, Tone::Target, What::Point(*point), *red);
            self.name(*point, &name.name, *red, Shown::Cluster("measuring points"));
        }
        self.add_load(cell, stage, terms, cautions);
        self.add_beams(cell, terms, cautions);
    }

    fn add_load(&mut self, cell: &Cell, stage: &Stage, terms: &PostureTerms, red: &Cautions) {
        let mut drawn: Vec<Vector3<f64>> = Vec::new();
        let cases = cell.setup.load.cases();
        for (number, setup) in cell.setup.cases().iter().enumerate() {
            let at = terms.frames().point(&setup.tool.loading_point);
            let name = cases.get(number).map(|case| case.name.as_str());
            if let Load::Rope { anchor, .. } = &setup.load {
                let rope = What::Line(vec![at, *anchor]);
                self.add(Layer::Lines, Tone::Pull, rope, red.rope);
                if let Some(name) = name {
                    self.name(*anchor, name, false, Shown::Inside);
                }
            }
            if let Some(tip) = stage.force_tip(setup, terms.frames()) {
                self.add(Layer::Lines, Tone::Pull, What::Arrow([at, tip]), false);
                let is_rope = matches!(setup.load, Load::Rope { .. });
                if let (Some(name), false) = (name, is_rope) {
                    self.name(tip, name, false, Shown::Arrow);
                }
            }
            if !drawn.contains(&at) {
                drawn.push(at);
                let point = What::Point(at);
                self.add(Layer::Points, Tone::Pull, point, red.loading_point);
                if red.loading_point {
                    self.name(at, "loading point", true, Shown::Inside);
                }
            }
        }
    }

    /// From each station to what it sees; from the one that sees most also to what is hidden.
    fn add_beams(&mut self, cell: &Cell, terms: &PostureTerms, cautions: &Cautions) {
        let (Some(sight), Some(best)) = (cell.scene.sight(), cell.scene.seen(terms)) else {
            return;
        };
        for seen in cell.scene.seen_by_each(terms) {
            let from = sight.stations[seen.station].position;
            for (number, point) in terms.measuring_points().iter().enumerate() {
                let is_seen = seen.points.contains(&number);
                let is_best = seen.station == best.station;
                let (tone, red) = match (is_seen, is_best) {
                    (true, _) => (Tone::Ray, false),
                    (false, true) => (Tone::FaintRay, cautions.beams),
                    (false, false) => continue,
                };
                let line = What::Line(vec![from, *point]);
                self.add(Layer::Lines, tone, line, red);
            }
        }
    }

    /// The arm of one of several postures as a thin line with its marker, ringed in red where a limit is violated.
    pub(super) fn add_other(&mut self, number: usize, terms: &PostureTerms, red: bool) {
        let mut line = arm(terms);
        line.push(*terms.loading_point());
        let tone = Tone::Item(number);
        self.add(Layer::Others, tone, What::Line(line), false);
        let at = What::Point(*terms.loading_point());
        self.add(Layer::Points, tone, at, red);
    }
}
