//! Several stations of the tracker: the readings of each are put into the axes of one of them, so that all that follows
//! knows one frame.
//!
//! What two stations have in common is the robot. Where both read three reflectors on its base, these tie them, else
//! the unloaded readings of each against the kinematic model.

use super::unloaded::{UnloadedRegistration, by_themselves, fits};
use crate::error::{Error, Result};
use crate::findings::{Finding, length, list};
use crate::measure::registration::{Pair, is_spread, rigid_transform, rms};
use crate::measure::series::PostureSeries;
use crate::model::cell::Cell;
use crate::model::measurement::{PostureReadings, ReadingTable, ReadingTarget, Role};
use nalgebra::{Isometry3, Point3, Vector3};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// Misfit of a station by itself above which the model is in doubt \[m\].
const DOUBTFUL: f64 = 2e-3;
/// Base reflectors that tie two stations.
const REFLECTORS: usize = 3;

/// One station of the tracker.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct StationRegistration {
    /// Its name in the table.
    pub station: String,
    /// The postures that were read from it.
    pub postures: Vec<String>,
    /// Rotation from its tracker to base axes, row by row.
    pub rotation: [[f64; 3]; 3],
    /// Origin of its tracker's frame in the base frame \[m\].
    pub translation_m: [f64; 3],
    /// RMS distance of its unloaded points from the model, of the postures used \[m\]; `None` without any.
    pub rms_m: Option<f64>,
    /// Whether there is a single posture, and nothing but its own readings to say where the station stands: they fit
    /// whatever its angles are.
    pub angles_unchecked: bool,
}

/// A station by itself.
struct StationFit {
    base_from_tracker: Isometry3<f64>,
    pairs: Vec<Pair>,
    rms: f64,
    /// Reflectors on the base, unloaded, tracker axes \[m\].
    base: BTreeMap<String, Vector3<f64>>,
}

/// Puts the readings of all stations into the axes of one: of the first that `stated_transform` fits, else of the
/// first. Postures of a station whose unloaded readings do not say where it stands are left out, with a remark. The
/// result names the station with most postures where one does not fit the model by itself.
///
/// # Errors
/// No station says where it stands.
pub(in crate::measure) fn in_one_frame(
    cell: &Cell,
    table: &mut ReadingTable,
    stated_transform: Option<&Isometry3<f64>>,
) -> Result<Option<String>> {
    let stated_transform = stated_transform.or(cell.tracker.base_from_tracker.as_ref());
    let mut names: Vec<String> = table.stations().into_iter().map(String::from).collect();
    if names.len() < 2 {
        return Ok(None);
    }
    let series = PostureSeries::all(table);
    let of_station = |name: &String| {
        let station_series = series.iter();
        let station_series = station_series.filter(|s| s.readings.station.as_ref() == Some(name));
        station_series.cloned().collect::<Vec<PostureSeries<'_>>>()
    };
    let mut all = Vec::with_capacity(names.len());
    let mut failed: Vec<(String, Error)> = Vec::new();
    for name in &names {
        match alone(cell, &of_station(name)) {
            Ok(station) => all.push(station),
            Err(error) => failed.push((name.clone(), error)),
        }
    }
    names.retain(|name| failed.iter().all(|(other, _)| other != name));
    if names.is_empty()
        && let Some((name, error)) = failed.first()
    {
        let message = format!("Station \"{name}\": {}", error.message());
        let hint = "read more of the points unloaded from there, or leave its postures out";
        return Err(Error::new(error.code(), message).hint(hint));
    }
    let most = names.iter().max_by_key(|name| of_station(name).len());
    let doubtful = all.iter().any(|station| station.rms > DOUBTFUL);
    let doubtful = most.filter(|_| doubtful).cloned();
    let stated_for = |station: &StationFit| stated_transform.filter(|t| fits(cell, t, &station.pairs, station.rms));
    let first = all.iter().position(|station| stated_for(station).is_some());
    let first = first.unwrap_or(0);
    let reference = &all[first];
    let base = *stated_for(reference).unwrap_or(&reference.base_from_tracker);
    let axes = all.iter().enumerate().map(|(at, station)| {
        if at == first || stated_for(station).is_some() {
            return Isometry3::identity();
        }
        tied(cell, station, reference, &base).unwrap_or(base.inverse() * station.base_from_tracker)
    });
    let axes: BTreeMap<String, Isometry3<f64>> = names.into_iter().zip(axes).collect();
    drop(series);
    for (name, error) in failed {
        let is_own = |p: &PostureReadings| p.station.as_ref() == Some(&name);
        let left_out = table.postures.iter().filter(|p| is_own(p));
        let left_out: Vec<&str> = left_out.map(|p| p.posture.name.as_str()).collect();
        let sentence =
            format!("Station {name}: {} Left out until more is read from there: {}.", error.message(), list(&left_out));
        let remark = Finding::caution("station-left-out", left_out.join(", "), sentence);
        table.postures.retain(|p| !is_own(p));
        table.remarks.push(remark);
    }
    for posture in &mut table.postures {
        let axes = posture.station.as_ref().and_then(|name| axes.get(name));
        let Some(axes) = axes.filter(|axes| **axes != Isometry3::identity()) else {
            continue;
        };
        posture.axes = *axes;
        for reading in posture.states.iter_mut().flat_map(|s| &mut s.readings) {
            reading.position = (axes * Point3::from(reading.position)).coords;
        }
    }
    Ok(doubtful)
}

