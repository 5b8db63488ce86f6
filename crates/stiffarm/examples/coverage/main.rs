//! Counts how often intervals hold the truth and writes `docs/coverage.md` and
//! `crates/stiffarm/data/coverage.json`, which the library embeds.
//!
//! `cargo run --release -p stiffarm --example coverage`; with `-- --experiments N`
//! at most N experiments for each row, the page on standard output and nothing written.

mod cases;
mod page;

use cases::{Bench, Row};
use std::path::Path;
use stiffarm::Control;
use stiffarm::estimate::coverage::{Coverage, Record, coverage};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let most = most()?;
    let rows = Bench::new()?.rows()?;
    let total = rows.len();
    let mut records = Vec::with_capacity(total);
    for (i, mut row) in rows.into_iter().enumerate() {
        if let Some(most) = most {
            row.case.experiments = row.case.experiments.min(most);
        }
        let coverage = coverage(&row.cell, &row.group.postures, &row.case, Control::default())?;
        eprintln!("{:>3}/{total} {:6.2} % {}", i + 1, 100.0 * coverage.coverage, row.situation);
        records.push(record(row, &coverage));
    }
    let page = page::page(&records);
    if most.is_some() {
        print!("{page}");
        return Ok(());
    }
    let crate_folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    std::fs::write(crate_folder.join("../../docs/coverage.md"), page)?;
    std::fs::write(crate_folder.join("data/coverage.json"), json(&records)?)?;
    Ok(())
}

/// The number behind `--experiments`.
fn most() -> Result<Option<usize>, String> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    match words.iter().map(String::as_str).collect::<Vec<_>>().as_slice() {
        [] => Ok(None),
        ["--experiments", number] => {
            number.parse().map(Some).map_err(|_| format!("--experiments {number}: not a number."))
        }
        _ => Err("The only option is --experiments N.".to_string()),
    }
}

fn record(row: Row, coverage: &Coverage) -> Record {
    let shares = || coverage.joints.iter().map(|j| j.coverage);
    Record {
        table: row.table.to_string(),
        situation: row.situation,
        intervals: row.intervals,
        adverse: row.adverse,
        postures: row.group.postures.len(),
        points: row.cell.setup.tool.point_count(),
        degrees_of_freedom: coverage.degrees_of_freedom,
        experiments: coverage.experiments,
        coverage: digits(coverage.coverage),
        standard_error: digits(coverage.standard_error),
        lowest: digits(shares().fold(f64::INFINITY, f64::min)),
        highest: digits(shares().fold(0.0, f64::max)),
        relative_half_width: coverage.relative_half_width.map(digits),
        open_above: digits(coverage.open_above),
    }
}

/// Five decimals: more than the experiments can tell.
fn digits(value: f64) -> f64 {
    (value * 1e5).round() / 1e5
}

/// The table, one record a line.
fn json(records: &[Record]) -> serde_json::Result<String> {
    let lines: Vec<String> = records
        .iter()
        .map(|r| serde_json::to_string(r).map(|line| format!("    {line}")))
        .collect::<serde_json::Result<_>>()?;
    Ok(format!(
        "{{\n  \"made_by\": \"cargo run --release -p stiffarm --example coverage\",\n  \"records\": [\n{}\n  ]\n}}\n",
        lines.join(",\n")
    ))
}
