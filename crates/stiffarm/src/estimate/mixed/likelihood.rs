//! The restricted likelihood of the mixed model, and the sizes that maximise it
//! (REML: Patterson & Thompson, Biometrika 58, 1971, 545–554,
//! doi:10.1093/biomet/58.3.545), from Henderson's mixed-model equations
//! (Biometrics 31, 1975, 423–447, doi:10.2307/2529430):
//!
//! \[ΨᵀV⁻¹Ψ, ΨᵀV⁻¹B; BᵀV⁻¹Ψ, BᵀV⁻¹B + Λ⁻¹\]\[h; u\] = \[ΨᵀV⁻¹y; BᵀV⁻¹y\]
//!
//! with V σ² the covariance of the readings and Λ σ² that of the random effects. In
//! coordinates v = Λ^(−1/2) u, in which the matrix A of the equations has Λ = I,
//! −2 ln L_R = ν ln(s²) + ln|V| + ln|A| up to a constant, where ν s² = eᵀV⁻¹e − cᵀA⁻¹c
//! are the squares that are left on ν = rows − rank Ψ degrees of freedom.

use super::sums::{Alike, Rows};
use crate::model::elastic::ElasticClass;
use crate::numerics::control::Control;
use crate::numerics::information::cholesky::Cholesky;
use crate::numerics::optimise::{Evaluation, Options, Problem, minimise};
use nalgebra::{DMatrix, DVector};

/// Shares of the noise's variance, as exponents of e, that an effect's class may give to
/// a row: below the first it is nothing, beyond the last there is no noise.
const SHARES: [f64; 2] = [-16.0, 16.0];
/// How far above the lower end of the bounds a search near known sizes starts.
const LITTLE: f64 = 8.0;
/// Where the search starts.
const STARTS: [f64; 3] = [-3.0, 0.0, 3.0];
/// ln γ of the variance that a posture's readings share.
const RATIO: [f64; 2] = [-14.0, 20.0];

/// Sizes of the random parts in units of σ².
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Sizes {
    /// γ = τ²/σ².
    pub(super) gamma: f64,
    /// λ = ω²/σ² of each class.
    pub(super) classes: Vec<f64>,
}

impl Sizes {
    /// ω of a class where σ is `sigma`.
    pub(super) fn std(&self, class: ElasticClass, sigma: f64) -> f64 {
        self.classes[class as usize].sqrt() * sigma
    }
}

/// The mixed-model equations solved at given sizes.
pub(super) struct Solved {
    /// −2 ln L_R up to a constant.
    pub(super) value: f64,
    /// h less its estimate by least squares, then u, in the columns' own units.
    change: DVector<f64>,
    /// s².
    pub(super) variance: f64,
    /// ν.
    pub(super) free: usize,
    /// Factor of A without the columns that Λ leaves nothing of: A is the identity there.
    factor: Cholesky,
    /// The columns of the factor.
    kept: Vec<usize>,
    /// Λ^(1/2) of each column, 1 for fixed effects.
    scale: DVector<f64>,
}

impl Solved {
    /// h, then u, in the columns' own units, of the system behind `rows`.
    pub(super) fn values(&self, rows: &Rows) -> DVector<f64> {
        let mut out = self.change.clone();
        let mut axes = out.rows_mut(0, rows.fixed);
        axes += &rows.start;
        out
    }

    /// Inverse of the mixed-model equations: times s² the covariance of h and u − û.
    pub(super) fn inverse(&self) -> DMatrix<f64> {
        self.scaled(self.scaled_inverse())
    }

    /// Inverse of A, both triangles the same.
    pub(super) fn scaled_inverse(&self) -> DMatrix<f64> {
        let (count, inverse) = (self.scale.len(), self.factor.inverse());
        if self.kept.len() == count {
            return inverse;
        }
        let mut out = DMatrix::identity(count, count);
        for (j, to) in self.kept.iter().enumerate() {
            for (i, row) in self.kept.iter().enumerate() {
                out[(*row, *to)] = inverse[(i, j)];
            }
        }
        out
    }

    /// Λ^(1/2) of each column, 1 for fixed effects.
    pub(super) fn scale(&self) -> &DVector<f64> {
        &self.scale
    }

    fn scaled(&self, mut out: DMatrix<f64>) -> DMatrix<f64> {
        for j in 0..out.ncols() {
            for i in j..out.nrows() {
                // Rounding makes the two sides differ in the last digit.
                let value = out[(i, j)] * self.scale[i] * self.scale[j];
                out[(i, j)] = value;
                out[(j, i)] = value;
            }
        }
        out
    }
}

