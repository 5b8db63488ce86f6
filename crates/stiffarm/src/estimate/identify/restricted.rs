//! The restricted likelihood of a whitened system as a function of γ = τ²/σ²
//! (REML: Patterson & Thompson, Biometrika 58, 1971, 545–554,
//! doi:10.1093/biomet/58.3.545).
//!
//! With the orthonormal basis B of Ψ's columns and the residual e of least
//! squares without shifts it takes four sums over the postures at each γ:
//! BᵀV⁻¹B, BᵀV⁻¹e, eᵀV⁻¹e and ln|V|. Those of all postures but some are the
//! difference of two such sums, so that leaving a posture out costs as much as
//! one posture. The sums are analytic in ln γ, nearest singularity at a
//! distance of π from the real axis: on a window two wide [`NODES`] Chebyshev
//! points give them to rounding (Trefethen, Approximation Theory and
//! Approximation Practice, SIAM 2013, ch. 8), whatever the number of postures.

use super::whitened::{GRID, STEP, Whitened, Whitening, grid_place, share};
use crate::numerics::scalar::minimum;
use nalgebra::{DMatrix, DVector};
use std::f64::consts::PI;
use std::sync::OnceLock;

/// Chebyshev points of a window: (π + √(π² + 1))^−20 is below the rounding.
const NODES: usize = 20;
/// Accuracy of ln γ.
const TOLERANCE: f64 = 1e-8;

/// BᵀV⁻¹B column by column, BᵀV⁻¹e, eᵀV⁻¹e and ln|V|, one after the other.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Sums(Vec<f64>);

impl Sums {
    fn zero(rank: usize) -> Self {
        Sums(vec![0.0; rank * rank + rank + 2])
    }

    /// BᵀV⁻¹B, BᵀV⁻¹e and eᵀV⁻¹e.
    pub(super) fn parts(&self, rank: usize) -> (DMatrix<f64>, DVector<f64>, f64) {
        let (information, rest) = self.0.split_at(rank * rank);
        (
            DMatrix::from_column_slice(rank, rank, information),
            DVector::from_column_slice(&rest[..rank]),
            rest[rank],
        )
    }

    pub(super) fn minus(&self, other: &Sums) -> Sums {
        Sums(self.0.iter().zip(&other.0).map(|(a, b)| a - b).collect())
    }
}

/// The restricted likelihood of one set of displacements.
#[derive(Debug)]
pub struct Restricted<'a> {
    system: &'a Whitened,
    /// Residual e without shifts.
    residual: DVector<f64>,
    /// Uᵀe of each posture.
    moved: Vec<DVector<f64>>,
    /// True where e is rounding, so that nothing tells shifts from noise.
    rounding: bool,
    /// Sums over all postures at the points of the grid.
    grid: OnceLock<Vec<Sums>>,
    /// Sums at the Chebyshev points of each window; the first ends at the
    /// grid's first point.
    windows: Vec<OnceLock<Vec<Sums>>>,
}

impl<'a> Restricted<'a> {
    pub(super) fn new(system: &'a Whitened, white: &DVector<f64>) -> Self {
        let residual = system.residual(white);
        let size = residual.norm_squared();
        let rounding = (64.0 * f64::EPSILON).powi(2) * white.norm_squared();
        let moved = (0..system.block_count())
            .map(|b| {
                let rows = system.block_rows(b);
                let own = residual.rows(rows.start, rows.len());
                system.directions(b).0.tr_mul(&own)
            })
            .collect();
        Restricted {
            system,
            rounding: size <= rounding || !size.is_finite(),
            residual,
            moved,
            grid: OnceLock::new(),
            windows: (0..=GRID.len()).map(|_| OnceLock::new()).collect(),
        }
    }

    /// True where the residual is rounding.
    pub(super) fn is_rounding(&self) -> bool {
        self.rounding
    }

    /// eᵀe.
    pub(super) fn size(&self) -> f64 {
        self.residual.norm_squared()
    }

    fn rank(&self) -> usize {
        self.system.factor().rank()
    }

    /// −2 ln L at γ, up to a constant, σ² profiled out.
    pub fn value(&self, gamma: f64) -> f64 {
        self.value_of(&self.at(gamma))
    }

    fn value_of(&self, sums: &Sums) -> f64 {
        value(sums, self.rank(), self.system.rows())
    }

    /// The sums over all postures at γ.
    pub(super) fn at(&self, gamma: f64) -> Sums {
        let all = 0..self.system.block_count();
        self.all(all, |by, k| share(gamma, by.size(k)))
    }

    /// The same at point `i` of the grid.
    fn on_grid(&self, i: usize) -> Sums {
        self.all(0..self.system.block_count(), |by, k| by.on_grid(i, k))
    }

