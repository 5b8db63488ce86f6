//! `--curve`: the best value for each number of postures, and what one more gains.

use super::job::Job;
use crate::answer::Answer;
use crate::output::Exit;
use crate::progress::Progress;
use stiffarm::Result;
use stiffarm::ask::select::{Curve, plan_curve};
use stiffarm::plan::index::Index;

/// Selects groups of every size up to the largest, and bounds them all.
pub(super) fn run(job: &Job<'_>) -> Result<Answer> {
    let progress = Progress::new(job.session, "selecting postures");
    let planned = progress.watch(|control| {
        let mut watch = |stage| job.show(&progress, stage);
        plan_curve(job.cell(), &job.args.options, &mut watch, control)
    })?;
    drop(progress);
    let table = job.outputs.text(|| csv(&planned.result));
    let exit = Exit::of_findings(&planned.result.findings);
    Ok(job.summary(planned, exit).with(table))
}

/// The curve as CSV: fractions as in JSON, the task index in metres.
fn csv(curve: &Curve) -> String {
    let is_error = curve.index == Index::ExpectedError;
    let mut heading = vec!["postures", curve.index.as_str()];
    if !is_error {
        heading.push("expected_error");
    }
    heading.extend(["gain", "bound", "efficiency"]);
    let mut text = heading.join(",") + "\n";
    let field = |value: Option<f64>| value.map_or_else(String::new, |v| v.to_string());
    for size in &curve.sizes {
        let mut fields = vec![size.point.postures.to_string(), field(size.point.value)];
        if !is_error {
            fields.push(field(size.point.expected_error));
        }
        fields.extend([size.gain, size.bound, size.efficiency].map(field));
        text += &(fields.join(",") + "\n");
    }
    text
}
