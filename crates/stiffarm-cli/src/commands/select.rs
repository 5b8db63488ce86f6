//! `stiffarm select`: choose the postures to measure.

use super::{evaluate::undetermined, index_value, is_relative_error, posture_table, with_length};
use crate::args::SelectArgs;
use crate::files::{Target, check_one_stdout, write_all};
use crate::input::NamedCell;
use crate::interrupt;
use crate::numbers::{coarse_mm, optional_percent, significant};
use crate::output::Exit;
use crate::progress::Progress;
use crate::session::Session;
use crate::table::{Table, title, yellow};
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::Serialize;
use std::sync::atomic::{AtomicUsize, Ordering};
use stiffarm::cell::Cell;
use stiffarm::index::{GroupEvaluation, Index, evaluate};
use stiffarm::optimise::{Control, Options as OptimiserOptions, Termination};
use stiffarm::posture::Posture;
use stiffarm::select::{Selection, StartKind, random_group, select_from};
use stiffarm::table::{reading_sheet, write_postures};
use stiffarm::{Code, Error, Result};

/// k(J_N) above which a posture counts as near a singularity.
const NEAR_SINGULAR: f64 = 50.0;

/// Options of the result.
#[derive(Serialize, JsonSchema)]
pub struct Options {
    /// Number of postures.
    pub postures: usize,
    /// Random starts; `null` when an initial group was given.
    pub starts: Option<u64>,
    /// Iterations of the optimiser for each start.
    pub max_iterations: u64,
    /// L of Eq. (20) \[m\].
    pub characteristic_length_m: Option<f64>,
}

/// The best group with how the starts fared.
#[derive(Serialize, JsonSchema)]
pub struct Selected {
    /// The best group; its counts are those of all starts.
    #[serde(flatten)]
    pub selection: Selection,
    /// Start by start; those that an interruption kept from starting are left out.
    pub start_results: Vec<StartResult>,
}

/// How one start ended.
#[derive(Serialize, JsonSchema)]
pub struct StartResult {
    /// Number of the start, from 1.
    pub start: usize,
    /// Value of the index, `null` where nothing was found.
    pub value: Option<f64>,
    /// Why the search ended, `null` where nothing was found.
    pub termination: Option<Termination>,
    /// Code of the error, where nothing was found.
    pub error: Option<String>,
}

/// Selects the postures and writes plan and sheet.
pub fn run(session: &Session, args: &SelectArgs) -> Result<Exit> {
    let index = Index::from_name(&args.index)?;
    let plan = args
        .output
        .as_deref()
        .map(|path| Target::new(path, args.force))
        .transpose()?;
    let sheet = args
        .sheet
        .as_deref()
        .map(|path| Target::new(path, args.force))
        .transpose()?;
    check_one_stdout(session, &[plan.as_ref(), sheet.as_ref()])?;
    let mut named = session.read_cell(&args.cell)?;
    let initial = args
        .from
        .as_deref()
        .map(|from| session.read_postures("initial", from, &named.cell.setup.robot))
        .transpose()?;
    let (cell, length_line) = with_length(named.cell);
    named.cell = cell;
    let cell = &named.cell;
    let optimiser = OptimiserOptions {
        max_iterations: args.max_iterations,
        ..OptimiserOptions::default()
    };

    let progress = Progress::new(session, "selecting postures");
    let outcomes = progress.watch(|control| match &initial {
        Some(group) => vec![select_from(cell, index, group, optimiser, control)],
        None => random_starts(cell, index, args, optimiser, control),
    });
    drop(progress);
    let selected = best(index, outcomes)?;

    let names = initial
        .as_ref()
        .map(|group| group.iter().map(|p| p.name.clone()).collect());
    let postures = named_postures(&selected.selection, names);
    let before = initial
        .as_ref()
        .map(|group| evaluate(cell, "initial", group))
        .transpose()?;
    let after = evaluate(cell, "selected", &postures)?;
    let to_stdout = [&plan, &sheet].into_iter().flatten().any(Target::is_stdout);
    let mut files = Vec::new();
    if let Some(plan) = plan {
        files.push((plan, write_postures(&postures)));
    }
    if let Some(sheet) = sheet {
        let states: Vec<&str> = args.states.iter().map(String::as_str).collect();
        files.push((sheet, reading_sheet(&postures, &states, cell)));
    }
    write_all(session, &files)?;

    let table = || {
        table(
            &named,
            &length_line,
            &selected,
            before.as_ref(),
            &after,
            &postures,
        )
    };
    if to_stdout {
        session.remark(&table());
    } else {
        let options = Options {
            postures: postures.len(),
            starts: initial.is_none().then_some(args.starts),
            max_iterations: args.max_iterations,
            characteristic_length_m: cell.characteristic_length,
        };
        let seed = initial.is_none().then_some(args.seed);
        session.show(&session.envelope("select", seed, options, &selected), table)?;
    }
    Ok(if interrupt::stopped() {
        Exit::Interrupted
    } else {
        Exit::Done
    })
}

