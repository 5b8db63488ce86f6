//! A plan: from a global search, from an initial group, or beside given postures.

use super::bounds::Bounds;
use super::driven::driven;
use super::in_time::in_time;
use super::kinds::{Mode, Planned, Stage};
use super::request::PlanRequest;
use super::result::{LoadOptions, Plan, PlanOptions};
use crate::error::Result;
use crate::model::cell::Cell;
use crate::model::posture::Posture;
use crate::numerics::control::Control;
use crate::plan::check::{FurtherLoad, prepared};
use crate::plan::evaluated::EvaluatedGroup;
use crate::plan::feasibility::on_limits;
use crate::plan::index::{GroupEvaluation, Index};
use crate::plan::route::{RouteOptions, route_findings};
use crate::plan::select::{
    GlobalOptions, LimitPrice, LocalOptions, Selection, Sensitivity, SensitivityOptions,
    limit_prices, select_from, select_watched, sensitivity,
};
use std::collections::HashSet;

/// Selects, bounds and examines a plan; `watch` is told what the work is at, and a stop of `control` ends it with
/// the best so far.
///
/// ```
/// # fn main() -> stiffarm::Result<()> {
/// use stiffarm::plan::planned::{PlanRequest, plan};
/// use stiffarm::Control;
/// use stiffarm_files::builtin;
///
/// let cell = builtin::cell("comau")?;
/// let mut request = PlanRequest::default();
/// request.postures = 3;
/// request.rounds = Some(1); // more find better plans
/// request.certificate = false;
/// let planned = plan(&cell, &request, &mut |_| {}, Control::default())?;
/// assert_eq!(planned.result.posture_names, ["1", "2", "3"]);
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// A request whose parts exclude each other; as [`select`](crate::plan::select::select), or from an initial group
/// as [`select_from`]; a step of the angles that is not above zero; stopped before there was a plan.
pub fn plan(
    cell: &Cell,
    request: &PlanRequest,
    watch: &mut dyn FnMut(Stage),
    control: Control<'_>,
) -> Result<Planned<Plan, PlanOptions>> {
    request.check()?;
    // A load that may move can reach what the cell's own does not.
    let moves = request.load.anchor.is_some() || request.load.loading_point.is_some();
    let (cell, mut findings) = prepared(cell, !moves);
    let global = global_options(request);
    let (cell, postures, in_time) = match request.measuring_time {
        Some(time) => in_time(cell, request.index, time, &global, control)?,
        None => (cell, request.postures, Vec::new()),
    };
    let request = &PlanRequest {
        postures,
        ..request.clone()
    };
    let initial = request.initial.as_deref();
    let given = request.given.as_slice();
    let selection = selected(&cell, request, &global, watch, control)?;
    let cell = match &selection.load {
        Some(chosen) => chosen.applied(&cell),
        None => cell,
    };
    // A search that was stopped keeps its order.
    let keep = initial.is_some() || control.stopped();
    let accept = request.accept.as_ref();
    let driving = RouteOptions {
        keep_order: keep,
        keep_angles: keep || accept.is_some(),
        keep_wrist: request.index == Index::Prediction,
        step_deg: request.angle_step_deg,
        seed: request.seed,
    };
    let (group, route) = driven(&cell, &selection.group, &driving, accept)?;
    let selection = selection.with_group(&cell, given, group)?;
    let postures = named(&selection, initial, given);
    let bounds = if request.certificate && initial.is_none() {
        Bounds::new(&cell, request.index, given, &postures, watch, control)
    } else {
        Bounds::default()
    };
    let sensitivity = examined(&cell, request, &postures, control)?;
    let prices = priced(&cell, request, &global, selection.value, control)?;

    let (known, before_name) = match initial {
        Some(initial) => (initial, "initial"),
        None => (given, "given"),
    };
    let before = if known.is_empty() {
        None
    } else {
        Some(EvaluatedGroup::new(&cell, before_name, known)?)
    };
    let after_name = if given.is_empty() {
        "selected"
    } else {
        "with new"
    };
    let names = |postures: &[Posture]| postures.iter().map(|p| p.name.clone()).collect();
    let same = |stops: &Vec<usize>| stops.iter().map(|p| postures[*p].name.clone()).collect();
    let all: Vec<&[f64]> = given.iter().chain(&postures).map(AsRef::as_ref).collect();
    findings.extend(cell.posture_findings(known));
    findings.extend(route_findings(&cell, &postures, &route)?);
    findings.extend(on_limits(&cell, &postures, &selection.limits));
    let result = Plan {
        posture_names: names(&postures),
        repeats: route.repeats.iter().map(same).collect(),
        given_names: names(given),
        given_value: if given.is_empty() {
            None
        } else {
            before
                .as_ref()
                .and_then(|b| b.evaluation.indices.get(request.index))
        },
        joints: cell.setup.robot.spring_names(),
        evaluation: GroupEvaluation {
            name: after_name.to_string(),
            ..selection.evaluation.clone()
        },
        before,
        time_s: cell.time.of(postures.len(), &cell.setup.load),
        in_time,
        further_load: FurtherLoad::new(&cell, &all),
        certificate: bounds.certificate,
        joint_efficiencies: bounds.joints,
        certificate_missing: bounds.missing,
        sensitivity,
        prices,
        selection,
        findings,
        route,
    };
    Ok(Planned {
        options: options(&cell, request, postures.len()),
        seed: (initial.is_none() || request.sensitivity).then_some(request.seed),
        result,
        cell,
        postures,
    })
}

