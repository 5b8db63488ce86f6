//! Joint stiffness that robots of a class have: published values of robots of
//! like payload, else those of the default robot scaled by payload and reach.

use crate::model::robot::{CatalogueEntry, Robot, catalogue};

/// Payloads within this factor belong to one class.
const CLASS: f64 = 2.0;
/// Payload and reach of the robot whose stiffness stands in, the first of the
/// catalogue \[kg, m\].
const STANDS_IN: [f64; 2] = [165.0, 3.0];
/// Spread of a prior about the truth, joint by joint: standard deviation of the
/// logarithm. A prior is off by up to three, ln 3 being two of them.
pub(super) const PRIOR_SPREAD: f64 = 0.55;
/// Spread of the robots of a class about its mean stiffness: likewise, all joints alike.
pub(super) const CLASS_SPREAD: f64 = 0.8;
/// Stiffness that stands in beyond the last joint of the published sets \[N·m/rad\].
const WRIST: f64 = 1.5e5;

/// The entry of the catalogue for this robot.
fn entry(robot: &Robot) -> Option<&'static CatalogueEntry> {
    catalogue().iter().find(|e| e.name == robot.name())
}

/// Order of magnitude of each spring's stiffness by the robot's class \[N·m/rad\]:
/// the geometric mean of the catalogue's published sets for robots of half to
/// twice the payload. Without any, those of 165 kg, 3 m scaled by payload and
/// reach, torque being their product; a robot of unknown payload counts as that one.
pub(super) fn expected_stiffness(robot: &Robot) -> Vec<f64> {
    let catalogue_entry = entry(robot);
    let payload = catalogue_entry.and_then(CatalogueEntry::payload_kg);
    let payload = payload.unwrap_or(STANDS_IN[0]);
    let published = |in_class: &dyn Fn(f64) -> bool| -> Vec<&'static [f64]> {
        catalogue()
            .iter()
            .filter(|e| e.payload_kg().is_some_and(in_class))
            .flat_map(|e| e.stiffness.iter().map(|set| set.values))
            .collect()
    };
    let alike = published(&|p| p > payload / CLASS && p < payload * CLASS);
    let (sets, factor) = if alike.is_empty() {
        let reach = catalogue_entry.and_then(CatalogueEntry::reach_m);
        let reach = reach.unwrap_or(STANDS_IN[1]);
        let like_first = published(&|p| p == STANDS_IN[0]);
        (like_first, payload / STANDS_IN[0] * reach / STANDS_IN[1])
    } else {
        (alike, 1.0)
    };
    let count = robot.spring_count();
    let mean = |j: usize| {
        let logs: Vec<f64> = sets.iter().filter_map(|s| s.get(j)).map(|k| k.ln()).collect();
        if logs.is_empty() { WRIST * factor } else { factor * (logs.iter().sum::<f64>() / logs.len() as f64).exp() }
    };
    (0..count).map(mean).collect()
}
