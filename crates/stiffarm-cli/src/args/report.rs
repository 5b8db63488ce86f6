//! Pages of results.

use crate::picture::{INSTEAD, is_foreign};
use clap::{Args, ValueHint};
use std::path::PathBuf;
use stiffarm::ask::values::above_zero;
use stiffarm_report::paper::{Format, PaperOptions};

/// The page of a result that a command has just made.
#[derive(Debug, Clone, Default, Args)]
pub struct Page {
    /// Write the result as one offline page, with the cell in 3D
    #[arg(value_hint = ValueHint::AnyPath, long, value_name = "FILE.html")]
    pub report: Option<String>,
}

impl Page {
    /// Where the page goes, if anywhere.
    pub fn path(&self) -> Option<&str> {
        self.report.as_deref()
    }
}

/// Pages of saved results.
#[derive(Debug, Args)]
pub struct Report {
    /// Saved results: what commands printed with --json (`--json > result.json`), or identify wrote with --output
    #[arg(value_hint = ValueHint::FilePath, required = true, value_name = "RESULT.json")]
    pub results: Vec<String>,
    /// Cell file that a result was made with; several may be given, as each result knows the hash of its cell. Built-in
    /// cells need no file
    #[arg(value_hint = ValueHint::FilePath, long, value_name = "CELL.toml")]
    pub cell: Vec<String>,
    /// File for the page [default: report.html, or no page where --figures is given]
    #[arg(value_hint = ValueHint::AnyPath, long, value_name = "FILE.html")]
    pub output: Option<String>,
    /// Write the pictures for a paper to this folder, each with its data
    #[arg(long, value_name = "DIR")]
    pub figures: Option<PathBuf>,
    #[command(flatten)]
    pub paper: Paper,
    /// Overwrite existing files
    #[arg(long)]
    pub force: bool,
}

/// Pictures for a paper.
#[derive(Debug, Args)]
#[command(next_help_heading = "Pictures for a paper")]
pub struct Paper {
    /// Formats with commas between them: svg, and csv for the numbers of charts
    #[arg(
        long,
        value_name = "FORMAT,...",
        value_delimiter = ',',
        default_value = "svg,csv",
        value_parser = format,
        requires = "figures"
    )]
    pub format: Vec<Format>,
    /// Width of each picture, 20 to 500; one column of a journal is about 88
    #[arg(long, value_name = "MM", default_value = "88", value_parser = above_zero("mm"), requires = "figures")]
    pub width_mm: f64,
    /// Font family, by its name only: the machine that shows the picture must have it
    #[arg(long, value_name = "FAMILY", requires = "figures")]
    pub font: Option<String>,
    /// Size of the smallest text, 4 to 30
    #[arg(long, value_name = "PT", default_value = "8", value_parser = above_zero("pt"), requires = "figures")]
    pub font_pt: f64,
    /// Draw titles in the pictures; a paper has them in its captions
    #[arg(long, requires = "figures")]
    pub titles: bool,
}

impl Paper {
    /// As the report takes them.
    pub fn options(&self) -> PaperOptions {
        PaperOptions {
            width_mm: self.width_mm,
            font_pt: self.font_pt,
            font_family: self.font.clone().unwrap_or_default(),
            titles: self.titles,
            formats: self.format.clone(),
        }
    }
}

/// Format of a picture.
fn format(text: &str) -> Result<Format, String> {
    let mut all = Format::ALL.into_iter();
    let format = all.find(|format| text == format.extension());
    format.ok_or_else(|| {
        if is_foreign(text) {
            format!("svg and csv are written; {INSTEAD}")
        } else {
            "svg and csv are written".to_string()
        }
    })
}