/// One local search from each of the random groups, on all cores.
fn random_starts(
    cell: &Cell,
    index: Index,
    args: &SelectArgs,
    optimiser: OptimiserOptions,
    control: Control<'_>,
) -> Vec<Result<Selection>> {
    let done = AtomicUsize::new(0);
    let count = usize::try_from(args.postures).unwrap_or(usize::MAX);
    let of = usize::try_from(args.starts).unwrap_or(usize::MAX);
    (0..args.starts)
        .into_par_iter()
        .map(|stream| {
            if control.stopped() {
                return Err(Error::new(Code::Interrupted, "Stopped before this start."));
            }
            let initial = random_group(cell, StartKind::Uniform, count, args.seed, stream)?;
            let selection = select_from(cell, index, &initial, optimiser, control);
            control.report("starts", done.fetch_add(1, Ordering::Relaxed) + 1, of);
            selection
        })
        .collect()
}

/// The best of all starts, or the first reason why there is none.
fn best(index: Index, outcomes: Vec<Result<Selection>>) -> Result<Selected> {
    let start_results = (1..)
        .zip(&outcomes)
        .filter(|(_, outcome)| {
            !outcome
                .as_ref()
                .is_err_and(|e| e.code() == Code::Interrupted)
        })
        .map(|(start, outcome)| StartResult {
            start,
            value: outcome.as_ref().ok().map(|s| s.value),
            termination: outcome.as_ref().ok().map(|s| s.termination),
            error: outcome
                .as_ref()
                .err()
                .map(|e| e.code().as_str().to_string()),
        })
        .collect();
    let (found, failed): (Vec<_>, Vec<_>) = outcomes.into_iter().partition(Result::is_ok);
    let found: Vec<Selection> = found.into_iter().flatten().collect();
    let starts = found.len();
    let evaluations = found.iter().map(|s| s.evaluations).sum();
    let iterations = found.iter().map(|s| s.iterations).sum();
    let better = |a: &Selection, b: &Selection| {
        if index.larger_is_better() {
            a.value > b.value
        } else {
            a.value < b.value
        }
    };
    // Equal values: the first start wins, whatever finished first.
    let selection = found
        .into_iter()
        .reduce(|best, next| if better(&next, &best) { next } else { best });
    let Some(mut selection) = selection else {
        let nothing = || Error::new(Code::Internal, "There was no start.");
        return Err(failed
            .into_iter()
            .find_map(Result::err)
            .unwrap_or_else(nothing));
    };
    (
        selection.starts,
        selection.evaluations,
        selection.iterations,
    ) = (starts, evaluations, iterations);
    if interrupt::stopped() {
        selection.termination = Termination::Interrupted;
    }
    Ok(Selected {
        selection,
        start_results,
    })
}

