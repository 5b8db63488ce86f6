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
            row.iter().zip(terms.torque()).map(|(c, t)| c * t).sum::<f64>()
        }));
        let points = terms.columns.chunks_exact(n);
        let count = points.len() as f64;
        let squares: f64 = points.map(|columns| moved(columns, &work.deflection).norm_squared()).sum();
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
    fn derivative(&self, setup: &Setup, terms: &PostureTerms, value: f64, work: &mut DisplacementWork) -> ByLoad {
        let n = terms.torque().len();
        let (frames, load_columns) = (terms.frames(), &terms.loading_columns);
        let axes = frames.axes();
        let DisplacementWork { deflection, by_deflection, by_torque, slope } = work;
        slope.clear();
        slope.resize(n, 0.0);
        by_torque.clear();
        by_torque.resize(n, 0.0);
        // A displacement of zero has no direction.
        let points = terms.columns.chunks_exact(n);
        let scale = if value > 0.0 { 1.0 / (points.len() as f64 * value) } else { 0.0 };
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
        let mut out = ByLoad { anchor: Vector3::zeros(), loading_point: force.cross(&by_moment) };
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
            Load::Constant { axes: Axes::Tool, .. } => {
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
fn add_turned(columns: &[Vector3<f64>], axes: &[Vector3<f64>], x: &[f64], weight: &Vector3<f64>, slope: &mut [f64]) {
    let mut from = moved(columns, x);
    let mut before = Vector3::zeros();
    for (k, slope) in slope.iter_mut().enumerate() {
        *slope += (axes[k].cross(&from) + before.cross(&columns[k])).dot(weight);
        from -= columns[k] * x[k];
        before += axes[k] * x[k];
    }
}
