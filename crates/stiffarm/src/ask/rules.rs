//! Options that exclude each other, as one table for the library and the command line.

use crate::error::{Code, Error, Result};
use serde::Serialize;
use std::collections::BTreeSet;

/// Options by name, each with those that are not taken beside it.
pub type NotWith = &'static [(&'static str, &'static [&'static str])];

/// The fields of some options that are not as they are by default; what stands under a unit of time is named without
/// it.
///
/// # Errors
/// Options that JSON cannot hold.
pub(super) fn changed_options<O: Serialize + Default>(options: &O) -> Result<BTreeSet<String>> {
    let json = |options: &O| serde_json::to_value(options).map_err(|e| Error::new(Code::Internal, e.to_string()));
    let (chosen, default) = (json(options)?, json(&O::default())?);
    let fields = chosen.as_object().into_iter().flatten();
    let changed = fields.filter(|(key, value)| default.get(key) != Some(value));
    Ok(changed.map(|(key, _)| key.strip_suffix("_s").unwrap_or(key).to_string()).collect())
}

/// Refuses two of the `names` that exclude each other.
///
/// # Errors
/// There are two such.
pub(super) fn refuse(rules: NotWith, names: &BTreeSet<String>) -> Result<()> {
    for (name, others) in rules.iter().filter(|(name, _)| names.contains(*name)) {
        if let Some(other) = others.iter().find(|other| names.contains(**other)) {
            let message = format!("`{name}` is not taken beside `{other}`.");
            let hint = format!("leave out `{name}` or `{other}`");
            return Err(Error::new(Code::Conflict, message).key(*name).hint(hint));
        }
    }
    Ok(())
}