/// The selected postures under the names of the initial ones, else numbered.
fn named_postures(selection: &Selection, names: Option<Vec<String>>) -> Vec<Posture> {
    let mut postures = selection.to_group("selected").postures;
    for (posture, name) in postures.iter_mut().zip(names.into_iter().flatten()) {
        posture.name = name;
    }
    postures
}

fn table(
    named: &NamedCell,
    length_line: &str,
    selected: &Selected,
    before: Option<&GroupEvaluation>,
    after: &GroupEvaluation,
    postures: &[Posture],
) -> String {
    let cell = &named.cell;
    let selection = &selected.selection;
    let index = selection.index;
    let unit = if is_relative_error(index) { " %" } else { "" };
    let shown = |value: f64| index_value(index, Some(value)) + unit;
    let mut out = named.line() + length_line;
    out += &undetermined(std::slice::from_ref(after));
    out += &format!("index: {} = {}", index.as_str(), shown(selection.value));
    if before.is_some() {
        out += &selection.start_value.map_or_else(String::new, |v| {
            format!(", from {} at the initial group", shown(v))
        });
    }
    out += &format!(" ({})\n", selection.termination.describe());
    out += &starts_line(selected, &shown);
    if let Some(margin) = selection.smallest_margin_m {
        out += &format!(
            "smallest margin to the cell's limits: {} mm\n",
            coarse_mm(margin.max(0.0))
        );
    }
    if cell.setup.robot.limits_are_unknown() {
        out += "the machine's limits are not known (±360° stand in): compare the postures with the machine before driving them\n";
    }
    for (posture, k) in postures.iter().zip(&after.k_jn) {
        if cell.characteristic_length.is_some() && k.is_none_or(|k| k > NEAR_SINGULAR) {
            let k = k.map_or_else(
                || "is infinite".to_string(),
                |k| format!("is {}", significant(k, 3)),
            );
            out += &format!(
                "{}: posture {} is close to a singularity, k(J_N) {k}: harmless to the identification, but move \
                 there joint by joint\n",
                yellow("note"),
                posture.name
            );
        }
    }
    out += &title("Postures");
    out += &posture_table(cell, postures).to_string();
    if cell.prior.is_some() {
        out += &title("Expected deviation |k̂ − k|/k of the identified stiffness [%]");
        let heading = if before.is_some() {
            vec!["joint", "initial", "selected"]
        } else {
            vec!["joint", "selected"]
        };
        let mut deviations = Table::new(heading);
        let columns: Vec<&GroupEvaluation> = before.into_iter().chain([after]).collect();
        for (j, name) in cell.setup.robot.spring_names().into_iter().enumerate() {
            let values = columns
                .iter()
                .map(|e| optional_percent(e.expected_deviation[j]));
            deviations.row(std::iter::once(name).chain(values));
        }
        let means = columns
            .iter()
            .map(|e| optional_percent(e.mean_expected_deviation()));
        deviations.row(std::iter::once("mean".to_string()).chain(means));
        out += &deviations.to_string();
    }
    out
}

/// How much the result depends on the start.
fn starts_line(selected: &Selected, shown: &dyn Fn(f64) -> String) -> String {
    let results = &selected.start_results;
    if results.len() < 2 {
        return String::new();
    }
    let mut values: Vec<f64> = results.iter().filter_map(|r| r.value).collect();
    values.sort_by(f64::total_cmp);
    let best = selected.selection.value;
    let near = values
        .iter()
        .filter(|v| (*v - best).abs() <= 0.01 * best.abs())
        .count();
    let (Some(low), Some(high)) = (values.first(), values.last()) else {
        return String::new();
    };
    let mut line = format!(
        "starts: {} of {} within 1 % of the best; values {} to {}",
        near,
        results.len(),
        shown(*low),
        shown(*high)
    );
    if values.len() < results.len() {
        line += &format!("; {} found nothing", results.len() - values.len());
    }
    if near == 1 {
        line += "; more --starts may find a better one";
    }
    line + "\n"
}
