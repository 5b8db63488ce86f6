//! The joint stiffness that a command works with: saved by `identify`, or the
//! cell's prior.

use crate::session::Session;
use serde_json::Value;
use stiffarm::estimate::compliance::{FittedNoise, IdentifiedCompliance};
use stiffarm::estimate::identify::Estimates;
use stiffarm::estimate::systematic::SystematicErrors;
use stiffarm::model::cell::Cell;
use stiffarm::{Code, Error, Result};

/// Stands for the cell's prior stiffness where a file name could stand.
const PRIOR: &str = "prior";

/// A stiffness as `identify` saved it.
pub struct Saved {
    /// What calculates displacements.
    pub predictor: IdentifiedCompliance,
    /// Postures it was identified from.
    pub postures: Vec<String>,
    /// SHA-256 of the cell it was identified in.
    pub cell: Option<String>,
    /// RMS displacement of the posture that moved most in the identification \[m\].
    pub largest_displacement: Option<f64>,
    /// Name of the file, or `prior`.
    pub name: String,
}

impl Saved {
    /// The cell's prior stiffness, without covariance.
    fn prior(cell: &Cell) -> Result<Self> {
        Ok(Saved {
            predictor: IdentifiedCompliance::from_stiffness(cell, cell.require_prior()?)?,
            postures: Vec::new(),
            cell: None,
            largest_displacement: None,
            name: PRIOR.to_string(),
        })
    }

    /// Where the stiffness comes from, as a line below the cell's.
    pub fn line(&self) -> String {
        let errors = &self.predictor.common;
        let with = match (&self.predictor.spread, errors.is_empty()) {
            (Some(_), false) => "covariance and common-mode errors",
            (Some(_), true) => "covariance",
            (None, _) => "no covariance",
        };
        match self.name == PRIOR {
            true => {
                "stiffness: the cell's prior, which says nothing about how sure it is\n".to_string()
            }
            false => format!("stiffness: {} (with {with})\n", self.name),
        }
    }

    /// True where the stiffness was identified in another version of the cell
    /// whose hash is `cell`.
    pub fn is_of_another_cell(&self, cell: Option<&String>) -> bool {
        self.cell.is_some() && self.cell.as_ref() != cell
    }
}

impl Session {
    /// Reads a joint stiffness of `cell`: a result of `identify`, a bare list,
    /// or `prior` for the cell's own (a file of that name is `./prior`).
    ///
    /// # Errors
    /// A file that cannot be read, anything wrong with it, or a cell without prior.
    pub fn read_stiffness(&self, from: &str, cell: &Cell) -> Result<Saved> {
        if from == PRIOR {
            return Saved::prior(cell);
        }
        let (name, bytes) = self.read("stiffness", from)?;
        saved(&bytes, &name, cell).map_err(|e| e.file(&name))
    }
}

/// The stiffness in a result of `identify`, or in a bare list.
///
/// # Errors
/// Anything wrong with the file.
fn saved(bytes: &[u8], name: &str, cell: &Cell) -> Result<Saved> {
    let json: Value = serde_json::from_slice(bytes).map_err(|e| {
        let error = fault("This is not JSON.".to_string());
        if e.line() > 0 {
            error.line(e.line(), Some(e.column().max(1)))
        } else {
            error
        }
    })?;
    let stiffness = stiffness(&json, cell)?;
    let result = result_of(&json);
    let predictor = match result {
        Some(result) => predictor(result, &stiffness, cell)?,
        None => IdentifiedCompliance::from_stiffness(cell, &stiffness)?,
    };
    let postures = result
        .and_then(|r| r["postures"].as_array().cloned())
        .unwrap_or_default();
    let displacements = postures
        .iter()
        .filter_map(|p| p["displacement_rms_m"].as_f64());
    Ok(Saved {
        predictor,
        largest_displacement: displacements.fold(None, |most, d| Some(d.max(most.unwrap_or(d)))),
        postures: postures
            .iter()
            .filter_map(|p| p["posture"].as_str().map(String::from))
            .collect(),
        cell: json["inputs"]["cell"].as_str().map(String::from),
        name: name.to_string(),
    })
}

