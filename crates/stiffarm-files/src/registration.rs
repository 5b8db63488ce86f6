//! A saved registration.

use super::json;
use stiffarm::error::{Code, Error, Result};
use stiffarm::measure::registration::{Registration, RegistrationRecord};

/// Reads a registration that `stiffarm register --output` or `--json` wrote,
/// with what made it or bare ([`RegistrationRecord`]); `file_name` is for messages.
///
/// # Errors
/// Text that is not JSON, lacks a key, or holds no valid registration.
pub fn read_registration(bytes: &[u8], file_name: &str) -> Result<Registration> {
    let fault = |message: String| {
        Error::new(Code::ResultFile, message)
            .file(file_name)
            .hint("give the file that `stiffarm register --output` wrote")
    };
    let json = json::parse(bytes).map_err(|e| {
        let place = e.place().clone();
        let error = fault(e.message().to_string());
        match place.line {
            Some(line) => error.line(line, place.column),
            None => error,
        }
    })?;
    let whole = ["result", "rotation"].map(|key| json.get(key).cloned());
    let record = match whole {
        [Some(result), _] if result.get("rotation").is_some() => result,
        [_, Some(_)] => json,
        _ => return Err(fault("The file holds no registration.".to_string())),
    };
    let record: RegistrationRecord =
        serde_json::from_value(record).map_err(|e| fault(format!("The registration cannot be read: {e}.")))?;
    Registration::try_from(record).map_err(|e| e.file(file_name))
}
