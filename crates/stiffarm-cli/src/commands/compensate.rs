//! `stiffarm compensate`: the path to command so that the loaded tool follows
//! the nominal one.

use crate::answer::Answer;
use crate::args;
use crate::args::WriteChoice;
use crate::output::Exit;
use crate::path::{Outputs, read_stiffness};
use crate::progress::Progress;
use crate::session::Session;
use std::path::Path;
use std::rc::Rc;
use stiffarm::ask::compensate::Compensated;
use stiffarm::estimate::compliance::IdentifiedCompliance;
use stiffarm::findings::Severity;
use stiffarm::model::cell::Cell;
use stiffarm::model::path::{PathPoint, PathTarget as Aim};
use stiffarm::units::{deg_to_rad, rad_to_shortest_deg};
use stiffarm::work::compensate::Compensation;
use stiffarm::work::predict::LoadedArm;
use stiffarm::{Code, Error, Result};
use stiffarm_files::program::Language;
use stiffarm_files::source::read_path;
use stiffarm_files::table::{PathFormat, PathKind, PathTable, write_path};
use stiffarm_files::tool_path::{Kind, MoveOptions, ToolPath, write_moves};
use stiffarm_report::{compensation_figure, render_svg};

/// Said where a path is asked for that is not to be commanded.
const WITHHELD: &str = "Nothing was written: the findings say why. `--beyond-data` writes it all the same.\n";

/// Compensates.
pub fn run(session: &Session, args: &args::Compensate) -> Result<Answer> {
    let mut outputs = Outputs::new(session, args.output.as_deref(), args.figure.as_deref(), args.force)?;
    let named = session.read_cell(&args.cell)?;
    let cell = &named.cell;
    let saved = read_stiffness(session, &args.stiffness, cell)?;
    let options = &args.options;
    let wrong = options.compensate_options(&saved).map(|_| ());
    wrong.and_then(|()| options.posture_options(cell))?;
    let (axes, log) = (options.axes, args.along.log.as_deref());
    let path = read_path(session, &args.path, cell, args.along.language, axes, log)?;
    let language = args.write.and_then(WriteChoice::language);
    let program = path.program.as_ref().filter(|_| args.write.is_none());
    if let Some(output) = &args.output {
        let new = language.map(Kind::Robot);
        check_ending(output, new.or(program.map(ToolPath::kind)), new.is_some(), &path.name)?;
        if let Some(ending) = program.and_then(ToolPath::companion) {
            outputs.beside(session, output, ending, args.force)?;
        }
    }
    let mut result = Progress::new(session, "compensating the path")
        .watch(|control| {
            let points = &path.table.points;
            let followed = options.follow(cell, &saved.predictor, points, control)?;
            options.compensate(cell, &saved, &followed, control)
        })
        .map_err(|e| path.in_file(e))?;
    result.postures.findings.extend(path.findings.iter().cloned());
    let wanted = args.output.is_some() || args.figure.is_some();
    let withheld = wanted && !args.beyond_data && is_objected(&result);
    let mut files = None;
    if wanted && !withheld {
        let compensation = &result.compensation;
        let figure = || render_svg(&compensation_figure(compensation, Some(&cell.work.workpiece)));
        let mut left = Vec::new();
        let tables = || {
            let format = format(cell, &path.table, args.write);
            let points = commanded(cell, &saved.predictor, &path.table, compensation, format.kind())?;
            if let Some(program) = program {
                let written = program.write(&path.table.points, &points)?;
                left = written.findings();
                return Ok(written.files.into_iter().map(|(_, bytes)| bytes).collect());
            }
            let text = match language {
                Some(language) => moves(session, args, cell, language, &points, compensation)?,
                None => write_path(&format, &points)?,
            };
            Ok(vec![text.into_bytes()])
        };
        files = Some(outputs.files(tables, figure)?);
        result.postures.findings.extend(left);
    }
    let findings = result.every_finding();
    let envelope = Rc::new(session.envelope("compensate", None, options.clone(), result));
    let made_with = (named, &saved);
    let exit = match withheld {
        true => Exit::Finding,
        false => Exit::of_findings(&findings),
    };
    let answer = Answer::at_work(exit, envelope, &findings, made_with, args.details).with(files);
    let warning = if withheld { WITHHELD } else { "" };
    Ok(Answer { warning, ..answer })
}

