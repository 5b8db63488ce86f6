//! How well the data determine the sizes of the mixed model, and what that does to the
//! covariance of its unknowns and to the degrees of freedom of its quantiles.
//!
//! The solution of the mixed-model equations takes the sizes as known. That they are
//! estimates makes the solution scatter more, and its covariance, which is too small on
//! average, a random quantity, too. Both to first order by the expected information of the
//! restricted likelihood about θ = (ln σ², ln γ, ln λ of each class), ½ tr(P V_k P V_l):
//!
//! - covariance + Σ W_kl E\[∂m/∂θ_k ∂mᵀ/∂θ_l\] with W the inverse of the information
//!   and m the solution (Kackar & Harville, JASA 79, 1984, 853–862,
//!   doi:10.1080/01621459.1984.10477102). Prasad & Rao (JASA 85, 1990, 163–171,
//!   doi:10.1080/01621459.1990.10475320) and Kenward & Roger (Biometrics 53, 1997,
//!   983–997, doi:10.2307/2533558) add the sum twice, the second time for the bias of the
//!   covariance; with the degrees of freedom below, counted bands are too wide then;
//! - 2 f²/(gᵀWg) degrees of freedom for a combination of variance f whose derivative is g
//!   (Satterthwaite, Biometrics Bulletin 2, 1946, 110–114, doi:10.2307/3002019), see
//!   [`SizeDoubt`](crate::estimate::freedom::SizeDoubt).
//!
//! A class that was found to give nothing takes no part in either.
//!
//! In coordinates in which Λ = I, T = I − A⁻¹ of the random effects gives all traces that
//! concern classes; those of γ come from the sums R = Σ (a/w)² x xᵀ and R₂ = Σ a⁴/w³ x xᵀ
//! over the directions x of shifts, a² = γ·size and w = 1 + a².

use super::likelihood::{Likelihood, Sizes, Solved};
use nalgebra::{DMatrix, Dyn, SymmetricEigen};
use std::ops::Range;

/// Standard deviation that the logarithm of a class's variance has at most: beyond a
/// factor of e either way first order in it means nothing.
const MOST_DOUBT: f64 = 1.0;
/// Sweeps after which eigenvalues are given up; a matrix of five rows takes ten.
pub(super) const MOST_SWEEPS: usize = 1000;
/// Eigenvalues of the scaled information below this are rounding.
const RANK: f64 = 1e-10;

