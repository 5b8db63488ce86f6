//! From raw readings to displacements with all that an identification needs
//! beside them: registration, base motion, drift, references, repeatability,
//! servo give and wrenches.
//!
//! Positions are the tracker's until the last step, which turns differences into
//! base axes. In this order, each step on what the one before left:
//! 1. readings of one reflector in one state are averaged, and what they scatter
//!    is pooled ([`Repeatability`]);
//! 2. per reflector, the straight line through the readings without load removes
//!    the drift ([`Drift`]), base reflectors included;
//! 3. loaded minus reference of the base reflectors is the base's motion, taken
//!    back from the loaded points ([`BaseMotion`]);
//! 4. loaded minus reference, turned by the registration
//!    ([`UnloadedRegistration`]), is the displacement.
//!
//! Sums do not depend on the order of rows within a state; the order of states
//! matters only where readings have no times.

mod base_motion;
mod drift;
mod messages;
mod preload;
mod repeatability;
mod servo;
pub(in crate::measure) mod stations;
mod table;
mod temperature;
mod unloaded;
mod wrench;
mod wrench_check;

pub use super::series::Clock;
pub use base_motion::BaseMotion;
pub use drift::{Drift, PostureDrift};
pub use repeatability::Repeatability;
pub use stations::StationRegistration;
pub use temperature::Temperatures;
pub use unloaded::{UnloadedPointResidual, UnloadedPostureResidual, UnloadedRegistration};
pub use wrench_check::{ApplicationPoint, ForceDirection, WrenchCheck};

use super::series::PostureSeries;
use crate::error::{Code, Error, Result};
use crate::findings::{Finding, Severity};
use crate::model::cell::Cell;
use crate::model::load::LoadCase;
use crate::model::measurement::{Displacement, MeasuredPosture, ReadingTable, ReadingTarget, Role, StateReadings};
use crate::model::posture::Posture;
pub(in crate::measure) use base_motion::Motion;
use messages::postures_first;
use nalgebra::{Isometry3, Matrix3, Point3, Vector3};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// Expanded uncertainties of 95 % are this many standard ones (JCGM 100:2008, 6.3.3).
const COVERAGE: f64 = 2.0;
/// Standard uncertainty that a tracker's reading has at least: files give a micrometre as 0.001 \[m\].
const SMALLEST_STD: f64 = 0.5e-6;

/// Options of a reduction.
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
pub struct ReduceOptions {
    /// Base frame from tracker frame \[m\], before the cell's own; where neither
    /// gives it, the unloaded readings do.
    pub base_from_tracker: Option<Isometry3<f64>>,
}

/// Displacements from raw readings, and what was found on the way.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Reduction {
    /// The displacements, posture by posture and state by state; not part of the
    /// saved result.
    #[serde(skip)]
    pub measured: Vec<MeasuredPosture>,
    /// The same against no load where a posture has a preload, the way to it among them; nothing where none has. Not
    /// part of the saved result.
    #[serde(skip)]
    pub against_unloaded: Vec<MeasuredPosture>,
    /// Base frame from tracker frame \[m\], as used; saved as the rotation and
    /// translation of `registration`.
    #[serde(skip)]
    pub base_from_tracker: Isometry3<f64>,
    /// How the unloaded readings fit the model; `None` for a given transform and
    /// no unloaded readings.
    pub registration: Option<UnloadedRegistration>,
    /// Each station by itself, where the readings come from several; `registration` is then that of the axes into
    /// which all were put.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub stations: Vec<StationRegistration>,
    /// Scatter of the repeats; `None` without repeats.
    pub repeatability: Option<Repeatability>,
    /// Largest motion of the base, posture by posture, where reflectors show it.
    pub base_motion: Vec<BaseMotion>,
    /// Drift within the postures; `None` without readings before and after a load.
    pub drift: Option<Drift>,
    /// How the temperature ran; `None` where it was not recorded.
    #[serde(default)]
    pub temperatures: Option<Temperatures>,
    /// Consistency of the measured wrenches; `None` where none were measured.
    pub wrench_check: Option<WrenchCheck>,
    /// What is worth knowing, the most serious first.
    pub findings: Vec<Finding>,
}

