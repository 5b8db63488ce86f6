//! The wrench of each load state, loaded minus reference.

use super::messages::postures_first;
use crate::error::{Code, Error, Result};
use crate::findings::Finding;
use crate::measure::series::PostureSeries;
use crate::model::cell::Cell;
use crate::model::instruments::Mount;
use crate::model::kinematics::Frames;
use crate::model::load::{Load, Wrench};
use crate::model::measurement::{Role, StateReadings, WrenchColumns};
use crate::model::observation::Setup;
use nalgebra::SVector;

/// Wrench on the robot at the loading point, base axes, in the loaded state
/// `number` against the reference; `None` lets the cell's load give it.
///
/// - With the cell's sensor: its readings are subtracted in its own axes, where
///   the tool's weight drops out, then turned and moved as
///   [`Sensor::wrench_on_robot`](crate::model::instruments::Sensor::wrench_on_robot).
/// - Without a sensor: the difference of the table's wrenches.
/// - Forces without moments: a pure force through the loading point.
/// - No forces: the force of the cell's rope, cylinder or weight in that state less that
///   in the reference, where the table has them.
///
/// Where states without load lie before and after, their straight line is
/// subtracted, as for the positions. A reference without force counts as zero
/// where it is unloaded.
///
/// # Errors
/// A loaded state or a preload without the force the other states have; a
/// measured load without any; a force per state in a cell whose load is neither rope, cylinder nor weight.
pub(super) fn wrench(
    cell: &Cell,
    columns: WrenchColumns,
    posture: &PostureSeries<'_>,
    number: usize,
) -> Result<Option<Wrench>> {
    let state = &posture.readings.states[number];
    let setup = &*cell.setup.of_state(&state.state)?;
    let several = cell.setup.load.has_cases();
    if several && posture.reference == Role::Preload {
        return Err(missing(
            posture,
            state,
            "a preload as reference, and the cell has several load cases",
            "take differences against unloaded readings, or put one load alone into [load]",
        ));
    }
    if columns == WrenchColumns::None {
        return by_load(setup, several, posture, state, number);
    }
    let Some(loaded) = &state.wrench else {
        return Err(missing(posture, state, "no force", "give its fx_n, fy_n, fz_n"));
    };
    let reference = reference(posture, number, "no force", |s| s.wrench.as_ref().map(to_vector))?;
    let difference = to_wrench(to_vector(loaded) - reference);
    let frames = Frames::new(&setup.robot, &posture.q);
    let at = frames.point(&setup.tool.loading_point);
    let mut wrench = match &cell.sensor {
        Some(sensor) => sensor.wrench_on_robot(&frames, &difference, &at),
        None => difference,
    };
    if columns == WrenchColumns::Force {
        wrench = Wrench::force(wrench.force);
    }
    Ok(Some(wrench))
}

/// By the cell's own load, scaled to the force the table gives.
fn by_load(
    setup: &Setup,
    several: bool,
    posture: &PostureSeries<'_>,
    state: &StateReadings,
    number: usize,
) -> Result<Option<Wrench>> {
    // Of several load cases some may have a force in the table and others none.
    let has_load =
        if several { state.load.is_some() } else { posture.readings.states.iter().any(|s| s.load.is_some()) };
    let mut unit = setup.load.clone();
    let full = match &mut unit {
        Load::Rope { magnitude, .. } | Load::Weight { magnitude, .. } => {
            // A table gives sizes: what pushes still pushes.
            let sign = 1.0_f64.copysign(*magnitude);
            std::mem::replace(magnitude, sign).abs()
        }
        Load::Constant { .. } if !has_load && posture.reference == Role::Unloaded => return Ok(None),
        Load::Measured if !has_load => {
            return Err(missing(
                posture,
                state,
                "no force, and the cell's load is measured",
                "give fx_n, fy_n, fz_n with each state",
            ));
        }
        Load::Constant { .. } | Load::Measured | Load::Cases(_) if has_load => {
            return Err(Error::new(
                Code::Conflict,
                "The table gives the force of a rope, cylinder or weight, but the cell's load has no such force.",
            )
            .key("load_n")
            .hint("set load.kind to \"rope\", \"cylinder\" (with anchor_mm) or \"weight\", or give fx_n, fy_n, fz_n"));
        }
        Load::Constant { .. } | Load::Measured | Load::Cases(_) => {
            return Err(missing(
                posture,
                state,
                "a preload as reference, whose wrench is not known",
                "give fx_n, fy_n, fz_n with each state",
            ));
        }
    };
    if !has_load && posture.reference == Role::Unloaded {
        return Ok(None);
    }
    let loaded = state.load.unwrap_or(full);
    let of_state = |s: &StateReadings| s.load.map(SVector::<f64, 1>::new);
    let reference = reference(posture, number, "no load_n", of_state)?[0];
    let frames = Frames::new(&setup.robot, &posture.q);
    let at = frames.point(&setup.tool.loading_point);
    Ok(unit
        .wrench(&frames, &at)
        .map(|one| Wrench { force: one.force * (loaded - reference), moment: one.moment * (loaded - reference) }))
}

