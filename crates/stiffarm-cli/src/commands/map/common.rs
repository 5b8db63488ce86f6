//! What `map` and `map --place` share.

use crate::args::MapArgs;
use crate::files::{Target, make_folder, write_all};
use crate::input::NamedCell;
use crate::numbers::coarse_mm;
use crate::saved::Saved;
use crate::session::Session;
use crate::table::yellow;
use std::path::Path;
use stiffarm::Result;

/// From so many postures to find on, their number is said before.
pub const MANY: usize = 100_000;

/// Cell, stiffness, and whether they belong together.
pub fn head(named: &NamedCell, saved: &Saved, hash: Option<&String>) -> String {
    let mut out = named.line() + &saved.line();
    if saved.is_of_another_cell(hash) {
        out += &format!(
            "{}: the stiffness was identified with another version of this cell\n",
            yellow("note")
        );
    }
    out
}

/// Writes picture and table to the folder, where one is asked for, and says so.
pub fn write_folder(
    session: &Session,
    args: &MapArgs,
    names: [&str; 2],
    texts: impl FnOnce() -> [String; 2],
) -> Result<String> {
    let Some(folder) = &args.output_dir else {
        return Ok(String::new());
    };
    make_folder(folder)?;
    let file = |name: &str| Target::file(&Path::new(folder).join(name), args.force);
    let [picture, table] = texts();
    let targets = [(file(names[0])?, picture), (file(names[1])?, table)];
    write_all(session, &targets)?;
    Ok(format!(
        "\nwrote {} to {}\n",
        names.join(" and "),
        folder.display()
    ))
}

/// Ends of a region in millimetres.
pub fn sides(axes: [&[f64]; 3]) -> String {
    let words = ["x", "y", "z"].iter().zip(axes).map(|(name, at)| match at {
        [low, .., high] => format!("{name} {} to {} mm", coarse_mm(*low), coarse_mm(*high)),
        [only] => format!("{name} = {} mm", coarse_mm(*only)),
        [] => String::new(),
    });
    words.collect::<Vec<_>>().join(", ")
}
