//! `--curve`: the best value for each number of postures, and what one more gains.

use super::certificate::efficient;
use super::job::{Job, number, to_usize, with_unit};
use crate::numbers::{optional_percent, percent};
use crate::progress::Progress;
use crate::table::{Table, title};
use stiffarm::Result;
use stiffarm::plan::index::Index;
use stiffarm::plan::planned::{Curve, CurveRequest, plan_curve};

/// Selects groups of every size up to the largest, and bounds them all.
pub(super) fn run(job: &Job<'_>) -> Result<()> {
    let budget = &job.args.budget;
    let mut request = CurveRequest::default();
    request.index = job.index;
    request.postures = job.args.postures.map_or(request.postures, to_usize);
    request.rounds = budget.rounds;
    request.time_limit = budget.time_limit;
    request.seed = budget.seed.unwrap_or(request.seed);
    request.certificate = !job.args.no_certificate;
    let progress = Progress::new(job.session, "selecting postures");
    let planned = progress.watch(|control| {
        let mut watch = |stage| job.tell(&progress, stage);
        plan_curve(job.cell(), &request, &mut watch, control)
    })?;
    drop(progress);
    let curve = &planned.result;
    job.outputs.write_text(job.session, || csv(curve))?;
    job.show(&planned, || table(job, curve, request.postures))
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

fn table(job: &Job<'_>, curve: &Curve, largest: usize) -> String {
    let index = curve.index;
    let is_error = index == Index::ExpectedError;
    let mut out = job.heading();
    if let Some(why) = &curve.certificate_missing {
        out += &format!("bounds: none; {why}\n");
    }
    out += &title("Best value for each number of postures");
    let has_errors = !is_error && curve.sizes.iter().any(|s| s.point.expected_error.is_some());
    let has_bounds = curve.sizes.iter().any(|s| s.bound.is_some());
    let mut headings = vec!["postures".to_string(), with_unit(index, index.as_str())];
    if has_errors {
        headings.push("expected_error [%]".to_string());
    }
    headings.push("one more gains [%]".to_string());
    if has_bounds {
        headings.push(with_unit(index, "none below"));
        headings.push("efficiency".to_string());
    }
    let mut table = Table::new(headings);
    for size in &curve.sizes {
        let mut row = vec![
            size.point.postures.to_string(),
            number(index, size.point.value),
        ];
        if has_errors {
            row.push(optional_percent(size.point.expected_error));
        }
        row.push(size.gain.map_or_else(String::new, percent));
        if has_bounds {
            row.push(number(index, size.bound));
            row.push(size.efficiency.map_or_else(|| "-".to_string(), efficient));
        }
        table.row(row);
    }
    out += &table.to_string();
    if curve.sizes.iter().any(|s| s.point.value.is_none()) {
        out += "-: so few postures cannot determine every joint\n";
    }
    if job.session.stopped() {
        let last = curve.sizes.last().map_or(0, |s| s.point.postures);
        if last < largest {
            out += &format!(
                "interrupted: the search for {last} postures was cut short, larger groups were not searched\n"
            );
        } else {
            out += "interrupted: the last search may have been cut short\n";
        }
    }
    out
}
