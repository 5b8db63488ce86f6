//! What is asked of the search for the best place of a workpiece.

use crate::error::{Error, Result};
use crate::model::cell::Cell;
use crate::units::deg_to_rad;
use crate::work::map::PlaceOptions;
use crate::work::region::{Region, RegionRequest};
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

/// What is asked of the search beside cell, stiffness and path.
#[derive(Debug, Clone, PartialEq)]
pub struct Request {
    /// Where the workpiece's origin may lie.
    pub region: RegionRequest,
    /// Turns of the workpiece about the base's z to try \[deg\].
    pub yaw_deg: Vec<f64>,
    /// Finer grids, each about the best place so far.
    pub refine: u8,
    /// Turns about the tool axis to try where the path leaves it free.
    pub free_turn: Option<usize>,
}

impl Default for Request {
    /// The plane through the given place, the workpiece as it stands.
    fn default() -> Self {
        Request {
            region: RegionRequest::default(),
            yaw_deg: vec![0.0],
            refine: 2,
            free_turn: None,
        }
    }
}

impl Request {
    /// Refuses what is wrong without a cell.
    ///
    /// # Errors
    /// A turn that is not finite (key `yaw_deg`).
    pub fn check(&self) -> Result<()> {
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
    /// As [`Request::check`] and [`Region::of_places`].
    pub fn place_options(&self, cell: &Cell) -> Result<PlaceOptions> {
        self.check()?;
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

    /// The options as the result holds them; `options` as [`Request::place_options`] gave them.
    pub fn options(&self, options: &PlaceOptions) -> Options {
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
