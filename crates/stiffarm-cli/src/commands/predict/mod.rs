//! `stiffarm predict`: how far the loaded tool bends away, and how sure that is.

mod tables;

use super::finding_line;
use crate::args::PredictArgs;
use crate::files::Rows;
use crate::input::Line;
use crate::output::Exit;
use crate::path::{Outputs, PathOptions, curve};
use crate::progress::Progress;
use crate::session::Session;
use schemars::JsonSchema;
use serde::Serialize;
use std::io::Write;
use stiffarm::files::source::{NamedPath, Source};
use stiffarm::findings::Severity;
use stiffarm::model::cell::Cell;
use stiffarm::model::load::{Axes, Wrench};
use stiffarm::model::observation::PostureTerms;
use stiffarm::model::path::LoadedPosture;
use stiffarm::model::stiffness::Model;
use stiffarm::work::posture_path::PosturePathSummary;
use stiffarm::work::predict::{LoadPoint, PredictOptions, Prediction, predict};
use stiffarm::{Code, Error, Result};
use stiffarm_report::{path_figure, render_svg};
use tables::{matrices, table, write_csv};

/// Postures whose stiffness matrices are printed.
const MATRICES: usize = 2;

/// Options of the result.
#[derive(Serialize, JsonSchema)]
pub struct Options {
    /// The path, its loads and postures.
    #[serde(flatten)]
    pub path: PathOptions,
    /// How the deflection was calculated.
    pub model: Model,
    /// Where the wrenches act.
    pub load_at: LoadPoint,
}

/// The deflections and how the postures were found.
#[derive(Serialize, JsonSchema)]
pub struct Predicted {
    /// The deflections.
    #[serde(flatten)]
    pub prediction: Prediction,
    /// The postures of the path; `null` for tasks and with --cell-load.
    pub postures: Option<PosturePathSummary>,
}

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
    named.cell = under_case(named.cell, args)?;
    let options = {
        let mut options = PredictOptions::default();
        options.model = args.model.into();
        options.load_uncertainty = args.along.load_uncertainty()?;
        options.load_at = match args.cell_load {
            true => LoadPoint::LoadingPoint,
            false => LoadPoint::Tip,
        };
        options.stiffness = args.matrix;
        options
    };
    let progress = Progress::new(session, "predicting deflections");
    let (postures, summary, line, file) = match &args.path {
        None => {
            let (tip, postures) = tasks(&named.cell)?;
            named.cell.work.tip = Some(tip);
            let line = format!("path: the tasks of the cell ({})\n", postures.len());
            (postures, None, line, None)
        }
        Some(path) if args.cell_load => {
            let (name, postures) = under_cell_load(session, path, &named.cell)?;
            let line = format!(
                "postures: {name} ({}), the cell's load at its loading point\n",
                postures.len()
            );
            (postures, None, line, Some(name))
        }
        Some(path) => {
            let found =
                session.follow_path(path, &named.cell, &saved.predictor, &args.along, &progress)?;
            let line = found.line();
            (found.postures, Some(found.summary), line, Some(found.name))
        }
    };
    let cell = &named.cell;
    let prediction = progress
        .watch(|control| predict(cell, &saved.predictor, &postures, &options, control))
        .map_err(|e| match (e.place().line, file) {
            (Some(_), Some(file)) => e.file(file),
            _ => e,
        })?;
    drop(progress);
    let figure = || {
        let points = prediction.points.iter();
        let values = points.map(|p| (p.deflection_m, p.band.map(|b| b.size_m[3]), None));
        let curve = curve(values, &postures, cell);
        render_svg(&path_figure(&curve, prediction.confidence))
    };
    let on_stdout = outputs.write(
        session,
        || Ok(Rows(|out: &mut dyn Write| write_csv(&prediction, out))),
        figure,
    )?;
    let described = Options {
        path: args.along.described(),
        model: options.model,
        load_at: options.load_at,
    };
    let result = Predicted {
        prediction,
        postures: summary,
    };
    let envelope = session.envelope("predict", None, described, &result);
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
        let mut out = named.line() + &saved.line() + &line;
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
        for finding in of_path().chain(&result.prediction.findings) {
            out += &finding_line(finding);
        }
        out
    })?;
    Ok(exit)
}

/// The tasks of the cell with their tip.
pub(super) fn tasks(cell: &Cell) -> Result<(nalgebra::Isometry3<f64>, Vec<LoadedPosture>)> {
    let tasks = cell.require_tasks().map_err(|e| {
        let hint = "give a path, or add [[task]] to the cell";
        Error::new(e.code(), "No path is given, and the cell has no tasks.")
            .key("task")
            .hint(hint)
    })?;
    if let Some(other) = tasks.iter().find(|task| task.tip != tasks[0].tip) {
        let message = format!(
            "The tasks \"{}\" and \"{}\" have different tips.",
            tasks[0].name, other.name
        );
        return Err(Error::new(Code::Unsupported, message)
            .key("task")
            .hint("give each as a path of its own, with tip_mm in [work]"));
    }
    let mut tip = cell.work.tip(&cell.setup.tool);
    tip.translation = tasks[0].tip.into();
    let robot = &cell.setup.robot;
    let postures = tasks.iter().map(|task| {
        let frames = stiffarm::model::kinematics::Frames::new(robot, &task.q);
        let turn = |v| match task.axes {
            Axes::Base => v,
            Axes::Tool => frames.direction(&v),
        };
        LoadedPosture {
            name: task.name.as_str().into(),
            line: None,
            q: task.q.clone(),
            wrench: Wrench {
                force: turn(task.wrench.force),
                moment: turn(task.wrench.moment),
            },
        }
    });
    Ok((tip, postures.collect()))
}

/// The cell under the load case that is asked for.
fn under_case(cell: Cell, args: &PredictArgs) -> Result<Cell> {
    match &args.load_case {
        Some(name) => cell.under(name).map_err(|e| e.key("--load-case")),
        None if args.cell_load && cell.setup.load.has_cases() => {
            let names = cell.setup.load.case_names();
            let message = "The cell has several load cases, and postures bend under one at a time.";
            let hint = format!("add --load-case with one of them: {names}");
            Err(Error::new(Code::Usage, message)
                .key("--cell-load")
                .hint(hint))
        }
        None => Ok(cell),
    }
}

/// Postures under the cell's own load.
fn under_cell_load(
    session: &Session,
    path: &str,
    cell: &Cell,
) -> Result<(String, Vec<LoadedPosture>)> {
    let NamedPath { table, name } = session.read_path(path, cell, None)?;
    let mut postures = Vec::with_capacity(table.points.len());
    for point in table.points {
        let stiffarm::model::path::PathTarget::Angles(q) = point.target else {
            return Err(Error::new(
                Code::Unsupported,
                "With --cell-load the postures must be joint angles.",
            )
            .file(&name)
            .hint("give columns q1_deg, q2_deg, …"));
        };
        let terms = PostureTerms::new(&cell.setup, &q, None)?;
        postures.push(LoadedPosture {
            name: point.name,
            line: point.line,
            wrench: *terms.wrench(),
            q,
        });
    }
    Ok((name, postures))
}