/// Covariance of h and u − û in the columns' own units, the doubt about the sizes in it,
/// and that of ln σ² and the logarithms of the classes' ratios.
pub(super) fn doubt(likelihood: &Likelihood, sizes: &Sizes, solved: &Solved) -> (DMatrix<f64>, DMatrix<f64>) {
    let rows = likelihood.rows();
    let scale = solved.scale();
    let inverse = solved.scaled_inverse();
    let count = inverse.ncols();
    let columns = |class: &Range<usize>| rows.fixed + class.start..rows.fixed + class.end;
    let estimated = &rows.classes[..rows.estimated_count()];
    let classes: Vec<Range<usize>> = estimated.iter().map(columns).collect();
    let seen = DMatrix::from_fn(count, count, |i, j| {
        let unit = f64::from(u8::from(i == j && i >= rows.fixed));
        unit - inverse[(i, j)]
    });

    let shared = usize::from(rows.has_shifts());
    let size = 1 + shared + classes.len();
    let mut information = DMatrix::zeros(size, size);
    let mut set = |k: usize, l: usize, value: f64| {
        information[(k, l)] = 0.5 * value;
        information[(l, k)] = 0.5 * value;
    };
    set(0, 0, solved.free as f64);
    for (c, class) in classes.iter().enumerate() {
        let k = 1 + shared + c;
        set(0, k, class.clone().map(|i| seen[(i, i)]).sum());
        for (d, other) in classes.iter().enumerate().take(c + 1) {
            let block = seen.view((class.start, other.start), (class.len(), other.len()));
            set(k, 1 + shared + d, block.norm_squared());
        }
    }
    // R and R₂, with A⁻¹R.
    let by_ratio = (shared == 1).then(|| {
        let sums = likelihood.directions().ratio_sums(sizes.gamma, scale);
        let moved = &inverse * &sums.first;
        set(0, 1, sums.trace - moved.trace());
        // The trace of a product is the sum of products of entries.
        let squares = sums.squares - 2.0 * inverse.dot(&sums.second) + moved.tr_dot(&moved);
        set(1, 1, squares);
        for (c, class) in classes.iter().enumerate() {
            set(1, 2 + c, class.clone().map(|i| moved.row(i).tr_dot(&inverse.column(i))).sum());
        }
        (sums, moved)
    });
    bound(&mut information, 1 + shared, MOST_DOUBT);
    let spread = inverted(&information);

    // Σ W_kl E[∂v/∂θ_k ∂vᵀ/∂θ_l]/σ² of the scaled solution v, between A⁻¹ on both sides.
    let mut middle = DMatrix::zeros(count, count);
    for (c, class) in classes.iter().enumerate() {
        for (d, other) in classes.iter().enumerate() {
            let weight = spread[(1 + shared + c, 1 + shared + d)];
            let at = ((class.start, other.start), (class.len(), other.len()));
            let block = seen.view(at.0, at.1) * weight;
            middle.view_mut(at.0, at.1).copy_from(&block);
        }
    }
    if let Some((sums, moved)) = &by_ratio {
        for (c, class) in classes.iter().enumerate() {
            let cross = moved.rows(class.start, class.len()) * spread[(1, 2 + c)];
            let mut rows = middle.rows_mut(class.start, class.len());
            rows -= &cross;
            let mut columns = middle.columns_mut(class.start, class.len());
            columns -= cross.transpose();
        }
        middle += (&sums.second - &sums.first * moved) * spread[(1, 1)];
    }
    let more = &inverse * middle * &inverse;
    // Rounding makes the two sides differ in the last digit.
    let entry = |i: usize, j: usize| {
        let plain = inverse[(i, j)] * scale[i] * scale[j];
        plain + 0.5 * (more[(i, j)] + more[(j, i)]) * scale[i] * scale[j]
    };
    let covariance = DMatrix::from_fn(count, count, |i, j| entry(i.max(j), i.min(j)));
    // ln σ² and the classes: what γ does to quantiles is left out.
    let spread = spread.remove_rows(1, shared).remove_columns(1, shared);
    (covariance * solved.variance, spread)
}

/// Adds to the information about the classes, which begin at `from`, what it lacks for
/// no combination of their logarithms to have a larger standard deviation than `most`.
fn bound(information: &mut DMatrix<f64>, from: usize, most: f64) {
    let count = information.nrows() - from;
    let others = inverted(&information.view((0, 0), (from, from)).into_owned());
    let cross = information.view((0, from), (from, count)).into_owned();
    let reduced = information.view((from, from), (count, count)) - cross.tr_mul(&(others * &cross));
    let Some(eigen) = eigen(reduced) else {
        return;
    };
    let mut block = information.view_mut((from, from), (count, count));
    for (value, vector) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
        let lacks = (most.powi(-2) - value).max(0.0);
        block.ger(lacks, &vector, &vector, 1.0);
    }
}

/// `None` for numbers that are not finite, with which the search for them never ends.
fn eigen(matrix: DMatrix<f64>) -> Option<SymmetricEigen<f64, Dyn>> {
    let finite = matrix.iter().all(|v| v.is_finite());
    finite.then(|| SymmetricEigen::try_new(matrix, f64::EPSILON, MOST_SWEEPS))?
}

/// Inverse of a positive semidefinite matrix in the coordinates in which its diagonal is
/// one, on the space that it determines.
fn inverted(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    let root = matrix.diagonal().map(|v| v.max(f64::MIN_POSITIVE).sqrt());
    let scaled = DMatrix::from_fn(matrix.nrows(), matrix.ncols(), |i, j| matrix[(i, j)] / (root[i] * root[j]));
    let mut out = DMatrix::zeros(matrix.nrows(), matrix.ncols());
    let Some(eigen) = eigen(scaled) else {
        return out;
    };
    for (value, vector) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
        if *value > RANK {
            out.ger(1.0 / value, &vector, &vector, 1.0);
        }
    }
    DMatrix::from_fn(out.nrows(), out.ncols(), |i, j| {
        // Rounding makes the two sides differ in the last digit.
        out[(i.max(j), i.min(j))] / (root[i] * root[j])
    })
}
