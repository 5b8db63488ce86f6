//! `[sensor]`, `[tracker]`, `[uncertainty]`: the instruments, and what no
//! residual shows.

use super::raw::{At, Number, Numbers, RawSensor, RawTracker, RawUncertainty, Text};
use super::source::Source;
use crate::error::{Code, Result, did_you_mean};
use crate::model::instruments::{Mount, Sensor, Tracker, TrackerAccuracy, Uncertainty};
use crate::model::load::Load;
use crate::units::{
    arcmin_to_rad, mm_to_m, mrad_to_rad, percent_to_fraction, um_to_m, urad_to_rad,
};
use nalgebra::{Isometry3, Translation3, Vector3};

const MOUNTS: [(&str, Mount); 2] = [("flange", Mount::Flange), ("base", Mount::Base)];

const REPORTS: [(&str, bool); 2] = [("on_robot", false), ("by_robot", true)];

/// The force sensor, where there is one.
pub(super) fn sensor(source: &Source<'_>, table: Option<&At<RawSensor>>) -> Result<Option<Sensor>> {
    let Some(table) = table else {
        return Ok(None);
    };
    let (raw, at) = (table.get(), Some(table.span()));
    let hint =
        "mount = \"flange\" (it turns with the tool) or mount = \"base\" (fixed in the cell)";
    let mount = source.required(&raw.mount, "sensor.mount", at.clone(), hint)?;
    let mount = choice(source, mount, "sensor.mount", &MOUNTS, hint)?;
    // The sign is never guessed: a wrong one turns every stiffness negative.
    let hint = "reports = \"on_robot\" (what acts on the robot) or reports = \"by_robot\" (what it exerts)";
    let reports = source.required(&raw.reports, "sensor.reports", at.clone(), hint)?;
    let reports_by_robot = choice(source, reports, "sensor.reports", &REPORTS, hint)?;
    let hint = "give the sensor's origin: xyz_mm = [x, y, z] in flange axes or the base frame";
    let xyz = source.required(&raw.xyz_mm, "sensor.xyz_mm", at.clone(), hint)?;
    let hint =
        "give the turn of the sensor's axes: rpy_deg = [roll, pitch, yaw], zeros if there is none";
    let rpy = source.required(&raw.rpy_deg, "sensor.rpy_deg", at, hint)?;
    Ok(Some(Sensor {
        mount,
        pose: pose(source, xyz, rpy, "sensor")?,
        reports_by_robot,
    }))
}

/// What the cell knows of the tracker.
pub(super) fn tracker(source: &Source<'_>, table: Option<&At<RawTracker>>) -> Result<Tracker> {
    let Some(table) = table else {
        return Ok(Tracker::default());
    };
    let raw = table.get();
    let base_from_tracker = match (&raw.xyz_mm, &raw.rpy_deg) {
        (None, None) => None,
        (xyz, rpy) => {
            let hint = "give both xyz_mm and rpy_deg, or none (the readings then say where the tracker stands)";
            let at = Some(table.span());
            let xyz = source.required(xyz, "tracker.xyz_mm", at.clone(), hint)?;
            let rpy = source.required(rpy, "tracker.rpy_deg", at, hint)?;
            Some(pose(source, xyz, rpy, "tracker")?)
        }
    };
    Ok(Tracker {
        base_from_tracker,
        accuracy: accuracy(source, table)?,
    })
}

fn accuracy(source: &Source<'_>, table: &At<RawTracker>) -> Result<Option<TrackerAccuracy>> {
    let (raw, at) = (table.get(), Some(table.span()));
    let given = [&raw.range_um, &raw.range_um_per_m, &raw.angle_urad];
    if given.iter().all(|number| number.is_none()) && raw.station_mm.is_none() {
        return Ok(None);
    }
    let hint = "the accuracy needs both range_um and angle_urad (standard deviations; a data sheet's limits are about twice these)";
    let key = "tracker.range_um";
    let range = source.required(&raw.range_um, key, at.clone(), hint)?;
    let range = um_to_m(source.positive(range, key)?);
    let key = "tracker.angle_urad";
    let angle = source.required(&raw.angle_urad, key, at, hint)?;
    let angle = urad_to_rad(source.positive(angle, key)?);
    let key = "tracker.range_um_per_m";
    let range_per_metre = not_negative(source, &raw.range_um_per_m, key, um_to_m)?;
    let station = match &raw.station_mm {
        Some(station) => source.vector(station, "tracker.station_mm")?.map(mm_to_m),
        None => Vector3::zeros(),
    };
    Ok(Some(TrackerAccuracy {
        station,
        range,
        range_per_metre: range_per_metre.unwrap_or(0.0),
        angle,
    }))
}

