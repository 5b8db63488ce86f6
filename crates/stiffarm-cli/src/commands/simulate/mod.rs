//! `stiffarm simulate`: Monte Carlo of identifications with tracker noise.

pub mod elastic;
mod slowly;

use crate::args::SimulateArgs;
use crate::error::of_usage;
use crate::files::{Target, check_targets, write_all};
use crate::input::Line;
use crate::numbers::{percent, percent_with_error};
use crate::output::Exit;
use crate::progress::Progress;
use crate::session::Session;
use crate::table::{Table, red, title};
use slowly::write_slowly;
use stiffarm::Result;
use stiffarm::estimate::elastic::ElasticChoice;
use stiffarm::estimate::simulate::{GroupSimulation, LevelResult, Simulation, simulate};
use stiffarm::estimate::simulated::Options;
use stiffarm::estimate::validate::{Model, simulate_measurements};
use stiffarm::files::source::Source;
use stiffarm::files::table::{write_displacements, write_readings};
use stiffarm::measure::experiment::{Experiment, experiment};
use stiffarm::model::cell::Cell;
use stiffarm::units::m_to_mm;

/// What is asked for that has a size.
const SIZES: [&str; 6] = [
    "levels",
    "force_scale_percent",
    "force_percent",
    "joint_angle_deg",
    "loading_point_mm",
    "anchor_mm",
];

/// Runs the simulation.
pub fn run(session: &Session, args: &SimulateArgs) -> Result<Exit> {
    if args.elastic() != ElasticChoice::Axes {
        return elastic::run(session, args);
    }
    let target_of = |path: &Option<String>| {
        path.as_deref()
            .map(|path| Target::new(path, args.force))
            .transpose()
    };
    let displacements = target_of(&args.measurements)?;
    let readings = target_of(&args.readings)?;
    check_targets(session, &[displacements.as_ref(), readings.as_ref()])?;
    let options = args
        .request()
        .simulation_options()
        .map_err(|e| of_usage(e, &SIZES))?;
    let named = session.read_cell(&args.cell)?;
    let cell = &named.cell;
    let groups = session.read_groups(&args.postures, &cell.setup.robot)?;
    let progress = Progress::new(session, "simulating");
    let result = progress.watch(|control| simulate(cell, &groups, &options, control))?;
    drop(progress);

    let to_stdout = [&displacements, &readings]
        .into_iter()
        .flatten()
        .any(Target::is_stdout);
    let (truth, first) = (cell.require_prior()?, &groups[0].postures);
    let mut files = Vec::new();
    if let Some(target) = displacements {
        let model = Model::Equilibrium;
        let measured = simulate_measurements(cell, first, truth, model, args.seed, 0)?;
        files.push((target, write_displacements(&measured, cell)));
    }
    if let Some(target) = readings {
        let done = Experiment::as_measured(cell);
        let table = experiment(cell, first, truth, &done, args.seed, 0)?;
        let text = write_readings(&table, cell);
        match args.slowly {
            Some(pause) => write_slowly(session, &target, &text, pause)?,
            None => files.push((target, text)),
        }
    }
    write_all(session, &files)?;
    let table = || named.line() + &table(cell, &result, !options.model_errors.is_exact());
    let envelope = session.envelope(
        "simulate",
        Some(args.seed),
        Options::from(&options),
        &result,
    );
    if to_stdout {
        session.write_page(&envelope)?;
        session.remark(&table());
    } else {
        session.show(&envelope, table)?;
    }
    Ok(match result.interrupted || session.stopped() {
        true => Exit::Interrupted,
        false => Exit::Done,
    })
}

fn table(cell: &Cell, result: &Simulation, model_errors: bool) -> String {
    let runs = match result.interrupted {
        true => "runs made".to_string(),
        false => format!("{} runs made", result.runs),
    };
    let mut out = format!(
        "deviation |k̂ − k|/k in %, mean of the {runs} ± Monte Carlo standard error; expected: closed form, first order\n"
    );
    if result.interrupted {
        let levels = || result.groups.iter().flat_map(|g| &g.levels);
        let fewest = levels().map(|level| level.runs).min().unwrap_or(0);
        out += &format!(
            "{} after {fewest} of {} runs at the level with the fewest; each row holds the runs made\n",
            red("stopped"),
            result.runs
        );
    }
    if model_errors {
        out += "simulated with errors of the model, which the expected values do not hold\n";
    }
    for group in &result.groups {
        out += &title(&group.name);
        out += &group_table(cell, group, &result.joints).to_string();
    }
    let flagged = result
        .groups
        .iter()
        .flat_map(|g| &g.levels)
        .any(|l| l.beyond_first_order.contains(&true));
    if flagged {
        out += "\n* median instead of the mean: the relative standard error is above 10 %, where single runs near a \
                compliance of zero dominate the mean and the closed form no longer holds. The expectation of |k̂ − k|/k is \
                infinite at every noise level; means are truncated, of the runs made\n";
    }
    out
}

fn group_table(cell: &Cell, group: &GroupSimulation, joints: &[String]) -> Table {
    let headings = ["variance", "noise [mm]", ""].into_iter().map(String::from);
    let mut table = Table::new(
        headings
            .chain(joints.iter().cloned())
            .chain(["mean".to_string()]),
    );
    table.align(2, crate::table::Align::Left);
    table.lead(3);
    for level in &group.levels {
        let factor = format!("× {}", level.variance_factor);
        let noise = format!(
            "{:.4}",
            m_to_mm(cell.noise.displacement_std()) * level.variance_factor.sqrt()
        );
        let mut simulated = vec![factor, noise, "simulated".to_string()];
        simulated.extend((0..joints.len()).map(|j| simulated_value(level, j)));
        let flagged = level.beyond_first_order.contains(&true);
        simulated.push(if flagged {
            String::new()
        } else {
            percent(mean(&level.mean_deviation))
        });
        table.row(simulated);
        let mut expected = vec![String::new(), String::new(), "expected".to_string()];
        expected.extend(level.expected_deviation.iter().map(|d| percent(*d)));
        expected.push(percent(mean(&level.expected_deviation)));
        table.row(expected);
    }
    table
}

/// Mean ± its standard error, or the marked median where single runs dominate it.
fn simulated_value(level: &LevelResult, j: usize) -> String {
    if level.beyond_first_order[j] {
        return format!("{} *", percent(level.median_deviation[j]));
    }
    percent_with_error(level.mean_deviation[j], level.standard_error[j])
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}
