//! A saved joint stiffness: what `identify` wrote, or a list by hand.
//!
//! A saved result is an input like any other. It is edited by hand and by
//! scripts, so whatever is calculated with is held against the rest of the
//! file: a stiffness against its compliance, a standard error against the
//! covariance. What contradicts itself is refused, as is a key nobody reads.

mod checks;
mod elastic;
mod errors;
mod interval;
mod keys;
mod posterior;

use super::json;
use super::result::collect_findings;
use crate::error::{Code, Error, Result, did_you_mean};
use crate::estimate::compliance::{FittedNoise, IdentifiedCompliance};
use crate::estimate::identify::Estimates;
use crate::model::cell::Cell;
use keys::{BARE, below};
use serde_json::Value;

/// A stiffness as `identify` saved it.
#[derive(Debug, Clone, PartialEq)]
pub struct SavedStiffness {
    /// What displacements are calculated with.
    pub compliance: IdentifiedCompliance,
    /// Postures it was identified from.
    pub postures: Vec<String>,
    /// SHA-256 of the cell it was identified in.
    pub cell: Option<String>,
    /// RMS displacement of the posture that moved most in the identification \[m\].
    pub largest_displacement: Option<f64>,
}

/// Reads the joint stiffness of `cell`: the result of `stiffarm identify
/// --output`, with what made it or bare, or `{"stiffness_nm_per_rad": [k1, …]}`;
/// `file_name` is for messages.
///
/// A result without `covariance` and `confidence`, as one writes it by hand,
/// gives values without bands.
///
/// # Errors
/// Text that is not JSON; a key that no saved result has, or one twice; values
/// of another robot; a joint without a positive stiffness; numbers that
/// contradict each other or lie where no robot's can: with the key's path.
pub fn read_stiffness(bytes: &[u8], file_name: &str, cell: &Cell) -> Result<SavedStiffness> {
    read(bytes, cell).map_err(|e| match e.hint_text() {
        Some(_) => e.file(file_name),
        None => e.file(file_name).hint(HINT),
    })
}

const HINT: &str =
    "give the file that `stiffarm identify --output` wrote, or {\"stiffness_nm_per_rad\": [k1, …]}";

fn fault(message: String) -> Error {
    Error::new(Code::ResultFile, message)
}

/// The error with the known key that `name` may stand for.
fn suggested(error: Error, name: &str, known: &[&str]) -> Error {
    match did_you_mean(name, known.iter().copied()) {
        Some(nearest) => error.hint(nearest),
        None => error.hint(format!("take it out; keys here: {}", known.join(", "))),
    }
}

fn read(bytes: &[u8], cell: &Cell) -> Result<SavedStiffness> {
    let json = json::parse(bytes)?;
    if json.get(BARE).is_some() && (json.get("result").is_some() || json.get("joints").is_some()) {
        let message = "A list of stiffness beside a result: only one of them could count.";
        return Err(fault(message.to_string())
            .key(BARE)
            .hint("keep one of them"));
    }
    if json.get(BARE).is_some() {
        keys::check(&json, "", &[BARE])?;
        let stiffness = bare(&json[BARE], cell)?;
        return Ok(SavedStiffness {
            compliance: IdentifiedCompliance::from_stiffness(cell, &stiffness)?,
            postures: Vec::new(),
            cell: None,
            largest_displacement: None,
        });
    }
    if json["joints"].is_array() {
        return result(&json, "", None, cell);
    }
    if !json["result"]["joints"].is_array() {
        return Err(fault("The file holds no joint stiffness.".to_string()));
    }
    keys::check(&json, "", keys::ENVELOPE)?;
    if json.get("format").is_some_and(|format| *format != 1) {
        let message = format!(
            "This is format {} of saved results; this version reads 1.",
            json["format"]
        );
        return Err(fault(message).key("format"));
    }
    if let Some(other) = json["command"].as_str().filter(|c| *c != "identify") {
        let message = format!("This is a result of `stiffarm {other}`.");
        return Err(fault(message).key("command"));
    }
    let hash = match json["inputs"].get("cell") {
        None | Some(Value::Null) => None,
        Some(Value::String(hash)) => Some(hash.clone()),
        Some(_) => {
            let message = "The hash of the cell must be text.";
            return Err(fault(message.to_string()).key("inputs.cell"));
        }
    };
    result(&json["result"], "result", hash, cell)
}

