//! What is asked of a map of stiffness: where, how the tool is held, under which load.

use crate::ask::region::{Region, RegionOptions};
use crate::ask::rules::NotWith;
#[cfg(feature = "clap")]
use crate::ask::values::{number, triple, within};
use crate::error::{Error, Result};
use crate::model::cell::Cell;
use crate::model::load::Wrench;
use crate::model::process::ForceAxes;
use crate::units::deg_to_rad;
use crate::work::map;
#[cfg(feature = "clap")]
use crate::work::map::MOST_TURNS;
use nalgebra::{UnitQuaternion, UnitVector3, Vector3};
use serde::{Deserialize, Serialize};

/// The tool axis down.
const DOWN_DEG: [f64; 3] = [180.0, 0.0, 0.0];

/// Options of the result.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Options {
    /// Orientation of the tip frame: turns about the base's x, then y, then z \[deg\].
    pub rpy_deg: [f64; 3],
    /// Turns about the tool axis that were tried, where it is free.
    pub free_turn: Option<usize>,
    /// Nodes along x, y, z.
    pub steps: [usize; 3],
    /// L of Eq. (20) \[m\].
    pub characteristic_length_m: Option<f64>,
    /// Where the load comes from.
    pub load_from: LoadSource,
}

/// What is asked of a map, or of the best place for a workpiece.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "clap", derive(clap::Args))]
pub struct MapOptions {
    /// Where to map, or where the workpiece's origin may lie.
    #[cfg_attr(feature = "clap", command(flatten))]
    pub region: RegionOptions,
    /// Orientation of the tip frame: turns about the base's x, then y, then z [deg] [default:
    /// 180,0,0, the tool axis down]
    #[cfg_attr(feature = "clap", arg(long, value_name = "R,P,Y", help_heading = TOOL, value_parser = triple("deg"),
        allow_hyphen_values = true))]
    pub rpy_deg: Option<[f64; 3]>,
    /// The turn about the tool axis is free: try N of them and take the best [default: 24]
    #[cfg_attr(feature = "clap", arg(long, value_name = "N", help_heading = TOOL, num_args = 0..=1,
        default_missing_value = "24", require_equals = true, value_parser = within::<usize>(1..=MOST_TURNS as u64)))]
    pub free_turn: Option<usize>,
    /// Force on the robot at the tip, base axes [N] [default: the cell's [work] force, else 1 N
    /// along the direction]
    #[cfg_attr(feature = "clap", arg(long, value_name = "X,Y,Z", help_heading = TOOL,
        value_parser = triple("force_n"), allow_hyphen_values = true))]
    pub force_n: Option<[f64; 3]>,
    /// Moment about the tip, base axes [N·m]
    #[cfg_attr(feature = "clap", arg(long, value_name = "X,Y,Z", help_heading = TOOL,
        value_parser = triple("moment_nm"), allow_hyphen_values = true, requires = "force_n"))]
    pub moment_nm: Option<[f64; 3]>,
    /// Direction of the stiffness, base axes [default: along the force, else against the tool axis]
    #[cfg_attr(feature = "clap", arg(long, value_name = "X,Y,Z", help_heading = TOOL,
        value_parser = triple("direction"), allow_hyphen_values = true))]
    pub direction: Option<[f64; 3]>,
    /// Turns of the workpiece about the base's z to try [deg]
    #[cfg_attr(feature = "clap", arg(long, value_name = "A,…", help_heading = PLACE, value_delimiter = ',',
        value_parser = number("deg"), allow_hyphen_values = true, default_value = "0", requires = "place"))]
    pub yaw_deg: Vec<f64>,
    /// Finer grids, each about the best place so far
    #[cfg_attr(feature = "clap", arg(long, value_name = "N", help_heading = PLACE, default_value_t = 2,
        requires = "place", value_parser = within::<u8>(0..=8)))]
    pub refine: u8,
}

/// What is not asked beside what.
pub const NOT_WITH: NotWith = &[("place", &["rpy_deg", "force_n", "direction"])];

