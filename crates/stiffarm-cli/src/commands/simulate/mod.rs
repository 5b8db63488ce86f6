//! `stiffarm simulate`: Monte Carlo of identifications with tracker noise.

pub mod elastic;
mod slowly;

use crate::answer::Answer;
use crate::args;
use crate::files::{Contents, Files, check_targets};
use crate::output::Exit;
use crate::progress::Progress;
use crate::session::Session;
use crate::target::Target;
use slowly::{check_slowly, write_slowly};
use stiffarm::Result;
use stiffarm::ask::simulate::Options;
use stiffarm::estimate::elastic::ElasticChoice;
use stiffarm::estimate::simulate::simulate;
use stiffarm::estimate::validate::{Model, simulate_measurements};
use stiffarm::measure::experiment::{Experiment, experiment};
use stiffarm_files::source::read_groups;
use stiffarm_files::table::{write_simulated, write_simulated_readings};

/// Runs the simulation.
pub fn run(session: &Session, args: &args::Simulate) -> Result<Answer> {
    if args.options.elastic() != ElasticChoice::Axes {
        return elastic::run(session, args);
    }
    let target_of = |path: &Option<String>| path.as_deref().map(|path| Target::new(path, args.force)).transpose();
    let displacements = target_of(&args.measurements)?;
    let readings = target_of(&args.readings)?;
    check_targets(session, &[displacements.as_ref(), readings.as_ref()])?;
    check_slowly(args.slowly, readings.as_ref())?;
    let options = args.options.simulation_options()?;
    let named = session.read_cell(&args.cell)?;
    let cell = &named.cell;
    let groups = read_groups(session, &args.postures, &cell.setup.robot)?;
    let result = Progress::new(session, "simulating").watch(|control| simulate(cell, &groups, &options, control))?;

    let (truth, first) = (cell.require_prior()?, &groups[0].postures);
    let mut files: Vec<(Target, Box<dyn Contents>)> = Vec::new();
    if let Some(target) = displacements {
        let model = Model::Equilibrium;
        let measured = simulate_measurements(cell, first, truth, model, args.options.seed, 0)?;
        files.push((target, Box::new(write_simulated(measured, cell))));
    }
    if let Some(target) = readings {
        let done = Experiment::as_measured(cell);
        let table = experiment(cell, first, truth, &done, args.options.seed, 0)?;
        let text = write_simulated_readings(table, cell);
        let left = match args.slowly {
            Some(pause) => write_slowly(session, target, text, pause),
            None => Some((target, text)),
        };
        if let Some((target, text)) = left {
            files.push((target, Box::new(text)));
        }
    }
    let options = Options::from(&options);
    let exit = Exit::so_far(result.interrupted || session.stopped(), &result.findings);
    let envelope = session.envelope("simulate", Some(args.options.seed), options, result);
    Ok(Answer::summary(exit, envelope, named, args.details).with(Files::new(files)))
}
