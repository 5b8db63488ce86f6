//! What is asked of a registration: which pairs, and how well they are known.

use crate::error::{Code, Error, Result};
use crate::measure::registration::{PointPair, RegisterOptions, Registration, register_with};
use crate::units::mm_to_m;
use serde::Serialize;

/// Options of the result.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Options {
    /// Standard deviation of each coordinate of a pair \[mm\]; `null` estimates it from the residuals.
    pub std_mm: Option<f64>,
    /// Pairs left out.
    pub exclude: Vec<String>,
}

impl Options {
    /// The pairs but those that are left out.
    ///
    /// # Errors
    /// A name that no pair has (key `exclude`).
    pub fn kept(&self, pairs: Vec<PointPair>) -> Result<Vec<PointPair>> {
        let is = |pair: &PointPair, name: &String| pair.name == *name;
        if let Some(name) = self
            .exclude
            .iter()
            .find(|name| !pairs.iter().any(|pair| is(pair, name)))
        {
            let known: Vec<&str> = pairs.iter().map(|pair| pair.name.as_str()).collect();
            let message = format!("The table has no point \"{name}\".");
            return Err(Error::new(Code::UnknownName, message)
                .key("exclude")
                .hint(format!("points: {}", known.join(", "))));
        }
        let kept = pairs
            .into_iter()
            .filter(|pair| !self.exclude.iter().any(|name| is(pair, name)));
        Ok(kept.collect())
    }

    /// Registers pairs of [`Options::kept`].
    ///
    /// # Errors
    /// As [`register_with`].
    pub fn register(&self, kept: &[PointPair]) -> Result<Registration> {
        let options = RegisterOptions {
            std: self.std_mm.map(mm_to_m),
            weights: Vec::new(),
        };
        register_with(kept, &options)
    }
}
