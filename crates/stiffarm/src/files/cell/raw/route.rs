//! `[route]`: how the robot drives from posture to posture.

use super::value::Percent;
use super::{Deg, List, Number, Text};
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::Deserialize;

/// How the robot drives from posture to posture: for the order of a plan, its moves and programs.
#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema), schemars(rename = "Route"))]
#[serde(deny_unknown_fields)]
pub(in crate::files::cell) struct RawRoute {
    /// Largest speed of each joint, degrees per second (default: the catalogue's, where it has them).
    pub joint_speeds_deg_s: Option<List<Deg>>,
    /// Share of these speeds that is driven at, percent (default: 10).
    pub speed_percent: Option<Number<Percent>>,
    /// Where the robot stands before and after, controller angles, degrees: a safe posture
    /// (default: unknown, and the drive to the first posture is the engineer's).
    pub start_deg: Option<List<Deg>>,
    /// Whether the load is taken off before each move ("off", the default) or stays "on".
    #[cfg_attr(feature = "schema", schemars(with = "Option<String>", extend("enum" = ["off", "on"])))]
    pub load: Option<Text>,
}
