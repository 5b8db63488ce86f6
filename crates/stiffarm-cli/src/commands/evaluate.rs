//! `stiffarm evaluate`: all indices and expected errors of given postures.

use super::{index_value, with_length};
use crate::args::EvaluateArgs;
use crate::input::Line;
use crate::numbers::{NONE, confidence, optional, optional_percent, significant};
use crate::output::Exit;
use crate::session::Session;
use crate::table::{Align, Table, serious, title, yellow};
use stiffarm::Result;
use stiffarm::files::source::Source;
use stiffarm::findings::list;
use stiffarm::model::cell::Cell;
use stiffarm::plan::index::{Evaluated, EvaluatedOptions, GroupEvaluation, Index};

/// Evaluates the groups.
pub fn run(session: &Session, args: &EvaluateArgs) -> Result<Exit> {
    let mut named = session.read_cell(&args.cell)?;
    let groups = session.read_groups(&args.postures, &named.cell.setup.robot)?;
    let (cell, length_line) = with_length(named.cell);
    named.cell = cell;
    let cell = &named.cell;
    let evaluated = Evaluated::new(cell, &groups)?.with_forecast(cell);
    let own = evaluated
        .groups
        .iter()
        .map(|group| group.evaluation.clone());
    let evaluations: Vec<GroupEvaluation> = own.collect();
    let exit = Exit::finding(
        evaluations
            .iter()
            .any(|e| !e.undetermined_joints.is_empty()),
    );
    let table = || {
        let mut out = named.line() + &length_line;
        out += &undetermined(&evaluations);
        for group in &groups {
            for remark in cell.posture_remarks(&group.postures) {
                out += &format!("{}: {}: {remark}\n", yellow("note"), group.name);
            }
        }
        if cell.prior.is_none() {
            out += "note: the cell has no prior stiffness, so there are no expected errors\n";
        }
        if cell.tasks.is_empty() {
            out += "note: the cell has no [[task]], so there is no task index\n";
        }
        if let Some(sizes) = evaluations.iter().find_map(|e| e.indices.prediction_sizes) {
            out += &format!("note: the index prediction takes {}\n", sizes.in_words());
        }
        let postures: Vec<Vec<&str>> = groups
            .iter()
            .map(|g| g.postures.iter().map(|p| p.name.as_str()).collect())
            .collect();
        out + &tables(cell, &evaluations, &postures)
    };
    let options = EvaluatedOptions::of(cell);
    session.show(
        &session.envelope("evaluate", None, options, evaluated),
        table,
    )?;
    Ok(exit)
}

/// Title of the table of expected deviations.
pub const DEVIATION: &str =
    "Expected deviation |k̂ − k|/k of the identified stiffness, by noise alone [%]";

/// The ± that `identify` is expected to print; nothing where there is none.
pub fn forecast(joints: &[String], evaluation: &GroupEvaluation) -> String {
    let known = evaluation.forecast.as_ref();
    let Some(found) = known.filter(|found| found.total.iter().any(Option::is_some)) else {
        return String::new();
    };
    let mut out = title(&format!(
        "{}: ± of the stiffness that `identify` will print [%]",
        evaluation.name
    ));
    let level = format!("± {} %", confidence(found.confidence));
    let mut table = Table::new(["joint", &level, "readings", "systematic", "most of it"]);
    table.align(4, Align::Left);
    let short = |part: Option<f64>| {
        let part = part.filter(|part| *part < 1.0);
        part.map_or_else(|| NONE.to_string(), |part| significant(100.0 * part, 2))
    };
    for (j, name) in joints.iter().enumerate() {
        let source = found.largest_source[j].as_deref().unwrap_or_default();
        table.row([
            name.clone(),
            short(found.total[j]),
            short(found.readings[j]),
            short(found.systematic[j]),
            source.replace('-', " "),
        ]);
    }
    out += &table.to_string();
    out + "forecast for one reading of each point under the whole load: readings and systematic errors together\n"
}

/// Names joints that a group cannot determine, before any number.
pub fn undetermined(evaluations: &[GroupEvaluation]) -> String {
    let lines = evaluations
        .iter()
        .filter(|e| !e.undetermined_joints.is_empty())
        .map(|e| {
            let said = format!(
                "{} cannot determine {}",
                e.name,
                list(&e.undetermined_joints)
            );
            format!(
                "{}: `stiffarm check` looks for the reason\n",
                serious(&said)
            )
        });
    lines.collect()
}

