//! All that `predict` says: deflections at the cell's tasks, along a path, or under the
//! load of the identification.

use crate::ask::path::{FollowedPath, PathOptions};
use crate::ask::rules::NotWith;
#[cfg(feature = "clap")]
use crate::ask::values::{MODEL, choice};
use crate::error::{Code, Error, Result};
use crate::estimate::compliance::IdentifiedCompliance;
use crate::estimate::saved::Saved;
use crate::findings::{Finding, each_once};
use crate::model::cell::Cell;
use crate::model::observation::PostureTerms;
use crate::model::path::{LoadedPosture, PathPoint, PathTarget};
use crate::model::stiffness::Model;
use crate::numerics::control::Control;
use crate::units::mm_to_m;
use crate::work::features::{Deviation, Feature, features};
use crate::work::never_loaded::never_loaded_at_work;
use crate::work::posture_path::PosturePathSummary;
use crate::work::predict::{self, LoadPoint, LoadedArm, Prediction, predict_on};
use crate::work::tasks::tasks;
use serde::{Deserialize, Serialize};

/// The deflections and how the postures were found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Predicted {
    /// The deflections.
    #[serde(flatten)]
    pub prediction: Prediction,
    /// The postures of the path; `null` for tasks and with --cell-load.
    pub postures: Option<PosturePathSummary>,
    /// How the features of the path come out, where it names them or a tolerance is given.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub features: Vec<Feature>,
}

impl Predicted {
    /// Every finding of the result, each once.
    pub fn every_finding(&self) -> Vec<Finding> {
        let of_path = self.postures.iter().flat_map(|path| &path.findings);
        each_once(self.prediction.findings.iter().chain(of_path))
    }
}

/// What is asked of a prediction; by default the equilibrium under the loads at the tip.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(rename = "Options"))]
#[cfg_attr(feature = "clap", derive(clap::Args))]
#[serde(default)]
pub struct PredictOptions {
    /// Loads and postures of a path.
    #[serde(flatten)]
    #[cfg_attr(feature = "clap", command(flatten))]
    pub path: PathOptions,
    /// Load the arm by the cell's own [load] at its loading point, not at the tip; the deflection is still that of the
    /// tip
    #[cfg_attr(feature = "clap", arg(long))]
    pub cell_load: bool,
    /// With --cell-load: which of several load cases
    #[cfg_attr(feature = "clap", arg(long, value_name = "NAME", requires = "cell_load"))]
    pub load_case: Option<String>,
    /// How the deflection is calculated
    #[cfg_attr(feature = "clap", arg(long, default_value = "equilibrium", value_parser = choice(MODEL)))]
    pub model: Model,
    /// Also the Cartesian stiffness matrix, with and without K_C, and its principal axes
    #[cfg_attr(feature = "clap", arg(long))]
    pub matrix: bool,
}

/// What is not asked beside what.
pub const NOT_WITH: NotWith = &[("cell_load", &["force_n", "axes", "free_turn", "log"])];

/// Postures and loads of a prediction.
#[derive(Debug, Clone, PartialEq)]
pub struct PredictionInputs {
    /// The cell; at its tasks with their tip.
    pub cell: Cell,
    /// Postures with their loads.
    pub postures: Vec<LoadedPosture>,
    /// How the postures of a path were found.
    pub summary: Option<PosturePathSummary>,
}

impl PredictOptions {
    /// The cell under the load case that is asked for.
    ///
    /// # Errors
    /// An unknown case (key `load_case`); the cell's own load where it has several cases and
    /// none is named (key `cell_load`).
    pub fn under_case(&self, cell: Cell) -> Result<Cell> {
        match &self.load_case {
            Some(name) => cell.under(name).map_err(|e| e.key("load_case")),
            None if self.cell_load && cell.setup.load.has_cases() => {
                let names = cell.setup.load.case_names();
                let message = "The cell has several load cases, and postures bend under one at a time.";
                Err(Error::invalid(message).key("cell_load").hint(format!("add `load_case` with one of them: {names}")))
            }
            None => Ok(cell),
        }
    }

