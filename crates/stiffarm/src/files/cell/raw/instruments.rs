//! `[sensor]`, `[tracker]`, `[uncertainty]`.

use super::value::{Arcmin, Mrad, Percent, Um, Urad};
use super::{At, Deg, Fixed, Mm, Number, RawStation, Text};
#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::Deserialize;

/// The force sensor whose readings stand in tables of raw readings.
#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema), schemars(rename = "Sensor"))]
#[serde(deny_unknown_fields)]
pub(in crate::files::cell) struct RawSensor {
    /// "flange": between flange and tool, turning with the flange. "base": in the cell, for
    /// example at the rope's anchor.
    #[cfg_attr(
        feature = "schema",
        schemars(required, extend("enum" = ["flange", "base"]))
    )]
    pub mount: Option<Text>,
    /// Origin of the sensor's axes, about which it reports moments: in flange axes where
    /// mount = "flange", in the base frame where mount = "base", mm.
    #[cfg_attr(feature = "schema", schemars(required))]
    pub xyz_mm: Option<Fixed<3, Mm>>,
    /// Roll, pitch, yaw of the sensor's axes, degrees: turns about x, then y, then z of the
    /// flange axes or the base frame.
    #[cfg_attr(feature = "schema", schemars(required))]
    pub rpy_deg: Option<Fixed<3, Deg>>,
    /// "on_robot": it reports force and moment that act on the robot. "by_robot": those that
    /// the robot exerts on its surroundings, the opposite sign.
    #[cfg_attr(
        feature = "schema",
        schemars(required, extend("enum" = ["on_robot", "by_robot"]))
    )]
    pub reports: Option<Text>,
}

/// The laser tracker: where its readings' axes are, and how exact it is.
#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema), schemars(rename = "Tracker"))]
#[serde(deny_unknown_fields)]
pub(in crate::files::cell) struct RawTracker {
    /// Origin of the tracker's axes in the base frame, mm; zeros where the readings are in base
    /// axes already (default: found from the readings).
    pub xyz_mm: Option<Fixed<3, Mm>>,
    /// Roll, pitch, yaw of the tracker's axes, degrees: turns about the base's x, then y, then
    /// z axis; together with xyz_mm.
    pub rpy_deg: Option<Fixed<3, Deg>>,
    /// Station from which the beam goes out, tracker axes, mm (default: the origin).
    pub station_mm: Option<Fixed<3, Mm>>,
    /// Standard deviation of a reading along the beam, µm.
    pub range_um: Option<Number<Um>>,
    /// What it grows by per metre of distance, µm/m (default: 0).
    pub range_um_per_m: Option<Number<Um>>,
    /// Standard deviation of each of the two angles of the beam, µrad.
    pub angle_urad: Option<Number<Urad>>,
    /// Places of the tracker: one of them must see the measuring points of a posture (default:
    /// lines of sight are not looked at).
    pub station: Option<At<Vec<At<RawStation>>>>,
}

/// Standard uncertainty of errors common to the whole experiment, before the readings say what they can.
#[derive(Debug, Deserialize)]
#[cfg_attr(
    feature = "schema",
    derive(JsonSchema),
    schemars(rename = "Uncertainty")
)]
#[serde(deny_unknown_fields)]
pub(in crate::files::cell) struct RawUncertainty {
    /// Scale of the force, per cent.
    pub force_scale_percent: Option<Number<Percent>>,
    /// Each coordinate of the anchor of rope or cylinder, mm.
    pub anchor_mm: Option<Number<Mm>>,
    /// Each coordinate of the loading point, mm.
    pub loading_point_mm: Option<Number<Mm>>,
    /// Each axis of the turn from tracker to base, mrad.
    pub registration_mrad: Option<Number<Mrad>>,
    /// Stiffness of the base about each of its horizontal axes, where it yields and nobody
    /// models it, N·m/rad.
    pub base_tilt_stiffness_nm_per_rad: Option<Number>,
    /// Stiffness about each axis of what lies between flange and reflectors, where it yields
    /// and nobody models it, N·m/rad.
    pub sensor_stiffness_nm_per_rad: Option<Number>,
    /// Lost motion of each joint: half the gap, minutes of arc.
    pub lost_motion_arcmin: Option<Number<Arcmin>>,
}