    fn all(
        &self,
        blocks: impl Iterator<Item = usize>,
        share: impl Fn(&Whitening, usize) -> [f64; 2],
    ) -> Sums {
        let rank = self.rank();
        let mut out = Sums::zero(rank);
        // BᵀB = I and Bᵀe = 0 without shifts.
        (0..rank).for_each(|j| out.0[j * rank + j] = 1.0);
        out.0[rank * rank + rank] = self.size();
        self.add_shifts(&mut out, blocks, share);
        out
    }

    /// Adds what the shifts of `blocks` change.
    fn add_shifts(
        &self,
        out: &mut Sums,
        blocks: impl Iterator<Item = usize>,
        share: impl Fn(&Whitening, usize) -> [f64; 2],
    ) {
        // Loops of known length are faster: the joints of an arm, and one term more.
        match self.rank() {
            6 => self.add(6, out, blocks, share),
            7 => self.add(7, out, blocks, share),
            rank => self.add(rank, out, blocks, share),
        }
    }

    #[inline(always)]
    fn add(
        &self,
        rank: usize,
        out: &mut Sums,
        blocks: impl Iterator<Item = usize>,
        share: impl Fn(&Whitening, usize) -> [f64; 2],
    ) {
        let (information, rest) = out.0.split_at_mut(rank * rank);
        let (moment, rest) = rest.split_at_mut(rank);
        let (mut size, mut logarithms) = (0.0, 0.0);
        for b in blocks {
            let (by, seen) = self.system.seen(b);
            for (k, moved) in self.moved[b].iter().enumerate() {
                let [part, logarithm] = share(by, k);
                let row = &seen.as_slice()[k * rank..(k + 1) * rank];
                size -= part * moved * moved;
                logarithms += logarithm;
                for j in 0..rank {
                    moment[j] -= part * row[j] * moved;
                    let scale = part * row[j];
                    for i in 0..rank {
                        information[j * rank + i] -= scale * row[i];
                    }
                }
            }
        }
        rest[0] += size;
        rest[1] += logarithms;
    }

    /// The sums over the postures `blocks` alone without shifts.
    pub(super) fn own(&self, blocks: &[usize]) -> Sums {
        let rank = self.rank();
        let mut information = DMatrix::zeros(rank, rank);
        let mut moment = DVector::zeros(rank);
        let mut size = 0.0;
        for &b in blocks {
            let rows = self.system.block_rows(b);
            let basis = self.system.basis().rows(rows.start, rows.len());
            let residual = self.residual.rows(rows.start, rows.len());
            information += basis.tr_mul(&basis);
            moment += basis.tr_mul(&residual);
            size += residual.norm_squared();
        }
        let mut out = Sums::zero(rank);
        out.0[..rank * rank].copy_from_slice(information.as_slice());
        out.0[rank * rank..][..rank].copy_from_slice(moment.as_slice());
        out.0[rank * rank + rank] = size;
        out
    }

    /// The sums over all postures but `blocks` at ln γ = `place`, `own` being
    /// theirs without shifts.
    fn others(&self, blocks: &[usize], own: &Sums, place: f64) -> Sums {
        let mut theirs = own.clone();
        let gamma = place.exp();
        let share = |by: &Whitening, k: usize| share(gamma, by.size(k));
        self.add_shifts(&mut theirs, blocks.iter().copied(), share);
        self.between(place).minus(&theirs)
    }

    /// The sums over all postures but `blocks` at γ; `all` are those over all.
    pub(super) fn without(&self, blocks: &[usize], own: &Sums, all: &Sums, gamma: f64) -> Sums {
        let mut theirs = own.clone();
        let share = |by: &Whitening, k: usize| share(gamma, by.size(k));
        self.add_shifts(&mut theirs, blocks.iter().copied(), share);
        all.minus(&theirs)
    }

    /// The sums over all postures at ln γ = `place`, from the Chebyshev points of
    /// the window around it.
    pub(super) fn between(&self, place: f64) -> Sums {
        let from_start = (place - grid_place(0)) / STEP + 1.0;
        let window = (from_start.floor().max(0.0) as usize).min(GRID.len());
        let start = grid_place(0) + STEP * (window as f64 - 1.0);
        let angle = |j: usize| PI * (j as f64 + 0.5) / NODES as f64;
        let node = |j: usize| start + 0.5 * STEP * (1.0 + angle(j).cos());
        let sums = self.windows[window]
            .get_or_init(|| (0..NODES).map(|j| self.at(node(j).exp())).collect());
        let mut total = 0.0;
        let mut out = Sums::zero(self.rank());
        for (j, sums) in sums.iter().enumerate() {
            let away = place - node(j);
            if away == 0.0 {
                return sums.clone();
            }
            let sign = if j % 2 == 0 { 1.0 } else { -1.0 };
            let weight = sign * angle(j).sin() / away;
            total += weight;
            for (out, value) in out.0.iter_mut().zip(&sums.0) {
                *out += weight * value;
            }
        }
        out.0.iter_mut().for_each(|v| *v /= total);
        out
    }

