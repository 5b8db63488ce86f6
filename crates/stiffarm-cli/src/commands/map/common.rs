//! What `map` and `map --place` share.

use crate::args::MapArgs;
use crate::commands::{finding_line, serious_first};
use crate::files;
use crate::input::Line;
use crate::numbers::coarse_mm;
use crate::session::Session;
use crate::table::yellow;
use stiffarm::Result;
use stiffarm::estimate::saved::Saved;
use stiffarm::files::source::NamedCell;
use stiffarm::findings::Finding;

/// From so many postures to find on, their number is said before.
pub const MANY: usize = 100_000;

/// What is serious; then cell, stiffness, and whether they belong together.
pub fn head(
    findings: &[Finding],
    named: &NamedCell,
    saved: &Saved,
    hash: Option<&String>,
) -> String {
    let mut out = serious_first(findings.iter(), finding_line) + &named.line() + &saved.line();
    if saved.is_of_another_cell(hash.map(String::as_str)) {
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
    let files = names.map(String::from).into_iter().zip(texts()).collect();
    files::write_folder(session, folder, files, args.force)?;
    if session.has_failed() {
        return Ok(String::new());
    }
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