/// Whether something speaks against commanding the path.
fn is_objected(result: &Compensated) -> bool {
    let mut of_path = result.postures.findings.iter();
    of_path.any(|f| f.severity == Severity::Serious) || result.compensation.objections().next().is_some()
}

/// A new program of linear moves through the commanded points, which are poses.
fn moves(
    session: &Session,
    args: &args::Compensate,
    cell: &Cell,
    language: Language,
    points: &[PathPoint],
    compensation: &Compensation,
) -> Result<String> {
    let pairs = points.iter().zip(&compensation.points);
    let poses = pairs.filter_map(|(point, compensated)| match &point.target {
        Aim::Pose(pose) => Some((*pose, compensated.command.as_slice())),
        Aim::Angles(_) | Aim::Axis { .. } => None,
    });
    let poses: Vec<_> = poses.collect();
    let hash = session.last_hash("path").unwrap_or_default();
    let stem = args.output.as_deref().map(Path::new).and_then(Path::file_stem);
    let name = stem.map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    let options = MoveOptions {
        name: if language == Language::Ls { name.to_ascii_uppercase() } else { name },
        header: vec![
            format!("Path compensated by stiffarm {}.", env!("CARGO_PKG_VERSION")),
            format!("path sha256 {}", &hash[..hash.len().min(16)]),
            "Check tool, base, speed and the first moves slowly.".to_string(),
        ],
        speed_mm_s: args.speed_mm_s,
        tool: args.tool.clone(),
        base: args.base.clone(),
    };
    write_moves(language, cell, &poses, &options)
}

/// Refuses a name that says that the file is something else; `kind` is the program's, `None` that of a table; a program
/// is new or the one that was read, with the ending of `input`.
fn check_ending(output: &str, kind: Option<Kind>, is_new: bool, input: &str) -> Result<()> {
    let [written, read] = [output, input].map(|name| Path::new(name).extension());
    let is_kept = kind.is_some() && !is_new && written == read;
    if output == "-" || Kind::of(output) == kind || is_kept {
        return Ok(());
    }
    let message = match kind {
        Some(kind) if is_new => format!("This writes a new program, {}.", kind.title()),
        Some(kind) => format!("This writes the program that was read, {}.", kind.title()),
        None => "This writes a table of the path (CSV).".to_string(),
    };
    let hint = match kind {
        Some(_) if is_new => "give it the ending of such a program",
        Some(_) => "give it the ending of the path, or write a table with `--write poses` or `--write angles`",
        None => "name it .csv; a program goes out as the program that came in, without --write",
    };
    let error = Error::new(Code::Usage, message).key("--output");
    Err(error.hint(hint))
}

/// The columns of the path, or those that `write` asks for.
fn format(cell: &Cell, table: &PathTable, write: Option<WriteChoice>) -> PathFormat {
    let read = table.format.clone();
    match write {
        None => read,
        Some(WriteChoice::Angles) => read.angles(cell),
        Some(_) => read.poses(cell),
    }
}

/// The path to command, in angles or poses as `kind` says.
fn commanded(
    cell: &Cell,
    predictor: &IdentifiedCompliance,
    table: &PathTable,
    result: &Compensation,
    kind: PathKind,
) -> Result<Vec<PathPoint>> {
    let arm = LoadedArm::new(cell, predictor)?;
    let points = table.points.iter().zip(&result.points).map(|(point, compensated)| PathPoint {
        target: match kind {
            // The angles as the result writes them.
            PathKind::Angles => {
                let written = |q: &f64| deg_to_rad(rad_to_shortest_deg(*q));
                Aim::Angles(compensated.command.iter().map(written).collect())
            }
            _ => Aim::Pose(arm.tip_pose(&compensated.command)),
        },
        ..point.clone()
    });
    Ok(points.collect())
}
