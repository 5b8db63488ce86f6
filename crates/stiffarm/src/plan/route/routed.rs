//! A route as a result: with the names of its stops and what to know before driving it.

use super::Route;
use crate::findings::Finding;
use serde::{Deserialize, Serialize};

/// Options of the result.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Options {
    /// Whether the plan's order was kept.
    pub keep_order: bool,
    /// Whether equivalent postures could stand in.
    pub equivalents: bool,
    /// Whether these had the wrist of the plan.
    pub keep_wrist: bool,
    /// Steps that angles were rounded to \[deg\]; `null` where they were not.
    pub angle_step_deg: Option<f64>,
}

/// The route with the names of its stops.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Routed {
    /// Names of the stops.
    pub posture_names: Vec<String>,
    /// The route.
    #[serde(flatten)]
    pub route: Route,
    /// What to know before driving it.
    pub findings: Vec<Finding>,
}
