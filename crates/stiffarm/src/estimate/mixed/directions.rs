//! Directions x = XᵀU in which the readings of a posture share shifts, and the sums over them that the likelihood takes.

use nalgebra::{DMatrix, DVector};

/// Sizes nearer than this are one size.
const ONE_SIZE: f64 = 1e-9;

/// The directions of the postures that take part. Under equal loads they have one size, or few, and no posture counts.
pub(super) struct Directions {
    /// Sums by size; none where there are many sizes.
    pub(super) groups: Vec<EqualDirections>,
    /// Each by itself: where there are many sizes, or few directions.
    pub(super) columns: Option<SizedColumns>,
}

/// Directions side by side.
pub(super) struct SizedColumns {
    pub(super) columns: DMatrix<f64>,
    /// The squared size of a unit shift along each.
    pub(super) sizes: Vec<f64>,
}

/// Directions of one size.
#[derive(Clone)]
pub(super) struct EqualDirections {
    size: f64,
    count: usize,
    /// Σ x xᵀ.
    pub(super) gram: DMatrix<f64>,
}

impl EqualDirections {
    /// The columns of `seen`, whose postures and sizes are `directions`, by size; none where the sums would be more
    /// numbers than the columns.
    pub(super) fn all(seen: &DMatrix<f64>, directions: &[(usize, f64)]) -> Vec<Self> {
        let most = (directions.len() / seen.nrows().max(1)).max(1);
        let mut groups: Vec<(f64, Vec<usize>)> = Vec::new();
        for (k, (_, size)) in directions.iter().enumerate() {
            match groups.iter().position(|(other, _)| is_one_size(*size, *other)) {
                Some(g) => groups[g].1.push(k),
                None if groups.len() == most => return Vec::new(),
                None => groups.push((*size, vec![k])),
            }
        }
        let group = |(size, members): (f64, Vec<usize>)| {
            let columns = seen.select_columns(&members);
            EqualDirections { size, count: members.len(), gram: &columns * columns.transpose() }
        };
        groups.into_iter().map(group).collect()
    }

    /// The same directions in other units.
    pub(super) fn with_gram(&self, gram: DMatrix<f64>) -> Self {
        EqualDirections { gram, ..*self }
    }

    /// Those that are not among `left`.
    pub(super) fn without(&self, left: &SizedColumns) -> Self {
        let mut out = self.clone();
        for (column, size) in left.columns.column_iter().zip(&left.sizes) {
            if is_one_size(*size, self.size) {
                out.gram.ger(-1.0, &column, &column, 1.0);
                out.count -= 1;
            }
        }
        out
    }

    /// γ s², the count as a number, and Σ x xᵀ.
    fn at(&self, gamma: f64) -> (f64, f64, &DMatrix<f64>) {
        (gamma * self.size, self.count as f64, &self.gram)
    }
}

fn is_one_size(size: f64, other: f64) -> bool {
    (size / other - 1.0).abs() < ONE_SIZE
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

impl Directions {
    /// Takes from `gram`, XᵀX, what shifts of the ratio `gamma` leave of it: XᵀV⁻¹X. Gives ln|V|.
    pub(super) fn take_from(&self, gram: &mut DMatrix<f64>, gamma: f64) -> f64 {
        let mut logarithms = 0.0;
        if gamma <= 0.0 {
            return logarithms;
        }
        for (part, count, sum) in self.groups.iter().map(|group| group.at(gamma)) {
            let share = part / (1.0 + part);
            gram.zip_apply(sum, |entry, x| *entry -= x * share);
            logarithms += count * part.ln_1p();
        }
        if let (true, Some(SizedColumns { columns, sizes })) = (self.groups.is_empty(), &self.columns) {
            let mut scaled = columns.transpose();
            for (mut row, size) in scaled.row_iter_mut().zip(sizes) {
                let part = gamma * size;
                row *= part / (1.0 + part);
                logarithms += part.ln_1p();
            }
            gram.gemm(-1.0, columns, &scaled, 1.0);
        }
        logarithms
    }

    /// What the information about γ needs, in columns times `scale`.
    pub(super) fn ratio_sums(&self, gamma: f64, scale: &DVector<f64>) -> RatioSums {
        let count = scale.len();
        let nothing = || DMatrix::zeros(count, count);
        let mut out = RatioSums { first: nothing(), second: nothing(), trace: 0.0, squares: 0.0 };
        let Some(SizedColumns { columns, sizes }) = &self.columns else {
            for (part, directions, sum) in self.groups.iter().map(|group| group.at(gamma)) {
                let share = part / (1.0 + part);
                let first = share / (1.0 + part);
                let scaled = DMatrix::from_fn(count, count, |i, j| sum[(i, j)] * (scale[i] * scale[j]) * first);
                out.second += &scaled * share;
                out.first += scaled;
                out.trace += directions * share;
                out.squares += directions * share * share;
            }
            return out;
        };
        let mut x = DMatrix::zeros(count, sizes.len());
        for (k, size) in sizes.iter().enumerate() {
            let part = gamma * size;
            let factor = part.sqrt() / (1.0 + part);
            x.set_column(k, &(columns.column(k).rows(0, count).component_mul(scale) * factor));
            out.trace += part / (1.0 + part);
            out.squares += (part / (1.0 + part)).powi(2);
        }
        out.first = &x * x.transpose();
        for (mut column, size) in x.column_iter_mut().zip(sizes) {
            let part = gamma * size;
            column.scale_mut((part / (1.0 + part)).sqrt());
        }
        out.second = &x * x.transpose();
        out
    }

    /// Derivatives by ln γ at `solution` (of X's columns, −1 for the last), where `whitened` makes of columns x of
    /// unknowns those whose squares are xᵀ(XᵀV⁻¹X)⁻¹x, and `inverse` is that inverse.
    pub(super) fn by_ratio(
        &self,
        gamma: f64,
        solution: &DVector<f64>,
        whitened: impl Fn(&DMatrix<f64>) -> DMatrix<f64>,
        inverse: impl Fn() -> DMatrix<f64>,
    ) -> ByRatio {
        let unknowns = solution.len() - 1;
        let moved = DVector::zeros(solution.len());
        let mut out = ByRatio { logarithms: 0.0, squares: 0.0, determinant: 0.0, twice: 0.0, moved };
        let Some(SizedColumns { columns, sizes }) = &self.columns else {
            let inverse = inverse();
            for (part, count, sum) in self.groups.iter().map(|group| group.at(gamma)) {
                let change = part / (1.0 + part).powi(2);
                let moved = sum * solution * change;
                let squares = solution.dot(&moved);
                out.logarithms += count * part / (1.0 + part);
                out.determinant -= change * inverse.dot(&sum.view((0, 0), (unknowns, unknowns)));
                out.twice += squares * part / (1.0 + part);
                out.squares += squares;
                out.moved += moved;
            }
            return out;
        };
        let left = columns.tr_mul(solution);
        let seen = whitened(&columns.rows(0, unknowns).into_owned());
        let mut changed = left.clone();
        for (i, size) in sizes.iter().enumerate() {
            let part = gamma * size;
            let change = part / (1.0 + part).powi(2);
            out.logarithms += part / (1.0 + part);
            out.squares += change * left[i].powi(2);
            out.twice += change * part / (1.0 + part) * left[i].powi(2);
            out.determinant -= change * seen.column(i).norm_squared();
            changed[i] *= change;
        }
        out.moved = columns * changed;
        out
    }
}
