//! `stiffarm predict`: how far the loaded tool bends away, and how sure that is.

use super::finding_line;
use super::identify::confidence;
use crate::args::PredictArgs;
use crate::files::{Target, check_one_stdout, write_all};
use crate::numbers::{mm, significant};
use crate::output::Exit;
use crate::path::PathOptions;
use crate::progress::Progress;
use crate::session::Session;
use crate::table::{Align, Table, title};
use schemars::JsonSchema;
use serde::Serialize;
use stiffarm::cell::Cell;
use stiffarm::load::{Axes, Wrench};
use stiffarm::observation::PostureTerms;
use stiffarm::path::LoadedPosture;
use stiffarm::posture_path::PosturePathSummary;
use stiffarm::predict::{
    CartesianStiffness, LoadPoint, PointPrediction, PredictOptions, Prediction, predict,
};
use stiffarm::stiffness::Model;
use stiffarm::table::read_path;
use stiffarm::units::{m_to_shortest_mm, rad_to_deg};
use stiffarm::{Code, Error, Result};
use stiffarm_report::{PathCurvePoint, path_figure, render_svg};

/// Rows of the table on the terminal.
const SHOWN: usize = 12;
/// Postures whose stiffness matrices are printed.
const MATRICES: usize = 2;

/// Entries of a matrix below this share of the largest are rounding.
const ROUNDING: f64 = 1e-12;

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
    let output = args
        .output
        .as_deref()
        .map(|p| Target::new(p, args.force))
        .transpose()?;
    let figure = args
        .figure
        .as_deref()
        .map(|p| Target::new(p, args.force))
        .transpose()?;
    check_one_stdout(session, &[output.as_ref(), figure.as_ref()])?;
    let mut named = session.read_cell(&args.cell)?;
    let saved = session.read_stiffness(&args.stiffness, &named.cell)?;
    let options = PredictOptions {
        model: args.model.into(),
        load_uncertainty: args.along.load_uncertainty()?,
        load_at: match args.cell_load {
            true => LoadPoint::LoadingPoint,
            false => LoadPoint::Tip,
        },
        stiffness: args.matrix,
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
    let on_stdout = [&output, &figure]
        .iter()
        .any(|t| t.as_ref().is_some_and(Target::is_stdout));
    let mut files = Vec::new();
    if let Some(target) = output {
        files.push((target, csv(&prediction)));
    }
    if let Some(target) = figure {
        let points = prediction.points.iter();
        let values = points.map(|p| (p.deflection_m, p.band.map(|b| b.size_m[3]), None));
        let curve = curve(values, &postures, cell);
        files.push((
            target,
            render_svg(&path_figure(&curve, prediction.confidence)),
        ));
    }
    write_all(session, &files)?;
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
    let other = saved.is_of_another_cell(envelope.inputs.get("cell"));
    if on_stdout {
        return Ok(Exit::Done);
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
        let of_path = result.postures.iter().flat_map(|p| &p.findings);
        for finding in of_path.chain(&result.prediction.findings) {
            out += &finding_line(finding);
        }
        let names: Vec<&str> = [&args.output, &args.figure]
            .into_iter()
            .flatten()
            .map(String::as_str)
            .collect();
        if !names.is_empty() {
            out += &format!("\nwrote {}\n", names.join(" and "));
        }
        out
    })?;
    Ok(Exit::Done)
}

