//! `stiffarm compensate`: the path to command so that the loaded tool follows
//! the nominal one.

use super::{finding_line, others_last, serious_first};
use crate::args::{CompensateArgs, WriteChoice};
use crate::input::Line;
use crate::numbers::{confidence, mm, times};
use crate::output::Exit;
use crate::path::{Outputs, curve, largest_first, of_path_usage, path_line};
use crate::progress::Progress;
use crate::session::Session;
use crate::table::{Align, Table, title};
use stiffarm::Result;
use stiffarm::estimate::compliance::IdentifiedCompliance;
use stiffarm::files::source::Source;
use stiffarm::files::table::{PathFormat, PathKind, PathTable, write_path};
use stiffarm::findings::{Finding, Severity};
use stiffarm::model::cell::Cell;
use stiffarm::model::path::{PathPoint, PathTarget as Aim};
use stiffarm::units::{deg_to_rad, rad_to_shortest_deg};
use stiffarm::work::compensate::{Compensation, PointCompensation};
use stiffarm::work::compensated::{Compensated, Options};
use stiffarm::work::predict::LoadedArm;
use stiffarm_report::{path_figure, render_svg};

/// Rows of the table on the terminal.
const SHOWN: usize = 12;

/// Compensates.
pub fn run(session: &Session, args: &CompensateArgs) -> Result<Exit> {
    let outputs = Outputs::new(
        session,
        args.output.as_deref(),
        args.figure.as_deref(),
        args.force,
    )?;
    let named = session.read_cell(&args.cell)?;
    let cell = &named.cell;
    let saved = session.read_stiffness(&args.stiffness, cell)?;
    let options = Options {
        path: args.along.options(),
    };
    let wrong = options.compensate_options(&saved).map(|_| ());
    wrong
        .and_then(|()| options.path.posture_options(cell))
        .map_err(of_path_usage)?;
    let path = session.read_path(&args.path, cell, options.path.axes)?;
    let progress = Progress::new(session, "compensating the path");
    let (followed, result) = progress
        .watch(|control| {
            let points = &path.table.points;
            let followed = options
                .path
                .follow(cell, &saved.predictor, points, control)?;
            let result = options.compensate(cell, &saved, &followed, control)?;
            Ok((followed, result))
        })
        .map_err(|e| path.in_file(e))?;
    drop(progress);
    let found = &result.compensation;
    let figure = || {
        let values = found.points.iter().map(|p| {
            let half = p.band.map(|b| b.size_m[3]);
            (
                p.uncompensated_m,
                half,
                Some(p.residual_m + half.unwrap_or_default()),
            )
        });
        let curve = curve(values, &followed.postures, cell);
        render_svg(&path_figure(&curve, found.confidence))
    };
    let table = || commanded(cell, &saved.predictor, &path.table, found, args.write);
    let objections = objections(&result);
    let wanted = args.output.is_some() || args.figure.is_some();
    let withheld = wanted && !args.beyond_data && !objections.is_empty();
    let on_stdout = match withheld {
        true => false,
        false => outputs.write(session, table, figure)?,
    };
    let envelope = session.envelope("compensate", None, options, &result);
    let other = saved.is_of_another_cell(envelope.inputs.get("cell").map(String::as_str));
    let exit =
        Exit::finding(withheld || findings(&result).any(|f| f.severity == Severity::Serious));
    if on_stdout {
        session.write_page(&envelope)?;
        session.remark_serious(findings(&result));
        return Ok(exit);
    }
    if withheld && session.json {
        session.print_error(&refusal(&objections));
    }
    session.show(&envelope, || {
        let mut out = serious_first(findings(&result), finding_line);
        let shown = |finding: &&Finding| !withheld || !objections.contains(finding);
        if withheld {
            let other = objections
                .iter()
                .filter(|f| f.severity != Severity::Serious);
            out += &refusal(&other.copied().collect::<Vec<_>>());
        }
        out += &(named.line()
            + &saved.line()
            + &path_line(&path.name, &result.postures, followed.postures.len()));
        if other {
            out += "note: the stiffness was identified with another version of this cell\n";
        }
        out + &corrections(&result.compensation)
            + &others_last(findings(&result).filter(shown))
            + match wanted {
                false => "\n`--output commanded.csv` writes the path to command.\n",
                true => "",
            }
    })?;
    Ok(exit)
}

