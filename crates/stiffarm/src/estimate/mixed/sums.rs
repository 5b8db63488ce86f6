//! Sums over the postures of an experiment from which the mixed model follows,
//! with and without single postures.

use super::means::gathered;
use crate::estimate::identify::Whitened;
use crate::numerics::information::scale_columns;
use nalgebra::{DMatrix, DVector};
use std::ops::Range;

/// Whitened rows of \[Ψ B e\] with their sums over all postures: fixed effects,
/// scaled random effects, and what least squares on Ψ leaves of the displacements.
#[derive(Clone)]
pub(super) struct Rows {
    /// Rows × (fixed + random + 1); what is known beforehand below the displacements.
    all: DMatrix<f64>,
    /// Number of rows of what is known.
    prior_count: usize,
    /// Variance ratio of the last class, where it is not told by the data.
    pub(super) held: Option<f64>,
    /// Number of fixed effects.
    pub(super) fixed: usize,
    /// Fixed effects without any share in the displacements: held at zero.
    pub(super) idle: Vec<usize>,
    /// Columns of each class among the random effects.
    pub(super) classes: Vec<Range<usize>>,
    /// Rows of each posture.
    postures: Vec<Range<usize>>,
    /// XᵀU of all postures side by side, one column for each direction of a shift; none
    /// where the data cannot tell shifts from noise.
    seen: DMatrix<f64>,
    /// The posture of each direction, and the squared size of a unit shift along it.
    directions: Vec<(usize, f64)>,
    /// Σ x xᵀ over all directions where they are of one size, as under equal loads: no posture counts then.
    alike: Option<DMatrix<f64>>,
    /// XᵀX of all postures without shifts.
    whole: DMatrix<f64>,
    /// Least squares on Ψ alone.
    pub(super) start: DVector<f64>,
}

/// The directions of some postures, all of one size.
pub(super) struct EqualDirections {
    size: f64,
    count: usize,
    /// Σ x xᵀ.
    gram: DMatrix<f64>,
}

/// Sizes nearer than this are one size.
const ONE_SIZE: f64 = 1e-9;

/// Sums of some postures at one ratio of the two variances.
pub(super) struct Sums {
    /// XᵀV⁻¹X.
    pub(super) gram: DMatrix<f64>,
    /// ln|V|.
    pub(super) logarithms: f64,
    /// Number of rows.
    pub(super) rows: usize,
}

/// Sums over the directions x of shifts that the information about γ needs, with
/// a² = γ·size and w = 1 + a².
pub(super) struct RatioSums {
    /// Σ (a/w)² x xᵀ.
    pub(super) first: DMatrix<f64>,
    /// Σ a⁴/w³ x xᵀ.
    pub(super) second: DMatrix<f64>,
    /// Σ a²/w.
    pub(super) trace: f64,
    /// Σ (a²/w)².
    pub(super) squares: f64,
}

/// What is known of random effects beside the readings: rows for them and what was read there, as sure as a
/// displacement, and the variance ratio of the class that they belong to, the last.
pub(super) struct PriorRows {
    pub(super) rows: DMatrix<f64>,
    pub(super) read: DVector<f64>,
    pub(super) ratio: Option<f64>,
}

impl PriorRows {
    /// Nothing of so many.
    pub(super) fn nothing(effects: usize) -> Self {
        PriorRows { rows: DMatrix::zeros(0, effects), read: DVector::zeros(0), ratio: None }
    }
}

impl Rows {
    /// Number of classes whose sizes the data tell.
    pub(super) fn estimated_count(&self) -> usize {
        self.classes.len() - usize::from(self.held.is_some())
    }

