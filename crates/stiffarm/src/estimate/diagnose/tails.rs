//! Tail probabilities, with bad arguments giving none instead of a panic.

use statrs::distribution::{ChiSquared, ContinuousCDF, FisherSnedecor, Normal, StudentsT};

/// Level of a family of tests.
pub(super) const LEVEL: f64 = 0.01;

/// P(F ≥ f) with m and d degrees of freedom.
pub(super) fn f_tail(f: f64, m: usize, d: usize) -> Option<f64> {
    if !f.is_finite() || m == 0 || d == 0 {
        return None;
    }
    let law = FisherSnedecor::new(m as f64, d as f64).ok()?;
    Some(law.sf(f.max(0.0)))
}

/// P(χ² ≥ x) and P(χ² ≤ x) with d degrees of freedom.
pub(super) fn chi_squared_tails(x: f64, d: usize) -> Option<(f64, f64)> {
    if !x.is_finite() || d == 0 {
        return None;
    }
    let law = ChiSquared::new(d as f64).ok()?;
    Some((law.sf(x.max(0.0)), law.cdf(x.max(0.0))))
}

/// P(|T| ≥ |t|), Student's with degrees of freedom, normal without.
pub(super) fn two_sided(t: f64, degrees_of_freedom: Option<usize>) -> Option<f64> {
    if !t.is_finite() {
        return None;
    }
    let tail = match degrees_of_freedom {
        Some(0) => return None,
        Some(d) => StudentsT::new(0.0, 1.0, d as f64).ok()?.sf(t.abs()),
        None => Normal::standard().sf(t.abs()),
    };
    Some(2.0 * tail)
}
