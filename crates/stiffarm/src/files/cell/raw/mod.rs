//! The cell file as it is written: optional keys, each with its place.
//!
//! Every key is optional here so that a missing one is reported in the field's
//! words by the conversion; the doc comments are the descriptions of the JSON
//! Schema. Keys carry their unit as a suffix.

mod columns;
mod instruments;
mod route;
mod scene;
mod value;
mod work;

pub(super) use columns::{RawColumn, RawColumns};
pub(super) use instruments::{RawSensor, RawTracker, RawUncertainty};
pub(super) use route::RawRoute;
pub(super) use scene::{RawClearance, RawLinkShape, RawShape, RawStation};
pub(super) use work::{RawForce, RawMilling, RawWork};

pub(super) use value::{At, Deg, Fixed, List, Mm, Number, Placed, Text, Unit};

#[cfg(feature = "schema")]
use schemars::JsonSchema;
use serde::Deserialize;
use value::{Mm2, Um};

/// A stiffarm cell: robot, tool, load, limits and measurement noise.
#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema), schemars(rename = "Cell"))]
#[serde(deny_unknown_fields)]
pub(super) struct RawCell {
    /// Version of the file format: 1.
    #[cfg_attr(feature = "schema", schemars(required, extend("const" = 1)))]
    #[expect(dead_code, reason = "checked before all other keys")]
    pub format: Option<At<i64>>,
    /// Name of the cell in tables and reports (default: the robot's name).
    pub name: Option<Text>,
    /// The robot.
    #[cfg_attr(feature = "schema", schemars(required))]
    pub robot: Option<At<RawRobot>>,
    /// Bounds of the controller angles for choosing postures (default: the machine's limits).
    pub bounds: Option<At<RawBounds>>,
    /// The end-effector: where it is loaded and where it is measured.
    #[cfg_attr(feature = "schema", schemars(required))]
    pub tool: Option<At<RawTool>>,
    /// How the robot is loaded.
    #[cfg_attr(feature = "schema", schemars(required))]
    pub load: Option<At<RawLoad>>,
    /// Where tool points, flange and wrist may be, base frame (default: anywhere).
    pub limits: Option<At<RawLimits>>,
    /// What stands in the cell, base frame.
    pub obstacle: Option<At<Vec<At<RawShape>>>>,
    /// Distances that shapes, rope and beams keep.
    pub clearance: Option<At<RawClearance>>,
    /// Measurement noise of a displacement.
    pub noise: Option<At<RawNoise>>,
    /// Joint stiffness known beforehand.
    pub stiffness: Option<At<RawStiffness>>,
    /// How much gives way beyond the joint axes, as an experiment on this arm or on one like
    /// it found (default: typical of an arm of this length and stiffness).
    pub elastic: Option<At<RawElastic>>,
    /// Postures kept for validation.
    pub validation: Option<At<RawValidation>>,
    /// Your own machining postures and loads: the task index chooses postures for the
    /// deflection predicted there.
    pub task: Option<At<Vec<At<RawTask>>>>,
    /// What the robot works with along a path: tool tip, workpiece, load of the process.
    pub work: Option<At<RawWork>>,
    /// How the robot drives from posture to posture.
    pub route: Option<At<RawRoute>>,
    /// The force sensor whose readings stand in tables of raw readings.
    pub sensor: Option<At<RawSensor>>,
    /// The laser tracker: where its readings' axes are, and how exact it is.
    pub tracker: Option<At<RawTracker>>,
    /// Standard uncertainty of errors common to the whole experiment, before the readings say what they can.
    pub uncertainty: Option<At<RawUncertainty>>,
    /// Headings of measurement tables and paths that another software writes: ours, with the
    /// unit that the table has, = theirs.
    pub columns: Option<At<RawColumns>>,
}