    /// `random` has one column per random effect, not yet white; `white` are the whitened displacements; the columns of
    /// the fixed effects `idle` are zero.
    pub(super) fn new(
        whitened: &Whitened,
        random: &DMatrix<f64>,
        classes: Vec<Range<usize>>,
        white: &DVector<f64>,
        (idle, shifts): (&[usize], bool),
    ) -> Self {
        let fixed = whitened.psi().ncols();
        let count = fixed + random.ncols() + 1;
        let mut all = DMatrix::zeros(whitened.rows(), count);
        all.columns_mut(0, fixed).copy_from(whitened.psi());
        all.column_mut(count - 1).copy_from(&whitened.residual(white));
        let (mut seen, mut along) = (Vec::new(), Vec::new());
        let postures: Vec<Range<usize>> = (0..whitened.block_count()).map(|b| whitened.block_rows(b)).collect();
        for (b, rows) in postures.iter().enumerate() {
            let mut block = random.rows(rows.start, rows.len()).into_owned();
            whitened.whiten_block(b, &mut block);
            all.view_mut((rows.start, fixed), block.shape()).copy_from(&block);
            if shifts {
                let (directions, sizes) = whitened.directions(b);
                let x = all.rows(rows.start, rows.len());
                let projected = x.tr_mul(directions);
                seen.extend(projected.column_iter().map(|column| column.into_owned()));
                along.extend(sizes.iter().map(|size| (b, *size)));
            }
        }
        let mut whole = all.transpose() * &all;
        // As if each had been read as zero: of the rest this changes nothing.
        idle.iter().for_each(|j| whole[(*j, *j)] += 1.0);
        let seen = if seen.is_empty() { DMatrix::zeros(count, 0) } else { DMatrix::from_columns(&seen) };
        let first = along.first().map_or(0.0, |(_, size): &(usize, f64)| *size);
        let is_alike = |(_, size): &(usize, f64)| (size / first - 1.0).abs() < ONE_SIZE;
        let alike = !along.is_empty() && along.iter().all(is_alike);
        Rows {
            prior_count: 0,
            held: None,
            all,
            fixed,
            idle: idle.to_vec(),
            classes,
            postures,
            alike: alike.then(|| &seen * seen.transpose()),
            seen,
            directions: along,
            whole,
            start: whitened.factor().solve(white),
        }
    }

    /// The same with random effects of other units: one of them is `scales` of those before, the columns of `means`
    /// share a mean; and with what `prior` knows of them.
    pub(super) fn of_effects(
        &self,
        scales: impl Iterator<Item = f64> + Clone,
        means: &[Range<usize>],
        prior: &PriorRows,
    ) -> Self {
        let fixed = self.fixed;
        let means: Vec<_> = means.iter().map(|mean| fixed + mean.start..fixed + mean.end).collect();
        let scales = std::iter::repeat_n(1.0, fixed).chain(scales);
        let changed = |mut columns: DMatrix<f64>| {
            scale_columns(&mut columns, scales.clone());
            gathered(&mut columns, &means);
            columns
        };
        let both = |sum: &DMatrix<f64>| changed(changed(sum.clone()).transpose());
        let (mut all, mut whole) = (changed(self.all.clone()), both(&self.whole));
        let (read, rows, last) = (prior.read.len(), all.nrows(), all.ncols() - 1);
        if read > 0 {
            all = all.resize_vertically(rows + read, 0.0);
            let mut below = all.rows_mut(rows, read);
            let mut random = below.columns_mut(fixed, prior.rows.ncols());
            random.copy_from(&prior.rows);
            below.column_mut(last).copy_from(&prior.read);
            whole += below.tr_mul(&below);
        }
        Rows {
            prior_count: read,
            held: prior.ratio,
            all,
            whole,
            seen: changed(self.seen.transpose()).transpose(),
            alike: self.alike.as_ref().map(both),
            idle: self.idle.clone(),
            classes: self.classes.clone(),
            postures: self.postures.clone(),
            directions: self.directions.clone(),
            start: self.start.clone(),
            ..*self
        }
    }

    /// Number of postures.
    pub(super) fn posture_count(&self) -> usize {
        self.postures.len()
    }

    /// True where shifts are told from noise.
    pub(super) fn has_shifts(&self) -> bool {
        !self.directions.is_empty()
    }

    /// Number of rows of displacements.
    fn measured(&self) -> usize {
        self.all.nrows() - self.prior_count
    }

