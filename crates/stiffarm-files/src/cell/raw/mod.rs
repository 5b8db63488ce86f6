//! The cell file as it is written: optional keys, each with its place.
//!
//! Every key is optional here so that a missing one is reported in the field's
//! words by the conversion; the doc comments are the descriptions of the JSON
//! Schema. Keys carry their unit as a suffix.

#[macro_use]
mod read;

mod columns;
mod instruments;
mod route;
mod scene;
mod work;

pub(super) use read::{Node, Reading, Value};

pub(super) use columns::{RawColumn, RawColumns};
pub(super) use instruments::{RawSensor, RawTracker, RawUncertainty};
pub(super) use route::{RawRoute, RawTime};
pub(super) use scene::{RawClearance, RawLinkShape, RawShape, RawStation};
pub(super) use work::{RawFeature, RawForce, RawMilling, RawWork};

use super::value::{Deg, Fixed, List, Mm, Mm2, Number, Spanned, Text, Um};

tables! {
    /// A stiffarm cell: robot, tool, load, limits and measurement noise.
    struct RawCell as "Cell" {
        /// Version of the file format: 1.
        #[expect(dead_code, reason = "checked before all other keys")]
        format: Spanned<i64> [required, extend("const" = 1)],
        /// Name of the cell in tables and reports (default: the robot's name).
        name: Text,
        /// The robot.
        robot: Spanned<RawRobot> [required],
        /// Bounds of the controller angles for choosing postures (default: the machine's limits).
        bounds: Spanned<RawBounds>,
        /// The end-effector: where it is loaded and where it is measured.
        tool: Spanned<RawTool> [required],
        /// How the robot is loaded.
        load: Spanned<RawLoad> [required],
        /// Where tool points, flange and wrist may be, base frame (default: anywhere).
        limits: Spanned<RawLimits>,
        /// What stands in the cell, base frame.
        obstacle: Spanned<Vec<Spanned<RawShape>>>,
        /// Distances that shapes, rope and beams keep.
        clearance: Spanned<RawClearance>,
        /// Measurement noise of a displacement.
        noise: Spanned<RawNoise>,
        /// Joint stiffness known beforehand.
        stiffness: Spanned<RawStiffness>,
        /// How much gives way beyond the joint axes, as an experiment on this arm or on one like
        /// it found (default: typical of an arm of this length and stiffness).
        elastic: Spanned<RawElastic>,
        /// Postures kept for validation.
        validation: Spanned<RawValidation>,
        /// Your own machining postures and loads: the task index chooses postures for the
        /// deflection predicted there.
        task: Spanned<Vec<Spanned<RawTask>>>,
        /// What the robot works with along a path: tool tip, workpiece, load of the process.
        work: Spanned<RawWork>,
        /// How the robot drives from posture to posture.
        route: Spanned<RawRoute>,
        /// What measuring takes, for the minutes of a plan.
        time: Spanned<RawTime>,
        /// The force sensor whose readings stand in tables of raw readings.
        sensor: Spanned<RawSensor>,
        /// The laser tracker: where its readings' axes are, and how exact it is.
        tracker: Spanned<RawTracker>,
        /// Standard uncertainty of errors common to the whole experiment, before the readings say what they can.
        uncertainty: Spanned<RawUncertainty>,
        /// Headings of measurement tables and paths that another software writes: ours, with the
        /// unit that the table has, = theirs.
        columns: Spanned<RawColumns>,
    }

    /// The robot: exactly one of `catalogue`, `dh_modified`, `dh_standard`.
    struct RawRobot as "Robot" {
        /// Robot of the catalogue (`stiffarm robots` lists them).
        catalogue: Text [extend("examples" = ["comau-nj165-3.0"])],
        /// Modified (Craig) Denavit–Hartenberg rows [alpha_deg, a_mm, d_mm, offset_deg], one per joint:
        /// T = RotX(alpha) TransX(a) RotZ(theta) TransZ(d).
        dh_modified: Spanned<Vec<Fixed<4>>>,
        /// Standard Denavit–Hartenberg rows [alpha_deg, a_mm, d_mm, offset_deg], one per joint:
        /// T = RotZ(theta) TransZ(d) TransX(a) RotX(alpha).
        dh_standard: Spanned<Vec<Fixed<4>>>,
        /// Turn of each joint's axis about the y axis of its frame, between TransX(a) and
        /// RotZ(theta) of dh_modified, degrees: for axes that are nearly parallel to the one
        /// before, where a common normal would lie far away (default: zeros).
        tilts_deg: List<Deg>,
        /// Origin of the flange in the last frame of the rows (of a catalogue robot: in the
        /// catalogue's flange), mm.
        flange_xyz_mm: Fixed<3, Mm>,
        /// Roll, pitch, yaw of the flange in that frame, degrees: turns about its x, then y,
        /// then z axis, which stay.
        flange_rpy_deg: Fixed<3, Deg>,
        /// Name of the robot in tables and reports.
        name: Text,
        /// Names of the joints, base to flange (default: "joint 1", "joint 2", …).
        joint_names: Spanned<Vec<Text>>,
        /// The maker of the controller whose pendant shows the angles q of this cell: "abb", "comau", "fanuc",
        /// "kuka", "staubli", "ur", "yaskawa" or "other" (default: that of a catalogue robot; else none, and
        /// no program is written for a controller).
        controller: Text [extend("enum" = ["abb", "comau", "fanuc", "kuka", "staubli", "ur", "yaskawa", "other"])],
        /// C of theta = offset + C q, one row per serial joint: signs and couplings between
        /// the controller's angles q and the mechanism's angles theta (default: the
        /// catalogue's, else the identity).
        theta_from_q: Spanned<Vec<List>>,
        /// E of the elastic coordinates e = E theta, one row per spring, for parallelogram
        /// arms (default: the identity, one spring per joint axis).
        elastic_from_theta: Spanned<Vec<List>>,
        /// Height of the robot's own base frame in the cell's base frame, mm.
        base_z_mm: Number<Mm>,
        /// Origin of the robot's own base frame in the cell's base frame, mm.
        base_xyz_mm: Fixed<3, Mm>,
        /// Roll, pitch, yaw of the robot's own base frame, degrees: turns about the cell's
        /// x, then y, then z axis.
        base_rpy_deg: Fixed<3, Deg>,
        /// The machine's limits [low, high] of each controller angle, degrees (default: the
        /// catalogue's, else -360 to 360).
        limits_deg: Spanned<Vec<Fixed<2, Deg>>>,
        /// Direction of gravity in base axes, any length (default: [0, 0, -1]); [0, 0, 1] for a
        /// robot that hangs from the ceiling and whose base frame hangs with it.
        down: Fixed<3>,
        /// Characteristic length L of the normalised Jacobian, mm (default: the length that
        /// minimises its condition number, computed when needed).
        characteristic_length_mm: Number<Mm>,
        /// Capsules around the links (default: the catalogue's).
        shape: Spanned<Vec<Spanned<RawLinkShape>>>,
        /// Largest torque of each joint under load and the tool's weight, either way, N·m. The arm's own weight
        /// is not counted: give what is left for payload and process.
        torque_limits_nm: List,
    }

    /// Bounds of the controller angles for choosing postures.
    struct RawBounds as "Bounds" {
        /// Bounds [low, high] of each controller angle, degrees, within the machine's limits.
        q_deg: Spanned<Vec<Fixed<2, Deg>>>,
    }

    /// The end-effector: where it is loaded and where it is measured, flange axes.
    struct RawTool as "Tool" {
        /// Where rope, weight or wrench act, flange axes, mm.
        loading_point_mm: Fixed<3, Mm> [required],
        /// The reflectors; the first is the tool centre point.
        measuring_point: Spanned<Vec<Spanned<RawPoint>>> [required, length(min = 1)],
        /// True when a force sensor sits between flange and reflectors (default: true where
        /// series_compliance or a sensor on the flange is given).
        has_sensor: Spanned<bool>,
        /// Known compliance of sensor and adapter between flange and reflectors.
        series_compliance: Spanned<RawSeries>,
        /// Shapes of the tool, flange axes.
        shape: Spanned<Vec<Spanned<RawShape>>>,
        /// Mass of the tool, kg: its weight counts against robot.torque_limits_nm.
        mass_kg: Number,
        /// Its centre of mass, flange axes, mm (default: the flange's origin).
        centre_of_mass_mm: Fixed<3, Mm>,
    }

    /// A measuring point (reflector).
    struct RawPoint as "MeasuringPoint" {
        /// Name in the measurement table; "base", "base-2", … are reserved for reflectors on the
        /// robot's base.
        name: Text [required],
        /// Position in flange axes, mm.
        position_mm: Fixed<3, Mm> [required],
        /// Where the reflector looks, flange axes, any length (default: all round).
        axis: Fixed<3>,
        /// Largest angle between that axis and the tracker's beam, degrees (default: 30).
        acceptance_deg: Number<Deg>,
    }

    /// Compliance between flange and reflectors, lumped at one point, along the flange axes.
    struct RawSeries as "SeriesCompliance" {
        /// Where it is lumped, flange axes, mm (default: the flange's origin).
        origin_mm: Fixed<3, Mm>,
        /// Stiffness along the flange's x, y, z, N/m.
        translational_n_per_m: Fixed<3> [required],
        /// Stiffness about the flange's x, y, z, N·m/rad.
        rotational_nm_per_rad: Fixed<3> [required],
    }

    /// How the robot is loaded.
    struct RawLoad as "Load" {
        /// "rope": from the loading point to a fixed anchor. "cylinder": a cylinder or screw that
        /// pulls or pushes, to a fixed anchor or along a direction. "weight": hangs on the loading
        /// point, along gravity. "wrench": constant force and moment. "measured": the wrench
        /// comes with each measurement. "cases": every posture is measured under each load of
        /// [[load.case]], one after the other.
        kind: Text [required, extend("enum" = ["rope", "cylinder", "weight", "wrench", "measured", "cases"])],
        /// Several loads under which every posture is measured, with kind = "cases"; each has a
        /// name and the keys of its own kind.
        case: Spanned<Vec<Spanned<RawLoad>>> [with = "Option<Vec<RawLoad>>"],
        /// Name of a load case, and of the state of readings taken under it.
        name: Text,
        /// Where a load case acts, flange axes, mm (default: the loading point of the tool).
        loading_point_mm: Fixed<3, Mm>,
        /// Force of rope, cylinder or weight, N, above zero.
        magnitude_n: Number,
        /// Mass of a weight, kg, instead of magnitude_n; standard gravity is 9.80665 m/s².
        mass_kg: Number,
        /// Anchor of the rope, or the other end of the cylinder, in the base frame, mm.
        anchor_mm: Fixed<3, Mm>,
        /// Whether the cylinder "pulls" (the force on the robot is towards the anchor, or along
        /// `direction`) or "pushes" (the other way).
        acts: Text [extend("enum" = ["pulls", "pushes"])],
        /// Direction of the pull of a guided cylinder or screw, any length, in the axes named by
        /// `axes`; instead of anchor_mm.
        direction: Fixed<3>,
        /// Force on the robot, N, in the axes named by `axes`.
        force_n: Fixed<3>,
        /// Moment on the robot about the loading point, N·m, in the axes named by `axes` (default: none).
        moment_nm: Fixed<3>,
        /// Axes of force_n and moment_nm, or of direction: "base" (fixed) or "tool" (turning with the flange).
        axes: Text [extend("enum" = ["base", "tool"])],
    }

    /// Where tool points, flange and wrist may be, base frame.
    struct RawLimits as "Limits" {
        /// Lower corner of the box for loading point, measuring points and flange, mm.
        box_min_mm: Fixed<3, Mm>,
        /// Upper corner of that box, mm.
        box_max_mm: Fixed<3, Mm>,
        /// Lowest z of loading point, measuring points and flange, mm.
        floor_mm: Number<Mm>,
        /// Radius about axis 1 that these points and the wrist centre stay out of, mm.
        keep_out_radius_mm: Number<Mm>,
        /// Lowest z of the wrist centre, mm.
        wrist_height_mm: Number<Mm>,
        /// Shortest and longest rope or cylinder [low, high], mm.
        rope_length_mm: Fixed<2, Mm>,
        /// Smallest and largest displacement [low, high] under the load, mm: the RMS over the measuring
        /// points, by the prior stiffness and the linear model. 0 as the lower one asks for none.
        displacement_mm: Fixed<2, Mm>,
    }

    /// Measurement noise of a displacement.
    struct RawNoise as "Noise" {
        /// Variance of one tracker reading per axis, mm² (default: 9.23e-5, the paper's tracker).
        variance_mm2: Number<Mm2>,
        /// Standard deviation of one tracker reading per axis, µm: the same said otherwise.
        std_um: Number<Um>,
        /// Readings behind one displacement: 1 as the paper counts (default), 2 for the
        /// difference of a loaded and an unloaded reading.
        readings_per_displacement: Spanned<i64> [extend("enum" = [1, 2])],
        /// Standard deviation of a shift common to all points of a posture (load, rope,
        /// drift), mm (default: 0).
        posture_common_mm: Number<Mm>,
    }

    /// Joint stiffness known beforehand.
    struct RawStiffness as "Stiffness" {
        /// Prior joint stiffness, one value per joint, N·m/rad (default: the catalogue's first
        /// published set, where there is one).
        prior_nm_per_rad: List,
    }

    /// How much gives way beyond the joint axes, for plans and `simulate`: standard deviations of the
    /// entries of the 6 × 6 compliances of joints and base in the mixed elastic model, all three or
    /// none, zeros: nothing does. And what a drawing or a catalogue says of bearings, links and base,
    /// which `identify` takes beside the readings.
    struct RawElastic as "Elastic" {
        /// Of shifts by forces, m/N.
        shift_std_m_per_n: Number,
        /// Of turns by moments, but for the joints' own axes, rad/(N·m).
        turn_std_rad_per_nm: Number,
        /// Of shifts by moments and turns by forces, rad/N.
        coupling_std_rad_per_n: Number,
        /// Tilting stiffness of each joint's bearing about the axes across its own, N·m/rad; 0 where
        /// it is not known.
        bearing_tilt_nm_per_rad: List,
        /// Tilting stiffness of the base about its horizontal axes, N·m/rad.
        base_tilt_nm_per_rad: Number,
        /// Bending stiffness E I of the link behind each joint, N·m²; 0 where it is not known.
        link_bending_nm2: List,
        /// Torsional stiffness G J of the link behind each joint, N·m²; 0 where it is not known.
        link_twist_nm2: List,
        /// The true stiffness of bearing, link or base is the given one times or over this factor,
        /// one standard uncertainty (default: 1.5).
        stiffness_factor: Number,
    }

    /// Postures kept for validation.
    struct RawValidation as "Validation" {
        /// Postures that take no part in the identification.
        posture: Spanned<Vec<Spanned<RawPosture>>>,
    }

    /// A posture: held to the machine's limits, not to the bounds.
    struct RawPosture as "Posture" {
        /// Name of the posture.
        name: Text [required],
        /// Controller angles, degrees, one per joint.
        q_deg: List<Deg> [required],
    }

    /// A machining posture with its load, which acts at the tool tip.
    struct RawTask as "Task" {
        /// Name of the task in tables (default: "task 1", "task 2", …).
        name: Text,
        /// Controller angles, degrees, one per joint: held to the machine's limits, not to the bounds.
        q_deg: List<Deg> [required],
        /// Force on the robot at the tip, N, in the axes named by `axes`.
        force_n: Fixed<3> [required],
        /// Moment on the robot about the tip, N·m, in the axes named by `axes` (default: none).
        moment_nm: Fixed<3>,
        /// Axes of force_n and moment_nm: "base" (fixed, the default) or "tool" (turning with
        /// the flange).
        axes: Text [extend("enum" = ["base", "tool"])],
        /// Tool tip in flange axes, mm: where the force acts and whose deflection counts
        /// (default: the first measuring point).
        tip_mm: Fixed<3, Mm>,
    }
}