/// The saved estimates with their covariance, further terms and common-mode
/// errors. A result that was written by hand or by another version may lack the
/// covariance; further terms must not go missing.
fn predictor(result: &Value, stiffness: &[f64], cell: &Cell) -> Result<IdentifiedCompliance> {
    match serde_json::from_value::<Estimates>(result.clone()) {
        Ok(estimates) => {
            let noise = FittedNoise {
                residual_std: result["residual_std_m"].as_f64(),
                posture_common_std: result["posture_common_std_m"].as_f64(),
            };
            let predictor = IdentifiedCompliance::from_estimates(cell, &estimates, noise)?;
            // `null` after --brief, missing for a clamped arm.
            match serde_json::from_value::<Option<SystematicErrors>>(result["budget"].clone()) {
                Ok(Some(budget)) => Ok(predictor.with_systematic_errors(&budget)),
                Ok(None) => Ok(predictor),
                Err(e) => Err(
                    fault(format!("The common-mode errors cannot be read: {e}."))
                        .key("result.budget"),
                ),
            }
        }
        Err(_) if result["extra"].as_array().is_none_or(Vec::is_empty) => {
            IdentifiedCompliance::from_stiffness(cell, stiffness)
        }
        Err(e) => Err(fault(format!(
            "The estimates with further terms cannot be read: {e}."
        ))
        .key("result")),
    }
}

fn fault(message: String) -> Error {
    Error::new(Code::ResultFile, message).hint(
        "give the file that `stiffarm identify --output` wrote, or {\"stiffness_nm_per_rad\": [k1, …]}",
    )
}

/// One stiffness above zero per joint.
fn stiffness(json: &Value, cell: &Cell) -> Result<Vec<f64>> {
    let (values, key): (Vec<(String, Option<f64>)>, &str) =
        match (json.get("stiffness_nm_per_rad"), result_of(json)) {
            (Some(list), _) => {
                let list = list
                    .as_array()
                    .ok_or_else(|| fault("stiffness_nm_per_rad is not a list.".to_string()))?;
                (
                    list.iter().map(|k| (String::new(), k.as_f64())).collect(),
                    "stiffness_nm_per_rad",
                )
            }
            (None, Some(result)) => {
                let joints = result["joints"].as_array().cloned().unwrap_or_default();
                let name = |j: &Value| j["name"].as_str().unwrap_or_default().to_string();
                (
                    joints
                        .iter()
                        .map(|j| (name(j), j["stiffness"].as_f64()))
                        .collect(),
                    "result.joints",
                )
            }
            (None, None) => return Err(fault("The file holds no joint stiffness.".to_string())),
        };
    let names = cell.setup.robot.spring_names();
    if values.len() != names.len() {
        let message = format!(
            "{} stiffness values for the {} joints of the cell.",
            values.len(),
            names.len()
        );
        return Err(fault(message).key(key));
    }
    let mut stiffness = Vec::with_capacity(values.len());
    for ((own, k), name) in values.into_iter().zip(&names) {
        if !own.is_empty() && own != *name {
            let message = format!(
                "The file has \"{own}\" where the cell has \"{name}\": it belongs to another robot."
            );
            return Err(fault(message).key(key));
        }
        match k {
            Some(k) if k.is_finite() && k > 0.0 => stiffness.push(k),
            Some(k) => {
                return Err(fault(format!(
                    "The stiffness of {name} is {k}; it must be above zero."
                ))
                .key(key));
            }
            None => return Err(fault(format!("The file has no stiffness of {name}.")).key(key)),
        }
    }
    Ok(stiffness)
}

/// The result of `identify`, inside its envelope or bare.
fn result_of(json: &Value) -> Option<&Value> {
    [&json["result"], json]
        .into_iter()
        .find(|v| v["joints"].is_array())
}
