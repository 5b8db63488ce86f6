//! Preloads: the wrench that the arm carries under one, and displacements against no load at all, the way to the
//! preload among them. Lost motion is in these and in nothing that was read after.

use super::wrench::wrench;
use crate::error::Result;
use crate::measure::series::PostureSeries;
use crate::model::cell::Cell;
use crate::model::instruments::Mount;
use crate::model::load::Wrench;
use crate::model::measurement::{MeasuredPosture, Role, WrenchColumns};

/// Wrench on the robot under the preload against which the loaded state `number` counts, whose own against it is
/// `difference`; `None` where the reference is unloaded.
///
/// A sensor on the flange that was not read unloaded has the weight of the tool in its readings: then the preload is
/// taken to pull as the load does.
///
/// # Errors
/// As [`wrench`].
pub(super) fn preload(
    cell: &Cell,
    columns: WrenchColumns,
    posture: &PostureSeries<'_>,
    number: usize,
    difference: Option<Wrench>,
) -> Result<Option<Wrench>> {
    let clock = |state: usize| posture.state_clocks[state].unwrap_or_default();
    let away = |state: &usize| (clock(*state) - clock(number)).abs();
    let preloads = posture.states(Role::Preload);
    let nearest = preloads.min_by(|a, b| away(a).total_cmp(&away(b)));
    let Some(nearest) = nearest.filter(|_| posture.reference == Role::Preload) else {
        return Ok(None);
    };
    let on_flange = cell.sensor.as_ref().map(|s| s.mount) == Some(Mount::Flange);
    let states = &posture.readings.states;
    let is_weighed = |state: usize| states[state].wrench.is_some();
    if columns != WrenchColumns::None && on_flange && !posture.states(Role::Unloaded).any(is_weighed) {
        return Ok(difference);
    }
    wrench(cell, columns, &posture.against_unloaded(), nearest)
}

/// The displacements of `measured` with those of postures that have a preload taken against no load, where that was
/// read; `displacements` makes those of a posture. Nothing where there is no such posture.
///
/// # Errors
/// As `displacements`.
pub(super) fn against_unloaded<'a>(
    series: &[PostureSeries<'a>],
    measured: &[MeasuredPosture],
    displacements: impl Fn(&PostureSeries<'a>, &mut Vec<MeasuredPosture>) -> Result<()>,
) -> Result<Vec<MeasuredPosture>> {
    let both = |posture: &&PostureSeries<'_>| {
        posture.reference == Role::Preload && posture.states(Role::Unloaded).next().is_some()
    };
    let mut out = Vec::new();
    if !series.iter().any(|posture| both(&posture)) {
        return Ok(out);
    }
    for posture in series {
        if both(&posture) {
            displacements(&posture.against_unloaded(), &mut out)?;
        } else {
            let of_posture = measured.iter().filter(|m| m.posture.name == posture.name());
            out.extend(of_posture.cloned());
        }
    }
    Ok(out)
}
