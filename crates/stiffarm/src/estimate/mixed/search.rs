//! The sizes of largest restricted likelihood, by Newton's method with the average of observed and expected curvature.

use super::likelihood::{Likelihood, Sizes, Slopes};
use crate::numerics::control::Control;
use nalgebra::{DMatrix, DVector};

/// Shares of the noise's variance, as exponents of e, that an effect's class may give to
/// a row: below the first it is nothing, beyond the last there is no noise.
const SHARES: [f64; 2] = [-16.0, 16.0];
/// How far above the lower end of the bounds a search near known sizes starts.
const LITTLE: f64 = 8.0;
/// Where the search starts.
const STARTS: [f64; 3] = [0.0, -3.0, 3.0];
/// ln γ of the variance that a posture's readings share.
const RATIO: [f64; 2] = [-14.0, 20.0];
/// Steps end where −2 ln L_R would fall by less than this share of itself.
const TOLERANCE: f64 = 1e-9;
/// Differences of −2 ln L_R below this say nothing.
const SETTLED_LIKELIHOOD: f64 = 1e-4;
/// A class of this curvature is something: −2 ln L_R would rise by about as much without it.
const TELLING_CURVATURE: f64 = 0.1;
/// No step changes a logarithm by more.
const LARGEST_STEP: f64 = 3.0;
/// Least curvature that a step counts on: with a class that vanishes so do slope and curvature.
const LEAST_CURVATURE: f64 = 1e-4;
/// Steps at most, and times that one is halved.
const STEPS: usize = 100;
const HALVED: usize = 40;
/// Share of what a step promises that it has to keep.
const PROMISED_SHARE: f64 = 1e-4;

impl Likelihood {
    /// The sizes of largest likelihood: from `near`, or from several starts. Classes that are `nothing` are left out.
    /// `None` where there is no likelihood.
    pub(super) fn best(&self, near: Option<&Sizes>, nothing: &[bool], control: Control<'_>) -> Option<(Sizes, f64)> {
        let rows = self.rows();
        let shared = rows.has_shifts().then_some(RATIO);
        let mut search = Search {
            likelihood: self,
            bounds: shared.into_iter().chain(nothing.iter().map(|_| SHARES)).collect(),
            // Logarithm of the λ that gives a row the variance of the noise.
            units: (0..nothing.len()).map(|class| -rows.mean_square(class).ln()).collect(),
            nothing: nothing.to_vec(),
        };
        // What some classes alone would say is a doubt, not a result: one start is enough.
        let shares = if nothing.contains(&true) { &STARTS[..1] } else { &STARTS };
        let starts = match near {
            Some(sizes) => vec![search.near(sizes)],
            None => {
                let from = |share: &f64| {
                    let at = |i: usize, _| {
                        if shared.is_some() && i == 0 { 0.0 } else { *share }
                    };
                    DVector::from_fn(search.bounds.len(), at)
                };
                shares.iter().map(from).collect()
            }
        };
        let optima = starts.into_iter().filter_map(|start| search.from(start, control));
        let best = optima.min_by(|a, b| a.1.value.total_cmp(&b.1.value));
        best.map(|(x, at)| {
            let shared = search.shared();
            let is_told = |c: usize| at.curvature[(shared + c, shared + c)] > TELLING_CURVATURE;
            self.without_nothing(search.sizes(&x), at.value, is_told)
        })
    }

    /// Classes that give next to nothing give nothing, where that is as likely.
    fn without_nothing(&self, mut sizes: Sizes, mut value: f64, is_told: impl Fn(usize) -> bool) -> (Sizes, f64) {
        let all = 0..self.rows().estimated_count();
        for class in all.filter(|c| !is_told(*c)) {
            if sizes.classes[class] == 0.0 {
                continue;
            }
            let mut less = sizes.clone();
            less.classes[class] = 0.0;
            if let Some(solved) = self.solve(&less)
                && solved.value <= value + SETTLED_LIKELIHOOD
            {
                value = solved.value;
                sizes = less;
            }
        }
        (sizes, value)
    }
}

/// The search over logarithms: ln γ, then ln λ in units of each class.
struct Search<'a> {
    likelihood: &'a Likelihood,
    bounds: Vec<[f64; 2]>,
    units: Vec<f64>,
    /// Classes that are nothing and stay so.
    nothing: Vec<bool>,
}

