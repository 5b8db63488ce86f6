//! What `select` says, a file for each way to work.

mod candidates;
mod curve;
mod details;
mod drop;
mod plan;
mod space_filling;
mod story;

use crate::tell::{Given, Told, of_saved};
use stiffarm::ask::select::{Chosen, Curve, DropResult, Plan, SpaceFillingPlan};
use stiffarm::{Code, Error, Result};

/// What a result says of `select`.
pub(super) fn told(context: &Given<'_>) -> Result<Told> {
    match context.saved.text("/options/mode") {
        Some("global" | "from" | "add") => of_saved::<Plan>(context),
        Some("drop") => of_saved::<DropResult>(context),
        Some("curve") => of_saved::<Curve>(context),
        Some("space_filling") => of_saved::<SpaceFillingPlan>(context),
        Some("candidates") => of_saved::<Chosen>(context),
        _ => {
            let message = "This result of `select` does not say how it was made.";
            Err(Error::new(Code::ResultFile, message)
                .file(&context.saved.name)
                .key("options.mode"))
        }
    }
}
