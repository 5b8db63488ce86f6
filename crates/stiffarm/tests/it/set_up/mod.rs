//! What the cell states of the set-up is held against the readings.

mod days;
mod mistakes;

use crate::common::prelude::*;
use days::{Beyond, Day, Kind, day, displacements};
use mistakes::{MISTAKES, Mistake, Plant};
use rayon::prelude::*;
use stiffarm::estimate::setup::{SetUp, set_up};
use stiffarm::model::measurement::Measurements;
use stiffarm::work::judged::{Options as JudgeOptions, judge};

const QUIET: JudgeOptions = JudgeOptions {
    until_stiffness: None,
    until_deflection_m: None,
    search: false,
};

/// The cell as it is stated, and what was read.
fn planted(mistake: &Mistake, beyond: Beyond, seed: u64) -> (Cell, Measurements) {
    let Day {
        mut cell,
        mut table,
    } = day(mistake.kind, beyond, 12, mistake.states, seed);
    match mistake.plant {
        Plant::Cell(plant) => plant(&mut cell),
        Plant::Readings(plant) => plant(&cell, &mut table),
        Plant::Table(plant) => {
            let mut measured = displacements(&cell, &table);
            plant(&mut measured);
            return (cell, measured.into());
        }
        Plant::CellOfTable(plant) => {
            let measured = displacements(&cell, &table);
            plant(&mut cell);
            return (cell, measured.into());
        }
    }
    (cell, table.into())
}

/// All that `measure` says of the readings.
fn said(cell: &Cell, measurements: Measurements) -> Vec<Finding> {
    let reduce = ReduceOptions::default();
    match judge(
        (cell, &[]),
        Ok(measurements),
        &reduce,
        (&QUIET, 1),
        Control::default(),
    ) {
        Ok(found) => found.readings,
        Err(error) => vec![Finding::serious("error", "", error.to_string())],
    }
}

/// `named`, `noticed`, `silent`, and the sentence.
fn outcome(mistake: &Mistake, beyond: Beyond, seed: u64) -> (&'static str, String) {
    let (cell, measurements) = planted(mistake, beyond, seed);
    let found = said(&cell, measurements);
    let is_it = |f: &&Finding| mistake.words.iter().all(|word| f.sentence.contains(word));
    let mut heard: Vec<&Finding> = found
        .iter()
        .filter(|f| f.severity > Severity::Note)
        .collect();
    heard.sort_by_key(|f| std::cmp::Reverse(f.severity));
    if let Some(named) = found
        .iter()
        .find(is_it)
        .filter(|_| !mistake.words.is_empty())
    {
        let other = found.iter().find(|f| f.code == "set-up" && !is_it(f));
        return match other {
            Some(other) => ("misled", other.sentence.clone()),
            None => ("named", named.sentence.clone()),
        };
    }
    match heard.first() {
        Some(first) => ("noticed", first.sentence.clone()),
        None => ("silent", String::new()),
    }
}

fn tested(cell: &Cell, measurements: impl Into<Measurements>) -> SetUp {
    let measured = prepare(cell, measurements, &Default::default()).unwrap();
    let fit = Fit::new(cell, measured, &Default::default()).unwrap();
    set_up(&fit, None).unwrap().unwrap_or_default()
}

#[test]
fn explore() {
    let only = std::env::var("ONLY").unwrap_or_default();
    let rows: Vec<&Mistake> = MISTAKES.iter().filter(|m| m.name.contains(&only)).collect();
    let beyond = match std::env::var("BEYOND").as_deref() {
        Ok("structure") => Beyond::Structure("arm_4"),
        Ok("nothing") => Beyond::Nothing,
        _ => Beyond::Tilts(5e-8, 1e-8),
    };
    rows.par_iter().for_each(|mistake| {
        let now = std::time::Instant::now();
        let (outcome, sentence) = outcome(mistake, beyond, 1);
        if std::env::var("DUMP").is_ok() {
            let (cell, measurements) = planted(mistake, beyond, 1);
            println!("{} {:#?}", mistake.name, tested(&cell, measurements));
        }
        println!(
            "{} | {outcome} | {:.1?} | {sentence}",
            mistake.name,
            now.elapsed()
        );
    });
}

#[test]
fn sound() {
    let runs: u64 = std::env::var("RUNS").map_or(2, |r| r.parse().unwrap());
    let beyonds = [
        Beyond::Nothing,
        Beyond::Tilts(5e-8, 1e-8),
        Beyond::Tilts(3e-7, 3e-8),
        Beyond::Structure("realistic"),
        Beyond::Structure("arm_0"),
        Beyond::Structure("arm_4"),
        Beyond::Structure("links_half"),
        Beyond::LostMotion(0.3),
        Beyond::Drift(4e-9),
        Beyond::Common(3e-5),
    ];
    let mut rows = Vec::new();
    for seed in 100..100 + runs {
        for (i, beyond) in beyonds.iter().enumerate() {
            let kinds = [
                Kind::Rope,
                Kind::Lever,
                Kind::Weight,
                Kind::Sensor,
                Kind::Forces,
            ];
            let kind = kinds[(seed as usize + i) % 5];
            let kind = if matches!(beyond, Beyond::Structure(_)) && kind == Kind::Lever {
                Kind::Rope
            } else {
                kind
            };
            rows.push((
                kind,
                *beyond,
                seed,
                [6, 12][(seed as usize / 2 + i) % 2],
                (seed as usize + i) % 3 == 0,
            ));
        }
    }
    rows.par_iter()
        .for_each(|(kind, beyond, seed, count, is_table)| {
            let Day { cell, table } =
                day(*kind, *beyond, *count, if *is_table { 2 } else { 3 }, *seed);
            let found = if *is_table && !matches!(kind, Kind::Sensor | Kind::Forces) {
                tested(&cell, displacements(&cell, &table))
            } else {
                tested(&cell, table)
            };
            let all: Vec<String> = found
                .freed
                .iter()
                .map(|f| {
                    format!(
                        "{} {:.0} ({:.3}→{:.3}) {:.3?}",
                        f.name,
                        f.likelihood_ratio,
                        1e3 * f.residual_rms_m[0],
                        1e3 * f.residual_rms_m[1],
                        f.asked
                    )
                })
                .collect();
            println!(
                "{kind:?} {beyond:?} {seed} {count} {is_table}{} {}",
                if found.finding.is_some() {
                    " FALSE"
                } else {
                    ""
                },
                all.join(" ; ")
            );
        });
}
