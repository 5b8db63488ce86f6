//! Factors of symmetric matrices with some hundred rows, by products of blocks. Those run at the processor's speed;
//! nalgebra's own factor and inverse go column by column, ten times as long.

use nalgebra::{DMatrix, DVector};

/// Blocks up to so many rows are left to nalgebra.
const SMALL_BLOCK: usize = 24;

/// L⁻¹ of a positive definite matrix A = L Lᵀ: all that is asked of it follows from this.
pub struct Cholesky {
    inverse_root: DMatrix<f64>,
}

impl Cholesky {
    /// `None` where the matrix is not positive definite.
    pub fn new(matrix: &DMatrix<f64>) -> Option<Self> {
        let inverse_root = inverse_root(matrix)?;
        Some(Cholesky { inverse_root })
    }

    /// ln|A|.
    pub fn ln_determinant(&self) -> f64 {
        let diagonal = self.inverse_root.diagonal();
        -2.0 * diagonal.iter().map(|v| v.ln()).sum::<f64>()
    }

    /// A⁻¹ b.
    pub fn solve(&self, right: &DVector<f64>) -> DVector<f64> {
        self.inverse_root.tr_mul(&(&self.inverse_root * right))
    }

    /// L⁻¹ X.
    pub fn whitened(&self, columns: &DMatrix<f64>) -> DMatrix<f64> {
        &self.inverse_root * columns
    }

    /// Diagonal of A⁻¹.
    pub fn inverse_diagonal(&self) -> DVector<f64> {
        let columns = self.inverse_root.column_iter();
        DVector::from_iterator(columns.len(), columns.map(|column| column.norm_squared()))
    }

    /// A⁻¹.
    pub fn inverse(&self) -> DMatrix<f64> {
        self.inverse_root.transpose() * &self.inverse_root
    }
}

/// L⁻¹ from the lower triangle of A: with A in four blocks that of its first, then of what it leaves of the last.
fn inverse_root(matrix: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let n = matrix.nrows();
    if n <= SMALL_BLOCK {
        let root = matrix.clone().cholesky()?.unpack();
        return root.solve_lower_triangular(&DMatrix::identity(n, n));
    }
    let first = n / 2;
    let rest = n - first;
    let inverse = inverse_root(&matrix.view((0, 0), (first, first)).into_owned())?;
    let below = matrix.view((first, 0), (rest, first)) * inverse.transpose();
    let left = matrix.view((first, first), (rest, rest)) - &below * below.transpose();
    let last = inverse_root(&left)?;
    let mut out = DMatrix::zeros(n, n);
    out.view_mut((0, 0), (first, first)).copy_from(&inverse);
    out.view_mut((first, 0), (rest, first)).copy_from(&-(&last * below * inverse));
    out.view_mut((first, first), (rest, rest)).copy_from(&last);
    Some(out)
}
