//! A plan as people read it.

use super::certificate::{efficient, loose, sentence};
use super::job::{Job, shown, statistic};
use super::{limits, load, sensitivity};
use crate::commands::evaluate::{
    DEVIATION, beyond_first_order, deviation, forecast, mean_deviation, undetermined,
};
use crate::commands::{posture_table, route, wrapped_line};
use crate::numbers::{coarse_mm, counted, percent, significant};
use crate::screen::{columns, wrapped};
use crate::table::{Align, Table, title, yellow};
use stiffarm::Termination;
use stiffarm::findings::{Finding, list};
use stiffarm::model::cell::Cell;
use stiffarm::model::posture::Posture;
use stiffarm::plan::feasibility::{NO_ROOM_TO_SPARE, ON_MACHINE_LIMIT};
use stiffarm::plan::index::{GroupEvaluation, Index, expected_deviation};
use stiffarm::plan::planned::{Plan, PlanOptions, PlanRequest, Planned};
use stiffarm::plan::route::MOVE_BLOCKED;
use stiffarm::plan::select::{Selection, different};

/// k(J_N) above which a posture counts as near a singularity.
const NEAR_SINGULAR: f64 = 50.0;

/// The whole table.
pub fn plan(job: &Job<'_>, request: &PlanRequest, planned: &Planned<Plan, PlanOptions>) -> String {
    let (plan, cell, selected) = (&planned.result, &planned.cell, &planned.postures);
    let given = request.given.as_slice();
    let selection = &plan.selection;
    let mut out = job.heading();
    out += &undetermined(std::slice::from_ref(&plan.evaluation));
    out += &index_line(job, plan);
    out += &rounds_line(job, selection);
    if let Some(certificate) = &plan.certificate {
        out += &sentence(certificate, selection.load.is_some());
    }
    if let Some(why) = &plan.certificate_missing {
        let what = if plan.certificate.is_some() {
            "bounds of the joints"
        } else {
            "certificate"
        };
        out += &format!("{what}: none; {why}\n");
    }
    out += &remarks(cell, given, selected, plan);
    out += &told(&plan.findings);
    if let Some(chosen) = &selection.load {
        out += &title("Load chosen with the postures");
        out +=
            "the plan holds for this load: put these lines into cell.toml before anything else\n";
        out += &load::lines(&request.load, chosen);
    }
    if selected.len() > 1 {
        // In which order to drive, and what is known of the moves.
        out += &route::sentence(cell, &plan.route);
    }
    out += &title("Postures");
    out += &postures(job, cell, given, selected);
    out += &limits::nearest(cell, &plan.posture_names, &selection.limits);
    out += &forecast(&plan.joints, &plan.evaluation);
    if cell.prior.is_some() {
        out += &deviations(plan);
    }
    out += &limits::prices(plan);
    match &plan.sensitivity {
        Some(found) => out += &sensitivity::table(found),
        None if job.args.sensitivity => out += "\nsensitivity: stopped before it was known\n",
        None => {}
    }
    out
}

/// The index, what it was before, and why a local search ended.
fn index_line(job: &Job<'_>, plan: &Plan) -> String {
    let selection = &plan.selection;
    let index = selection.index;
    let mut out = format!(
        "index: {} = {}{}",
        index.as_str(),
        shown(index, selection.value),
        statistic(index)
    );
    if !plan.given_names.is_empty() {
        let given = counted(plan.given_names.len(), "posture");
        out += &match plan.given_value {
            Some(value) => format!(
                " with the new ones, {} with the {given} given",
                shown(index, value)
            ),
            None => format!(" with the new ones; the {given} given cannot determine every joint"),
        };
    } else if job.args.existing.from.is_some() {
        if let Some(value) = selection.start_value {
            out += &format!(", from {} at the initial group", shown(index, value));
        }
        out += &format!(" ({})", selection.termination.describe());
    }
    if !plan.repeats.is_empty() {
        let count = plan.posture_names.len();
        out += &format!(
            "; {count} postures, {} different",
            different(count, &plan.repeats)
        );
    }
    wrapped(&out, columns()) + "\n"
}

/// Findings about moves and postures that one wants to know before the tables.
pub(super) fn told(findings: &[Finding]) -> String {
    let codes = [MOVE_BLOCKED, ON_MACHINE_LIMIT, NO_ROOM_TO_SPARE];
    let own = findings.iter().filter(|f| codes.contains(&f.code.as_str()));
    own.map(|f| wrapped_line(f) + "\n").collect()
}

