//! `--space-filling`: postures that cover the joint space evenly, as a baseline.

use super::job::{Job, to_usize};
use crate::commands::route::sentence;
use crate::commands::{evaluate, posture_table};
use crate::numbers::{coarse_mm, significant};
use crate::progress::Progress;
use crate::table::{title, yellow};
use stiffarm::model::posture::Posture;
use stiffarm::plan::planned::{SpaceFillingPlan, SpaceFillingRequest, plan_space_filling};
use stiffarm::{Result, Termination};

/// Spreads the postures and writes plan and sheet. True where a move has no free way.
pub(super) fn run(job: &Job<'_>) -> Result<bool> {
    let mut request = SpaceFillingRequest::default();
    request.postures = job.args.postures.map_or(request.postures, to_usize);
    request.seed = job.args.budget.seed.unwrap_or(request.seed);
    request.angle_step_deg = job.angle_step();
    let progress = Progress::new(job.session, "spreading postures");
    let planned = progress.watch(|control| plan_space_filling(job.cell(), &request, control))?;
    drop(progress);
    let result = &planned.result;
    job.deliver(&planned, || table(job, &planned.postures, result))?;
    Ok(result.is_blocked())
}

fn table(job: &Job<'_>, postures: &[Posture], result: &SpaceFillingPlan) -> String {
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
    out += &posture_table(cell, postures).to_string();
    let names = vec![postures.iter().map(|p| p.name.as_str()).collect()];
    out + &evaluate::tables(cell, evaluations, &names)
}
