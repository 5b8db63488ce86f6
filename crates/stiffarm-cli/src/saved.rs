//! What results say that are at hand as JSON, for a program around the command.

use crate::page::page_of_saved;
use crate::screen::plain;
use crate::text;
use stiffarm::Result;
use stiffarm::model::cell::Cell;
use stiffarm::model::posture::Posture;
use stiffarm_files::envelope::to_json;
use stiffarm_files::result::read_result;
use stiffarm_report::page::{pictures, render_summary};
use stiffarm_report::report::report;
use stiffarm_report::summary::{WithCell, summarise};
use stiffarm_report::{Full, cell_drawing, shown_drawing, shown_figure, usual_posture};

/// How much of a result is told.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SummaryForm {
    /// What came out, what is serious, every caution: a few lines.
    Verdict,
    /// What the command prints.
    Summary,
    /// What the command prints with `--details`.
    Details,
    /// Verdict, cautions and the table to read first as HTML, for a notebook.
    Html,
}

/// What a result says: a result as `--json` prints it, and its cell where that is at hand.
///
/// # Errors
/// A text that holds no result, or one that is not told.
pub fn summary(json: &str, cell: Option<&Cell>, how: SummaryForm) -> Result<String> {
    let saved = read_result(json.as_bytes(), "result")?;
    let summary = summarise(&WithCell::new(&saved, cell).without_pictures())?;
    Ok(match how {
        SummaryForm::Verdict => plain(&text::verdict(&summary)),
        SummaryForm::Summary => plain(&text::summary(&summary, false)),
        SummaryForm::Details => plain(&text::summary(&summary, true)),
        SummaryForm::Html => render_summary(&summary),
    })
}

/// The page of a result as `--json` prints it, with its cell where that is at hand.
///
/// # Errors
/// As [`summary`].
pub fn page(json: &str, cell: Option<&Cell>) -> Result<String> {
    page_of_saved(&read_result(json.as_bytes(), "result")?, cell)
}

/// The figures of the [`page`] as JSON, in its order: data, and what the page decides of how they look.
///
/// # Errors
/// As [`summary`].
pub fn figures(json: &str, cell: Option<&Cell>) -> Result<String> {
    let saved = read_result(json.as_bytes(), "result")?;
    let (figures, _) = pictures(&report(&[WithCell::new(&saved, cell)])?);
    to_json(&figures.iter().map(shown_figure).collect::<Vec<_>>())
}

/// The drawing of a cell at these postures as JSON, one of them in full.
///
/// # Errors
/// Angles that do not fit the robot.
pub fn drawing(cell: &Cell, postures: &[Posture], full: usize) -> Result<String> {
    let drawing = match postures {
        [] => cell_drawing(cell, &[usual_posture(cell)?], Full::Number(0)),
        _ => cell_drawing(cell, postures, Full::Number(full)),
    };
    to_json(&shown_drawing(&drawing?))
}
