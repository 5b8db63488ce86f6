//! Limits on where the tool, the flange and the wrist may be.
//!
//! Each limit is a margin in metres, positive inside, with its derivative, so
//! that every optimiser can respect it during the search.

use super::Slopes;
use super::point_limit::{LimitedPoints, Measure, PointLimit, Side};
use crate::model::limit::{LimitKind, LimitMargin};
use crate::model::load::Load;
use crate::model::observation::{PostureTerms, Setup};
use nalgebra::Vector3;
use std::iter;

/// Bounds in the base frame \[m\]; `None` leaves a limit out.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Limits {
    /// Lower and upper corner of the box for loading point, measuring points and flange.
    pub tool_box: Option<[Vector3<f64>; 2]>,
    /// Lowest z for loading point, measuring points and flange.
    pub floor: Option<f64>,
    /// Radius about axis 1 that these points and the wrist centre stay out of.
    pub keep_out_radius: Option<f64>,
    /// Lowest z of the wrist centre.
    pub wrist_height: Option<f64>,
    /// Shortest and longest rope or cylinder.
    pub rope_length: Option<[f64; 2]>,
}

/// Called with limit, subject, margin and a function that writes the margin's
/// derivative with respect to θ.
type Visitor<'a> = dyn FnMut(LimitKind, usize, f64, &dyn Fn(&mut [f64])) + 'a;

/// A point that moves with the joints below `moved_by`.
struct MovingPoint {
    point: Vector3<f64>,
    moved_by: usize,
}

impl Limits {
    /// True when nothing is limited.
    pub fn is_empty(&self) -> bool {
        *self == Limits::default()
    }

    /// The limits on points, in the order in which every point is held against them.
    pub fn on_points(&self) -> impl Iterator<Item = PointLimit> {
        use LimitedPoints::{All, Tool, Wrist};
        use Measure::{Axis, FromAxis1};
        use Side::{AtLeast, AtMost};
        let of_box = |axis: usize, side, at| Some((LimitKind::ToolBox, Tool, Axis(axis), side, at));
        let sides = self.tool_box.into_iter().flat_map(move |[low, high]| {
            let pair = move |axis| [of_box(axis, AtLeast, low[axis]), of_box(axis, AtMost, high[axis])];
            (0..3).flat_map(pair)
        });
        let others = [
            self.floor.map(|z| (LimitKind::Floor, Tool, Axis(2), AtLeast, z)),
            self.keep_out_radius.map(|r| (LimitKind::KeepOut, All, FromAxis1, AtLeast, r)),
            self.wrist_height.map(|z| (LimitKind::WristHeight, Wrist, Axis(2), AtLeast, z)),
        ];
        let all = sides.chain(others).flatten();
        all.map(|(kind, of, measure, side, at)| PointLimit { kind, of, measure, side, at })
    }

    /// Whether a limit of this kind is there and holds under `load`.
    pub(crate) fn has(&self, kind: LimitKind, load: &Load) -> bool {
        match kind {
            LimitKind::RopeLength => self.rope_length.is_some() && load.has_rope(),
            _ => self.on_points().any(|limit| limit.kind == kind),
        }
    }

    /// The same without one kind of limit.
    #[must_use]
    pub(crate) fn without(&self, kind: LimitKind) -> Self {
        let mut limits = self.clone();
        match kind {
            LimitKind::ToolBox => limits.tool_box = None,
            LimitKind::Floor => limits.floor = None,
            LimitKind::KeepOut => limits.keep_out_radius = None,
            LimitKind::WristHeight => limits.wrist_height = None,
            LimitKind::RopeLength => limits.rope_length = None,
            // These are of shapes, lines and loads.
            LimitKind::Shapes
            | LimitKind::RopeClearance
            | LimitKind::RopeCone
            | LimitKind::Incidence
            | LimitKind::Sight
            | LimitKind::Torque
            | LimitKind::SmallestDisplacement
            | LimitKind::LargestDisplacement => {}
        }
        limits
    }

    /// Number of margins per posture.
    pub(crate) fn count(&self, setup: &Setup) -> usize {
        let tool_points = setup.tool.point_count() + 2;
        let of_points = self.on_points().map(|limit| match limit.of {
            LimitedPoints::Tool => tool_points,
            LimitedPoints::Wrist => 1,
            LimitedPoints::All => tool_points + 1,
        });
        let rope = self.has(LimitKind::RopeLength, &setup.load);
        of_points.sum::<usize>() + if rope { 2 } else { 0 }
    }