impl Search<'_> {
    /// Number of logarithms before those of the classes.
    fn shared(&self) -> usize {
        self.bounds.len() - self.units.len()
    }

    fn sizes(&self, x: &DVector<f64>) -> Sizes {
        let shared = self.shared();
        let size = |(c, unit): (usize, &f64)| match self.nothing[c] {
            true => 0.0,
            false => (x[shared + c] + unit).exp(),
        };
        let classes = self.units.iter().enumerate().map(size);
        Sizes {
            gamma: if shared == 1 { x[0].exp() } else { 0.0 },
            classes: classes.chain(self.likelihood.rows().held()).collect(),
        }
    }

    /// Where a search near `sizes` starts. A class that was nothing starts as little, or stays nothing where it would
    /// be less likely as that.
    fn near(&mut self, sizes: &Sizes) -> DVector<f64> {
        let shared = self.shared();
        let ratio = (shared == 1).then(|| sizes.gamma.ln());
        let classes = sizes.classes.iter().zip(&self.units);
        let all = ratio.into_iter().chain(classes.map(|(size, unit)| size.ln() - unit));
        let inside = all.zip(&self.bounds).map(|(x, [low, high])| x.clamp(low + LITTLE, *high));
        let place = DVector::from_iterator(self.bounds.len(), inside);
        if sizes.classes.contains(&0.0)
            && let Some(slopes) = self.likelihood.slopes(&self.sizes(&place))
        {
            for (c, nothing) in self.nothing.iter_mut().enumerate() {
                *nothing |= sizes.classes[c] == 0.0 && slopes.gradient[shared + c] >= 0.0;
            }
        }
        place
    }

    /// Newton's steps from `x` within the bounds: where they end, and −2 ln L_R there.
    fn from(&self, mut x: DVector<f64>, control: Control<'_>) -> Option<(DVector<f64>, Slopes)> {
        let mut at = self.likelihood.slopes(&self.sizes(&x))?;
        for _ in 0..STEPS {
            if control.stopped() {
                break;
            }
            let Some(step) = self.step(&x, &at) else {
                break;
            };
            let promised = -step.dot(&at.gradient);
            if promised <= TOLERANCE * (1.0 + at.value.abs()) {
                break;
            }
            let mut share = 1.0;
            let better = (0..HALVED).find_map(|_| {
                let place = self.within(&x + &step * share);
                let next = self.likelihood.slopes(&self.sizes(&place));
                let next = next.filter(|next| next.value < at.value - PROMISED_SHARE * share * promised);
                share *= 0.5;
                next.map(|next| (place, next))
            });
            let Some((place, next)) = better else { break };
            x = place;
            at = next;
        }
        at.value.is_finite().then_some((x, at))
    }

    /// The step of those logarithms that no bound holds.
    fn step(&self, x: &DVector<f64>, at: &Slopes) -> Option<DVector<f64>> {
        let shared = self.shared();
        let is_free = |i: &usize| {
            let ([low, high], slope) = (self.bounds[*i], at.gradient[*i]);
            let is_nothing = *i >= shared && self.nothing[*i - shared];
            !(is_nothing || x[*i] <= low && slope >= 0.0 || x[*i] >= high && slope <= 0.0)
        };
        let free: Vec<usize> = (0..x.len()).filter(is_free).collect();
        let mut step = DVector::zeros(x.len());
        if free.is_empty() {
            return Some(step);
        }
        let curvature = DMatrix::from_fn(free.len(), free.len(), |i, j| {
            at.curvature[(free[i], free[j])] + if i == j { LEAST_CURVATURE } else { 0.0 }
        });
        let slope = DVector::from_fn(free.len(), |i, _| -at.gradient[free[i]]);
        let newton = curvature.cholesky()?.solve(&slope);
        let shorter = (LARGEST_STEP / newton.amax()).min(1.0);
        for (i, value) in free.iter().zip(&newton) {
            step[*i] = value * shorter;
        }
        Some(step)
    }

    fn within(&self, x: DVector<f64>) -> DVector<f64> {
        let all = x.iter().zip(&self.bounds);
        DVector::from_iterator(x.len(), all.map(|(x, [low, high])| x.clamp(*low, *high)))
    }
}
