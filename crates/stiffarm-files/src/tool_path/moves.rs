//! A path as a new program of linear moves.

use crate::program::characters::wrapped;
use crate::program::{Language, LinearMove, PoseForm, filled, fixed};
use nalgebra::Isometry3;
use stiffarm::error::{Code, Error, Result};
use stiffarm::model::cell::Cell;
use stiffarm::model::pose::{Configuration, Elbow, Shoulder, Wrist};
use stiffarm::units::rad_to_deg;

/// Most characters of a line of the header.
const HEADER_WIDTH: usize = 76;

/// What a new program needs to know beside its path.
#[derive(Debug, Clone, PartialEq)]
pub struct MoveOptions {
    /// Its name.
    pub name: String,
    /// Lines at its head, for the reader.
    pub header: Vec<String>,
    /// Speed of the linear moves \[mm/s\].
    pub speed_mm_s: f64,
    /// Name or number of the controller's tool, that of the tip.
    pub tool: Option<String>,
    /// Name or number of the controller's base, that of the workpiece frame.
    pub base: Option<String>,
}

/// A point of it: the pose of the tip in the base frame \[m\] and controller angles \[rad\].
pub type PosedPoint<'a> = (Isometry3<f64>, &'a [f64]);

/// The text of a program that leads the tip of `cell` through `points`: a joint move to the first, linear
/// moves to all others. Poses count from the workpiece frame, in URScript from the controller's base.
///
/// # Errors
/// A language in which no paths are written, a robot of another controller or not of six joints, a name
/// that the language does not allow, a speed that is not above zero, too many points.
pub fn write_moves(
    language: Language,
    cell: &Cell,
    points: &[PosedPoint<'_>],
    options: &MoveOptions,
) -> Result<String> {
    let fault = |code, message: String| Err(Error::new(code, message));
    let pose_form = language.poses();
    let Some((poses, moves)) = pose_form.and_then(|poses| Some((poses, poses.moves?))) else {
        let message = format!("Paths are not written in {} here.", language.title());
        return Err(
            Error::new(Code::Unsupported, message).hint("krl, rapid, ls and urscript hold paths; so does a table")
        );
    };
    let robot = &cell.setup.robot;
    if robot.joint_count() != 6 {
        let joints = robot.joint_count();
        return fault(Code::Unsupported, format!("Paths are written for robots of six joints; this one has {joints}."));
    }
    language.check_robot(robot, None).map_err(|error| {
        Error::new(error.code(), error.message()).key("write").hint("write it in the language of the cell's controller")
    })?;
    language.check_name(&options.name)?;
    if !(options.speed_mm_s.is_finite() && options.speed_mm_s > 0.0) {
        let speed = options.speed_mm_s;
        return Err(Error::invalid(format!("The speed must be above 0 mm/s, got {speed}.")).key("speed_mm_s"));
    }
    if points.len() > moves.most {
        let message = format!(
            "The path has {} points; a program in {} has {} moves at most.",
            points.len(),
            language.title(),
            moves.most
        );
        return Err(Error::new(Code::Unsupported, message).hint("write it in parts"));
    }
    let [tool, base] = moves.frames;
    let tool = options.tool.as_deref().unwrap_or(tool);
    let base = options.base.as_deref().unwrap_or(base);
    let workpiece = if poses.in_base { *robot.controller_base() } else { cell.work.workpiece };
    let leads = points.iter().zip(1..).map(|((pose, q), number)| LinearMove {
        number,
        pose: numbers(&poses, &(workpiece.inverse() * pose)),
        angles: q.iter().map(|angle| fixed(rad_to_deg(*angle), 4)).collect(),
        configuration: configuration(cell, q),
        speed_mm_s: options.speed_mm_s,
        tool,
        base,
    });
    let (mut body, mut list) = (Vec::with_capacity(points.len()), Vec::new());
    for leads in leads {
        body.extend((moves.lines)(&leads));
        list.extend((moves.point)(&leads));
    }
    let header = options.header.iter().cloned().chain(frames(&poses, cell, tool, base));
    let header: Vec<String> = match language {
        // A remark has 32 characters.
        Language::Ls => header.flat_map(|line| wrapped(&line, 32)).collect(),
        _ => header.flat_map(|line| wrapped(&line, HEADER_WIDTH)).collect(),
    };
    let words = [("{name}", options.name.as_str()), ("{tool}", tool), ("{base}", base), ("{what}", "path")];
    let lists = [("{header}", header), ("{body}", body), ("{points}", list)];
    Ok(filled(moves.template, &words, &lists, language.line_end()))
}

/// Position and orientation as the language has them.
fn numbers(poses: &PoseForm, pose: &Isometry3<f64>) -> Vec<String> {
    let [length, turn] = poses.decimals;
    let position = pose.translation.vector / poses.unit;
    let position = position.iter().map(|x| fixed(*x, length));
    let turns = poses.convention.shown(&pose.rotation).into_iter();
    position.chain(turns.map(|x| fixed(x, turn))).collect()
}

/// What tool and base of the controller have to be.
fn frames(poses: &PoseForm, cell: &Cell, tool: &str, base: &str) -> Vec<String> {
    let shown = |pose: &Isometry3<f64>| numbers(poses, pose).join(", ");
    let tip = format!("Tool {tool}: {}", shown(&cell.work.tip(&cell.setup.tool)));
    if poses.in_base {
        return vec![tip.replace("Tool : ", "TCP: ")];
    }
    let from_controller = cell.setup.robot.controller_base().inverse();
    let workpiece = from_controller * cell.work.workpiece;
    vec![tip, format!("Base {base}: {}", shown(&workpiece))]
}

/// FANUC's name of the configuration: wrist, elbow, arm, turns of axes 1, 4 and 6.
fn configuration(cell: &Cell, q: &[f64]) -> String {
    let Some(configuration) = Configuration::of(&cell.setup.robot, q) else {
        return String::new();
    };
    let words = [
        if configuration.wrist == Wrist::Flip { "F" } else { "N" },
        if configuration.elbow == Elbow::Up { "U" } else { "D" },
        if configuration.shoulder == Shoulder::Front { "T" } else { "B" },
    ];
    let turns = [0, 3, 5].map(|axis| ((rad_to_deg(q[axis]) + 180.0) / 360.0).floor().to_string());
    format!("{}, {}", words.join(" "), turns.join(", "))
}
