//! `stiffarm simulate --elastic`: identifications of an arm that gives way beyond its
//! joint axes, with the axes alone and with the mixed model.

use crate::args::SimulateArgs;
use crate::error::of_usage;
use crate::files::{Target, check_targets, write_all};
use crate::input::Line;
use crate::numbers::{NONE, mm, percent, significant};
use crate::output::Exit;
use crate::progress::Progress;
use crate::screen::{columns, wrapped};
use crate::session::Session;
use crate::table::{Table, red, title};
use stiffarm::estimate::elastic::ElasticChoice;
use stiffarm::estimate::simulate::{
    ElasticGroup, ElasticLevel, ElasticModelOutcome, ElasticSimulation, simulate_elastic,
    simulate_elastic_measurements,
};
use stiffarm::estimate::simulated::ElasticOptions;
use stiffarm::files::source::Source;
use stiffarm::files::table::write_displacements;
use stiffarm::model::elastic::ElasticClass;
use stiffarm::{Code, Error, Result};

/// Runs the simulation.
pub(super) fn run(session: &Session, args: &SimulateArgs) -> Result<Exit> {
    refuse(args)?;
    let target = args.measurements.as_deref();
    let target = target
        .map(|path| Target::new(path, args.force))
        .transpose()?;
    check_targets(session, &[target.as_ref()])?;
    let options = args
        .request()
        .elastic_options(args.elastic())
        .map_err(|e| of_usage(e, &super::SIZES))?;
    let named = session.read_cell(&args.cell)?;
    let cell = &named.cell;
    let groups = session.read_groups(&args.postures, &cell.setup.robot)?;
    let progress = Progress::new(session, "simulating");
    let result = progress.watch(|control| simulate_elastic(cell, &groups, &options, control))?;
    drop(progress);
    let to_stdout = target.as_ref().is_some_and(Target::is_stdout);
    if let Some(target) = target {
        let measured = simulate_elastic_measurements(cell, &groups[0].postures, args.seed)?;
        write_all(session, &[(target, write_displacements(&measured, cell))])?;
    }
    let table = || named.line() + &table(&result);
    let envelope = session.envelope(
        "simulate",
        Some(args.seed),
        ElasticOptions::from(&options),
        &result,
    );
    if to_stdout {
        session.write_page(&envelope)?;
        session.remark(&table());
    } else {
        session.show(&envelope, table)?;
    }
    Ok(match result.interrupted {
        true => Exit::Interrupted,
        false => Exit::Done,
    })
}

/// Refuses options that only the paper's simulation has.
fn refuse(args: &SimulateArgs) -> Result<()> {
    let refused = match (args.errors.given(), &args.readings) {
        (Some(option), _) => Some((
            option,
            "Errors of the model are drawn only for an arm of which the joint axes alone give way.",
        )),
        (None, Some(_)) => Some((
            "--readings",
            "Raw readings are simulated only for an arm of which the joint axes alone give way.",
        )),
        (None, None) => None,
    };
    match refused {
        Some((option, message)) => {
            let hint = match option {
                "--readings" => {
                    "write displacements with --measurements, or leave --elastic out".into()
                }
                _ => format!("leave {option} out, or --elastic"),
            };
            Err(Error::new(Code::Conflict, message).key(option).hint(hint))
        }
        None => Ok(()),
    }
}

fn table(result: &ElasticSimulation) -> String {
    let said = |sentence: &str| wrapped(sentence, columns()) + "\n";
    let mut out = said(&result.verdict());
    out += &said(&truth(result));
    let levels = || result.groups.iter().flat_map(|g| &g.levels);
    if result.interrupted {
        let fewest = levels().map(|level| level.runs).min().unwrap_or(0);
        let stopped = format!(
            "{} after {fewest} of {} runs at the level with the fewest",
            red("stopped"),
            result.runs
        );
        out += &said(&stopped);
    }
    let without: usize = levels().map(|level| level.without_mixed).sum();
    if without > 0 {
        out += &said(&format!(
            "In {without} of {} runs the data do not carry the mixed model, and the joint axes stand in for it.",
            levels().map(|level| level.runs).sum::<usize>()
        ));
    }
    out += &title("RMS error of a predicted deflection [mm]");
    out += &errors(result).to_string();
    out += &said(
        "expected: the index prediction, the error of the mixed model if its sizes and those of the noise were known",
    );
    out += &title("Share that holds the truth [%]: bands of deflections, intervals of k");
    out += &shares(result).to_string();
    if result.asked == ElasticChoice::Auto {
        out += "taken: runs in which the data call for the mixed model\n";
    }
    for group in &result.groups {
        for level in &group.levels {
            out += &title(&format!(
                "{}, variance × {}: deviation |k̂ − k|/k [%]",
                group.name, level.variance_factor
            ));
            out += &joints(level, &result.joints).to_string();
        }
    }
    out
}