/// The likelihood of all postures but some.
pub(super) struct Likelihood<'a> {
    rows: &'a Rows,
    left_out: &'a [usize],
    plain: DMatrix<f64>,
    alike: Option<Alike>,
}

impl<'a> Likelihood<'a> {
    /// Of all postures but `left_out` (ascending).
    pub(super) fn new(rows: &'a Rows, left_out: &'a [usize]) -> Self {
        Likelihood {
            rows,
            left_out,
            plain: rows.plain(left_out),
            alike: rows.alike(left_out),
        }
    }

    /// Postures that take no part, ascending.
    pub(super) fn left_out(&self) -> &'a [usize] {
        self.left_out
    }

    /// `None` where the equations cannot be solved, or nothing is left of the
    /// displacements.
    pub(super) fn solve(&self, sizes: &Sizes) -> Option<Solved> {
        let (fixed, random) = (self.rows.fixed, self.rows.random());
        let unknowns = fixed + random;
        let sums = self
            .rows
            .at(sizes.gamma, self.left_out, &self.plain, self.alike.as_ref());
        let free = sums.rows + self.rows.idle.len();
        let free = free.checked_sub(fixed).filter(|free| *free > 0)?;
        let mut scale = DVector::from_element(unknowns, 1.0);
        for (class, size) in self.rows.classes.iter().zip(&sizes.classes) {
            scale
                .rows_mut(fixed + class.start, class.len())
                .fill(size.sqrt());
        }
        let gram = &sums.gram;
        let kept: Vec<usize> = (0..unknowns).filter(|i| scale[*i] > 0.0).collect();
        let mut matrix = DMatrix::from_fn(kept.len(), kept.len(), |i, j| {
            gram[(kept[i], kept[j])] * scale[kept[i]] * scale[kept[j]]
        });
        for i in fixed..kept.len() {
            matrix[(i, i)] += 1.0;
        }
        let right = DVector::from_fn(kept.len(), |i, _| {
            gram[(kept[i], unknowns)] * scale[kept[i]]
        });
        let factor = Cholesky::new(&matrix)?;
        let solution = factor.solve(&right);
        let left = gram[(unknowns, unknowns)] - right.dot(&solution);
        if !(left > 0.0 && left.is_finite()) {
            return None;
        }
        let determinant = factor.ln_determinant();
        let variance = left / free as f64;
        let mut change = DVector::zeros(unknowns);
        for (i, value) in kept.iter().zip(solution.iter()) {
            change[*i] = value * scale[*i];
        }
        Some(Solved {
            value: free as f64 * variance.ln() + sums.logarithms + determinant,
            change,
            variance,
            free,
            factor,
            kept,
            scale,
        })
    }

    /// −2 ln L_R and its derivatives by ln γ (where the data tell shifts from noise)
    /// and by the ln λ of each class.
    pub(super) fn value_and_gradient(&self, sizes: &Sizes) -> Option<(f64, Vec<f64>)> {
        let solved = self.solve(sizes)?;
        let fixed = self.rows.fixed;
        let inverse = solved.scaled_inverse();
        let mut gradient = Vec::with_capacity(4);
        if self.rows.has_shifts() {
            let unknowns = solved.change.len();
            let solution = solved.change.clone().resize_vertically(unknowns + 1, -1.0);
            let covariance = solved.scaled(inverse.clone());
            let [logarithms, squares, determinant] = self.rows.by_ratio(
                sizes.gamma,
                self.left_out,
                &solution,
                &covariance,
                self.alike.as_ref(),
            );
            gradient.push(logarithms + squares / solved.variance + determinant);
        }
        let told = self.rows.classes.iter().zip(&sizes.classes);
        for (class, size) in told.take(self.rows.told()) {
            let own = class.clone().map(|c| fixed + c);
            let trace: f64 = own.clone().map(|c| inverse[(c, c)]).sum();
            let squares: f64 = own.map(|c| solved.change[c].powi(2)).sum();
            let squares = if *size > 0.0 { squares / size } else { 0.0 };
            gradient.push(class.len() as f64 - trace - squares / solved.variance);
        }
        Some((solved.value, gradient))
    }

    /// The sizes of largest likelihood: from `near`, or from several starts. Classes that are `nothing` are left out.
    /// `None` where there is no likelihood.
    pub(super) fn best(
        &self,
        near: Option<&Sizes>,
        nothing: &[bool],
        control: Control<'_>,
    ) -> Option<(Sizes, f64)> {
        let units: Vec<f64> = (0..self.rows.told())
            .map(|class| self.rows.mean_square(class))
            .collect();
        let mut problem = Search {
            likelihood: self,
            bounds: Vec::new(),
            // Logarithm of the λ that gives a row the variance of the noise.
            units: units.iter().map(|unit| -unit.ln()).collect(),
            nothing: nothing.to_vec(),
        };
        if self.rows.has_shifts() {
            problem.bounds.push(RATIO);
        }
        problem.bounds.extend(units.iter().map(|_| SHARES));
        let starts: Vec<Vec<f64>> = match near {
            Some(sizes) => vec![problem.start(sizes)],
            None => STARTS
                .iter()
                .map(|share| {
                    let ratio = self.rows.has_shifts().then_some(0.0);
                    ratio
                        .into_iter()
                        .chain(units.iter().map(|_| *share))
                        .collect()
                })
                .collect(),
        };
        let options = Options {
            tolerance: TOLERANCE,
            max_iterations: 200,
            ..Options::default()
        };
        let mut best: Option<(Sizes, f64)> = None;
        for start in starts {
            let found = minimise(&mut problem, &start, options, control);
            let sizes = problem.sizes(&found.x);
            if found.merit.is_finite()
                && best.as_ref().is_none_or(|(_, value)| found.merit < *value)
            {
                best = Some((sizes, found.merit));
            }
        }
        best.map(|(sizes, value)| self.without_nothing(sizes, value))
    }

    /// Classes that give next to nothing give nothing, where that is as likely.
    fn without_nothing(&self, mut sizes: Sizes, mut value: f64) -> (Sizes, f64) {
        for class in 0..self.rows.told() {
            let mut less = sizes.clone();
            less.classes[class] = 0.0;
            if let Some(solved) = self.solve(&less)
                && solved.value <= value + NOTHING
            {
                value = solved.value;
                sizes = less;
            }
        }
        (sizes, value)
    }
}

