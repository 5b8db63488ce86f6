//! A bound on all groups of a list from one weighted mixture of its postures.
//!
//! A convex function f of the information lies above its tangents: with scores
//! g_i = −⟨∇f(M₀), M_i⟩ at the mixture M₀ = Σ w_i M_i, every group S has
//! f(M_S) ≥ f(M₀) + Σ w_i g_i − Σ_S g_i. Weights between 0 and 1 that minimise f make it
//! tight (Welch, Journal of the American Statistical Association 77, 1982, 190–194,
//! doi:10.1080/01621459.1982.10477788).

/// f(M₀), the scores, and how f becomes an index.
#[derive(Debug, Clone)]
pub(super) struct Tangent {
    /// f(M₀) + Σ w_i g_i.
    level: f64,
    /// g_i of each candidate.
    pub(super) scores: Vec<f64>,
    /// n where f = 2n ln(index); `None` where f = index².
    logarithmic: Option<usize>,
    /// ln of what multiplies the index.
    log_factor: f64,
}

impl Tangent {
    pub(super) fn new(
        value: f64,
        weights: &[f64],
        scores: Vec<f64>,
        logarithmic: Option<usize>,
        log_factor: f64,
    ) -> Self {
        let gained: f64 = weights.iter().zip(&scores).map(|(w, g)| w * g).sum();
        Tangent { level: value + gained, scores, logarithmic, log_factor }
    }

    /// Lower bound on ln(index) of every group whose scores sum to at most `sum`.
    pub(super) fn bound(&self, sum: f64) -> f64 {
        let f = self.level - sum;
        self.log_factor
            + match self.logarithmic {
                Some(n) => f / (2.0 * n as f64),
                None if f > 0.0 => 0.5 * f.ln(),
                None => f64::NEG_INFINITY,
            }
    }

    /// Lower bound on ln(index) of every group of `count` candidates.
    pub(super) fn bound_of(&self, count: usize) -> f64 {
        let mut sorted = self.scores.clone();
        sorted.sort_by(|a, b| b.total_cmp(a));
        self.bound(sorted[..count].iter().sum())
    }
}

/// Weights between 0 and 1 that sum to `count`, moved from `weights` towards larger
/// scores.
pub(super) fn moved(weights: &[f64], scores: &[f64], count: usize) -> Vec<f64> {
    let mut out: Vec<f64> = weights.iter().zip(scores).map(|(w, g)| w * g.max(0.0).sqrt()).collect();
    // Those that would pass 1 stay there; the others share what is left.
    let mut full = vec![false; out.len()];
    loop {
        let free: f64 = out.iter().zip(&full).filter(|(_, f)| !**f).map(|(w, _)| w).sum();
        let left = count as f64 - full.iter().filter(|f| **f).count() as f64;
        if free <= 0.0 || left <= 0.0 {
            return weights.to_vec();
        }
        let factor = left / free;
        let mut again = false;
        for (w, full) in out.iter_mut().zip(&mut full) {
            if !*full {
                *w *= factor;
                if *w > 1.0 {
                    (*w, *full, again) = (1.0, true, true);
                }
            }
        }
        if !again {
            return out;
        }
    }
}
