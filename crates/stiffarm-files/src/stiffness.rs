//! A saved joint stiffness: what `identify` sealed in its result, or a list by hand.
//!
//! Of a result one section is read, the one that was written to be read
//! ([`Sealed`]); the rest is for people. The seal says that nobody has changed either.

use super::result::{SavedResult, sealed_result};
use super::{json, seal};
use serde::Deserialize;
use serde_json::Value;
use stiffarm::error::{Code, Error, Result};
use stiffarm::estimate::saved::{Saved, Sealed};
use stiffarm::model::cell::Cell;
use stiffarm::units::deg_to_rad;

/// A list of stiffness values and nothing else.
const BARE: &str = "stiffness_nm_per_rad";

/// No joint of a robot is softer or stiffer \[N·m/rad\]: softer would give way by a radian
/// under the weight of a bar of chocolate held a metre away, the stiffest of industrial
/// robots have 1e8.
const PLAUSIBLE: [f64; 2] = [1.0, 1e15];

const HINT: &str = "give the saved result of an identification, or {\"stiffness_nm_per_rad\": [k1, …]}";

/// Reads the joint stiffness of `cell`: the result of `stiffarm identify
/// --output`, or `{"stiffness_nm_per_rad": [k1, …]}`, which gives values without
/// bands; `file_name` is for messages.
///
/// # Errors
/// Text that is not JSON; a result that was changed after it was written, or that
/// an earlier version wrote; values of another robot, or that no joint has.
pub fn read_stiffness(bytes: &[u8], file_name: &str, cell: &Cell) -> Result<Saved> {
    read(bytes, file_name, cell).map_err(|e| match e.hint_text() {
        Some(_) => e.file(file_name),
        None => e.file(file_name).hint(HINT),
    })
}

fn fault(message: impl Into<String>) -> Error {
    Error::new(Code::ResultFile, message)
}

fn read(bytes: &[u8], file_name: &str, cell: &Cell) -> Result<Saved> {
    let json = json::parse(bytes)?;
    if let Some(list) = json.get(BARE) {
        let keys = json.as_object().into_iter().flat_map(|map| map.keys());
        if let Some(other) = keys.into_iter().find(|key| *key != BARE) {
            let message = "Beside a list of stiffness nothing else can stand: it would not count.";
            return Err(fault(message).key(other).hint("take it out"));
        }
        return Saved::bare(cell, &bare(list, cell)?, file_name);
    }
    if json.get("format").is_none() && json.get("error").is_none() {
        return Err(fault("The file holds no joint stiffness."));
    }
    let saved = sealed_result(json, file_name)?;
    if saved.command != "identify" {
        let message = format!("This is a result of `stiffarm {}`.", saved.command);
        return Err(fault(message).key("command"));
    }
    let sealed = sealed(&saved)?;
    let within = |error: Error| match error.place().key.clone() {
        Some(key) => error.key(format!("{}.{key}", seal::SECTION)),
        None => error.key(seal::SECTION),
    };
    sealed.check(cell).map_err(within)?;
    let hash = saved.input("cell").map(String::from);
    let mut out = Saved::new(sealed, hash, file_name);
    out.angles = angles(&saved.json["result"]["postures"]);
    Ok(out)
}

/// Controller angles of the postures of a result \[rad\]; none where one of them has none.
fn angles(postures: &Value) -> Vec<Vec<f64>> {
    let of = |posture: &Value| {
        let list = posture["q_deg"].as_array()?.iter();
        list.map(|q| q.as_f64().map(deg_to_rad)).collect::<Option<Vec<f64>>>()
    };
    let all = postures.as_array().into_iter().flatten().map(of);
    all.collect::<Option<_>>().unwrap_or_default()
}

/// What was sealed to be calculated with.
fn sealed(saved: &SavedResult) -> Result<Sealed> {
    let section = &saved.json["result"]["sealed"];
    if section.is_null() {
        let message = match saved.json["result"].get("sealed") {
            Some(_) => "The measurements determined no joint: nothing can be calculated with this.",
            None => "This result of `identify` holds nothing to calculate with.",
        };
        let hint = "measure postures that load the joints, and identify again with this version";
        return Err(fault(message).key(seal::SECTION).hint(hint));
    }
    Sealed::deserialize(section).map_err(|e| {
        fault(format!("The sealed stiffness cannot be read: {e}."))
            .key(seal::SECTION)
            .hint("identify again with this version")
    })
}

/// The values of a list without anything else.
fn bare(list: &Value, cell: &Cell) -> Result<Vec<f64>> {
    let Some(list) = list.as_array() else {
        return Err(fault(format!("{BARE} is not a list.")).key(BARE));
    };
    let names = cell.setup.robot.spring_names();
    if list.len() != names.len() {
        let (count, joints) = (list.len(), names.len());
        let message = format!("{count} stiffness values for the {joints} joints of the cell.");
        return Err(fault(message).key(BARE));
    }
    let [softest, stiffest] = PLAUSIBLE;
    let values = list.iter().zip(&names).enumerate();
    let value = |(j, (value, name)): (usize, (&Value, &String))| {
        let refused = match value.as_f64() {
            None => format!("The file has no stiffness of {name}."),
            Some(k) if k.is_nan() || k <= 0.0 => {
                format!("The stiffness of {name} is {k}; it must be above zero.")
            }
            Some(k) if !(softest..=stiffest).contains(&k) => format!(
                "The stiffness of {name} is {k:e} N·m/rad, which no joint has: it must lie between {softest:e} and \
                 {stiffest:e}."
            ),
            Some(k) => return Ok(k),
        };
        Err(fault(refused).key(format!("{BARE}[{j}]")))
    };
    values.map(value).collect()
}