    fn grid(&self) -> &[Sums] {
        self.grid
            .get_or_init(|| (0..GRID.len()).map(|i| self.on_grid(i)).collect())
    }

    /// The γ ≥ 0 with the smallest value, and that value.
    pub(super) fn best_ratio(&self) -> (f64, f64) {
        let points = (0..GRID.len()).map(|i| self.value_of(&self.on_grid(i)));
        best(points, self.value(0.0), |x| self.value(x.exp()))
    }

    /// The γ ≥ 0 with the smallest `value` of the sums over all postures, and
    /// that value.
    pub(super) fn best_by(&self, value: impl Fn(&Sums) -> f64) -> (f64, f64) {
        let points = self.grid().iter().map(&value);
        best(points, value(&self.at(0.0)), |x| value(&self.between(x)))
    }

    /// The γ ≥ 0 with the smallest value for all postures but `blocks`, that
    /// have `rows` rows; `own` are the sums over `blocks` without shifts.
    pub(super) fn best_without(&self, blocks: &[usize], own: &Sums, rows: usize) -> f64 {
        let rank = self.rank();
        let points = self.grid().iter().enumerate().map(|(i, all)| {
            let mut theirs = own.clone();
            let share = |by: &Whitening, k: usize| by.on_grid(i, k);
            self.add_shifts(&mut theirs, blocks.iter().copied(), share);
            value(&all.minus(&theirs), rank, rows)
        });
        let none = value(&self.at(0.0).minus(own), rank, rows);
        let at = |x: f64| value(&self.others(blocks, own, x), rank, rows);
        best(points, none, at).0
    }
}

/// The γ ≥ 0 with the smallest value, and that value: from the values at the
/// grid's points and at zero, then by Brent's method about the best point.
fn best(points: impl Iterator<Item = f64>, zero: f64, at: impl Fn(f64) -> f64) -> (f64, f64) {
    let none = (0.0, zero);
    let best = points
        .enumerate()
        .map(|(i, value)| (grid_place(i), value))
        .reduce(|best, next| if next.1 < best.1 { next } else { best });
    let Some(best) = best.filter(|best| best.1.is_finite()) else {
        return none;
    };
    let ends = [best.0 - STEP, best.0 + STEP];
    let (place, value) = minimum(at, ends, best, TOLERANCE);
    match value < none.1 {
        true => (place.exp(), value),
        false => none,
    }
}

/// −2 ln L of `rows` rows, up to a constant.
fn value(sums: &Sums, rank: usize, rows: usize) -> f64 {
    let (information, moment, size) = sums.parts(rank);
    let Some(cholesky) = information.cholesky() else {
        return f64::INFINITY;
    };
    let root = cholesky.l_dirty();
    let determinant: f64 = (0..rank).map(|i| 2.0 * root[(i, i)].ln()).sum();
    let rest = size - moment.dot(&cholesky.solve(&moment));
    if rest <= 0.0 {
        return f64::INFINITY;
    }
    rows.saturating_sub(rank) as f64 * rest.ln() + sums.logarithms(rank) + determinant
}

impl Sums {
    fn logarithms(&self, rank: usize) -> f64 {
        self.0[rank * rank + rank + 1]
    }

    /// −2 ln L, up to a constant, of `rows` rows with unknown j held at the
    /// distance `away` from its estimate without shifts; `along` is its row of
    /// the matrix that takes coordinates in the basis B to unknowns.
    ///
    /// With c = BᵀV⁻¹B the others' information has the determinant
    /// |c|·(tᵀc⁻¹t)/(tᵀt), and holding t·x at d adds (d − t·x̂)²/(tᵀc⁻¹t) to the
    /// squares.
    pub(super) fn held(&self, along: &DVector<f64>, away: f64, rows: usize) -> f64 {
        let rank = along.len();
        let (information, moment, size) = self.parts(rank);
        let Some(cholesky) = information.cholesky() else {
            return f64::INFINITY;
        };
        let root = cholesky.l_dirty();
        let determinant: f64 = (0..rank).map(|i| 2.0 * root[(i, i)].ln()).sum();
        let best = cholesky.solve(&moment);
        let variance = along.dot(&cholesky.solve(along));
        let rest = size - moment.dot(&best) + (away - along.dot(&best)).powi(2) / variance;
        if rest <= 0.0 || variance <= 0.0 {
            return f64::INFINITY;
        }
        (rows + 1).saturating_sub(rank) as f64 * rest.ln()
            + self.logarithms(rank)
            + determinant
            + (variance / along.norm_squared()).ln()
    }
}
