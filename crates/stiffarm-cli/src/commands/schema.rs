//! `stiffarm schema`: JSON Schemas, as `cargo xtask generate` has made them of the types.

use crate::answer::Answer;
use crate::args;
use crate::args::SCHEMAS;
use stiffarm::Result;

/// Prints one schema.
pub fn run(args: &args::Schema) -> Result<Answer> {
    let schema = SCHEMAS.iter().find(|(name, ..)| *name == args.what);
    Ok(Answer::text(schema.map_or("", |(.., text)| text)))
}
