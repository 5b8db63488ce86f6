//! Colours of series.
//!
//! The colour follows from the label, so that a label looks the same in every
//! figure; where two labels of a figure would share one, the later takes the
//! next that is free. Labels with a fixed place and numbered ones keep theirs.

use crate::figure::{Figure, Style};

/// The Okabe–Ito colours without yellow, which is too faint on white.
pub(super) const PALETTE: [&str; 7] = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000"];

/// Place of black.
const BLACK: usize = 6;

/// Labels with a fixed place in the palette, without trailing parentheses.
const KNOWN: [(&str, usize); 11] = [
    ("Group 1", 0),
    ("Group 2", 1),
    ("Group 3", 2),
    ("scaled", 3),
    ("expected error", 6),
    ("measured", 6),
    ("true", 6),
    ("predicted", 4),
    ("nominal", 5),
    ("without compensation", 1),
    ("left after compensation", 0),
];

/// The colour of a series as `#rrggbb`.
///
/// The same label has the same colour in every figure. What follows the first
/// comma is a variant and shares the colour: `Group 1, theory` looks like
/// `Group 1`. The posture groups, `scaled`, `expected error` and a few other
/// labels are fixed; numbered labels such as `Joint 1`, `Joint 2` take the
/// palette in turn; the colour of any other label is a hash of its text. In a
/// figure such a label takes the next free colour where another has its own;
/// so do bars that would be black.
pub fn series_colour(label: &str) -> &'static str {
    PALETTE[fixed(label).unwrap_or_else(|| hashed(label))]
}

/// What of a label decides its colour.
fn name(label: &str) -> &str {
    label.split(',').next().unwrap_or(label).trim()
}

/// Place in the palette of a label that has the same one everywhere.
fn fixed(label: &str) -> Option<usize> {
    let name = name(label);
    let plain = match name.split_once(" (") {
        Some((before, _)) => before.trim_end(),
        None => name,
    };
    if let Some((_, i)) = KNOWN.iter().find(|(word, _)| word.eq_ignore_ascii_case(plain)) {
        return Some(*i);
    }
    let stem = plain.trim_end_matches(|c: char| c.is_ascii_digit());
    if let (false, Ok(number)) = (stem.is_empty(), plain[stem.len()..].parse::<usize>()) {
        return Some(number.saturating_sub(1) % PALETTE.len());
    }
    None
}

/// Place in the palette of any other label, where nothing stands against it.
fn hashed(label: &str) -> usize {
    // FNV-1a: the hasher of the standard library may change between releases.
    let hash = name(label)
        .bytes()
        .fold(0xcbf2_9ce4_8422_2325_u64, |h, b| (h ^ u64::from(b)).wrapping_mul(0x0000_0100_0000_01b3));
    (hash % PALETTE.len() as u64) as usize
}

/// Places in the palette of the names in one figure.
pub(super) struct Places {
    names: Vec<(String, usize)>,
    /// The only bars, where their colour is not fixed.
    plain: Option<String>,
}

impl Places {
    pub(super) fn of(figure: &Figure) -> Self {
        let all = figure.panels.iter().flat_map(|p| &p.series);
        let coloured = all.filter(|s| !s.label.is_empty() && has_colour(s.style));
        // Name, whether it is that of bars, and its fixed place.
        let mut names: Vec<(&str, bool, Option<usize>)> = Vec::new();
        for series in coloured {
            let name_of_series = name(&series.label);
            let is_bar = series.style == Style::Bars;
            match names.iter_mut().find(|(n, ..)| *n == name_of_series) {
                Some((_, bar, _)) => *bar |= is_bar,
                None => names.push((name_of_series, is_bar, fixed(&series.label))),
            }
        }
        let is_only_bar = names.iter().filter(|(_, bar, _)| *bar).count() == 1;
        let mut taken: Vec<usize> = names.iter().filter_map(|(.., place)| *place).collect();
        let places = names.iter().map(|(name, bar, place)| {
            let place = place.unwrap_or_else(|| {
                let wanted = hashed(name);
                let turn = (0..PALETTE.len()).map(|i| (wanted + i) % PALETTE.len());
                // Black areas weigh more than all others: they come last.
                let (last, first): (Vec<usize>, Vec<usize>) = turn.partition(|i| *bar && *i == BLACK);
                let mut turn = first.into_iter().chain(last);
                let free = turn.find(|i| !taken.contains(i)).unwrap_or(wanted);
                taken.push(free);
                free
            });
            ((*name).to_owned(), place)
        });
        let places = places.collect();
        let mut lone = names.iter().filter(|(_, bar, place)| *bar && place.is_none());
        let lone = lone.next().filter(|_| is_only_bar);
        Self { names: places, plain: lone.map(|(name, ..)| (*name).to_owned()) }
    }

    /// Whether this is the label of the only bars: nothing must tell them from others.
    pub(super) fn is_plain(&self, label: &str) -> bool {
        self.plain.as_deref() == Some(name(label))
    }

    pub(super) fn get(&self, label: &str) -> usize {
        let name_of_series = name(label);
        let entry = self.names.iter().find(|(n, _)| n == name_of_series);
        let usual = || fixed(label).unwrap_or_else(|| hashed(label));
        entry.map_or_else(usual, |(_, place)| *place)
    }
}

/// Whether marks of a style have the colours of the palette.
fn has_colour(style: Style) -> bool {
    !matches!(style, Style::Outline | Style::Landmark | Style::Map | Style::Strokes)
}