/// The robot: exactly one of `catalogue`, `dh_modified`, `dh_standard`.
#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema), schemars(rename = "Robot"))]
#[serde(deny_unknown_fields)]
pub(super) struct RawRobot {
    /// Robot of the catalogue (`stiffarm robots` lists them).
    #[cfg_attr(feature = "schema", schemars(extend("examples" = ["comau-nj165-3.0"])))]
    pub catalogue: Option<Text>,
    /// Modified (Craig) Denavit–Hartenberg rows [alpha_deg, a_mm, d_mm, offset_deg], one per joint:
    /// T = RotX(alpha) TransX(a) RotZ(theta) TransZ(d).
    pub dh_modified: Option<At<Vec<Fixed<4>>>>,
    /// Standard Denavit–Hartenberg rows [alpha_deg, a_mm, d_mm, offset_deg], one per joint:
    /// T = RotZ(theta) TransZ(d) TransX(a) RotX(alpha).
    pub dh_standard: Option<At<Vec<Fixed<4>>>>,
    /// Turn of each joint's axis about the y axis of its frame, between TransX(a) and
    /// RotZ(theta) of dh_modified, degrees: for axes that are nearly parallel to the one
    /// before, where a common normal would lie far away (default: zeros).
    pub tilts_deg: Option<List<Deg>>,
    /// Origin of the flange in the last frame of the rows (of a catalogue robot: in the
    /// catalogue's flange), mm.
    pub flange_xyz_mm: Option<Fixed<3, Mm>>,
    /// Roll, pitch, yaw of the flange in that frame, degrees: turns about its x, then y,
    /// then z axis, which stay.
    pub flange_rpy_deg: Option<Fixed<3, Deg>>,
    /// Name of the robot in tables and reports.
    pub name: Option<Text>,
    /// Names of the joints, base to flange (default: "joint 1", "joint 2", …).
    pub joint_names: Option<At<Vec<Text>>>,
    /// The maker of the controller whose pendant shows the angles q of this cell: "abb", "comau", "fanuc",
    /// "kuka", "staubli", "ur", "yaskawa" or "other" (default: that of a catalogue robot; else none, and
    /// no program is written for a controller).
    #[cfg_attr(feature = "schema", schemars(extend("enum" = ["abb", "comau", "fanuc", "kuka", "staubli", "ur", "yaskawa", "other"])))]
    pub controller: Option<Text>,
    /// C of theta = offset + C q, one row per serial joint: signs and couplings between
    /// the controller's angles q and the mechanism's angles theta (default: the
    /// catalogue's, else the identity).
    pub theta_from_q: Option<At<Vec<List>>>,
    /// E of the elastic coordinates e = E theta, one row per spring, for parallelogram
    /// arms (default: the identity, one spring per joint axis).
    pub elastic_from_theta: Option<At<Vec<List>>>,
    /// Height of the robot's own base frame in the cell's base frame, mm.
    pub base_z_mm: Option<Number<Mm>>,
    /// Origin of the robot's own base frame in the cell's base frame, mm.
    pub base_xyz_mm: Option<Fixed<3, Mm>>,
    /// Roll, pitch, yaw of the robot's own base frame, degrees: turns about the cell's
    /// x, then y, then z axis.
    pub base_rpy_deg: Option<Fixed<3, Deg>>,
    /// The machine's limits [low, high] of each controller angle, degrees (default: the
    /// catalogue's, else -360 to 360).
    pub limits_deg: Option<At<Vec<Fixed<2, Deg>>>>,
    /// Direction of gravity in base axes, any length (default: [0, 0, -1]); [0, 0, 1] for a
    /// robot that hangs from the ceiling and whose base frame hangs with it.
    pub down: Option<Fixed<3>>,
    /// Characteristic length L of the normalised Jacobian, mm (default: the length that
    /// minimises its condition number, computed when needed).
    pub characteristic_length_mm: Option<Number<Mm>>,
    /// Capsules around the links (default: the catalogue's).
    pub shape: Option<At<Vec<At<RawLinkShape>>>>,
    /// Largest torque of each joint under load and the tool's weight, either way, N·m. The arm's own weight
    /// is not counted: give what is left for payload and process.
    pub torque_limits_nm: Option<List>,
}

