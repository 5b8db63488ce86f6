//! Displacements or raw readings, as the heading says.

use super::displacements::displacements;
use super::grid::Table;
use super::readings::readings;
use super::values::Values;
use stiffarm::error::{Code, Result};
use stiffarm::model::cell::Cell;
use stiffarm::model::measurement::Measurements;
use stiffarm::model::posture::Posture;

/// Reads a measurement table: displacements where its heading has `dx`, `dy`,
/// `dz`, as [`read_displacements`](super::read_displacements), and raw readings
/// where it has `x`, `y`, `z`, as [`read_readings`](super::read_readings).
///
/// # Errors
/// A heading with both or neither, and everything of these two.
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

fn read_of(
    files: &[(&[u8], &str)],
    cell: &Cell,
    postures: Option<&[Posture]>,
    growing: bool,
) -> Result<Measurements> {
    let table = Table::read_all(files, &cell.columns)?;
    let read = || match Values::of(&table, cell.setup.robot.joint_count())? {
        Values::Positions => readings(&table, cell, postures, growing).map(Measurements::Readings),
        Values::Displacements => {
            displacements(&table, cell, postures).map(Measurements::Displacements)
        }
    };
    read().map_err(|error| table.with_aside(error))
}

/// True where the heading is that of measurements: of displacements or of positions.
///
/// # Errors
/// Not a table.
pub fn holds_measurements(bytes: &[u8], file_name: &str, cell: &Cell) -> Result<bool> {
    let table = Table::read(bytes, file_name, &cell.columns)?;
    Ok(Values::of(&table, cell.setup.robot.joint_count()).is_ok())
}

impl Table<'_> {
    /// Refuses a table of other values.
    pub(super) fn expect(&self, wanted: Values, cell: &Cell) -> Result<()> {
        let found = Values::of(self, cell.setup.robot.joint_count())?;
        let (message, hint) = match wanted {
            _ if found == wanted => return Ok(()),
            Values::Displacements => (
                "The table holds positions, not displacements.",
                "give dx_mm, dy_mm, dz_mm: loaded minus unloaded, base axes",
            ),
            Values::Positions => (
                "The table holds displacements, not positions.",
                "give x_mm, y_mm, z_mm as the tracker read them",
            ),
        };
        Err(self
            .heading_error(None, Code::TableHeading, message)
            .hint(hint))
    }
}
