//! `stiffarm export`: a plan as a program for the robot's controller.

pub mod compare;
mod moves;

use crate::answer::Answer;
use crate::args;
use crate::args::ControllerChoice;
use crate::files::{Files, Said, check_folder};
use crate::finding::wrapped_line;
use crate::input::Line;
use crate::numbers::counted;
use crate::output::Exit;
use crate::screen::{columns, wrapped};
use crate::session::Session;
use crate::table::{red, yellow};
use moves::Driven;
use serde::Serialize;
use std::path::Path;
use stiffarm::findings::Finding;
use stiffarm::model::cell::LimitKind;
use stiffarm::model::posture::Posture;
use stiffarm::model::robot::{Controller, Robot};
use stiffarm::plan::check::robot_doubts;
use stiffarm::plan::feasibility::{Violation, on_limits, violations};
use stiffarm::plan::select::limits_of;
use stiffarm::units::rad_to_deg;
use stiffarm::{Code, Error, Result};
use stiffarm_files::check_name;
use stiffarm_files::program::{
    Language, Move, Program, ProgramFile, ProgramOptions, program_of_stops, read_program, write_program,
};
use stiffarm_files::source::{NamedCell, group_name, read_postures};
use stiffarm_files::table::{SheetOptions, sha256_hex};

/// Name of the start that the cell gives.
const START: &str = "home";

/// Options of the result.
#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Options {
    /// Language of the controller.
    language: Language,
    /// Speed of the moves, in per cent of what the language counts from.
    speed_percent: u8,
    /// Load states that the texts name.
    states: Vec<String>,
    /// Maker of the controller, where the language was asked for by name.
    controller: Option<&'static str>,
    /// Tool of the controller, where one was given.
    tool: Option<String>,
    /// Axis of the controller of each joint, where they were given.
    controller_axes: Option<Vec<usize>>,
    /// Pulses per degree of each axis, where they were given.
    pulses_per_degree: Option<Vec<f64>>,
    /// Whether a plan that violates limits is written.
    despite_limits: bool,
}

/// What was written.
#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Exported {
    /// Name of the program on the controller.
    program: String,
    /// The files; none where the plan violates limits of its cell.
    files: Vec<WrittenFile>,
    /// Names of the postures, in the order of the program.
    postures: Vec<String>,
    /// Joint moves.
    moves: usize,
    /// Moves that lead over via postures.
    moves_with_via: usize,
    /// Moves for which no free way was found.
    blocked_moves: Vec<String>,
    /// What the moves were checked against.
    checked: Vec<LimitKind>,
    /// Largest difference between an angle of the plan and of the program.
    rounding_deg: f64,
    /// Limits of the cell that postures violate.
    violations: Vec<Violation>,
    /// What to distrust about the robot, and which postures sit on a limit.
    findings: Vec<Finding>,
}

/// A file of the program.
#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct WrittenFile {
    /// Its name in the folder.
    name: String,
    /// SHA-256 of its content.
    sha256: String,
}

/// What is to be exported or compared.
struct Task {
    cell: NamedCell,
    speed_percent: u8,
    driven: Driven,
    language: Language,
    plan: Vec<Posture>,
    start: Option<Posture>,
    states: Vec<String>,
    options: ProgramOptions,
    violations: Vec<Violation>,
    program: Program,
}

/// Writes the program, or compares one.
pub fn run(session: &Session, args: &args::Export) -> Result<Answer> {
    let task = Task::new(session, args)?;
    match &args.output_dir {
        Some(folder) => export(session, args, &task, folder),
        None => compare::run(session, args, &task),
    }
}

impl Task {
    /// What to know before the arm is driven: doubts about its angles, postures on limits.
    fn findings(&self) -> Result<Vec<Finding>> {
        let cell = &self.cell.cell;
        let limits = limits_of(cell, &self.plan)?;
        let mut findings = robot_doubts(&cell.setup.robot);
        findings.extend(on_limits(cell, &self.plan, &limits));
        findings.extend(self.driven.not_approached.clone());
        Ok(findings)
    }

