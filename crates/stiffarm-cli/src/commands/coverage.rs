//! `stiffarm coverage`: how often the intervals of `identify` hold the truth, counted in simulated experiments.

use crate::answer::Answer;
use crate::args::CoverageArgs;
use crate::numbers::to_usize;
use crate::output::Exit;
use crate::progress::Progress;
use crate::session::Session;
use stiffarm::estimate::coverage::{CoverageCase, ErrorModel, Options, coverage};
use stiffarm::{Code, Error, Result};
use stiffarm_files::source::read_postures;

/// Counts.
pub fn run(session: &Session, args: &CoverageArgs) -> Result<Answer> {
    if args.fit.elastic.is_some() {
        let message = "Coverage is counted for springs at the joint axes.";
        let error = Error::new(Code::Usage, message).key("--elastic");
        return Err(error.hint("`simulate --elastic` counts what the mixed model holds"));
    }
    let named = session.read_cell(&args.cell)?;
    let robot = &named.cell.setup.robot;
    let postures = read_postures(session, "postures", &args.postures, robot)?;
    let options = args.fit.options(robot)?;
    let described = Options {
        runs: args.runs,
        confidence: options.confidence,
        estimator: options.estimator.as_str().to_string(),
        bootstrap: args.bootstrap,
    };
    let case = CoverageCase {
        experiments: to_usize(args.runs),
        seed: args.seed,
        resamples: args.bootstrap.map(to_usize),
        options,
        world: ErrorModel {
            common_ratio: named.cell.noise.common_ratio().sqrt(),
            ..ErrorModel::default()
        },
    };
    let found = Progress::new(session, "counting")
        .watch(|control| coverage(&named.cell, &postures, &case, control))?;
    let exit = Exit::of_findings(&found.findings);
    let envelope = session.envelope("coverage", Some(args.seed), described, found);
    Ok(Answer::told(exit, envelope, named, false))
}
