//! Every margin of a posture as the library tells it against the checker's.

use super::checker::Checker;
use crate::common::prelude::*;
use std::collections::BTreeMap;
use stiffarm::model::cell::LimitMargin;

/// What both may differ by \[m, rad, share\]; torques rest on finite differences.
const DIFFERENCE: f64 = 1e-7;
const OF_TORQUE: f64 = 1e-5;
/// Beams that are clearer than this are as good as free \[m\].
const FREE: f64 = 0.25;

impl Checker<'_> {
    /// Compares all margins of one posture.
    ///
    /// # Errors
    /// What differs.
    pub fn compare(&self, cell: &Cell, q: &[f64]) -> Result<(), String> {
        let margins = self.margins(q);
        let named = cell.posture_margins().and_then(|mut all| all.named(q));
        let mut theirs: BTreeMap<String, f64> = BTreeMap::new();
        for margin in named.map_err(|e| e.to_string())? {
            let least = theirs.entry(key(&margin)).or_insert(f64::INFINITY);
            *least = margin.margin.min(*least);
        }
        // A short rope touches nothing, and the checker says nothing of it.
        theirs.retain(|_, margin| margin.is_finite());
        let ours = margins.iter().filter(|(what, _)| !what.starts_with("bounds"));
        if !ours.clone().map(|(what, _)| what).eq(theirs.keys()) {
            let ours: Vec<&String> = margins.keys().collect();
            let theirs: Vec<&String> = theirs.keys().collect();
            return Err(format!("at {q:?} margins of {ours:?}, but {theirs:?}"));
        }
        for ((what, margin), theirs) in ours.zip(theirs.values()) {
            let most = match what {
                what if what.starts_with("torque") => OF_TORQUE * (1.0 + margin.abs()),
                _ => DIFFERENCE,
            };
            let margin = match &**what {
                "sight" => margin.min(FREE),
                _ => *margin,
            };
            let differs =
                if self.is_drawn_smaller(what) { *theirs > margin + most } else { (theirs - margin).abs() > most };
            if differs {
                return Err(format!("at {q:?} {what} is {margin}, but {theirs}"));
            }
        }
        Ok(())
    }
}

/// What a margin is about, in the checker's words.
fn key(margin: &LimitMargin) -> String {
    let point = &margin.point;
    match margin.kind {
        LimitKind::ToolBox => "box".to_string(),
        LimitKind::Floor => "floor".to_string(),
        LimitKind::KeepOut => "keep-out".to_string(),
        LimitKind::WristHeight => "wrist".to_string(),
        LimitKind::RopeLength => "rope length".to_string(),
        LimitKind::Shapes => {
            let mut names: Vec<&str> = point.split(" and ").collect();
            names.sort_unstable();
            names.join(" and ")
        }
        LimitKind::RopeClearance => match point.strip_prefix("cylinder and ") {
            Some(part) => format!("rope and {part}"),
            None => point.clone(),
        },
        LimitKind::RopeCone => "cone".to_string(),
        LimitKind::Incidence | LimitKind::Sight => "sight".to_string(),
        LimitKind::SmallestDisplacement => "least displacement".to_string(),
        LimitKind::LargestDisplacement => "most displacement".to_string(),
        LimitKind::Torque => point.replace("joint", "torque"),
    }
}