/// Value of the reference states at the clock of the loaded state `number`.
fn reference<const N: usize>(
    posture: &PostureSeries<'_>,
    number: usize,
    lacks: &str,
    of: impl Fn(&StateReadings) -> Option<SVector<f64, N>>,
) -> Result<SVector<f64, N>> {
    let at = posture.state_clocks[number].unwrap_or_default();
    let mut samples = Vec::new();
    for i in posture.states(posture.reference) {
        let state = &posture.readings.states[i];
        match of(state) {
            Some(value) => samples.push((posture.state_clocks[i].unwrap_or_default(), value)),
            None if posture.reference == Role::Preload => {
                return Err(missing(
                    posture,
                    state,
                    &format!("{lacks}, and differences are taken against it"),
                    "give its force too",
                ));
            }
            None => {}
        }
    }
    Ok(line_at(&samples, at))
}

/// Value at `at` of the straight line through `samples` (clock, value) where
/// they lie on both sides, else the nearest one; zero without samples.
fn line_at<const N: usize>(samples: &[(f64, SVector<f64, N>)], at: f64) -> SVector<f64, N> {
    let nearest = samples.iter().min_by(|a, b| (a.0 - at).abs().total_cmp(&(b.0 - at).abs()));
    let Some(nearest) = nearest else {
        return SVector::zeros();
    };
    if !(samples.iter().any(|s| s.0 <= at) && samples.iter().any(|s| s.0 > at)) {
        return nearest.1;
    }
    let count = samples.len() as f64;
    let clock = samples.iter().map(|s| s.0).sum::<f64>() / count;
    let mean = samples.iter().map(|s| s.1).sum::<SVector<f64, N>>() / count;
    let spread: f64 = samples.iter().map(|s| (s.0 - clock).powi(2)).sum();
    let product: SVector<f64, N> = samples.iter().map(|s| (s.1 - mean) * (s.0 - clock)).sum();
    mean + product * ((at - clock) / spread)
}

fn to_vector(wrench: &Wrench) -> SVector<f64, 6> {
    let (f, m) = (wrench.force, wrench.moment);
    SVector::<f64, 6>::new(f.x, f.y, f.z, m.x, m.y, m.z)
}

fn to_wrench(v: SVector<f64, 6>) -> Wrench {
    Wrench { force: v.fixed_rows::<3>(0).into_owned(), moment: v.fixed_rows::<3>(3).into_owned() }
}

fn missing(posture: &PostureSeries<'_>, state: &StateReadings, lacks: &str, hint: &str) -> Error {
    let message = format!("Posture {}, state {} has {lacks}.", posture.name(), state.state);
    let error = Error::new(Code::MissingKey, message).hint(hint);
    match state.readings.first().map(|r| r.line) {
        Some(line) if line > 0 => error.line(line, None),
        _ => error,
    }
}

/// What the forces leave open.
pub(super) fn findings(cell: &Cell, columns: WrenchColumns, series: &[PostureSeries<'_>]) -> Vec<Finding> {
    let mut out = Vec::new();
    if columns == WrenchColumns::None {
        return out;
    }
    let on_flange = cell.sensor.as_ref().is_some_and(|s| s.mount == Mount::Flange);
    let without: Vec<&str> = series
        .iter()
        .filter(|p| p.reference == Role::Unloaded)
        .filter(|p| [Role::Unloaded, Role::Loaded].iter().all(|r| p.states(*r).next().is_some()))
        .filter(|p| p.states(Role::Unloaded).all(|i| p.readings.states[i].wrench.is_none()))
        .map(PostureSeries::name)
        .collect();
    if on_flange && !without.is_empty() {
        out.push(Finding::caution(
            "no-unloaded-force",
            "sensor",
            format!(
                "{}: the sensor on the flange has no unloaded reading, so the weight of the tool stays in the wrench \
                 unless the sensor was set to zero in that very posture.",
                postures_first(&without)
            ),
        ));
    }
    if columns == WrenchColumns::Force && cell.setup.load.has_moment() {
        out.push(Finding::serious(
            "moment-not-read",
            "load",
            "The cell's load has a moment, but the table has forces only: they are taken as pure forces through the \
             loading point. Add mx_nm, my_nm, mz_nm.",
        ));
    }
    out
}
