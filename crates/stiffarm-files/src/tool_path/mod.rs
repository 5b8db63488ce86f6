//! Tool paths as programs: CL data of a CAM system (APT, Siemens NX CLSF), G-code, and the
//! programs of robot controllers (KRL, RAPID, FANUC TP, INFORM, URScript).
//!
//! [`read_tool_path`] gives the points of a program as a table would ([`PathPoint`]): the moves at
//! feed with the load of the process, rapid moves without one. [`ToolPath::write`] gives the same text
//! back with other numbers in it; lines, comments and layout stay. So a reader keeps for each
//! number of a point where it stands (`Slot`); what a line leaves out because it has not changed
//! gets the place where it would be inserted.
//!
//! CL data and G-code give the tool axis from the tip to the spindle; the tip's z points the other
//! way. All poses count from the workpiece frame of the cell, in URScript from the controller's base.
//!
//! What a program says and is not followed is an error with its place, or a sentence with its line.

mod apt;
mod arc;
mod builder;
mod divided;
mod gcode;
mod kind;
mod moves;
mod numbers;
mod robot;
mod targets;
mod write;

use super::program::ProgramFile;
use super::text::decode;
use builder::Builder;
use divided::Divided;
pub use gcode::page as gcode_page;
pub use kind::{Kind, LANGUAGES, PathLanguage, recognised};
pub use moves::{MoveOptions, PosedPoint, write_moves};
use nalgebra::Isometry3;
use stiffarm::error::{Code, Error, Result};
use stiffarm::findings::{Finding, Severity};
use stiffarm::model::cell::Cell;
use stiffarm::model::path::PathPoint;
use stiffarm::model::pose::Convention;
pub use write::WrittenPath;

/// Largest distance of straight moves from the arc, or from the corrected move, that they stand for \[m\].
pub const TOLERANCE: f64 = 0.01e-3;

/// Longer straight moves at feed are looked at in parts of this length at most \[m\].
pub const SPAN: f64 = 0.05;

/// So near its ends a straight move has a point, where its load may change to that of another \[m\].
const NEAR_END: f64 = 1e-3;

/// Coordinates beyond this are no path of a robot \[m\].
const FARTHEST: f64 = 100.0;

/// What is wrong with such a point.
const FAR_AWAY: &str = "This point is more than 100 m from the origin: look at the unit of the file.";

/// The orientation in a program.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Orientation {
    /// None, or one that stays as it is.
    Kept,
    /// Direction from the tip to the spindle.
    Axis,
    /// A whole orientation.
    Full { convention: Convention, degrees: bool },
}

/// How the numbers of points stand in a program.
#[derive(Debug, Clone, PartialEq)]
struct Form {
    orientation: Orientation,
    /// Unit of lengths \[m\].
    unit: f64,
    /// What stands before each number, for those that a line leaves out.
    before: &'static [&'static str],
    /// Fewest decimals of a length and of a number of the orientation that is written.
    decimals: [usize; 2],
    /// Frame of the poses in the base frame \[m\].
    frame: Isometry3<f64>,
}

/// Where a number stands: `length` bytes at byte `at` of a file; none where it is to be inserted.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Slot {
    at: u32,
    length: u16,
    file: u8,
    /// x, y, z, then the orientation.
    component: u8,
    /// Whether it is what it was before where it is left out.
    modal: bool,
}

/// The text of a tool path, with the places of its numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct ToolPath {
    kind: Kind,
    files: Vec<ProgramFile>,
    /// True where the bytes are ISO 8859-1, not UTF-8.
    latin: bool,
    form: Form,
    slots: Vec<Slot>,
    /// The numbers of `slots`, in the units of the program.
    values: Vec<f64>,
    /// Slots of each point: those before this one.
    ends: Vec<usize>,
    divided: Vec<Divided>,
    /// Why it cannot be written, with the line.
    fixed: Option<(usize, &'static str)>,
}

/// A tool path as it was read.
#[derive(Debug, Clone, PartialEq)]
pub struct ReadPath {
    /// The points, targets in the base frame.
    pub points: Vec<PathPoint>,
    /// The text, for [`ToolPath::write`].
    pub program: ToolPath,
    /// What is to be known about it, in sentences.
    pub findings: Vec<Finding>,
}

/// Reads the tool path `name`; `companion` is the file beside it ([`Kind::companion`]).
///
/// # Errors
/// What cannot be read, or changes the path and is not followed (cutter compensation, a subprogram, a
/// spline), with line and column; no moves; a file above 4 GB.
pub fn read_tool_path(
    kind: Kind,
    (name, bytes): (&str, &[u8]),
    companion: Option<(&str, &[u8])>,
    cell: &Cell,
) -> Result<ReadPath> {
    let mut latin = false;
    let files = [Some((name, bytes)), companion].into_iter().flatten();
    let files: Vec<ProgramFile> = files
        .map(|(name, bytes)| {
            if u32::try_from(bytes.len()).is_err() {
                let error = Error::new(Code::Unsupported, "The file is larger than 4 GB.");
                return Err(error.file(name));
            }
            let text = match decode(bytes) {
                Ok(text) => text.into_owned(),
                // Comments of controllers and older CAM systems.
                Err(_) if !bytes.contains(&0) => {
                    latin = true;
                    bytes.iter().copied().map(char::from).collect()
                }
                Err(error) => return Err(error.file(name)),
            };
            Ok(ProgramFile { name: name.to_string(), text })
        })
        .collect::<Result<_>>()?;
    let mut builder = Builder::new(cell);
    let read = match kind {
        Kind::Apt => apt::read(&files[0], &mut builder),
        Kind::Gcode => gcode::read(&files[0], &mut builder),
        Kind::Robot(language) => robot::read(&files, language, &mut builder),
    };
    read.map_err(|error| match error.hint_text() {
        Some(_) => error,
        None => error.hint(format!(
            "the file is read as {}, by the ending of its name; docs/paths.md says what is read",
            kind.title()
        )),
    })?;
    if builder.points.iter().all(|point| point.rapid) {
        let message = format!("The file has no move at feed as {} has it.", kind.title());
        let error = Error::new(Code::TooFewData, message).file(name);
        return Err(error.hint("the ending of its name says what it is: a table of the path ends in .csv or .xlsx"));
    }
    let in_base = matches!(kind, Kind::Robot(language) if language.poses().is_some_and(|poses| poses.in_base));
    if !in_base && cell.work.workpiece == Isometry3::identity() {
        builder.remark("workpiece-assumed", "", 1, Severity::Caution, || {
            "The cell names no workpiece frame, so the path counts from the base: say where the workpiece is with \
             workpiece_mm in [work]."
                .to_string()
        });
    }
    let findings = builder.findings();
    Ok(ReadPath {
        points: builder.points,
        findings,
        program: ToolPath {
            kind,
            files,
            latin,
            form: builder.form,
            slots: builder.slots,
            values: builder.values,
            ends: builder.ends,
            divided: builder.divided,
            fixed: builder.fixed,
        },
    })
}
