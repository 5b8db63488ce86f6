//! Any saved result: what a command printed with `--json`, or wrote with `--output`.

use super::{json, seal};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;
use stiffarm::error::{Code, Error, Result};

/// A result with what made it.
#[derive(Debug, Clone, PartialEq)]
pub struct SavedResult {
    /// Its file's name, for messages.
    pub name: String,
    /// The command that made it.
    pub command: String,
    /// Version of the program that made it.
    pub version: String,
    /// Seed of the random numbers, where there were any.
    pub seed: Option<u64>,
    /// Words of the command line that makes it again, inputs as `{role}`, or the call in Python as one text; empty
    /// where the file does not have them.
    pub arguments: Vec<String>,
    /// Inputs by role with their SHA-256.
    pub inputs: Vec<(String, String)>,
    /// The whole file but its seal.
    pub json: Value,
}

impl SavedResult {
    /// A result that was just made, as it would be read from its file.
    ///
    /// # Errors
    /// A value that is no result with what made it, or that JSON cannot hold.
    pub fn of(envelope: &impl Serialize, name: &str) -> Result<Self> {
        let json = serde_json::to_value(envelope)
            .map_err(|e| Error::new(Code::Internal, format!("The result cannot be written as JSON: {e}.")))?;
        Self::from_json(json, name)
    }

    fn from_json(json: Value, name: &str) -> Result<Self> {
        let fault = |message: String| {
            Error::new(Code::ResultFile, message)
                .file(name)
                .hint("give a file that a command wrote with --output, or what it printed with --json")
        };
        if let Some(error) = json.get("error") {
            let said = error["message"].as_str().unwrap_or_default();
            return Err(fault(format!("This file holds the error of a command, not a result: {said}")));
        }
        match json.get("format") {
            Some(format) if *format == 1 => {}
            Some(format) => {
                let message = format!("The result has format {format}; this version reads 1.");
                return Err(fault(message));
            }
            None => return Err(fault("This is not a result of stiffarm.".to_string())),
        }
        let text = |key: &str| json[key].as_str().map(String::from);
        let (Some(command), Some(version), Some(_)) = (text("command"), text("stiffarm"), json.get("result")) else {
            let message = "The result lacks one of the keys stiffarm, command and result.";
            return Err(fault(message.to_string()));
        };
        let inputs = json["inputs"].as_object().into_iter().flatten();
        let words = json["arguments"].as_array().into_iter().flatten();
        Ok(SavedResult {
            name: name.to_string(),
            command,
            version,
            seed: json["seed"].as_u64(),
            arguments: words.filter_map(|w| w.as_str().map(String::from)).collect(),
            inputs: inputs.filter_map(|(role, hash)| Some((role.clone(), hash.as_str()?.to_string()))).collect(),
            json,
        })
    }

    /// The result itself as the type that was written.
    ///
    /// # Errors
    /// A result of another command, or of a version whose results look different.
    pub fn result<T: DeserializeOwned>(&self) -> Result<T> {
        self.section("result", "The result")
    }

    /// The options that it was made with, as the type that was written.
    ///
    /// # Errors
    /// As [`SavedResult::result`].
    pub fn options<T: DeserializeOwned>(&self) -> Result<T> {
        self.section("options", "The options")
    }

    fn section<T: DeserializeOwned>(&self, key: &str, what: &str) -> Result<T> {
        T::deserialize(&self.json[key]).map_err(|e| {
            let message = format!("{what} of `{}` cannot be read: {e}.", self.command);
            let hint = format!("it was written by version {}; make it again with this version", self.version);
            Error::new(Code::ResultFile, message).file(&self.name).key(key).hint(hint)
        })
    }

    /// The hash of the input of a role.
    pub fn input(&self, role: &str) -> Option<&str> {
        let mut inputs = self.inputs.iter();
        let input = inputs.find(|(input_role, _)| input_role == role);
        input.map(|(_, hash)| hash.as_str())
    }
}

/// A result as its file holds it, its seal unbroken and taken off.
///
/// # Errors
/// No result, or one that was changed after it was written.
pub(super) fn sealed_result(json: Value, file_name: &str) -> Result<SavedResult> {
    let mut saved = SavedResult::from_json(json, file_name)?;
    seal::unseal(&mut saved.json).map_err(|e| e.file(file_name))?;
    Ok(saved)
}

/// Reads a saved result; `file_name` is for messages.
///
/// # Errors
/// Text that is not JSON, with line and column; a file that holds no result, or one that was
/// changed after it was written.
pub fn read_result(bytes: &[u8], file_name: &str) -> Result<SavedResult> {
    let json = json::parse(bytes).map_err(|error| {
        let error = error.file(file_name);
        match error.hint_text() {
            Some(_) => error,
            None => error.hint("give what a command printed with --json, or what `stiffarm identify --output` wrote"),
        }
    })?;
    sealed_result(json, file_name)
}