/// Reduces raw readings to displacements.
///
/// Differences are taken against the states named `preload…` where a posture has
/// them, else against `unloaded…`. A posture without such a state, or a point not
/// read in it, is left out and named in the findings.
///
/// # Errors
/// A table that is empty, contradicts itself or the cell, or has a number that
/// is not finite; no displacement at all; no transform given and too few unloaded
/// points for one; forces that are missing where others are given.
pub fn reduce(cell: &Cell, table: &ReadingTable, options: &ReduceOptions) -> Result<Reduction> {
    let mut table = table.clone().in_order_of_time();
    stations::in_one_frame(cell, &mut table, options.base_from_tracker.as_ref())?;
    reduce_series(cell, &table, &PostureSeries::all(&table), options)
}

/// [`reduce`] of readings that are sorted already.
pub(super) fn reduce_series(
    cell: &Cell,
    table: &ReadingTable,
    series: &[PostureSeries<'_>],
    options: &ReduceOptions,
) -> Result<Reduction> {
    let stated_transform = options.base_from_tracker.or(cell.tracker.base_from_tracker);
    table::check(cell, table, stated_transform.as_ref())?;
    let mut findings = Vec::new();

    let repeatability = repeatability::repeatability(series);
    if let Some(result) = &repeatability {
        findings.extend(repeatability::findings(cell, result)?);
    }
    let reading_std = repeatability::reading_std(cell, repeatability.as_ref());
    let (registration, base_from_tracker) =
        unloaded::registration(cell, series, stated_transform.as_ref(), reading_std, &mut findings)?;
    let stations = stations::describe(table, &base_from_tracker, registration.as_ref());
    findings.extend(stations::finding(&stations));
    let drift = drift::drift(series, &base_from_tracker, reading_std)?;
    findings.extend(drift::findings(series, drift.as_ref()));
    let temperatures = temperature::temperatures(series, drift.as_ref(), reading_std);
    findings.extend(temperatures.as_ref().map(|temperatures| temperature::finding(cell, temperatures)));

    let mut measured = Vec::new();
    let mut base_motion = Vec::new();
    let mut expected_forces = Vec::new();
    for posture in series {
        let first = measured.len();
        let motion = displacements(cell, table, posture, &base_from_tracker, reading_std, &mut measured)?;
        base_motion.extend(motion);
        expected_forces.extend(expected_force(cell, posture, &measured[first..]));
    }
    let mut against_unloaded = preload::against_unloaded(series, &measured, |posture, out| {
        displacements(cell, table, posture, &base_from_tracker, reading_std, out).map(|_| ())
    })?;
    incomplete(cell, series, &mut findings);
    if measured.is_empty() {
        return Err(Error::new(
            Code::TooFewData,
            "The readings give no displacement: no point was read both loaded and unloaded in one posture.",
        )
        .hint("state names: unloaded, preload, and any other name for a load; -2 and so on for another time"));
    }
    findings.extend(base_motion::findings(series, &base_motion, reading_std));
    servo::servo_deflection(cell, &mut measured, &mut findings);
    // What there is to say of them was said.
    servo::servo_deflection(cell, &mut against_unloaded, &mut Vec::new());
    findings.extend(wrench::findings(cell, table.wrench_columns, series));
    let wrench_check = wrench_check::wrench_check(cell, table.wrench_columns, &measured, &expected_forces);
    if let Some(check) = &wrench_check {
        findings.extend(wrench_check::findings(cell, check));
    }
    findings.sort_by_key(|f| std::cmp::Reverse(f.severity));
    Ok(Reduction {
        measured,
        against_unloaded,
        base_from_tracker,
        registration,
        stations,
        repeatability,
        base_motion,
        drift,
        temperatures,
        wrench_check,
        findings,
    })
}

/// Adds the displacements of all loaded states of one posture to `measured`;
/// returns the largest motion of the base.
fn displacements(
    cell: &Cell,
    table: &ReadingTable,
    posture: &PostureSeries<'_>,
    base_from_tracker: &Isometry3<f64>,
    reading_std: f64,
    measured: &mut Vec<MeasuredPosture>,
) -> Result<Option<BaseMotion>> {
    let rotation = base_from_tracker.rotation;
    let axes = &posture.readings.axes;
    let usable = base_motion::usable(posture);
    let mut largest: Option<BaseMotion> = None;
    for number in posture.loaded() {
        let state = &posture.readings.states[number];
        let motion = Motion::new(posture, &usable, number)?;
        let mut displacements = Vec::new();
        let mut loaded = Vec::new();
        let mut gives = Vec::new();
        for (index, series) in &posture.points {
            let Some(pair) = series.pair(number, posture.reference) else {
                continue;
            };
            loaded.push(pair.loaded);
            let without_motion = match &motion {
                Some(motion) => motion.removed(&pair.loaded),
                None => pair.loaded,
            };
            gives.push(servo::give(posture, number, &pair.parts));
            displacements.push(Displacement {
                point: *index,
                value: rotation * (without_motion - pair.reference),
                time: (posture.clock == Clock::Time).then_some(posture.start + pair.clock),
                readings: pair.readings,
                reference: pair.parts,
                covariance: covariance(
                    cell,
                    &(base_from_tracker * axes),
                    &(axes.inverse() * Point3::from(pair.loaded)).coords,
                    stated(state, *index),
                )?,
            });
        }
        if displacements.is_empty() {
            continue;
        }
        let common_readings = motion.as_ref().map_or([0.0; 2], |m| m.common(&loaded));
        if let Some(motion) = motion {
            let now = motion.describe(posture.name(), &state.state, &loaded, base_from_tracker, reading_std);
            let more = |l: &BaseMotion| now.largest_correction_m > l.largest_correction_m;
            if largest.as_ref().is_none_or(more) {
                largest = Some(now);
            }
        }
        let wrench = wrench::wrench(cell, table.wrench_columns, posture, number)?;
        measured.push(MeasuredPosture {
            posture: Posture { name: posture.name().to_string(), q: posture.q.clone() },
            state: state.state.clone(),
            wrench,
            preload: preload::preload(cell, table.wrench_columns, posture, number, wrench)?,
            common_readings,
            servo_deflection: servo::one_give(cell, &posture.q, &gives, &mut displacements)?,
            displacements,
        });
    }
    Ok(largest)
}

/// Mean variances of the readings of a point in a state as the tracker states them, its axes; `None` where one of them
/// has none.
fn stated(state: &StateReadings, point: usize) -> Option<Vector3<f64>> {
    let of_point = state.readings.iter();
    let of_point = of_point.filter(|reading| reading.target == ReadingTarget::Point(point));
    let variance = |std: f64| (std / COVERAGE).max(SMALLEST_STD).powi(2);
    let each = of_point.map(|reading| reading.expanded.map(|expanded| expanded.map(variance)));
    let each: Vec<Vector3<f64>> = each.collect::<Option<_>>()?;
    (!each.is_empty()).then(|| each.iter().sum::<Vector3<f64>>() / each.len() as f64)
}

/// Covariance of one reading at the tracker position `at`, base axes: by the variances that the tracker stated, else
/// by its accuracy.
fn covariance(
    cell: &Cell,
    base_from_tracker: &Isometry3<f64>,
    at: &Vector3<f64>,
    stated: Option<Vector3<f64>>,
) -> Result<Option<Matrix3<f64>>> {
    let tracker_covariance = match (stated, &cell.tracker.accuracy) {
        (Some(variances), _) => Matrix3::from_diagonal(&variances),
        (None, Some(accuracy)) => accuracy.covariance(at)?,
        (None, None) => return Ok(None),
    };
    let rotation = base_from_tracker.rotation.to_rotation_matrix();
    let rotation = rotation.matrix();
    let turned = rotation * tracker_covariance * rotation.transpose();
    // Symmetric to the last bit.
    Ok(Some((turned + turned.transpose()) * 0.5))
}

/// Size of the force that the cell's rope, cylinder or weight has in each loaded state of a posture,
/// loaded minus reference, where known \[N\].
fn expected_force(cell: &Cell, posture: &PostureSeries<'_>, measured: &[MeasuredPosture]) -> Vec<Option<f64>> {
    let load = &cell.setup.load;
    let several = load.has_cases();
    let full_of = |m: &MeasuredPosture| load.each().nth(load.case_of(&m.state).ok()?)?.size();
    let states = &posture.readings.states;
    let unloaded = posture.reference == Role::Unloaded;
    let reference = posture.states(posture.reference).find_map(|i| states[i].load);
    let reference = reference.or(unloaded.then_some(0.0));
    let force = |m: &MeasuredPosture| m.wrench.map_or(0.0, |w| w.force.norm());
    let strongest = measured.iter().map(force).fold(0.0, f64::max);
    let expected = |m: &MeasuredPosture| {
        let full = full_of(m)?;
        let load = states.iter().find(|s| s.state == m.state).and_then(|s| s.load);
        let is_full = several || force(m) == strongest;
        match load.zip(reference) {
            Some((load, reference)) => Some(load - reference),
            // Without the table's word only the full load is known.
            None => (load.is_none() && unloaded && is_full).then_some(full),
        }
    };
    measured.iter().map(expected).collect()
}

/// Postures and points that gave nothing.
fn incomplete(cell: &Cell, series: &[PostureSeries<'_>], findings: &mut Vec<Finding>) {
    let (mut no_load, mut no_reference) = (Vec::new(), Vec::new());
    for posture in series {
        if posture.states(Role::Loaded).next().is_none() {
            no_load.push(posture.name());
            continue;
        }
        if posture.states(posture.reference).next().is_none() {
            no_reference.push(posture.name());
            continue;
        }
        let taken = |case: &&LoadCase| {
            let mut states = posture.states(Role::Loaded);
            !states.any(|i| case.is_of(&posture.readings.states[i].state))
        };
        let missing = cell.setup.load.cases().iter().filter(taken);
        let missing: Vec<&str> = missing.map(|case| case.name.as_str()).collect();
        if !missing.is_empty() {
            findings.push(Finding::caution(
                "load-case-not-measured",
                posture.name(),
                format!(
                    "Posture {}: not measured under {}, which the plan counted.",
                    posture.name(),
                    crate::findings::list(&missing)
                ),
            ));
        }
        let lost: BTreeSet<&str> = posture
            .points
            .iter()
            .filter(|(_, s)| s.states.iter().all(|state| state.role != posture.reference))
            .map(|(index, _)| cell.setup.tool.measuring_points[*index].name.as_str())
            .collect();
        if !lost.is_empty() {
            let names: Vec<&str> = lost.into_iter().collect();
            findings.push(Finding::caution(
                "point-without-reference",
                posture.name(),
                format!(
                    "Posture {}: point {} was read under load but not {}; it gives no displacement there.",
                    posture.name(),
                    crate::findings::list(&names),
                    match posture.reference {
                        Role::Preload => "under the preload",
                        _ => "unloaded",
                    }
                ),
            ));
        }
    }
    let mut add = |code, severity, names: &[&str], sentence: &str| {
        if !names.is_empty() {
            let sentence = format!("{}: {sentence}", postures_first(names));
            findings.push(Finding::new(code, severity, names.join(", "), sentence));
        }
    };
    add(
        "posture-without-reference",
        Severity::Caution,
        &no_reference,
        "no unloaded and no preload reading, so no displacement. Left out.",
    );
    add("posture-without-load", Severity::Note, &no_load, "no loaded reading; used for the registration only.");
}
