//! The readers of the library, and the writers that must fit them.

use super::{Verdict, logs};
use crate::input::Input;
use crate::mutate::{Grammar, mutate, scraps};
use crate::oracle::{error_is_sound, is_finite, same_but_digits};
use crate::random::Random;
use crate::seeds::{self, Kind};
use std::fmt::Debug;
use std::sync::OnceLock;
use stiffarm::estimate::clamped::ClampedPosture;
use stiffarm::model::measurement::Measurements;
use stiffarm::model::path::{PathPoint, PathTarget};
use stiffarm::model::pose::Convention;
use stiffarm::model::process::ForceAxes;
use stiffarm::model::robot::{DhConvention, DhRobot};
use stiffarm::nalgebra::{Translation3, Vector3};
use stiffarm::{Cell, Posture, Result};
use stiffarm_files::builtin;
use stiffarm_files::cell::{parse_cell_bytes, template_of, template_with_shapes};
use stiffarm_files::mesh::parse_mesh;
use stiffarm_files::program::{Language, Program, ProgramFile, read_program, write_program};
use stiffarm_files::registration::read_registration;
use stiffarm_files::result::read_result;
use stiffarm_files::stiffness::read_stiffness;
use stiffarm_files::table::{
    read_clamped, read_dh_rows, read_measurements, read_pairs, read_path, read_poses, read_postures, write_clamped,
    write_displacements, write_path, write_poses, write_postures, write_readings,
};
use stiffarm_files::tool_path::{self, ReadPath, read_tool_path};
use stiffarm_files::urdf::{UrdfOptions, UrdfRobot, read_urdf};

/// A name for messages.
const NAME: &str = "input";

/// The cell whose tables are read.
pub fn cell_of_tables() -> &'static Cell {
    static CELL: OnceLock<Cell> = OnceLock::new();
    CELL.get_or_init(|| match builtin::cell("comau") {
        Ok(cell) => cell,
        Err(error) => unreachable!("the built-in cell: {}", error.message()),
    })
}

fn group() -> &'static [Posture] {
    static GROUP: OnceLock<Vec<Posture>> = OnceLock::new();
    GROUP.get_or_init(|| builtin::postures("comau-group1", &cell_of_tables().setup.robot).unwrap_or_default())
}

