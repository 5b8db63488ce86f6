//! `--curve`: the best value for each number of postures, and what one more gains.

use super::certificate::efficient;
use super::job::{Job, Mode, number, to_usize, with_unit};
use crate::interrupt;
use crate::numbers::{optional_percent, percent};
use crate::progress::Progress;
use crate::table::{Table, title};
use schemars::JsonSchema;
use serde::Serialize;
use stiffarm::Control;
use stiffarm::findings::Finding;
use stiffarm::model::cell::Cell;
use stiffarm::plan::certificate::{CertificateOptions, certify};
use stiffarm::plan::index::Index;
use stiffarm::plan::select::{ErrorAtCount, GlobalOptions, error_by_count, select};
use stiffarm::{Code, Result};

/// Largest number of postures unless one is given.
const LARGEST: u64 = 12;

/// Options of the result.
#[derive(Serialize, JsonSchema)]
pub struct Options {
    /// `curve`.
    pub mode: Mode,
    /// Largest number of postures.
    pub postures: usize,
    /// Rounds asked for, for each number of postures; `null` where each search
    /// ended by itself.
    pub rounds: Option<u64>,
    /// Time after which no further round was begun, for each number of
    /// postures \[s\]; `null` without one.
    pub time_limit_s: Option<f64>,
    /// Whether bounds were wanted.
    pub certificate: bool,
    /// L of Eq. (20) \[m\].
    pub characteristic_length_m: Option<f64>,
}

/// The curve.
#[derive(Serialize, JsonSchema)]
pub struct Curve {
    /// The index.
    pub index: Index,
    /// One entry for each number of postures; an interruption leaves out the rest.
    pub sizes: Vec<Size>,
    /// Why there are no bounds, where the index has them; else `null`.
    pub certificate_missing: Option<String>,
    /// What to distrust about the robot of the catalogue.
    pub findings: Vec<Finding>,
}

/// The best group of one size, beside what is possible.
#[derive(Serialize, JsonSchema)]
pub struct Size {
    /// What the search found.
    #[serde(flatten)]
    pub point: ErrorAtCount,
    /// How much better the index becomes with one more posture (fraction);
    /// `null` for the last size and where there is no value.
    pub gain: Option<f64>,
    /// No group of this size has an index below this; `null` where the index
    /// has no bound, or none was wanted or found.
    pub bound: Option<f64>,
    /// `bound`/`value`.
    pub efficiency: Option<f64>,
}

/// Selects groups of every size up to the largest, and bounds them all.
pub(super) fn run(job: &Job<'_>) -> Result<()> {
    let budget = &job.args.budget;
    let largest = to_usize(job.args.postures.unwrap_or(LARGEST));
    let mut options = GlobalOptions::default();
    options.seed = job.seed();
    options.rounds = budget.rounds;
    options.time_limit = budget.time_limit;
    let progress = Progress::new(job.session, "selecting postures");
    let curve = progress.watch(|control| searched(job, largest, &options, &progress, control))?;
    drop(progress);
    job.outputs.write_text(job.session, || csv(&curve))?;
    let options = Options {
        mode: Mode::Curve,
        postures: largest,
        rounds: budget.rounds,
        time_limit_s: budget.time_limit.map(|limit| limit.as_secs_f64()),
        certificate: !job.args.no_certificate,
        characteristic_length_m: job.cell().characteristic_length,
    };
    let envelope = job
        .session
        .envelope("select", Some(job.seed()), options, &curve);
    job.show(&envelope, || table(job, &curve, largest))
}

