//! Sums over the postures of an experiment from which the mixed model follows,
//! with and without single postures.

use super::directions::{Directions, EqualDirections, SizedColumns};
use super::means::gathered;
use crate::estimate::identify::Whitened;
use crate::numerics::information::scale_columns;
use nalgebra::{DMatrix, DVector};
use std::ops::Range;
use std::sync::Arc;

/// Whitened rows of \[Ψ B e\], the random effects in units of their own, as all models of a fit share them: fixed
/// effects, random effects, and what least squares on Ψ leaves of the displacements.
struct SharedRows {
    /// Rows × (fixed + random + 1).
    all: DMatrix<f64>,
    /// Rows of each posture.
    postures: Vec<Range<usize>>,
    /// XᵀU of all postures side by side, one column for each direction of a shift; none
    /// where the data cannot tell shifts from noise.
    seen: DMatrix<f64>,
    /// The posture of each direction, and the squared size of a unit shift along it.
    directions: Vec<(usize, f64)>,
    /// Least squares on Ψ alone.
    start: DVector<f64>,
}

/// The rows in the units of a model, with their sums over all postures. Rows are made from the shared ones where they
/// are needed: a model without one posture needs those of that posture alone.
#[derive(Clone)]
pub(super) struct Rows {
    shared: Arc<SharedRows>,
    units: Units,
    prior: PriorRows,
    /// Number of fixed effects.
    pub(super) fixed: usize,
    /// Fixed effects without any share in the displacements: held at zero.
    pub(super) idle: Vec<usize>,
    /// Columns of each class among the random effects.
    pub(super) classes: Vec<Range<usize>>,
    /// XᵀX of all postures without shifts, and of what is known beforehand.
    whole: DMatrix<f64>,
    /// All directions by their sizes; none where that would be more than the directions themselves.
    groups: Vec<EqualDirections>,
}

/// What makes columns of shared rows those of a model.
#[derive(Clone)]
struct Units {
    /// Units of the columns, 1 for fixed effects; one more column, the displacements, has none.
    scales: Vec<f64>,
    /// Columns that share a mean.
    means: Vec<Range<usize>>,
}

impl Units {
    fn of_columns(&self, mut columns: DMatrix<f64>) -> DMatrix<f64> {
        scale_columns(&mut columns, self.scales.iter().copied());
        gathered(&mut columns, &self.means);
        columns
    }

    /// The same of rows and columns.
    fn of_both(&self, sum: &DMatrix<f64>) -> DMatrix<f64> {
        self.of_columns(self.of_columns(sum.clone()).transpose())
    }
}

