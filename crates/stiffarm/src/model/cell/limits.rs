//! Limits on where the tool, the flange and the wrist may be.
//!
//! Each limit is a margin in metres, positive inside, with its derivative, so
//! that every optimiser can respect it during the search.

use super::Slopes;
use super::point_limit::{LimitedPoints, Measure, PointLimit, Side};
use crate::model::kinematics::Frames;
use crate::model::limit::{LimitKind, LimitMargin};
use crate::model::load::Load;
use crate::model::observation::{PostureTerms, Setup};
use nalgebra::Vector3;

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

/// The derivative of a margin of a point that moves with the joints below `moved_by`: what moves it `along` counts.
struct PointSlope<'a> {
    frames: &'a Frames,
    point: Vector3<f64>,
    moved_by: usize,
    along: Vector3<f64>,
}

impl PointSlope<'_> {
    /// With respect to θ.
    fn write_to(&self, gradient: &mut [f64]) {
        for (k, g) in gradient.iter_mut().enumerate() {
            *g = if k < self.moved_by { self.frames.column(k, &self.point).dot(&self.along) } else { 0.0 };
        }
    }
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
        let on_points: Vec<PointLimit> = self.on_points().collect();
        self.visit(&on_points, setup, terms, |kind, subject, margin, _| {
            out.push(LimitMargin { kind, point: names[subject].clone(), load: None, margin });
        });
        out
    }

    /// Writes the margins of one posture to `values`, and their derivatives; `on_points` are the limits
    /// [on points](Self::on_points).
    pub(crate) fn evaluate(
        &self,
        on_points: &[PointLimit],
        setup: &Setup,
        terms: &PostureTerms,
        values: &mut [f64],
        mut slopes: Slopes<'_>,
    ) {
        let n = setup.robot.joint_count();
        let mut at = 0;
        self.visit(on_points, setup, terms, |_, _, margin, slope| {
            values[at] = margin;
            if let Some(row) = slopes.row(at, n) {
                slope.write_to(row);
            }
            at += 1;
        });
    }

    /// The smallest margin of one posture, infinite without limits; `on_points` are the limits
    /// [on points](Self::on_points).
    pub(crate) fn least(&self, on_points: &[PointLimit], setup: &Setup, terms: &PostureTerms) -> f64 {
        let mut least = f64::INFINITY;
        self.visit(on_points, setup, terms, |_, _, margin, _| least = least.min(margin));
        least
    }

    /// Calls `each` with limit, number of the subject, margin and derivative, subject by subject.
    fn visit(
        &self,
        on_points: &[PointLimit],
        setup: &Setup,
        terms: &PostureTerms,
        mut each: impl FnMut(LimitKind, usize, f64, PointSlope<'_>),
    ) {
        let n = setup.robot.joint_count();
        let frames = terms.frames();
        let (axis, origin) = (frames.axes()[0], frames.origins()[0]);
        let measuring_points = terms.measuring_points();
        let tool_points = measuring_points.len() + 2;
        for s in 0..=tool_points {
            let is_tool_point = s < tool_points;
            let point = match s {
                0 => *terms.loading_point(),
                s if s <= measuring_points.len() => measuring_points[s - 1],
                _ if is_tool_point => frames.flange().translation.vector,
                _ => frames.wrist_centre(),
            };
            // The wrist centre is moved by the joints before the one whose axis carries it.
            let moved_by = if is_tool_point { n } else { n.saturating_sub(2) };
            for limit in on_points {
                if !limit.holds_for(is_tool_point) {
                    continue;
                }
                let (value, along) = match limit.measure {
                    Measure::Axis(axis) => (point[axis], Vector3::ith(axis, 1.0)),
                    Measure::FromAxis1 => {
                        let offset = point - origin;
                        let across = offset - axis * axis.dot(&offset);
                        let distance = across.norm();
                        let along = if distance > 0.0 { across / distance } else { Vector3::zeros() };
                        (distance, along)
                    }
                };
                let (margin, along) = match limit.side {
                    Side::AtLeast => (value - limit.at, along),
                    Side::AtMost => (limit.at - value, -along),
                };
                each(limit.kind, s, margin, PointSlope { frames, point, moved_by, along });
            }
        }
        if let (Some([shortest, longest]), Load::Rope { anchor, .. }) = (self.rope_length, &setup.load) {
            let point = *terms.loading_point();
            let rope = point - anchor;
            let length = rope.norm();
            let unit = if length > 0.0 { rope / length } else { Vector3::zeros() };
            let s = tool_points + 1;
            let along = |along: Vector3<f64>| PointSlope { frames, point, moved_by: n, along };
            each(LimitKind::RopeLength, s, length - shortest, along(unit));
            each(LimitKind::RopeLength, s, longest - length, along(-unit));
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
