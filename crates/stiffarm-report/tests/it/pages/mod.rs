//! Pages of saved results.

mod groups;
mod plans;

use serde_json::{Value, json};
use stiffarm::model::cell::Cell;
use stiffarm_files::result::SavedResult;
use stiffarm_report::page::{Block, Number, Page, Piece, Text, render_page};
use stiffarm_report::report::{Given, report};

/// A result as its command writes it.
fn saved(command: &str, mode: Option<&str>, result: &Value) -> SavedResult {
    let envelope = json!({
        "format": 1, "stiffarm": "0.1.0", "command": command, "arguments": [command, "{cell}"],
        "inputs": {"cell": "00"}, "seed": 1, "options": {"mode": mode}, "result": result,
    });
    SavedResult::of(&envelope, "result.json").unwrap()
}

fn page(saved: &SavedResult, cell: Option<&Cell>) -> Page {
    let page = report(&[Given::new(saved, cell)]).unwrap();
    holds(saved, &page);
    page
}

/// Every number of the page stands in the file where it says.
fn holds(saved: &SavedResult, page: &Page) {
    let mut found = Vec::new();
    for part in &page.parts {
        part.verdict
            .iter()
            .for_each(|text| numbers(text, &mut found));
        let key = part
            .key
            .iter()
            .flat_map(|table| table.rows.iter().flatten());
        key.for_each(|text| numbers(text, &mut found));
        let blocks = part.sections.iter().flat_map(|section| &section.blocks);
        blocks.for_each(|block| of_block(block, &mut found));
    }
    let pointed: Vec<&Number> = found.iter().filter(|n| !n.pointer.is_empty()).collect();
    assert!(!pointed.is_empty());
    for number in pointed {
        let value = saved.json.pointer(&number.pointer);
        let value = value.unwrap_or_else(|| panic!("{} is not in the file", number.pointer));
        assert_eq!(value.as_f64(), number.value, "{}", number.pointer);
    }
}

fn of_block(block: &Block, found: &mut Vec<Number>) {
    match block {
        Block::Text(text) => numbers(text, found),
        Block::List(texts) | Block::Lines(texts) => {
            texts.iter().for_each(|text| numbers(text, found))
        }
        Block::Table(table) => {
            let cells = table.rows.iter().flatten();
            cells.for_each(|text| numbers(text, found));
        }
        Block::Details(_, blocks) => blocks.iter().for_each(|block| of_block(block, found)),
        _ => {}
    }
}

fn numbers(text: &Text, found: &mut Vec<Number>) {
    found.extend(text.0.iter().filter_map(|piece| match piece {
        Piece::Number(number) => Some(number.clone()),
        _ => None,
    }));
}

/// The three sentences of the story.
fn story(page: &Page) -> [String; 3] {
    let [done, came, next] = &page.parts[0].verdict;
    [done.plain(), came.plain(), next.plain()]
}

/// The figures of the page by their names.
fn figures(page: &Page) -> Vec<String> {
    let blocks = page.parts[0]
        .sections
        .iter()
        .flat_map(|section| &section.blocks);
    let figures = blocks.filter_map(|block| match block {
        Block::Figure(figure) => Some(figure.id.clone()),
        _ => None,
    });
    figures.collect()
}

/// The page, the same both times.
fn html(page: &Page) -> String {
    let text = render_page(page);
    assert_eq!(text, render_page(page));
    text
}
