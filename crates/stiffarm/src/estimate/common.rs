//! Errors common to a whole experiment, as they go on into predictions.

use crate::model::observation::ExtraTerm;
use crate::numerics::lists;
use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

/// One independent part of a common error, of one standard uncertainty: an axis,
/// a joint, or all of a source that is one number.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CommonPart {
    /// Name of the source, as in
    /// [`SystematicErrors`](super::systematic::SystematicErrors).
    pub source: String,
    /// Change of the identified unknowns while the part is there: compliances
    /// \[rad/(N·m)\], then extra terms in their own units.
    #[serde(with = "lists::vector")]
    #[cfg_attr(feature = "schema", schemars(with = "Vec<f64>"))]
    pub change: DVector<f64>,
    /// The term by which it acts again at work, where it does, and its size in
    /// the term's unit: lost motion and a tilting base stay with the arm, an
    /// anchor or a registration with the experiment.
    pub at_work: Option<(ExtraTerm, f64)>,
}

/// What errors common to an experiment may be, as far as its readings tell.
///
/// Each part is c standard uncertainties large. Before the readings c has mean
/// zero and covariance I; `mean` and `covariance` are those of c after them. The
/// identified values are not corrected by the mean, so that what counts are the
/// moments about zero, covariance + mean meanᵀ.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CommonErrors {
    /// The parts.
    pub parts: Vec<CommonPart>,
    /// Mean of c, one entry for each part.
    #[serde(with = "lists::vector")]
    #[cfg_attr(feature = "schema", schemars(with = "Vec<f64>"))]
    pub mean: DVector<f64>,
    /// Covariance of c, parts × parts: row i up to column i.
    #[serde(with = "lists::symmetric")]
    #[cfg_attr(feature = "schema", schemars(with = "Vec<Vec<f64>>"))]
    pub covariance: DMatrix<f64>,
}

impl Default for CommonErrors {
    fn default() -> Self {
        CommonErrors::independent(Vec::new())
    }
}

impl CommonErrors {
    /// Parts about which readings say nothing.
    pub fn independent(parts: Vec<CommonPart>) -> Self {
        CommonErrors {
            mean: DVector::zeros(parts.len()),
            covariance: DMatrix::identity(parts.len(), parts.len()),
            parts,
        }
    }

    /// True where nothing common is known of.
    pub fn is_empty(&self) -> bool {
        self.parts.is_empty()
    }

    /// The parts of one source alone.
    #[must_use]
    pub fn only(&self, source: &str) -> Self {
        let parts = self.parts.iter().enumerate();
        let indices: Vec<usize> = parts.filter(|(_, part)| part.source == source).map(|(i, _)| i).collect();
        CommonErrors {
            parts: indices.iter().map(|i| self.parts[*i].clone()).collect(),
            mean: self.mean.select_rows(&indices),
            covariance: self.covariance.select_rows(&indices).select_columns(&indices),
        }
    }
}

/// A part of a source as it goes on into predictions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PosteriorPart {
    /// Name of the source.
    pub source: String,
    /// `x`, `y`, `z`, the name of a joint, or empty where the source is one number.
    pub part: String,
    /// Change of the unknowns while this part is there with one standard
    /// uncertainty: compliances \[rad/(N·m)\], then extra terms in their own units.
    pub response: Vec<f64>,
    /// The term by which it acts again at work; `null` where it belongs to the
    /// experiment alone.
    pub at_work: Option<ExtraTerm>,
    /// Standard uncertainty, in the unit of its source.
    pub size: f64,
}

/// What the readings leave of the sizes of all parts, each in its standard
/// uncertainties.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SystematicPosterior {
    /// The parts, source by source.
    pub parts: Vec<PosteriorPart>,
    /// Mean of each part given the readings; the estimates are not corrected by it.
    pub mean: Vec<f64>,
    /// Covariance given the readings, row i up to column i.
    pub covariance: Vec<Vec<f64>>,
}

impl SystematicPosterior {
    /// The same for what predicts.
    ///
    /// # Panics
    /// If the numbers are not as many as the parts.
    pub(crate) fn common_errors(&self) -> CommonErrors {
        let count = self.parts.len();
        let entry = |i: usize, k: usize| self.covariance[i.max(k)][i.min(k)];
        CommonErrors {
            parts: self
                .parts
                .iter()
                .map(|part| CommonPart {
                    source: part.source.clone(),
                    change: DVector::from_column_slice(&part.response),
                    at_work: part.at_work.map(|term| (term, part.size)),
                })
                .collect(),
            mean: DVector::from_column_slice(&self.mean),
            covariance: DMatrix::from_fn(count, count, entry),
        }
    }
}
