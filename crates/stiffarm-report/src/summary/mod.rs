//! What a saved result says: verdict, findings, tables, pictures as data. Nothing here knows where it is shown.
//!
//! One file or folder per command holds what is said of its results: verdict and tables, units and digits of numbers; a
//! finding brings its sentence and weight along. The command renders a [`Summary`] for the terminal and
//! [`crate::report`] for the page, so that both say the same. A telling is a function of the saved result and its cell,
//! which is why a page that is made later says what the terminal said.

mod arrows;
mod at_work;
mod check;
mod compensate;
mod context;
mod coverage;
mod described;
mod evaluate;
mod identify;
mod map;
mod measure;
mod number;
mod place;
mod points;
mod postures;
mod predict;
mod register;
mod route;
mod select;
mod simulate;
mod study;
mod study_measured;
mod table;
mod tables;
mod text;
mod validate;
mod worth;
mod zones;

use context::with_stopped;
pub(crate) use context::{cell_line, quoted};
pub use number::{Form, Number, Quantity};
pub(crate) use stiffarm::findings::shown;
pub use table::DataTable;
pub use text::{Piece, Text, counted};
pub use worth::index_quantity;

use crate::figure::Figure;
use crate::figure::drawing::Drawing;
use crate::scene::Scene;
use serde::de::{DeserializeOwned, IgnoredAny};
use std::cmp::Reverse;
use stiffarm::ask::compensate::Compensated;
use stiffarm::ask::coverage::CoverageOptions;
use stiffarm::ask::measure::{Judgement, MeasureOptions};
use stiffarm::ask::predict::{PredictOptions, Predicted};
use stiffarm::ask::route::{DriveOptions, Routed};
use stiffarm::ask::validate::{Options as ValidateOptions, Validated};
use stiffarm::ask::zones::ZonesResultOptions;
use stiffarm::estimate::coverage::Coverage;
use stiffarm::findings::{Finding, Severity};
use stiffarm::measure::registration::RegistrationRecord;
use stiffarm::model::cell::Cell;
use stiffarm::plan::check::CellCheck;
use stiffarm::plan::evaluated::{Evaluated, EvaluatedOptions};
use stiffarm::plan::zones::Zones;
use stiffarm::{Code, Error, Result};
use stiffarm_files::result::SavedResult;

/// Cautions that are seen without asking for details.
pub const SEEN_AT_ONCE: usize = 4;

/// A result that can be told, with the options `O` that it was made with.
pub trait Summarise<O> {
    /// What it says.
    ///
    /// # Errors
    /// A cell that cannot take its postures.
    fn summary(&self, options: &O, context: &Context<'_>) -> Result<Summary>;
}

impl<O, R: Summarise<O>> Summarise<O> for &R {
    fn summary(&self, options: &O, context: &Context<'_>) -> Result<Summary> {
        (**self).summary(options, context)
    }
}

/// What a telling has beside the result and its options.
#[derive(Debug, Clone, Copy)]
pub struct Context<'a> {
    /// The command that made the result.
    pub command: &'a str,
    /// The name of its file.
    pub name: &'a str,
    /// The cell it was made with, where that is at hand.
    pub cell: Option<&'a Cell>,
    /// Whether there are figures and the cell is drawn: a terminal shows none of it.
    pub pictures: bool,
}

/// A saved result with its cell, where that is at hand.
#[derive(Debug, Clone, Copy)]
pub struct WithCell<'a> {
    /// The result.
    pub saved: &'a SavedResult,
    /// The cell it was made with.
    pub cell: Option<&'a Cell>,
    /// Whether there are figures and the cell is drawn: a terminal shows none of it.
    pub pictures: bool,
}

/// The telling of each command's results.
const SUMMARISERS: &[(&str, Summariser)] = &[
    ("check", of_saved::<CellCheck, IgnoredAny>),
    ("compensate", of_saved::<Compensated, IgnoredAny>),
    ("coverage", of_saved::<Coverage, CoverageOptions>),
    ("evaluate", of_saved::<Evaluated, EvaluatedOptions>),
    ("identify", identify::summary),
    ("map", map::summary),
    ("measure", of_saved::<Judgement, MeasureOptions>),
    ("predict", of_saved::<Predicted, PredictOptions>),
    ("register", of_saved::<RegistrationRecord, IgnoredAny>),
    ("route", of_saved::<Routed, DriveOptions>),
    ("select", select::summary),
    ("simulate", simulate::summary),
    ("study", study::summary),
    ("validate", of_saved::<Validated, ValidateOptions>),
    ("zones", of_saved::<Zones, ZonesResultOptions>),
];

