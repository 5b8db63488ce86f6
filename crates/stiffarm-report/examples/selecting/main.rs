//! Makes the numbers and pictures of `docs/selecting.md`.
//!
//! ```text
//! cargo run --release -p stiffarm-report --example selecting -- --output-dir docs/images
//! ```
//!
//! Everything has a fixed seed and a fixed number of rounds: the same program on
//! the same machine writes the same bytes. Numbers are rounded to six digits.

mod figures;
mod novel;
mod plans;
mod questions;

use novel::NovelIndex;
use plans::{Band, Plan};
use questions::{Certified, CountPoint, LoadCase, Lost, ZoneGroups};
use serde::Serialize;
use serde_json::{Number, Value};
use std::path::PathBuf;
use std::time::Instant;
use stiffarm::Control;
use stiffarm::Result;
use stiffarm::model::cell::Cell;
use stiffarm::plan::index::Index;
use stiffarm::plan::select::{Sensitivity, SensitivityOptions, sensitivity, space_filling};
use stiffarm::plan::zones::{MapRange, Zone, ZoneOptions, zones};
use stiffarm_files::builtin;
use stiffarm_report::{Figure, render_svg};

/// Rounds of each selection of the table of plans.
const ROUNDS: u64 = 8;
/// Rounds after which the global searches under the novel index are looked at;
/// with joint bounds only they take longer to settle.
const ROUNDS_DEFAULT: [u64; 3] = [1, 4, 16];
const ROUNDS_REFERENCE: [u64; 4] = [1, 4, 16, 48];

/// The indices of the table of plans.
const INDICES: [Index; 13] = [
    Index::Classical,
    Index::Condition,
    Index::Novel,
    Index::Scaled,
    Index::ExpectedError,
    Index::WorstJoint,
    Index::DropOne,
    Index::D,
    Index::Task,
    Index::Prediction,
    Index::O3,
    Index::O4,
    Index::O5,
];

/// Everything the page quotes.
#[derive(Serialize)]
struct Numbers {
    command: &'static str,
    stiffarm: &'static str,
    /// Six postures under each index, the hand-picked group, and
    /// space-filling groups, on the default cell.
    plans: Vec<Plan>,
    random: Band,
    /// Six postures under the expected error from five seeds.
    expected_error_by_seed: Vec<f64>,
    novel: Vec<NovelIndex>,
    count: Vec<CountPoint>,
    certified: Vec<Certified>,
    lost: Vec<Lost>,
    load: Vec<LoadCase>,
    prior: Sensitivity,
    zone: Option<Zone>,
    /// Smallest, middle and largest relative change of the translation by K_C.
    zone_translation: Option<MapRange>,
    /// The same of the rotation.
    zone_rotation: Option<MapRange>,
    zone_groups: Option<ZoneGroups>,
}

fn main() -> std::result::Result<(), Box<dyn std::error::Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let folder = match words.as_slice() {
        [] => PathBuf::from("docs/images"),
        [flag, folder] if flag == "--output-dir" => PathBuf::from(folder),
        _ => return Err("usage: selecting [--output-dir FOLDER]".into()),
    };
    std::fs::create_dir_all(&folder)?;
    let (numbers, figures) = numbers()?;
    let mut value = serde_json::to_value(&numbers)?;
    round(&mut value);
    let text = serde_json::to_string_pretty(&value)? + "\n";
    std::fs::write(folder.join("selecting.json"), text)?;
    for figure in figures {
        let file = folder.join(format!("{}.svg", figure.id));
        std::fs::write(file, render_svg(&figure))?;
    }
    Ok(())
}

