//! Pages of results.

#[cfg(feature = "report")]
use super::values::above_zero;
use clap::Args;
#[cfg(feature = "report")]
use clap::ValueEnum;
#[cfg(feature = "report")]
use std::path::PathBuf;
#[cfg(feature = "report")]
use stiffarm_report::print::{Format, PaperOptions};

/// The page of a result that a command has just made.
#[derive(Debug, Clone, Default, Args)]
pub struct PageArgs {
    /// Write the result as one offline page, with the cell in 3D
    #[cfg(feature = "report")]
    #[arg(long, value_name = "FILE.html")]
    pub report: Option<String>,
}

impl PageArgs {
    /// Where the page goes, if anywhere.
    pub fn path(&self) -> Option<&str> {
        #[cfg(feature = "report")]
        return self.report.as_deref();
        #[cfg(not(feature = "report"))]
        None
    }
}

/// Pages of saved results.
#[cfg(feature = "report")]
#[derive(Debug, Args)]
pub struct ReportArgs {
    /// Saved results: what commands printed with --json (`--json > result.json`), or identify wrote with --output
    #[arg(required = true, value_name = "RESULT.json")]
    pub results: Vec<String>,
    /// Cell file that a result was made with; it is known by its hash, so several may be given. Built-in
    /// cells are found without
    #[arg(long, value_name = "CELL.toml")]
    pub cell: Vec<String>,
    /// File for the page; report.html, or no page where --figures is given
    #[arg(long, value_name = "FILE.html")]
    pub output: Option<String>,
    /// Write the pictures for a paper to this folder, each with its data
    #[arg(long, value_name = "DIR")]
    pub figures: Option<PathBuf>,
    #[command(flatten)]
    pub paper: PaperArgs,
    /// Overwrite existing files
    #[arg(long)]
    pub force: bool,
}

/// Pictures for a paper.
#[cfg(feature = "report")]
#[derive(Debug, Args)]
#[command(next_help_heading = "Pictures for a paper")]
pub struct PaperArgs {
    /// Formats, with commas between them
    #[arg(
        long,
        value_name = "FORMAT,...",
        value_delimiter = ',',
        default_value = "svg,pdf,png,csv",
        requires = "figures"
    )]
    pub format: Vec<FormatArg>,
    /// Width of each picture, 20 to 500; one column of a journal is about 88
    #[arg(long, value_name = "MM", default_value = "88", value_parser = above_zero("mm"), requires = "figures")]
    pub width_mm: f64,
    /// Font family; DejaVu Sans comes with the program, others must be installed
    #[arg(long, value_name = "FAMILY", requires = "figures")]
    pub font: Option<String>,
    /// Size of the smallest text, 4 to 30
    #[arg(long, value_name = "PT", default_value = "8", value_parser = above_zero("pt"), requires = "figures")]
    pub font_pt: f64,
    /// Pixels per inch of PNG, 72 to 1200
    #[arg(long, value_name = "DPI", default_value = "300", value_parser = above_zero("dpi"), requires = "figures")]
    pub dpi: f64,
    /// Draw the titles, which a paper has in its captions
    #[arg(long, requires = "figures")]
    pub titles: bool,
}

#[cfg(feature = "report")]
impl PaperArgs {
    /// As the report takes them.
    pub fn options(&self) -> PaperOptions {
        PaperOptions {
            width_mm: self.width_mm,
            font_pt: self.font_pt,
            font_family: self.font.clone().unwrap_or_default(),
            dpi: self.dpi,
            titles: self.titles,
            formats: self.format.iter().map(|format| format.format()).collect(),
        }
    }
}

/// Format of a picture.
#[cfg(feature = "report")]
#[derive(Debug, Clone, Copy, ValueEnum)]
pub enum FormatArg {
    /// Vectors; the font is named only
    Svg,
    /// Vectors with their font
    Pdf,
    /// Pixels
    Png,
    /// The numbers of a chart
    Csv,
}

#[cfg(feature = "report")]
impl FormatArg {
    fn format(self) -> Format {
        match self {
            FormatArg::Svg => Format::Svg,
            FormatArg::Pdf => Format::Pdf,
            FormatArg::Png => Format::Png,
            FormatArg::Csv => Format::Csv,
        }
    }
}
