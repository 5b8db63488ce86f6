//! How far the load may move the measuring points: enough to be seen above the noise, little
//! enough for the linear model.

use super::slope::Slope;
use crate::model::limit::LimitKind;
use crate::model::load::{Axes, Load};
use crate::model::observation::{PostureTerms, Setup};
use nalgebra::{DMatrix, Vector3};

/// The displacement that the load makes in every posture, by the linear model of Eq. (7) and a
/// stiffness known before: the RMS over the measuring points of |Δ_a|, Δ_a = J^m_a K_θ⁻¹ Γ. What a known compliance
/// between flange and reflectors adds is not in it.
#[derive(Debug, Clone, PartialEq)]
pub struct DisplacementLimits {
    /// Smallest displacement \[m\]; `None` asks for none.
    pub smallest: Option<f64>,
    /// Largest displacement \[m\]; `None` allows any.
    pub largest: Option<f64>,
    /// Joint compliance K_θ⁻¹, n × n \[rad/(N·m)\], as
    /// [`joint_compliance`](crate::model::stiffness::joint_compliance) gives it: springs are mixed by E⁻¹.
    pub compliance: DMatrix<f64>,
}

/// Room for the derivative.
#[derive(Debug, Clone, Default)]
pub(super) struct DisplacementWork {
    /// Joint deflections K_θ⁻¹ Γ \[rad\].
    deflection: Vec<f64>,
    /// Derivative of the displacement by each deflection \[m/rad\].
    by_deflection: Vec<f64>,
    /// Derivative of the displacement by the torque of each joint \[m/(N·m)\].
    by_torque: Vec<f64>,
    /// Derivative of the displacement by θ \[m/rad\].
    slope: Vec<f64>,
}

/// Derivatives of the displacement by anchor and loading point, base axes.
struct ByLoad {
    anchor: Vector3<f64>,
    loading_point: Vector3<f64>,
}

impl DisplacementLimits {
    /// The same without one of the two, `None` where nothing is left.
    pub(super) fn without(mut self, kind: LimitKind) -> Option<Self> {
        match kind {
            LimitKind::SmallestDisplacement => self.smallest = None,
            LimitKind::LargestDisplacement => self.largest = None,
            _ => {}
        }
        (self.count() > 0).then_some(self)
    }

    /// Number of margins per posture.
    pub(super) fn count(&self) -> usize {
        self.kinds().count()
    }

    /// The kinds of its margins, in their order.
    pub(crate) fn kinds(&self) -> impl Iterator<Item = LimitKind> + use<> {
        let smallest = self.smallest.map(|_| LimitKind::SmallestDisplacement);
        let largest = self.largest.map(|_| LimitKind::LargestDisplacement);
        smallest.into_iter().chain(largest)
    }

    /// Displacement that counts as one \[m\]: a search looks at margins as shares of it, for those in
    /// metres are thousands of times smaller than distances of shapes.
    pub(crate) fn unit(&self) -> f64 {
        let unit = self.largest.or(self.smallest);
        unit.filter(|unit| *unit > 0.0).unwrap_or(1.0)
    }

    /// RMS displacement of the measuring points at a posture \[m\].
    pub fn displacement(&self, terms: &PostureTerms) -> f64 {
        let mut work = DisplacementWork::default();
        self.value(terms, &mut work)
    }

    fn value(&self, terms: &PostureTerms, work: &mut DisplacementWork) -> f64 {
        let n = terms.torque().len();
        work.deflection.clear();
        work.deflection.extend((0..n).map(|i| {
            let row = self.compliance.row(i);
            row.iter()
                .zip(terms.torque())
                .map(|(c, t)| c * t)
                .sum::<f64>()
        }));
        let points = terms.columns.chunks_exact(n);
        let count = points.len() as f64;
        let squares: f64 = points
            .map(|columns| moved(columns, &work.deflection).norm_squared())
            .sum();
        (squares / count).sqrt()
    }

