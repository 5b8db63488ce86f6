//! `stiffarm validate`: calculated against measured displacements, Eq. (22), at
//! postures kept out of the identification, or fold by fold without any.

use crate::answer::Answer;
use crate::args;
use crate::files::ends_in;
use crate::output::Exit;
use crate::progress::Progress;
use crate::session::Session;
use stiffarm::ask::validate::{Folds, Options, ValidateOptions, Validated};
use stiffarm::estimate::identify::Fit;
use stiffarm::estimate::validate::Model;
use stiffarm::findings::Severity;
use stiffarm::measure::{Measured, prepare};
use stiffarm::model::cell::Cell;
use stiffarm::{Code, Error, Result};
use stiffarm_files::source::{NamedCell, read_measurements, read_registration, read_stiffness};

/// Validates.
pub fn run(session: &Session, args: &args::Validate) -> Result<Answer> {
    let request = &args.options;
    request.check()?;
    match (&args.stiffness, request.folds) {
        (Some(stiffness), None) => held_out(session, args, request, stiffness),
        (None, Some(folds)) => cross(session, args, request, &args.measurements, folds),
        (None, None) => Err(Error::new(Code::Usage, "There is no joint stiffness to validate.")
            .hint("give the file that `stiffarm identify --output` wrote before the measurements, or --folds")),
        // A table of measurements before others is no stiffness.
        (Some(first), Some(folds)) if !ends_in(first, "json") => {
            let first = std::slice::from_ref(first);
            let from = [first, &args.measurements].concat();
            cross(session, args, request, &from, folds)
        }
        (Some(_), Some(_)) => Err(Error::new(
            Code::Usage,
            "With --folds the stiffness is identified anew in each fold, so no file of stiffness can be given.",
        )
        .key("--folds")
        .hint("give the cell and the measurements alone")),
    }
}

/// Validates a saved stiffness.
fn held_out(session: &Session, args: &args::Validate, request: &ValidateOptions, stiffness: &str) -> Result<Answer> {
    request.fit.refuse()?;
    let named = session.read_cell(&args.cell)?;
    let saved = read_stiffness(session, stiffness, &named.cell)?;
    let measured = measured(session, args, request, &args.measurements, &named.cell)?;
    let hash = session.last_hash("cell");
    let result = request.held_out(&named.cell, hash.as_deref(), &saved, measured)?;
    answer(session, args, named, request.options(None), result)
}

/// Predicts each posture from fits without it.
fn cross(
    session: &Session,
    args: &args::Validate,
    request: &ValidateOptions,
    from: &[String],
    folds: Folds,
) -> Result<Answer> {
    if request.model != Model::Linear {
        return Err(Error::new(Code::Unsupported, "With --folds only the linear model can be used.").key("--model"));
    }
    let named = session.read_cell(&args.cell)?;
    let fit = request.fit.options(&named.cell.setup.robot)?;
    let measured = measured(session, args, request, from, &named.cell)?;
    let progress = Progress::new(session, "predicting each posture");
    let (result, described) = Fit::watched(&named.cell, measured, &fit, progress.shared())
        .and_then(|fit| request.by_folds(&fit, folds))
        .map_err(|e| match e.code() {
            Code::InvalidValue => e.key("--folds"),
            _ => e,
        })?;
    drop(progress);
    let options = request.options(Some(described));
    answer(session, args, named, options, result)
}

fn answer(
    session: &Session,
    args: &args::Validate,
    named: NamedCell,
    options: Options,
    result: Validated,
) -> Result<Answer> {
    let mut remarks = result.remarks.iter();
    let validation = &result.validation;
    let exit = Exit::finding(
        validation.passed == Some(false)
            || !validation.unpredicted.is_empty()
            || remarks.any(|f| f.severity == Severity::Serious),
    );
    let envelope = session.envelope("validate", None, options, result);
    Ok(Answer::summary(exit, envelope, named, args.details))
}

/// The measurements, or those of `--only`.
fn measured(
    session: &Session,
    args: &args::Validate,
    request: &ValidateOptions,
    from: &[String],
    cell: &Cell,
) -> Result<Measured> {
    let measurements = read_measurements(session, from, args.postures.as_deref(), cell)?;
    let reduce = read_registration(session, args.registration.as_deref())?;
    let mut measured = prepare(cell, measurements, &reduce)?;
    request.keep_only(&mut measured)?;
    Ok(measured)
}
