//! The key of a drawing.

use super::ink;
use super::view::head;
use crate::figure::drawing::{KeyEntry, Sample, Tone};
use crate::figure::svg::canvas::{Anchor, Canvas, Font, Point};
use crate::figure::svg::text;

/// Font size of the key.
const SIZE: f64 = 11.5;
/// Width of a sample.
const SAMPLE: f64 = 24.0;
/// Distance between sample and text.
const GAP: f64 = 6.0;
/// Height of one row.
const ROW: f64 = 17.0;

/// The entries and where they go: things, and below them numbered items.
pub(super) struct Key<'a> {
    blocks: [Block<'a>; 2],
}

/// Entries in columns of one width.
struct Block<'a> {
    entries: Vec<&'a KeyEntry>,
    columns: usize,
    width: f64,
}

impl<'a> Key<'a> {
    /// As many columns as fit into `width`.
    pub(super) fn of(entries: &'a [KeyEntry], width: f64) -> Self {
        let (items, things) = entries.iter().partition(|entry| matches!(entry.tone, Tone::Item(_)));
        Key { blocks: [Block::of(things, width), Block::of(items, width)] }
    }

    pub(super) fn height(&self) -> f64 {
        self.blocks.iter().map(Block::height).sum()
    }

    /// Draws the key with its upper left corner at `at`.
    pub(super) fn draw(&self, canvas: &mut Canvas, at: Point) {
        let mut top = at.1;
        for block in &self.blocks {
            block.draw(canvas, (at.0, top));
            top += block.height();
        }
    }
}

impl<'a> Block<'a> {
    fn of(entries: Vec<&'a KeyEntry>, width: f64) -> Self {
        let widest =
            entries.iter().map(|entry| SAMPLE + GAP + text::width(&entry.label, SIZE) + 10.0).fold(60.0, f64::max);
        let columns = ((width / widest) as usize).clamp(1, 4);
        Block { entries, columns, width: width / columns as f64 }
    }

    fn rows(&self) -> usize {
        self.entries.len().div_ceil(self.columns)
    }

    fn height(&self) -> f64 {
        self.rows() as f64 * ROW
    }

    fn draw(&self, canvas: &mut Canvas, at: Point) {
        let rows = self.rows().max(1);
        for (i, entry) in self.entries.iter().enumerate() {
            let left = at.0 + (i / rows) as f64 * self.width;
            let middle = at.1 + ((i % rows) as f64 + 0.5) * ROW;
            sample(canvas, entry, (left, middle));
            let limit = self.width - SAMPLE - GAP;
            let shown = text::shorten(&entry.label, SIZE, limit);
            let from = (left + SAMPLE + GAP, middle + 0.36 * SIZE);
            canvas.text(from, &shown, None, Font::new(SIZE, Anchor::Start));
        }
    }
}

fn sample(canvas: &mut Canvas, entry: &KeyEntry, left: Point) {
    let stroke = ink::stroke(entry.tone, entry.caution);
    let right = (left.0 + SAMPLE, left.1);
    let middle = (left.0 + 0.5 * SAMPLE, left.1);
    match entry.sample {
        Sample::Area => {
            let fill = ink::fill(entry.tone, entry.caution);
            let corners = [
                (left.0 + 2.0, left.1 - 5.5),
                (right.0 - 2.0, left.1 - 5.5),
                (right.0 - 2.0, left.1 + 5.5),
                (left.0 + 2.0, left.1 + 5.5),
            ];
            canvas.glass(&corners, fill.colour, fill.opacity, fill.edge);
        }
        Sample::Line => canvas.line(left, right, stroke),
        Sample::Arrow => {
            canvas.line(left, right, stroke);
            head(canvas, left, right, stroke);
        }
        Sample::Point => ink::marker(canvas, middle, entry.tone, entry.caution),
        Sample::LineAndPoint => {
            canvas.line(left, right, stroke);
            ink::marker(canvas, middle, entry.tone, entry.caution);
        }
    }
}
