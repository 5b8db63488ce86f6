//! How large a picture is and what its text looks like.

use serde::{Deserialize, Serialize};

/// Size and typeface of a picture for a paper or for a small screen.
///
/// Everything is drawn at one scale, chosen so that the smallest text (names in
/// drawings, notes) has the stated size; tick labels and the legend are 9 %
/// larger, axis labels 18 %. Raised exponents are smaller. Panels that do not
/// fit side by side go below each other. A figure whose labels need more than
/// the stated width is scaled down to it on paper; on a screen it is wider.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Layout {
    /// Width and size of the smallest text.
    pub size: Size,
    /// Font family, or empty for the usual list of sans-serif families.
    pub font_family: String,
    /// Whether the title is drawn, and the notes of a drawing; in papers they are usually in the caption.
    pub title: bool,
}

/// Width of a picture and size of its smallest text.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum Size {
    /// On paper.
    Paper {
        /// Width of the picture in mm.
        width_mm: f64,
        /// Smallest text in points of 1/72 inch.
        font_pt: f64,
    },
    /// On a screen.
    Screen {
        /// Width of the picture in CSS pixels.
        width_px: f64,
        /// Smallest text in CSS pixels.
        font_px: f64,
    },
}

/// The usual font families as a CSS list.
pub(super) const USUAL_FAMILIES: &str = "Helvetica, Arial, 'DejaVu Sans', sans-serif";
/// Least and largest width at the renderer's own scale, where the smallest text
/// is [`SMALLEST`] high. Below, labels leave no room for the data.
const WIDTHS: [f64; 2] = [220.0, 4000.0];
/// Greatest height of a drawing on paper \[mm\]: on an A4 page it leaves room for its caption.
const TALLEST_MM: f64 = 220.0;
/// Smallest text at the renderer's own scale.
const SMALLEST: f64 = 11.0;

impl Layout {
    /// A picture for a paper: no title, the usual typeface.
    pub fn paper(width_mm: f64, font_pt: f64) -> Self {
        Self { size: Size::Paper { width_mm, font_pt }, font_family: String::new(), title: false }
    }

    /// A picture for a small screen, with its title.
    pub fn screen(width_px: f64, font_px: f64) -> Self {
        Self { size: Size::Screen { width_px, font_px }, font_family: String::new(), title: true }
    }

    /// The same with a font family.
    #[must_use]
    pub fn with_font(mut self, family: impl Into<String>) -> Self {
        self.font_family = family.into();
        self
    }

    /// The same with or without the title and the notes.
    #[must_use]
    pub fn with_title(mut self, yes: bool) -> Self {
        self.title = yes;
        self
    }

    /// Width at the renderer's own scale. Sizes that are not positive numbers
    /// count as the nearest possible one.
    pub(super) fn drawn_width(&self) -> f64 {
        let (width, font) = match self.size {
            Size::Paper { width_mm, font_pt } => (width_mm / 25.4 * 72.0, font_pt),
            Size::Screen { width_px, font_px } => (width_px, font_px),
        };
        let drawn = width * SMALLEST / font;
        if drawn.is_finite() { drawn.clamp(WIDTHS[0], WIDTHS[1]) } else { WIDTHS[0] }
    }

    /// Greatest height of a drawing at the renderer's own scale; none on a screen, which is scrolled.
    pub(super) fn tallest(&self) -> Option<f64> {
        let Size::Paper { width_mm, .. } = self.size else {
            return None;
        };
        Some(self.drawn_width() * TALLEST_MM / sound(width_mm))
    }

    /// Width and height attributes of a picture that is `drawn` wide and high
    /// at the renderer's own scale.
    pub(super) fn attributes(&self, drawn: [f64; 2]) -> [String; 2] {
        match self.size {
            Size::Paper { width_mm, .. } => {
                let width = sound(width_mm);
                let height = width * drawn[1] / drawn[0];
                [width, height].map(|value| format!("{}mm", short(value)))
            }
            Size::Screen { width_px, .. } => {
                let scale = sound(width_px) / self.drawn_width();
                drawn.map(|value| short(value * scale))
            }
        }
    }

    /// The font families, the stated one first, as a CSS list. Characters that
    /// no family name has are left out.
    pub(super) fn families(&self) -> String {
        let is_of_name = |c: &char| c.is_alphanumeric() || " -_.+".contains(*c);
        let family: String = self.font_family.chars().filter(is_of_name).collect();
        match family.trim() {
            "" => USUAL_FAMILIES.to_owned(),
            family => format!("'{family}', {USUAL_FAMILIES}"),
        }
    }
}

/// A usable length, whatever was stated.
fn sound(length: f64) -> f64 {
    if length.is_finite() { length.clamp(1.0, 1e4) } else { 1.0 }
}

/// At most four decimals.
fn short(value: f64) -> String {
    let text = format!("{value:.4}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_smallest_text_has_the_stated_size() {
        let layout = Layout::paper(88.0, 8.0);
        let points_per_unit = 88.0 / 25.4 * 72.0 / layout.drawn_width();
        assert!((points_per_unit * SMALLEST - 8.0).abs() < 1e-12);
        assert_eq!(Layout::screen(360.0, 11.0).drawn_width(), 360.0);
        assert_eq!(layout.attributes([100.0, 50.0]), ["88mm", "44mm"]);
        assert_eq!(Layout::screen(360.0, 11.0).attributes([380.0, 100.0]), ["380", "100"]);
    }

    #[test]
    fn absurd_sizes_are_replaced() {
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e300, 1e-300] {
            for layout in [Layout::paper(bad, 8.0), Layout::screen(300.0, bad)] {
                let width = layout.drawn_width();
                assert!((WIDTHS[0]..=WIDTHS[1]).contains(&width));
                assert!(!layout.attributes([width, 10.0])[0].contains("NaN"));
            }
        }
    }

    #[test]
    fn a_family_cannot_leave_its_quotes() {
        let layout = Layout::paper(88.0, 8.0).with_font("A'\\\"<b>; x");
        assert!(layout.families().starts_with("'Ab x', Helvetica"));
    }
}