/// What each run draws, and what it predicts.
fn truth(result: &ElasticSimulation) -> String {
    let sizes = ElasticClass::ALL.map(|class| {
        let size = significant(result.sizes.of(class), 2);
        format!("{size} {}", class.unit())
    });
    let place = match result.predicted_tasks {
        true => "at the tasks of the cell".to_string(),
        false => format!(
            "at {} random postures inside the cell's limits, under its load",
            result.predicted_count
        ),
    };
    format!(
        "Each of {} runs draws springs at joints and base with {}, {}; deflections are predicted {place}.",
        result.runs,
        result.sizes_from.in_words(),
        sizes.join(", ")
    )
}

/// Every level of every group.
fn rows(result: &ElasticSimulation) -> impl Iterator<Item = (&ElasticGroup, &ElasticLevel)> {
    let groups = result.groups.iter();
    groups.flat_map(|group| group.levels.iter().map(move |level| (group, level)))
}

fn errors(result: &ElasticSimulation) -> Table {
    let is_auto = result.asked == ElasticChoice::Auto;
    let auto = is_auto.then_some("auto");
    let headings = ["group", "variance", "axes", "mixed", "expected"];
    let mut table = Table::new(headings.into_iter().chain(auto));
    let shown = |outcome: &ElasticModelOutcome| {
        format!(
            "{} ± {}",
            mm(outcome.prediction_rms_m),
            mm(outcome.prediction_standard_error_m)
        )
    };
    let optional = |value: Option<String>| value.unwrap_or_else(|| NONE.to_string());
    for (group, level) in rows(result) {
        let auto = level.auto.as_ref().map(|auto| mm(auto.prediction_rms_m));
        let row = [
            group.name.clone(),
            format!("× {}", level.variance_factor),
            shown(&level.axes),
            optional(level.mixed.as_ref().map(shown)),
            optional(level.expected_prediction_m.map(mm)),
        ];
        table.row(row.into_iter().chain(auto));
    }
    table
}

fn shares(result: &ElasticSimulation) -> Table {
    let is_auto = result.asked == ElasticChoice::Auto;
    let mut headings = vec!["group", "variance", "bands: axes", "mixed"];
    headings.extend(is_auto.then_some("auto"));
    headings.extend(["k: axes", "mixed"]);
    headings.extend(is_auto.then_some(["auto", "taken"]).into_iter().flatten());
    let mut table = Table::new(headings);
    for (group, level) in rows(result) {
        let models = || {
            [Some(&level.axes), level.mixed.as_ref(), level.auto.as_ref()]
                .into_iter()
                .flatten()
        };
        let mut row = vec![group.name.clone(), format!("× {}", level.variance_factor)];
        row.extend(models().map(|model| share(model.band_share)));
        row.extend(models().map(|model| share(model.mean_interval_share())));
        row.extend(level.auto_took_mixed.map(|taken| share(Some(taken))));
        table.row(row);
    }
    table
}

fn joints(level: &ElasticLevel, names: &[String]) -> Table {
    let mut table = Table::new([
        "joint",
        "axes: median",
        "mean",
        "k holds",
        "mixed: median",
        "mean",
        "k holds",
    ]);
    for (j, name) in names.iter().enumerate() {
        let mut row = vec![name.clone()];
        for model in [Some(&level.axes), level.mixed.as_ref()]
            .into_iter()
            .flatten()
        {
            row.push(percent(model.median_deviation[j]));
            row.push(percent(model.mean_deviation[j]));
            row.push(share(model.interval_share[j]));
        }
        table.row(row);
    }
    table
}

/// A share in percent, to a tenth.
fn share(fraction: Option<f64>) -> String {
    fraction.map_or_else(|| NONE.to_string(), |f| format!("{:.1}", 100.0 * f))
}