fn alone(cell: &Cell, series: &[PostureSeries<'_>]) -> Result<StationFit> {
    let (base_from_tracker, pairs) = by_themselves(cell, series)?;
    let mut seen: BTreeMap<String, Vec<Vector3<f64>>> = BTreeMap::new();
    for (name, reflector) in series.iter().flat_map(|posture| &posture.base) {
        let unloaded = reflector.states.iter().filter(|s| s.role != Role::Loaded);
        let positions = unloaded.map(|s| s.position);
        seen.entry(name.clone()).or_default().extend(positions);
    }
    let mean = |all: Vec<Vector3<f64>>| all.iter().sum::<Vector3<f64>>() / all.len() as f64;
    seen.retain(|_, all| !all.is_empty());
    Ok(StationFit {
        rms: rms(&base_from_tracker, &pairs),
        base_from_tracker,
        pairs,
        base: seen.into_iter().map(|(name, all)| (name, mean(all))).collect(),
    })
}

/// What turns a station's axes into those of `reference`, by the base reflectors that both read; `None` where these are
/// too few, or were moved in between.
fn tied(
    cell: &Cell,
    station: &StationFit,
    reference: &StationFit,
    base_from_reference: &Isometry3<f64>,
) -> Option<Isometry3<f64>> {
    let both = station.base.iter();
    let both = both.filter_map(|(name, at)| Some((*at, *reference.base.get(name)?)));
    let both: Vec<Pair> = both.collect();
    let there: Vec<Vector3<f64>> = both.iter().map(|(_, there)| *there).collect();
    if both.len() < REFLECTORS || !is_spread(&there) {
        return None;
    }
    let tied = rigid_transform(both.iter().copied())?;
    let to_base = base_from_reference * tied;
    let agrees = fits(cell, &tied, &both, 0.0) && fits(cell, &to_base, &station.pairs, station.rms.max(reference.rms));
    agrees.then_some(tied)
}

/// Each station as it was used; none where there is but one.
pub(super) fn describe(
    table: &ReadingTable,
    base_from_tracker: &Isometry3<f64>,
    registration: Option<&UnloadedRegistration>,
) -> Vec<StationRegistration> {
    let names = table.stations();
    if names.len() < 2 {
        return Vec::new();
    }
    let one = |name: &str| {
        let of_station = table.postures.iter();
        let of_station = of_station.filter(|p| p.station.as_deref() == Some(name));
        let axes = of_station.clone().next().map(|p| p.axes).unwrap_or_default();
        let has_reflectors = of_station.clone().any(|p| base_reflectors(p) >= REFLECTORS);
        let postures: Vec<String> = of_station.map(|p| p.posture.name.clone()).collect();
        let residuals = registration.iter().flat_map(|r| &r.postures);
        let residuals = residuals.filter(|r| r.used && postures.contains(&r.posture));
        let points = residuals.flat_map(|r| &r.points);
        let squares = points.map(|p| Vector3::from(p.residual_m).norm_squared());
        let squares: Vec<f64> = squares.collect();
        let mean = squares.iter().sum::<f64>() / squares.len().max(1) as f64;
        let frame = base_from_tracker * axes;
        let rotation = frame.rotation.to_rotation_matrix();
        StationRegistration {
            angles_unchecked: postures.len() == 1 && !has_reflectors,
            station: name.to_string(),
            postures,
            rotation: std::array::from_fn(|i| std::array::from_fn(|j| rotation[(i, j)])),
            translation_m: frame.translation.vector.into(),
            rms_m: (!squares.is_empty()).then(|| mean.sqrt()),
        }
    };
    names.into_iter().map(one).collect()
}

/// Reflectors on the base that a posture's readings have.
fn base_reflectors(posture: &PostureReadings) -> usize {
    let readings = posture.states.iter().flat_map(|s| &s.readings);
    let base = readings.filter(|r| matches!(r.target, ReadingTarget::Base(_)));
    base.map(|r| &r.target).collect::<BTreeSet<_>>().len()
}

/// Says from which stations the readings come, and how well each fits the model.
pub(super) fn finding(stations: &[StationRegistration]) -> Option<Finding> {
    let each: Vec<String> = stations
        .iter()
        .map(|station| {
            let postures = match station.postures.len() {
                1 => "1 posture".to_string(),
                count => format!("{count} postures"),
            };
            let fit = station.rms_m.map(|rms| format!(", {} RMS", length(rms)));
            format!("{} ({postures}{})", station.station, fit.unwrap_or_default())
        })
        .collect();
    let unchecked = stations.iter().filter(|station| station.angles_unchecked);
    let unchecked: Vec<String> = unchecked.flat_map(|station| station.postures.clone()).collect();
    let unchecked = match unchecked.len() {
        0 => String::new(),
        1 => format!(" Nothing checks the angles of posture {}, the only one of its station.", unchecked[0]),
        _ => format!(" Nothing checks the angles of postures {}, each the only one of its station.", list(&unchecked)),
    };
    let sentence = format!(
        "The tracker read from {} stations, each registered by itself: {}. The RMS is the distance of the unloaded \
         points from the kinematic model.{unchecked}",
        stations.len(),
        list(&each)
    );
    (!stations.is_empty()).then(|| Finding::note("stations", "readings", sentence))
}