/// Bounds of the controller angles for choosing postures.
#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema), schemars(rename = "Bounds"))]
#[serde(deny_unknown_fields)]
pub(super) struct RawBounds {
    /// Bounds [low, high] of each controller angle, degrees, within the machine's limits.
    pub q_deg: Option<At<Vec<Fixed<2, Deg>>>>,
}

/// The end-effector: where it is loaded and where it is measured, flange axes.
#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema), schemars(rename = "Tool"))]
#[serde(deny_unknown_fields)]
pub(super) struct RawTool {
    /// Where rope, weight or wrench act, flange axes, mm.
    #[cfg_attr(feature = "schema", schemars(required))]
    pub loading_point_mm: Option<Fixed<3, Mm>>,
    /// The reflectors; the first is the tool centre point.
    #[cfg_attr(feature = "schema", schemars(required, length(min = 1)))]
    pub measuring_point: Option<At<Vec<At<RawPoint>>>>,
    /// True when a force sensor sits between flange and reflectors (default: true where
    /// series_compliance or a sensor on the flange is given).
    pub has_sensor: Option<At<bool>>,
    /// Known compliance of sensor and adapter between flange and reflectors.
    pub series_compliance: Option<At<RawSeries>>,
    /// Shapes of the tool, flange axes.
    pub shape: Option<At<Vec<At<RawShape>>>>,
    /// Mass of the tool, kg: its weight counts against robot.torque_limits_nm.
    pub mass_kg: Option<Number>,
    /// Its centre of mass, flange axes, mm (default: the flange's origin).
    pub centre_of_mass_mm: Option<Fixed<3, Mm>>,
}

/// A measuring point (reflector).
#[derive(Debug, Deserialize)]
#[cfg_attr(
    feature = "schema",
    derive(JsonSchema),
    schemars(rename = "MeasuringPoint")
)]
#[serde(deny_unknown_fields)]
pub(super) struct RawPoint {
    /// Name in the measurement table; "base", "base-2", … are reserved for reflectors on the
    /// robot's base.
    #[cfg_attr(feature = "schema", schemars(required))]
    pub name: Option<Text>,
    /// Position in flange axes, mm.
    #[cfg_attr(feature = "schema", schemars(required))]
    pub position_mm: Option<Fixed<3, Mm>>,
    /// Where the reflector looks, flange axes, any length (default: all round).
    pub axis: Option<Fixed<3>>,
    /// Largest angle between that axis and the tracker's beam, degrees (default: 30).
    pub acceptance_deg: Option<Number<Deg>>,
}

/// Compliance between flange and reflectors, lumped at one point, along the flange axes.
#[derive(Debug, Deserialize)]
#[cfg_attr(
    feature = "schema",
    derive(JsonSchema),
    schemars(rename = "SeriesCompliance")
)]
#[serde(deny_unknown_fields)]
pub(super) struct RawSeries {
    /// Where it is lumped, flange axes, mm (default: the flange's origin).
    pub origin_mm: Option<Fixed<3, Mm>>,
    /// Stiffness along the flange's x, y, z, N/m.
    #[cfg_attr(feature = "schema", schemars(required))]
    pub translational_n_per_m: Option<Fixed<3>>,
    /// Stiffness about the flange's x, y, z, N·m/rad.
    #[cfg_attr(feature = "schema", schemars(required))]
    pub rotational_nm_per_rad: Option<Fixed<3>>,
}

