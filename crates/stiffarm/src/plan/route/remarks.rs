//! What to know of a route before it is driven, in words.

use super::planned_route::{Route, RouteMove};
use crate::error::Result;
use crate::findings::{Finding, codes, list};
use crate::model::cell::{Cell, LimitKind};
use crate::model::load::Load;
use crate::model::posture::Posture;
use crate::plan::check::start_touches;

impl Route {
    /// Whether a move has no free way.
    pub fn is_blocked(&self) -> bool {
        self.moves.iter().any(|each| !each.free)
    }

    /// Whether stops are reached from the side of their load.
    pub fn is_approached(&self) -> bool {
        self.moves.iter().any(|each| !each.approached.is_empty())
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

/// What to know of `route` before it is driven: each move without a free way, and the joints that are not approached
/// from the side of their load, where `cell` asks for that; `stops` are its postures under their names.
///
/// # Errors
/// A rope without a direction.
pub fn route_findings(cell: &Cell, stops: &[Posture], route: &Route) -> Result<Vec<Finding>> {
    // Where the start itself touches something, one sentence says it for all moves from and to it.
    let start = start_touches(cell);
    let is_told = |each: &RouteMove| start.is_some() && (each.from.is_none() || each.to.is_none());
    let blocked = route.moves.iter();
    let blocked: Vec<&RouteMove> = blocked.filter(|each| !each.free && !is_told(each)).collect();
    // Moves with one reason are one finding.
    let mut reasons: Vec<(String, Vec<String>)> = Vec::new();
    for each in blocked {
        let reason = reason(each);
        match reasons.iter_mut().find(|(earlier, _)| *earlier == reason) {
            Some((_, moves)) => moves.push(each.name(stops)),
            None => reasons.push((reason, vec![each.name(stops)])),
        }
    }
    let blocked = reasons.iter().map(|(reason, moves)| blocked_moves(reason, moves));
    let mut findings: Vec<Finding> = start.into_iter().chain(blocked).collect();
    findings.extend(not_approached(cell, stops, route)?);
    Ok(findings)
}

/// What is in the way of a move, as the end of a sentence.
fn reason(each: &RouteMove) -> String {
    each.nearest.as_ref().map_or(String::new(), |nearest| {
        let near = match nearest.kind {
            LimitKind::Shapes | LimitKind::RopeClearance => {
                format!("{} come too near each other", nearest.subject)
            }
            kind if !kind.keeps_off() => {
                format!("the {} goes beyond {}", nearest.subject, kind.describe())
            }
            kind => format!("the {} comes too near {}", nearest.subject, kind.describe()),
        };
        format!(": on the straight joint move {near}")
    })
}

fn blocked_moves(reason: &str, moves: &[String]) -> Finding {
    let (word, them) = match moves.len() {
        1 => ("move", "it"),
        _ => ("moves", "them"),
    };
    let subject = format!("{word} {}", list(moves));
    let sentence = format!(
        "no free way was found for the {subject}{reason}. Drive {them} by hand over via postures of your own, or move \
         what is in the way."
    );
    Finding::serious(codes::MOVE_BLOCKED, subject, sentence)
}

/// Joints that stand on the side of their lost motion that chance gives them, and at which postures; nothing where
/// `cell` asks for no approach.
///
/// # Errors
/// A rope without a direction.
pub fn not_approached(cell: &Cell, stops: &[Posture], route: &Route) -> Result<Option<Finding>> {
    if cell.route.approach.is_none() {
        return Ok(None);
    }
    let joints = cell.setup.robot.joints();
    let mut left = Vec::new();
    for one in route.moves.iter().filter(|one| one.free) {
        let Some(stop) = one.to else { continue };
        let sides = cell.sides_of_load(&route.postures[stop])?;
        let is_left = |joint: usize| sides[joint].is_some_and(|side| side != 0.0) && !one.approached.contains(&joint);
        let names = (0..joints.len()).filter(|joint| is_left(*joint));
        let names: Vec<&str> = names.map(|joint| &*joints[joint].name).collect();
        let posture = stops.get(stop).map_or("?", |posture| &posture.name);
        if !names.is_empty() {
            left.push(format!("{} at posture {posture}", list(&names)));
        }
    }
    let message = if matches!(cell.setup.load, Load::Measured) {
        "[route] approach_deg needs to know which load acts: no posture is approached from its side. Give [load], or \
         take the key out."
            .to_string()
    } else if left.is_empty() {
        return Ok(None);
    } else {
        format!(
            "not approached from the side to which the load turns them: {}. A limit or something near is in the way; \
             their lost motion is in the displacements, which `identify` does not know.",
            list(&left)
        )
    };
    let code = "not-approached";
    let finding = Finding::caution(code, "route.approach_deg", message);
    Ok(Some(finding))
}