    fn new(session: &Session, args: &args::Export) -> Result<Self> {
        let cell = session.read_cell(&args.cell)?;
        let robot = &cell.cell.setup.robot;
        let controller = args.controller.controller;
        let language = args.language.map_or_else(|| language_of(robot, controller), Ok)?;
        language.check_robot(robot, controller)?;
        let plan = read_postures(session, "plan", &args.plan, robot)?;
        let start = match args.start.as_deref() {
            Some(from) => Some(only_posture(session, from, &cell)?),
            None => cell.cell.route.start.clone().map(|q| Posture { name: START.to_string(), q }),
        };
        for state in &args.states {
            check_name(state).map_err(|e| e.key("--states"))?;
        }
        let mut sheet = SheetOptions::default();
        sheet.states.clone_from(&args.states);
        let states = sheet.all_states(&cell.cell);
        let mut violated = violations(&cell.cell, start.as_slice())?;
        // Nothing is measured where the program begins: sight and loads do not matter there.
        violated.retain(|v| v.limit.as_ref().is_none_or(|limit| limit.kind.is_of_place()));
        violated.extend(violations(&cell.cell, &plan)?);
        let name = match &args.name {
            Some(name) => name.clone(),
            None => language.name_for(&group_name(&args.plan)),
        };
        language.check_name(&name).map_err(|e| e.key("--name"))?;
        let speed_percent = args.speed_percent.unwrap_or_else(|| {
            let percent = (100.0 * cell.cell.route.speed_share).round();
            percent.clamp(1.0, 100.0) as u8
        });
        let driven = Driven::new(&cell.cell, &plan, start.as_ref(), &states)?;
        let header = header(session, &cell, plan.len(), speed_percent, violated.len(), &driven);
        let program = program_of_stops(name, header, &driven.stops, driven.start.as_ref(), speed_percent);
        Ok(Task {
            speed_percent,
            driven,
            language,
            plan,
            start,
            states,
            options: program_options(&args.controller),
            violations: violated,
            program,
            cell,
        })
    }

    /// The files, and what is read from them again.
    fn written(&self) -> Result<(Vec<ProgramFile>, Program)> {
        let joints = self.cell.cell.setup.robot.joint_count();
        let files = write_program(&self.program, self.language, &self.options)?;
        let read = read_program(&files, self.language, &self.options, joints)?;
        Ok((files, read))
    }

    fn options(&self, args: &args::Export) -> Options {
        Options {
            language: self.language,
            speed_percent: self.speed_percent,
            states: self.states.clone(),
            controller: args.controller.controller.map(Controller::as_str),
            tool: self.options.tool.clone(),
            controller_axes: self.options.controller_axes.clone(),
            pulses_per_degree: self.options.pulses_per_degree.clone(),
            despite_limits: args.despite_limits,
        }
    }

    /// What the limits say, one line each.
    fn limit_lines(&self) -> String {
        if self.violations.is_empty() {
            return "limits: every posture meets the limits of robot and cell\n".to_string();
        }
        let lines = self.violations.iter().map(|v| {
            let line = format!("{}: posture {} {}", red("limit"), v.posture, v.sentence);
            wrapped(&line, columns()) + "\n"
        });
        lines.collect()
    }
}

fn program_options(args: &ControllerChoice) -> ProgramOptions {
    ProgramOptions {
        controller_axes: (!args.controller_axes.is_empty()).then(|| args.controller_axes.clone()),
        pulses_per_degree: (!args.pulses_per_degree.is_empty()).then(|| args.pulses_per_degree.clone()),
        tool: args.tool.clone(),
    }
}

fn only_posture(session: &Session, from: &str, cell: &NamedCell) -> Result<Posture> {
    let mut postures = read_postures(session, "start", from, &cell.cell.setup.robot)?;
    match (postures.pop(), postures.len()) {
        (Some(only), 0) => Ok(only),
        (_, more) => {
            Err(Error::new(Code::Usage, format!("The program begins at one posture; this table has {}.", more + 1))
                .file(from)
                .hint("give a table with a single row"))
        }
    }
}

/// The head of the program: the warning, and what made it. No time and no path: the same plan gives
/// the same bytes.
fn header(
    session: &Session,
    cell: &NamedCell,
    postures: usize,
    speed_percent: u8,
    violated: usize,
    driven: &Driven,
) -> Vec<String> {
    let hashes = session.hashes();
    let hash = |role: &str| hashes.get(role).cloned().unwrap_or_default();
    let mut lines = vec![
        format!("Motion program generated by stiffarm {}.", env!("CARGO_PKG_VERSION")),
        "WARNING: never run on this robot before. Run it first in T1 (manual reduced speed), step by step, \
         with the cell empty and nobody inside, the enabling switch in hand."
            .to_string(),
        "Base, mastering, payload and axis limits are those of the controller. This program does not set them."
            .to_string(),
        driven.sentence(),
    ];
    if violated > 0 {
        lines.push(format!("WARNING: postures of this plan violate limits of its cell ({violated} in all)."));
    }
    lines.extend([
        format!("cell {}", cell.cell.name),
        format!("cell sha256 {}", hash("cell")),
        format!("plan sha256 {}", hash("plan")),
        format!("postures {postures}, speed {speed_percent} per cent"),
    ]);
    lines
}

