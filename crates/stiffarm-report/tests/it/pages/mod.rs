//! Pages of saved results hold their numbers, figures and scenes.

mod groups;
mod plans;

use crate::common::{self, numbers_of_the_file, saved_with};
use serde_json::{Value, json};
use stiffarm::estimate::simulate::ModelErrors;
use stiffarm::model::cell::Cell;
use stiffarm_files::result::SavedResult;
use stiffarm_report::page::{Block, Page, render_page};
use stiffarm_report::report::{WithCell, report};

fn saved(command: &str, mode: Option<&str>, result: &Value) -> SavedResult {
    let options = match command {
        "route" => json!({"keep_order": false, "equivalents": false, "keep_wrist": false}),
        "simulate" => {
            json!({"levels": [0.5, 1.0], "runs": 30, "model_errors": ModelErrors::default()})
        }
        "zones" => json!({"steps": 15}),
        _ => json!({"mode": mode}),
    };
    saved_with(command, options, result.clone())
}

fn page(saved: &SavedResult, cell: Option<&Cell>) -> Page {
    let page = report(&[WithCell::new(saved, cell)]).unwrap();
    assert!(numbers_of_the_file(&page, saved) > 0);
    page
}

/// The three sentences of the story, a line each.
fn story(page: &Page) -> String {
    common::story(&page.parts[0].verdict)
}

/// Scenes in the markup of the page.
fn scenes(page: &Page) -> usize {
    html(page).matches("<div class=\"scene\"").count()
}

/// The figures of the page by their names.
fn figures(page: &Page) -> Vec<String> {
    let blocks = page.parts[0].sections.iter().flat_map(|section| &section.blocks);
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
