//! `[sensor]`, `[tracker]`, `[uncertainty]`: the instruments, and what no
//! residual shows.

use super::raw::{RawSensor, RawTracker, RawUncertainty};
use super::source::Source;
use super::value::{Deg, Fixed, Mm, Number, Spanned};
use nalgebra::{Isometry3, Translation3};
use stiffarm::error::{Code, Result};
use stiffarm::model::instruments::{Mount, Sensor, Tracker, TrackerAccuracy, Uncertainty};
use stiffarm::model::load::Load;

const MOUNTS: [(&str, Mount); 2] = [("flange", Mount::Flange), ("base", Mount::Base)];

/// Axes by their numbers.
const AXES: [(&str, usize); 3] = [("x", 0), ("y", 1), ("z", 2)];

const REPORTS: [(&str, bool); 2] = [("on_robot", false), ("by_robot", true)];

/// The force sensor.
pub(super) fn sensor(source: &Source<'_>, table: &Spanned<RawSensor>) -> Result<Sensor> {
    let raw = table.get();
    let hint = "mount = \"flange\" (it turns with the tool) or mount = \"base\" (fixed in the cell)";
    let mount = source.required(table, &raw.mount, "mount", hint)?;
    let mount = source.choice(mount, &MOUNTS, hint)?;
    // The sign is never guessed: a wrong one turns every stiffness negative.
    let hint = "reports = \"on_robot\" (what acts on the robot) or reports = \"by_robot\" (what it exerts)";
    let reports = source.required(table, &raw.reports, "reports", hint)?;
    let reports_by_robot = source.choice(reports, &REPORTS, hint)?;
    let hint = "mirrored_axis = \"x\", \"y\" or \"z\": the one of a left-handed sensor that counts the other way";
    let mirrored = raw.mirrored_axis.as_ref();
    let mirrored = mirrored.map(|axis| source.choice(axis, &AXES, hint));
    let hint = "give the sensor's origin: xyz_mm = [x, y, z] in flange axes or the base frame";
    let xyz = source.required(table, &raw.xyz_mm, "xyz_mm", hint)?;
    let hint = "give the turn of the sensor's axes: rpy_deg = [roll, pitch, yaw], zeros if there is none";
    let rpy = source.required(table, &raw.rpy_deg, "rpy_deg", hint)?;
    Ok(Sensor { mount, pose: pose(source, xyz, rpy)?, reports_by_robot, mirrored: mirrored.transpose()? })
}

/// What the cell knows of the tracker.
pub(super) fn tracker(source: &Source<'_>, table: &Spanned<RawTracker>) -> Result<Tracker> {
    let raw = table.get();
    let base_from_tracker = match (&raw.xyz_mm, &raw.rpy_deg) {
        (None, None) => None,
        (xyz, rpy) => {
            let hint = "give both xyz_mm and rpy_deg, or none (the readings then say where the tracker stands)";
            let xyz = source.required(table, xyz, "xyz_mm", hint)?;
            let rpy = source.required(table, rpy, "rpy_deg", hint)?;
            Some(pose(source, xyz, rpy)?)
        }
    };
    Ok(Tracker { base_from_tracker, accuracy: accuracy(source, table)? })
}

fn accuracy(source: &Source<'_>, table: &Spanned<RawTracker>) -> Result<Option<TrackerAccuracy>> {
    let raw = table.get();
    let is_exact = raw.range_um.is_some() || raw.angle_urad.is_some();
    if !is_exact && raw.range_um_per_m.is_none() && raw.station_mm.is_none() {
        return Ok(None);
    }
    let hint = "the accuracy needs both range_um and angle_urad (standard deviations; a data sheet's limits are about \
        twice these)";
    let range = source.required(table, &raw.range_um, "range_um", hint)?;
    let range = source.positive(range)?;
    let angle = source.required(table, &raw.angle_urad, "angle_urad", hint)?;
    let angle = source.positive(angle)?;
    let range_per_metre = source.optional(&raw.range_um_per_m, Source::not_negative)?;
    let station = source.optional(&raw.station_mm, Source::vector)?;
    Ok(Some(TrackerAccuracy {
        station: station.unwrap_or_default(),
        range,
        range_per_metre: range_per_metre.unwrap_or(0.0),
        angle,
    }))
}

/// Errors of the whole experiment, as far as the cell says.
pub(super) fn uncertainty(source: &Source<'_>, table: &Spanned<RawUncertainty>, load: &Load) -> Result<Uncertainty> {
    let raw = table.get();
    if let (Some(anchor), false) = (&raw.anchor_mm, load.has_rope()) {
        let message = "An uncertainty of the anchor needs a load of kind \"rope\", or \"cylinder\" with anchor_mm.";
        let error = source.error(Code::Conflict, anchor, message);
        return Err(error.hint("remove anchor_mm, or set load.kind = \"rope\" or \"cylinder\""));
    }
    let compliance = |value: &Option<Number>| -> Result<Option<f64>> {
        let stiffness = source.optional(value, Source::positive)?;
        Ok(stiffness.map(|stiffness| 1.0 / stiffness))
    };
    Ok(Uncertainty {
        force_scale: source.optional(&raw.force_scale_percent, Source::not_negative)?,
        anchor: source.optional(&raw.anchor_mm, Source::not_negative)?,
        loading_point: source.optional(&raw.loading_point_mm, Source::not_negative)?,
        registration: source.optional(&raw.registration_mrad, Source::not_negative)?,
        base_tilt_compliance: compliance(&raw.base_tilt_stiffness_nm_per_rad)?,
        sensor_compliance: compliance(&raw.sensor_stiffness_nm_per_rad)?,
        force_beside: source.optional(&raw.force_beside_n, Source::not_negative)?,
        common_shift: source.optional(&raw.common_shift_mm, Source::not_negative)?,
        lost_motion: source.optional(&raw.lost_motion_arcmin, Source::not_negative)?,
    })
}

/// A frame from its origin and its roll, pitch, yaw.
fn pose(source: &Source<'_>, xyz: &Fixed<3, Mm>, rpy: &Fixed<3, Deg>) -> Result<Isometry3<f64>> {
    let origin = Translation3::from(source.vector(xyz)?);
    Ok(Isometry3::from_parts(origin, source.rotation(rpy)?))
}
