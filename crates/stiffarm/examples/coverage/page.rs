//! The page `docs/coverage.md`, from the table alone.

use std::fmt::Write;
use stiffarm::estimate::coverage::{Intervals, Record};

/// Names of the tables of the page.
pub const EXACT: &str = "exact";
/// The two-variance model.
pub const TWO_VARIANCE: &str = "two-variance";
/// Estimators without exact intervals.
pub const INEXACT: &str = "inexact";
/// Errors that no interval models.
pub const BESIDE: &str = "beside";

/// The page, Markdown.
pub fn page(records: &[Record]) -> String {
    let of = |table: &str| -> Vec<&Record> { records.iter().filter(|r| r.table == table).collect() };
    [HEAD.to_string(), exact(&of(EXACT)), two_variance(&of(TWO_VARIANCE)), inexact(&of(INEXACT)), beside(&of(BESIDE))]
        .join("\n")
}

const HEAD: &str = "\
# Do the intervals cover?

A 95 % interval should hold the true stiffness in 95 of 100 experiments. This page counts it: experiments are simulated on the
default cell (`builtin:comau`), identified by the same code as `stiffarm identify`, and the intervals that hold the truth are
counted, all six joints together. Made by

```
cargo run --release -p stiffarm --example coverage
```

from fixed seeds: the same numbers for any number of threads.

- A displacement is the difference of two readings, each with the cell's tracker noise; displacements follow the linear model.
- Postures are drawn at random within the cell's limits, or selected for the smallest expected error where the row says so.
- Cells hold the coverage [%] and, in brackets, the mean half-width of the interval of the compliance 1/k over the true
  compliance [%]. Columns are postures × measuring points of each, then the degrees of freedom of the interval's quantile
  where all rows have the same.
- An interval that is open above counts as holding the truth when the truth is above its lower end; a joint without an
  interval (negative stiffness beyond noise) counts as missed.

Standard errors, the joints one by one and the share of open intervals of each cell are in `crates/stiffarm/data/coverage.json`.
";

fn exact(records: &[&Record]) -> String {
    let worst = records.iter().map(|r| (r.coverage - 0.95).abs()).fold(0.0, f64::max);
    let verdict = if worst <= 0.005 {
        "within half a point, the most this project accepts"
    } else {
        "**more than half a point, the most this project accepts**"
    };
    format!(
        "## Exact intervals\n\n\
         Linear estimators with normal errors: the interval is exact whatever the postures, also with three degrees of freedom.\n\n\
         {}\n\
         {} The largest distance from 95 % is {:.2} percentage points: {verdict}.\n",
        table(records),
        counted(records),
        100.0 * worst
    )
}

fn two_variance(records: &[&Record]) -> String {
    let least = || {
        let shares = records.iter().map(|r| r.coverage);
        100.0 * shares.fold(f64::INFINITY, f64::min)
    };
    let most = 100.0 * records.iter().map(|r| r.coverage).fold(0.0, f64::max);
    let verdict = if least() >= 94.0 {
        "not below 94 %, the least this project accepts"
    } else {
        "**below 94 %, the least this project accepts**"
    };
    format!(
        "## The two-variance model\n\n\
         The default estimator finds two variances by restricted maximum likelihood: σ² of a displacement component and τ² of a shift \
         that all points of a posture share. Its t quantile has 3·postures − n degrees of freedom, as if each posture were one \
         reading. That is careful, most of all without a shift, and the more so the fewer the postures.\n\n\
         {}\n\
         {} From {:.2} to {most:.2} %, {verdict}.\n",
        table(records),
        counted(records),
        least()
    )
}