    /// All margins of one posture with their names, in a fixed order.
    pub(crate) fn margins(&self, setup: &Setup, terms: &PostureTerms) -> Vec<LimitMargin> {
        let mut out = Vec::with_capacity(self.count(setup));
        let names = subject_names(setup);
        self.visit(setup, terms, &mut |kind, subject, margin, _| {
            out.push(LimitMargin { kind, point: names[subject].clone(), load: None, margin });
        });
        out
    }

    /// Writes the margins of one posture to `values`, and their derivatives.
    pub(crate) fn evaluate(&self, setup: &Setup, terms: &PostureTerms, values: &mut [f64], mut slopes: Slopes<'_>) {
        let n = setup.robot.joint_count();
        let mut at = 0;
        self.visit(setup, terms, &mut |_, _, margin, derivative| {
            values[at] = margin;
            if let Some(row) = slopes.row(at, n) {
                derivative(row);
            }
            at += 1;
        });
    }

    /// The smallest margin of one posture, infinite without limits.
    pub(crate) fn least(&self, setup: &Setup, terms: &PostureTerms) -> f64 {
        let mut least = f64::INFINITY;
        self.visit(setup, terms, &mut |_, _, margin, _| least = least.min(margin));
        least
    }

    fn visit(&self, setup: &Setup, terms: &PostureTerms, each: &mut Visitor<'_>) {
        let n = setup.robot.joint_count();
        let frames = terms.frames();
        let flange = frames.flange().translation.vector;
        let points = iter::once(&terms.loading_point).chain(&terms.measuring_points);
        let points = points.chain([&flange]);
        let mut subjects: Vec<MovingPoint> = points.map(|p| MovingPoint { point: *p, moved_by: n }).collect();
        let tool_points = subjects.len();
        // The wrist centre is moved by the joints before the one whose axis carries it.
        subjects.push(MovingPoint { point: frames.wrist_centre(), moved_by: n.saturating_sub(2) });
        let limits: Vec<PointLimit> = self.on_points().collect();

        let direction = |subject: &MovingPoint, along: Vector3<f64>| {
            let (point, moved_by) = (subject.point, subject.moved_by);
            move |gradient: &mut [f64]| {
                for (k, g) in gradient.iter_mut().enumerate() {
                    *g = if k < moved_by { frames.column(k, &point).dot(&along) } else { 0.0 };
                }
            }
        };

        for (s, subject) in subjects.iter().enumerate() {
            for limit in &limits {
                if !limit.holds_for(s < tool_points) {
                    continue;
                }
                let across = || {
                    let axis = frames.axes()[0];
                    let offset = subject.point - frames.origins()[0];
                    offset - axis * axis.dot(&offset)
                };
                let value = match limit.measure {
                    Measure::Axis(axis) => subject.point[axis],
                    Measure::FromAxis1 => across().norm(),
                };
                let margin = match limit.side {
                    Side::AtLeast => value - limit.at,
                    Side::AtMost => limit.at - value,
                };
                each(limit.kind, s, margin, &|gradient| {
                    let along = match limit.measure {
                        Measure::Axis(axis) => Vector3::ith(axis, 1.0),
                        Measure::FromAxis1 if value > 0.0 => across() / value,
                        Measure::FromAxis1 => Vector3::zeros(),
                    };
                    let along = if limit.side == Side::AtMost { -along } else { along };
                    direction(subject, along)(gradient);
                });
            }
        }
        if let (Some([shortest, longest]), Load::Rope { anchor, .. }) = (self.rope_length, &setup.load) {
            let rope = terms.loading_point - anchor;
            let length = rope.norm();
            let unit = if length > 0.0 { rope / length } else { Vector3::zeros() };
            let s = subjects.len();
            each(LimitKind::RopeLength, s, length - shortest, &direction(&subjects[0], unit));
            each(LimitKind::RopeLength, s, longest - length, &direction(&subjects[0], -unit));
        }
    }
}

/// Names in the order of the subjects of [`Limits::visit`].
fn subject_names(setup: &Setup) -> Vec<String> {
    let mut names = vec!["loading point".to_string()];
    names.extend(setup.tool.measuring_points.iter().map(|p| format!("measuring point {}", p.name)));
    names.extend(["flange", "wrist centre", setup.load.line()].map(String::from));
    names
}
