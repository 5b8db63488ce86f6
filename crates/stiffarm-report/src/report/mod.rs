//! Saved results as a page: what was done, what came out, what to do next.
//!
//! A part of the page is a function of the saved result, and of its cell where that is at hand: without it only
//! the pictures of the cell are missing. The command that made a result and `stiffarm report` build the same page.

mod arrows;
mod at_work;
mod compare;
mod compensate;
mod context;
mod evaluate;
mod identify;
mod map;
mod place;
mod points;
mod postures;
mod predict;
mod register;
mod select;
mod simulate;
mod study;
mod study_measured;
mod tables;
mod validate;
mod worth;
mod zones;

pub use crate::tell::Given;

use crate::page::{Page, Part};
use context::Context;
use stiffarm::{Code, Error, Result};

/// Commands whose results become pages.
pub const COMMANDS: [&str; 11] = [
    "compensate",
    "evaluate",
    "identify",
    "map",
    "predict",
    "register",
    "select",
    "simulate",
    "study",
    "validate",
    "zones",
];

/// The page of saved results, in their order.
///
/// # Errors
/// A result of a command that has no page, one that another version wrote and that looks different, or
/// postures that the cell cannot take.
pub fn report(given: &[Given<'_>]) -> Result<Page> {
    let parts = given.iter().map(|one| part(&Context::new(one)));
    let parts = parts.collect::<Result<Vec<Part>>>()?;
    let title = match parts.as_slice() {
        [one] => one.heading.clone(),
        parts => format!("{} results of stiffarm", parts.len()),
    };
    let cells: Vec<String> = given.iter().filter_map(Given::cell_line).collect();
    let subtitle = match cells.split_first() {
        Some((first, rest)) if rest.iter().all(|other| other == first) => first.clone(),
        _ => cells.join("; "),
    };
    Ok(Page {
        title,
        subtitle,
        comparison: compare::compare(&parts),
        parts,
    })
}

fn part(context: &Context<'_>) -> Result<Part> {
    match context.saved.command.as_str() {
        "compensate" => compensate::part(context),
        "evaluate" => evaluate::part(context),
        "identify" => identify::part(context),
        "map" => map::part(context),
        "predict" => predict::part(context),
        "register" => register::part(context),
        "select" => select::part(context),
        "simulate" => simulate::part(context),
        "study" if context.saved.json["options"]["measured"] == true => {
            study_measured::part(context)
        }
        "study" => study::part(context),
        "validate" => validate::part(context),
        "zones" => zones::part(context),
        other => {
            let message = format!("There is no page for the results of `{other}`.");
            Err(Error::new(Code::Unsupported, message)
                .file(&context.saved.name)
                .hint(format!("there are pages for {}", COMMANDS.join(", "))))
        }
    }
}
