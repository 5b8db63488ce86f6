//! `stiffarm schema`: JSON Schemas, as `cargo xtask generate` has made them of the types.

use crate::answer::Answer;
use crate::args::{SCHEMAS, SchemaArgs};
use stiffarm::Result;

/// Prints one schema.
pub fn run(args: &SchemaArgs) -> Result<Answer> {
    let schema = SCHEMAS.iter().find(|(name, ..)| *name == args.what);
    Ok(Answer::text(schema.map_or("", |(.., text)| text)))
}
