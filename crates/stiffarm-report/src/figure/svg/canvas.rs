//! SVG elements as text, with fixed number formatting and escaping.

use std::fmt::Write;

/// A place on the picture, in pixels from the upper left corner.
pub(super) type Point = (f64, f64);

/// Colour of all text.
pub(super) const INK: &str = "#222222";

/// How a line is drawn.
#[derive(Clone, Copy)]
pub(super) struct Stroke<'a> {
    pub colour: &'a str,
    pub width: f64,
    pub dash: &'a str,
}

impl<'a> Stroke<'a> {
    pub(super) fn solid(colour: &'a str, width: f64) -> Self {
        Self { colour, width, dash: "" }
    }
}

/// Where a text is attached to its position.
#[derive(Clone, Copy)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// How a text is drawn.
#[derive(Clone, Copy)]
pub(super) struct Font {
    pub size: f64,
    pub bold: bool,
    pub anchor: Anchor,
    /// Clockwise turn about the position, in degrees.
    pub turn: f64,
}

impl Font {
    pub(super) fn new(size: f64, anchor: Anchor) -> Self {
        Self { size, bold: false, anchor, turn: 0.0 }
    }

    pub(super) fn bold(mut self) -> Self {
        self.bold = true;
        self
    }

    pub(super) fn turned(mut self, degrees: f64) -> Self {
        self.turn = degrees;
        self
    }
}

/// An axis-parallel rectangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rect {
    pub x: f64,
    pub y: f64,
    pub w: f64,
    pub h: f64,
}

impl Rect {
    /// The rectangle with these two opposite corners.
    pub(super) fn spanning(a: Point, b: Point) -> Self {
        Self { x: a.0.min(b.0), y: a.1.min(b.1), w: (a.0 - b.0).abs(), h: (a.1 - b.1).abs() }
    }

    /// Whether `p` lies inside, give or take rounding.
    pub(super) fn contains(&self, p: Point) -> bool {
        let slack = 0.01;
        p.0 >= self.x - slack
            && p.0 <= self.x + self.w + slack
            && p.1 >= self.y - slack
            && p.1 <= self.y + self.h + slack
    }

    /// The nearest point inside.
    pub(super) fn clamp(&self, p: Point) -> Point {
        (p.0.max(self.x).min(self.x + self.w), p.1.max(self.y).min(self.y + self.h))
    }

    /// The part of the segment `a`–`b` inside (Liang–Barsky). Clipping here
    /// rather than with `clipPath` keeps the picture free of ids, which would
    /// clash when several pictures are embedded in one page.
    pub(super) fn clip(&self, a: Point, b: Point) -> Option<(Point, Point)> {
        let (dx, dy) = (b.0 - a.0, b.1 - a.1);
        let (mut from, mut to) = (0.0_f64, 1.0_f64);
        let edges =
            [(-dx, a.0 - self.x), (dx, self.x + self.w - a.0), (-dy, a.1 - self.y), (dy, self.y + self.h - a.1)];
        for (step, room) in edges {
            if step == 0.0 {
                if room < 0.0 {
                    return None;
                }
            } else if step < 0.0 {
                from = from.max(room / step);
            } else {
                to = to.min(room / step);
            }
        }
        let at = |t: f64| (a.0 + t * dx, a.1 + t * dy);
        (from <= to).then(|| (at(from), at(to)))
    }
}

/// The picture under construction.
#[derive(Default)]
pub(super) struct Canvas {
    out: String,
    /// On a screen: series can be put out, and places answer the pointer.
    answers: bool,
}

impl Canvas {
    /// A picture that answers on a screen if `yes`.
    pub(super) fn answering(yes: bool) -> Self {
        Canvas { answers: yes, ..Canvas::default() }
    }

    /// True on a screen.
    pub(super) fn answers(&self) -> bool {
        self.answers
    }

