//! `[work]`: tool tip, workpiece, and the load of the process.

use super::value::{NPerMm, NPerMm2};
use super::{At, Deg, Fixed, Mm, Number, Text};
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::Deserialize;

/// What the robot works with: tool tip, workpiece, and the load of the process where a path's
/// rows do not give it (`force` or `milling`).
#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema), schemars(rename = "Work"))]
#[serde(deny_unknown_fields)]
pub(in crate::files::cell) struct RawWork {
    /// Tool tip, the contact point, in flange axes, mm (default: the first measuring point).
    pub tip_mm: Option<Fixed<3, Mm>>,
    /// Roll, pitch, yaw of the tip frame, degrees: turns about the flange's x, then y, then z
    /// axis (default: none). Its z is the tool axis, out of the tool into the workpiece.
    pub tip_rpy_deg: Option<Fixed<3, Deg>>,
    /// Origin of the workpiece frame, in which the poses of a path are given, in the base frame,
    /// mm (default: zeros).
    pub workpiece_mm: Option<Fixed<3, Mm>>,
    /// Roll, pitch, yaw of the workpiece frame, degrees: turns about the base's x, then y, then
    /// z axis (default: none).
    pub workpiece_rpy_deg: Option<Fixed<3, Deg>>,
    /// The same load all along the path.
    pub force: Option<At<RawForce>>,
    /// The mean load of a milling cut.
    pub milling: Option<At<RawMilling>>,
}

/// A load that is the same all along the path.
#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema), schemars(rename = "Force"))]
#[serde(deny_unknown_fields)]
pub(in crate::files::cell) struct RawForce {
    /// Force on the robot at the tip, N, in the axes named by `axes`.
    #[cfg_attr(feature = "schema", schemars(required))]
    pub force_n: Option<Fixed<3>>,
    /// Moment on the robot about the tip, N·m, in the axes named by `axes` (default: none).
    pub moment_nm: Option<Fixed<3>>,
    /// Axes of force_n and moment_nm: "base", "tool" (the tip frame), "workpiece", or "path" (z
    /// the tool axis, x the feed across it, y = z × x).
    #[cfg_attr(
        feature = "schema",
        schemars(required, extend("enum" = ["base", "tool", "workpiece", "path"]))
    )]
    pub axes: Option<Text>,
}

/// A milling cut with a cylindrical cutter, which turns clockwise seen from the spindle; its
/// mean load acts on the tip.
#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema), schemars(rename = "Milling"))]
#[serde(deny_unknown_fields)]
pub(in crate::files::cell) struct RawMilling {
    /// Number of teeth.
    #[cfg_attr(feature = "schema", schemars(required, with = "i64", range(min = 1)))]
    pub teeth: Option<At<i64>>,
    /// Diameter of the cutter, mm.
    #[cfg_attr(feature = "schema", schemars(required))]
    pub diameter_mm: Option<Number<Mm>>,
    /// Depth of cut along the tool axis, mm.
    #[cfg_attr(feature = "schema", schemars(required))]
    pub axial_depth_mm: Option<Number<Mm>>,
    /// Width of cut across feed and tool axis, mm; at most the diameter, which is a full slot.
    #[cfg_attr(feature = "schema", schemars(required))]
    pub radial_depth_mm: Option<Number<Mm>>,
    /// Feed per tooth, mm: feed rate / (spindle speed · teeth).
    #[cfg_attr(feature = "schema", schemars(required))]
    pub feed_per_tooth_mm: Option<Number<Mm>>,
    /// "up" (conventional: the workpiece lies to the left of the feed, seen from the spindle) or
    /// "down" (climb: to the right).
    #[cfg_attr(
        feature = "schema",
        schemars(required, extend("enum" = ["up", "down"]))
    )]
    pub direction: Option<Text>,
    /// Tangential cutting coefficient, N/mm² (the specific cutting force).
    #[cfg_attr(feature = "schema", schemars(required))]
    pub k_tc_n_per_mm2: Option<Number<NPerMm2>>,
    /// Radial cutting coefficient, N/mm².
    #[cfg_attr(feature = "schema", schemars(required))]
    pub k_rc_n_per_mm2: Option<Number<NPerMm2>>,
    /// Axial cutting coefficient, N/mm²: above zero where it pulls the tool out of the spindle,
    /// as a right-hand helix does (default: 0).
    pub k_ac_n_per_mm2: Option<Number<NPerMm2>>,
    /// Tangential edge coefficient, N/mm (default: 0).
    pub k_te_n_per_mm: Option<Number<NPerMm>>,
    /// Radial edge coefficient, N/mm (default: 0).
    pub k_re_n_per_mm: Option<Number<NPerMm>>,
    /// Axial edge coefficient, N/mm, signed as k_ac_n_per_mm2 (default: 0).
    pub k_ae_n_per_mm: Option<Number<NPerMm>>,
}
