//! A plan: from a global search, from an initial group, or beside given postures.

use super::bounds::Bounds;
use super::driven::driven;
use super::in_time::in_time;
use super::kinds::{Mode, Planned, SelectResultOptions, Stage};
use super::options::{SelectInputs, SelectOptions};
use super::result::Plan;
use crate::error::Result;
use crate::estimate::forecast::add_forecast;
use crate::model::cell::Cell;
use crate::model::posture::Posture;
use crate::numerics::control::Control;
use crate::plan::check::{FurtherLoad, prepared};
use crate::plan::evaluated::EvaluatedGroup;
use crate::plan::feasibility::on_limits;
use crate::plan::index::{GroupEvaluation, Index};
use crate::plan::route::{RouteOptions, route_findings};
use crate::plan::select::{
    LocalOptions, Selection, Sensitivity, SensitivityOptions, limit_prices, select_from, select_watched, sensitivity,
};
use crate::units::min_to_s;
use std::collections::HashSet;

/// Selects, bounds and examines a plan; `watch` is told what the work is at, and a stop of `control` ends it with
/// the best so far.
///
/// ```
/// # fn main() -> stiffarm::Result<()> {
/// use stiffarm::Control;
/// use stiffarm::ask::select::{SelectInputs, SelectOptions, plan};
/// use stiffarm_files::builtin;
///
/// let cell = builtin::cell("comau")?;
/// let mut options = SelectOptions::default();
/// options.count = Some(3);
/// options.rounds = Some(1); // more find better plans
/// options.no_certificate = true;
/// let inputs = SelectInputs::default();
/// let planned = plan(&cell, &inputs, &options, &mut |_| {}, Control::default())?;
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
    inputs: &SelectInputs,
    options: &SelectOptions,
    watch: &mut dyn FnMut(Stage),
    control: Control<'_>,
) -> Result<Planned<Plan>> {
    options.check(inputs)?;
    let (index, global) = (options.index(), options.global(inputs));
    // A load that may move can reach what the cell's own does not.
    let moves = global.load.anchor.is_some() || global.load.loading_point.is_some();
    let (cell, mut findings) = prepared(cell, !moves);
    let (cell, count, in_time) = match options.minutes {
        Some(minutes) => in_time(cell, index, min_to_s(minutes), &global, control)?,
        None => (cell, options.postures(inputs), Vec::new()),
    };
    let initial = inputs.initial.as_deref();
    let held = inputs.given.as_slice();
    let selection = match initial {
        Some(group) => {
            let local = LocalOptions { max_iterations: options.max_iterations(), ..LocalOptions::default() };
            select_from(&cell, index, group, local, control)?
        }
        None => {
            select_watched(&cell, index, count, &global, control.quiet(), &mut |round| watch(Stage::Round(*round)))?
        }
    };
    let cell = match &selection.load {
        Some(chosen) => chosen.applied(&cell),
        None => cell,
    };
    let keep = initial.is_some();
    let accept = inputs.accept.as_ref();
    let driving = RouteOptions {
        keep_order: keep,
        keep_angles: keep || accept.is_some(),
        keep_wrist: index == Index::Prediction,
        step_deg: options.angle_step(),
        seed: options.seed(),
    };
    let (group, route) = driven(&cell, &selection.group, &driving, accept, control)?;
    let selection = selection.with_group(&cell, held, group)?;
    let postures = named(&selection, initial, held);
    let bounds = if !options.no_certificate && initial.is_none() {
        Bounds::new(&cell, index, held, &postures, watch, control)
    } else {
        Bounds::default()
    };
    let sensitivity = examined(&cell, options, &postures, control)?;
    let prices = if options.prices && !control.stopped() {
        let prices = limit_prices(&cell, index, count, &global, selection.value, control.quiet())?;
        (!control.stopped()).then_some(prices)
    } else {
        None
    };

    let (before_group, before_name) = match initial {
        Some(initial) => (initial, "initial"),
        None => (held, "given"),
    };
    let before = if before_group.is_empty() {
        None
    } else {
        let mut before = EvaluatedGroup::new(&cell, before_name, before_group)?;
        add_forecast(&cell, before_group, &mut before.evaluation);
        Some(before)
    };
    let after_name = if held.is_empty() { "selected" } else { "with new" };
    let mut evaluation = GroupEvaluation { name: after_name.to_string(), ..selection.evaluation.clone() };
    // An initial group makes way for the plan, given postures stay.
    let stay: Vec<Posture> = held.iter().chain(&postures).cloned().collect();
    add_forecast(&cell, &stay, &mut evaluation);
    let names = |postures: &[Posture]| postures.iter().map(|p| p.name.clone()).collect();
    let same = |stops: &Vec<usize>| stops.iter().map(|p| postures[*p].name.clone()).collect();
    findings.extend(cell.posture_findings(before_group));
    findings.extend(route_findings(&cell, &postures, &route)?);
    findings.extend(on_limits(&cell, &postures, &selection.limits));
    let result = Plan {
        posture_names: names(&postures),
        repeats: route.repeats.iter().map(same).collect(),
        given_names: names(held),
        given_value: if held.is_empty() { None } else { before.as_ref().and_then(|b| b.evaluation.indices.get(index)) },
        joints: cell.setup.robot.spring_names(),
        evaluation,
        before,
        time_s: cell.time.of(postures.len(), &cell.setup.load),
        in_time,
        further_load: FurtherLoad::new(&cell, &stay),
        certificate: bounds.certificate,
        joint_efficiencies: bounds.joints,
        certificate_missing: bounds.missing,
        sensitivity,
        prices,
        selection,
        findings,
        route,
    };
    let mode = match (initial.is_some(), held.is_empty()) {
        (true, _) => Mode::From,
        (false, true) => Mode::Global,
        (false, false) => Mode::Add,
    };
    Ok(Planned {
        options: SelectResultOptions::new(mode, options, &cell),
        seed: (initial.is_none() || options.sensitivity).then(|| options.seed()),
        result,
        cell,
        postures,
    })
}

/// Whether wrong assumptions would change the plan; `None` unless asked for, and when stopped on the way.
fn examined(
    cell: &Cell,
    options: &SelectOptions,
    selected: &[Posture],
    control: Control<'_>,
) -> Result<Option<Sensitivity>> {
    if !options.sensitivity || control.stopped() {
        return Ok(None);
    }
    let mut search =
        SensitivityOptions { seed: options.seed(), repeats: options.repeats, ..SensitivityOptions::default() };
    // Who wants a quick plan wants a quick answer here too.
    search.rounds = options.rounds.map_or(search.rounds, |rounds| rounds.min(search.rounds));
    let sensitivity = sensitivity(cell, options.index(), selected, &search, control)?;
    Ok((!control.stopped()).then_some(sensitivity))
}

/// The selected postures: under the names of the initial ones, else numbered on
/// from the given ones without meeting any of their names.
fn named(selection: &Selection, initial: Option<&[Posture]>, held: &[Posture]) -> Vec<Posture> {
    let mut postures = selection.to_group("selected").postures;
    if let Some(initial) = initial {
        for (posture, old) in postures.iter_mut().zip(initial) {
            posture.name.clone_from(&old.name);
        }
        return postures;
    }
    let taken: HashSet<&str> = held.iter().map(|p| p.name.as_str()).collect();
    let free = (held.len() + 1..).map(|number| number.to_string()).filter(|name| !taken.contains(name.as_str()));
    for (posture, name) in postures.iter_mut().zip(free) {
        posture.name = name;
    }
    postures
}