    /// Begins what belongs to a series.
    pub(super) fn begin(&mut self, label: &str) {
        if self.answers {
            self.raw(&format!(r#"<g data-series="{}">"#, escape(label)));
        }
    }

    /// Begins the entry of a legend that puts its series out.
    pub(super) fn begin_switch(&mut self, label: &str) {
        if self.answers {
            self.raw(&format!(
                r#"<g data-toggle-series="{0}" role="button" tabindex="0" aria-pressed="true" aria-label="Show {0}">"#,
                escape(label)
            ));
        }
    }

    /// Ends what was begun last.
    pub(super) fn end(&mut self) {
        if self.answers {
            self.raw("</g>");
        }
    }

    /// An invisible area that answers a click for the group that it is in.
    pub(super) fn target(&mut self, r: Rect) {
        if self.answers {
            self.raw(&format!(
                r#"<rect class="hit" x="{}" y="{}" width="{}" height="{}" fill-opacity="0"/>"#,
                num(r.x),
                num(r.y),
                num(r.w),
                num(r.h)
            ));
        }
    }

    /// An invisible area with words that a screen shows at the pointer.
    pub(super) fn hit(&mut self, r: Rect, words: &str) {
        self.raw(&format!(
            r#"<rect class="hit" x="{}" y="{}" width="{}" height="{}" fill-opacity="0" data-tip="{}"/>"#,
            num(r.x),
            num(r.y),
            num(r.w),
            num(r.h),
            escape(words)
        ));
    }

    /// Appends markup as it is.
    pub(super) fn raw(&mut self, markup: &str) {
        self.out.push_str(markup);
        self.out.push('\n');
    }

    pub(super) fn finish(self) -> String {
        self.out
    }

    pub(super) fn line(&mut self, a: Point, b: Point, stroke: Stroke) {
        self.path(&[vec![a, b]], stroke);
    }

    /// Several open polylines with one stroke.
    pub(super) fn path(&mut self, runs: &[Vec<Point>], stroke: Stroke) {
        let mut data = String::new();
        for run in runs.iter().filter(|run| run.len() > 1) {
            for (i, p) in run.iter().enumerate() {
                let letter = if i == 0 { 'M' } else { 'L' };
                push(&mut data, letter, *p);
            }
        }
        if data.is_empty() {
            return;
        }
        let dash = dashes(stroke);
        self.raw(&format!(
            r#"<path d="{data}" fill="none" stroke="{}" stroke-width="{}" stroke-linejoin="round"{dash}/>"#,
            stroke.colour,
            num(stroke.width)
        ));
    }

    /// A closed shape.
    pub(super) fn polygon(&mut self, corners: &[Point], fill: &str, stroke: Stroke) {
        let mut data = String::new();
        for (i, p) in corners.iter().enumerate() {
            push(&mut data, if i == 0 { 'M' } else { 'L' }, *p);
        }
        self.raw(&format!(
            r#"<path d="{data}Z" fill="{fill}" stroke="{}" stroke-width="{}"/>"#,
            stroke.colour,
            num(stroke.width)
        ));
    }

    /// A closed shape without an edge.
    pub(super) fn area(&mut self, corners: &[Point], fill: &str, opacity: f64) {
        let mut data = String::new();
        for (i, p) in corners.iter().enumerate() {
            push(&mut data, if i == 0 { 'M' } else { 'L' }, *p);
        }
        self.raw(&format!(r#"<path d="{data}Z" fill="{fill}" fill-opacity="{}"/>"#, num(opacity)));
    }

    /// A closed shape that what lies behind it shows through.
    pub(super) fn glass(&mut self, corners: &[Point], fill: &str, opacity: f64, edge: Stroke) {
        let mut data = String::new();
        for (i, p) in corners.iter().enumerate() {
            push(&mut data, if i == 0 { 'M' } else { 'L' }, *p);
        }
        self.raw(&format!(
            r#"<path d="{data}Z" fill="{fill}" fill-opacity="{}" stroke="{}" stroke-width="{}" stroke-linejoin="round"{}/>"#,
            num(opacity),
            edge.colour,
            num(edge.width),
            dashes(edge)
        ));
    }

    pub(super) fn circle(&mut self, c: Point, r: f64, fill: &str, stroke: Stroke) {
        self.raw(&format!(
            r#"<circle cx="{}" cy="{}" r="{}" fill="{fill}" stroke="{}" stroke-width="{}"/>"#,
            num(c.0),
            num(c.1),
            num(r),
            stroke.colour,
            num(stroke.width)
        ));
    }

    pub(super) fn rect(&mut self, r: Rect, fill: &str, fill_opacity: f64, stroke: Stroke) {
        self.raw(&format!(
            r#"<rect x="{}" y="{}" width="{}" height="{}" fill="{fill}" fill-opacity="{}" stroke="{}" stroke-width="{}"/>"#,
            num(r.x),
            num(r.y),
            num(r.w),
            num(r.h),
            num(fill_opacity),
            stroke.colour,
            num(stroke.width)
        ));
    }

    /// Filled rectangles as one element, without seams between neighbours.
    pub(super) fn cells(&mut self, rects: &[Rect], fill: &str) {
        let mut data = String::new();
        for r in rects.iter().filter(|r| r.w > 0.0 && r.h > 0.0) {
            push(&mut data, 'M', (r.x, r.y));
            let (right, bottom) = (num(r.x + r.w), num(r.y + r.h));
            let _ = write!(data, "H{right}V{bottom}H{}Z", num(r.x));
        }
        if !data.is_empty() {
            self.raw(&format!(r#"<path d="{data}" fill="{fill}" shape-rendering="crispEdges"/>"#));
        }
    }

    /// Many small dots as one element; thousands of circles would dominate
    /// the size of the file.
    pub(super) fn dots(&mut self, places: &[Point], diameter: f64, colour: &str, opacity: f64) {
        if places.is_empty() {
            return;
        }
        let mut data = String::new();
        for p in places {
            push(&mut data, 'M', *p);
            data.push_str("h0.01");
        }
        self.raw(&format!(
            r#"<path d="{data}" fill="none" stroke="{colour}" stroke-width="{}" stroke-linecap="round" stroke-opacity="{}"/>"#,
            num(diameter),
            num(opacity)
        ));
    }

    /// One line of text in a colour of its own.
    pub(super) fn coloured_text(&mut self, at: Point, text: &str, font: Font, colour: &str) {
        match colour {
            INK => self.text(at, text, None, font),
            _ => {
                self.raw(&format!(r#"<g fill="{colour}">"#));
                self.text(at, text, None, font);
                self.raw("</g>");
            }
        }
    }

    /// One line of text with an optional raised exponent.
    pub(super) fn text(&mut self, at: Point, text: &str, exponent: Option<&str>, font: Font) {
        let anchor = match font.anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let (x, y) = (num(at.0), num(at.1));
        let mut markup = format!(r#"<text x="{x}" y="{y}" font-size="{}" text-anchor="{anchor}""#, num(font.size));
        if font.bold {
            markup.push_str(r#" font-weight="bold""#);
        }
        if font.turn != 0.0 {
            let _ = write!(markup, r#" transform="rotate({} {x} {y})""#, num(font.turn));
        }
        let _ = write!(markup, ">{}", escape(text));
        if let Some(exponent) = exponent {
            // `dy` is understood everywhere, `baseline-shift` is not.
            let _ = write!(
                markup,
                r#"<tspan dy="{}" font-size="{}">{}</tspan>"#,
                num(-0.38 * font.size),
                num(0.75 * font.size),
                escape(exponent)
            );
        }
        markup.push_str("</text>");
        self.raw(&markup);
    }
}

fn dashes(stroke: Stroke) -> String {
    match stroke.dash {
        "" => String::new(),
        dash => format!(r#" stroke-dasharray="{dash}""#),
    }
}

fn push(data: &mut String, letter: char, p: Point) {
    let _ = write!(data, "{letter}{} {}", num(p.0), num(p.1));
}

/// A number with at most two decimals and no superfluous characters.
pub(super) fn num(value: f64) -> String {
    // A value that is not a number cannot arise from the mapping of accepted
    // values; should it ever, a misplaced mark is better than a broken file.
    let value = if value.is_finite() { value } else { 0.0 };
    let text = format!("{:.2}", value.clamp(-1e6, 1e6));
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".into() } else { text.into() }
}

/// Text as XML content or attribute value. Characters XML cannot represent
/// become the replacement character.
pub fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            '\t' | '\n' | '\r' => out.push(' '),
            // What XML cannot hold, and marks that turn the text around them.
            c if c.is_control() => out.push('\u{fffd}'),
            '\u{200b}'..='\u{200f}'
            | '\u{2028}'..='\u{202e}'
            | '\u{2060}'..='\u{206f}'
            | '\u{feff}'
            | '\u{fffe}'
            | '\u{ffff}' => out.push('\u{fffd}'),
            other => out.push(other),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_finite() {
        assert_eq!(num(1.0), "1");
        assert_eq!(num(-0.001), "0");
        assert_eq!(num(12.345), "12.35");
        assert_eq!(num(100.0), "100");
        assert_eq!(num(f64::NAN), "0");
        assert_eq!(num(f64::NEG_INFINITY), "0");
        assert_eq!(num(1e300), "1000000");
    }

    #[test]
    fn escaping_covers_markup_and_control_characters() {
        assert_eq!(
            escape("a<b & \"c\" 'd'>\u{0}\n\u{202e}"),
            "a&lt;b &amp; &quot;c&quot; &#39;d&#39;&gt;\u{fffd} \u{fffd}"
        );
    }

    #[test]
    fn segments_are_clipped_at_the_frame() {
        let frame = Rect { x: 0.0, y: 0.0, w: 10.0, h: 10.0 };
        assert_eq!(frame.clip((-5.0, 5.0), (15.0, 5.0)), Some(((0.0, 5.0), (10.0, 5.0))));
        assert_eq!(frame.clip((-5.0, 5.0), (-1.0, 5.0)), None);
        assert_eq!(frame.clip((3.0, 3.0), (3.0, 3.0)), Some(((3.0, 3.0), (3.0, 3.0))));
    }
}