/// The values of a list without anything else.
fn bare(list: &Value, cell: &Cell) -> Result<Vec<f64>> {
    let Some(list) = list.as_array() else {
        return Err(fault(format!("{BARE} is not a list.")).key(BARE));
    };
    let names = cell.setup.robot.spring_names();
    checks::count(list.len(), names.len(), BARE)?;
    let values = list.iter().zip(&names).enumerate();
    values
        .map(|(j, (value, name))| {
            let key = format!("{BARE}[{j}]");
            let Some(k) = value.as_f64() else {
                return Err(fault(format!("The file has no stiffness of {name}.")).key(key));
            };
            checks::stiffness(k, name, &key)?;
            Ok(k)
        })
        .collect()
}

/// The result of `identify`, which stands at `key`.
fn result(result: &Value, key: &str, hash: Option<String>, cell: &Cell) -> Result<SavedStiffness> {
    keys::check(result, key, keys::RESULT)?;
    for name in ["joints", "extra_springs"] {
        keys::check_each(result, key, name, keys::JOINT)?;
    }
    keys::check_each(result, key, "lost_motion", keys::ANGLE)?;
    let compliance = match ["covariance", "confidence"].map(|name| result.get(name)) {
        [None, None] => by_hand(result, key, cell)?,
        _ => identified(result, key, cell)?,
    };
    let (postures, largest_displacement) = checks::postures(result, key)?;
    let mut findings = Vec::new();
    collect_findings(result, &mut findings);
    Ok(SavedStiffness {
        compliance: compliance.with_doubts(&findings),
        postures,
        cell: hash,
        largest_displacement,
    })
}

/// Joints alone: what a person writes, without covariance.
fn by_hand(result: &Value, key: &str, cell: &Cell) -> Result<IdentifiedCompliance> {
    let extra = result["extra"].as_array();
    if extra.is_some_and(|extra| !extra.is_empty()) {
        let message = "The estimates with further terms cannot be read: they have no covariance.";
        return Err(fault(message.to_string()).key(below(key, "extra")));
    }
    let joints = result["joints"].as_array().map_or(&[][..], Vec::as_slice);
    let names = cell.setup.robot.spring_names();
    let list = below(key, "joints");
    checks::count(joints.len(), names.len(), &list)?;
    let mut stiffness = Vec::with_capacity(names.len());
    for (j, (joint, name)) in joints.iter().zip(&names).enumerate() {
        let key = format!("{list}[{j}]");
        if let Some(own) = joint["name"].as_str() {
            checks::same_name(own, name, &below(&key, "name"))?;
        }
        let number = |field: &str| checks::optional_number(joint, field, &key);
        let Some(k) = number("stiffness")? else {
            let error = fault(format!("The file has no stiffness of {name}."));
            return Err(error.key(below(&key, "stiffness")));
        };
        checks::stiffness(k, name, &below(&key, "stiffness"))?;
        if let Some(h) = number("compliance")? {
            checks::agree(k, h, &below(&key, "compliance"))?;
        }
        stiffness.push(k);
    }
    IdentifiedCompliance::from_stiffness(cell, &stiffness)
}

/// The estimates with their covariance, further terms and common-mode errors.
fn identified(result: &Value, key: &str, cell: &Cell) -> Result<IdentifiedCompliance> {
    checks::joints_readable(result, key)?;
    let estimates: Estimates = serde_json::from_value(result.clone()).map_err(|e| {
        let error = fault(format!("The estimates cannot be read: {e}."));
        match key.is_empty() {
            true => error,
            false => error.key(key),
        }
    })?;
    checks::estimates(&estimates, cell, key)?;
    let noise = FittedNoise {
        residual_std: checks::scatter(result, "residual_std_m", key)?,
        posture_common_std: checks::scatter(result, "posture_common_std_m", key)?,
    };
    let compliance = IdentifiedCompliance::from_estimates(cell, &estimates, noise)?;
    checks::quantile(&compliance, key)?;
    if let Some(mixed) =
        elastic::mixed(&result["elastic"], &below(key, "elastic"), cell, &estimates)?
    {
        return Ok(mixed);
    }
    // `null` after --brief, missing for a clamped arm.
    match &result["budget"] {
        Value::Null => Ok(compliance),
        budget => errors::with_budget(compliance, budget, &below(key, "budget"), cell),
    }
}
