//! A plan: from a global search, from an initial group, or beside given postures.

use super::certificate::{self, Bounds};
use super::{Job, Mode, load, table, to_usize};
use crate::progress::Progress;
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::HashSet;
use stiffarm::Control;
use stiffarm::Result;
use stiffarm::internals::optimise::Options as OptimiserOptions;
use stiffarm::model::cell::Cell;
use stiffarm::model::posture::Posture;
use stiffarm::plan::certificate::{Certificate, JointEfficiency};
use stiffarm::plan::index::{GroupEvaluation, evaluate};
use stiffarm::plan::select::{
    GlobalOptions, LoadDesign, Selection, Sensitivity, SensitivityOptions, select_from,
    select_watched, sensitivity,
};

/// Postures of a plan unless their number is given.
pub(super) const POSTURES: u64 = 6;
/// Iterations of a local search unless their number is given.
const MAX_ITERATIONS: u64 = 2000;

/// Options of the result.
#[derive(Serialize, JsonSchema)]
pub struct Options {
    /// `global`, `from` or `add`.
    pub mode: Mode,
    /// Number of postures selected.
    pub postures: usize,
    /// Iterations of the optimiser from an initial group; `null` without one.
    pub max_iterations: Option<u64>,
    /// Rounds asked for; `null` where the search ended by itself.
    pub rounds: Option<u64>,
    /// Time after which no further round was begun \[s\]; `null` without one.
    pub time_limit_s: Option<f64>,
    /// What of the load might be chosen; `null` where nothing.
    pub load: Option<load::LoadOptions>,
    /// Whether a certificate was wanted.
    pub certificate: bool,
    /// Whether the plan's sensitivity was wanted.
    pub sensitivity: bool,
    /// L of Eq. (20) \[m\].
    pub characteristic_length_m: Option<f64>,
}

/// The selected postures and what is known about them.
#[derive(Serialize, JsonSchema)]
pub struct Plan {
    /// The selection; its index and indices count the given postures too.
    #[serde(flatten)]
    pub selection: Selection,
    /// Names of the selected postures, in the order of `postures_deg`.
    pub posture_names: Vec<String>,
    /// Names of the postures that were given; empty without any.
    pub given_names: Vec<String>,
    /// The index of the given postures alone; `null` where there are none or
    /// they leave a joint undetermined.
    pub given_value: Option<f64>,
    /// How good any plan of as many postures could be; `null` where the index
    /// has no bound, or none was wanted or found.
    pub certificate: Option<Certificate>,
    /// The same for each joint on its own; `null` also beside given postures.
    pub joint_efficiencies: Option<Vec<JointEfficiency>>,
    /// Why there is no certificate, where one was wanted; else `null`.
    pub certificate_missing: Option<String>,
    /// Whether wrong assumptions would change the plan; `null` unless asked for.
    pub sensitivity: Option<Sensitivity>,
}

/// A plan with all that its table shows.
pub struct Planned<'a> {
    /// The result.
    pub plan: &'a Plan,
    /// The cell with the load that was chosen.
    pub cell: &'a Cell,
    /// What of the load might be chosen.
    pub design: &'a LoadDesign,
    /// The given postures.
    pub given: &'a [Posture],
    /// The selected postures.
    pub selected: &'a [Posture],
    /// Initial or given postures alone.
    pub before: Option<&'a GroupEvaluation>,
    /// Given and selected postures together.
    pub after: &'a GroupEvaluation,
}

/// Selects, bounds and examines the plan, and writes plan and sheet.
pub(super) fn run(job: &Job<'_>) -> Result<()> {
    let (session, args) = (job.session, job.args);
    let robot = &job.cell().setup.robot;
    let read = |role: &str, from: &Option<String>| {
        from.as_deref()
            .map(|from| session.read_postures(role, from, robot))
            .transpose()
    };
    let initial = read("initial", &args.existing.from)?;
    let given = read("given", &args.existing.given)?.unwrap_or_default();
    let global = GlobalOptions {
        seed: job.seed(),
        rounds: args.budget.rounds,
        time_limit: args.budget.time_limit,
        load: load::design(&args.load),
    };
    let count = to_usize(match args.existing.given {
        Some(_) => args.existing.add.unwrap_or(1),
        None => args.postures.unwrap_or(POSTURES),
    });
    let max_iterations = args.existing.max_iterations.unwrap_or(MAX_ITERATIONS);

    let progress = Progress::new(session, "selecting postures");
    let (selection, cell, selected, bounds, sensitivity) =
        progress.watch(|control| -> Result<_> {
            let selection = match &initial {
                Some(group) => {
                    let options = OptimiserOptions {
                        max_iterations,
                        ..OptimiserOptions::default()
                    };
                    select_from(job.cell(), job.index, group, options, control)?
                }
                None => {
                    let quiet = Control {
                        progress: None,
                        ..control
                    };
                    select_watched(
                        job.cell(),
                        job.index,
                        count,
                        &given,
                        &global,
                        quiet,
                        &mut |round| job.report(&progress, round),
                    )?
                }
            };
            let cell = load::applied(job.cell(), selection.load.as_ref());
            let selected = named(&selection, initial.as_deref(), &given);
            let bounds = match &initial {
                Some(_) => Bounds::default(),
                None => certificate::bounds(job, &cell, &given, &selected, &progress, control),
            };
            let examined = match args.sensitivity && !control.stopped() {
                true => examine(job, &cell, &selected, control)?,
                false => None,
            };
            Ok((selection, cell, selected, bounds, examined))
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
        false => Some(evaluate(&cell, before_name, known)?),
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
        given_names: names(&given),
        given_value: match given.is_empty() {
            true => None,
            false => before.as_ref().and_then(|b| b.indices.get(job.index)),
        },
        certificate: bounds.certificate,
        joint_efficiencies: bounds.joints,
        certificate_missing: bounds.missing,
        sensitivity,
        selection,
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
        load: load::options(&global.load),
        certificate: initial.is_none() && !args.no_certificate,
        sensitivity: args.sensitivity,
        characteristic_length_m: cell.characteristic_length,
    };
    let planned = Planned {
        plan: &plan,
        cell: &cell,
        design: &global.load,
        given: &given,
        selected: &selected,
        before: before.as_ref(),
        after: &after,
    };
    let seed = is_random.then(|| job.seed());
    let envelope = session.envelope("select", seed, options, &plan);
    job.show(&envelope, || table::plan(job, &planned))
}

/// Whether wrong assumptions would change the plan, `None` when stopped on the way.
fn examine(
    job: &Job<'_>,
    cell: &Cell,
    selected: &[Posture],
    control: Control<'_>,
) -> Result<Option<Sensitivity>> {
    let usual = SensitivityOptions::default();
    let options = SensitivityOptions {
        seed: job.seed(),
        // Who wants a quick plan wants a quick answer here too.
        rounds: job
            .args
            .budget
            .rounds
            .map_or(usual.rounds, |rounds| rounds.min(usual.rounds)),
        ..usual
    };
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