fn made(kind: Kind, grammar: Grammar, random: &mut Random) -> Input {
    static SEEDS: OnceLock<Vec<(Kind, Vec<&'static str>)>> = OnceLock::new();
    let all = SEEDS.get_or_init(|| Kind::ALL.map(|kind| (kind, seeds::of(kind))).to_vec());
    let texts = all.iter().find(|(k, _)| *k == kind).map_or(&[][..], |(_, texts)| texts);
    let text = texts[random.below(texts.len())];
    Input::File(if random.one_in(16) { scraps(random) } else { mutate(text.as_bytes(), grammar, random) })
}

macro_rules! makers {
    ($($name:ident, $kind:ident, $grammar:ident;)*) => {$(
        #[doc = concat!("An input from a seed of kind ", stringify!($kind), ".")]
        pub fn $name(random: &mut Random) -> Input {
            made(Kind::$kind, Grammar::$grammar, random)
        }
    )*};
}

makers! {
    make_cell, Cell, Toml;
    make_postures, Postures, Table;
    make_displacements, Displacements, Table;
    make_readings, Readings, Table;
    make_clamped, Clamped, Table;
    make_pairs, Pairs, Table;
    make_poses, Poses, Table;
    make_path, Path, Table;
    make_log, Log, Table;
    make_tool_path, ToolPath, Table;
    make_stiffness, Stiffness, Json;
    make_registration, Registration, Json;
    make_urdf, Urdf, Json;
    make_rows, Rows, Table;
    make_program, Program, Table;
}

/// The bytes of a file.
pub fn bytes(input: &Input) -> &[u8] {
    match input {
        Input::File(bytes) => bytes,
        Input::Command { .. } => &[],
    }
}

/// What was read is finite; an error is sound.
fn judged<T: Debug>(read: &Result<T>) -> Verdict {
    match read {
        Ok(value) => is_finite(value).map(|()| true),
        Err(error) => error_is_sound(error).map(|()| false),
    }
}

/// As [`judged`]; an error begins with the file that it is about.
fn judged_in_file<T: Debug>(read: &Result<T>) -> Verdict {
    match read {
        Err(error) if !error.to_string().starts_with("input:") => Err(format!("an error without its file: {error}")),
        read => judged(read),
    }
}

/// What is written reads back and is written as the same text again.
pub fn written_again<T>(
    value: &T,
    write: impl Fn(&T) -> Result<String>,
    read: impl Fn(&[u8]) -> Result<T>,
) -> Result<(), String> {
    let text = match write(value) {
        Ok(text) => text,
        Err(error) => return error_is_sound(&error),
    };
    let back =
        read(text.as_bytes()).map_err(|e| format!("written and not read: {} {:?}", e.message(), e.place().key))?;
    let again = write(&back).map_err(|e| format!("not written again: {}", e.message()))?;
    if same_but_digits(&again, &text) {
        Ok(())
    } else {
        let pairs = text.lines().zip(again.lines());
        let other = pairs.into_iter().find(|(a, b)| a != b);
        Err(format!("written otherwise the second time: {other:?}"))
    }
}

/// Whether the reader of a kind accepts a file. A panic counts as yes: the target shows it.
pub fn takes(kind: Kind, file: &[u8]) -> bool {
    let cell = cell_of_tables();
    let read = || match kind {
        Kind::Cell => parse_cell_bytes(file, NAME).is_ok(),
        Kind::Postures => read_postures(file, NAME, &cell.setup.robot).is_ok(),
        Kind::Displacements | Kind::Readings => read_measurements(file, NAME, cell, None).is_ok(),
        Kind::Clamped => read_clamped(file, NAME, cell, None).is_ok(),
        Kind::Pairs => read_pairs(file, NAME).is_ok(),
        Kind::Poses => read_poses(file, NAME, Convention::Yaskawa).is_ok(),
        Kind::Path => {
            let axes = Some(ForceAxes::Base);
            read_path(file, NAME, cell, axes).is_ok()
        }
        Kind::Log => logs::read(file, NAME, cell).is_ok(),
        Kind::ToolPath => TOOL_PATHS.iter().any(|kind| read_tool_path(*kind, (NAME, file), None, cell).is_ok()),
        Kind::Stiffness => read_stiffness(file, NAME, cell).is_ok(),
        Kind::Registration => read_registration(file, NAME).is_ok(),
        Kind::Saved => read_result(file, NAME).is_ok(),
        Kind::Urdf => described(file).is_ok(),
        Kind::Rows => read_dh_rows(file, NAME, NAME, DhConvention::Modified).is_ok(),
        Kind::Program => {
            let text = String::from_utf8_lossy(file);
            Language::ALL.into_iter().any(|language| {
                let options = seeds::program_options(language);
                read_program(&program_files(language, &text), language, &options, 6).is_ok()
            })
        }
    };
    std::panic::catch_unwind(read).unwrap_or(true)
}

/// The cell file.
pub fn cell(input: &Input) -> Verdict {
    judged_in_file(&parse_cell_bytes(bytes(input), NAME))
}

/// The table of postures.
pub fn postures(input: &Input) -> Verdict {
    let robot = &cell_of_tables().setup.robot;
    let read = |bytes: &[u8]| read_postures(bytes, NAME, robot);
    let first = read(bytes(input));
    if let Ok(postures) = &first {
        written_again(postures, |p: &Vec<Posture>| Ok(write_postures(p)), read)?;
    }
    judged_in_file(&first)
}

/// Displacements or raw readings, with and without angles of their own.
pub fn measurements(input: &Input) -> Verdict {
    let cell = cell_of_tables();
    let read = |bytes: &[u8]| read_measurements(bytes, NAME, cell, None);
    let first = read(bytes(input));
    if let Ok(measurements) = &first {
        let write = |m: &Measurements| {
            Ok(match m {
                Measurements::Displacements(measured) => write_displacements(measured, cell),
                Measurements::Readings(table) => write_readings(table, cell),
            })
        };
        written_again(measurements, write, read)?;
    } else {
        judged(&read_measurements(bytes(input), NAME, cell, Some(group())))?;
    }
    judged_in_file(&first)
}

/// The table of a clamped flange.
pub fn clamped(input: &Input) -> Verdict {
    let cell = cell_of_tables();
    let read = |bytes: &[u8]| read_clamped(bytes, NAME, cell, None);
    let first = read(bytes(input));
    if let Ok(clamped) = &first {
        let write = |c: &Vec<ClampedPosture>| Ok(write_clamped(c, &cell.setup.robot));
        written_again(clamped, write, read)?;
    }
    judged(&first)
}

/// The table of pairs.
pub fn pairs(input: &Input) -> Verdict {
    judged(&read_pairs(bytes(input), NAME))
}

/// The robot of a description's bytes, any text of which is one.
fn described(bytes: &[u8]) -> Result<UrdfRobot> {
    let text = String::from_utf8_lossy(bytes);
    // A finger hangs below the flange of the seed.
    let options = UrdfOptions { base: None, tip: Some("tool0".to_string()) };
    read_urdf(&text, NAME, &options)
}

/// A robot is finite, and so is the one in the cell that is written for it.
fn judged_robot(read: &Result<DhRobot>) -> Verdict {
    if let Ok(robot) = read {
        judged(&robot.robot())?;
        match template_of(robot, NAME) {
            Ok(text) => judged(&parse_cell_bytes(text.as_bytes(), NAME))?,
            Err(error) => error_is_sound(&error).map(|()| false)?,
        };
    }
    judged(read)
}

/// A robot description; each of its meshes is a triangle.
pub fn urdf(input: &Input) -> Verdict {
    let read = described(bytes(input));
    if let Ok(read) = &read {
        let triangle = b"v 0.1 0.2 0.3\nv 0.3 0.1 0.2\nv 0 0 0.1\nf 1 2 3\n";
        let capsules = read.link_capsules(|_, unit| parse_mesh(triangle, "a.obj", unit));
        judged(&capsules)?;
        if let Ok(Ok(text)) = capsules.map(|capsules| template_with_shapes(&read.robot, NAME, &capsules)) {
            judged(&parse_cell_bytes(text.as_bytes(), NAME))?;
        }
    }
    judged_robot(&read.map(|read| read.robot))
}

/// Denavit–Hartenberg rows.
pub fn rows(input: &Input) -> Verdict {
    judged_robot(&read_dh_rows(bytes(input), NAME, NAME, DhConvention::Standard))
}

/// A table of poses: the first convention that takes it is judged, and gives it
/// back but for rounding.
pub fn poses(input: &Input) -> Verdict {
    let read = |convention| read_poses(bytes(input), NAME, convention);
    for convention in Convention::ALL {
        if let Ok(poses) = read(convention) {
            let text = write_poses(&poses, convention);
            if let Err(error) = read_poses(text.as_bytes(), NAME, convention) {
                return Err(format!("what was written is not read: {error}"));
            }
        }
    }
    judged(&read(Convention::Yaskawa))
}

/// A controller program: the first language that takes it is judged, and gives the same moves
/// back; otherwise what each says must be sound.
pub fn program(input: &Input) -> Verdict {
    let text = String::from_utf8_lossy(bytes(input)).into_owned();
    for language in Language::ALL {
        let options = seeds::program_options(language);
        let files = program_files(language, &text);
        match read_program(&files, language, &options, 6) {
            Err(error) => error_is_sound(&error)?,
            Ok(read) => {
                is_finite(&read)?;
                let again = Program { name: language.name_for("again"), ..read.clone() };
                let Ok(files) = write_program(&again, language, &options) else {
                    return Err(format!("read and not written: {read:?}"));
                };
                let back =
                    read_program(&files, language, &options, 6).map_err(|e| format!("written and not read: {e}"))?;
                let count = |program: &Program| program.steps.len();
                return if count(&back) == count(&read) {
                    Ok(true)
                } else {
                    Err("written with another number of steps".to_string())
                };
            }
        }
    }
    Ok(false)
}

/// The files of a program whose texts stand one after the other.
fn program_files(language: Language, text: &str) -> Vec<ProgramFile> {
    let file = |name: &str, text: &str| ProgramFile { name: name.to_string(), text: text.to_string() };
    match language {
        Language::Krl => {
            let at = text.rfind("&ACCESS").unwrap_or(0);
            vec![file("a.src", &text[..at]), file("a.dat", &text[at..])]
        }
        _ => vec![file("a.txt", text)],
    }
}

/// A recorded load along a path.
pub fn log(input: &Input) -> Verdict {
    judged(&logs::read(bytes(input), NAME, cell_of_tables()))
}

/// The table of a path.
pub fn path(input: &Input) -> Verdict {
    let cell = cell_of_tables();
    let axes = Some(ForceAxes::Base);
    let read = |bytes: &[u8]| read_path(bytes, NAME, cell, axes);
    let first = read(bytes(input));
    if let Ok(table) = &first {
        written_again(table, |t| write_path(&t.format, &t.points), read)?;
    }
    judged(&first)
}

/// What a tool path can be.
const TOOL_PATHS: [tool_path::Kind; 7] = [
    tool_path::Kind::Apt,
    tool_path::Kind::Gcode,
    tool_path::Kind::Robot(Language::Krl),
    tool_path::Kind::Robot(Language::Rapid),
    tool_path::Kind::Robot(Language::Ls),
    tool_path::Kind::Robot(Language::Urscript),
    tool_path::Kind::Robot(Language::Inform),
];

/// A tool path in every language: finite, and with its own points the same bytes.
pub fn tool_path(input: &Input) -> Verdict {
    let bytes = bytes(input);
    let mut taken = false;
    for kind in TOOL_PATHS {
        let read = match read_tool_path(kind, (NAME, bytes), None, cell_of_tables()) {
            Ok(read) => read,
            Err(error) => {
                error_is_sound(&error)?;
                continue;
            }
        };
        taken = true;
        is_finite(&read.points)?;
        match read.program.write(&read.points, &read.points) {
            Ok(written) if std::str::from_utf8(bytes).is_err() || written.files[0].1 == bytes => {}
            Ok(written) => {
                let text = String::from_utf8_lossy(&written.files[0].1).into_owned();
                return Err(format!("written otherwise, as {kind:?}: {text}"));
            }
            Err(error) => error_is_sound(&error)?,
        }
        shifted(kind, &read)?;
    }
    Ok(taken)
}

/// Where the program states all its points: moved by a millimetre, written and read again they are there.
fn shifted(kind: tool_path::Kind, read: &ReadPath) -> Result<(), String> {
    let count = read.points.len();
    if !(0..count).all(|i| read.program.holds(i)) {
        return Ok(());
    }
    let step = Translation3::new(1e-3, 0.0, 0.0);
    let moved = |point: &PathPoint| PathPoint {
        target: match &point.target {
            PathTarget::Pose(pose) => PathTarget::Pose(step * pose),
            PathTarget::Axis { position, axis } => PathTarget::Axis { position: position + step.vector, axis: *axis },
            other => other.clone(),
        },
        ..point.clone()
    };
    let wanted: Vec<PathPoint> = read.points.iter().map(moved).collect();
    let written = match read.program.write(&read.points, &wanted) {
        Ok(written) => written,
        Err(error) => return error_is_sound(&error),
    };
    let bytes = written.files[0].1.as_slice();
    let again = read_tool_path(kind, (NAME, bytes), None, cell_of_tables())
        .map_err(|e| format!("moved, written and not read: {}", e.message()))?;
    let position = |point: &PathPoint| match &point.target {
        PathTarget::Pose(pose) => pose.translation.vector,
        PathTarget::Axis { position, .. } => *position,
        PathTarget::Angles(_) => Vector3::zeros(),
    };
    // Where a point has moved far enough, the move to the next is looked at in parts.
    let stated = (0..again.points.len()).filter(|i| again.program.holds(*i));
    let positions: Vec<Vector3<f64>> = stated.map(|i| position(&again.points[i])).collect();
    let is_near = |(a, b): (&Vector3<f64>, &PathPoint)| (a - position(b)).norm() < 2e-6;
    if positions.len() == count && positions.iter().zip(&wanted).all(is_near) {
        Ok(())
    } else {
        let text = String::from_utf8_lossy(bytes).into_owned();
        Err(format!("moved otherwise, as {kind:?}: {text}"))
    }
}

/// A saved stiffness.
pub fn stiffness(input: &Input) -> Verdict {
    judged(&read_stiffness(bytes(input), NAME, cell_of_tables()))
}

/// A saved registration.
pub fn registration(input: &Input) -> Verdict {
    judged(&read_registration(bytes(input), NAME))
}
