//! Several straight moves for one move of a program: an arc, a cycle, or a long move whose correction bends.

use super::targets::SAME_POSITION;
use super::{Orientation, ToolPath};
use crate::program::fixed;
use nalgebra::Vector3;
use stiffarm::model::path::PathPoint;

/// An arc or a long move as it stands in a program, and the straight moves that may stand for it.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Divided {
    /// Its points; the last one is its end.
    pub points: std::ops::Range<usize>,
    /// Whether all its points are written, as those of an arc or a cycle; a straight move is divided only
    /// where its correction bends.
    pub is_whole: bool,
    /// The bytes that straight moves take the place of; none where the program can have no more points.
    pub text: std::ops::Range<usize>,
    /// What begins the first of those moves, and all others.
    pub first: String,
    pub others: &'static str,
    /// What begins each of them, at feed and rapid.
    pub begin: String,
    pub begin_rapid: &'static str,
    /// What ends the first of them, and the last.
    pub end: String,
    pub last: String,
    /// Points behind which the program waits, and how it says so.
    pub waits: Vec<usize>,
    pub wait: String,
    /// The inverse of the whole move's time, where this is its feed: each of those moves has its own.
    pub inverse: Option<f64>,
}

/// A straight move that stands with others for one.
pub(super) struct Piece {
    /// The point that it ends at.
    point: usize,
    /// The numbers of that point.
    numbers: [f64; 10],
    /// In units of the program.
    length: f64,
}

/// The straight moves through the `corners` of a `way` that begins at the point before.
pub(super) fn pieces(division: &Divided, way: &[[f64; 10]], corners: &[usize]) -> Vec<Piece> {
    let place = |k: usize| Vector3::from_column_slice(&way[k][..3]);
    let from = std::iter::once(0).chain(corners.iter().copied());
    let pairs = from.zip(corners);
    let piece = |(from, to): (usize, &usize)| Piece {
        point: division.points.start + to - 1,
        numbers: way[*to],
        length: (place(*to) - place(from)).norm(),
    };
    pairs.map(piece).collect()
}

impl ToolPath {
    /// Straight moves in place of one.
    pub(super) fn lines(&self, division: &Divided, pieces: &[Piece], nominal: &[PathPoint]) -> String {
        let form = &self.form;
        let line_end = if self.files[0].text.contains("\r\n") { "\r\n" } else { "\n" };
        let count = if form.orientation == Orientation::Kept { 3 } else { form.before.len() };
        let way: f64 = pieces.iter().map(|piece| piece.length).sum();
        let mut lines = Vec::with_capacity(pieces.len());
        for (k, piece) in pieces.iter().enumerate() {
            let words = form.before.iter().take(count).enumerate();
            let words = words.map(|(component, before)| {
                let value = piece.numbers[component];
                format!("{before}{}", fixed(value, form.decimals_of(component)))
            });
            let mut words: String = words.collect();
            if division.begin.ends_with('/') {
                words = words.trim_start_matches(',').to_string();
            }
            if let Some(inverse) = division.inverse {
                words += &format!(" F{}", fixed(inverse * way / piece.length.max(SAME_POSITION), 4));
            }
            let (first, end) = match k {
                0 => (division.first.as_str(), division.end.as_str()),
                _ => (division.others, ""),
            };
            let last = if k + 1 == pieces.len() { &division.last } else { "" };
            let begin = if nominal[piece.point].rapid { division.begin_rapid } else { &division.begin };
            lines.push(format!("{first}{begin}{words}{end}{last}"));
            if division.waits.contains(&piece.point) {
                lines.push(format!("{}{}", division.others, division.wait));
            }
        }
        lines.join(line_end)
    }
}
