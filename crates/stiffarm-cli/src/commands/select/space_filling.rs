//! `--space-filling`: postures that cover the joint space evenly, as a baseline.

use super::job::{Job, Mode, POSTURES, to_usize};
use crate::commands::route::{blocked_moves, is_blocked, sentence};
use crate::commands::{degrees, evaluate, posture_table};
use crate::numbers::{coarse_mm, significant};
use crate::progress::Progress;
use crate::table::{title, yellow};
use schemars::JsonSchema;
use serde::Serialize;
use stiffarm::findings::Finding;
use stiffarm::model::posture::PostureGroup;
use stiffarm::plan::index::{GroupEvaluation, evaluate as evaluate_group};
use stiffarm::plan::route::Route;
use stiffarm::plan::select::{smallest_distance, smallest_margin, space_filling};
use stiffarm::{Result, Termination};

/// Options of the result.
#[derive(Serialize, JsonSchema)]
pub struct Options {
    /// `space_filling`.
    pub mode: Mode,
    /// Number of postures.
    pub postures: usize,
    /// Steps that angles were rounded to \[deg\]; `null` where they were not.
    pub angle_step_deg: Option<f64>,
    /// L of Eq. (20) \[m\].
    pub characteristic_length_m: Option<f64>,
}

/// Evenly spread postures with what they are worth.
#[derive(Serialize, JsonSchema)]
pub struct SpaceFilling {
    /// Names of the joints, as in `evaluation`.
    pub joints: Vec<String>,
    /// Selected postures, controller angles \[deg\].
    pub postures_deg: Vec<Vec<f64>>,
    /// Names of the selected postures, in the order of `postures_deg`.
    pub posture_names: Vec<String>,
    /// Smallest distance of two postures, relative to the joints' ranges: 0 to
    /// the root of their number; `null` for one posture.
    pub smallest_distance: Option<f64>,
    /// Why the search ended.
    pub termination: Termination,
    /// Smallest margin to a limit of the cell \[m\], `null` without limits.
    pub smallest_margin_m: Option<f64>,
    /// Every index and expected deviation of the postures.
    pub evaluation: GroupEvaluation,
    /// The moves between the postures, in their order.
    pub route: Route,
    /// What to distrust about the robot of the catalogue, and moves without a free way.
    pub findings: Vec<Finding>,
}

/// Spreads the postures and writes plan and sheet. True where a move has no free way.
pub(super) fn run(job: &Job<'_>) -> Result<bool> {
    let cell = job.cell();
    let count = to_usize(job.args.postures.unwrap_or(POSTURES));
    let progress = Progress::new(job.session, "spreading postures");
    let found = progress.watch(|control| space_filling(cell, count, job.seed(), control))?;
    drop(progress);
    let stopped = found.termination == Termination::Interrupted;
    let (postures, route) = job.route(cell, &found.postures, stopped)?;
    let group = PostureGroup::from_angles("space-filling", postures);
    let result = SpaceFilling {
        findings: {
            let mut findings = job.findings();
            findings.extend(blocked_moves(&group.postures, &route));
            findings
        },
        joints: cell.setup.robot.spring_names(),
        postures_deg: degrees(&group.postures),
        posture_names: group.postures.iter().map(|p| p.name.clone()).collect(),
        smallest_distance: smallest_distance(&cell.bounds, &group.postures),
        termination: found.termination,
        smallest_margin_m: smallest_margin(cell, &group.postures)?,
        evaluation: evaluate_group(cell, &group.name, &group.postures)?,
        route,
    };
    job.outputs
        .write_postures(job.session, cell, &group.postures)?;
    let options = Options {
        mode: Mode::SpaceFilling,
        postures: count,
        angle_step_deg: job.angle_step(),
        characteristic_length_m: cell.characteristic_length,
    };
    let envelope = job
        .session
        .envelope("select", Some(job.seed()), options, &result);
    job.show(&envelope, || table(job, &group, &result))?;
    Ok(is_blocked(&result.findings))
}

fn table(job: &Job<'_>, group: &PostureGroup, result: &SpaceFilling) -> String {
    let cell = job.cell();
    let evaluations = std::slice::from_ref(&result.evaluation);
    let mut out = job.heading();
    out += &evaluate::undetermined(evaluations);
    if let Some(distance) = result.smallest_distance {
        out += &format!(
            "smallest distance of two postures: {} of the joints' ranges (root of the sum of squares)\n",
            significant(distance, 3)
        );
    }
    if result.termination == Termination::Interrupted {
        out += &format!(
            "{}: stopped; more exchanges may spread the postures further\n",
            yellow("note")
        );
    }
    if let Some(margin) = result.smallest_margin_m {
        out += &format!(
            "smallest margin to the cell's limits: {} mm\n",
            coarse_mm(margin.max(0.0))
        );
    }
    if !result.route.moves.is_empty() {
        out += &sentence(cell, &result.route);
    }
    out += &title("Postures");
    out += &posture_table(cell, &group.postures).to_string();
    let names = vec![group.postures.iter().map(|p| p.name.as_str()).collect()];
    out + &evaluate::tables(cell, evaluations, &names)
}
