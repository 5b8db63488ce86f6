//! The tables of an identification.

use super::messages;
use crate::numbers::{NONE, mm, optional, optional_percent, percent, significant, stiffness};
use crate::table::{Align, Table, title};
use stiffarm::estimate::diagnose::{JointSignal, TermTrials};
use stiffarm::estimate::identified::Identified;
use stiffarm::estimate::identify::{Bootstrap, Estimates, Identification, JointEstimate, Verdict};
use stiffarm::estimate::systematic::{SystematicErrors, SystematicSource};
use stiffarm::units::{m_to_mm, rad_to_deg};

/// Postures whose residuals the table shows.
const SHOWN_RESIDUALS: usize = 5;
/// Further terms that the table shows.
const SHOWN_TERMS: usize = 5;
/// Displacements whose weights the table shows.
const SHOWN_WEIGHTS: usize = 10;
/// Minutes of arc in a degree.
const ARCMIN: f64 = 60.0;

/// k with intervals, and both parts of its uncertainty.
pub(super) fn estimates(
    found: &Estimates,
    budget: Option<&SystematicErrors>,
    bootstrap: Option<&Bootstrap>,
) -> Table {
    let interval_heading = format!(
        "{} % interval [N·m/rad]",
        messages::confidence(found.confidence)
    );
    let mut headings = vec![
        "joint".to_string(),
        "k [N·m/rad]".to_string(),
        "± standard error".to_string(),
        interval_heading,
        "relative error [%]".to_string(),
    ];
    if budget.is_some() {
        headings.push("common errors [%]".to_string());
    }
    if bootstrap.is_some() {
        headings.push("bootstrap interval".to_string());
    }
    let mut table = Table::new(headings);
    for (j, joint) in found.joints.iter().enumerate() {
        let mut row = estimate(joint);
        if let Some(budget) = budget {
            row.push(optional_percent(budget.combined[j]));
        }
        if let Some(bootstrap) = bootstrap {
            row.push(ends(bootstrap.joints[j].interval));
        }
        table.row(row);
    }
    table
}

/// Intervals by resampled postures.
pub(super) fn bootstrap(found: &Bootstrap) -> Table {
    let mut table = Table::new(["joint", "bootstrap interval [N·m/rad]"]);
    for joint in &found.joints {
        table.row([joint.name.clone(), ends(joint.interval)]);
    }
    table
}

fn estimate(joint: &JointEstimate) -> Vec<String> {
    let relative = joint
        .readings_standard_error
        .zip(joint.stiffness)
        .map(|(e, k)| percent(e / k.abs()));
    let none = || NONE.to_string();
    vec![
        joint.name.clone(),
        joint.stiffness.map_or_else(none, stiffness),
        joint.readings_standard_error.map_or_else(none, stiffness),
        interval(joint),
        relative.unwrap_or_else(none),
    ]
}

fn interval(joint: &JointEstimate) -> String {
    match (joint.verdict, joint.readings_interval) {
        (Verdict::Undetermined, _) => "undetermined".to_string(),
        (Verdict::SignOrModelFault, _) => "sign or model fault".to_string(),
        (_, interval) => ends(interval),
    }
}

pub(super) fn ends(interval: [Option<f64>; 2]) -> String {
    match interval {
        [Some(low), Some(high)] => format!("{} to {}", stiffness(low), stiffness(high)),
        [Some(low), None] => format!("above {}", stiffness(low)),
        _ => NONE.to_string(),
    }
}