fn numbers() -> Result<(Numbers, Vec<Figure>)> {
    let begin = Instant::now();
    let say = |what: &str| eprintln!("{:6.1} s  {what}", begin.elapsed().as_secs_f64());
    let default = builtin::cell("comau")?;
    let reference = builtin::cell("comau-reference")?;
    let group1: Vec<Vec<f64>> =
        builtin::postures("comau-group1", &default.setup.robot)?.into_iter().map(|posture| posture.q).collect();

    say("plans");
    let mut plans = vec![Plan::new(&default, "Group 1", &group1)?];
    for index in INDICES {
        plans.push(Plan::select(&default, index, group1.len(), 1, ROUNDS)?);
    }
    for count in [6, 15, 20] {
        let group = space_filling(&default, count, 1, Control::default())?.postures;
        plans.push(Plan::new(&default, &format!("space-filling {count}"), &group)?);
    }
    let random = Band::new(&default, 200, group1.len())?;

    let by_seed = (1..=5).map(|seed| {
        let plan = Plan::select(&default, Index::ExpectedError, group1.len(), seed, ROUNDS)?;
        Ok(plan.index(Index::ExpectedError))
    });
    let expected_error_by_seed = by_seed.collect::<Result<Vec<f64>>>()?;

    say("certificates");
    let of_reference = [Index::ExpectedError, Index::D, Index::WorstJoint, Index::DropOne]
        .into_iter()
        .map(|index| Plan::select(&reference, index, group1.len(), 1, ROUNDS))
        .collect::<Result<Vec<Plan>>>()?;
    let certified = vec![questions::certified(&default, &plans)?, questions::certified(&reference, &of_reference)?];

    say("number of postures");
    let whole = &certified[0].certificates[0];
    let one = whole.bound * (whole.posture_count as f64).sqrt();
    let count = questions::count(&default, one)?;

    say("lost postures");
    let mut lost = Vec::new();
    for (cell, plans) in [(&default, &plans), (&reference, &of_reference)] {
        for name in ["expected-error", "drop-one"] {
            for plan in plans.iter().filter(|p| p.name == name) {
                lost.push(Lost::new(cell, plan)?);
            }
        }
    }

    say("load");
    let load = questions::load(&default)?;

    say("prior");
    let prior = prior(&default, &plans)?;

    say("zones");
    let maps = zones(&default, &ZoneOptions::default(), Control::default())?;
    let zone_groups = match &maps.best {
        Some(zone) => Some(ZoneGroups::new(&default, zone)?),
        None => None,
    };

    say("the novel index, default cell");
    let mut novel = vec![NovelIndex::new(&default, &group1, &ROUNDS_DEFAULT, &default)?];
    say("the novel index, reference cell");
    novel.push(NovelIndex::new(&reference, &group1, &ROUNDS_REFERENCE, &default)?);
    say("done");

    let figures = vec![
        figures::deviation(&default, &plans, &random),
        figures::novel(&novel),
        figures::count(&count),
        figures::zones(&maps),
    ];
    let numbers = Numbers {
        command: "cargo run --release -p stiffarm-report --example selecting",
        stiffarm: env!("CARGO_PKG_VERSION"),
        plans,
        random,
        expected_error_by_seed,
        novel,
        count,
        certified,
        lost,
        load,
        prior,
        zone: maps.best,
        zone_translation: maps.translation_range,
        zone_rotation: maps.rotation_range,
        zone_groups,
    };
    Ok((numbers, figures))
}

/// The expected-error plan under changed priors.
fn prior(cell: &Cell, plans: &[Plan]) -> Result<Sensitivity> {
    let index = Index::ExpectedError;
    let plan = plans.iter().find(|p| p.name == "expected-error");
    let group = plan.map_or(&[][..], |p| p.group.as_slice());
    let options = SensitivityOptions::default();
    sensitivity(cell, index, group, &options, Control::default())
}

/// Rounds every number to six digits.
fn round(value: &mut Value) {
    match value {
        Value::Array(items) => items.iter_mut().for_each(round),
        Value::Object(entries) => entries.values_mut().for_each(round),
        Value::Number(number) if number.is_f64() => {
            let short = number.as_f64().and_then(|v| format!("{v:.5e}").parse().ok()).and_then(Number::from_f64);
            if let Some(short) = short {
                *number = short;
            }
        }
        _ => {}
    }
}
