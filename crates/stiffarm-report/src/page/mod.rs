//! One HTML page that holds everything it shows: text, tables, charts, the cell in 3D.
//!
//! A [`Page`] is plain data made of [`Part`]s, one for each saved result. Every number on it that stands in the
//! result says where ([`Number`]), so that a test can hold the page against the file. The page asks the network for
//! nothing, and its policy forbids it.

mod chart;
mod html;
mod pictures;
mod table;
mod words;

pub use crate::summary::{Block, DataTable, Form, Number, Outcome, Piece, Section, Text};
pub use html::{render_page, render_summary};
pub use pictures::pictures;

use stiffarm::findings::Finding;

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
