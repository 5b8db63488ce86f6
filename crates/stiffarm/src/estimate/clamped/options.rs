//! Which postures are identified with the flange fixed.

use super::ClampedPosture;
use crate::error::Result;
use crate::measure::{all_excluded, check_names};

/// The postures but those with the names `exclude`.
///
/// # Errors
/// A name that no posture has; nothing is left (key `exclude`).
pub fn without(mut clamped: Vec<ClampedPosture>, exclude: &[String]) -> Result<Vec<ClampedPosture>> {
    let names = clamped.iter().map(|c| c.posture.name.as_str());
    check_names(exclude, names).map_err(|e| e.key("exclude"))?;
    clamped.retain(|c| !exclude.contains(&c.posture.name));
    if clamped.is_empty() { Err(all_excluded().key("exclude")) } else { Ok(clamped) }
}
