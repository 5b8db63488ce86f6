//! `[sensor]`, `[tracker]`, `[uncertainty]`.

use super::{Deg, Fixed, Mm, Number, RawStation, Spanned, Text};
use crate::cell::value::{Arcmin, Mrad, Percent, Um, Urad};

tables! {
    /// The force sensor whose readings stand in tables of raw readings.
    struct RawSensor as "Sensor" {
        /// "flange": between flange and tool, turning with the flange. "base": in the cell, for
        /// example at the rope's anchor.
        mount: Text [required, extend("enum" = ["flange", "base"])],
        /// Origin of the sensor's axes, about which it reports moments: in flange axes where
        /// mount = "flange", in the base frame where mount = "base", mm.
        xyz_mm: Fixed<3, Mm> [required],
        /// Roll, pitch, yaw of the sensor's axes, degrees: turns about x, then y, then z of the
        /// flange axes or the base frame.
        rpy_deg: Fixed<3, Deg> [required],
        /// "on_robot": it reports force and moment that act on the robot. "by_robot": those that
        /// the robot exerts on its surroundings, the opposite sign.
        reports: Text [required, extend("enum" = ["on_robot", "by_robot"])],
        /// "x", "y" or "z": the axis along and about which a sensor with left-handed axes counts the other
        /// way (default: its axes are right-handed).
        mirrored_axis: Text [extend("enum" = ["x", "y", "z"])],
    }

    /// The laser tracker: where its readings' axes are, and how exact it is.
    struct RawTracker as "Tracker" {
        /// Origin of the tracker's axes in the base frame, mm; zeros where the readings are in base
        /// axes already (default: found from the readings).
        xyz_mm: Fixed<3, Mm>,
        /// Roll, pitch, yaw of the tracker's axes, degrees: turns about the base's x, then y, then
        /// z axis; together with xyz_mm.
        rpy_deg: Fixed<3, Deg>,
        /// Station from which the beam goes out, tracker axes, mm (default: the origin).
        station_mm: Fixed<3, Mm>,
        /// Standard deviation of a reading along the beam, µm.
        range_um: Number<Um>,
        /// What it grows by per metre of distance, µm/m (default: 0).
        range_um_per_m: Number<Um>,
        /// Standard deviation of each of the two angles of the beam, µrad.
        angle_urad: Number<Urad>,
        /// Places of the tracker: one of them must see the measuring points of a posture (default:
        /// lines of sight are not looked at).
        station: Spanned<Vec<Spanned<RawStation>>>,
    }

    /// Standard uncertainty of errors common to the whole experiment, before the readings say what they can.
    struct RawUncertainty as "Uncertainty" {
        /// Scale of the force, per cent.
        force_scale_percent: Number<Percent>,
        /// Each coordinate of the anchor of rope or cylinder, mm.
        anchor_mm: Number<Mm>,
        /// Each coordinate of the loading point, mm.
        loading_point_mm: Number<Mm>,
        /// Each axis of the turn from tracker to base, mrad.
        registration_mrad: Number<Mrad>,
        /// Stiffness of the base about each of its horizontal axes, where it yields and nobody
        /// models it, N·m/rad.
        base_tilt_stiffness_nm_per_rad: Number,
        /// Stiffness about each axis of what lies between flange and reflectors, where it yields
        /// and nobody models it, N·m/rad.
        sensor_stiffness_nm_per_rad: Number,
        /// Each component of a constant force beside the load, of what hangs on the rope in loaded states alone, N.
        force_beside_n: Number,
        /// Each component of a displacement that all loaded readings share, mm.
        common_shift_mm: Number<Mm>,
        /// Lost motion of each joint: half the gap, minutes of arc.
        lost_motion_arcmin: Number<Arcmin>,
    }
}