    /// Norm of what least squares on Ψ leaves.
    pub(super) fn rest(&self) -> f64 {
        let rest = self.all.column(self.all.ncols() - 1);
        rest.rows(0, self.measured()).norm()
    }

    /// White columns of the random effects, without shifts.
    pub(super) fn random_columns(&self) -> DMatrix<f64> {
        let at = ((0, self.fixed), (self.measured(), self.random()));
        self.all.view(at.0, at.1).into_owned()
    }

    /// Rows of what is known of the random effects, and what was read there.
    pub(super) fn prior_rows(&self) -> (DMatrix<f64>, DVector<f64>) {
        let from = self.measured();
        let rows = self.all.view((from, self.fixed), (self.prior_count, self.random()));
        let read = self.all.column(self.all.ncols() - 1);
        (rows.into_owned(), read.rows(from, self.prior_count).into_owned())
    }

    /// Number of random effects.
    pub(super) fn random(&self) -> usize {
        self.all.ncols() - 1 - self.fixed
    }

    /// Mean square of a row that effects of variance 1 in class `class` give.
    pub(super) fn mean_square(&self, class: usize) -> f64 {
        let columns = self.classes[class].clone();
        let squares = columns.map(|c| self.whole[(self.fixed + c, self.fixed + c)]);
        squares.sum::<f64>() / self.measured() as f64
    }

    /// The postures that take part when `left_out` (ascending) do not.
    fn others<'a>(&'a self, left_out: &'a [usize]) -> impl Iterator<Item = usize> + 'a {
        (0..self.postures.len()).filter(move |b| left_out.binary_search(b).is_err())
    }

    /// Number and size of each direction of the postures that take part.
    fn directions_without<'a>(&'a self, left_out: &'a [usize]) -> impl Iterator<Item = (usize, f64)> + 'a {
        let all = self.directions.iter().enumerate();
        all.filter(move |(_, (posture, _))| left_out.binary_search(posture).is_err()).map(|(k, (_, size))| (k, *size))
    }

    /// XᵀX of all postures but `left_out`, without shifts.
    pub(super) fn plain(&self, left_out: &[usize]) -> DMatrix<f64> {
        let mut gram = self.whole.clone();
        for &b in left_out {
            let rows = &self.postures[b];
            let block = self.all.rows(rows.start, rows.len());
            gram.gemm_tr(-1.0, &block, &block, 1.0);
        }
        gram
    }

    /// The directions of all postures but `left_out`, where all are of one size.
    pub(super) fn alike(&self, left_out: &[usize]) -> Option<EqualDirections> {
        let mut gram = self.alike.clone()?;
        let mut count = self.directions.len();
        for (k, (posture, _)) in self.directions.iter().enumerate() {
            if left_out.binary_search(posture).is_ok() {
                let column = self.seen.column(k);
                gram.ger(-1.0, &column, &column, 1.0);
                count -= 1;
            }
        }
        let size = self.directions[0].1;
        Some(EqualDirections { size, count, gram })
    }

    /// The sums of all postures but `left_out`, of which `plain` are those without
    /// shifts and `alike` their directions, at the ratio `gamma` of the two variances.
    pub(super) fn at(
        &self,
        gamma: f64,
        left_out: &[usize],
        plain: &DMatrix<f64>,
        alike: Option<&EqualDirections>,
    ) -> Sums {
        let mut out = Sums {
            gram: plain.clone(),
            logarithms: 0.0,
            rows: self.prior_count + self.others(left_out).map(|b| self.postures[b].len()).sum::<usize>(),
        };
        if gamma <= 0.0 {
            return out;
        }
        if let Some(alike) = alike {
            let part = gamma * alike.size;
            out.gram -= &alike.gram * (part / (1.0 + part));
            out.logarithms = alike.count as f64 * part.ln_1p();
            return out;
        }
        let mut scaled = self.seen.transpose();
        let mut parts = vec![0.0; self.directions.len()];
        for (k, size) in self.directions_without(left_out) {
            parts[k] = gamma * size / (1.0 + gamma * size);
            out.logarithms += (gamma * size).ln_1p();
        }
        for (mut row, part) in scaled.row_iter_mut().zip(&parts) {
            row *= *part;
        }
        out.gram.gemm(-1.0, &self.seen, &scaled, 1.0);
        out
    }

