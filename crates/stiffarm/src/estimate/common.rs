//! Errors common to a whole experiment, as they go on into predictions.

use crate::model::observation::ExtraTerm;
use nalgebra::{DMatrix, DVector};

/// One independent part of a common error, of one standard uncertainty: an axis,
/// a joint, or all of a source that is one number.
#[derive(Debug, Clone, PartialEq)]
pub struct CommonPart {
    /// Name of the source, as in
    /// [`SystematicErrors`](super::systematic::SystematicErrors).
    pub source: String,
    /// Change of the identified unknowns while the part is there: compliances
    /// \[rad/(N·m)\], then further terms in their own units.
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
#[derive(Debug, Clone, PartialEq)]
pub struct CommonErrors {
    /// The parts.
    pub parts: Vec<CommonPart>,
    /// Mean of c, one entry for each part.
    pub mean: DVector<f64>,
    /// Covariance of c, parts × parts.
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
        let kept: Vec<usize> = parts
            .filter(|(_, part)| part.source == source)
            .map(|(i, _)| i)
            .collect();
        CommonErrors {
            parts: kept.iter().map(|i| self.parts[*i].clone()).collect(),
            mean: self.mean.select_rows(&kept),
            covariance: self.covariance.select_rows(&kept).select_columns(&kept),
        }
    }
}