/// All findings of a result.
fn findings(result: &Compensated) -> impl Iterator<Item = &Finding> + Clone {
    let of_path = result.postures.findings.iter();
    of_path.chain(&result.compensation.findings)
}

/// What speaks against commanding the path.
fn objections(result: &Compensated) -> Vec<&Finding> {
    let of_path = result.postures.findings.iter();
    let serious = of_path.filter(|f| f.severity == Severity::Serious);
    serious.chain(result.compensation.objections()).collect()
}

/// That nothing was written, and why.
fn refusal(objections: &[&Finding]) -> String {
    let why: String = objections.iter().map(|f| finding_line(f)).collect();
    why + "Nothing was written; `--beyond-data` writes it all the same.\n"
}

/// The path to command, in the columns of the path or as `write` says.
fn commanded(
    cell: &Cell,
    predictor: &IdentifiedCompliance,
    table: &PathTable,
    result: &Compensation,
    write: Option<WriteChoice>,
) -> Result<String> {
    let read: &PathFormat = &table.format;
    let format = match write {
        None => read.clone(),
        Some(WriteChoice::Angles) => read.clone().angles(cell),
        Some(WriteChoice::Poses) => read.clone().poses(cell),
    };
    let arm = LoadedArm::new(cell, predictor)?;
    let points = table
        .points
        .iter()
        .zip(&result.points)
        .map(|(point, found)| {
            // The angles as the result writes them.
            let command = found.command.iter();
            let q: Vec<f64> = command
                .map(|q| deg_to_rad(rad_to_shortest_deg(*q)))
                .collect();
            PathPoint {
                target: match format.kind() {
                    PathKind::Angles => Aim::Angles(q),
                    _ => Aim::Pose(arm.tip_pose(&q)),
                },
                ..point.clone()
            }
        });
    write_path(&format, points)
}

fn corrections(result: &Compensation) -> String {
    let rows = largest_first(&result.points, |p| p.correction_size_m, SHOWN);
    let mut out = match rows.len() < result.points.len() {
        true => title(&format!("The {SHOWN} largest corrections [mm]")),
        false => title("Corrections [mm]"),
    };
    let mut headings = vec![
        "point",
        "without",
        "correction x",
        "y",
        "z",
        "left by the model",
    ];
    let band = result.confidence.map(|c| format!("± {} %", confidence(c)));
    headings.extend(band.as_deref());
    let mut table = Table::new(headings);
    table.align(0, Align::Left);
    for PointCompensation {
        point,
        uncompensated_m,
        correction_m: c,
        residual_m,
        band,
        ..
    } in rows
    {
        let mut row = vec![point.to_string(), mm(*uncompensated_m)];
        row.extend(c.iter().map(|v| mm(*v)));
        row.push(tiny(*residual_m));
        row.extend(band.map(|b| mm(b.size_m[3])));
        table.row(row);
    }
    out += &table.to_string();
    out += &format!(
        "\nWithout compensation: deflection RMS {} mm, largest {} mm.\nWith it, by the same model: RMS {} mm, largest {} mm.\n",
        mm(result.uncompensated_rms_m),
        mm(result.uncompensated_max_m),
        tiny(result.residual_rms_m),
        tiny(result.residual_max_m)
    );
    if let (Some(error), Some(factor)) = (result.error_rms_m, result.expected_factor) {
        out += &format!(
            "Expected on the arm, as far as the bands know: RMS {} mm, {} than without.\n",
            mm(error),
            times(factor, 2, ["less", "more"])
        );
    }
    out
}

/// Lengths far below what anybody measures.
fn tiny(m: f64) -> String {
    match m < 1e-9 {
        true => "< 1e-6".to_string(),
        false => mm(m),
    }
}
