//! A judgement in a few lines.

use super::Judgement;
use super::judgement::DeflectionStanding;
use crate::args::Goal;
use crate::commands::wrapped_line;
use crate::numbers::{NONE, counted as number_of, significant, stiffness};
use crate::screen::{columns, wrapped};
use crate::table::{Table, green, yellow};
use stiffarm::estimate::next_posture::NextPosture;
use stiffarm::estimate::standing::Standing;
use stiffarm::findings::{Finding, Severity, list};
use stiffarm::model::cell::Cell;
use stiffarm::model::posture::Posture;
use stiffarm::units::{m_to_mm, rad_to_shortest_deg};

/// All of it, for one look.
pub(super) fn whole(
    cell: &Cell,
    plan: &[Posture],
    found: &Judgement,
    goal: Option<Goal>,
) -> String {
    let mut out = counted(plan, found);
    out += &soundness(&found.measured, &found.readings);
    for finding in &found.readings {
        out += &(wrapped_line(finding) + "\n");
    }
    out + &verdict(found, goal) + &joints(found) + &next(cell, plan, found)
}

/// `3 of 6 postures measured; 4 begun`.
fn counted(plan: &[Posture], found: &Judgement) -> String {
    let done = plan.len() - found.left.len();
    let mut out = format!("measured: {done} of {} planned postures", plan.len());
    let beside = found.measured.len().saturating_sub(done);
    if beside > 0 {
        out += &format!(" and {beside} beside the plan");
    }
    if !found.begun.is_empty() {
        out += &format!("; begun: {}", list(&found.begun));
    }
    out + "\n"
}

/// Whether the readings of these postures are sound.
pub(super) fn soundness(postures: &[String], readings: &[Finding]) -> String {
    let serious = readings
        .iter()
        .filter(|f| f.severity == Severity::Serious)
        .count();
    let what = match postures {
        [] => return String::new(),
        [one] => format!("posture {one}"),
        several => format!("postures {}", list(several)),
    };
    // The findings say of which posture they are.
    let said = match serious {
        0 => format!("{what}: readings {}", green("sound")),
        1 => "something is wrong with the readings: settle it before the next posture".to_string(),
        _ => format!(
            "{serious} things are wrong with the readings: settle them before the next posture"
        ),
    };
    wrapped(&said, columns()) + "\n"
}

/// How well the joints are known, and whether that is enough.
pub(super) fn verdict(found: &Judgement, goal: Option<Goal>) -> String {
    let Some(standing) = &found.standing else {
        let why = found
            .standing_missing
            .as_deref()
            .unwrap_or("no posture is measured yet");
        return wrapped(&format!("stiffness: not yet; {why}"), columns()) + "\n";
    };
    let undetermined: Vec<&str> = standing
        .joints
        .iter()
        .filter(|joint| joint.total.is_none())
        .map(|joint| joint.name.as_str())
        .collect();
    let mut out = match standing.largest {
        None if undetermined.len() == standing.joints.len() => {
            "stiffness: no joint is known to better than half of it yet".to_string()
        }
        None => format!("stiffness: not yet for {}", list(&undetermined)),
        Some(largest) => format!(
            "stiffness: every joint within ± {} % at {} % confidence, all errors together",
            short(largest),
            significant(100.0 * standing.confidence, 2)
        ),
    };
    out += &match (goal.and_then(Goal::stiffness), standing.reached) {
        (Some(goal), Some(true)) => {
            format!("; {} (± {} %)", green("the goal is reached"), short(goal))
        }
        (Some(goal), _) => to_go(standing, goal, found.left.len()),
        _ => String::new(),
    };
    let mut out = wrapped(&out, columns()) + "\n";
    if let (Some(deflection), Some(goal)) = (&found.deflection, goal.and_then(Goal::deflection)) {
        out += &(wrapped(&at_tasks(deflection, goal), columns()) + "\n");
    }
    for finding in &standing.findings {
        out += &(wrapped_line(finding) + "\n");
    }
    out
}