/// Tells a saved result.
type Summariser = fn(&WithCell<'_>) -> Result<Summary>;

/// Tells a saved result of these types.
fn of_saved<R: Summarise<O> + DeserializeOwned, O: DeserializeOwned>(with: &WithCell<'_>) -> Result<Summary> {
    let context =
        Context { command: &with.saved.command, name: &with.saved.name, cell: with.cell, pictures: with.pictures };
    let saved = with.saved;
    saved.result::<R>()?.summary(&saved.options()?, &context)
}

/// What a result says.
#[derive(Debug, Clone, PartialEq)]
pub struct Summary {
    /// What it is, as a heading.
    pub heading: String,
    /// How it came out.
    pub outcome: Outcome,
    /// What was done, what came out, what to do next. One sentence or two each.
    pub verdict: [Text; 3],
    /// What to know before relying on the numbers, the gravest first.
    pub findings: Vec<Finding>,
    /// The table to read first.
    pub key: Option<DataTable>,
    /// Further tables, figures and sentences.
    pub sections: Vec<Section>,
}

/// What a result says.
///
/// # Errors
/// A result of a command that is not told here, or one that another version wrote and that looks different.
pub fn summarise(with: &WithCell<'_>) -> Result<Summary> {
    let command = with.saved.command.as_str();
    let Some((_, teller)) = SUMMARISERS.iter().find(|(name, _)| *name == command) else {
        let names: Vec<&str> = SUMMARISERS.iter().map(|(name, _)| *name).collect();
        let message = format!("Results of `{command}` are not told.");
        return Err(Error::new(Code::Unsupported, message)
            .file(&with.saved.name)
            .hint(format!("those of {} are", names.join(", "))));
    };
    teller(with)
}

impl<'a> WithCell<'a> {
    /// A result with its cell, pictures included.
    pub fn new(saved: &'a SavedResult, cell: Option<&'a Cell>) -> Self {
        WithCell { saved, cell, pictures: true }
    }

    /// The same without pictures.
    #[must_use]
    pub fn without_pictures(self) -> Self {
        WithCell { pictures: false, ..self }
    }
}

/// Whether something is said at once or when it is asked for. A page shows both.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Depth {
    /// In the summary.
    Summary,
    /// Among the details.
    Details,
}

/// How a result came out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Outcome {
    /// Nothing to worry about.
    Good,
    /// There is something to look at.
    Caution,
    /// It cannot be used as it is.
    Serious,
}

/// A heading and what stands under it.
#[derive(Debug, Clone, PartialEq)]
pub struct Section {
    /// Anchor of the section, unique within a part.
    pub id: String,
    /// The heading.
    pub title: String,
    /// Whether it is part of the summary.
    pub depth: Depth,
    /// What stands under it.
    pub blocks: Vec<Block>,
}

/// A piece of a section.
#[derive(Debug, Clone, PartialEq)]
pub enum Block {
    /// A paragraph.
    Text(Text),
    /// A list of points.
    List(Vec<Text>),
    /// Lines to copy into a file.
    Lines(Vec<Text>),
    /// A table.
    Table(DataTable),
    /// A chart with its caption and its data.
    Figure(Figure),
    /// Charts side by side.
    Figures(Vec<Figure>),
    /// A drawing with its caption.
    Drawing(Drawing),
    /// The cell in 3D; the drawing stands in where it cannot be shown, and in print.
    Scene(Box<Scene>, Option<Drawing>),
    /// Sentences with their weight.
    Findings(Vec<Finding>),
    /// What is folded away until it is asked for.
    Details(String, Vec<Block>),
}

impl Section {
    /// A section of the details with these blocks.
    pub fn new(id: &str, title: impl Into<String>, blocks: Vec<Block>) -> Self {
        Section { id: id.to_string(), title: title.into(), depth: Depth::Details, blocks }
    }

    /// The same as a part of the summary.
    #[must_use]
    pub fn in_summary(mut self) -> Self {
        self.depth = Depth::Summary;
        self
    }
}

impl Outcome {
    /// What findings make of it.
    pub fn of(findings: &[Finding]) -> Self {
        match findings.iter().map(|finding| finding.severity).max() {
            Some(Severity::Serious) => Outcome::Serious,
            Some(Severity::Caution) => Outcome::Caution,
            _ => Outcome::Good,
        }
    }
}

impl Summary {
    /// Adds what else to know: the gravest first, and the outcome never better than it was.
    pub(crate) fn add_findings(&mut self, findings: impl IntoIterator<Item = Finding>) {
        self.findings.extend(findings);
        self.findings.sort_by_key(|finding| Reverse(finding.severity));
        self.outcome = self.outcome.max(Outcome::of(&self.findings));
    }

    /// The same with one more thing to look at, where there is one.
    pub(crate) fn caution(mut self, command: &str, sentence: Option<&str>) -> Self {
        let finding = sentence.map(|s| Finding::caution("page", command, s));
        self.add_findings(finding);
        self
    }
}
