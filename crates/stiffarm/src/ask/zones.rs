//! What is asked of maps of zones.

#[cfg(feature = "clap")]
use crate::ask::values::{number, within};
use crate::model::cell::Cell;
#[cfg(feature = "clap")]
use crate::plan::zones::STEPS;
use crate::plan::zones::ZoneOptions;
use crate::units::deg_to_rad;
use serde::{Deserialize, Serialize};

/// What is mapped.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "clap", derive(clap::Args))]
#[serde(default)]
pub struct ZonesOptions {
    /// Angles per axis of the map, from bound to bound
    #[cfg_attr(feature = "clap", arg(long, value_name = "N", default_value_t = 41,
        value_parser = within::<usize>(STEPS[0] as u64..=STEPS[1] as u64)))]
    pub steps: usize,
    /// Angles at which the joints are held, one per joint; those of joints 2 and 3 are replaced by
    /// the map's [default: 0,0,0,45,45,45 for six joints]
    #[cfg_attr(feature = "clap", arg(long, value_name = "Q1,…", value_delimiter = ',', value_parser = number("deg"),
        allow_hyphen_values = true))]
    pub q_deg: Vec<f64>,
}

impl Default for ZonesOptions {
    fn default() -> Self {
        ZonesOptions { steps: 41, q_deg: Vec::new() }
    }
}

/// Options of a result: what was asked, and what else it depends on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(rename = "Options"))]
pub struct ZonesResultOptions {
    /// What was asked.
    #[serde(flatten)]
    pub zones: ZonesOptions,
    /// L of Eq. (20) \[m\].
    pub characteristic_length_m: Option<f64>,
}

impl ZonesOptions {
    /// The same in SI units.
    pub fn options(&self) -> ZoneOptions {
        let q = self.q_deg.iter().copied().map(deg_to_rad);
        ZoneOptions { steps: self.steps, q: (!self.q_deg.is_empty()).then(|| q.collect()) }
    }

    /// What a result in this cell says of them.
    pub fn in_cell(&self, cell: &Cell) -> ZonesResultOptions {
        ZonesResultOptions { zones: self.clone(), characteristic_length_m: cell.characteristic_length }
    }
}
