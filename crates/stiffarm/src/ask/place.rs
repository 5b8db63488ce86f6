//! What is asked of the search for the best place of a workpiece.

use crate::ask::map::MapOptions;
use crate::ask::region::Region;
use crate::error::{Error, Result};
use crate::model::cell::Cell;
use crate::units::deg_to_rad;
use crate::work::map::PlaceOptions;
use serde::{Deserialize, Serialize};

/// Options of the result.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Options {
    /// Lower corner of the box for the workpiece's origin, base frame \[m\].
    pub lower_m: [f64; 3],
    /// Upper corner \[m\].
    pub upper_m: [f64; 3],
    /// Places along x, y, z in the first round.
    pub steps: [usize; 3],
    /// Turns of the workpiece about the base's z \[deg\].
    pub yaw_deg: Vec<f64>,
    /// Finer rounds.
    pub refine: u8,
    /// Turns about the tool axis, tried where the path leaves it free.
    pub free_turns: usize,
}

impl MapOptions {
    /// Refuses what is wrong with the places without a cell.
    ///
    /// # Errors
    /// A turn that is not finite (key `yaw_deg`).
    pub fn check_places(&self) -> Result<()> {
        match self.yaw_deg.iter().find(|yaw| !yaw.is_finite()) {
            Some(yaw) => {
                let message = format!("The turn must be a finite number, got {yaw}.");
                Err(Error::invalid(message).key("yaw_deg"))
            }
            None => Ok(()),
        }
    }

    /// Where and how to search.
    ///
    /// # Errors
    /// As [`MapOptions::check_places`] and [`Region::of_places`].
    pub fn place_options(&self, cell: &Cell) -> Result<PlaceOptions> {
        self.check_places()?;
        let region = Region::of_places(cell, &self.region)?;
        let default = PlaceOptions::default();
        Ok(PlaceOptions {
            lower: region.lower,
            upper: region.upper,
            steps: region.steps,
            yaws: self.yaw_deg.iter().copied().map(deg_to_rad).collect(),
            free_turns: self.free_turn.unwrap_or(default.free_turns),
            refinements: usize::from(self.refine),
        })
    }

    /// The options as the result holds them; `options` as [`MapOptions::place_options`] gave them.
    pub fn of_places(&self, options: &PlaceOptions) -> Options {
        Options {
            lower_m: options.lower,
            upper_m: options.upper,
            steps: options.steps,
            yaw_deg: self.yaw_deg.clone(),
            refine: self.refine,
            free_turns: options.free_turns,
        }
    }
}
