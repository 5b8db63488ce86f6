//! Which columns tables of measurements may have, and what the headings say that they hold.

use super::beside::RowQuantity;
use super::grid::Table;
use super::heading::{ColumnDefinition, find_heading, stem};
use super::path::path_definitions;
use super::quantity::Quantity;
use stiffarm::error::{Code, Result};

/// What the three lengths of a row are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Values {
    /// `x`, `y`, `z`: positions as the tracker gave them.
    Positions,
    /// `dx`, `dy`, `dz`: loaded minus reference position.
    Displacements,
}

impl Values {
    pub(super) fn stems(self) -> [&'static str; 3] {
        match self {
            Values::Positions => ["x", "y", "z"],
            Values::Displacements => ["dx", "dy", "dz"],
        }
    }

    pub(super) fn components(self) -> [ColumnDefinition; 3] {
        let group = match self {
            Values::Positions => "position",
            Values::Displacements => "displacement",
        };
        self.stems().map(|stem| ColumnDefinition::of(stem, Quantity::Length, group))
    }

    /// What its rows may have beside names, lengths and angles.
    pub(super) fn beside(self) -> impl Iterator<Item = RowQuantity> {
        let all = RowQuantity::ALL.into_iter();
        all.filter(move |quantity| self == Values::Positions || quantity.is_of_displacements())
    }

    /// The columns that a table of these values may have.
    pub(super) fn definitions(self, joints: usize) -> Vec<ColumnDefinition> {
        let mut definitions = ["posture", "state", "point"].map(ColumnDefinition::name).to_vec();
        definitions.extend(self.components());
        definitions.extend(self.beside().flat_map(RowQuantity::definitions));
        definitions.extend(ColumnDefinition::angles(joints));
        definitions
    }

    /// What the heading says that the table holds.
    ///
    /// # Errors
    /// Both, or neither.
    pub(super) fn of(table: &Table<'_>, joints: usize) -> Result<Self> {
        let first = |values: Values| {
            let is_component = |name: &str| values.stems().contains(&stem(name));
            let mut headings = table.headings.iter();
            headings.position(|heading| !heading.ignored && is_component(&heading.name))
        };
        match (first(Values::Positions), first(Values::Displacements)) {
            (Some(_), None) => Ok(Values::Positions),
            (None, Some(_)) => Ok(Values::Displacements),
            (Some(position), Some(displacement)) => {
                let second = position.max(displacement);
                let message = "The table has both positions and displacements.";
                let error = table.heading_error(Some(second), Code::Conflict, message);
                Err(error.hint("keep x, y, z or dx, dy, dz; `ignore` in [columns] of the cell file leaves columns out"))
            }
            (None, None) => {
                // A heading that is no heading has an error of its own.
                table.check_heading(&measurement_definitions(joints), joints)?;
                let message = "The table has neither positions nor displacements.";
                let error = table.heading_error(None, Code::TableHeading, message);
                Err(error.hint(
                    "give x_mm, y_mm, z_mm as the tracker read them, or dx_mm, dy_mm, dz_mm: loaded minus unloaded, \
                     base axes",
                ))
            }
        }
    }
}

/// Every column that a measurement table may have.
fn measurement_definitions(joints: usize) -> Vec<ColumnDefinition> {
    let mut definitions = Values::Positions.definitions(joints);
    let displacements = Values::Displacements.components();
    definitions.splice(3..3, displacements);
    definitions
}

/// Every column that a table of measurements or of a path may have: those for
/// which the cell file can name other headings.
fn all_definitions(joints: usize) -> Vec<ColumnDefinition> {
    let mut definitions = measurement_definitions(joints);
    for column in path_definitions(joints) {
        if !definitions.iter().any(|k| k.heading() == column.heading()) {
            definitions.push(column);
        }
    }
    definitions
}

/// A heading of tables as this program writes it, whatever its case.
///
/// # Errors
/// A name that no table of measurements or of a path has, with the nearest, among
/// `also`, too, as a hint.
pub(crate) fn own_heading(name: &str, joints: usize, also: &str) -> Result<String> {
    find_heading(name, &all_definitions(joints), joints, also)
}

/// Every heading of tables of measurements and of paths in every unit, for
/// `joints` joints.
#[cfg(feature = "schema")]
pub(crate) fn own_headings(joints: usize) -> Vec<String> {
    let definitions = all_definitions(joints);
    definitions.iter().flat_map(ColumnDefinition::headings).collect()
}
