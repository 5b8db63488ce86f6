//! The columns of a measurement table that is written, and what stands in them.

use super::beside::{RowContents, RowQuantity};
use super::heading::ColumnDefinition;
use super::postures::angle_names;
use super::values::Values;
use stiffarm::model::cell::Cell;

/// The columns of a measurement table that is written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Layout {
    values: Values,
    beside: Vec<RowQuantity>,
}

impl Layout {
    /// With what is `wanted` beside names, lengths and angles.
    pub(super) fn new(values: Values, wanted: impl Fn(RowQuantity) -> bool) -> Self {
        let beside = values.beside().filter(|beside| wanted(*beside));
        Layout { values, beside: beside.collect() }
    }

    /// Whether it has these columns.
    pub(super) fn has(&self, beside: RowQuantity) -> bool {
        self.beside.contains(&beside)
    }

    pub(super) fn heading(&self, cell: &Cell) -> Vec<String> {
        let names = ["posture", "state", "point"].map(ColumnDefinition::name);
        let lengths = self.values.components();
        let beside = self.beside.iter().flat_map(|beside| beside.definitions());
        let definitions = names.into_iter().chain(lengths).chain(beside);
        let angles = angle_names(cell.setup.robot.joint_count());
        definitions.map(|definition| definition.heading()).chain(angles).collect()
    }

    /// The fields between lengths and angles, empty where there is no value.
    pub(super) fn fields(&self, contents: &RowContents<'_>) -> impl Iterator<Item = String> {
        self.beside.iter().flat_map(|beside| beside.texts(contents))
    }
}
