//! A plan: from a global search, from an initial group, or beside given postures.

use super::certificate::{self, Bounds};
use super::job::{Job, Mode, POSTURES, to_usize};
use super::planned::{Options, Plan, Planned};
use super::{load, table};
use crate::commands::route::{blocked_moves, is_blocked};
use crate::progress::Progress;
use std::collections::HashSet;
use stiffarm::Control;
use stiffarm::Result;
use stiffarm::files::source::Source;
use stiffarm::model::cell::Cell;
use stiffarm::model::posture::Posture;
use stiffarm::plan::index::{EvaluatedGroup, GroupEvaluation};
use stiffarm::plan::select::{
    GlobalOptions, LocalOptions, Selection, Sensitivity, SensitivityOptions, limit_prices,
    select_from, select_watched, sensitivity,
};

/// Iterations of a local search unless their number is given.
const MAX_ITERATIONS: u64 = 2000;

/// Selects, bounds and examines the plan, and writes plan and sheet. True where a move has no free way.
pub(super) fn run(job: &Job<'_>) -> Result<bool> {
    let (session, args) = (job.session, job.args);
    let robot = &job.cell().setup.robot;
    let read = |role: &str, from: &Option<String>| {
        from.as_deref()
            .map(|from| session.read_postures(role, from, robot))
            .transpose()
    };
    let initial = read("initial", &args.existing.from)?;
    let given = read("given", &args.existing.given)?.unwrap_or_default();
    let mut global = GlobalOptions::default();
    global.seed = job.seed();
    global.rounds = args.budget.rounds;
    global.time_limit = args.budget.time_limit;
    global.load = load::design(&args.load);
    global.given = given.iter().map(|posture| posture.q.clone()).collect();
    let count = to_usize(match args.existing.given {
        Some(_) => args.existing.add.unwrap_or(1),
        None => args.postures.unwrap_or(POSTURES),
    });
    let max_iterations = args.existing.max_iterations.unwrap_or(MAX_ITERATIONS);

    let progress = Progress::new(session, "selecting postures");
    let (selection, route, cell, selected, bounds, sensitivity, prices) =
        progress.watch(|control| -> Result<_> {
            let selection = match &initial {
                Some(group) => {
                    let mut options = LocalOptions::default();
                    options.max_iterations = max_iterations;
                    select_from(job.cell(), job.index, group, options, control)?
                }
                None => {
                    let quiet = Control {
                        progress: None,
                        ..control
                    };
                    select_watched(job.cell(), job.index, count, &global, quiet, &mut |round| {
                        job.report(&progress, round)
                    })?
                }
            };
            let cell = load::applied(job.cell(), selection.load.as_ref());
            let keep = initial.is_some();
            let (selection, route) = job.driven(&cell, selection, &given, keep, control)?;
            let selected = named(&selection, initial.as_deref(), &given);
            let bounds = match &initial {
                Some(_) => Bounds::default(),
                None => certificate::bounds(job, &cell, &given, &selected, &progress, control),
            };
            let examined = match args.sensitivity && !control.stopped() {
                true => examine(job, &cell, &selected, control)?,
                false => None,
            };
            let prices = match args.prices && !control.stopped() {
                true => {
                    let value = selection.value;
                    let quiet = Control {
                        progress: None,
                        ..control
                    };
                    let found = limit_prices(&cell, job.index, count, &global, value, quiet)?;
                    (!control.stopped()).then_some(found)
                }
                false => None,
            };
            Ok((selection, route, cell, selected, bounds, examined, prices))
        })?;
    drop(progress);

    let known: &[Posture] = initial.as_deref().unwrap_or(&given);
    let before_name = if initial.is_some() {
        "initial"
    } else {
        "given"
    };
    let before = match known.is_empty() {
        true => None,
        false => Some(EvaluatedGroup::new(&cell, before_name, known)?),
    };
    let after_name = if given.is_empty() {
        "selected"
    } else {
        "with new"
    };
    let after = GroupEvaluation {
        name: after_name.to_string(),
        ..selection.evaluation.clone()
    };
    job.outputs.write_postures(session, &cell, &selected)?;

    let names = |postures: &[Posture]| postures.iter().map(|p| p.name.clone()).collect();
    let plan = Plan {
        posture_names: names(&selected),
        repeats: route
            .repeats
            .iter()
            .map(|same| same.iter().map(|p| selected[*p].name.clone()).collect())
            .collect(),
        given_names: names(&given),
        given_value: match given.is_empty() {
            true => None,
            false => before
                .as_ref()
                .and_then(|b| b.evaluation.indices.get(job.index)),
        },
        joints: cell.setup.robot.spring_names(),
        evaluation: after.clone(),
        before,
        certificate: bounds.certificate,
        joint_efficiencies: bounds.joints,
        certificate_missing: bounds.missing,
        sensitivity,
        prices,
        selection,
        findings: {
            let mut findings = job.findings();
            findings.extend(cell.posture_findings(known));
            findings.extend(blocked_moves(&selected, &route));
            findings
        },
        route,
    };
    let is_random = initial.is_none() || args.sensitivity;
    let options = Options {
        mode: match (&initial, given.is_empty()) {
            (Some(_), _) => Mode::From,
            (None, true) => Mode::Global,
            (None, false) => Mode::Add,
        },
        postures: selected.len(),
        max_iterations: initial.is_some().then_some(max_iterations),
        rounds: args.budget.rounds,
        time_limit_s: args.budget.time_limit.map(|limit| limit.as_secs_f64()),
        angle_step_deg: job.angle_step(),
        load: load::options(&global.load),
        certificate: initial.is_none() && !args.no_certificate,
        sensitivity: args.sensitivity,
        prices: args.prices,
        characteristic_length_m: cell.characteristic_length,
    };
    let planned = Planned {
        plan: &plan,
        cell: &cell,
        design: &global.load,
        given: &given,
        selected: &selected,
        before: plan.before.as_ref().map(|before| &before.evaluation),
        after: &after,
    };
    let seed = is_random.then(|| job.seed());
    let envelope = session.envelope("select", seed, options, &plan);
    job.show(&envelope, || table::plan(job, &planned))?;
    Ok(is_blocked(&plan.findings))
}

/// Whether wrong assumptions would change the plan, `None` when stopped on the way.
fn examine(
    job: &Job<'_>,
    cell: &Cell,
    selected: &[Posture],
    control: Control<'_>,
) -> Result<Option<Sensitivity>> {
    let mut options = SensitivityOptions::default();
    options.seed = job.seed();
    // Who wants a quick plan wants a quick answer here too.
    if let Some(rounds) = job.args.budget.rounds {
        options.rounds = options.rounds.min(rounds);
    }
    let found = sensitivity(cell, job.index, selected, &options, control)?;
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
