//! `stiffarm compensate`: the path to command so that the loaded tool follows
//! the nominal one.

use crate::args::{CompensateArgs, WriteChoice};
use crate::output::Exit;
use crate::path::{Outputs, of_path_usage, read_stiffness};
use crate::progress::Progress;
use crate::session::Session;
use stiffarm::Result;
use stiffarm::estimate::compliance::IdentifiedCompliance;
use stiffarm::files::source::Source;
use stiffarm::files::table::{PathFormat, PathKind, PathTable, write_path};
use stiffarm::findings::Severity;
use stiffarm::model::cell::Cell;
use stiffarm::model::path::{PathPoint, PathTarget as Aim};
use stiffarm::units::{deg_to_rad, rad_to_shortest_deg};
use stiffarm::work::compensate::Compensation;
use stiffarm::work::compensated::{Compensated, Options};
use stiffarm::work::predict::LoadedArm;
use stiffarm_report::{compensation_figure, render_svg};

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
    let saved = read_stiffness(session, &args.stiffness, cell)?;
    let options = Options {
        path: args.along.options(),
    };
    let wrong = options.compensate_options(&saved).map(|_| ());
    wrong
        .and_then(|()| options.path.posture_options(cell))
        .map_err(of_path_usage)?;
    let path = session.read_path(&args.path, cell, options.path.axes)?;
    let progress = Progress::new(session, "compensating the path");
    let result = progress
        .watch(|control| {
            let points = &path.table.points;
            let followed = options
                .path
                .follow(cell, &saved.predictor, points, control)?;
            options.compensate(cell, &saved, &followed, control)
        })
        .map_err(|e| path.in_file(e))?;
    drop(progress);
    let found = &result.compensation;
    let figure = || render_svg(&compensation_figure(found));
    let table = || commanded(cell, &saved.predictor, &path.table, found, args.write);
    let wanted = args.output.is_some() || args.figure.is_some();
    let withheld = wanted && !args.beyond_data && is_objected(&result);
    if withheld {
        session.print_error(
            "Nothing was written: the findings say why. `--beyond-data` writes it all the same.\n",
        );
    } else {
        outputs.write(session, table, figure)?;
    }
    let exit = session.deliver_at_work(
        session.envelope("compensate", None, options, result),
        |result| &mut result.compensation.points,
        (&named, &saved),
        args.details,
    )?;
    Ok(if withheld { Exit::Finding } else { exit })
}

/// Whether something speaks against commanding the path.
fn is_objected(result: &Compensated) -> bool {
    let mut of_path = result.postures.findings.iter();
    of_path.any(|f| f.severity == Severity::Serious)
        || result.compensation.objections().next().is_some()
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