fn export(session: &Session, args: &args::Export, task: &Task, folder: &Path) -> Result<Answer> {
    let (files, read) = task.written()?;
    let rounding = rounding_deg(&task.program, &read)?;
    let names: Vec<&str> = files.iter().map(|file| file.name.as_str()).collect();
    let is_sound = task.violations.is_empty() && task.driven.blocked.is_empty();
    let is_written = is_sound || args.despite_limits;
    if is_written {
        check_folder(session, folder, names.iter().copied(), args.force)?;
    }
    let hashed = files
        .iter()
        .filter(|_| is_written)
        .map(|file| WrittenFile { name: file.name.clone(), sha256: sha256_hex(file.text.as_bytes()) });
    let result = Exported {
        program: task.program.name.clone(),
        files: hashed.collect(),
        postures: task.plan.iter().map(|posture| posture.name.clone()).collect(),
        moves: task.program.moves().count(),
        moves_with_via: task.driven.with_via,
        blocked_moves: task.driven.blocked.clone(),
        checked: task.driven.checked.clone(),
        rounding_deg: rounding,
        violations: task.violations.clone(),
        findings: task.findings()?,
    };
    let doubts = result.findings.iter().map(|f| wrapped_line(f) + "\n");
    let doubts: String = doubts.collect();
    let table = || {
        let mut out = task.cell.line() + &doubts + &task.limit_lines();
        for blocked in &task.driven.blocked {
            let line = format!("{}: the move {blocked} has no free way that was found", red("move"));
            out += &(wrapped(&line, columns()) + "\n");
        }
        if !is_written {
            let said = "nothing is written: change the plan, or write it all the same with --despite-limits";
            return out + &wrapped(said, columns()) + "\n";
        }
        out += &said(task, &names, folder, rounding);
        out
    };
    let table = table();
    let written = is_written.then(|| {
        let texts = files.into_iter().map(|file| (file.name, file.text));
        Files::folder(folder, texts, args.force).said(Said::Nothing)
    });
    let envelope = session.envelope("export", None, task.options(args), result);
    Ok(Answer::table(Exit::finding(!is_sound), envelope, table).with(written))
}

/// What was written, and what is to be done with it.
fn said(task: &Task, names: &[&str], folder: &Path, rounding: f64) -> String {
    let first = task.program.moves().next().map_or(0, |first| first.speed_percent);
    let speed = format!(
        "{}: program {}, {}, speed {} % of {}, first move {first} %\n",
        task.language.title(),
        task.program.name,
        counted(task.plan.len(), "posture"),
        task.speed_percent,
        task.language.speed_of()
    );
    let mut out = wrapped(speed.trim_end(), columns()) + "\n";
    for name in names {
        out += &format!("  {}\n", folder.join(name).display());
    }
    out += &if rounding < 1e-9 {
        "read back: the angles of the plan\n".to_string()
    } else {
        format!("read back: the angles of the plan, rounded by at most {rounding:.5}°\n")
    };
    let warning = format!(
        "{}: {} Run the program first in T1 (manual reduced speed), with the cell empty and nobody inside. \
         Tool load, base and mastering are those of the controller.",
        yellow("warning"),
        task.driven.sentence()
    );
    out + &wrapped(&warning, columns()) + "\n"
}

/// Largest difference between the angles that were meant and those read from the written program.
///
/// # Errors
/// The program that was read is another than the one written: a fault of this program.
fn rounding_deg(program: &Program, read: &Program) -> Result<f64> {
    let pairs: Vec<(&Move, &Move)> = program.moves().zip(read.moves()).collect();
    let same = program.moves().count() == read.moves().count()
        && pairs.iter().all(|(a, b)| a.kind == b.kind && a.q.len() == b.q.len());
    let angles = pairs.iter().flat_map(|(a, b)| a.q.iter().zip(&b.q));
    let largest = angles.fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
    // Half a pulse of the coarsest encoder is the most that any language rounds by.
    if same && rad_to_deg(largest) < 0.011 {
        Ok(rad_to_deg(largest))
    } else {
        Err(Error::new(Code::Internal, "The written program is not read back as the plan."))
    }
}

/// The language of the controller that is asked for, or that shows the angles of the cell.
fn language_of(robot: &Robot, controller: Option<Controller>) -> Result<Language> {
    let controller = controller.map_or_else(|| robot.known_controller(), Ok)?;
    Language::of(controller).ok_or_else(|| {
        let message = format!("No language of {} is written here.", controller.title());
        Error::new(Code::Usage, message).key("--language").hint("--language csv writes a table of the moves")
    })
}
