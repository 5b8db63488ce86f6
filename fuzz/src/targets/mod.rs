//! What is fuzzed: each reader, and the command.

mod commands;
mod logs;
mod meshes;
mod readers;
mod workbooks;

use crate::input::Input;
use crate::random::Random;

/// What became of a sound input: true where it was accepted.
pub type Verdict = Result<bool, String>;

/// One thing that takes inputs.
pub struct Target {
    /// Its name on the command line.
    pub name: &'static str,
    /// Makes an input.
    pub make: fn(&mut Random) -> Input,
    /// Runs it; the error is the fault that it shows.
    pub check: fn(&Input) -> Verdict,
    /// Whether its inputs are command lines.
    pub is_command: bool,
    /// Its weight in a run over all targets.
    pub share: u32,
}

/// Every target.
pub const ALL: [Target; 20] = [
    reader("cell", readers::make_cell, readers::cell),
    reader("postures", readers::make_postures, readers::postures),
    reader("measurements", readers::make_displacements, readers::measurements),
    reader("readings", readers::make_readings, readers::measurements),
    reader("clamped", readers::make_clamped, readers::clamped),
    reader("pairs", readers::make_pairs, readers::pairs),
    reader("poses", readers::make_poses, readers::poses),
    reader("path", readers::make_path, readers::path),
    reader("log", readers::make_log, readers::log),
    reader("stiffness", readers::make_stiffness, readers::stiffness),
    reader("registration", readers::make_registration, readers::registration),
    reader("urdf", readers::make_urdf, readers::urdf),
    reader("rows", readers::make_rows, readers::rows),
    reader("tool-path", readers::make_tool_path, readers::tool_path),
    reader("program", readers::make_program, readers::program),
    reader("mesh", meshes::make, meshes::check),
    reader("workbook", workbooks::make, workbooks::check),
    reader("workbook-bytes", workbooks::make_bytes, workbooks::check),
    Target { name: "command", make: commands::make, check: commands::check, is_command: true, share: 4 },
    Target { name: "line", make: commands::make_line, check: commands::check, is_command: true, share: 2 },
];

const fn reader(name: &'static str, make: fn(&mut Random) -> Input, check: fn(&Input) -> Verdict) -> Target {
    Target { name, make, check, is_command: false, share: 1 }
}

/// The target of that name.
pub fn named(name: &str) -> Option<&'static Target> {
    static TARGETS: [Target; 20] = ALL;
    TARGETS.iter().find(|target| target.name == name)
}
