//! One HTML page that holds everything it shows: text, tables, charts, the cell in 3D.
//!
//! A [`Page`] is plain data made of [`Part`]s, one for each saved result. Every number on it that stands in the
//! result says where ([`Number`]), so that a test can hold the page against the file. The page asks the network for
//! nothing, and its policy forbids it.

mod chart;
mod html;
mod number;
mod pictures;

pub use html::render_page;
pub use number::{Form, Number};
pub use pictures::pictures;

use crate::figure::Figure;
use crate::figure::drawing::Drawing;
use crate::scene::Scene;
use stiffarm::findings::{Finding, Severity};

/// A page.
#[derive(Debug, Clone, PartialEq)]
pub struct Page {
    /// Title of the window and first heading.
    pub title: String,
    /// What stands under the title: cell, robot.
    pub subtitle: String,
    /// What a page of several results says before them.
    pub comparison: Option<Comparison>,
    /// One part for each result, in the order of the files.
    pub parts: Vec<Part>,
}

/// Several results beside each other.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// The gravest of how the results came out.
    pub outcome: Outcome,
    /// The story: what is compared, how far it differs, what to do next.
    pub verdict: [Text; 3],
    /// Tables and pictures side by side.
    pub sections: Vec<Section>,
}

/// What one saved result has to say.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// The command that made it.
    pub command: String,
    /// Heading of the part.
    pub heading: String,
    /// What to call it beside others, for example the file's name.
    pub name: String,
    /// How it came out.
    pub outcome: Outcome,
    /// The story: what was done, what came out, what to do next. One sentence or two each.
    pub verdict: [Text; 3],
    /// What to know before relying on the numbers.
    pub warnings: Vec<Finding>,
    /// The table to read first.
    pub key: Option<DataTable>,
    /// Pictures and details.
    pub sections: Vec<Section>,
    /// How the result was made.
    pub provenance: Provenance,
}

impl Part {
    /// Adds what else to know: the gravest first, and never better than it was.
    pub fn add_warnings(&mut self, found: impl IntoIterator<Item = Finding>) {
        for finding in found {
            self.outcome = self
                .outcome
                .max(Outcome::of(std::slice::from_ref(&finding)));
            self.warnings.push(finding);
        }
        self.warnings
            .sort_by_key(|finding| std::cmp::Reverse(finding.severity));
    }
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

/// A sentence or two in which numbers keep what they are.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Text(pub Vec<Piece>);

/// A piece of a text.
#[derive(Debug, Clone, PartialEq)]
pub enum Piece {
    /// Words.
    Words(String),
    /// Words that matter most.
    Strong(String),
    /// What one types, or a name from a file.
    Code(String),
    /// Words that lead to an anchor of the page.
    Link(String, String),
    /// Words that say how something differs from what stands beside it.
    Different(String),
    /// A number with its unit.
    Number(Number),
}

/// A table of texts and numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct DataTable {
    /// What it shows.
    pub caption: String,
    /// Headings, units included.
    pub headings: Vec<String>,
    /// Rows, one cell per heading; the first cell names the row.
    pub rows: Vec<Vec<Text>>,
}

/// How a result was made.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Provenance {
    /// Version of the program.
    pub version: String,
    /// Seed of the random numbers, where there are any.
    pub seed: Option<u64>,
    /// The command line that makes the result again, or the call in Python.
    pub command_line: String,
    /// Inputs by role with their SHA-256.
    pub inputs: Vec<(String, String)>,
    /// Options by name with their value.
    pub options: Vec<(String, String)>,
}

impl Text {
    /// A text to begin with.
    pub fn new(words: impl Into<String>) -> Self {
        Text(vec![Piece::Words(words.into())])
    }

    /// With more words.
    #[must_use]
    pub fn words(mut self, words: impl Into<String>) -> Self {
        self.0.push(Piece::Words(words.into()));
        self
    }

    /// With words that matter most.
    #[must_use]
    pub fn strong(mut self, words: impl Into<String>) -> Self {
        self.0.push(Piece::Strong(words.into()));
        self
    }

    /// With another text behind it.
    #[must_use]
    pub fn then(mut self, text: Text) -> Self {
        self.0.extend(text.0);
        self
    }

    /// With something that one types.
    #[must_use]
    pub fn code(mut self, words: impl Into<String>) -> Self {
        self.0.push(Piece::Code(words.into()));
        self
    }

    /// With words that lead to an anchor of the page.
    #[must_use]
    pub fn link(mut self, words: impl Into<String>, anchor: impl Into<String>) -> Self {
        self.0.push(Piece::Link(words.into(), anchor.into()));
        self
    }

    /// With a number.
    #[must_use]
    pub fn number(mut self, number: Number) -> Self {
        self.0.push(Piece::Number(number));
        self
    }

    /// As one line of plain text.
    pub fn plain(&self) -> String {
        let pieces = self.0.iter().map(|piece| match piece {
            Piece::Words(words)
            | Piece::Strong(words)
            | Piece::Code(words)
            | Piece::Link(words, _)
            | Piece::Different(words) => words.clone(),
            Piece::Number(number) => number.text(),
        });
        pieces.collect()
    }
}

impl From<&str> for Text {
    fn from(words: &str) -> Self {
        Text::new(words)
    }
}

impl From<String> for Text {
    fn from(words: String) -> Self {
        Text::new(words)
    }
}

impl From<Number> for Text {
    fn from(number: Number) -> Self {
        Text(vec![Piece::Number(number)])
    }
}

impl DataTable {
    /// A table without rows.
    pub fn new<S: Into<String>>(
        caption: impl Into<String>,
        headings: impl IntoIterator<Item = S>,
    ) -> Self {
        DataTable {
            caption: caption.into(),
            headings: headings.into_iter().map(Into::into).collect(),
            rows: Vec::new(),
        }
    }

    /// Adds a row by its name and its cells.
    pub fn row(&mut self, name: impl Into<Text>, cells: impl IntoIterator<Item = Text>) {
        let row = std::iter::once(name.into()).chain(cells);
        self.rows.push(row.collect());
    }
}

impl Section {
    /// A section with these blocks.
    pub fn new(id: &str, title: impl Into<String>, blocks: Vec<Block>) -> Self {
        Section {
            id: id.to_string(),
            title: title.into(),
            blocks,
        }
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
