//! Drawings of things in space: views of one scene side by side, as plain data.
//!
//! A [`Figure`](super::Figure) shows numbers on axes; a drawing shows where things are and what
//! they touch. Its marks are in the plane of their view, in the order in which they are
//! drawn; what lies in front comes later.

use super::Axis;
use serde::{Deserialize, Serialize};

/// Views of one scene with a key and notes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Drawing {
    /// Short stable name, used for file names and links.
    pub id: String,
    /// Heading drawn above the views.
    pub title: String,
    /// What the reader should take from the drawing: the description of the picture for assistive
    /// technology, printed by the page that embeds it.
    pub caption: String,
    /// Lines drawn below the views.
    pub notes: Vec<Note>,
    /// The views. Those with axes stand below each other, the others beside them with the key.
    pub views: Vec<View>,
    /// What the marks mean.
    pub key: Vec<KeyEntry>,
}

/// A line below the views.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Note {
    /// Its text.
    pub text: String,
    /// Drawn in the colour of cautions.
    pub caution: bool,
}

/// One view. One unit is equally long in both directions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct View {
    /// Heading of the view.
    pub title: String,
    /// Axes to the right and up; `None` in a view that has no scale.
    pub axes: Option<[Axis; 2]>,
    /// What must be seen: from and to, to the right and up.
    pub extent: [[f64; 2]; 2],
    /// What is drawn, from the back to the front.
    pub marks: Vec<Mark>,
    /// Names, written where there is room beside their places.
    pub labels: Vec<Label>,
}

/// A shape and how it is drawn.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Mark {
    /// The shape.
    pub shape: Shape,
    /// What kind of thing it is.
    pub tone: Tone,
    /// Drawn in the colour of cautions, whatever it is.
    pub caution: bool,
}

/// A shape in the plane of a view.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Shape {
    /// A convex area by its corners.
    Area(Vec<[f64; 2]>),
    /// A line through points.
    Line(Vec<[f64; 2]>),
    /// A line with a head at its second end.
    Arrow([[f64; 2]; 2]),
    /// A marker.
    Point([f64; 2]),
}

/// What kind of thing a mark is; it decides the look.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Tone {
    /// The body that all is about.
    Body,
    /// What is fixed to the body.
    Attached,
    /// Lines within the body.
    Skeleton,
    /// What stands around.
    Fixed,
    /// What everything stands on, and walls.
    Ground,
    /// Limits that are no things.
    Bound,
    /// Ropes and forces.
    Pull,
    /// Lines of sight and where they begin.
    Ray,
    /// Lines of sight that do not matter, or are hidden.
    FaintRay,
    /// Places that are looked at.
    Target,
    /// Axes of a frame.
    Triad,
    /// One of several things of a kind, by its number from 0: marker and colour of
    /// [`DISTINCT_ITEMS`] items differ from each other.
    Item(usize),
}

/// So many [items](Tone::Item) are told apart by marker and colour; those beyond are grey lines without a marker.
pub const DISTINCT_ITEMS: usize = 42;

/// A name beside its place.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Label {
    /// The place.
    pub at: [f64; 2],
    /// The name.
    pub text: String,
    /// Drawn in the colour of cautions.
    pub caution: bool,
    /// Labels of one cluster whose places nearly meet share one text; empty for none.
    pub cluster: String,
}

/// A sample mark and what it means.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct KeyEntry {
    /// The meaning.
    pub label: String,
    /// How it is sampled.
    pub sample: Sample,
    /// The kind of thing.
    pub tone: Tone,
    /// In the colour of cautions.
    pub caution: bool,
}

/// What a key shows of a kind of thing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Sample {
    /// A piece of an area.
    Area,
    /// A piece of a line.
    Line,
    /// An arrow.
    Arrow,
    /// A marker.
    Point,
    /// A line with its marker.
    LineAndPoint,
}

impl Drawing {
    /// Number of marks in the colour of cautions.
    pub fn caution_count(&self) -> usize {
        let marks = self.views.iter().flat_map(|view| &view.marks);
        marks.filter(|mark| mark.caution).count()
    }
}

impl Note {
    /// A plain line.
    pub fn plain(text: impl Into<String>) -> Self {
        Note { text: text.into(), caution: false }
    }

    /// A line in the colour of cautions.
    pub fn caution(text: impl Into<String>) -> Self {
        Note { text: text.into(), caution: true }
    }
}

impl Mark {
    /// A mark without caution.
    pub fn new(shape: Shape, tone: Tone) -> Self {
        Mark { shape, tone, caution: false }
    }

    /// The same mark, in the colour of cautions if `yes`.
    #[must_use]
    pub fn with_caution(mut self, yes: bool) -> Self {
        self.caution = yes;
        self
    }
}