    /// What the information about γ needs, in columns times `scale`.
    pub(super) fn ratio_sums(&self, gamma: f64, left_out: &[usize], scale: &DVector<f64>) -> RatioSums {
        let count = scale.len();
        let directions: Vec<(usize, f64)> = self.directions_without(left_out).collect();
        let mut x = DMatrix::zeros(count, directions.len());
        let (mut trace, mut squares) = (0.0, 0.0);
        for (to, (k, size)) in directions.iter().enumerate() {
            let part = gamma * size;
            let column = self.seen.column(*k);
            let factor = part.sqrt() / (1.0 + part);
            x.set_column(to, &(column.rows(0, count).component_mul(scale) * factor));
            trace += part / (1.0 + part);
            squares += (part / (1.0 + part)).powi(2);
        }
        let first = &x * x.transpose();
        for (to, (_, size)) in directions.iter().enumerate() {
            let part = gamma * size;
            x.column_mut(to).scale_mut((part / (1.0 + part)).sqrt());
        }
        RatioSums { second: &x * x.transpose(), first, trace, squares }
    }

    /// Derivatives by ln γ at `solution` (of X's columns, −1 for the last), where `whitened` makes of columns x of
    /// unknowns those whose squares are xᵀ(XᵀV⁻¹X)⁻¹x, and `inverse` is that inverse.
    pub(super) fn by_ratio(
        &self,
        gamma: f64,
        left_out: &[usize],
        solution: &DVector<f64>,
        alike: Option<&EqualDirections>,
        whitened: &dyn Fn(&DMatrix<f64>) -> DMatrix<f64>,
        inverse: &dyn Fn() -> DMatrix<f64>,
    ) -> ByRatio {
        let unknowns = solution.len() - 1;
        // With fewer directions than unknowns their own columns are less work.
        if let Some(alike) = alike.filter(|alike| alike.count > unknowns) {
            let part = gamma * alike.size;
            let change = part / (1.0 + part).powi(2);
            let moved = &alike.gram * solution * change;
            let squares = solution.dot(&moved);
            let gram = alike.gram.view((0, 0), (unknowns, unknowns));
            return ByRatio {
                logarithms: alike.count as f64 * part / (1.0 + part),
                determinant: -change * inverse().dot(&gram),
                twice: squares * part / (1.0 + part),
                squares,
                moved,
            };
        }
        let directions: Vec<(usize, f64)> = self.directions_without(left_out).collect();
        let columns = directions.iter().map(|(k, _)| self.seen.column(*k));
        let x = DMatrix::from_columns(&columns.collect::<Vec<_>>());
        let left = x.tr_mul(solution);
        let seen = whitened(&x.rows(0, unknowns).into_owned());
        let mut out = ByRatio { logarithms: 0.0, squares: 0.0, determinant: 0.0, twice: 0.0, moved: DVector::zeros(0) };
        let mut changed = left.clone();
        for (i, (_, size)) in directions.iter().enumerate() {
            let part = gamma * size;
            let change = part / (1.0 + part).powi(2);
            out.logarithms += part / (1.0 + part);
            out.squares += change * left[i].powi(2);
            out.twice += change * part / (1.0 + part) * left[i].powi(2);
            out.determinant -= change * seen.column(i).norm_squared();
            changed[i] *= change;
        }
        out.moved = x * changed;
        out
    }
}

/// What changes with ln γ.
pub(super) struct ByRatio {
    /// Derivative of ln|V|.
    pub(super) logarithms: f64,
    /// Derivative of the squares that are left, its sign changed.
    pub(super) squares: f64,
    /// Derivative of ln|XᵀV⁻¹X|.
    pub(super) determinant: f64,
    /// wᵀV⁻¹w of w = ∂V/∂ln γ V⁻¹ r, r what is left.
    pub(super) twice: f64,
    /// XᵀV⁻¹w, its sign changed.
    pub(super) moved: DVector<f64>,
}
