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
use crate::numerics::information::small::{cholesky, invert_lower, packed};
use crate::numerics::scalar::minimum;
use nalgebra::{DMatrix, DVector};
use std::f64::consts::PI;
use std::sync::OnceLock;

/// Chebyshev points of a window: (π + √(π² + 1))^−20 is below the rounding.
const NODES: usize = 20;
/// Accuracy of ln γ.
const TOLERANCE: f64 = 1e-8;

/// BᵀV⁻¹B as a packed lower triangle, BᵀV⁻¹e, eᵀV⁻¹e and ln|V|, one after the
/// other.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Sums {
    rank: usize,
    all: Vec<f64>,
}

impl Sums {
    fn zero(rank: usize) -> Self {
        Sums { rank, all: vec![0.0; packed(rank, 0) + rank + 2] }
    }

    fn information(&self) -> &[f64] {
        &self.all[..packed(self.rank, 0)]
    }

    fn moment(&self) -> &[f64] {
        &self.all[packed(self.rank, 0)..][..self.rank]
    }

    /// eᵀV⁻¹e.
    fn size(&self) -> f64 {
        self.all[self.all.len() - 2]
    }

    /// ln|V|.
    fn logarithms(&self) -> f64 {
        self.all[self.all.len() - 1]
    }

    fn minus(mut self, other: &Sums) -> Sums {
        let pairs = self.all.iter_mut().zip(&other.all);
        pairs.for_each(|(a, b)| *a -= b);
        self
    }

    /// Cholesky factor L of BᵀV⁻¹B, packed, and what it makes of the moment;
    /// `None` where it is not positive definite.
    pub(super) fn root(&self) -> Option<Root> {
        let mut factor = vec![0.0; packed(self.rank, 0)];
        cholesky(self.rank, self.information(), &mut factor).then(|| {
            let mut moved = self.moment().to_vec();
            forward(&factor, &mut moved);
            let explained: f64 = moved.iter().map(|v| v * v).sum();
            Root { rest: self.size() - explained, factor, moved }
        })
    }

    /// −2 ln L of `rows` rows, up to a constant.
    fn value(&self, rows: usize) -> f64 {
        let Some(root) = self.root().filter(|root| root.rest > 0.0) else {
            return f64::INFINITY;
        };
        let free = rows.saturating_sub(self.rank) as f64;
        free * root.rest.ln() + self.logarithms() + root.determinant()
    }

    /// −2 ln L, up to a constant, of `rows` rows with unknown j held at the
    /// distance `away` from its estimate without shifts; `along` is its row of
    /// the matrix that takes coordinates in the basis B to unknowns.
    ///
    /// With C = BᵀV⁻¹B the others' information has the determinant
    /// |C|·(tᵀC⁻¹t)/(tᵀt), and holding tᵀx at d adds (d − tᵀx̂)²/(tᵀC⁻¹t) to the
    /// squares.
    pub(super) fn held(&self, along: &[f64], away: f64, rows: usize) -> f64 {
        let Some(root) = self.root() else {
            return f64::INFINITY;
        };
        let mut across = along.to_vec();
        forward(&root.factor, &mut across);
        let variance: f64 = across.iter().map(|v| v * v).sum();
        let best: f64 = across.iter().zip(&root.moved).map(|(a, b)| a * b).sum();
        let rest = root.rest + (away - best).powi(2) / variance;
        if !(rest > 0.0 && variance > 0.0) {
            return f64::INFINITY;
        }
        let length: f64 = along.iter().map(|v| v * v).sum();
        let free = (rows + 1).saturating_sub(self.rank) as f64;
        free * rest.ln() + self.logarithms() + root.determinant() + (variance / length).ln()
    }
}

/// The Cholesky factor of an information with what follows from it.
pub(super) struct Root {
    /// L, packed.
    factor: Vec<f64>,
    /// L⁻¹BᵀV⁻¹e.
    pub(super) moved: Vec<f64>,
    /// Squares that no unknown explains.
    pub(super) rest: f64,
}

impl Root {
    /// Logarithm of the information's determinant.
    fn determinant(&self) -> f64 {
        let diagonal = (0..self.moved.len()).map(|i| self.factor[packed(i, i)]);
        2.0 * diagonal.map(f64::ln).sum::<f64>()
    }

    /// A lower bound of the information's smallest eigenvalue, at least a
    /// rank-th of it: 1/tr(C⁻¹).
    pub(super) fn least(&self) -> f64 {
        let mut inverse = vec![0.0; self.factor.len()];
        invert_lower(self.moved.len(), &self.factor, &mut inverse);
        1.0 / inverse.iter().map(|v| v * v).sum::<f64>()
    }

