//! Classes whose entries scatter about a common mean, which itself is as large as one of them: their covariance is
//! that of a class by itself times I + 1 1ᵀ. With L L = I + 1 1ᵀ the unknowns w = L⁻¹ v scatter independently, so the
//! equations are solved for w.

use nalgebra::DMatrix;
use std::ops::Range;

/// Columns C that belong to v become those of w, C L, in the columns of each of `means`.
pub(super) fn gathered(columns: &mut DMatrix<f64>, means: &[Range<usize>]) {
    with(columns, means, |count| ((1.0 + count).sqrt() - 1.0) / count);
}

/// C L⁻¹.
pub(super) fn scattered(columns: &mut DMatrix<f64>, means: &[Range<usize>]) {
    with(columns, means, |count| (1.0 / (1.0 + count).sqrt() - 1.0) / count);
}

/// C (I + `part`(count) 1 1ᵀ): what L and its inverse are.
fn with(columns: &mut DMatrix<f64>, means: &[Range<usize>], part: impl Fn(f64) -> f64) {
    for mean in means.iter().filter(|mean| !mean.is_empty()) {
        let block = columns.columns(mean.start, mean.len());
        let sum = block.column_sum() * part(mean.len() as f64);
        for mut column in columns.columns_mut(mean.start, mean.len()).column_iter_mut() {
            column += &sum;
        }
    }
}