/// The request as options of the global search.
fn global_options(request: &PlanRequest) -> GlobalOptions {
    GlobalOptions {
        seed: request.seed,
        rounds: request.rounds,
        time_limit: request.time_limit,
        load: request.load.clone(),
        accept: request.accept.clone(),
        repeats: request.repeats,
        given: request.given.iter().map(|p| p.q.clone()).collect(),
        ..GlobalOptions::default()
    }
}

/// The search itself.
fn selected(
    cell: &Cell,
    request: &PlanRequest,
    global: &GlobalOptions,
    watch: &mut dyn FnMut(Stage),
    control: Control<'_>,
) -> Result<Selection> {
    let (index, count) = (request.index, request.postures);
    match &request.initial {
        Some(group) => {
            let options = LocalOptions {
                max_iterations: request.max_iterations,
                ..LocalOptions::default()
            };
            select_from(cell, index, group, options, control)
        }
        None => select_watched(cell, index, count, global, control.quiet(), &mut |round| {
            watch(Stage::Round(*round))
        }),
    }
}

/// Whether wrong assumptions would change the plan; `None` unless asked for, and when stopped on the way.
fn examined(
    cell: &Cell,
    request: &PlanRequest,
    selected: &[Posture],
    control: Control<'_>,
) -> Result<Option<Sensitivity>> {
    if !request.sensitivity || control.stopped() {
        return Ok(None);
    }
    let mut options = SensitivityOptions {
        seed: request.seed,
        repeats: request.repeats,
        ..SensitivityOptions::default()
    };
    // Who wants a quick plan wants a quick answer here too.
    if let Some(rounds) = request.rounds {
        options.rounds = options.rounds.min(rounds);
    }
    let found = sensitivity(cell, request.index, selected, &options, control)?;
    Ok((!control.stopped()).then_some(found))
}

/// What each kind of limit costs; `None` unless asked for, and when stopped on the way.
fn priced(
    cell: &Cell,
    request: &PlanRequest,
    global: &GlobalOptions,
    value: f64,
    control: Control<'_>,
) -> Result<Option<Vec<LimitPrice>>> {
    if !request.prices || control.stopped() {
        return Ok(None);
    }
    let (index, count) = (request.index, request.postures);
    let found = limit_prices(cell, index, count, global, value, control.quiet())?;
    Ok((!control.stopped()).then_some(found))
}

/// The selected postures: under the names of the initial ones, else numbered on
/// from the given ones without meeting any of their names.
fn named(selection: &Selection, initial: Option<&[Posture]>, given: &[Posture]) -> Vec<Posture> {
    let mut postures = selection.to_group("selected").postures;
    if let Some(initial) = initial {
        for (posture, old) in postures.iter_mut().zip(initial) {
            posture.name.clone_from(&old.name);
        }
        return postures;
    }
    let taken: HashSet<&str> = given.iter().map(|p| p.name.as_str()).collect();
    let free = (given.len() + 1..)
        .map(|number| number.to_string())
        .filter(|name| !taken.contains(name.as_str()));
    for (posture, name) in postures.iter_mut().zip(free) {
        posture.name = name;
    }
    postures
}

/// What the result says of the request.
fn options(cell: &Cell, request: &PlanRequest, postures: usize) -> PlanOptions {
    let is_local = request.initial.is_some();
    PlanOptions {
        mode: match (is_local, request.given.is_empty()) {
            (true, _) => Mode::From,
            (false, true) => Mode::Global,
            (false, false) => Mode::Add,
        },
        postures,
        measuring_time_s: request.measuring_time.map(|time| time.as_secs_f64()),
        repeats: request.repeats,
        max_iterations: is_local.then_some(request.max_iterations),
        rounds: request.rounds,
        time_limit_s: request.time_limit.map(|limit| limit.as_secs_f64()),
        angle_step_deg: request.angle_step_deg,
        load: LoadOptions::of(&request.load),
        certificate: !is_local && request.certificate,
        sensitivity: request.sensitivity,
        prices: request.prices,
        characteristic_length_m: cell.characteristic_length,
    }
}
