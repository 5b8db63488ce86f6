//! `[route]`: how the robot drives from posture to posture; `[time]`: what measuring takes.

use super::raw::{RawRoute, RawTime};
use super::robot::angles;
use super::source::Source;
use super::value::{Minutes, Number, Spanned};
use stiffarm::error::{Code, Result};
use stiffarm::model::cell::MeasuringTime;
use stiffarm::model::robot::{CatalogueEntry, Robot};
use stiffarm::model::route::RouteRules;
use stiffarm::units::deg_to_rad;

/// Largest joint speed that is not a slip \[deg/s\].
const FASTEST_DEG_S: f64 = 2000.0;
/// Turns beyond a posture from which it is reached that are no slip \[deg\].
const APPROACH_DEG: std::ops::RangeInclusive<f64> = 0.05..=10.0;

/// What the cell says of the drive; joint speeds are the catalogue's unless it gives others.
pub(super) fn route(
    source: &Source<'_>,
    table: Option<&Spanned<RawRoute>>,
    robot: &Robot,
    entry: Option<&CatalogueEntry>,
) -> Result<RouteRules> {
    let mut rules = RouteRules::default();
    let catalogue_speeds = entry.map_or(&[][..], |entry| entry.speeds_deg_s);
    if catalogue_speeds.len() == robot.joint_count() {
        rules.joint_speeds = Some(catalogue_speeds.iter().map(|v| deg_to_rad(*v)).collect());
    }
    let Some(raw) = table.map(Spanned::get) else {
        return Ok(rules);
    };
    if let Some(list) = &raw.joint_speeds_deg_s {
        let speeds = source.positives(list, robot.joint_count(), "one per joint")?;
        let mut speeds_deg_s = list.get().iter().map(Number::get);
        if let Some(fast) = speeds_deg_s.find(|v| *v > FASTEST_DEG_S) {
            let message = format!("No joint turns at {fast}°/s.");
            let error = source.error(Code::InvalidValue, list, message);
            return Err(
                error.hint("give the largest speed of each joint in degrees per second, as the data sheet has it")
            );
        }
        rules.joint_speeds = Some(speeds);
    }
    if let Some(value) = &raw.speed_percent {
        rules.speed_share = source.positive(value)?;
        let percent = value.get();
        if percent > 100.0 {
            let message = format!("{percent} % is faster than the joints turn.");
            let error = source.error(Code::InvalidValue, value, message);
            return Err(error.hint("give a share of the largest joint speeds, 100 at most"));
        }
    }
    rules.start = source.optional(&raw.start_deg, |source, list| angles(source, list, robot))?;
    if let Some(value) = &raw.approach_deg {
        let turn = source.positive(value)?;
        let degrees = value.get();
        let fault = |message: String, hint: &str| Err(source.error(Code::InvalidValue, value, message).hint(hint));
        if !APPROACH_DEG.contains(&degrees) {
            let message = format!("A turn of {degrees}° does not take up lost motion.");
            let hint = "give 0.05 to 10; half a degree is far more than the lost motion of a worn joint";
            return fault(message, hint);
        }
        if rules.start.is_none() {
            let message = "Nothing says how the first posture is reached.".to_string();
            return fault(message, "give start_deg, a safe posture that the robot starts from");
        }
        rules.approach = Some(turn);
    }
    if let Some(text) = &raw.load {
        let hint = "load = \"off\" where it is taken off before each move, or \"on\" where it stays on";
        rules.load_stays_on = source.choice(text, &[("off", false), ("on", true)], hint)?;
    }
    Ok(rules)
}

/// Longest part of an experiment that is no slip of the unit \[min\].
const LONGEST_MIN: f64 = 480.0;

/// What measuring takes, where the cell says it.
pub(super) fn time(source: &Source<'_>, table: &Spanned<RawTime>) -> Result<MeasuringTime> {
    let (raw, assumed) = (table.get(), MeasuringTime::default());
    let posture = source.optional(&raw.posture_min, |source, value| {
        source.positive(value)?;
        minutes(source, value)
    })?;
    // A further load that hangs there already may take none.
    let further_load = source.optional(&raw.further_load_min, minutes)?;
    let further_anchor = source.optional(&raw.further_anchor_min, minutes)?;
    Ok(MeasuringTime {
        posture: posture.unwrap_or(assumed.posture),
        further_load: further_load.unwrap_or(assumed.further_load),
        further_anchor: further_anchor.unwrap_or(assumed.further_anchor),
    })
}

fn minutes(source: &Source<'_>, value: &Number<Minutes>) -> Result<f64> {
    if value.get() > LONGEST_MIN {
        let message = format!("{} minutes are longer than a day beside the robot.", value.get());
        let error = source.error(Code::InvalidValue, value, message);
        return Err(error.hint("give minutes, not seconds"));
    }
    source.not_negative(value)
}