/// Expected deviation of a joint \[%\], marked where the first order does not reach.
pub fn deviation(evaluation: &GroupEvaluation, joint: usize) -> String {
    let value = optional_percent(evaluation.expected_deviation[joint]);
    match evaluation.is_beyond_first_order(joint) {
        true => format!("{value} *"),
        false => value,
    }
}

/// Their mean over the joints \[%\], marked where one of them is.
pub fn mean_deviation(evaluation: &GroupEvaluation) -> String {
    let value = optional_percent(evaluation.mean_expected_deviation());
    match is_marked(evaluation) && evaluation.mean_expected_deviation().is_some() {
        true => format!("{value} *"),
        false => value,
    }
}

/// What the mark means, where there is one.
pub fn beyond_first_order<'a>(
    mut evaluations: impl Iterator<Item = &'a GroupEvaluation>,
) -> &'static str {
    match evaluations.any(is_marked) {
        true => {
            "* the relative standard error is above 10 %, where this closed form, a first-order figure, no longer holds; \
             `stiffarm simulate` draws the errors\n"
        }
        false => "",
    }
}

fn is_marked(evaluation: &GroupEvaluation) -> bool {
    (0..evaluation.relative_standard_error.len()).any(|j| evaluation.is_beyond_first_order(j))
}

/// Tables with one column per group: indices, expected deviations, k(J_N).
pub fn tables(cell: &Cell, evaluations: &[GroupEvaluation], postures: &[Vec<&str>]) -> String {
    let table = |first: &str| {
        Table::new(
            std::iter::once(first.to_string()).chain(evaluations.iter().map(|e| e.name.clone())),
        )
    };
    let row = |name: String, value: &dyn Fn(&GroupEvaluation) -> String| -> Vec<String> {
        std::iter::once(name)
            .chain(evaluations.iter().map(value))
            .collect()
    };
    let mut out = title("Indices");
    let names = evaluations.iter().map(|e| e.name.as_str());
    let mut indices = Table::new(["index", "meaning"].into_iter().chain(names));
    indices.align(1, Align::Left);
    for index in Index::ALL {
        let values = evaluations
            .iter()
            .map(|e| index_value(index, e.indices.get(index)));
        let described = [index.as_str().to_string(), meaning(index).to_string()];
        indices.row(described.into_iter().chain(values));
    }
    out += &indices.to_string();
    let joints = cell.setup.robot.spring_names();
    for evaluation in evaluations {
        out += &forecast(&joints, evaluation);
    }
    if cell.prior.is_some() {
        out += &title(DEVIATION);
        let mut deviations = table("joint");
        for (j, name) in joints.into_iter().enumerate() {
            deviations.row(row(name, &|e| deviation(e, j)));
        }
        deviations.row(row("mean".to_string(), &mean_deviation));
        out += &deviations.to_string();
        out += beyond_first_order(evaluations.iter());
    }
    if cell.characteristic_length.is_some() {
        out += &title("k(J_N) of each posture");
        // Postures are named by the first group where all agree, else counted.
        let longest = postures
            .iter()
            .max_by_key(|p| p.len())
            .cloned()
            .unwrap_or_default();
        let same = postures
            .iter()
            .all(|p| p.iter().zip(&longest).all(|(a, b)| a == b));
        let mut dexterity = table(if same { "posture" } else { "row" });
        for (p, name) in longest.iter().enumerate() {
            let name = if same {
                (*name).to_string()
            } else {
                (p + 1).to_string()
            };
            dexterity.row(row(name, &|e| {
                e.k_jn.get(p).map_or_else(String::new, |k| optional(*k, 4))
            }));
        }
        out += &dexterity.to_string();
    }
    out
}

/// What an index stands for.
fn meaning(index: Index) -> &'static str {
    match index {
        Index::Classical => "max k(J_N)",
        Index::Condition => "cond(Ψ)",
        Index::Novel => "classical × condition",
        Index::ScaledCondition => "cond(Ψ·diag(1/k))",
        Index::Scaled => "classical × scaled_condition",
        Index::ExpectedError => "RMS relative standard error of k [%]",
        Index::WorstJoint => "largest relative standard error of k [%]",
        Index::DropOne => "expected_error with the worst posture lost [%]",
        Index::D => "size of the error ellipsoid, per axis [%]",
        Index::Task => "RMS error of the tasks' predicted deflection [mm]",
        Index::Prediction => "RMS error of predicted deflection, mixed model [mm]",
        Index::O1 => "geometric mean of σ_i / √postures; larger is better",
        Index::O2 => "σ_min/σ_max; larger is better",
        Index::O3 => "σ_min; larger is better",
        Index::O4 => "σ_min²/σ_max; larger is better",
        Index::O5 => "1/Σ(1/σ_i); larger is better",
    }
}