/// Further springs, lost motion, and combinations that are determined; empty
/// where there are none.
pub(super) fn further(found: &Estimates) -> String {
    let mut out = String::new();
    if !found.extra_springs.is_empty() {
        let mut table = Table::new([
            "further spring",
            "k [N·m/rad]",
            "± standard error",
            "interval [N·m/rad]",
            "relative error [%]",
        ]);
        for spring in &found.extra_springs {
            table.row(estimate(spring));
        }
        out += &format!("\n{table}");
    }
    if !found.lost_motion.is_empty() {
        let mut table = Table::new(["lost motion", "half gap [arcmin]", "interval [arcmin]"]);
        let arcmin = |rad: f64| significant(rad_to_deg(rad) * ARCMIN, 3);
        for lost in &found.lost_motion {
            let interval = match lost.interval {
                [Some(low), Some(high)] => format!("{} to {}", arcmin(low), arcmin(high)),
                _ => NONE.to_string(),
            };
            table.row([
                lost.name.clone(),
                lost.angle.map_or_else(|| NONE.to_string(), arcmin),
                interval,
            ]);
        }
        out += &format!("\n{table}");
    }
    if !found.combinations.is_empty() {
        let mut table = Table::new([
            "determined together",
            "compliance [rad/(N·m)]",
            "± standard error",
        ]);
        for sum in &found.combinations {
            let terms: Vec<String> = sum
                .unknowns
                .iter()
                .zip(&sum.coefficients)
                .enumerate()
                .map(|(i, (name, c))| term(i, name, *c))
                .collect();
            table.row([
                terms.concat(),
                significant(sum.compliance, 4),
                optional(sum.standard_error, 2),
            ]);
        }
        out += &format!("\n{table}");
    }
    out
}

/// One term of a sum of compliances: `1/k(joint 4) + 0.5/k(joint 6)`.
fn term(position: usize, name: &str, coefficient: f64) -> String {
    let size = match coefficient.abs() {
        c if (c - 1.0).abs() < 5e-4 => "1".to_string(),
        c => significant(c, 3),
    };
    let sign = match (position, coefficient < 0.0) {
        (0, false) => "",
        (0, true) => "-",
        (_, false) => " + ",
        (_, true) => " - ",
    };
    format!("{sign}{size}/k({name})")
}

/// The common-mode budget, a row for each source.
pub(super) fn common(budget: &SystematicErrors) -> Table {
    let mut headings = ["source", "size", "from", "left [%]"]
        .map(String::from)
        .to_vec();
    headings.extend(budget.joints.iter().cloned());
    let mut table = Table::new(headings);
    table.align(2, Align::Left);
    for source in &budget.sources {
        let from = if source.declared { "cell" } else { "assumed" };
        let mut row = vec![
            source.name.replace('-', " "),
            size_in_words(source),
            from.to_string(),
            optional_percent(source.remaining),
        ];
        row.extend(source.change.iter().map(|c| optional_percent(*c)));
        table.row(row);
    }
    let mut total = ["all, as far as the readings leave them", "", "", ""]
        .map(String::from)
        .to_vec();
    total.extend(budget.combined.iter().map(|c| optional_percent(*c)));
    table.row(total);
    table
}

/// Torque and displacement of each joint.
pub(super) fn signals(signals: &[JointSignal]) -> Table {
    let mut table = Table::new([
        "joint",
        "torque RMS [N·m]",
        "displacement RMS [mm]",
        "displacement / residual",
    ]);
    for joint in signals {
        table.row([
            joint.name.clone(),
            significant(joint.torque_rms_nm, 3),
            joint
                .displacement_rms_m
                .map_or_else(|| NONE.to_string(), mm),
            optional(joint.to_residual, 3),
        ]);
    }
    table
}

