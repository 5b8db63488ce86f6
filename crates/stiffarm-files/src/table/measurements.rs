//! Displacements or raw readings, as the heading says.

use super::displacements::displacements;
use super::foreign::Names;
use super::grid::Table;
use super::readings::readings;
use super::values::Values;
use stiffarm::error::Result;
use stiffarm::model::cell::Cell;
use stiffarm::model::measurement::Measurements;
use stiffarm::model::posture::Posture;

/// Reads a measurement table: displacements (loaded minus unloaded position, base axes) where its heading has `dx`,
/// `dy`, `dz`, with one row per posture, load state and measuring point; and raw readings, positions in tracker axes,
/// where it has `x`, `y`, `z`, with one row per posture, state, point and repeat (docs/readings.md). Controller angles
/// come from the table's own columns or, by the posture's name, from `postures`; `file_name` is for messages.
///
/// # Errors
/// A heading with both or neither, a heading or row that cannot be read, unknown names, values that contradict each
/// other, angles outside the machine's limits, a posture without the readings that it needs: with line, column and the
/// column's name.
pub fn read_measurements(
    bytes: &[u8],
    file_name: &str,
    cell: &Cell,
    postures: Option<&[Posture]>,
) -> Result<Measurements> {
    read_measurements_of(&[(bytes, file_name)], cell, postures)
}

/// Reads several files with the same columns, for example one per posture, as one
/// measurement table; each file is its bytes and its name for messages.
///
/// # Errors
/// Files with different columns, and everything of [`read_measurements`].
pub fn read_measurements_of(
    files: &[(&[u8], &str)],
    cell: &Cell,
    postures: Option<&[Posture]>,
) -> Result<Measurements> {
    read_of(files, cell, postures, false)
}

/// As [`read_measurements_of`], of files that are still being filled: the last posture is in
/// [`ReadingTable::incomplete`](stiffarm::model::measurement::ReadingTable::incomplete) while it has fewer states
/// or readings than those before it.
///
/// # Errors
/// As [`read_measurements_of`].
pub fn read_growing_measurements(
    files: &[(&[u8], &str)],
    cell: &Cell,
    postures: Option<&[Posture]>,
) -> Result<Measurements> {
    read_of(files, cell, postures, true)
}

fn read_of(files: &[(&[u8], &str)], cell: &Cell, postures: Option<&[Posture]>, growing: bool) -> Result<Measurements> {
    let table = Table::read_all(files, &cell.columns, &names(cell, postures), growing)?;
    let read = || match Values::of(&table, cell.setup.robot.joint_count())? {
        Values::Positions => readings(&table, cell, postures, growing).map(Measurements::Readings),
        Values::Displacements => displacements(&table, cell, postures).map(Measurements::Displacements),
    };
    read().map_err(|error| table.with_aside(error))
}

/// The names that cell and plan know.
fn names<'n>(cell: &'n Cell, postures: Option<&'n [Posture]>) -> Names<'n> {
    let points = cell.setup.tool.measuring_points.iter();
    let cases = cell.setup.load.cases().iter();
    Names {
        postures: postures.into_iter().flatten().map(|p| p.name.as_str()).collect(),
        points: points.map(|point| point.name.as_str()).collect(),
        cases: cases.map(|case| case.name.as_str()).collect(),
    }
}

/// True where the heading is that of measurements: of displacements or of positions.
///
/// # Errors
/// Not a table.
pub fn holds_measurements(bytes: &[u8], file_name: &str, cell: &Cell) -> Result<bool> {
    let table = Table::read_all(&[(bytes, file_name)], &cell.columns, &names(cell, None), false)?;
    Ok(Values::of(&table, cell.setup.robot.joint_count()).is_ok())
}