    /// How to predict with the stiffness `saved`.
    ///
    /// # Errors
    /// As [`PathOptions::load_uncertainty`].
    pub fn at_work(&self, saved: &Saved) -> Result<predict::PredictOptions> {
        Ok(predict::PredictOptions {
            model: self.model,
            load_uncertainty: self.path.load_uncertainty()?,
            load_at: self.load_at(),
            stiffness: self.matrix,
            measured_up_to: saved.largest_displacement,
            loaded_up_to: saved.largest_force,
        })
    }

    fn load_at(&self) -> LoadPoint {
        if self.cell_load { LoadPoint::LoadingPoint } else { LoadPoint::Tip }
    }

    /// Postures and loads along `points`, without them at the tasks of the cell, which is
    /// [`PredictOptions::under_case`].
    ///
    /// # Errors
    /// No points and no tasks, or tasks with several tips; poses under the cell's own load; as
    /// [`PathOptions::follow`].
    pub fn loaded(
        &self,
        mut cell: Cell,
        predictor: &IdentifiedCompliance,
        points: Option<&[PathPoint]>,
        control: Control<'_>,
    ) -> Result<PredictionInputs> {
        let (postures, summary) = match points {
            None => {
                let (tip, postures) = tasks(&cell)?;
                // A tip that no task gives stays the cell's, and is said to be a measuring point.
                if tip != cell.work.tip(&cell.setup.tool) {
                    cell.work.tip = Some(tip);
                }
                (postures, None)
            }
            Some(points) if self.cell_load => (under_cell_load(points, &cell)?, None),
            Some(points) => {
                let FollowedPath { postures, summary } = self.path.follow(&cell, predictor, points, control)?;
                (postures, Some(summary))
            }
        };
        Ok(PredictionInputs { cell, postures, summary })
    }

    /// Predicts at postures and loads of [`PredictOptions::loaded`].
    ///
    /// # Errors
    /// As [`PredictOptions::at_work`] and [`predict`](crate::work::predict::predict).
    pub fn predict(&self, loaded: &PredictionInputs, saved: &Saved, control: Control<'_>) -> Result<Predicted> {
        let options = self.at_work(saved)?;
        let mut arm = LoadedArm::new(&loaded.cell, &saved.predictor)?;
        if self.cell_load {
            arm = arm.loaded_by(&loaded.cell);
        }
        let mut prediction = predict_on((&loaded.cell, &arm), &saved.predictor, &loaded.postures, &options, control)?;
        let deviation = |i: usize| {
            let point = &prediction.points[i];
            Deviation { shift_m: point.shift_m, half_width_m: point.band.map(|band| band.size_m[3]), residual_m: None }
        };
        let tolerance = self.path.tolerance_mm.map(mm_to_m);
        let (features, finding) = features((&loaded.cell, &arm), &loaded.postures, tolerance, deviation, control)?;
        prediction.findings.extend(finding);
        let points = loaded.postures.iter().zip(&prediction.points);
        let points = points.map(|(posture, point)| (posture, point.shift_m, point.band));
        let untold = never_loaded_at_work((&loaded.cell, &arm), saved, points)?;
        prediction.findings.extend(untold);
        Ok(Predicted { prediction, postures: loaded.summary.clone(), features })
    }
}

/// Postures under the cell's own load.
fn under_cell_load(points: &[PathPoint], cell: &Cell) -> Result<Vec<LoadedPosture>> {
    let postures = points.iter().map(|point| {
        let PathTarget::Angles(q) = &point.target else {
            return Err(Error::new(Code::Unsupported, "With the cell's own load the postures must be joint angles.")
                .key("cell_load")
                .hint("give columns q1_deg, q2_deg, …"));
        };
        let terms = PostureTerms::new(&cell.setup, q, None)?;
        Ok(LoadedPosture {
            name: point.name.clone(),
            line: point.line,
            feature: point.feature.clone(),
            wrench: *terms.wrench(),
            q: q.clone(),
        })
    });
    postures.collect()
}