/// Further terms by how well the postures predict each other with them.
pub(super) fn trials(trials: &TermTrials) -> Table {
    let mut table = Table::new([
        "term",
        "leave-one-out RMS [mm]",
        "against without [%]",
        "estimate",
        "then not determined",
    ]);
    table.align(4, Align::Left);
    let base = trials.rms_m.map_or_else(|| NONE.to_string(), mm);
    table.row(["none".to_string(), base]);
    for trial in trials.trials.iter().take(SHOWN_TERMS) {
        let estimate = match (trial.value, trial.standard_error) {
            (Some(v), Some(e)) if trial.term.is_spring() && v > 0.0 => format!(
                "{} ± {} % N·m/rad",
                stiffness(1.0 / v),
                significant(100.0 * e / v, 2)
            ),
            (Some(_), Some(_)) if trial.term.is_spring() => "negative".to_string(),
            (Some(v), Some(e)) => {
                let arcmin = |rad: f64| significant(rad_to_deg(rad) * ARCMIN, 2);
                format!("{} ± {} arcmin", arcmin(v), arcmin(e))
            }
            _ => NONE.to_string(),
        };
        table.row([
            trial.name.clone(),
            trial.rms_m.map_or_else(|| NONE.to_string(), mm),
            trial.ratio.map_or_else(
                || NONE.to_string(),
                |r| format!("{:+.1}", 100.0 * (r - 1.0)),
            ),
            estimate,
            trial.lost_joints.join(", "),
        ]);
    }
    table
}

/// Huber's smallest weights.
pub(super) fn weights(found: &Identification) -> String {
    let low: Vec<_> = found.weights.iter().filter(|w| w.weight < 1.0).collect();
    let mut out = title("Displacements that count less (Huber)");
    if low.is_empty() {
        return out + "none\n";
    }
    let mut table = Table::new(["posture", "state", "point", "weight"]);
    table.align(1, Align::Left);
    table.align(2, Align::Left);
    for weight in low.iter().take(SHOWN_WEIGHTS) {
        table.row([
            weight.posture.clone(),
            weight.state.clone(),
            weight.point.clone(),
            significant(weight.weight, 2),
        ]);
    }
    out += &table.to_string();
    if low.len() > SHOWN_WEIGHTS {
        out += &format!(
            "and {} more of {}\n",
            low.len() - SHOWN_WEIGHTS,
            found.weights.len()
        );
    }
    out
}

/// Postures with the largest residuals, and how well the others predict them.
pub(super) fn residuals(result: &Identified) -> Table {
    let found = &result.identification;
    let has_states = found
        .postures
        .iter()
        .any(|p| p.state != found.postures[0].state);
    let influence = result.diagnosis.as_ref().and_then(|d| d.influence.as_ref());
    let mut headings = vec![
        "posture",
        "residual RMS [mm]",
        "displacement RMS [mm]",
        "residual / mean",
    ];
    if influence.is_some() {
        headings.push("from the others [mm]");
    }
    if has_states {
        headings.push("state");
    }
    let mut table = Table::new(headings);
    let mut postures: Vec<_> = found.postures.iter().collect();
    postures.sort_by(|a, b| b.residual_rms_m.total_cmp(&a.residual_rms_m));
    for posture in postures.into_iter().take(SHOWN_RESIDUALS) {
        let ratio =
            (found.residual_rms_m > 0.0).then(|| posture.residual_rms_m / found.residual_rms_m);
        let mut row = vec![
            posture.posture.clone(),
            mm(posture.residual_rms_m),
            mm(posture.displacement_rms_m),
            optional(ratio, 3),
        ];
        if let Some(influence) = influence {
            let own = influence
                .postures
                .iter()
                .find(|p| p.posture == posture.posture);
            let predicted = own.and_then(|p| p.prediction_rms_m);
            row.push(predicted.map_or_else(|| NONE.to_string(), mm));
        }
        if has_states {
            row.push(posture.state.clone());
        }
        table.row(row);
    }
    table
}

/// Size of a source with its unit.
pub(super) fn size_in_words(source: &SystematicSource) -> String {
    let size = source.size;
    match source.unit.as_str() {
        "1" => format!("{} %", percent(size)),
        "m" => format!("{} mm", significant(m_to_mm(size), 2)),
        "rad" if source.name == "lost-motion" => {
            format!("{} arcmin", significant(rad_to_deg(size) * ARCMIN, 2))
        }
        "rad" => format!("{} mrad", significant(size * 1e3, 2)),
        _ if size > 0.0 => format!("{} N·m/rad", significant(1.0 / size, 2)),
        _ => "rigid".to_string(),
    }
}