/// The tasks of the cell with their tip.
fn tasks(cell: &Cell) -> Result<(nalgebra::Isometry3<f64>, Vec<LoadedPosture>)> {
    let tasks = cell.require_tasks().map_err(|e| {
        let hint = "give a path, or add [[task]] to the cell";
        Error::new(e.code(), "There is no path, and the cell has no tasks.")
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
        let frames = stiffarm::kinematics::Frames::new(robot, &task.q);
        let turn = |v| match task.axes {
            Axes::Base => v,
            Axes::Tool => frames.direction(&v),
        };
        LoadedPosture {
            name: task.name.clone(),
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

/// Postures under the cell's own load.
fn under_cell_load(
    session: &Session,
    path: &str,
    cell: &Cell,
) -> Result<(String, Vec<LoadedPosture>)> {
    let (name, bytes) = session.read("path", path)?;
    let table = read_path(&bytes, &name, cell, None)?;
    let mut postures = Vec::with_capacity(table.points.len());
    for point in table.points {
        let stiffarm::path::Target::Angles(q) = point.target else {
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

/// The `count` largest, in the order of the path.
pub fn largest_first<P>(points: &[P], size: impl Fn(&P) -> f64, count: usize) -> Vec<&P> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|a, b| size(&points[*b]).total_cmp(&size(&points[*a])));
    order.truncate(count);
    order.sort_unstable();
    order.into_iter().map(|i| &points[i]).collect()
}

/// Values along the path for the figure.
pub fn curve(
    values: impl Iterator<Item = (f64, Option<f64>, Option<f64>)>,
    postures: &[LoadedPosture],
    cell: &Cell,
) -> Vec<PathCurvePoint> {
    let tip = cell.work.tip(&cell.setup.tool).translation.vector;
    let at = |posture: &LoadedPosture| {
        stiffarm::kinematics::Frames::new(&cell.setup.robot, &posture.q).point(&tip)
    };
    let mut along = 0.0;
    let mut last = None;
    postures
        .iter()
        .zip(values)
        .map(|(posture, (deflection_m, half_width_m, left_m))| {
            let position = at(posture);
            along += last.map_or(0.0, |last: nalgebra::Vector3<f64>| (position - last).norm());
            last = Some(position);
            PathCurvePoint {
                along_m: along,
                deflection_m,
                half_width_m,
                left_m,
            }
        })
        .collect()
}

fn table(result: &Prediction) -> String {
    let rows = largest_first(&result.points, |p| p.deflection_m, SHOWN);
    let mut out = match rows.len() < result.points.len() {
        true => title(&format!("The {SHOWN} largest deflections of the tip [mm]")),
        false => title("Deflection of the tip [mm]"),
    };
    let mut headings: Vec<String> = ["point", "force [N]", "x", "y", "z", "size"]
        .map(String::from)
        .into();
    if let Some(level) = result.confidence {
        headings.push(format!("± {} %", confidence(level)));
        headings.extend(["statistical", "common", "load"].map(String::from));
    }
    let mut table = Table::new(headings);
    table.align(0, Align::Left);
    for point in rows {
        let force = nalgebra::Vector3::from(point.force_n).norm();
        let mut row = vec![point.point.clone(), significant(force, 3)];
        row.extend(point.shift_m.iter().map(|v| mm(*v)));
        row.push(mm(point.deflection_m));
        if let Some(band) = &point.band {
            row.extend([3, 0, 1, 2].map(|i| mm(band.size_m[i])));
        }
        table.row(row);
    }
    out += &table.to_string();
    let largest = match result.points.len() {
        1 => String::new(),
        _ => format!(
            "\nDeflection RMS {} mm, largest {} mm at point {}.\n",
            mm(result.deflection_rms_m),
            mm(result.deflection_max_m),
            result.deflection_max_point
        ),
    };
    out += if largest.is_empty() { "\n" } else { &largest };
    if let Some(error) = result.error_rms_m {
        out += &format!(
            "RMS error that the bands stand for, all axes together: {} mm.\n",
            mm(error)
        );
    }
    out
}

/// Matrices and principal axes of one point.
fn matrices(point: &PointPrediction) -> String {
    let Some(CartesianStiffness {
        matrix,
        matrix_with_k_c,
        principal,
        ..
    }) = &point.stiffness
    else {
        return String::new();
    };
    let mut out = title(&format!(
        "Principal axes of the translational stiffness at {}",
        point.point
    ));
    let mut axes = Table::new(["axis", "stiffness [N/mm]", "x", "y", "z"]);
    for (name, axis) in ["softest", "middle", "stiffest"].iter().zip(principal) {
        let stiffness = axis.stiffness_n_per_m.map(|k| k / 1e3);
        let mut row = vec![(*name).to_string(), crate::numbers::optional(stiffness, 4)];
        row.extend(axis.direction.iter().map(|v| format!("{v:.3}")));
        axes.row(row);
    }
    out += &axes.to_string();
    for (what, matrix) in [
        ("K, Eq. (2)", matrix),
        ("K with K_C of this load", matrix_with_k_c),
    ] {
        out += &title(&format!(
            "{what} at {} [N/mm, N/mrad; N·m/mm, N·m/mrad]",
            point.point
        ));
        match matrix {
            None => out += "none: the posture is singular\n",
            Some(rows) => {
                let mut table = Table::new(["", "x", "y", "z", "about x", "about y", "about z"]);
                let largest = rows.iter().flatten().fold(0.0_f64, |m, v| m.max(v.abs()));
                for (name, row) in ["Fx", "Fy", "Fz", "Mx", "My", "Mz"].iter().zip(rows) {
                    // Newtons per millimetre and per milliradian alike.
                    let values = row.iter().map(|v| match v.abs() < ROUNDING * largest {
                        true => "0".to_string(),
                        false => significant(v / 1e3, 5),
                    });
                    table.row(std::iter::once((*name).to_string()).chain(values));
                }
                out += &table.to_string();
            }
        }
    }
    out
}

/// All points as a table.
fn csv(result: &Prediction) -> String {
    let joints = result.points.first().map_or(0, |p| p.q_deg.len());
    let mut heading: Vec<String> = vec!["point".to_string()];
    heading.extend((1..=joints).map(|j| format!("q{j}_deg")));
    let columns = [
        "tip_x_mm",
        "tip_y_mm",
        "tip_z_mm",
        "fx_n",
        "fy_n",
        "fz_n",
        "mx_nm",
        "my_nm",
        "mz_nm",
        "dx_mm",
        "dy_mm",
        "dz_mm",
        "turn_x_deg",
        "turn_y_deg",
        "turn_z_deg",
        "deflection_mm",
        "linear_difference_mm",
    ];
    heading.extend(columns.map(String::from));
    let has_band = result.points.iter().any(|p| p.band.is_some());
    if has_band {
        let band = ["statistical", "common", "load", "total"];
        heading.extend(band.map(|part| format!("{part}_half_width_mm")));
        heading.extend(["x", "y", "z"].map(|axis| format!("total_half_width_{axis}_mm")));
    }
    let mut text = heading.join(",") + "\n";
    let length = |v: f64| m_to_shortest_mm(v).to_string();
    for point in &result.points {
        let mut row = vec![quoted(&point.point)];
        row.extend(point.q_deg.iter().map(f64::to_string));
        row.extend(point.tip_m.iter().map(|v| length(*v)));
        row.extend(
            point
                .force_n
                .iter()
                .chain(&point.moment_nm)
                .map(f64::to_string),
        );
        row.extend(point.shift_m.iter().map(|v| length(*v)));
        row.extend(point.turn_rad.iter().map(|v| rad_to_deg(*v).to_string()));
        row.extend([point.deflection_m, point.linear_difference_m].map(length));
        if let Some(band) = &point.band {
            row.extend(band.size_m.iter().chain(&band.total_m).map(|v| length(*v)));
        }
        text += &(row.join(",") + "\n");
    }
    text
}

/// A name as a field of a table.
fn quoted(name: &str) -> String {
    match name.contains([',', '"', '\n', '#', ';']) {
        true => format!("\"{}\"", name.replace('"', "\"\"")),
        false => name.to_string(),
    }
}
