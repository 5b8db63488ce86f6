//! Cells, results and pages that several subjects share.

use serde_json::{Value, json};
use std::collections::HashSet;
use std::sync::LazyLock;
use stiffarm::Control;
use stiffarm::ask::identify::{Identified, IdentifiedOptions};
use stiffarm::estimate::identify::{Fit, IdentifyOptions};
use stiffarm::measure::{Measured, prepare};
use stiffarm::model::cell::Cell;
use stiffarm::model::measurement::{ReadingTable, ReadingTarget};
use stiffarm::model::posture::{Posture, PostureGroup};
use stiffarm::simulated_readings;
use stiffarm_files::builtin;
use stiffarm_files::cell::parse_cell;
use stiffarm_files::result::SavedResult;
use stiffarm_report::page::{Block, Page, Piece, Text};

/// The test cell with a limit of every kind.
pub fn with_shapes() -> Cell {
    let text = include_str!("../../../../stiffarm/tests/cells/comau-shapes.toml");
    parse_cell(text, "comau-shapes").unwrap()
}

/// `count` postures spread over the bounds.
pub fn spread(cell: &Cell, count: usize) -> Vec<Posture> {
    spread_by(cell, count, |joint| 0.31 + 0.11 * joint as f64)
}

/// The same, each joint in steps of this share of its range.
pub fn spread_by(cell: &Cell, count: usize, step: impl Fn(usize) -> f64) -> Vec<Posture> {
    let angles = (0..count).map(|i| {
        let share = |j: usize| (0.5 + (i + 1) as f64 * step(j)) % 1.0;
        let bounds = cell.bounds.iter().enumerate();
        bounds.map(|(j, [a, b])| a + (b - a) * share(j)).collect()
    });
    PostureGroup::from_angles("spread", angles).postures
}

pub fn group(cell: &Cell) -> Vec<Posture> {
    builtin::postures("comau-group1", &cell.setup.robot).unwrap()
}

/// A cell with simulated displacements of these postures.
pub fn measured(cell: &Cell, postures: &[Posture]) -> Measured {
    let readings = simulated_readings(cell, postures, 1).unwrap();
    prepare(cell, readings, &Default::default()).unwrap()
}

/// Two points of the second posture exchanged.
pub fn exchange(readings: &mut ReadingTable) {
    let states = readings.postures[1].states.iter_mut();
    for reading in states.flat_map(|state| &mut state.readings) {
        reading.target = match reading.target.clone() {
            ReadingTarget::Point(0) => ReadingTarget::Point(2),
            ReadingTarget::Point(2) => ReadingTarget::Point(0),
            other => other,
        };
    }
}

/// What the command writes, without the search for a next posture.
pub fn identified(cell: &Cell, measured: &Measured) -> Value {
    let fit = Fit::new(cell, measured, &IdentifyOptions::default()).unwrap();
    let control = Control { stop: Some(&|| true), ..Control::default() };
    let mut identified = Identified::new(&fit, &IdentifiedOptions::default(), control).unwrap();
    (identified.profile, identified.not_computed) = (None, Vec::new());
    json!(identified)
}

/// What `identify` makes of good readings of the default cell.
pub fn good() -> Value {
    static GOOD: LazyLock<Value> = LazyLock::new(|| {
        let cell = builtin::cell("comau").unwrap();
        identified(&cell, &measured(&cell, &group(&cell)))
    });
    GOOD.clone()
}

/// A result as its command writes it.
pub fn saved(command: &str, result: Value) -> SavedResult {
    saved_with(command, json!({"exclude": []}), result)
}

/// The same with other options.
pub fn saved_with(command: &str, options: Value, result: Value) -> SavedResult {
    let envelope = json!({
        "format": 1, "stiffarm": "0.1.0", "command": command, "inputs": {}, "seed": 1,
        "options": options, "result": result
    });
    SavedResult::of(&envelope, "result").unwrap()
}

/// The three sentences of a verdict, a line each.
pub fn story(verdict: &[Text; 3]) -> String {
    verdict.each_ref().map(Text::plain).join("\n")
}

/// How many numbers of the page are those of the file; every one stands there, to the last bit.
pub fn numbers_of_the_file(page: &Page, saved: &SavedResult) -> usize {
    let mut texts = Vec::new();
    for part in &page.parts {
        texts.extend(&part.verdict);
        texts.extend(part.key.iter().flat_map(|key| key.rows.iter().flatten()));
        let sections = part.sections.iter();
        sections.for_each(|section| texts_of(&section.blocks, &mut texts));
    }
    let mut in_file = HashSet::new();
    all_numbers(&saved.json, &mut in_file);
    let mut count = 0;
    for piece in texts.into_iter().flat_map(|text| &text.0) {
        let Piece::Number(number) = piece else {
            continue;
        };
        if number.is_of_result {
            let bits = number.value.map(f64::to_bits);
            assert!(in_file.contains(&bits), "{number:?} is not in the file");
            count += 1;
        }
    }
    count
}

/// Every number of a file, and `None` for `null`.
fn all_numbers(value: &Value, out: &mut HashSet<Option<u64>>) {
    match value {
        Value::Null => drop(out.insert(None)),
        Value::Number(number) => drop(out.insert(number.as_f64().map(f64::to_bits))),
        Value::Array(items) => items.iter().for_each(|item| all_numbers(item, out)),
        Value::Object(map) => map.values().for_each(|item| all_numbers(item, out)),
        _ => {}
    }
}

fn texts_of<'a>(blocks: &'a [Block], out: &mut Vec<&'a Text>) {
    for block in blocks {
        match block {
            Block::Text(text) => out.push(text),
            Block::List(texts) | Block::Lines(texts) => out.extend(texts),
            Block::Table(table) => out.extend(table.rows.iter().flatten()),
            Block::Details(_, inside) => texts_of(inside, out),
            _ => {}
        }
    }
}
