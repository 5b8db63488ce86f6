//! What is asked of a registration: which pairs, and how well they are known.

#[cfg(feature = "clap")]
use crate::ask::values::above_zero;
use crate::error::{Code, Error, Result};
use crate::measure::registration::{PointPair, RegisterOptions, Registration, register_with};
use crate::units::mm_to_m;
use serde::{Deserialize, Serialize};

/// What is asked of a registration.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(rename = "Options"))]
#[cfg_attr(feature = "clap", derive(clap::Args))]
pub struct PairOptions {
    /// Standard deviation of each coordinate of a pair, both frames together [mm] [default: from
    /// the residuals]
    #[cfg_attr(feature = "clap", arg(long, value_name = "X", value_parser = above_zero("std_mm")))]
    pub std_mm: Option<f64>,
    /// Points to leave out
    #[cfg_attr(feature = "clap", arg(long, value_name = "NAME,…", value_delimiter = ','))]
    pub exclude: Vec<String>,
}

impl PairOptions {
    /// The pairs but those that are left out.
    ///
    /// # Errors
    /// A name that no pair has (key `exclude`).
    pub fn kept(&self, pairs: Vec<PointPair>) -> Result<Vec<PointPair>> {
        let is = |pair: &PointPair, name: &String| pair.name == *name;
        if let Some(name) = self.exclude.iter().find(|name| !pairs.iter().any(|pair| is(pair, name))) {
            let names: Vec<&str> = pairs.iter().map(|pair| pair.name.as_str()).collect();
            let message = format!("The table has no point \"{name}\".");
            return Err(Error::new(Code::UnknownName, message)
                .key("exclude")
                .hint(format!("points: {}", names.join(", "))));
        }
        let remaining = pairs.into_iter().filter(|pair| !self.exclude.iter().any(|name| is(pair, name)));
        Ok(remaining.collect())
    }

    /// Registers pairs of [`PairOptions::kept`].
    ///
    /// # Errors
    /// As [`register_with`].
    pub fn register(&self, pairs: &[PointPair]) -> Result<Registration> {
        let options = RegisterOptions { std: self.std_mm.map(mm_to_m), weights: Vec::new() };
        register_with(pairs, &options)
    }
}