/// Errors of the whole experiment, as far as the cell says.
pub(super) fn uncertainty(
    source: &Source<'_>,
    table: Option<&At<RawUncertainty>>,
    load: &Load,
) -> Result<Uncertainty> {
    let Some(raw) = table.map(At::get) else {
        return Ok(Uncertainty::default());
    };
    if let (Some(anchor), false) = (&raw.anchor_mm, load.has_rope()) {
        let message = "An uncertainty of the anchor needs a load of kind \"rope\", or \"cylinder\" with anchor_mm.";
        let error = source.error(
            Code::Conflict,
            "uncertainty.anchor_mm",
            anchor.span(),
            message,
        );
        return Err(error.hint("remove anchor_mm, or set load.kind = \"rope\" or \"cylinder\""));
    }
    let number = |value: &Option<Number>, key: &str, to_si: fn(f64) -> f64| {
        not_negative(source, value, &format!("uncertainty.{key}"), to_si)
    };
    let compliance = |value: &Option<Number>, key: &str| -> Result<Option<f64>> {
        let key = format!("uncertainty.{key}");
        let stiffness = value.as_ref().map(|value| source.positive(value, &key));
        Ok(stiffness.transpose()?.map(|stiffness| 1.0 / stiffness))
    };
    Ok(Uncertainty {
        force_scale: number(
            &raw.force_scale_percent,
            "force_scale_percent",
            percent_to_fraction,
        )?,
        anchor: number(&raw.anchor_mm, "anchor_mm", mm_to_m)?,
        loading_point: number(&raw.loading_point_mm, "loading_point_mm", mm_to_m)?,
        registration: number(&raw.registration_mrad, "registration_mrad", mrad_to_rad)?,
        base_tilt_compliance: compliance(
            &raw.base_tilt_stiffness_nm_per_rad,
            "base_tilt_stiffness_nm_per_rad",
        )?,
        sensor_compliance: compliance(
            &raw.sensor_stiffness_nm_per_rad,
            "sensor_stiffness_nm_per_rad",
        )?,
        lost_motion: number(&raw.lost_motion_arcmin, "lost_motion_arcmin", arcmin_to_rad)?,
    })
}

fn not_negative(
    source: &Source<'_>,
    value: &Option<Number>,
    key: &str,
    to_si: fn(f64) -> f64,
) -> Result<Option<f64>> {
    let number = value.as_ref().map(|value| source.not_negative(value, key));
    Ok(number.transpose()?.map(to_si))
}

/// A frame from its origin and its roll, pitch, yaw.
fn pose(source: &Source<'_>, xyz: &Numbers, rpy: &Numbers, table: &str) -> Result<Isometry3<f64>> {
    let origin = source.vector(xyz, &format!("{table}.xyz_mm"))?.map(mm_to_m);
    let rotation = source.rotation(rpy, &format!("{table}.rpy_deg"))?;
    Ok(Isometry3::from_parts(Translation3::from(origin), rotation))
}

/// One of a few words.
pub(super) fn choice<T: Copy>(
    source: &Source<'_>,
    given: &Text,
    key: &str,
    choices: &[(&str, T)],
    hint: &str,
) -> Result<T> {
    let word = given.get().as_str();
    if let Some((_, value)) = choices.iter().find(|(name, _)| *name == word) {
        return Ok(*value);
    }
    let message = format!("\"{word}\" is not one of the choices.");
    let nearest = did_you_mean(word, choices.iter().map(|(name, _)| *name));
    let error = source.error(Code::InvalidValue, key, given.span(), message);
    Err(error.hint(nearest.unwrap_or_else(|| hint.to_string())))
}
