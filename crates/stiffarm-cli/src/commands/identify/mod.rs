//! `stiffarm identify`: joint stiffness from measured displacements or raw readings.

pub mod clamped;
mod elastic;
mod messages;
mod next;
pub mod readings;
mod summary;
mod tables;

pub use messages::confidence;

use crate::args::IdentifyArgs;
use crate::error::of_option;
use crate::files::only_target;
use crate::output::Exit;
use crate::progress::Progress;
use crate::screen::{columns, wrapped};
use crate::session::Session;
use crate::table::title;
use stiffarm::Result;
use stiffarm::estimate::identified::{Identified, Options, Wanted};
use stiffarm::estimate::identify::{Fit, implausible_scale};
use stiffarm::files::source::Source;
use stiffarm::findings::Severity;
use stiffarm::measure::prepare;

/// Identifies the joint stiffness.
pub fn run(session: &Session, args: &IdentifyArgs) -> Result<Exit> {
    if args.clamped {
        return clamped::run(session, args);
    }
    let target = only_target(session, args.output.as_deref(), args.force)?;
    let named = session.read_cell(&args.cell)?;
    let options = args.fit.options(&named.cell.setup.robot)?;
    let measurements =
        session.read_measurements(&args.measurements, args.postures.as_deref(), &named.cell)?;
    let reduce = session.read_registration(args.registration.as_deref())?;
    let mut measured = prepare(&named.cell, measurements, &reduce)?;
    measured
        .exclude(&args.exclude)
        .map_err(|e| e.key("--exclude"))?;
    let serious = measured.worst() == Some(Severity::Serious);
    let progress = Progress::new(session, "examining the identification");
    let fit = Fit::watched(&named.cell, measured, &options, progress.shared())?;
    let wanted = {
        let mut wanted = Wanted::default();
        wanted.bootstrap = args.bootstrap;
        wanted.elastic = args.fit.elastic();
        wanted.seed = args.seed;
        wanted.brief = args.brief;
        wanted
    };
    let result = progress
        .watch(|control| Identified::new(&fit, &wanted, control))
        .map_err(|e| of_option(e, &["bootstrap", "elastic"]))?;
    drop(progress);

    let implausible = implausible_scale(fit.cell(), &result.identification).is_some();
    let exit = match result.not_computed.is_empty() {
        true => {
            Exit::finding(!result.identification.estimates.is_complete() || implausible || serious)
        }
        false => Exit::Interrupted,
    };
    let elastic = args.fit.elastic.map(Into::into);
    let described = Options::new(&options, &wanted, elastic, &args.exclude);
    let envelope = session.envelope("identify", Some(args.seed), described, &result);
    let table = || {
        let out = summary::summary(&named, &fit, &result, &args.exclude, args.details);
        match args.details {
            true => out + &details(&fit, &result),
            false => out,
        }
    };
    session.deliver(target, &envelope, table)?;
    Ok(exit)
}

/// Everything beside the summary.
fn details(fit: &Fit, result: &Identified) -> String {
    let found = &result.identification;
    let mut out = String::new();
    let columns = columns();
    let sentence = |text: &str| format!("{}\n", wrapped(text, columns));
    if result.readings.is_some() || result.sanity.is_some() {
        out += &title("Readings");
        let lines = readings::summary(fit.measured());
        lines.lines().for_each(|line| out += &sentence(line));
    }
    out += &title("Intervals of the joint stiffness by the scatter of the readings");
    let shared = &found.estimates;
    let (budget, bootstrap) = (result.budget.as_ref(), result.bootstrap.as_ref());
    out += &tables::estimates(shared, budget, bootstrap).to_string();
    out += &tables::further(shared);
    out.push('\n');
    for text in messages::verdicts(result) {
        out += &sentence(&text);
    }
    if let Some(budget) = &result.budget {
        out += &title("Systematic errors: change of k [%]");
        out += &tables::common(budget).to_string();
    }
    if let Some(diagnosis) = &result.diagnosis {
        out += &title("What each joint carries");
        out += &tables::signals(&diagnosis.signals).to_string();
        if let Some(trials) = diagnosis.terms.as_ref().filter(|t| !t.trials.is_empty()) {
            out += &title("Further terms, each tried alone");
            out += &tables::trials(trials).to_string();
        }
    }
    if !found.weights.is_empty() {
        out += &tables::weights(found);
    }
    out += &title("Postures with the largest residuals");
    out += &tables::residuals(result).to_string();
    out + &next::next(fit.cell(), result)
}