    /// Calls `each` with every margin, as a share of [`unit`](Self::unit), and its derivative where
    /// the margin is below what `enough` says.
    pub(super) fn visit(
        &self,
        setup: &Setup,
        terms: &PostureTerms,
        work: &mut DisplacementWork,
        enough: f64,
        mut each: impl FnMut(f64, &Slope<'_>),
    ) {
        let unit = self.unit();
        let value = self.value(terms, work);
        let smallest = self.smallest.map(|least| (value - least, 1.0));
        let largest = self.largest.map(|most| (most - value, -1.0));
        let margins = smallest.into_iter().chain(largest);
        let margins = margins.map(|(margin, sign)| (margin / unit, sign / unit));
        let needed = margins.clone().any(|(margin, _)| margin < enough);
        let by_load = needed.then(|| self.derivative(setup, terms, value, work));
        let mut now = 1.0;
        for (margin, share) in margins {
            let mut slope = Slope::NONE;
            if let Some(by_load) = &by_load {
                work.slope.iter_mut().for_each(|s| *s *= share / now);
                now = share;
                slope.by_joint = Some(&work.slope);
                slope.by_anchor = by_load.anchor * share;
                slope.by_loading_point = by_load.loading_point * share;
            }
            each(margin, &slope);
        }
    }

    /// Derivative of the displacement `value`: by θ into `work`, and by the load.
    fn derivative(
        &self,
        setup: &Setup,
        terms: &PostureTerms,
        value: f64,
        work: &mut DisplacementWork,
    ) -> ByLoad {
        let n = terms.torque().len();
        let (frames, load_columns) = (terms.frames(), &terms.loading_columns);
        let axes = frames.axes();
        let DisplacementWork {
            deflection,
            by_deflection,
            by_torque,
            slope,
        } = work;
        slope.clear();
        slope.resize(n, 0.0);
        by_torque.clear();
        by_torque.resize(n, 0.0);
        // A displacement of zero has no direction.
        let points = terms.columns.chunks_exact(n);
        let scale = match value > 0.0 {
            true => 1.0 / (points.len() as f64 * value),
            false => 0.0,
        };
        by_deflection.clear();
        by_deflection.resize(n, 0.0);
        for columns in points {
            // ∂r/∂Δ_a = Δ_a/(m r).
            let weight = moved(columns, deflection) * scale;
            for (g, column) in by_deflection.iter_mut().zip(columns) {
                *g += column.dot(&weight);
            }
            add_turned(columns, axes, deflection, &weight, slope);
        }
        for (i, g) in by_torque.iter_mut().enumerate() {
            let column = self.compliance.column(i);
            *g = column.iter().zip(&*by_deflection).map(|(c, d)| c * d).sum();
        }
        // Γ_j = c_j · F + z_j · M, with the wrench as it stands.
        let (force, moment) = (terms.wrench().force, terms.wrench().moment);
        add_turned(load_columns, axes, by_torque, &force, slope);
        let mut after = Vector3::zeros();
        for k in (0..n).rev() {
            slope[k] += axes[k].cross(&after).dot(&moment);
            after += axes[k] * by_torque[k];
        }
        // What the joints' motion and the load do to the wrench.
        let by_force = moved(load_columns, by_torque);
        let by_moment = after;
        let mut out = ByLoad {
            anchor: Vector3::zeros(),
            loading_point: force.cross(&by_moment),
        };
        match &setup.load {
            Load::Rope { anchor, magnitude } => {
                let line = anchor - terms.loading_point();
                let length = line.norm();
                let unit = line / length;
                // dF = (G/ℓ)(I − u uᵀ)(dP2 − dP1).
                let across = by_force - unit * unit.dot(&by_force);
                out.anchor = across * (magnitude / length);
                out.loading_point -= out.anchor;
                for (slope, column) in slope.iter_mut().zip(load_columns) {
                    *slope -= column.dot(&out.anchor);
                }
            }
            Load::Constant {
                axes: Axes::Tool, ..
            } => {
                for (slope, axis) in slope.iter_mut().zip(axes) {
                    *slope += by_force.dot(&axis.cross(&force));
                    *slope += by_moment.dot(&axis.cross(&moment));
                }
            }
            _ => {}
        }
        out
    }
}

/// Σ_j x_j c_j.
fn moved(columns: &[Vector3<f64>], x: &[f64]) -> Vector3<f64> {
    columns.iter().zip(x).map(|(c, x)| c * *x).sum()
}

/// Adds w · ∂/∂θ_k Σ_j x_j c_j for a point of the tool: ∂c_j/∂θ_k = z_min × c_max.
fn add_turned(
    columns: &[Vector3<f64>],
    axes: &[Vector3<f64>],
    x: &[f64],
    weight: &Vector3<f64>,
    slope: &mut [f64],
) {
    let mut from = moved(columns, x);
    let mut before = Vector3::zeros();
    for (k, slope) in slope.iter_mut().enumerate() {
        *slope += (axes[k].cross(&from) + before.cross(&columns[k])).dot(weight);
        from -= columns[k] * x[k];
        before += axes[k] * x[k];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::cell::parse_cell;
    use crate::model::cell::Cell;
    use crate::model::kinematics::Frames;
    use crate::model::load::Wrench;
    use crate::model::scene::SceneParts;
    use crate::model::stiffness::joint_compliance;

    /// The default cell under each kind of load, joints as springs and mixed, with limits that
    /// some postures violate.
    fn cells() -> Vec<Cell> {
        let text = include_str!("../../../tests/cells/comau-shapes.toml");
        let cell = parse_cell(text, "cell.toml").unwrap();
        let anchor = Vector3::new(1.8, -0.4, 0.1);
        let wrench = Wrench {
            force: Vector3::new(300.0, -200.0, 400.0),
            moment: Vector3::new(50.0, 80.0, -60.0),
        };
        let loads = [
            Load::Rope {
                anchor,
                magnitude: 500.0,
            },
            Load::Rope {
                anchor,
                magnitude: -500.0,
            },
            Load::Weight {
                magnitude: 500.0,
                direction: -Vector3::z(),
            },
            Load::Constant {
                wrench,
                axes: Axes::Base,
            },
            Load::Constant {
                wrench,
                axes: Axes::Tool,
            },
        ];
        let mixing = DMatrix::from_fn(6, 6, |i, j| match i == j {
            true => 1.0,
            false => 0.2 * ((3 * i + j) as f64).sin(),
        });
        let mut out = Vec::new();
        for load in loads {
            for mixed in [false, true] {
                let mut cell = cell.clone();
                cell.setup.load = load.clone();
                if mixed {
                    let robot = cell.setup.robot.clone();
                    cell.setup.robot = robot.with_elastic_coordinates(mixing.clone()).unwrap();
                }
                let prior = cell.prior.clone().unwrap();
                let parts = SceneParts {
                    displacement: Some(DisplacementLimits {
                        smallest: Some(4e-4),
                        largest: Some(1.2e-3),
                        compliance: joint_compliance(&cell.setup.robot, &prior).unwrap(),
                    }),
                    ..SceneParts::default()
                };
                cell.scene = parts.build(&cell.setup.robot, &cell.bounds).unwrap();
                out.push(cell);
            }
        }
        out
    }

    fn theta(posture: usize) -> Vec<f64> {
        let angle = |j: usize| (1.3 * posture as f64 + 0.7 * j as f64).sin() * 2.0;
        (0..6).map(angle).collect()
    }

    fn terms(setup: &Setup, theta: &[f64]) -> PostureTerms {
        let mut terms = PostureTerms::new(setup, &[0.0; 6], None).unwrap();
        terms.frames = Frames::at_serial_angles(&setup.robot, theta);
        terms.fill(setup, None).unwrap();
        terms
    }

    #[test]
    fn margins_are_those_of_the_linear_model() {
        for cell in cells() {
            let (setup, prior) = (&cell.setup, cell.prior.as_ref().unwrap());
            let springs = prior.iter().map(|k| 1.0 / k);
            let springs = nalgebra::DVector::from_iterator(6, springs);
            for posture in 0..8 {
                let terms = terms(setup, &theta(posture));
                // Ψ diag(1/k) 1: Eq. (7) by the columns of the springs.
                let moved = terms.block(&setup.robot) * &springs;
                let rms = (moved.norm_squared() / setup.tool.point_count() as f64).sqrt();
                let mut margins = cell.margins();
                let named = margins.named(&terms);
                let named = named.iter().filter(|m| m.point == "measuring points");
                let found: Vec<f64> = named.map(|m| m.margin).collect();
                assert_eq!(found.len(), 2);
                assert!((found[0] - (rms - 4e-4)).abs() < 1e-15);
                assert!((found[1] - (1.2e-3 - rms)).abs() < 1e-15);
                let inside = (4e-4..=1.2e-3).contains(&rms);
                let scene_only = crate::model::cell::Limits::default();
                let mut own = crate::model::cell::Margins::new(setup, &scene_only, &cell.scene);
                assert_eq!(own.least(&terms) >= 0.0, inside);
            }
        }
    }

    /// Margins with the derivatives by θ, anchor and loading point.
    fn all(setup: &Setup, asked: &DisplacementLimits, at: &[f64]) -> (Vec<f64>, Vec<[f64; 12]>) {
        let terms = terms(setup, at);
        let (mut values, mut slopes) = (Vec::new(), Vec::new());
        let mut work = DisplacementWork::default();
        asked.visit(setup, &terms, &mut work, f64::INFINITY, |margin, slope| {
            values.push(margin);
            let by_joint = slope.by_joint.unwrap();
            let mut row = [0.0; 12];
            row[..6].copy_from_slice(by_joint);
            row[6..9].copy_from_slice(slope.by_anchor.as_slice());
            row[9..].copy_from_slice(slope.by_loading_point.as_slice());
            slopes.push(row);
        });
        (values, slopes)
    }

    #[test]
    fn derivatives_are_those_of_differences() {
        let mut worst = 0.0_f64;
        for cell in cells() {
            let asked = cell.scene.displacement().unwrap();
            for posture in 0..6 {
                let at = theta(posture);
                let (values, slopes) = all(&cell.setup, asked, &at);
                assert_eq!(values.len(), 2);
                let flange = Frames::at_serial_angles(&cell.setup.robot, &at);
                let flange = *flange.flange();
                for k in 0..12 {
                    let moved = |step: f64| {
                        let (mut setup, mut at) = (cell.setup.clone(), at.clone());
                        match k {
                            0..6 => at[k] += step,
                            6..9 => {
                                if let Load::Rope { anchor, .. } = &mut setup.load {
                                    anchor[k - 6] += step;
                                }
                            }
                            _ => {
                                let along = Vector3::ith(k - 9, step);
                                let own = flange.rotation.inverse_transform_vector(&along);
                                setup.tool.loading_point += own;
                            }
                        }
                        all(&setup, asked, &at).0
                    };
                    let difference = |step: f64| -> Vec<f64> {
                        let (after, before) = (moved(step), moved(-step));
                        let both = after.iter().zip(&before);
                        both.map(|(a, b)| (a - b) / (2.0 * step)).collect()
                    };
                    // Richardson: the error of order h² cancels.
                    let (coarse, fine) = (difference(2e-4), difference(1e-4));
                    for l in 0..2 {
                        let expected = (4.0 * fine[l] - coarse[l]) / 3.0;
                        let error = (slopes[l][k] - expected).abs();
                        worst = worst.max(error);
                        assert!(error < 1e-8, "{k}: {} {expected}", slopes[l][k]);
                    }
                }
            }
        }
        println!("worst {worst:.1e}");
    }

    #[test]
    fn one_of_the_two_may_go() {
        let cell = &cells()[0];
        for (kind, rest) in [
            (
                LimitKind::SmallestDisplacement,
                LimitKind::LargestDisplacement,
            ),
            (
                LimitKind::LargestDisplacement,
                LimitKind::SmallestDisplacement,
            ),
        ] {
            let less = cell.without_limit(kind);
            assert!(less.limit_kinds().contains(&rest) && !less.limit_kinds().contains(&kind));
            let none = less.without_limit(rest);
            assert!(none.scene.is_empty() && none.scene.displacement().is_none());
        }
    }
}
