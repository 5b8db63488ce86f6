//! The mixed model of any system, for this project's own tests.

use super::doubt::doubt;
use super::likelihood::{Likelihood, Sizes};
use super::sums::Rows;
use crate::error::Result;
use crate::estimate::identify::{MeasuredSystem, Whitened};
use crate::numerics::control::Control;
use nalgebra::{DMatrix, DVector};
use std::ops::Range;

/// Ψ h + Σ B_c u_c + shifts + noise for a system with random effects of its own.
pub struct MixedModel {
    rows: Rows,
}

impl MixedModel {
    /// `random` has one column per effect, `classes` says which belong together.
    ///
    /// # Errors
    /// As [`Whitened::new`].
    pub fn new(system: &MeasuredSystem, random: &DMatrix<f64>, classes: Vec<Range<usize>>) -> Result<Self> {
        let whitened = Whitened::new(system)?;
        let white = whitened.whiten(&system.delta);
        let shifts = whitened.is_separable();
        Ok(MixedModel { rows: Rows::new(&whitened, random, classes, &white, (&[], shifts)) })
    }

    /// −2 ln of the restricted likelihood, up to a constant, and its derivatives by ln γ
    /// and by the logarithm of each class's variance ratio.
    pub fn value(&self, gamma: f64, classes: &[f64]) -> Option<(f64, Vec<f64>)> {
        Likelihood::new(self.rows.clone(), &[]).value_and_gradient(&sizes(gamma, classes))
    }

    /// The curvature by which the search for the ratios steps.
    pub fn curvature(&self, gamma: f64, classes: &[f64]) -> Option<DMatrix<f64>> {
        let slopes = Likelihood::new(self.rows.clone(), &[]).slopes(&sizes(gamma, classes))?;
        Some(slopes.curvature)
    }

    /// h and u, their covariance and σ² at given ratios, all postures but `left_out`.
    pub fn solve(&self, gamma: f64, classes: &[f64], left_out: &[usize]) -> Option<(DVector<f64>, DMatrix<f64>, f64)> {
        let solved = Likelihood::new(self.rows.clone(), left_out).solve(&sizes(gamma, classes))?;
        let covariance = solved.inverse() * solved.variance;
        Some((solved.values(&self.rows), covariance, solved.variance))
    }

    /// Covariance of h and u − û at given ratios with the doubt about the ratios in it, and
    /// the covariance of ln σ² and the logarithms of the classes' ratios.
    pub fn doubt(&self, gamma: f64, classes: &[f64]) -> Option<(DMatrix<f64>, DMatrix<f64>)> {
        let likelihood = Likelihood::new(self.rows.clone(), &[]);
        let sizes = sizes(gamma, classes);
        let solved = likelihood.solve(&sizes)?;
        Some(doubt(&likelihood, &sizes, &solved))
    }

    /// True where the data tell shifts from noise.
    pub fn has_shifts(&self) -> bool {
        self.rows.has_shifts()
    }

    /// γ and the variance ratios of largest likelihood, with −2 ln L.
    pub fn best(&self) -> Option<(f64, Vec<f64>, f64)> {
        let best = Likelihood::new(self.rows.clone(), &[]).best(
            None,
            &vec![false; self.rows.estimated_count()],
            Control::default(),
        );
        best.map(|(sizes, value)| (sizes.gamma, sizes.classes, value))
    }
}

fn sizes(gamma: f64, classes: &[f64]) -> Sizes {
    Sizes { gamma, classes: classes.to_vec() }
}