    /// L.
    pub(super) fn factor(&self) -> DMatrix<f64> {
        let rank = self.moved.len();
        let entry = |i: usize, j: usize| {
            if j <= i { self.factor[packed(i, j)] } else { 0.0 }
        };
        DMatrix::from_fn(rank, rank, entry)
    }
}

/// Solves L x = v in place, L packed.
fn forward(factor: &[f64], values: &mut [f64]) {
    for i in 0..values.len() {
        let row = &factor[packed(i, 0)..];
        let solved: f64 = (0..i).map(|k| row[k] * values[k]).sum();
        values[i] = (values[i] - solved) / row[i];
    }
}

/// The restricted likelihood of one set of displacements.
#[derive(Debug)]
pub struct Restricted<'a> {
    system: &'a Whitened,
    /// Residual e without shifts.
    residual: DVector<f64>,
    /// eᵀe.
    size: f64,
    /// Uᵀe of each posture.
    moved: Vec<DVector<f64>>,
    /// True where e is rounding, so that nothing tells shifts from noise.
    rounding: bool,
    /// Sums over all postures without shifts.
    plain: Sums,
    /// Chebyshev points of −1..1 with their barycentric weights.
    nodes: [(f64, f64); NODES],
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
                let block_residual = residual.rows(rows.start, rows.len());
                system.directions(b).0.tr_mul(&block_residual)
            })
            .collect();
        let rank = system.factor().rank();
        let mut plain = Sums::zero(rank);
        // BᵀB = I and Bᵀe = 0.
        (0..rank).for_each(|j| plain.all[packed(j, j)] = 1.0);
        let end = plain.all.len();
        plain.all[end - 2] = size;
        let node = |j: usize| {
            let angle = PI * (j as f64 + 0.5) / NODES as f64;
            let sign = if j.is_multiple_of(2) { 1.0 } else { -1.0 };
            (angle.cos(), sign * angle.sin())
        };
        Restricted {
            system,
            plain,
            nodes: std::array::from_fn(node),
            rounding: size <= rounding || !size.is_finite(),
            residual,
            size,
            moved,
            grid: OnceLock::new(),
            windows: (0..=GRID.len()).map(|_| OnceLock::new()).collect(),
        }
    }

    /// True where the residual is rounding.
    pub(super) fn is_rounding(&self) -> bool {
        self.rounding
    }

    /// The sums over all postures without shifts.
    pub(super) fn plain(&self) -> &Sums {
        &self.plain
    }

    /// eᵀe.
    pub(super) fn size(&self) -> f64 {
        self.size
    }

    fn rank(&self) -> usize {
        self.system.factor().rank()
    }

    /// −2 ln L at γ, up to a constant, σ² profiled out.
    pub fn value(&self, gamma: f64) -> f64 {
        self.at(gamma).value(self.system.rows())
    }

    /// The sums over all postures at γ.
    pub(super) fn at(&self, gamma: f64) -> Sums {
        let all = 0..self.system.block_count();
        self.shifted(&self.plain, all, |by, k| share(gamma, by.size(k)))
    }

    /// The same at point `i` of the grid.
    fn on_grid(&self, i: usize) -> Sums {
        let all = 0..self.system.block_count();
        self.shifted(&self.plain, all, |by, k| by.on_grid(i, k))
    }

    /// The sums `plain` over `blocks` without shifts, with what their shifts change.
    fn shifted(
        &self,
        plain: &Sums,
        blocks: impl Iterator<Item = usize>,
        share: impl Fn(&Whitening, usize) -> [f64; 2],
    ) -> Sums {
        let mut out = plain.clone();
        // Loops of known length are faster: the joints of an arm, and one term more.
        match self.rank() {
            6 => self.add(6, &mut out, blocks, share),
            7 => self.add(7, &mut out, blocks, share),
            rank => self.add(rank, &mut out, blocks, share),
        }
        out
    }

    #[inline(always)]
    fn add(
        &self,
        rank: usize,
        out: &mut Sums,
        blocks: impl Iterator<Item = usize>,
        share: impl Fn(&Whitening, usize) -> [f64; 2],
    ) {
        let (information, rest) = out.all.split_at_mut(packed(rank, 0));
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
                    for i in 0..=j {
                        information[packed(j, i)] -= scale * row[i];
                    }
                }
            }
        }
        rest[0] += size;
        rest[1] += logarithms;
    }

    /// The sums over the postures `blocks` alone without shifts.
    pub(super) fn block_sums(&self, blocks: &[usize]) -> Sums {
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
        let lower = (0..rank).flat_map(|i| (0..=i).map(move |j| (i, j)));
        let values = lower.map(|at| information[at]);
        let values = values.chain(moment.iter().copied()).chain([size]);
        out.all.iter_mut().zip(values).for_each(|(o, v)| *o = v);
        out
    }

    /// The sums over all postures but `blocks` at γ; `all` are those over all,
    /// `block_sums` those over `blocks` without shifts.
    pub(super) fn without(&self, blocks: &[usize], block_sums: &Sums, all: Sums, gamma: f64) -> Sums {
        let share = |by: &Whitening, k: usize| share(gamma, by.size(k));
        all.minus(&self.shifted(block_sums, blocks.iter().copied(), share))
    }

    /// The sums over all postures at ln γ = `place`, from the Chebyshev points of
    /// the window around it.
    pub(super) fn between(&self, place: f64) -> Sums {
        let from_start = (place - grid_place(0)) / STEP + 1.0;
        let window = (from_start.floor().max(0.0) as usize).min(GRID.len());
        let start = grid_place(0) + STEP * (window as f64 - 1.0);
        let nodes = &self.nodes;
        let node = |j: usize| start + 0.5 * STEP * (1.0 + nodes[j].0);
        let sums = self.windows[window].get_or_init(|| (0..NODES).map(|j| self.at(node(j).exp())).collect());
        let mut total = 0.0;
        let mut out = Sums::zero(self.rank());
        for (j, sums) in sums.iter().enumerate() {
            let away = place - node(j);
            if away == 0.0 {
                return sums.clone();
            }
            let weight = nodes[j].1 / away;
            total += weight;
            for (out, value) in out.all.iter_mut().zip(&sums.all) {
                *out += weight * value;
            }
        }
        out.all.iter_mut().for_each(|v| *v /= total);
        out
    }

    fn grid(&self) -> &[Sums] {
        self.grid.get_or_init(|| (0..GRID.len()).map(|i| self.on_grid(i)).collect())
    }

    /// The γ ≥ 0 with the smallest value, and that value.
    pub(super) fn best_ratio(&self) -> (f64, f64) {
        let points = (0..GRID.len()).map(|i| self.on_grid(i).value(self.system.rows()));
        best(points, self.value(0.0), |x| self.value(x.exp()))
    }

    /// The γ ≥ 0 with the smallest `value` of the sums over all postures, and
    /// that value.
    pub(super) fn best_by(&self, value: impl Fn(&Sums) -> f64) -> (f64, f64) {
        let points = self.grid().iter().map(&value);
        best(points, value(&self.plain), |x| value(&self.between(x)))
    }

    /// The γ ≥ 0 with the smallest value for all postures but `blocks`, that
    /// have `rows` rows; `block_sums` are the sums over `blocks` without shifts.
    pub(super) fn best_without(&self, blocks: &[usize], block_sums: &Sums, rows: usize) -> f64 {
        let points = self.grid().iter().enumerate().map(|(i, all)| {
            let share = |by: &Whitening, k: usize| by.on_grid(i, k);
            let theirs = self.shifted(block_sums, blocks.iter().copied(), share);
            all.clone().minus(&theirs).value(rows)
        });
        let without = |all: Sums, gamma: f64| self.without(blocks, block_sums, all, gamma).value(rows);
        let none = without(self.plain.clone(), 0.0);
        let at = |x: f64| without(self.between(x), x.exp());
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
    if value < none.1 { (place.exp(), value) } else { none }
}

impl Whitened {
    /// The ratio γ = τ²/σ² that maximises the restricted likelihood; zero where
    /// it cannot be told.
    pub fn variance_ratio(&self, whitened: &DVector<f64>) -> f64 {
        let rank = self.factor().rank();
        if !self.is_separable() || self.rows() <= rank {
            return 0.0;
        }
        self.restricted(whitened).map_or(0.0, |c| c.best_ratio().0)
    }

    /// −2 ln of the profiled restricted likelihood as a function of γ; `None`
    /// where the residuals are rounding.
    pub fn restricted(&self, whitened: &DVector<f64>) -> Option<Restricted<'_>> {
        Some(Restricted::new(self, whitened)).filter(|c| !c.is_rounding())
    }
}