fn searched(
    job: &Job<'_>,
    largest: usize,
    options: &GlobalOptions,
    progress: &Progress,
    control: Control<'_>,
) -> Result<Curve> {
    let (cell, index) = (job.cell(), job.index);
    let mut points = error_by_count(cell, index, 1..largest, options, control)?;
    // The largest group on its own: its postures are wanted for the bound.
    let mut group = None;
    if points.len() + 1 == largest && !control.stopped() {
        progress.tell(&format!("selecting {largest} postures, the last size"));
        let quiet = Control {
            progress: None,
            ..control
        };
        match select(cell, index, largest, options, quiet) {
            Ok(selection) => {
                points.push(ErrorAtCount {
                    postures: largest,
                    value: Some(selection.value),
                    expected_error: selection.evaluation.indices.expected_error,
                    rounds: selection.rounds,
                    evaluations: selection.evaluations,
                });
                group = Some(selection.group);
            }
            Err(error) if error.code() == Code::NotIdentifiable => points.push(ErrorAtCount {
                postures: largest,
                value: None,
                expected_error: None,
                rounds: None,
                evaluations: 0,
            }),
            Err(error) if error.code() == Code::Interrupted && !points.is_empty() => {}
            Err(error) => return Err(error),
        }
    }
    let mut missing = None;
    let mut bound_of_one = None;
    if let (Some(group), false) = (&group, job.args.no_certificate) {
        progress.tell("bounding what any group can give");
        match one_posture_bound(cell, index, group, &CertificateOptions::default(), control) {
            _ if control.stopped() => {
                missing = Some("stopped before the bound was found".to_string())
            }
            Ok(bound) => bound_of_one = Some(bound),
            Err(error) if error.code() == Code::Unsupported => {}
            Err(error) => missing = Some(error.message().trim_end_matches('.').to_string()),
        }
    }
    Ok(Curve {
        index,
        sizes: sizes(index, points, bound_of_one),
        certificate_missing: missing,
        findings: job.findings(),
    })
}

/// The bound of the index for one posture, from which that for n follows: the
/// bound is σ·sqrt(φ(M₀)/n) with the same M₀ for every n.
fn one_posture_bound(
    cell: &Cell,
    index: Index,
    group: &[Vec<f64>],
    options: &CertificateOptions,
    control: Control<'_>,
) -> Result<f64> {
    let quiet = Control {
        progress: None,
        ..control
    };
    let certificate = certify(cell, index, group, options, quiet)?;
    Ok(certificate.bound * (group.len() as f64).sqrt())
}

/// The points with what one more gains and what is possible.
fn sizes(index: Index, points: Vec<ErrorAtCount>, bound_of_one: Option<f64>) -> Vec<Size> {
    let next: Vec<Option<f64>> = points.iter().skip(1).map(|p| p.value).collect();
    let next = next.into_iter().chain([None]);
    points
        .into_iter()
        .zip(next)
        .map(|(point, next)| {
            let better = if index.larger_is_better() { -1.0 } else { 1.0 };
            let gain = point
                .value
                .zip(next)
                .map(|(now, next)| better * (now - next) / now);
            let bound = bound_of_one.map(|bound| bound / (point.postures as f64).sqrt());
            Size {
                gain,
                bound,
                efficiency: bound.zip(point.value).map(|(bound, value)| bound / value),
                point,
            }
        })
        .collect()
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
    if interrupt::stopped() {
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

#[cfg(test)]
mod tests {
    use super::*;
    use stiffarm::files::builtin;
    use stiffarm::plan::select::{StartKind, random_group};

    /// One certificate serves the whole curve.
    #[test]
    fn the_bound_of_one_size_is_that_of_another() {
        // This cell has tasks, and limits do not matter here.
        let mut cell = builtin::cell("comau").unwrap();
        cell.limits = Default::default();
        let mut options = CertificateOptions::default();
        options.samples = 64;
        for index in [Index::ExpectedError, Index::D, Index::Task] {
            let of_one = |count: usize| {
                let group = random_group(&cell, StartKind::Uniform, count, 1, 0).unwrap();
                one_posture_bound(&cell, index, &group, &options, Control::default()).unwrap()
            };
            let (three, eight) = (of_one(3), of_one(8));
            assert!((three / eight - 1.0).abs() < 2e-4, "{three} {eight}");
        }
    }

    #[test]
    fn gains_are_gains_for_every_index() {
        let point = |postures, value| ErrorAtCount {
            postures,
            value,
            expected_error: None,
            rounds: None,
            evaluations: 0,
        };
        let points = || vec![point(1, None), point(2, Some(4.0)), point(3, Some(3.0))];
        let smaller = sizes(Index::Condition, points(), None);
        let larger = sizes(Index::O3, points(), None);
        let gains = |sizes: &[Size]| sizes.iter().map(|s| s.gain).collect::<Vec<_>>();
        assert_eq!(gains(&smaller), [None, Some(0.25), None]);
        assert_eq!(gains(&larger), [None, Some(-0.25), None]);
        let bounded = sizes(Index::D, points(), Some(5.0));
        assert_eq!(bounded[0].bound, Some(5.0));
        assert_eq!(bounded[0].efficiency, None);
        assert!((bounded[1].efficiency.unwrap() - 5.0 / 2_f64.sqrt() / 4.0).abs() < 1e-12);
    }
}