#[cfg(feature = "clap")]
const TOOL: &str = "Tool and load";
#[cfg(feature = "clap")]
const PLACE: &str = "Best place of the workpiece";

impl Default for MapOptions {
    /// What the cell says; the workpiece as it stands.
    fn default() -> Self {
        MapOptions {
            region: RegionOptions::default(),
            rpy_deg: None,
            free_turn: None,
            force_n: None,
            moment_nm: None,
            direction: None,
            yaw_deg: vec![0.0],
            refine: 2,
        }
    }
}

/// Where the load of a map comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum LoadSource {
    /// The force that was given.
    Given,
    /// The cell's process.
    Cell,
    /// 1 N along the direction: the cell's process gives a load in the axes of a path, which a
    /// map has not.
    CellAlongPath,
    /// 1 N along the direction: there is no force.
    Unit,
}

impl MapOptions {
    /// What is mapped.
    ///
    /// # Errors
    /// As [`Region::of_map`]; a direction of length zero (key `direction`).
    pub fn map_options(&self, cell: &Cell) -> Result<map::MapOptions> {
        let region = Region::of_map(cell, &self.region)?;
        let [roll, pitch, yaw] = self.rpy_deg.unwrap_or(DOWN_DEG).map(deg_to_rad);
        let rotation = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
        let direction = match self.direction {
            Some(direction) => {
                Some(UnitVector3::try_new(Vector3::from(direction), f64::MIN_POSITIVE).ok_or_else(|| {
                    let message = "The direction must not have length zero.";
                    Error::invalid(message).key("direction")
                })?)
            }
            None => None,
        };
        let (wrench, _) = self.load(cell, &rotation);
        let fixed = |v: Vector3<f64>| (v.norm() > 0.0).then_some(v);
        // Against the tool axis, as the process pushes the tool back.
        let back = UnitVector3::new_normalize(rotation * -Vector3::z());
        let direction = direction.unwrap_or_else(|| {
            let along = wrench.and_then(|w| fixed(w.force));
            along.map_or(back, UnitVector3::new_normalize)
        });
        Ok(map::MapOptions {
            rotation,
            free_turn: self.free_turn,
            direction,
            wrench: wrench.unwrap_or_else(|| Wrench::force(direction.into_inner())),
            ..map::MapOptions::new(region.lower, region.upper, region.steps)
        })
    }

    /// The load at the tip in base axes, where there is one.
    fn load(&self, cell: &Cell, rotation: &UnitQuaternion<f64>) -> (Option<Wrench>, LoadSource) {
        if let Some(force) = self.force_n {
            let wrench =
                Wrench { force: Vector3::from(force), moment: Vector3::from(self.moment_nm.unwrap_or_default()) };
            return (Some(wrench), LoadSource::Given);
        }
        match cell.work.process.as_ref().and_then(|p| p.load().at(None)) {
            Some(load) if load.axes != ForceAxes::Path && load.force.norm() > 0.0 => {
                let turn = match load.axes {
                    ForceAxes::Tool => *rotation,
                    ForceAxes::Workpiece => cell.work.workpiece.rotation,
                    ForceAxes::Base | ForceAxes::Path => UnitQuaternion::identity(),
                };
                let wrench = Wrench { force: turn * load.force, moment: turn * load.moment };
                (Some(wrench), LoadSource::Cell)
            }
            Some(_) => (None, LoadSource::CellAlongPath),
            None => (None, LoadSource::Unit),
        }
    }

    /// The options as the result holds them; `options` as [`MapOptions::map_options`] gave them.
    pub fn options(&self, options: &map::MapOptions, cell: &Cell) -> Options {
        Options {
            rpy_deg: self.rpy_deg.unwrap_or(DOWN_DEG),
            free_turn: options.free_turn,
            steps: options.steps,
            characteristic_length_m: cell.characteristic_length,
            load_from: self.load(cell, &options.rotation).1,
        }
    }
}
