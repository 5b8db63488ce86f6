//! Moves without a free way, in words.

use super::found::{Route, RouteMove};
use super::moves::can_be_touched;
use crate::findings::{Finding, Severity};
use crate::model::cell::LimitKind;
use crate::model::posture::Posture;

/// Code of the finding about a move without a free way.
pub const MOVE_BLOCKED: &str = "move-blocked";

impl Route {
    /// Whether a move has no free way.
    pub fn is_blocked(&self) -> bool {
        self.moves.iter().any(|each| !each.free)
    }
}

impl RouteMove {
    /// `2 to 5`: the names of the stops that it begins and ends at; `stops` are those of the route.
    pub fn name(&self, stops: &[Posture]) -> String {
        // The start has no name of its own.
        let name = |stop: Option<usize>| match stop {
            None => "start".to_string(),
            Some(stop) => match stops.get(stop) {
                Some(posture) => posture.name.clone(),
                None => (stop + 1).to_string(),
            },
        };
        format!("{} to {}", name(self.from), name(self.to))
    }
}

/// A finding for each move of `route` without a free way; `stops` are its postures under their names.
pub fn blocked_moves(stops: &[Posture], route: &Route) -> Vec<Finding> {
    let blocked = route.moves.iter().filter(|each| !each.free);
    let finding = |each: &RouteMove| {
        let what = each.nearest.as_ref().map_or(String::new(), |nearest| {
            let near = match nearest.kind {
                LimitKind::Shapes | LimitKind::RopeClearance => {
                    format!("{} come too near each other", nearest.subject)
                }
                kind if !can_be_touched(kind) => {
                    format!("the {} goes beyond {}", nearest.subject, kind.describe())
                }
                kind => format!("the {} comes too near {}", nearest.subject, kind.describe()),
            };
            format!(" on the straight joint move {near}")
        });
        Finding::new(
            MOVE_BLOCKED,
            Severity::Serious,
            format!("move {}", each.name(stops)),
            format!(
                "no free way was found:{what}. Drive it by hand over via postures of your own, or move what is in the way."
            ),
        )
    };
    blocked.map(finding).collect()
}