/// What is known of random effects beside the readings: rows for them and what was read there, as sure as a
/// displacement, and the variance ratio of the class that they belong to, the last.
#[derive(Clone)]
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
        self.classes.len() - usize::from(self.prior.ratio.is_some())
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
        let (mut seen, mut directions) = (Vec::new(), Vec::new());
        let postures: Vec<Range<usize>> = (0..whitened.block_count()).map(|b| whitened.block_rows(b)).collect();
        for (b, rows) in postures.iter().enumerate() {
            let mut block = random.rows(rows.start, rows.len()).into_owned();
            whitened.whiten_block(b, &mut block);
            all.view_mut((rows.start, fixed), block.shape()).copy_from(&block);
            if shifts {
                let (along, sizes) = whitened.directions(b);
                let x = all.rows(rows.start, rows.len());
                let projected = x.tr_mul(along);
                seen.extend(projected.column_iter().map(|column| column.into_owned()));
                directions.extend(sizes.iter().map(|size| (b, *size)));
            }
        }
        let mut whole = all.transpose() * &all;
        // As if each had been read as zero: of the rest this changes nothing.
        idle.iter().for_each(|j| whole[(*j, *j)] += 1.0);
        let seen = if seen.is_empty() { DMatrix::zeros(count, 0) } else { DMatrix::from_columns(&seen) };
        let start = whitened.factor().solve(white);
        Rows {
            units: Units { scales: vec![1.0; count - 1], means: Vec::new() },
            prior: PriorRows::nothing(random.ncols()),
            fixed,
            idle: idle.to_vec(),
            classes,
            whole,
            groups: EqualDirections::all(&seen, &directions),
            shared: Arc::new(SharedRows { all, postures, seen, directions, start }),
        }
    }

    /// The same with random effects of other units: one of them is `scales` of those before, the columns of `means`
    /// share a mean; and with what `prior` knows of them.
    pub(super) fn of_effects(
        &self,
        scales: impl Iterator<Item = f64>,
        means: &[Range<usize>],
        prior: PriorRows,
    ) -> Self {
        let fixed = self.fixed;
        let units = Units {
            scales: std::iter::repeat_n(1.0, fixed).chain(scales).collect(),
            means: means.iter().map(|mean| fixed + mean.start..fixed + mean.end).collect(),
        };
        let groups = self.groups.iter().map(|group| group.with_gram(units.of_both(&group.gram)));
        let mut out = Rows {
            shared: self.shared.clone(),
            prior,
            fixed,
            idle: self.idle.clone(),
            classes: self.classes.clone(),
            whole: units.of_both(&self.whole),
            groups: groups.collect(),
            units,
        };
        if !out.prior.read.is_empty() {
            let mut below = DMatrix::zeros(out.prior.read.len(), out.whole.ncols());
            below.columns_mut(fixed, out.prior.rows.ncols()).copy_from(&out.prior.rows);
            let last = below.ncols() - 1;
            below.set_column(last, &out.prior.read);
            out.whole += below.tr_mul(&below);
        }
        out
    }

    /// Variance ratio of the last class, where it is not told by the data.
    pub(super) fn held(&self) -> Option<f64> {
        self.prior.ratio
    }

    /// Least squares on Ψ alone.
    pub(super) fn start(&self) -> &DVector<f64> {
        &self.shared.start
    }

    /// Number of postures.
    pub(super) fn posture_count(&self) -> usize {
        self.shared.postures.len()
    }

    /// True where shifts are told from noise.
    pub(super) fn has_shifts(&self) -> bool {
        !self.shared.directions.is_empty()
    }

    /// Norm of what least squares on Ψ leaves.
    pub(super) fn rest(&self) -> f64 {
        let all = &self.shared.all;
        all.column(all.ncols() - 1).norm()
    }

    /// White columns of the random effects, without shifts.
    pub(super) fn random_columns(&self) -> DMatrix<f64> {
        self.units.of_columns(self.shared.all.clone()).columns(self.fixed, self.random()).into_owned()
    }

    /// What is known of the random effects beside the readings.
    pub(super) fn prior(&self) -> &PriorRows {
        &self.prior
    }

    /// Number of random effects.
    pub(super) fn random(&self) -> usize {
        self.units.scales.len() - self.fixed
    }

    /// Mean square of a row that effects of variance 1 in class `class` give.
    pub(super) fn mean_square(&self, class: usize) -> f64 {
        let columns = self.classes[class].clone();
        let squares = columns.map(|c| self.whole[(self.fixed + c, self.fixed + c)]);
        squares.sum::<f64>() / self.shared.all.nrows() as f64
    }

    /// XᵀX of all postures but `left_out` (ascending), without shifts, and the number of its rows.
    pub(super) fn plain(&self, left_out: &[usize]) -> (DMatrix<f64>, usize) {
        let (mut gram, mut count) = (self.whole.clone(), self.prior.read.len() + self.shared.all.nrows());
        for &b in left_out {
            let rows = &self.shared.postures[b];
            let block = self.units.of_columns(self.shared.all.rows(rows.start, rows.len()).into_owned());
            gram.gemm(-1.0, &block.transpose(), &block, 1.0);
            count -= rows.len();
        }
        (gram, count)
    }

    /// The directions of shifts of all postures but `left_out` (ascending).
    pub(super) fn directions(&self, left_out: &[usize]) -> Directions {
        let SharedRows { seen, directions, .. } = &*self.shared;
        let of = |is_chosen: &dyn Fn(&usize) -> bool| {
            let chosen = directions.iter().enumerate().filter(|(_, (posture, _))| is_chosen(posture));
            let (numbers, sizes): (Vec<usize>, Vec<f64>) = chosen.map(|(k, (_, size))| (k, *size)).unzip();
            let columns = self.units.of_columns(seen.select_columns(&numbers).transpose()).transpose();
            SizedColumns { columns, sizes }
        };
        let is_out = |posture: &usize| left_out.binary_search(posture).is_ok();
        let left = of(&is_out);
        let groups: Vec<EqualDirections> = self.groups.iter().map(|group| group.without(&left)).collect();
        // With fewer directions than unknowns their own columns are less work.
        let count = directions.len() - left.sizes.len();
        let few = count <= groups.len() * self.units.scales.len();
        let columns = (groups.is_empty() || few).then(|| of(&|posture| !is_out(posture)));
        Directions { groups, columns }
    }
}