fn inexact(records: &[&Record]) -> String {
    let names = [
        (Intervals::Huber, "Huber's estimator", HUBER),
        (Intervals::NonNegative, "Non-negative fit", NON_NEGATIVE),
        (Intervals::Prior, "Prior stiffness as further knowledge", PRIOR),
        (Intervals::Bootstrap, "Bootstrap over postures", BOOTSTRAP),
    ];
    let mut out = "## Intervals that are not exact\n\n\
        For these the command prints what was measured here, at the nearest degrees of freedom of the table that are not above those of \
        the fit. Below the table's smallest no coverage is claimed.\n"
        .to_string();
    for (intervals, title, words) in names {
        let matching: Vec<&Record> = records.iter().copied().filter(|r| r.intervals == Some(intervals)).collect();
        let range = |adverse: bool| {
            let values = || matching.iter().filter(|r| r.adverse == adverse).map(|r| 100.0 * r.coverage);
            let low = values().fold(f64::INFINITY, f64::min);
            let high = values().fold(0.0, f64::max);
            format!("{low:.1} to {high:.1} %")
        };
        let smallest = matching.iter().filter_map(|r| r.degrees_of_freedom).min().unwrap_or(0);
        // Writing to a string cannot fail.
        let _ = write!(
            out,
            "\n### {title}\n\n{words}\n\n{}\n{} As assumed: {}; against the assumptions: {}. No coverage is claimed below \
             {smallest} degrees of freedom.\n",
            table(&matching),
            counted(&matching),
            range(false),
            range(true)
        );
    }
    out
}

const HUBER: &str = "\
Intervals from Huber's asymptotic covariance with his correction for few rows, Student's t on rows − n.";
const NON_NEGATIVE: &str = "\
Intervals of the free two-variance fit, laid about the non-negative values; a joint held at zero gets a lower bound.";
const PRIOR: &str = "\
Two-variance fit with the prior stiffness ± 30 % as further rows. The noise is ten times the cell's, else the prior has no say.";
const BOOTSTRAP: &str = "\
Percentile intervals of two-variance fits to postures drawn with replacement, 400 resamples. Degrees of freedom are \
3·postures − n. Resamples that lose a joint are skipped. A bootstrap takes \
postures as draws from one population, which selected ones are not; with few postures its intervals are too narrow.";

fn beside(records: &[&Record]) -> String {
    format!(
        "## Beside the model\n\n\
         Errors that no interval models, on six random postures. Intervals state the noise; what is common to all postures (force scale, \
         loading point) shows in no residual, and belongs to the common-mode part of the result. What differs from posture to posture \
         (force of a posture, part of the lost motion) the two-variance model takes up in part as its shift.\n\n{}\n{}\n",
        table(records),
        counted(records)
    )
}

/// A row for each situation, a column for each size of the experiment.
fn table(records: &[&Record]) -> String {
    let mut situations: Vec<(&str, bool)> = Vec::new();
    let mut sizes: Vec<(usize, usize)> = Vec::new();
    for r in records {
        let situation = (r.situation.as_str(), r.adverse);
        if !situations.contains(&situation) {
            situations.push(situation);
        }
        if !sizes.contains(&(r.postures, r.points)) {
            sizes.push((r.postures, r.points));
        }
    }
    let mut out = "| simulated |".to_string();
    for &(postures, points) in &sizes {
        let freedoms =
            || records.iter().filter(|r| (r.postures, r.points) == (postures, points)).map(|r| r.degrees_of_freedom);
        let first = freedoms().next().flatten();
        let dof = match first {
            Some(dof) if freedoms().all(|d| d == first) => format!(", {dof}"),
            _ => String::new(),
        };
        out += &format!(" {postures} × {points}{dof} |");
    }
    out += &format!("\n|:--|{}\n", "--:|".repeat(sizes.len()));
    for (situation, adverse) in situations {
        let against = if adverse { "*against*: " } else { "" };
        out += &format!("| {against}{situation} |");
        for &size in &sizes {
            let record = records.iter().find(|r| r.situation == situation && (r.postures, r.points) == size);
            out += &format!(" {} |", record.map(|r| share(r)).unwrap_or_default());
        }
        out.push('\n');
    }
    out
}

/// Coverage and half-width, in per cent.
fn share(r: &Record) -> String {
    let coverage = 100.0 * r.coverage;
    match r.relative_half_width {
        Some(width) => format!("{coverage:.2} ({:.1})", 100.0 * width),
        None => format!("{coverage:.2}"),
    }
}

/// How much was counted, and how far joints and standard errors go.
fn counted(records: &[&Record]) -> String {
    let experiments = records.iter().map(|r| r.experiments).min().unwrap_or(0);
    let low = records.iter().map(|r| r.lowest).fold(1.0, f64::min);
    let high = records.iter().map(|r| r.highest).fold(0.0, f64::max);
    let error = records.iter().map(|r| r.standard_error).fold(0.0, f64::max);
    format!(
        "{experiments} experiments a cell, standard errors up to {:.2} %; single joints have {:.1} to {:.1} %.",
        100.0 * error,
        100.0 * low,
        100.0 * high
    )
}
