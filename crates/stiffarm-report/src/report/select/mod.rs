//! The pages of `select`, a file for each way to work.

mod candidates;
mod curve;
mod details;
mod drop;
mod plan;
mod planned;
mod space_filling;
mod story;

use super::context::Context;
use crate::page::Part;
use stiffarm::{Code, Error, Result};

/// The part of a page for a result of `select`.
pub(super) fn part(context: &Context<'_>) -> Result<Part> {
    match context.saved.text("/options/mode") {
        Some("global" | "from" | "add") => plan::part(context),
        Some("drop") => drop::part(context),
        Some("curve") => curve::part(context),
        Some("space_filling") => space_filling::part(context),
        Some("candidates") => candidates::part(context),
        _ => {
            let message = "This result of `select` does not say how it was made.";
            Err(Error::new(Code::ResultFile, message)
                .file(&context.saved.name)
                .key("options.mode"))
        }
    }
}
