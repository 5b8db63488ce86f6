//! Saved results as a page: what was done, what came out, what to do next.
//!
//! A part of the page is a function of the saved result, and of its cell where that is at hand: without it only
//! the pictures of the cell are missing. The command that made a result and `stiffarm report` build the same page.

mod compare;

pub use crate::summary::WithCell;

use crate::page::{Block, Page, Part, Provenance, Section};
use crate::summary::{cell_line, quoted, summarise};
use serde_json::Value;
use stiffarm::Result;
use stiffarm::findings::{Finding, Severity, visible};
use stiffarm_files::result::SavedResult;

/// The page of saved results, in their order.
///
/// # Errors
/// A result of a command that has no page, one that another version wrote and that looks different, or
/// postures that the cell cannot take.
pub fn report(saved_results: &[WithCell<'_>]) -> Result<Page> {
    let parts = saved_results.iter().map(part);
    let parts = parts.collect::<Result<Vec<Part>>>()?;
    let title = match parts.as_slice() {
        [one] => one.heading.clone(),
        parts => format!("{} results of stiffarm", parts.len()),
    };
    let cells: Vec<String> = saved_results.iter().filter_map(|one| one.cell.map(cell_line)).collect();
    let subtitle = match cells.split_first() {
        Some((first, rest)) if rest.iter().all(|other| other == first) => first.clone(),
        _ => cells.join("; "),
    };
    Ok(Page { title, subtitle, comparison: compare::compare(saved_results, &parts), parts })
}

/// The part of a page for what a result says.
fn part(with: &WithCell<'_>) -> Result<Part> {
    let summary = summarise(with)?;
    let is_note = |finding: &Finding| finding.severity == Severity::Note;
    let (notes, warnings): (Vec<Finding>, Vec<Finding>) = summary.findings.into_iter().partition(is_note);
    let mut sections = summary.sections;
    if !notes.is_empty() {
        let block = Block::Findings(notes);
        sections.push(Section::new("notes", "Notes", vec![block]));
    }
    Ok(Part {
        command: with.saved.command.clone(),
        heading: summary.heading,
        name: visible(&with.saved.name).into_owned(),
        outcome: summary.outcome,
        verdict: summary.verdict,
        warnings,
        key: summary.key,
        sections,
        provenance: provenance(with.saved),
    })
}

/// How a result was made.
fn provenance(saved: &SavedResult) -> Provenance {
    let mut options = Vec::new();
    flatten("", &saved.json["options"], &mut options);
    let words = saved.arguments.iter().map(|word| quoted(word));
    let words: Vec<String> = words.collect();
    let command_line = match saved.arguments.as_slice() {
        [] => String::new(),
        [call] if call.starts_with("stiffarm.") => call.clone(),
        _ => format!("stiffarm {}", words.join(" ")),
    };
    Provenance {
        version: visible(&saved.version).into_owned(),
        seed: saved.seed,
        command_line,
        inputs: saved.inputs.clone(),
        options,
    }
}

/// Options by their key path.
fn flatten(path: &str, value: &Value, out: &mut Vec<(String, String)>) {
    match value {
        Value::Object(map) => {
            for (key, value) in map {
                let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
                flatten(&path, value, out);
            }
        }
        Value::Null => out.push((path.to_string(), "–".to_string())),
        Value::String(text) => out.push((path.to_string(), visible(text).into_owned())),
        Value::Array(items) if items.is_empty() => out.push((path.to_string(), "none".to_string())),
        Value::Array(items) => {
            let items: Vec<String> = items.iter().map(plain).collect();
            out.push((path.to_string(), items.join(", ")));
        }
        other => out.push((path.to_string(), other.to_string())),
    }
}

/// A value of a list.
fn plain(value: &Value) -> String {
    match value {
        Value::String(text) => visible(text).into_owned(),
        other => other.to_string(),
    }
}
