//! Vectors and symmetric matrices as lists of numbers, for serde's `with`.

/// A vector.
pub mod vector {
    use nalgebra::DVector;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    /// Writes the entries.
    ///
    /// # Errors
    /// Those of the serialiser.
    pub fn serialize<S: Serializer>(vector: &DVector<f64>, to: S) -> Result<S::Ok, S::Error> {
        vector.as_slice().serialize(to)
    }

    /// Reads the entries.
    ///
    /// # Errors
    /// Anything but a list of numbers.
    pub fn deserialize<'d, D: Deserializer<'d>>(from: D) -> Result<DVector<f64>, D::Error> {
        Vec::deserialize(from).map(DVector::from_vec)
    }
}

/// A symmetric matrix as its lower triangle, row by row.
pub mod symmetric {
    use nalgebra::DMatrix;
    use serde::de::Error;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    /// Writes the rows, each up to the diagonal.
    ///
    /// # Errors
    /// Those of the serialiser.
    pub fn serialize<S: Serializer>(matrix: &DMatrix<f64>, to: S) -> Result<S::Ok, S::Error> {
        let row = |i: usize| (0..=i).map(|j| matrix[(i, j)]).collect();
        let rows: Vec<Vec<f64>> = (0..matrix.nrows()).map(row).collect();
        rows.serialize(to)
    }

    /// Reads the rows.
    ///
    /// # Errors
    /// Anything but a lower triangle.
    pub fn deserialize<'d, D: Deserializer<'d>>(from: D) -> Result<DMatrix<f64>, D::Error> {
        let rows: Vec<Vec<f64>> = Vec::deserialize(from)?;
        let count = rows.len();
        if rows.iter().enumerate().all(|(i, row)| row.len() == i + 1) {
            Ok(DMatrix::from_fn(count, count, |i, j| rows[i.max(j)][i.min(j)]))
        } else {
            Err(D::Error::custom("a covariance must be a lower triangle"))
        }
    }
}
