//! What predicts with the errors common to its experiment.

use super::{SystematicErrors, systematic_errors};
use crate::error::Result;
use crate::estimate::common::{CommonErrors, CommonPart};
use crate::estimate::compliance::IdentifiedCompliance;
use crate::estimate::identify::Fit;
use nalgebra::DVector;

impl IdentifiedCompliance {
    /// The same with the errors that its budget holds, as far as the readings left
    /// them. A result of an earlier version says nothing of that: there a change c of
    /// k is one of H by the factor 1/(1 + c), all of H where a source can explain all
    /// of a joint's give, none of further terms, and every part has its whole size.
    #[must_use]
    pub fn with_systematic_errors(mut self, budget: &SystematicErrors) -> Self {
        if let Some(posterior) = &budget.posterior {
            self.common = posterior.common_errors();
            return self;
        }
        let values = &self.values;
        let part = |source: &str, changes: &[Option<f64>]| {
            let mut change = DVector::zeros(values.len());
            for (j, own) in changes.iter().enumerate().take(values.len()) {
                change[j] = values[j] * own.map_or(-1.0, |c| 1.0 / (1.0 + c) - 1.0);
            }
            CommonPart {
                source: source.to_string(),
                change,
                at_work: None,
            }
        };
        let mut parts = Vec::new();
        for source in &budget.sources {
            match source.parts.is_empty() {
                true => parts.push(part(&source.name, &source.change)),
                false => parts.extend(source.parts.iter().map(|p| part(&source.name, &p.change))),
            }
        }
        self.common = CommonErrors::independent(parts);
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
        let found = IdentifiedCompliance::from_identification(self.cell(), self.identification()?)?;
        Ok(found
            .with_systematic_errors(&systematic_errors(self)?)
            .with_doubts(self.measured().findings()))
    }
}
