//! Rows of a tall matrix X of which only XᵀX counts.

use nalgebra::DMatrix;

/// Rows as they are while they are few; of more what a QR decomposition leaves of them, R with RᵀR = XᵀX.
pub(crate) struct Stack {
    blocks: Vec<DMatrix<f64>>,
    rows: usize,
    columns: usize,
    most: usize,
}

impl Stack {
    /// No rows yet, and never more than about `most`.
    pub fn new(columns: usize, most: usize) -> Self {
        Stack { blocks: Vec::new(), rows: 0, columns, most }
    }

    /// Adds rows below the others.
    pub fn push(&mut self, block: DMatrix<f64>) {
        if self.rows + block.nrows() > self.most && self.rows > self.columns {
            let above = std::mem::take(&mut self.blocks);
            let r = stacked(&above, self.columns).qr().r();
            self.rows = r.nrows();
            self.blocks.push(r);
        }
        self.rows += block.nrows();
        self.blocks.push(block);
    }

    /// All rows, or a matrix with the same XᵀX.
    pub fn into_matrix(self) -> DMatrix<f64> {
        stacked(&self.blocks, self.columns)
    }
}

/// Blocks of so many columns, one below the other.
pub(crate) fn stacked(blocks: &[DMatrix<f64>], columns: usize) -> DMatrix<f64> {
    let mut all = DMatrix::zeros(blocks.iter().map(DMatrix::nrows).sum(), columns);
    let mut at = 0;
    for block in blocks {
        all.rows_mut(at, block.nrows()).copy_from(block);
        at += block.nrows();
    }
    all
}
