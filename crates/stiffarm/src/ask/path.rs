//! Loads and postures along a path, as predictions and compensations are asked for.

#[cfg(feature = "clap")]
use crate::ask::values::{AXES, choice, number, triple, within};
use crate::error::{Error, Result};
use crate::estimate::compliance::IdentifiedCompliance;
use crate::model::cell::Cell;
use crate::model::inverse::InverseKinematics;
use crate::model::path::{LoadedPosture, PathPoint};
use crate::model::process::{ForceAxes, TipLoad};
use crate::numerics::control::Control;
use crate::units::{deg_to_rad, percent_to_fraction};
use crate::work::posture_path::{PosturePathOptions, PosturePathSummary, posture_path};
use crate::work::predict::LoadedArm;
use serde::{Deserialize, Serialize};

/// Turns about the tool axis that are tried where a path gives the axis alone.
const TURNS: usize = 72;

/// Loads and postures along a path.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "clap", derive(clap::Args))]
#[serde(default)]
pub struct PathOptions {
    /// Axes of --force-n, and of the forces of a path without a column `axes`
    #[cfg_attr(feature = "clap", arg(long, value_name = "AXES", value_parser = choice(AXES)))]
    pub axes: Option<ForceAxes>,
    /// Force on the robot's tip [N] where the path has none [default: the cell's [work]]
    #[cfg_attr(feature = "clap", arg(long, value_name = "X,Y,Z", value_parser = triple("force_n"),
        allow_hyphen_values = true))]
    pub force_n: Option<[f64; 3]>,
    /// Moment about the tip [N·m], with --force-n
    #[cfg_attr(feature = "clap", arg(long, value_name = "X,Y,Z", value_parser = triple("moment_nm"),
        allow_hyphen_values = true, requires = "force_n"))]
    pub moment_nm: Option<[f64; 3]>,
    /// Standard uncertainty of the load at work [%]
    #[cfg_attr(feature = "clap", arg(long, value_name = "X", default_value_t = 0.0, value_parser = number("percent")))]
    pub load_uncertainty_percent: f64,
    /// Posture that the first one should be near [deg] [default: the branch that bends least]
    #[cfg_attr(feature = "clap", arg(long, value_name = "Q1,…", value_delimiter = ',', value_parser = number("deg"),
        allow_hyphen_values = true))]
    pub near_deg: Option<Vec<f64>>,
    /// Largest change of a joint from one point to the next [deg]; more is a jump
    #[cfg_attr(feature = "clap", arg(long, value_name = "X", default_value_t = 30.0, value_parser = number("step_deg")))]
    pub max_step_deg: f64,
    /// Tolerance of those features of the path to which the cell gives none [mm]: how far each may come out beside
    /// where it should be
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "clap", arg(long, value_name = "X", value_parser = number("mm")))]
    pub tolerance_mm: Option<f64>,
    /// The turn about the tool axis is free: try N of them at each point and take the postures that
    /// bend least [default: 72]
    #[cfg_attr(feature = "clap", arg(long, value_name = "N", num_args = 0..=1, default_missing_value = "72",
        require_equals = true, value_parser = within::<u16>(1..=3600)))]
    pub free_turn: Option<u16>,
}

impl Default for PathOptions {
    /// The loads of the path or of the cell's process, known exactly; steps up to 30°.
    fn default() -> Self {
        PathOptions {
            axes: None,
            force_n: None,
            moment_nm: None,
            load_uncertainty_percent: 0.0,
            near_deg: None,
            max_step_deg: 30.0,
            free_turn: None,
            tolerance_mm: None,
        }
    }
}

/// The postures of a path with their loads.
#[derive(Debug, Clone, PartialEq)]
pub struct FollowedPath {
    /// Postures with their loads, point by point.
    pub postures: Vec<LoadedPosture>,
    /// How they were found.
    pub summary: PosturePathSummary,
}

impl PathOptions {
    /// Relative standard uncertainty of the load.
    ///
    /// # Errors
    /// A negative number, or one that is not finite (key `load_uncertainty_percent`).
    pub fn load_uncertainty(&self) -> Result<f64> {
        let percent = self.load_uncertainty_percent;
        if percent.is_finite() && percent >= 0.0 {
            Ok(percent_to_fraction(percent))
        } else {
            Err(wrong("load_uncertainty_percent", format!("The uncertainty must be 0 % or more, got {percent} %.")))
        }
    }

    /// The load where the path has none, if one is given.
    fn load(&self) -> Result<Option<TipLoad>> {
        let Some(force) = self.force_n else {
            return Ok(None);
        };
        let Some(axes) = self.axes else {
            let error = wrong("force_n", "The axes of the force are not given.".to_string());
            return Err(error.hint("say its axes: `axes` base, tool, workpiece or path"));
        };
        Ok(Some(TipLoad { force: force.into(), moment: self.moment_nm.unwrap_or_default().into(), axes }))
    }

    /// Options of the search for postures; the load given here comes before that of the cell.
    ///
    /// # Errors
    /// A start that is no posture of the robot (key `near_deg`), a step that is not above zero
    /// (key `max_step_deg`), a force without axes (key `force_n`).
    pub fn posture_options(&self, cell: &Cell) -> Result<PosturePathOptions> {
        let joints = cell.setup.robot.joint_count();
        let start = self.near_deg.as_deref();
        if start.is_some_and(|q| q.len() != joints || q.iter().any(|a| !a.is_finite())) {
            return Err(wrong("near_deg", format!("The start needs {joints} angles in degrees, one per joint.")));
        }
        if let Some(mm) = self.tolerance_mm
            && !(mm.is_finite() && mm > 0.0)
        {
            return Err(wrong("tolerance_mm", format!("The tolerance must be above 0 mm, got {mm} mm.")));
        }
        if !(self.max_step_deg.is_finite() && self.max_step_deg > 0.0) {
            return Err(wrong("max_step_deg", format!("The step must be above 0°, got {}°.", self.max_step_deg)));
        }
        let process = match self.load()? {
            Some(load) => Some(load.into()),
            None => cell.work.process.as_ref().map(|p| p.load()),
        };
        Ok(PosturePathOptions {
            start: start.map(|q| q.iter().copied().map(deg_to_rad).collect()),
            largest_step: deg_to_rad(self.max_step_deg),
            free_turn: self.free_turn.is_some(),
            turns: self.free_turn.map_or(TURNS, usize::from),
            process,
            workpiece: cell.work.workpiece,
        })
    }

    /// Finds the postures of a path.
    ///
    /// # Errors
    /// As [`PathOptions::posture_options`] and [`posture_path`].
    pub fn follow(
        &self,
        cell: &Cell,
        predictor: &IdentifiedCompliance,
        points: &[PathPoint],
        control: Control<'_>,
    ) -> Result<FollowedPath> {
        let options = self.posture_options(cell)?;
        let arm = LoadedArm::new(cell, predictor)?;
        let inverse = InverseKinematics::new(&cell.setup.robot);
        let (postures, summary) = posture_path(&arm, &inverse, points, &options, control)?;
        Ok(FollowedPath { postures, summary })
    }
}

fn wrong(key: &str, message: String) -> Error {
    Error::invalid(message).key(key)
}
