//! All that `compensate` says: the commands of a path, and how its postures were found.

use crate::ask::path::{FollowedPath, PathOptions};
use crate::error::Result;
use crate::estimate::saved::Saved;
use crate::findings::{Finding, each_once};
use crate::model::cell::Cell;
use crate::numerics::control::Control;
use crate::units::mm_to_m;
use crate::work::compensate::{CompensateOptions, Compensation, compensate_on};
use crate::work::features::{Deviation, Feature, features};
use crate::work::never_loaded::never_loaded_at_work;
use crate::work::posture_path::PosturePathSummary;
use crate::work::predict::LoadedArm;
use serde::{Deserialize, Serialize};

/// The commands and how the postures were found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Compensated {
    /// The compensation.
    #[serde(flatten)]
    pub compensation: Compensation,
    /// The postures of the nominal path.
    pub postures: PosturePathSummary,
    /// How the features of the path come out, where it names them or a tolerance is given.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub features: Vec<Feature>,
}

impl Compensated {
    /// Every finding of the result, each once.
    pub fn every_finding(&self) -> Vec<Finding> {
        each_once(self.compensation.findings.iter().chain(&self.postures.findings))
    }
}

impl PathOptions {
    /// How to compensate with the stiffness `saved`.
    ///
    /// # Errors
    /// As [`PathOptions::load_uncertainty`].
    pub fn compensate_options(&self, saved: &Saved) -> Result<CompensateOptions> {
        Ok(CompensateOptions {
            load_uncertainty: self.load_uncertainty()?,
            measured_up_to: saved.largest_displacement,
            loaded_up_to: saved.largest_force,
        })
    }

    /// Compensates a path whose postures [`PathOptions::follow`] found.
    ///
    /// # Errors
    /// As [`PathOptions::compensate_options`] and [`compensate`](crate::work::compensate::compensate).
    pub fn compensate(
        &self,
        cell: &Cell,
        saved: &Saved,
        followed: &FollowedPath,
        control: Control<'_>,
    ) -> Result<Compensated> {
        let options = self.compensate_options(saved)?;
        let arm = LoadedArm::new(cell, &saved.predictor)?;
        let mut compensation = compensate_on((cell, &arm), &saved.predictor, &followed.postures, &options, control)?;
        let deviation = |i: usize| {
            let point = &compensation.points[i];
            Deviation {
                shift_m: point.uncompensated_shift_m,
                half_width_m: point.band.map(|band| band.size_m[3]),
                residual_m: Some(point.residual_m),
            }
        };
        let tolerance = self.tolerance_mm.map(mm_to_m);
        let (features, finding) = features((cell, &arm), &followed.postures, tolerance, deviation, control)?;
        compensation.findings.extend(finding);
        let points = followed.postures.iter().zip(&compensation.points);
        let points = points.map(|(posture, point)| (posture, point.uncompensated_shift_m, point.band));
        let untold = never_loaded_at_work((cell, &arm), saved, points)?;
        compensation.findings.extend(untold);
        Ok(Compensated { compensation, postures: followed.summary.clone(), features })
    }
}
