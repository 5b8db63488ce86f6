//! `stiffarm predict`: how far the loaded tool bends away, and how sure that is.

mod tables;

use super::{finding_line, others_last, serious_first};
use crate::args::PredictArgs;
use crate::error::{of_option, of_usage};
use crate::files::Rows;
use crate::input::Line;
use crate::output::Exit;
use crate::path::{Outputs, curve, of_path_usage, path_line};
use crate::progress::Progress;
use crate::session::Session;
use std::io::Write;
use stiffarm::files::source::Source;
use stiffarm::findings::Severity;
use stiffarm::work::predicted::Request;
use stiffarm::{Error, Result};
use stiffarm_report::{path_figure, render_svg};
use tables::{matrices, table, write_csv};

/// Postures whose stiffness matrices are printed.
const MATRICES: usize = 2;

/// Predicts.
pub fn run(session: &Session, args: &PredictArgs) -> Result<Exit> {
    let outputs = Outputs::new(
        session,
        args.output.as_deref(),
        args.figure.as_deref(),
        args.force,
    )?;
    let mut named = session.read_cell(&args.cell)?;
    let saved = session.read_stiffness(&args.stiffness, &named.cell)?;
    let request = Request {
        path: args.along.options(),
        model: args.model.into(),
        matrix: args.matrix,
        cell_load: args.cell_load,
        load_case: args.load_case.clone(),
    };
    named.cell = request
        .under_case(named.cell)
        .map_err(|e| of_usage(of_option(e, &["load_case"]), &["cell_load", "load_case"]))?;
    request.predict_options(&saved).map_err(of_path_usage)?;
    if args.path.is_some() && !args.cell_load {
        let wrong = request.path.posture_options(&named.cell);
        wrong.map_err(of_path_usage)?;
    }
    let path = args.path.as_ref();
    let path = path
        .map(|path| session.read_path(path, &named.cell, request.path.axes))
        .transpose()?;
    let progress = Progress::new(session, "predicting deflections");
    let points = path.as_ref().map(|path| path.table.points.as_slice());
    let in_file = |e: Error| match &path {
        Some(path) if e.place().key.as_deref() == Some("cell_load") => Error::new(
            e.code(),
            "With --cell-load the postures must be joint angles.",
        )
        .file(&path.name)
        .hint(e.hint_text().unwrap_or_default()),
        Some(path) => path.in_file(e),
        None => e,
    };
    let predictor = &saved.predictor;
    let (loaded, result) = progress
        .watch(|control| {
            let loaded = request.loaded(named.cell.clone(), predictor, points, control)?;
            let result = request.predict(&loaded, &saved, control)?;
            Ok((loaded, result))
        })
        .map_err(in_file)?;
    drop(progress);
    named.cell = loaded.cell;
    let postures = loaded.postures;
    let line = match (&path, &result.postures) {
        (None, _) => format!("path: the tasks of the cell ({})\n", postures.len()),
        (Some(path), Some(summary)) => path_line(&path.name, summary, postures.len()),
        (Some(path), None) => format!(
            "postures: {} ({}), the cell's load at its loading point\n",
            path.name,
            postures.len()
        ),
    };
    let (cell, prediction) = (&named.cell, &result.prediction);
    let figure = || {
        let points = prediction.points.iter();
        let values = points.map(|p| (p.deflection_m, p.band.map(|b| b.size_m[3]), None));
        let curve = curve(values, &postures, cell);
        render_svg(&path_figure(&curve, prediction.confidence))
    };
    let on_stdout = outputs.write(
        session,
        || Ok(Rows(|out: &mut dyn Write| write_csv(prediction, out))),
        figure,
    )?;
    let envelope = session.envelope("predict", None, request.options(), &result);
    let other = saved.is_of_another_cell(envelope.inputs.get("cell").map(String::as_str));
    let of_path = || result.postures.iter().flat_map(|p| &p.findings);
    let mut findings = of_path().chain(&result.prediction.findings);
    let exit = Exit::finding(findings.any(|f| f.severity == Severity::Serious));
    if on_stdout {
        session.write_page(&envelope)?;
        let findings = of_path().chain(&result.prediction.findings);
        session.remark_serious(findings);
        return Ok(exit);
    }
    session.show(&envelope, || {
        let findings = || of_path().chain(&result.prediction.findings);
        let mut out = serious_first(findings(), finding_line);
        out += &(named.line() + &saved.line() + &line);
        if other {
            out += "note: the stiffness was identified with another version of this cell\n";
        }
        out += &table(&result.prediction);
        for point in result
            .prediction
            .points
            .iter()
            .filter(|_| args.matrix)
            .take(MATRICES)
        {
            out += &matrices(point);
        }
        out + &others_last(findings())
    })?;
    Ok(exit)
}
