//! `stiffarm export --compare`: a program against the plan.

use super::Task;
use crate::answer::Answer;
use crate::args;
use crate::finding::wrapped_line;
use crate::input::Line;
use crate::output::Exit;
use crate::screen::{columns, wrapped};
use crate::session::Session;
use crate::table::red;
use serde::Serialize;
use stiffarm::Result;
use stiffarm::findings::Finding;
use stiffarm::model::posture::Posture;
use stiffarm::plan::feasibility::{Violation, violations};
use stiffarm::units::deg_to_rad;
use stiffarm_files::program::{
    Difference, Move, MoveKind, Program, ProgramFile, compare_moves, compare_statements, missing_stops, read_program,
    write_program,
};
use stiffarm_files::source::Source;

/// Angles that differ by less are the same \[deg\]: no arm repeats better.
const TOLERANCE_DEG: f64 = 0.001;

/// Lines that differ which are printed.
const MOST_LINES: usize = 12;

/// How the program compares with the plan.
#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Compared {
    /// Name of the program.
    program: String,
    /// True where every posture is the plan's, in its order, and every line one that is written for it.
    same: bool,
    /// Angles that differ by less are the same.
    tolerance_deg: f64,
    /// Postures of the plan.
    planned_postures: usize,
    /// Postures of the program.
    found_postures: usize,
    /// Where they differ.
    differences: Vec<Difference>,
    /// Limits of the cell that the program's postures violate.
    violations: Vec<Violation>,
    /// What is doubtful about the angles of the cell's robot, and which postures of the plan sit on a limit.
    findings: Vec<Finding>,
}

/// Reads the program and compares it.
pub(super) fn run(session: &Session, args: &args::Export, task: &Task) -> Result<Answer> {
    let files = files(session, args)?;
    let joints = task.cell.cell.setup.robot.joint_count();
    let program = read_program(&files, task.language, &task.options, joints)?;
    // As the language holds it: rounded, in whole pulses.
    let (_, planned) = task.written()?;
    let wanted = |target: &&Move| task.start.is_some() || target.kind != MoveKind::Start;
    let planned: Vec<&Move> = planned.moves().filter(wanted).collect();
    let moves: Vec<&Move> = program.moves().filter(wanted).collect();
    let mut differences = compare_moves(&planned, &moves, task.language, deg_to_rad(TOLERANCE_DEG));
    differences.extend(missing_stops(&program));
    differences.extend(other_lines(task, &files, &program)?);
    let postures = at_limits(task, &program, &differences);
    let result = Compared {
        program: program.name.clone(),
        same: differences.is_empty(),
        tolerance_deg: TOLERANCE_DEG,
        planned_postures: task.plan.len(),
        found_postures: postures.len(),
        differences,
        violations: violations(&task.cell.cell, &postures)?,
        findings: task.findings()?,
    };
    let is_finding = !result.same || !result.violations.is_empty();
    let text = table(task, &result);
    let envelope = session.envelope("export", None, task.options(args), result);
    Ok(Answer::table(Exit::finding(is_finding), envelope, text))
}

/// The postures of the program, to be held against the limits: those that are the plan's as the plan
/// has them, for one that lies on a limit is rounded to either side of it.
fn at_limits(task: &Task, program: &Program, differences: &[Difference]) -> Vec<Posture> {
    let is_other = |name: &str| {
        differences.iter().any(|difference| match difference {
            Difference::Angle { posture, .. } | Difference::Added { posture } => posture == name,
            _ => false,
        })
    };
    let planned_posture = |target: &Move| {
        let planned = task.plan.iter().find(|posture| posture.name == target.name);
        planned.filter(|_| !is_other(&target.name)).cloned()
    };
    let measured = program.moves().filter(|target| target.kind == MoveKind::Posture);
    let postures = measured.map(|target| {
        planned_posture(target).unwrap_or_else(|| Posture { name: target.name.clone(), q: target.q.clone() })
    });
    postures.collect()
}

fn files(session: &Session, args: &args::Export) -> Result<Vec<ProgramFile>> {
    let files = args.compare.iter().enumerate().map(|(number, from)| {
        let (name, bytes) = session.read(&format!("program_{}", number + 1), from)?;
        // Controllers write comments in character sets of their own.
        let text = String::from_utf8_lossy(&bytes).into_owned();
        Ok(ProgramFile { name, text })
    });
    files.collect()
}

/// Lines beside those that are written for the plan, under the name that the program has.
fn other_lines(task: &Task, files: &[ProgramFile], program: &Program) -> Result<Vec<Difference>> {
    let mut planned = task.program.clone();
    if task.language.check_name(&program.name).is_ok() {
        planned.name.clone_from(&program.name);
    }
    let joints = task.cell.cell.setup.robot.joint_count();
    let written = write_program(&planned, task.language, &task.options)?;
    Ok(compare_statements(&written, files, task.language, joints))
}

fn table(task: &Task, result: &Compared) -> String {
    let mut out = task.cell.line();
    let doubts = result.findings.iter().map(|f| wrapped_line(f) + "\n");
    out.extend(doubts);
    out += &if result.same {
        format!(
            "program {}: the same {} postures as the plan, within {TOLERANCE_DEG}°, and no other line\n",
            result.program, result.planned_postures
        )
    } else {
        format!(
            "program {}: {} postures, the plan has {}\n",
            result.program, result.found_postures, result.planned_postures
        )
    };
    let joints: Vec<String> = task.cell.cell.setup.robot.joints().iter().map(|j| j.name.clone()).collect();
    let is_line =
        |difference: &&Difference| matches!(difference, Difference::Line { .. } | Difference::MissingLine { .. });
    let lines = result.differences.iter().filter(is_line).count();
    let others = result.differences.len() - lines;
    for difference in result.differences.iter().take(others + MOST_LINES) {
        let line = format!("{}: {}", red("differs"), difference.sentence(&joints));
        out += &(wrapped(&line, columns()) + "\n");
    }
    if lines > MOST_LINES {
        out += &format!("… and {} lines more (--json has all)\n", lines - MOST_LINES);
    }
    for violation in &result.violations {
        let line = format!("{}: posture {} {}", red("limit"), violation.posture, violation.sentence);
        out += &(wrapped(&line, columns()) + "\n");
    }
    if result.violations.is_empty() {
        out += "limits: every posture of the program meets the limits of the cell\n";
    }
    out
}
