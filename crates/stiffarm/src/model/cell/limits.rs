//! Limits on where the tool, the flange and the wrist may be.
//!
//! Each limit is a margin in metres, positive inside, with its derivative, so
//! that every optimiser can respect it during the search.

use super::point_limit::{LimitedPoints, PointBound, PointLimit};
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

    /// The limits on points, in the order in which every point is held against them.
    pub fn on_points(&self) -> impl Iterator<Item = PointLimit> {
        use LimitedPoints::{All, Tool, Wrist};
        use PointBound::{FromAxis1, Highest, Lowest};
        let sides = self.tool_box.into_iter().flat_map(|[low, high]| {
            let pair = move |axis| [Lowest(axis, low[axis]), Highest(axis, high[axis])];
            let sides = (0..3).flat_map(pair);
            sides.map(|side| PointLimit::new(LimitKind::ToolBox, Tool, side))
        });
        let floor = self.floor.map(|z| (LimitKind::Floor, Tool, Lowest(2, z)));
        let keep_out = self.keep_out_radius.map(FromAxis1);
        let keep_out = keep_out.map(|bound| (LimitKind::KeepOut, All, bound));
        let wrist = self.wrist_height.map(|z| Lowest(2, z));
        let wrist = wrist.map(|bound| (LimitKind::WristHeight, Wrist, bound));
        let others = [floor, keep_out, wrist].into_iter().flatten();
        sides.chain(others.map(|(kind, of, bound)| PointLimit::new(kind, of, bound)))
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
            _ => {}
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
            for limit in self.on_points() {
                if !limit.holds_for(s < tool_points) {
                    continue;
                }
                let (margin, along) = match limit.bound {
                    PointBound::Lowest(axis, at) => {
                        (subject.point[axis] - at, Vector3::ith(axis, 1.0))
                    }
                    PointBound::Highest(axis, at) => {
                        (at - subject.point[axis], -Vector3::ith(axis, 1.0))
                    }
                    PointBound::FromAxis1(radius) => {
                        let axis = frames.axes()[0];
                        let offset = subject.point - frames.origins()[0];
                        let across = offset - axis * axis.dot(&offset);
                        let distance = across.norm();
                        let along = match distance > 0.0 {
                            true => across / distance,
                            false => Vector3::zeros(),
                        };
                        (distance - radius, along)
                    }
                };
                each(limit.kind, s, margin, &direction(subject, along));
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::cell::Margins;
    use crate::model::kinematics::Frames;
    use crate::model::robot::{DhConvention, DhRow, Robot};
    use crate::model::scene::Scene;
    use crate::model::tool::{NamedPoint, Tool};
    use nalgebra::{Isometry3, Translation3, UnitQuaternion};

    /// A tilted and shifted arm of `n` joints with general twists and a rope.
    fn setup(n: usize) -> Setup {
        let rows: Vec<DhRow> = (0..n)
            .map(|i| {
                let i = i as f64;
                DhRow {
                    alpha: 0.9 - 0.4 * i,
                    a: 0.3 + 0.1 * i,
                    d: 0.2 * i - 0.3,
                    offset: 0.5 * i,
                }
            })
            .collect();
        let base = Isometry3::from_parts(
            Translation3::new(0.2, -0.1, 0.4),
            UnitQuaternion::from_euler_angles(0.3, -0.2, 0.5),
        );
        let point = |name: &str, position| NamedPoint {
            name: name.to_string(),
            position,
        };
        Setup {
            robot: Robot::from_dh("bent", DhConvention::Modified, &rows, base).unwrap(),
            tool: Tool {
                loading_point: Vector3::new(0.2, -0.1, 0.25),
                measuring_points: vec![
                    point("a", Vector3::new(0.1, 0.2, 0.3)),
                    point("b", Vector3::new(-0.2, 0.0, 0.1)),
                ],
                has_sensor: false,
                series_compliance: None,
            },
            load: Load::Rope {
                anchor: Vector3::new(1.8, -0.4, 0.1),
                magnitude: 500.0,
            },
        }
    }

    fn limits() -> Limits {
        Limits {
            tool_box: Some([Vector3::new(-1.0, -1.1, -0.7), Vector3::new(1.2, 1.3, 1.4)]),
            floor: Some(-0.2),
            keep_out_radius: Some(0.35),
            wrist_height: Some(0.15),
            rope_length: Some([0.8, 3.4]),
        }
    }

    /// Margins and their derivatives at the serial angles `theta`.
    fn at(setup: &Setup, limits: &Limits, theta: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let count = limits.count(setup);
        let mut terms = PostureTerms::new(setup, &vec![0.0; theta.len()], None).unwrap();
        terms.frames = Frames::at_serial_angles(&setup.robot, theta);
        terms.fill(setup, None).unwrap();
        let (mut values, mut gradients) =
            (vec![f64::NAN; count], vec![f64::NAN; count * theta.len()]);
        limits.evaluate(setup, &terms, &mut values, Some(&mut gradients));
        (values, gradients)
    }

    #[test]
    fn derivatives_of_margins_are_those_of_differences() {
        for n in [2, 5, 6, 7] {
            let (setup, limits) = (setup(n), limits());
            for posture in 0..6 {
                let theta: Vec<f64> = (0..n)
                    .map(|j| (1.3 * posture as f64 + 0.7 * j as f64).sin() * 2.0)
                    .collect();
                let (values, gradients) = at(&setup, &limits, &theta);
                // 6 box sides, floor and cylinder of 4 points; cylinder and height of the wrist; rope.
                assert_eq!(values.len(), 4 * 8 + 2 + 2);
                for k in 0..n {
                    let difference = |step: f64| -> Vec<f64> {
                        let moved = |by: f64| {
                            let mut theta = theta.clone();
                            theta[k] += by;
                            at(&setup, &limits, &theta).0
                        };
                        let (after, before) = (moved(step), moved(-step));
                        after
                            .iter()
                            .zip(&before)
                            .map(|(a, b)| (a - b) / (2.0 * step))
                            .collect()
                    };
                    // Richardson: the error of order h² cancels.
                    let (coarse, fine) = (difference(2e-3), difference(1e-3));
                    for l in 0..values.len() {
                        let expected = (4.0 * fine[l] - coarse[l]) / 3.0;
                        let ours = gradients[l * n + k];
                        assert!(
                            (ours - expected).abs() < 1e-8,
                            "n {n} margin {l} joint {k}: {ours} {expected}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn margins_are_distances_by_name() {
        let setup = setup(6);
        let limits = limits();
        let terms = PostureTerms::new(&setup, &[0.3, -0.4, 0.2, 0.9, -0.5, 0.1], None).unwrap();
        let margins = limits.margins(&setup, &terms);
        assert_eq!(margins.len(), limits.count(&setup));
        let find = |kind: LimitKind, point: &str| -> Vec<f64> {
            margins
                .iter()
                .filter(|m| m.kind == kind && m.point == point)
                .map(|m| m.margin)
                .collect()
        };
        let load = terms.loading_point();
        let wrist = terms.frames().wrist_centre();
        let sides: Vec<f64> = [(0, -1.0, 1.2), (1, -1.1, 1.3), (2, -0.7, 1.4)]
            .iter()
            .flat_map(|&(axis, low, high)| [load[axis] - low, high - load[axis]])
            .collect();
        assert_eq!(find(LimitKind::ToolBox, "loading point"), sides);
        assert_eq!(
            find(LimitKind::Floor, "measuring point b"),
            [terms.measuring_points()[1].z + 0.2]
        );
        assert_eq!(
            find(LimitKind::WristHeight, "wrist centre"),
            [wrist.z - 0.15]
        );
        let rope = (load - Vector3::new(1.8, -0.4, 0.1)).norm();
        assert_eq!(
            find(LimitKind::RopeLength, "rope"),
            [rope - 0.8, 3.4 - rope]
        );
        // Distance from a line by the area of a parallelogram.
        let flange = terms.frames().flange().translation.vector;
        let distance = (flange - terms.frames().origins()[0])
            .cross(&terms.frames().axes()[0])
            .norm();
        let [ours] = find(LimitKind::KeepOut, "flange")[..] else {
            panic!("one margin")
        };
        assert!((ours - (distance - 0.35)).abs() < 1e-14);
        // The wrist centre is no tool point: it may leave the box.
        assert!(find(LimitKind::ToolBox, "wrist centre").is_empty());
        let nothing = Scene::default();
        let mut all = Margins::new(&setup, &limits, &nothing);
        let smallest = all.smallest(&terms).unwrap();
        assert!(margins.iter().all(|m| m.margin >= smallest.margin));
        let none = Limits::default();
        let mut all = Margins::new(&setup, &none, &nothing);
        assert!(all.smallest(&terms).is_none());
    }

    #[test]
    fn a_load_without_rope_has_no_rope_limit() {
        let mut setup = setup(6);
        let with_rope = limits().count(&setup);
        setup.load = Load::Weight {
            magnitude: 500.0,
            direction: -Vector3::z(),
        };
        assert_eq!(limits().count(&setup), with_rope - 2);
        let terms = PostureTerms::new(&setup, &[0.1; 6], None).unwrap();
        assert_eq!(limits().margins(&setup, &terms).len(), with_rope - 2);
    }
}