/// How the robot is loaded.
#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema), schemars(rename = "Load"))]
#[serde(deny_unknown_fields)]
pub(super) struct RawLoad {
    /// "rope": from the loading point to a fixed anchor. "cylinder": a cylinder or screw that
    /// pulls or pushes, to a fixed anchor or along a direction. "weight": hangs on the loading
    /// point, along gravity. "wrench": constant force and moment. "measured": the wrench
    /// comes with each measurement. "cases": every posture is measured under each load of
    /// [[load.case]], one after the other.
    #[cfg_attr(
        feature = "schema",
        schemars(required, extend("enum" = ["rope", "cylinder", "weight", "wrench", "measured", "cases"]))
    )]
    pub kind: Option<Text>,
    /// Several loads under which every posture is measured, with kind = "cases"; each has a
    /// name and the keys of its own kind.
    #[cfg_attr(feature = "schema", schemars(with = "Option<Vec<RawLoad>>"))]
    pub case: Option<At<Vec<At<RawLoad>>>>,
    /// Name of a load case, and of the state of readings taken under it.
    pub name: Option<Text>,
    /// Where a load case acts, flange axes, mm (default: the loading point of the tool).
    pub loading_point_mm: Option<Fixed<3, Mm>>,
    /// Force of rope, cylinder or weight, N, above zero.
    pub magnitude_n: Option<Number>,
    /// Mass of a weight, kg, instead of magnitude_n; standard gravity is 9.80665 m/s².
    pub mass_kg: Option<Number>,
    /// Anchor of the rope, or the other end of the cylinder, in the base frame, mm.
    pub anchor_mm: Option<Fixed<3, Mm>>,
    /// Whether the cylinder "pulls" (the force on the robot is towards the anchor, or along
    /// `direction`) or "pushes" (the other way).
    #[cfg_attr(feature = "schema", schemars(extend("enum" = ["pulls", "pushes"])))]
    pub acts: Option<Text>,
    /// Direction of the pull of a guided cylinder or screw, any length, in the axes named by
    /// `axes`; instead of anchor_mm.
    pub direction: Option<Fixed<3>>,
    /// Force on the robot, N, in the axes named by `axes`.
    pub force_n: Option<Fixed<3>>,
    /// Moment on the robot about the loading point, N·m, in the axes named by `axes` (default: none).
    pub moment_nm: Option<Fixed<3>>,
    /// Axes of force_n and moment_nm, or of direction: "base" (fixed) or "tool" (turning with the flange).
    #[cfg_attr(feature = "schema", schemars(extend("enum" = ["base", "tool"])))]
    pub axes: Option<Text>,
}

/// Where tool points, flange and wrist may be, base frame.
#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema), schemars(rename = "Limits"))]
#[serde(deny_unknown_fields)]
pub(super) struct RawLimits {
    /// Lower corner of the box for loading point, measuring points and flange, mm.
    pub box_min_mm: Option<Fixed<3, Mm>>,
    /// Upper corner of that box, mm.
    pub box_max_mm: Option<Fixed<3, Mm>>,
    /// Lowest z of loading point, measuring points and flange, mm.
    pub floor_mm: Option<Number<Mm>>,
    /// Radius about axis 1 that these points and the wrist centre stay out of, mm.
    pub keep_out_radius_mm: Option<Number<Mm>>,
    /// Lowest z of the wrist centre, mm.
    pub wrist_height_mm: Option<Number<Mm>>,
    /// Shortest and longest rope or cylinder [low, high], mm.
    pub rope_length_mm: Option<Fixed<2, Mm>>,
    /// Smallest and largest displacement [low, high] under the load, mm: the RMS over the measuring
    /// points, by the prior stiffness and the linear model. 0 as the lower one asks for none.
    pub displacement_mm: Option<Fixed<2, Mm>>,
}

