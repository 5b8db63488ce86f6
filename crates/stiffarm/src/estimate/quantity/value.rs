//! A value that a quantity has.

use super::facts::Quantity;
use nalgebra::{DVector, Matrix3, Rotation3, Vector3};

/// A value of a quantity: first `turn`, which is found by trying, then the numbers, which are found by least squares.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct QuantityValue {
    pub turn: Matrix3<f64>,
    pub values: DVector<f64>,
}

impl QuantityValue {
    pub fn new(turn: Matrix3<f64>, values: Vec<f64>) -> Self {
        let values = DVector::from_vec(values);
        QuantityValue { turn, values }
    }

    /// Number `k` of `count` off by `size`, and nothing else.
    pub fn off(count: usize, k: usize, size: f64) -> Self {
        let mut place = QuantityValue::new(Matrix3::identity(), vec![0.0; count]);
        place.values[k] = size;
        place
    }

    /// The first three numbers.
    pub fn vector(&self) -> Vector3<f64> {
        Vector3::from_fn(|i, _| self.values.get(i).copied().unwrap_or(0.0))
    }

    /// The last three numbers as a turn, after `turn`.
    pub fn rotated(&self) -> Matrix3<f64> {
        let from = self.values.len().saturating_sub(3);
        let by = Vector3::from_fn(|i, _| self.values.get(from + i).copied().unwrap_or(0.0));
        Rotation3::new(by).matrix() * self.turn
    }
}

/// A quantity at a value.
pub(crate) type QuantityAtValue = (Quantity, QuantityValue);