/// Relative change of −2 ln L_R at which the search ends.
const TOLERANCE: f64 = 1e-10;
/// Differences of −2 ln L_R below this say nothing.
const NOTHING: f64 = 1e-4;

/// The search over logarithms: ln γ, then ln λ in units of each class.
struct Search<'a, 'b> {
    likelihood: &'b Likelihood<'a>,
    bounds: Vec<[f64; 2]>,
    units: Vec<f64>,
    /// Classes that are nothing and stay so.
    nothing: Vec<bool>,
}

impl Search<'_, '_> {
    fn sizes(&self, x: &[f64]) -> Sizes {
        let shared = usize::from(self.likelihood.rows.has_shifts());
        let classes = x[shared..].iter().zip(&self.units);
        Sizes {
            gamma: if shared == 1 { x[0].exp() } else { 0.0 },
            classes: classes
                .zip(&self.nothing)
                .map(|((x, unit), nothing)| if *nothing { 0.0 } else { (x + unit).exp() })
                .chain(self.likelihood.rows.held)
                .collect(),
        }
    }

    /// Where a search near `sizes` starts. A class that was nothing starts as little, or stays nothing where it would be
    /// less likely as that.
    fn start(&mut self, sizes: &Sizes) -> Vec<f64> {
        let shared = usize::from(self.likelihood.rows.has_shifts());
        let place = self.place(sizes);
        if sizes.classes.contains(&0.0)
            && let Some((_, gradient)) = self.likelihood.value_and_gradient(&self.sizes(&place))
        {
            let classes = sizes.classes.iter().zip(&gradient[shared..]);
            for (nothing, (size, slope)) in self.nothing.iter_mut().zip(classes) {
                *nothing |= *size == 0.0 && *slope >= 0.0;
            }
        }
        place
    }

    fn place(&self, sizes: &Sizes) -> Vec<f64> {
        let ratio = self.likelihood.rows.has_shifts().then(|| sizes.gamma.ln());
        let classes = sizes.classes.iter().zip(&self.units);
        let all = ratio
            .into_iter()
            .chain(classes.map(|(size, unit)| size.ln() - unit));
        // A class that was nothing starts as little, where its derivative is not nothing.
        let kept = all.zip(&self.bounds);
        kept.map(|(x, [low, high])| x.clamp(low + LITTLE, *high))
            .collect()
    }
}

impl Problem for Search<'_, '_> {
    fn bounds(&self) -> &[[f64; 2]] {
        &self.bounds
    }

    fn evaluate(&mut self, x: &[f64]) -> Evaluation {
        let found = self.likelihood.value_and_gradient(&self.sizes(x));
        let (value, gradient) = found.unwrap_or_else(|| (f64::INFINITY, vec![0.0; x.len()]));
        Evaluation {
            objective: value,
            gradient,
            merit: value,
            ..Evaluation::default()
        }
    }
}
