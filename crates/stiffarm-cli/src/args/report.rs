//! Pages of results.

use clap::Args;

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
    /// Saved results: what commands wrote with --output, or printed with --json
    #[arg(required = true, value_name = "RESULT.json")]
    pub results: Vec<String>,
    /// Cell file that a result was made with; it is known by its hash, so several may be given. Built-in
    /// cells are found without
    #[arg(long, value_name = "CELL.toml")]
    pub cell: Vec<String>,
    /// File for the page
    #[arg(long, value_name = "FILE.html", default_value = "report.html")]
    pub output: String,
    /// Overwrite existing files
    #[arg(long)]
    pub force: bool,
}
