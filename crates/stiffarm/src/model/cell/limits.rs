//! Limits on where the tool, the flange and the wrist may be.
//!
//! Each limit is a margin in metres, positive inside, with its derivative, so
//! that every optimiser can respect it during the search.

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

/// Called with limit, subject, margin and a function that writes the margin's
/// derivative with respect to θ.
type Visitor<'a> = dyn FnMut(LimitKind, usize, f64, &dyn Fn(&mut [f64])) + 'a;

/// A point that moves with the joints below `moved_by`.
struct Subject {
    point: Vector3<f64>,
    moved_by: usize,
}

impl Limits {
    /// True when nothing is limited.
    pub fn is_empty(&self) -> bool {
        *self == Limits::default()
    }

    /// Number of margins per posture.
    pub(crate) fn count(&self, setup: &Setup) -> usize {
        let tool_points = setup.tool.point_count() + 2;
        let mut count = 0;
        if self.tool_box.is_some() {
            count += 6 * tool_points;
        }
        if self.floor.is_some() {
            count += tool_points;
        }
        if self.keep_out_radius.is_some() {
            count += tool_points + 1;
        }
        if self.wrist_height.is_some() {
            count += 1;
        }
        if self.rope_length.is_some() && matches!(setup.load, Load::Rope { .. }) {
            count += 2;
        }
        count
    }

    /// All margins of one posture with their names, in a fixed order.
    pub(crate) fn margins(&self, setup: &Setup, terms: &PostureTerms) -> Vec<LimitMargin> {
        let mut out = Vec::with_capacity(self.count(setup));
        let names = subject_names(setup);
        self.visit(setup, terms, &mut |kind, subject, margin, _| {
            out.push(LimitMargin {
                kind,
                point: names[subject].clone(),
                load: None,
                margin,
            });
        });
        out
    }

    /// Writes the margins of one posture to `values` and, where asked, their
    /// derivatives with respect to θ to `gradients` (row per margin, n long).
    pub(crate) fn evaluate(
        &self,
        setup: &Setup,
        terms: &PostureTerms,
        values: &mut [f64],
        mut gradients: Option<&mut [f64]>,
    ) {
        let n = setup.robot.joint_count();
        let mut at = 0;
        self.visit(setup, terms, &mut |_, _, margin, derivative| {
            values[at] = margin;
            if let Some(gradients) = gradients.as_deref_mut() {
                derivative(&mut gradients[at * n..(at + 1) * n]);
            }
            at += 1;
        });
    }

    fn visit(&self, setup: &Setup, terms: &PostureTerms, each: &mut Visitor<'_>) {
        let n = setup.robot.joint_count();
        let frames = terms.frames();
        let mut subjects = vec![Subject {
            point: terms.loading_point,
            moved_by: n,
        }];
        subjects.extend(terms.measuring_points.iter().map(|p| Subject {
            point: *p,
            moved_by: n,
        }));
        subjects.push(Subject {
            point: frames.flange().translation.vector,
            moved_by: n,
        });
        let tool_points = subjects.len();
        // The wrist centre is moved by the joints before the one whose axis carries it.
        subjects.push(Subject {
            point: frames.wrist_centre(),
            moved_by: n.saturating_sub(2),
        });

        let direction = |subject: &Subject, along: Vector3<f64>| {
            let (point, moved_by) = (subject.point, subject.moved_by);
            move |gradient: &mut [f64]| {
                for (k, g) in gradient.iter_mut().enumerate() {
                    *g = if k < moved_by {
                        frames.column(k, &point).dot(&along)
                    } else {
                        0.0
                    };
                }
            }
        };

        for (s, subject) in subjects.iter().enumerate() {
            let is_tool_point = s < tool_points;
            if let (Some([low, high]), true) = (&self.tool_box, is_tool_point) {
                for axis in 0..3 {
                    let unit = Vector3::ith(axis, 1.0);
                    each(
                        LimitKind::ToolBox,
                        s,
                        subject.point[axis] - low[axis],
                        &direction(subject, unit),
                    );
                    each(
                        LimitKind::ToolBox,
                        s,
                        high[axis] - subject.point[axis],
                        &direction(subject, -unit),
                    );
                }
            }
            if let (Some(floor), true) = (self.floor, is_tool_point) {
                each(
                    LimitKind::Floor,
                    s,
                    subject.point.z - floor,
                    &direction(subject, Vector3::z()),
                );
            }
            if let Some(radius) = self.keep_out_radius {
                let axis = frames.axes()[0];
                let offset = subject.point - frames.origins()[0];
                let across = offset - axis * axis.dot(&offset);
                let distance = across.norm();
                let unit = if distance > 0.0 {
                    across / distance
                } else {
                    Vector3::zeros()
                };
                each(
                    LimitKind::KeepOut,
                    s,
                    distance - radius,
                    &direction(subject, unit),
                );
            }
            if let (Some(height), false) = (self.wrist_height, is_tool_point) {
                each(
                    LimitKind::WristHeight,
                    s,
                    subject.point.z - height,
                    &direction(subject, Vector3::z()),
                );
            }
        }
        if let (Some([shortest, longest]), Load::Rope { anchor, .. }) =
            (self.rope_length, &setup.load)
        {
            let rope = terms.loading_point - anchor;
            let length = rope.norm();
            let unit = if length > 0.0 {
                rope / length
            } else {
                Vector3::zeros()
            };
            let s = subjects.len();
            each(
                LimitKind::RopeLength,
                s,
                length - shortest,
                &direction(&subjects[0], unit),
            );
            each(
                LimitKind::RopeLength,
                s,
                longest - length,
                &direction(&subjects[0], -unit),
            );
        }
    }
}

/// Names in the order of the subjects of [`Limits::visit`].
fn subject_names(setup: &Setup) -> Vec<String> {
    let mut names = vec!["loading point".to_string()];
    names.extend(
        setup
            .tool
            .measuring_points
            .iter()
            .map(|p| format!("measuring point {}", p.name)),
    );
    names.extend(["flange", "wrist centre", setup.load.line()].map(String::from));
    names
}
