//! What to know about a cell before anybody measures in it: joints the load
//! cannot excite, points that cannot see a joint, limits that no posture
//! meets, numbers that look like a slip of the unit.
//!
//! The checks look at postures spread evenly over the bounds, so they speak of
//! the whole cell and not of one plan.

mod beside_arm;
mod excitation;
mod further_load;
mod prepared;
mod reason;
mod slips;
mod start;
mod work;

pub use excitation::JointExcitation;
pub(crate) use further_load::both_loads;
pub use further_load::{FurtherAnchor, FurtherLoad};
pub use prepared::{determinable, prepared, springs_left_out};
pub use start::start_touches;

use crate::error::Result;
use crate::findings::{Finding, Severity, length, list};
use crate::model::cell::{Cell, LimitMargin};
use crate::model::load::{Load, Wrench};
use crate::model::observation::{PostureTerms, Setup, check_angles};
use crate::model::robot::{DoubtAbout, Robot};
use crate::numerics::streams::spread;
use crate::plan::feasibility::{obstruction_among, on_machine_limits};
use crate::units::rad_to_sentence_deg;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Postures that [`check`] spreads over the bounds.
pub const SAMPLES: u32 = 256;
/// Postures of an experiment for which a second load is weighed.
const ONE_LOAD_POSTURES: usize = 12;
/// Share of postures within the limits below which a cell counts as cramped.
const CRAMPED: f64 = 0.02;
/// What stands farther from the base's origin belongs to no cell \[m\].
const FARTHEST_IN_CELL: f64 = 100.0;

/// Result of a check.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CellCheck {
    /// The findings, the most serious first.
    pub findings: Vec<Finding>,
    /// Postures sampled within the bounds.
    pub postures_sampled: usize,
    /// How many of them meet the cell's limits.
    pub postures_within_limits: usize,
    /// The joints, base to flange.
    pub joints: Vec<JointExcitation>,
}

impl CellCheck {
    /// True when a finding makes the cell unusable as it is.
    pub fn is_serious(&self) -> bool {
        self.findings.iter().any(|f| f.severity == Severity::Serious)
    }
}

/// Checks a cell on [`SAMPLES`] postures spread over its bounds. The same cell
/// always gives the same result.
///
/// ```
/// # fn main() -> stiffarm::Result<()> {
/// use stiffarm_files::builtin;
/// use stiffarm::plan::check::check;
///
/// let cell = builtin::cell("comau")?;
/// let found = check(&cell)?;
/// assert!(found.joints.iter().all(|joint| joint.determined));
/// assert!(!found.is_serious());
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// Bounds whose number differs from the joints', or that are not finite.
pub fn check(cell: &Cell) -> Result<CellCheck> {
    let mut findings = Vec::new();
    let sampled = sampled_terms(cell)?;
    let within: Vec<&Sample> = sampled.iter().filter(|s| s.is_allowed).collect();
    let postures_within_limits = within.len();
    reach(cell, postures_within_limits, &mut findings)?;
    // Where nothing is reachable, the load is still worth a word.
    let looked_at = if within.is_empty() { sampled.iter().collect() } else { within };
    let terms: Vec<&PostureTerms> = looked_at.iter().flat_map(|s| &s.terms).collect();
    let joints = excitation::check(cell, &terms, &mut findings)?;
    one_load(cell, &looked_at, &mut findings);
    validation(cell, &mut findings);
    machine_limits(cell, &mut findings);
    findings.extend(robot_doubts(&cell.setup.robot));
    slips::check(cell, &mut findings);
    findings.extend(two_noises(cell));
    beside_arm::check(cell, &mut findings);
    findings.extend(start_touches(cell));
    work::check(cell, &mut findings);
    setup(cell, &mut findings);
    shapes(cell, &mut findings);
    findings.sort_by_key(|f| std::cmp::Reverse(f.severity));
    Ok(CellCheck { findings, postures_sampled: sampled.len(), postures_within_limits, joints })
}

/// What is doubtful about a robot of the catalogue, or about the angles and rows of one's own, one finding
/// `robot-doubt` or `dh-convention` each: whatever uses its numbers says so. How a source was read is left out.
pub fn robot_doubts(robot: &Robot) -> Vec<Finding> {
    let doubts = robot.doubts().iter();
    let coupling =
        robot.controller().filter(|controller| controller.couples_joint_3() && robot.level_forearm().is_some());
    let coupling = coupling.map(|controller| {
        let sentence = format!(
            "Pendants of {} count joint 3 by the forearm's angle to the floor, which stays while joint 2 moves alone; \
             theta_from_q of this cell counts it otherwise. Look at the pendant (docs/robots.md) before the arm is \
             driven.",
            controller.title()
        );
        Finding::caution("robot-doubt", "robot.theta_from_q", sentence)
    });
    let convention = robot.like_in_other_convention().map(|lookalike| {
        let [stated, other] = [robot.convention(), robot.convention().other()].map(|c| c.name());
        let sentence = format!(
            "Read as {stated} rows the arm is like no robot of the catalogue, read as {other} ones it is like {}: name \
             the rows robot.dh_{other}, or compare a posture with the pendant (stiffarm pose).",
            lookalike.name
        );
        Finding::caution("dh-convention", format!("robot.dh_{stated}"), sentence)
    });
    doubts
        .filter(|doubt| doubt.about != DoubtAbout::Source)
        .map(|doubt| {
            let subject = match doubt.about {
                DoubtAbout::Limits => "robot.limits_deg",
                DoubtAbout::Angles => "robot.theta_from_q",
                _ => "robot.catalogue",
            };
            Finding::caution("robot-doubt", subject, doubt.sentence)
        })
        .chain(coupling)
        .chain(convention)
        .collect()
}

