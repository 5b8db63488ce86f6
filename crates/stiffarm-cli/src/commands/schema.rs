//! `stiffarm schema`: JSON Schemas, as `cargo xtask generate` has made them of the types.

use crate::args::{SCHEMAS, SchemaArgs};
use crate::output::Exit;
use crate::session::Session;
use stiffarm::Result;

/// Prints one schema.
pub fn run(session: &Session, args: &SchemaArgs) -> Result<Exit> {
    let found = SCHEMAS.iter().find(|(name, ..)| *name == args.what);
    session.print_exact(found.map_or("", |(.., text)| text))?;
    Ok(Exit::Done)
}
