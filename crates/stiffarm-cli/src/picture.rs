//! What pictures are written as.

use std::path::Path;
use stiffarm::{Code, Error, Result};

/// How to come by a picture in another format than SVG.
pub const INSTEAD: &str = "convert the SVG with another program, print the page of the result from a browser, or draw \
                           it with stiffarm.plot in Python";

/// Whether pictures in this format are made by other programs only.
pub fn is_foreign(format: &str) -> bool {
    let foreign = ["pdf", "png"];
    foreign.iter().any(|name| format.eq_ignore_ascii_case(name))
}

/// Refuses a picture whose name promises another format than SVG.
///
/// # Errors
/// A name that ends in .pdf or .png.
pub fn check_picture_name(path: &str) -> Result<()> {
    let ending = Path::new(path).extension();
    if ending.is_some_and(|ending| is_foreign(&ending.to_string_lossy())) {
        Err(Error::new(Code::Usage, "A picture is written as SVG, not as PDF or PNG.")
            .key("--figure")
            .hint(format!("name it .svg; then {INSTEAD}")))
    } else {
        Ok(())
    }
}
