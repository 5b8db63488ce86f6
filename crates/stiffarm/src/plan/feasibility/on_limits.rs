//! Which postures of a plan sit on a limit.

use super::PostureLimits;
use crate::findings::{Finding, codes, list, more};
use crate::model::cell::{Cell, LimitKind};
use crate::model::posture::Posture;
use crate::units::{deg_to_rad, m_to_mm, rad_to_sentence_deg};

/// Nearer than this to a machine's limit is on it \[deg\].
const NEAR_DEG: f64 = 0.1;
/// More room than this beyond the distance that is asked is room to spare \[m\].
const TO_SPARE: f64 = 1e-4;
/// Most postures that a sentence names.
const MOST_NAMES: usize = 12;

/// Which postures have a joint on the machine's limit, which the robot may refuse to reach.
pub fn on_machine_limits(cell: &Cell, postures: &[Posture]) -> Vec<Finding> {
    let mut findings = Vec::new();
    let robot = &cell.setup.robot;
    let limited_joints = robot.joints().iter().enumerate().filter(|_| !robot.limits_are_unknown());
    for (j, joint) in limited_joints {
        for limit in joint.limits {
            let is_near = |p: &&Posture| (p.q[j] - limit).abs() <= deg_to_rad(NEAR_DEG);
            let near: Vec<&Posture> = postures.iter().filter(is_near).collect();
            if near.is_empty() {
                continue;
            }
            let sentence = format!(
                "{} {} on the machine's limit, {}°, which the robot may refuse to reach: keep postures, and \
                 bounds.q_deg, a degree before it.",
                have(&near, postures.len()),
                joint.name,
                rad_to_sentence_deg(limit),
            );
            let subject = format!("bounds.q_deg[{}]", j + 1);
            findings.push(Finding::caution(codes::ON_MACHINE_LIMIT, subject, sentence));
        }
    }
    findings
}

/// What to know of postures that sit on limits: [`on_machine_limits`], and distances of shapes and rope, which a tool
/// or table that is not quite where the cell says uses up. `limits` are those of the postures.
pub fn on_limits(cell: &Cell, postures: &[Posture], limits: &[PostureLimits]) -> Vec<Finding> {
    let mut findings = on_machine_limits(cell, postures);
    // A distance that is too small is told where limits are, as a violation.
    let has_none = |posture_limits: &PostureLimits| {
        let kinds = [LimitKind::Shapes, LimitKind::RopeClearance];
        let mut rooms = kinds.into_iter().filter_map(|kind| posture_limits.of(kind)?.margin_m);
        rooms.any(|room| room.abs() <= TO_SPARE)
    };
    let tight = postures.iter().zip(limits).filter(|(_, posture_limits)| has_none(posture_limits));
    let tight: Vec<&Posture> = tight.map(|(posture, _)| posture).collect();
    if !tight.is_empty() {
        let sentence = format!(
            "{} at most {} mm to spare beyond the distances that [clearance] asks for: how exactly tool, table and \
             rope are where the cell has them is what these distances have to cover.",
            have(&tight, postures.len()),
            m_to_mm(TO_SPARE),
        );
        findings.push(Finding::note(codes::NO_ROOM_TO_SPARE, "clearance", sentence));
    }
    findings.extend(hidden(cell, postures));
    findings
}

/// Which points are not to be read at which postures, since the tracker does not see them.
fn hidden(cell: &Cell, postures: &[Posture]) -> Option<Finding> {
    let points = &cell.setup.tool.measuring_points;
    let of = postures.iter().map(|posture| {
        let hidden = cell.hidden_points(&posture.q).into_iter();
        let names: Vec<&str> = hidden.map(|point| &*points[point].name).collect();
        (posture, names)
    });
    let of: Vec<_> = of.filter(|(_, names)| !names.is_empty()).collect();
    let (_, first) = of.first()?;
    let each = of.iter().take(MOST_NAMES).map(|(posture, names)| {
        let word = if names.len() == 1 { "point" } else { "points" };
        format!("{word} {} at posture {}", list(names), posture.name)
    });
    let each: Vec<String> = each.collect();
    let sentence = format!(
        "The tracker does not see {}{}: sheet and page to print leave {} out.",
        list(&each),
        more(of.len().saturating_sub(MOST_NAMES)),
        if of.len() == 1 && first.len() == 1 { "it" } else { "them" }
    );
    Some(Finding::note(codes::HIDDEN_POINTS, "tracker.station", sentence))
}

/// `Posture 3 has`, `4 of 12 postures (1, 2, 3 and 4) have`.
fn have(some: &[&Posture], of: usize) -> String {
    let names: Vec<&str> = some.iter().map(|p| p.name.as_str()).collect();
    match names.as_slice() {
        [name] => format!("Posture {name} has"),
        names if names.len() > MOST_NAMES => format!("{} of {of} postures have", names.len()),
        names => format!("{} of {of} postures ({}) have", names.len(), list(names)),
    }
}
