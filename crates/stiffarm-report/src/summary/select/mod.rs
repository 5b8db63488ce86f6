//! What `select` says, a file for each way to work.

mod candidates;
mod curve;
mod details;
mod drop;
mod plan;
mod space_filling;
mod story;

use crate::summary::{Summary, WithCell, of_saved};
use serde::Deserialize;
use serde::de::IgnoredAny;
use stiffarm::ask::select::{Chosen, Curve, DropResult, Mode, Plan, SelectResultOptions, SpaceFillingPlan};
use stiffarm::{Code, Error, Result};

/// What a result says of `select`.
pub(super) fn summary(with: &WithCell<'_>) -> Result<Summary> {
    match Mode::deserialize(&with.saved.json["options"]["mode"]) {
        Ok(Mode::Global | Mode::From | Mode::Add) => of_saved::<Plan, SelectResultOptions>(with),
        Ok(Mode::Drop) => of_saved::<DropResult, IgnoredAny>(with),
        Ok(Mode::Curve) => of_saved::<Curve, IgnoredAny>(with),
        Ok(Mode::SpaceFilling) => of_saved::<SpaceFillingPlan, SelectResultOptions>(with),
        Ok(Mode::Candidates) => of_saved::<Chosen, SelectResultOptions>(with),
        Err(_) => {
            let message = "This result of `select` does not say how it was made.";
            Err(Error::new(Code::ResultFile, message).file(&with.saved.name).key("options.mode"))
        }
    }
}
