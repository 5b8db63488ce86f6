//! The restricted likelihood of the mixed model, which its sizes maximise
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

use super::directions::Directions;
use super::sums::Rows;
use crate::model::elastic::ElasticClass;
use crate::numerics::information::cholesky::Cholesky;
use nalgebra::{DMatrix, DVector};

/// Sizes of the random parts in units of σ².
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Sizes {
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
    active: Vec<usize>,
    /// Λ^(1/2) of each column, 1 for fixed effects.
    scale: DVector<f64>,
    /// XᵀV⁻¹X, the displacements its last column.
    gram: DMatrix<f64>,
}

impl Solved {
    /// h, then u, in the columns' own units, of the system behind `rows`.
    pub(super) fn values(&self, rows: &Rows) -> DVector<f64> {
        let mut out = self.change.clone();
        let mut axes = out.rows_mut(0, rows.fixed);
        axes += rows.start();
        out
    }

    /// Inverse of the mixed-model equations: times s² the covariance of h and u − û.
    pub(super) fn inverse(&self) -> DMatrix<f64> {
        self.scaled(self.scaled_inverse())
    }

    /// Inverse of A, both triangles the same.
    pub(super) fn scaled_inverse(&self) -> DMatrix<f64> {
        let (count, inverse) = (self.scale.len(), self.factor.inverse());
        if self.active.len() == count {
            return inverse;
        }
        let mut out = DMatrix::identity(count, count);
        for (j, to) in self.active.iter().enumerate() {
            for (i, row) in self.active.iter().enumerate() {
                out[(*row, *to)] = inverse[(i, j)];
            }
        }
        out
    }

    /// L⁻¹Λ^(1/2) x of columns x of unknowns, A = L Lᵀ: their squares are xᵀ(XᵀV⁻¹X + Λ⁻¹)⁻¹x.
    fn whitened(&self, x: &DMatrix<f64>) -> DMatrix<f64> {
        let scaled =
            DMatrix::from_fn(self.active.len(), x.ncols(), |i, j| x[(self.active[i], j)] * self.scale[self.active[i]]);
        self.factor.whitened(&scaled)
    }

