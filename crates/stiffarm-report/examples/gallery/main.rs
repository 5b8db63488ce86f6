//! Writes one picture of every kind of figure.
//!
//! ```text
//! cargo run -p stiffarm-report --example gallery -- target/gallery
//! ```
//!
//! The numbers are made up; they only have the shape of real results.

mod figures;

use std::{env, fs, io, path::PathBuf};
use stiffarm_report::{Layout, render_svg, render_svg_with};

fn main() -> io::Result<()> {
    let folder = env::args_os()
        .nth(1)
        .map_or_else(|| PathBuf::from("target/gallery"), PathBuf::from);
    fs::create_dir_all(&folder)?;
    for figure in figures::all() {
        fs::write(
            folder.join(format!("{}.svg", figure.id)),
            render_svg(&figure),
        )?;
        for (name, layout) in [
            ("88mm", Layout::paper(88.0, 8.0)),
            ("180mm", Layout::paper(180.0, 8.0)),
            ("phone", Layout::screen(360.0, 11.0)),
        ] {
            let file = folder.join(format!("{}-{name}.svg", figure.id));
            fs::write(file, render_svg_with(&figure, &layout))?;
        }
    }
    Ok(())
}
