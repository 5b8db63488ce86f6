//! `stiffarm predict`: how far the loaded tool bends away, and how sure that is.

use crate::answer::Answer;
use crate::args;
use crate::files::Rows;
use crate::output::Exit;
use crate::path::{Outputs, read_stiffness};
use crate::progress::Progress;
use crate::session::Session;
use std::io::Write;
use std::mem::take;
use std::rc::Rc;
use stiffarm::{Error, Result};
use stiffarm_files::source::read_path;
use stiffarm_report::{prediction_figure, render_svg};

/// Predicts.
pub fn run(session: &Session, args: &args::Predict) -> Result<Answer> {
    let outputs = Outputs::new(session, args.output.as_deref(), args.figure.as_deref(), args.force)?;
    let mut named = session.read_cell(&args.cell)?;
    let saved = read_stiffness(session, &args.stiffness, &named.cell)?;
    let request = &args.options;
    named.cell = request.under_case(named.cell)?;
    request.at_work(&saved)?;
    if args.path.is_some() && !request.cell_load {
        let wrong = request.path.posture_options(&named.cell);
        wrong?;
    }
    let path = args.path.as_ref();
    let (axes, log) = (request.path.axes, args.along.log.as_deref());
    let mut path =
        path.map(|path| read_path(session, path, &named.cell, args.along.language, axes, log)).transpose()?;
    let points = path.as_mut().map(|path| take(&mut path.table.points));
    let in_file = |e: Error| match &path {
        Some(path) if e.place().key.as_deref() == Some("cell_load") => {
            Error::new(e.code(), "With --cell-load the postures must be joint angles.")
                .file(&path.name)
                .hint(e.hint_text().unwrap_or_default())
        }
        Some(path) => path.in_file(e),
        None => e,
    };
    let predictor = &saved.predictor;
    let (cell, mut result) = Progress::new(session, "predicting deflections")
        .watch(|control| {
            let loaded = request.loaded(named.cell.clone(), predictor, points.as_deref(), control)?;
            // A path may have millions of points.
            drop(points);
            let result = request.predict(&loaded, &saved, control)?;
            Ok((loaded.cell, result))
        })
        .map_err(in_file)?;
    named.cell = cell;
    if let (Some(summary), Some(path)) = (&mut result.postures, &path) {
        summary.findings.extend(path.findings.iter().cloned());
    }
    let envelope = Rc::new(session.envelope("predict", None, request.clone(), result));
    let result = &envelope.result;
    let workpiece = result.postures.as_ref().map(|_| &named.cell.work.workpiece);
    let table = Rc::clone(&envelope);
    let rows = move |out: &mut dyn Write| table.result.prediction.write_csv(out);
    let files =
        outputs.files(|| Ok(vec![Rows(rows)]), || render_svg(&prediction_figure(&result.prediction, workpiece)))?;
    let findings = result.every_finding();
    let made_with = (named, &saved);
    let exit = Exit::of_findings(&findings);
    let answer = Answer::at_work(exit, envelope, &findings, made_with, args.details);
    Ok(answer.with(files))
}