/// How well the deflection at the tasks is predicted.
fn at_tasks(deflection: &DeflectionStanding, goal: f64) -> String {
    let goal = significant(m_to_mm(goal), 3);
    let Some(largest) = deflection.largest_m else {
        return format!("tasks: no deflection is predicted yet; the goal is ± {goal} mm");
    };
    let said = format!(
        "tasks: deflection predicted to ± {} mm or better ({} is worst)",
        significant(m_to_mm(largest), 2),
        deflection.task
    );
    match deflection.reached {
        true => format!("{said}; {} (± {goal} mm)", green("the goal is reached")),
        false => format!("{said}; the goal is ± {goal} mm"),
    }
}

/// How far the goal is.
fn to_go(standing: &Standing, goal: f64, left: usize) -> String {
    let goal = short(goal);
    match standing.postures_to_goal {
        Some(1) => format!("; the goal of ± {goal} % should take about 1 more posture"),
        Some(count) => {
            format!("; the goal of ± {goal} % should take about {count} more postures")
        }
        None if left == 0 => format!("; the goal of ± {goal} % is not reached with the whole plan"),
        // A forecast of joints that are not determined would be a guess.
        None if standing.largest.is_none() => format!("; the goal is ± {goal} %"),
        None => {
            format!(
                "; whether the {} left reach the goal of ± {goal} % is not sure",
                number_of(left, "posture")
            )
        }
    }
}

/// A row for each joint.
pub(super) fn joints(found: &Judgement) -> String {
    let Some(standing) = &found.standing else {
        return String::new();
    };
    let half = |part: Option<f64>| part.map_or(NONE.to_string(), short);
    let mut headings = vec!["joint", "k [N·m/rad]", "± [%]", "systematic [%]"];
    if !found.left.is_empty() {
        headings.extend(["with the next ≈ [%]", "with all ≈ [%]"]);
    }
    let mut table = Table::new(headings);
    for joint in &standing.joints {
        let mut row = vec![
            joint.name.clone(),
            joint
                .stiffness_nm_per_rad
                .map_or(NONE.to_string(), stiffness),
            half(joint.total),
            half(joint.systematic),
        ];
        if !found.left.is_empty() {
            row.extend([half(joint.with_next), half(joint.with_all)]);
        }
        table.row(row);
    }
    table.to_string()
}

/// What to drive to next.
pub(super) fn next(cell: &Cell, plan: &[Posture], found: &Judgement) -> String {
    let reached = found.reached() == Some(true);
    let open = |name: &String| plan.iter().find(|posture| posture.name == *name);
    let mut out = match found.left.iter().find_map(open) {
        _ if reached => "next: nothing; the goal is reached".to_string(),
        None => "next: nothing; the plan is measured".to_string(),
        Some(posture) => {
            let again = match found.begun.contains(&posture.name) {
                true => ", which is begun",
                false => "",
            };
            format!(
                "next: posture {}{again}, q [deg] {}",
                posture.name,
                angles(&posture.q)
            )
        }
    };
    out = wrapped(&out, columns()) + "\n";
    if let Some(better) = &found.better {
        out += &(wrapped(&proposal(cell, better, found), columns()) + "\n");
    }
    out
}

/// A posture that helps more.
fn proposal(cell: &Cell, better: &NextPosture, found: &Judgement) -> String {
    let worst = |errors: &[Option<f64>]| {
        let names = cell.setup.robot.spring_names();
        let known = errors
            .iter()
            .zip(names)
            .filter_map(|(e, name)| Some(((*e)?, name)));
        known.max_by(|a, b| a.0.total_cmp(&b.0))
    };
    let mut out = match found.left.is_empty() {
        true => format!("{}: one more posture that would help most", yellow("note")),
        false => format!(
            "{}: a posture beside the plan would help more than the next one",
            yellow("note")
        ),
    };
    out += &format!(", q [deg] {}", angles(&better.angles));
    if let Some((error, name)) = worst(&better.after) {
        out += &format!(
            ": a standard error of at most {} % ({name}) by the scatter of the readings alone",
            short(error)
        );
    }
    out
}

fn angles(q: &[f64]) -> String {
    let degrees = q.iter().map(|q| {
        let deg = (rad_to_shortest_deg(*q) * 100.0).round() / 100.0 + 0.0;
        format!("{deg:.2}")
    });
    degrees.collect::<Vec<_>>().join(", ")
}

/// A fraction in percent with two digits.
fn short(fraction: f64) -> String {
    significant(100.0 * fraction, 2)
}
