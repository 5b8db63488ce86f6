//! What is asked of a count of coverage.

use crate::ask::fit::FitOptions;
#[cfg(feature = "clap")]
use crate::ask::values::{count, seed};
use crate::error::{Code, Error, Result};
use crate::estimate::coverage::{CoverageCase, ErrorModel};
use crate::model::cell::Cell;
use serde::{Deserialize, Serialize};

/// What is simulated, and how it is identified.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(rename = "Options"))]
#[cfg_attr(feature = "clap", derive(clap::Args))]
#[serde(default)]
pub struct CoverageOptions {
    /// Experiments to simulate
    #[cfg_attr(feature = "clap", arg(long, value_name = "N", default_value_t = 10_000, value_parser = count::<usize>()))]
    pub runs: usize,
    /// Count the intervals of so many resamples of the postures instead
    #[cfg_attr(feature = "clap", arg(long, value_name = "N", value_parser = count::<usize>()))]
    pub bootstrap: Option<usize>,
    /// Seed of the random numbers
    #[cfg_attr(feature = "clap", arg(long, default_value_t = 1, value_parser = seed()))]
    pub seed: u64,
    /// How the stiffness is estimated.
    #[serde(flatten)]
    #[cfg_attr(feature = "clap", command(flatten))]
    pub fit: FitOptions,
}

impl Default for CoverageOptions {
    fn default() -> Self {
        CoverageOptions { runs: 10_000, bootstrap: None, seed: 1, fit: FitOptions::default() }
    }
}

impl CoverageOptions {
    /// What is counted in this cell.
    ///
    /// # Errors
    /// An elastic model (key `elastic`); as [`FitOptions::options`].
    pub fn case(&self, cell: &Cell) -> Result<CoverageCase> {
        if self.fit.elastic.is_some() {
            let message = "Coverage is counted for springs at the joint axes.";
            let error = Error::new(Code::Usage, message).key("elastic");
            return Err(error.hint("`simulate --elastic` counts what the mixed model holds"));
        }
        Ok(CoverageCase {
            experiments: self.runs,
            seed: self.seed,
            resamples: self.bootstrap,
            options: self.fit.options(&cell.setup.robot)?,
            world: ErrorModel { common_ratio: cell.noise.common_ratio().sqrt(), ..ErrorModel::default() },
        })
    }
}
