//! What `select` says, a file for each way to work.

mod candidates;
mod curve;
mod details;
mod drop;
mod plan;
mod space_filling;
mod story;

use crate::tell::Given;
use crate::tell::Told;
use stiffarm::{Code, Error, Result};

/// What a result says of `select`.
pub(super) fn told(context: &Given<'_>) -> Result<Told> {
    match context.saved.text("/options/mode") {
        Some("global" | "from" | "add") => plan::told(context),
        Some("drop") => drop::told(context),
        Some("curve") => curve::told(context),
        Some("space_filling") => space_filling::told(context),
        Some("candidates") => candidates::told(context),
        _ => {
            let message = "This result of `select` does not say how it was made.";
            Err(Error::new(Code::ResultFile, message)
                .file(&context.saved.name)
                .key("options.mode"))
        }
    }
}
