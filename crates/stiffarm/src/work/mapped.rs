//! What is asked of a map of stiffness: where, how the tool is held, under which load.

use crate::error::{Error, Result};
use crate::model::cell::Cell;
use crate::model::load::Wrench;
use crate::model::process::ForceAxes;
use crate::units::deg_to_rad;
use crate::work::map::MapOptions;
use crate::work::region::{Region, RegionRequest};
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

/// What is asked of a map beside cell and stiffness.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Request {
    /// Where to map.
    pub region: RegionRequest,
    /// Orientation of the tip frame: turns about the base's x, then y, then z \[deg\]; without
    /// one the tool axis is down.
    pub rpy_deg: Option<[f64; 3]>,
    /// Turns about the tool axis to try, where it is free.
    pub free_turn: Option<usize>,
    /// Force on the robot at the tip, base axes \[N\]; without one the cell's `[work]` force,
    /// else 1 N along the direction.
    pub force_n: Option<[f64; 3]>,
    /// Moment about the tip, base axes \[N·m\].
    pub moment_nm: Option<[f64; 3]>,
    /// Direction of the stiffness, base axes; without one along the force, else against the
    /// tool axis.
    pub direction: Option<[f64; 3]>,
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

impl Request {
    /// What is mapped.
    ///
    /// # Errors
    /// As [`Region::of_map`]; a direction of length zero (key `direction`).
    pub fn map_options(&self, cell: &Cell) -> Result<MapOptions> {
        let region = Region::of_map(cell, &self.region)?;
        let [roll, pitch, yaw] = self.rpy_deg.unwrap_or(DOWN_DEG).map(deg_to_rad);
        let rotation = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
        let direction = match self.direction {
            Some(direction) => Some(
                UnitVector3::try_new(Vector3::from(direction), f64::MIN_POSITIVE).ok_or_else(
                    || {
                        let message = "The direction must not have length zero.";
                        Error::invalid(message).key("direction")
                    },
                )?,
            ),
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
        Ok(MapOptions {
            rotation,
            free_turn: self.free_turn,
            direction,
            wrench: wrench.unwrap_or_else(|| Wrench::force(direction.into_inner())),
            ..MapOptions::new(region.lower, region.upper, region.steps)
        })
    }

    /// The load at the tip in base axes, where there is one.
    fn load(&self, cell: &Cell, rotation: &UnitQuaternion<f64>) -> (Option<Wrench>, LoadSource) {
        if let Some(force) = self.force_n {
            let wrench = Wrench {
                force: Vector3::from(force),
                moment: Vector3::from(self.moment_nm.unwrap_or_default()),
            };
            return (Some(wrench), LoadSource::Given);
        }
        match cell.work.process.as_ref().and_then(|p| p.load().at(None)) {
            Some(load) if load.axes != ForceAxes::Path && load.force.norm() > 0.0 => {
                let turn = match load.axes {
                    ForceAxes::Tool => *rotation,
                    ForceAxes::Workpiece => cell.work.workpiece.rotation,
                    ForceAxes::Base | ForceAxes::Path => UnitQuaternion::identity(),
                };
                let wrench = Wrench {
                    force: turn * load.force,
                    moment: turn * load.moment,
                };
                (Some(wrench), LoadSource::Cell)
            }
            Some(_) => (None, LoadSource::CellAlongPath),
            None => (None, LoadSource::Unit),
        }
    }

    /// The options as the result holds them; `options` as [`Request::map_options`] gave them.
    pub fn options(&self, options: &MapOptions, cell: &Cell) -> Options {
        Options {
            rpy_deg: self.rpy_deg.unwrap_or(DOWN_DEG),
            free_turn: options.free_turn,
            steps: options.steps,
            characteristic_length_m: cell.characteristic_length,
            load_from: self.load(cell, &options.rotation).1,
        }
    }
}
