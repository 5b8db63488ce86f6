//! What predicts with the errors common to its experiment.

use super::{SystematicErrors, systematic_errors};
use crate::error::Result;
use crate::estimate::compliance::IdentifiedCompliance;
use crate::estimate::identify::Fit;

impl IdentifiedCompliance {
    /// The same with the errors that `systematic` holds, as far as the readings left
    /// them.
    #[must_use]
    pub fn with_systematic_errors(mut self, systematic: &SystematicErrors) -> Self {
        self.common = systematic.posterior.common_errors();
        self
    }
}

impl Fit {
    /// The compliance that the fit found, with its covariance and what the
    /// systematic errors do to it.
    ///
    /// # Errors
    /// As [`IdentifiedCompliance::from_estimates`] and [`systematic_errors`].
    pub fn compliance(&self) -> Result<IdentifiedCompliance> {
        let compliance = IdentifiedCompliance::from_identification(self.cell(), self.identification()?)?;
        Ok(compliance.with_systematic_errors(&systematic_errors(self)?).with_doubts(self.measured().findings()))
    }
}