/// Measurement noise of a displacement.
#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema), schemars(rename = "Noise"))]
#[serde(deny_unknown_fields)]
pub(super) struct RawNoise {
    /// Variance of one tracker reading per axis, mm² (default: 9.23e-5, the paper's tracker).
    pub variance_mm2: Option<Number<Mm2>>,
    /// Standard deviation of one tracker reading per axis, µm: the same said otherwise.
    pub std_um: Option<Number<Um>>,
    /// Readings behind one displacement: 1 as the paper counts (default), 2 for the
    /// difference of a loaded and an unloaded reading.
    #[cfg_attr(feature = "schema", schemars(extend("enum" = [1, 2])))]
    pub readings_per_displacement: Option<At<i64>>,
    /// Standard deviation of a shift common to all points of a posture (load, rope,
    /// drift), mm (default: 0).
    pub posture_common_mm: Option<Number<Mm>>,
}

/// Joint stiffness known beforehand.
#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema), schemars(rename = "Stiffness"))]
#[serde(deny_unknown_fields)]
pub(super) struct RawStiffness {
    /// Prior joint stiffness, one value per joint, N·m/rad (default: the catalogue's first
    /// published set, where there is one).
    pub prior_nm_per_rad: Option<List>,
}

/// How much gives way beyond the joint axes: standard deviations of the entries of the 6 × 6
/// compliances of joints and base in the mixed elastic model. Zeros: nothing does.
#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema), schemars(rename = "Elastic"))]
#[serde(deny_unknown_fields)]
pub(super) struct RawElastic {
    /// Of shifts by forces, m/N.
    #[cfg_attr(feature = "schema", schemars(required))]
    pub shift_std_m_per_n: Option<Number>,
    /// Of turns by moments, but for the joints' own axes, rad/(N·m).
    #[cfg_attr(feature = "schema", schemars(required))]
    pub turn_std_rad_per_nm: Option<Number>,
    /// Of shifts by moments and turns by forces, rad/N.
    #[cfg_attr(feature = "schema", schemars(required))]
    pub coupling_std_rad_per_n: Option<Number>,
}

/// Postures kept for validation.
#[derive(Debug, Deserialize)]
#[cfg_attr(
    feature = "schema",
    derive(JsonSchema),
    schemars(rename = "Validation")
)]
#[serde(deny_unknown_fields)]
pub(super) struct RawValidation {
    /// Postures that take no part in the identification.
    pub posture: Option<At<Vec<At<RawPosture>>>>,
}

/// A posture: held to the machine's limits, not to the bounds.
#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema), schemars(rename = "Posture"))]
#[serde(deny_unknown_fields)]
pub(super) struct RawPosture {
    /// Name of the posture.
    #[cfg_attr(feature = "schema", schemars(required))]
    pub name: Option<Text>,
    /// Controller angles, degrees, one per joint.
    #[cfg_attr(feature = "schema", schemars(required))]
    pub q_deg: Option<List<Deg>>,
}

/// A machining posture with its load, which acts at the tool tip.
#[derive(Debug, Deserialize)]
#[cfg_attr(feature = "schema", derive(JsonSchema), schemars(rename = "Task"))]
#[serde(deny_unknown_fields)]
pub(super) struct RawTask {
    /// Name of the task in tables (default: "task 1", "task 2", …).
    pub name: Option<Text>,
    /// Controller angles, degrees, one per joint: held to the machine's limits, not to the bounds.
    #[cfg_attr(feature = "schema", schemars(required))]
    pub q_deg: Option<List<Deg>>,
    /// Force on the robot at the tip, N, in the axes named by `axes`.
    #[cfg_attr(feature = "schema", schemars(required))]
    pub force_n: Option<Fixed<3>>,
    /// Moment on the robot about the tip, N·m, in the axes named by `axes` (default: none).
    pub moment_nm: Option<Fixed<3>>,
    /// Axes of force_n and moment_nm: "base" (fixed, the default) or "tool" (turning with
    /// the flange).
    #[cfg_attr(feature = "schema", schemars(extend("enum" = ["base", "tool"])))]
    pub axes: Option<Text>,
    /// Tool tip in flange axes, mm: where the force acts and whose deflection counts
    /// (default: the first measuring point).
    pub tip_mm: Option<Fixed<3, Mm>>,
}
