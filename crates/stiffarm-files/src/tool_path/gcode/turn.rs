//! The tool axis of a block, and the places of its numbers.

use super::State;
use super::effect::Mode;
use super::words::{Word, axis_component};
use crate::program::Number;
use crate::tool_path::Orientation;
use nalgebra::{UnitVector3, Vector3};
use stiffarm::error::Result;

impl State<'_, '_> {
    /// Takes the tool axis.
    pub(super) fn turn(&mut self, words: &[Word<'_>], mode: Mode) -> Result<()> {
        let vectors = self.vectors && matches!(mode, Mode::Rapid | Mode::Feed);
        let vector = words.iter().filter_map(|word| Some((axis_component(word, vectors)?, word)));
        let vector: Vec<(usize, &Word<'_>)> = vector.collect();
        if let Some((_, first)) = vector.first() {
            let mut axis = Vector3::zeros();
            for (component, word) in &vector {
                axis[*component] = word.number.value;
            }
            self.stated = axis.into();
            let Some(axis) = UnitVector3::try_new(axis, 1e-6) else {
                return Err(first.place.wrong("This tool axis has length zero."));
            };
            self.axis = axis;
            self.builder.form.orientation = Orientation::Axis;
        }
        let mut has_turned = false;
        for word in words {
            let Some(axis @ 3..6) = word.axis() else {
                continue;
            };
            let value = word.number.value;
            let angle = self.moved(Some(self.rotary[axis - 3]), value).unwrap_or(value);
            let work = &self.builder.cell.work;
            let is_known = work.rotary.iter().any(|axis| axis.letter() == word.letter);
            if !is_known && angle != 0.0 {
                let letter = char::from(word.letter);
                let message = format!("The rotary axis {letter} turns, and nothing says how it carries the tool.");
                return Err(word.place.wrong(message).hint(
                    "say so in [work] of the cell, in the order in which the axes carry each other, from the workpiece \
                     to the tool, with - where they carry the workpiece: rotary_axes = [\"C\", \"A\"] for a head whose \
                     C carries its A, [\"-C\", \"-A\"] for a table whose A carries its C; `check` shows the tool axis \
                     of one pose",
                ));
            }
            (self.rotary[axis - 3], has_turned) = (angle, true);
        }
        if has_turned {
            self.axis = self.builder.cell.work.tool_axis(self.rotary);
        }
        Ok(())
    }

    /// The places of the numbers of the point given last; what is left out would stand at `end`.
    pub(super) fn slots(&mut self, words: &[Word<'_>], end: usize) {
        // Of an axis that is stated, components that are left out are zero.
        let has_axis = words.iter().any(|word| axis_component(word, self.vectors).is_some());
        for component in 0..6 {
            let word = words.iter().find(|word| match component {
                0..3 => word.axis() == Some(component),
                _ => axis_component(word, self.vectors) == Some(component - 3),
            });
            let value = match component {
                0..3 => self.position[component].unwrap_or_default(),
                _ => self.stated[component - 3],
            };
            let modal = word.is_none() && !(has_axis && component >= 3);
            let number = word.map_or(left_out(value, end), |word| word.number);
            self.builder.numeral(0, component, number, modal);
        }
    }
}

/// The number of a word, for what has none.
fn left_out(value: f64, at: usize) -> Number {
    Number { value, at: at as u32, length: 0 }
}