    /// Diagonal of A⁻¹.
    fn scaled_diagonal(&self) -> DVector<f64> {
        let mut out = DVector::from_element(self.scale.len(), 1.0);
        for (i, value) in self.active.iter().zip(&self.factor.inverse_diagonal()) {
            out[*i] = *value;
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
pub(super) struct Likelihood {
    rows: Rows,
    /// XᵀX without shifts.
    plain: DMatrix<f64>,
    /// Number of rows.
    count: usize,
    directions: Directions,
}

impl Likelihood {
    /// Of all postures but `left_out` (ascending).
    pub(super) fn new(rows: Rows, left_out: &[usize]) -> Self {
        let (plain, count) = rows.plain(left_out);
        Likelihood { plain, count, directions: rows.directions(left_out), rows }
    }

    pub(super) fn rows(&self) -> &Rows {
        &self.rows
    }

    /// Directions of the shifts of the postures that take part.
    pub(super) fn directions(&self) -> &Directions {
        &self.directions
    }

    /// `None` where the equations cannot be solved, or nothing is left of the
    /// displacements.
    pub(super) fn solve(&self, sizes: &Sizes) -> Option<Solved> {
        let (fixed, random) = (self.rows.fixed, self.rows.random());
        let unknowns = fixed + random;
        let mut gram = self.plain.clone();
        let logarithms = self.directions.take_from(&mut gram, sizes.gamma);
        let free = self.count + self.rows.idle.len();
        let free = free.checked_sub(fixed).filter(|free| *free > 0)?;
        let mut scale = DVector::from_element(unknowns, 1.0);
        for (class, size) in self.rows.classes.iter().zip(&sizes.classes) {
            scale.rows_mut(fixed + class.start, class.len()).fill(size.sqrt());
        }
        let active: Vec<usize> = (0..unknowns).filter(|i| scale[*i] > 0.0).collect();
        let mut matrix = DMatrix::zeros(active.len(), active.len());
        for (j, from) in active.iter().enumerate() {
            let (column, size) = (gram.column(*from), scale[*from]);
            // The factor reads the lower triangle.
            for (i, row) in active.iter().enumerate().skip(j) {
                matrix[(i, j)] = column[*row] * scale[*row] * size;
            }
        }
        for i in fixed..active.len() {
            matrix[(i, i)] += 1.0;
        }
        let right = DVector::from_fn(active.len(), |i, _| gram[(active[i], unknowns)] * scale[active[i]]);
        let factor = Cholesky::new(&matrix)?;
        let solution = factor.solve(&right);
        let left = gram[(unknowns, unknowns)] - right.dot(&solution);
        if !(left > 0.0 && left.is_finite()) {
            return None;
        }
        let determinant = factor.ln_determinant();
        let variance = left / free as f64;
        let mut change = DVector::zeros(unknowns);
        for (i, value) in active.iter().zip(solution.iter()) {
            change[*i] = value * scale[*i];
        }
        Some(Solved {
            value: free as f64 * variance.ln() + logarithms + determinant,
            change,
            variance,
            free,
            factor,
            active,
            scale,
            gram,
        })
    }

    /// −2 ln L_R and its derivatives by ln γ (where the data tell shifts from noise)
    /// and by the ln λ of each class.
    pub(super) fn value_and_gradient(&self, sizes: &Sizes) -> Option<(f64, Vec<f64>)> {
        let slopes = self.slopes(sizes)?;
        Some((slopes.value, slopes.gradient.as_slice().to_vec()))
    }

    /// The same with the average of the observed and the expected curvature: a class scatters as w = ∂V/∂θ P y, and
    /// wᵀP w is all it takes (Gilmour, Thompson & Cullis, Biometrics 51, 1995, 1440–1450, doi:10.2307/2533274); less
    /// what ln s² takes of it.
    pub(super) fn slopes(&self, sizes: &Sizes) -> Option<Slopes> {
        let solved = self.solve(sizes)?;
        let (fixed, unknowns) = (self.rows.fixed, solved.change.len());
        let shared = usize::from(self.rows.has_shifts());
        let count = shared + self.rows.estimated_count();
        let mut gradient = DVector::zeros(count);
        // XᵀV⁻¹w, wᵀP y and, of the shifts, wᵀV⁻¹w.
        let mut moved = DMatrix::zeros(unknowns, count);
        let mut along = DVector::zeros(count);
        let mut gram = DMatrix::zeros(count, count);
        if shared == 1 {
            let solution = solved.change.clone().resize_vertically(unknowns + 1, -1.0);
            let inverse = || solved.scaled(solved.scaled_inverse());
            let ratio = self.directions.by_ratio(sizes.gamma, &solution, |x| solved.whitened(x), inverse);
            gradient[0] = ratio.logarithms - ratio.squares / solved.variance + ratio.determinant;
            along[0] = ratio.squares;
            gram[(0, 0)] = ratio.twice;
            moved.set_column(0, &-ratio.moved.rows(0, unknowns));
        }
        let diagonal = solved.scaled_diagonal();
        let range = |c: usize| {
            let class = &self.rows.classes[c];
            (fixed + class.start, class.len())
        };
        for c in (0..self.rows.estimated_count()).filter(|c| sizes.classes[*c] > 0.0) {
            let (from, len) = range(c);
            let effects = solved.change.rows(from, len);
            let squares = effects.norm_squared() / sizes.classes[c];
            let trace = diagonal.rows(from, len).sum();
            gradient[shared + c] = len as f64 - trace - squares / solved.variance;
            along[shared + c] = squares;
            moved.set_column(shared + c, &(solved.gram.view((0, from), (unknowns, len)) * effects));
        }
        for c in 0..self.rows.estimated_count() {
            let (from, len) = range(c);
            let effects = solved.change.rows(from, len);
            for k in 0..=shared + c {
                let value = effects.dot(&moved.view((from, k), (len, 1)));
                gram[(shared + c, k)] = value;
                gram[(k, shared + c)] = value;
            }
        }
        let seen = solved.whitened(&moved);
        let free = solved.free as f64 * solved.variance;
        let curvature = gram - seen.tr_mul(&seen) - &along * along.transpose() / free;
        Some(Slopes { value: solved.value, gradient, curvature: curvature / solved.variance })
    }
}

/// −2 ln L_R with its derivatives by ln γ and the ln λ of each class.
pub(super) struct Slopes {
    pub(super) value: f64,
    pub(super) gradient: DVector<f64>,
    pub(super) curvature: DMatrix<f64>,
}