/// Says where limits of ±360° only stand in for unknown ones.
fn machine_limits(cell: &Cell, findings: &mut Vec<Finding>) {
    if cell.setup.robot.limits_are_unknown() {
        findings.push(Finding::caution(
            "unknown-limits",
            "robot.limits_deg",
            "The machine's limits are not known: -360° to 360° stand in for them. Give robot.limits_deg, or bounds \
             that the machine can reach, before a plan is driven.",
        ));
    }
}

/// Distances from a tracker at which readings are taken \[m\].
const FROM_TRACKER: [f64; 2] = [2.0, 10.0];
/// Noises that differ by less may both be meant: one averages, the other is a data sheet's.
const SIMILAR_NOISE_RATIO: f64 = 1.5;

/// Says where `[noise]` and `[tracker]` are two stories of the same readings.
fn two_noises(cell: &Cell) -> Option<Finding> {
    let accuracy = cell.tracker.accuracy.as_ref()?;
    let at = |distance| {
        let beam = accuracy.station + Vector3::x() * distance;
        let covariance = accuracy.covariance(&beam).ok()?;
        Some((covariance.trace() / 3.0).sqrt())
    };
    let [near, far] = FROM_TRACKER.map(at);
    let (near, far, scatter) = (near?, far?, cell.noise.reading_variance.sqrt());
    let agrees = scatter * SIMILAR_NOISE_RATIO >= near && scatter <= far * SIMILAR_NOISE_RATIO;
    let sentence = format!(
        "[noise] has a reading scatter by {} along an axis, [tracker] by {} at {} m and {} at {} m: plans, forecasts \
         and simulated readings count with [noise], `--weights tracker` with [tracker].",
        length(scatter),
        length(near),
        FROM_TRACKER[0],
        length(far),
        FROM_TRACKER[1]
    );
    (!agrees && scatter > 0.0).then(|| Finding::caution("two-noises", "noise", sentence))
}

/// One sampled posture.
struct Sample {
    /// Controller angles \[rad\].
    q: Vec<f64>,
    /// Its terms under each load; three of them, under unit forces along x, y and z, where the
    /// force is only known once it is measured.
    terms: Vec<PostureTerms>,
    /// Whether it meets the cell's limits.
    is_allowed: bool,
}

fn sampled_terms(cell: &Cell) -> Result<Vec<Sample>> {
    let setup = &cell.setup;
    let middle: Vec<f64> = cell.bounds.iter().map(|b| (b[0] + b[1]) / 2.0).collect();
    check_angles(&setup.robot, &middle)?;
    let forces: Vec<(Setup, Option<Wrench>)> = match setup.load {
        Load::Measured => (0..3).map(|axis| (setup.clone(), Some(Wrench::force(Vector3::ith(axis, 1.0))))).collect(),
        _ => setup.cases().into_iter().map(|case| (case, None)).collect(),
    };
    let mut margins = cell.posture_margins()?;
    (0..SAMPLES)
        .map(|i| {
            let q = spread(&cell.bounds, i);
            let terms = forces
                .iter()
                .map(|(setup, wrench)| PostureTerms::new(setup, &q, wrench.as_ref()))
                .collect::<Result<Vec<_>>>()?;
            let is_allowed = margins.are_met(&q)?;
            Ok(Sample { q, terms, is_allowed })
        })
        .collect()
}

/// How many of the postures the limits leave.
fn reach(cell: &Cell, within: usize, findings: &mut Vec<Finding>) -> Result<()> {
    if cell.is_unlimited() {
        if cell.setup.load != Load::Measured {
            findings.push(Finding::caution(
                "no-limits",
                "limits",
                "There are no limits on where the tool may be: a selection may bring it below the floor, \
                 into the robot's own column or onto the load's anchor.",
            ));
        }
        return Ok(());
    }
    if within as f64 >= CRAMPED * f64::from(SAMPLES) {
        return Ok(());
    }
    // What a selection says that finds nothing.
    let sentence = obstruction_among(cell, SAMPLES)?.words();
    if within == 0 {
        findings.push(Finding::serious(
            "unreachable-limits",
            "limits",
            format!("{sentence} Check the limits' frame (robot base) and unit (mm)."),
        ));
    } else {
        findings.push(Finding::caution("cramped-limits", "limits", sentence));
    }
    Ok(())
}