/// How a global search went, and how to have the same result again.
fn rounds_line(job: &Job<'_>, selection: &Selection) -> String {
    let Some(rounds) = selection.rounds else {
        return String::new();
    };
    let searched = match rounds {
        1 => "1 round".to_string(),
        _ => format!("{rounds} rounds"),
    };
    let again = match rounds {
        0 => "stopped in the first round, which cannot be repeated".to_string(),
        _ => format!("--rounds {rounds} repeats it"),
    };
    let ended = match selection.termination {
        Termination::Converged if selection.index.has_many_local_minima() => {
            "nothing improved any more, but this index has many local minima: another --seed may find a better plan"
                .to_string()
        }
        Termination::Converged => "nothing improved any more".to_string(),
        Termination::TimeLimit => format!("the time was over; {again}"),
        Termination::Interrupted => format!("interrupted; {again}"),
        _ if job.args.budget.rounds.is_some() => "as asked for".to_string(),
        _ => "the most without --rounds; more may find a better plan".to_string(),
    };
    format!(
        "search: {searched}, {} local searches; {ended}\n",
        selection.starts
    )
}

/// What to know before driving to the postures.
fn remarks(cell: &Cell, given: &[Posture], selected: &[Posture], plan: &Plan) -> String {
    let mut out = String::new();
    if let Some(margin) = plan.selection.smallest_margin_m {
        out += &format!(
            "smallest margin to the cell's limits: {} mm\n",
            coarse_mm(margin.max(0.0))
        );
    }
    if cell.setup.robot.limits_are_unknown() {
        out += "the machine's limits are not known (±360° stand in): compare the postures with the machine before driving them\n";
    }
    let sizes = plan.evaluation.indices.prediction_sizes;
    if let (Index::Prediction, Some(sizes)) = (plan.selection.index, sizes) {
        out += &format!("prediction takes {}\n", sizes.in_words());
    }
    let several = cell.setup.load.has_cases();
    out += &repeated(&plan.repeats, selected.len(), several);
    for remark in cell.posture_remarks(given) {
        out += &format!("{}: given {remark}\n", yellow("note"));
    }
    let selected_k = plan.evaluation.k_jn.iter().skip(given.len());
    for (posture, k) in selected.iter().zip(selected_k) {
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
    out
}

/// What to measure more than once.
fn repeated(repeats: &[Vec<String>], count: usize, several_loads: bool) -> String {
    let Some(first) = repeats.first() else {
        return String::new();
    };
    let times = |count: usize| match count {
        2 => "twice".to_string(),
        count => format!("{count} times"),
    };
    let each: Vec<String> = repeats
        .iter()
        .map(|same| {
            format!(
                "posture {} {} (it is also {})",
                same[0],
                times(same.len()),
                list(&same[1..])
            )
        })
        .collect();
    let said = format!(
        "{}: {} different postures; measure {}: drive away in between. Against noise alone posture {} is worth more a second time than any \
         other once; what else may be wrong shows better at another posture{}",
        yellow("note"),
        different(count, repeats),
        list(&each),
        first[0],
        match several_loads {
            // That index counts one load.
            true => "",
            false => " (--index prediction)",
        }
    );
    wrapped(&said, columns()) + "\n"
}

/// The postures; beside given ones, which are which.
fn postures(job: &Job<'_>, cell: &Cell, given: &[Posture], selected: &[Posture]) -> String {
    if given.is_empty() {
        return posture_table(cell, selected).to_string();
    }
    let all: Vec<Posture> = given.iter().chain(selected).cloned().collect();
    let marks =
        std::iter::repeat_n("given", given.len()).chain(std::iter::repeat_n("new", selected.len()));
    let mut table = posture_table(cell, &all);
    table.column("", Align::Left, marks);
    let mut out = table.to_string();
    if job.args.output.output.is_some() || job.args.output.sheet.is_some() {
        out += "the files hold the new postures only\n";
    }
    out
}

/// Expected deviation of each joint, beside the least that is possible.
fn deviations(plan: &Plan) -> String {
    let mut out = title(DEVIATION);
    let before = plan.before.as_ref().map(|before| &before.evaluation);
    let columns: Vec<&GroupEvaluation> = before.into_iter().chain([&plan.evaluation]).collect();
    let bounds = plan.joint_efficiencies.as_deref();
    let mut headings = vec!["joint".to_string()];
    headings.extend(columns.iter().map(|e| e.name.clone()));
    if bounds.is_some() {
        headings.push(format!("no {} go below", plan.posture_names.len()));
        headings.push("efficiency".to_string());
    }
    let mut table = Table::new(headings);
    for (j, name) in plan.joints.iter().cloned().enumerate() {
        let mut row = vec![name];
        row.extend(columns.iter().map(|e| deviation(e, j)));
        if let Some(bound) = bounds.and_then(|bounds| bounds.get(j)) {
            row.push(percent(expected_deviation(bound.bound)));
            row.push(bound.efficiency.map_or_else(|| "-".to_string(), efficient));
        }
        table.row(row);
    }
    let means = columns.iter().map(|e| mean_deviation(e));
    table.row(std::iter::once("mean".to_string()).chain(means));
    out += &table.to_string();
    out += beyond_first_order(columns.iter().copied());
    if let Some(bounds) = bounds {
        out += "each joint's bound is for a plan that serves this joint alone; no plan need reach it\n";
        out += &loose(bounds);
    }
    out
}