/// Says what a second load would bring.
fn one_load(cell: &Cell, samples: &[&Sample], findings: &mut Vec<Finding>) {
    let allowed = samples.iter().filter(|s| s.is_allowed);
    let some: Vec<&[f64]> = allowed.take(ONE_LOAD_POSTURES).map(|s| s.q.as_slice()).collect();
    let further_load = FurtherLoad::new(cell, &some);
    findings.extend(further_load.map(|further_load| further_load.finding(cell, some.len())));
}

/// Validation postures: the machine's limits bind them, the cell's limits warn.
fn validation(cell: &Cell, findings: &mut Vec<Finding>) {
    let setup = &cell.setup;
    let Ok(mut margins) = cell.posture_margins() else {
        return;
    };
    for mut finding in on_machine_limits(cell, &cell.validation) {
        finding.subject = "validation.posture".to_string();
        findings.push(finding);
    }
    for posture in &cell.validation {
        if check_angles(&setup.robot, &posture.q).is_err() {
            continue;
        }
        if let Some((j, angle)) = cell.outside_machine_limits(&posture.q) {
            let joint = &setup.robot.joints()[j];
            let [low, high] = joint.limits.map(rad_to_sentence_deg);
            findings.push(Finding::serious(
                "validation-outside-machine-limits",
                "validation.posture",
                format!(
                    "Validation posture {} has {} at {}°, outside the machine's limits, {low}° to {high}°.",
                    posture.name,
                    joint.name,
                    rad_to_sentence_deg(angle)
                ),
            ));
            continue;
        }
        let smallest = margins.smallest(&posture.q).unwrap_or(None);
        if let Some(margin) = smallest.filter(LimitMargin::is_violated) {
            findings.push(Finding::caution(
                "validation-outside-limits",
                "validation.posture",
                format!("Validation posture {} {}.", posture.name, margin.violation()),
            ));
        }
    }
}

/// What of the shapes is not looked at.
fn shapes(cell: &Cell, findings: &mut Vec<Finding>) {
    let dropped: Vec<String> = cell.scene.dropped_pairs().map(|(a, b)| format!("{a} and {b}")).collect();
    if !dropped.is_empty() {
        let dropped: Vec<&str> = dropped.iter().map(String::as_str).collect();
        findings.push(Finding::note(
            "pairs-left-out",
            "clearance.shapes_mm",
            format!(
                "These come nearer than {:.0} mm in every posture, because their shapes are drawn large, and are not \
                 kept apart: {}.",
                cell.scene.clearance() * 1e3,
                list(&dropped)
            ),
        ));
    }
    let has_link_shapes = !cell.setup.robot.link_capsules().is_empty();
    if !cell.scene.parts().is_empty() && !has_link_shapes {
        findings.push(Finding::caution(
            "no-link-shapes",
            "robot.shape",
            "The robot's links have no shapes: only tool, rope and beams are kept away from what stands in the cell. \
             Give [[robot.shape]]; stiffarm capsules makes them from meshes.",
        ));
    }
}

/// What is missing or only half honest in the description.
fn setup(cell: &Cell, findings: &mut Vec<Finding>) {
    let tool = &cell.setup.tool;
    if tool.has_sensor && tool.series_compliance.is_none() {
        findings.push(Finding::caution(
            "sensor-compliance",
            "tool.series_compliance",
            "A force sensor sits between flange and reflectors, but its compliance is not given: what the \
             sensor yields is taken for the joints' (10 to 20 % on the wrist joints for a usual sensor).",
        ));
    }
    if cell.prior.is_none() {
        findings.push(Finding::note(
            "no-prior",
            "stiffness.prior_nm_per_rad",
            "There is no prior joint stiffness: expected errors, the indices built on them and the \
             simulation are not available. Orders of magnitude suffice.",
        ));
    }
    if cell.noise.readings_per_displacement == 1 {
        findings.push(Finding::note(
            "one-reading",
            "noise.readings_per_displacement",
            "One reading is counted per displacement, as the paper does. A displacement is the difference of \
             a loaded and an unloaded reading: unless the variance is already that of a displacement, give 2.",
        ));
    }
    for (j, (bounds, joint)) in cell.bounds.iter().zip(cell.setup.robot.joints()).enumerate() {
        if bounds[0] < joint.limits[0] - 1e-9 || bounds[1] > joint.limits[1] + 1e-9 {
            findings.push(Finding::serious(
                "bounds-outside-machine-limits",
                format!("bounds.q_deg[{}]", j + 1),
                format!("The bounds of {} reach beyond the machine's limits.", joint.name),
            ));
        }
    }
}
