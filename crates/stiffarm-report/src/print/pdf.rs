//! Pictures as PDF.
//!
//! Our own writer: what this crate draws are filled and stroked paths of plain
//! colours and text, and the crate that turns any SVG into PDF (svg2pdf 0.13)
//! writes fonts and settings in the random order of its hash maps, so that equal
//! pictures would not be equal bytes.

use super::Fonts;
use super::embedded::{Embedded, compressed};
use pdf_writer::types::{LineCapStyle, LineJoinStyle};
use pdf_writer::{Content, Filter, Finish, Name, Pdf, Rect, Ref, Str, TextStr};
use resvg::tiny_skia::PathSegment;
use resvg::usvg::fontdb::Database;
use resvg::usvg::layout::{PositionedGlyph, Span};
use resvg::usvg::{
    BlendMode, Color, Fill, FillRule, Group, LineCap, LineJoin, Node, Opacity, Paint, Path,
    ShapeRendering, Stroke, Text, Transform,
};
use stiffarm::{Code, Error, Result};

/// Points of 1/72 inch per pixel of an SVG.
const POINTS: f32 = 72.0 / 96.0;
/// Width of the line that closes the gaps which viewers leave between cells of maps \[pt\].
const SEAM: f32 = 0.2;

/// A picture of this crate as PDF: one page of the picture's size, its text as text in embedded subsets of `fonts`.
///
/// # Errors
/// The picture is no SVG, or has more than paths of plain colours and text.
pub fn to_pdf(svg: &str, title: &str, fonts: &Fonts) -> Result<Vec<u8>> {
    let tree = fonts.read(svg)?;
    let (width, height) = (tree.size().width() * POINTS, tree.size().height() * POINTS);
    let mut page = Page {
        // y points up in a PDF.
        transform: Transform::from_row(POINTS, 0.0, 0.0, -POINTS, 0.0, height),
        content: Content::new(),
        opacities: Vec::new(),
        faces: Vec::new(),
        database: tree.fontdb(),
    };
    page.group(tree.root())?;
    let Page {
        content,
        opacities,
        faces,
        ..
    } = page;

    let [catalog, pages, sheet, stream, info] = [1, 2, 3, 4, 5].map(Ref::new);
    let mut next = Ref::new(6);
    let mut pdf = Pdf::new();
    pdf.catalog(catalog).pages(pages);
    pdf.pages(pages).kids([sheet]).count(1);
    let mut out = pdf.page(sheet);
    out.parent(pages)
        .media_box(Rect::new(0.0, 0.0, width, height))
        .contents(stream);
    let mut resources = out.resources();
    let references: Vec<Ref> = faces
        .iter()
        .map(|_| Embedded::references(&mut next))
        .collect();
    let mut fonts = resources.fonts();
    for (number, reference) in references.iter().enumerate() {
        fonts.pair(Name(face_name(number).as_bytes()), *reference);
    }
    fonts.finish();
    let mut settings = resources.ext_g_states();
    for (number, [fill, stroke]) in opacities.iter().enumerate() {
        settings
            .insert(Name(setting_name(number).as_bytes()))
            .start::<pdf_writer::writers::ExtGraphicsState>()
            .non_stroking_alpha(*fill)
            .stroking_alpha(*stroke);
    }
    settings.finish();
    resources.finish();
    out.finish();
    pdf.stream(stream, &compressed(&content.finish()))
        .filter(Filter::FlateDecode);
    for (face, reference) in faces.iter().zip(references) {
        face.write(&mut pdf, reference)?;
    }
    pdf.document_info(info)
        .title(TextStr(title))
        .producer(TextStr("stiffarm"));
    Ok(pdf.finish())
}

fn face_name(number: usize) -> String {
    format!("F{number}")
}

fn setting_name(number: usize) -> String {
    format!("G{number}")
}

/// A page while it is drawn.
struct Page<'a> {
    /// From pixels of the picture to points of the page.
    transform: Transform,
    content: Content,
    /// Opacities of areas and lines that were used.
    opacities: Vec<[f32; 2]>,
    faces: Vec<Embedded>,
    database: &'a Database,
}

impl Page<'_> {
    fn group(&mut self, group: &Group) -> Result<()> {
        let is_plain = group.opacity() == Opacity::ONE
            && group.blend_mode() == BlendMode::Normal
            && group.clip_path().is_none()
            && group.mask().is_none()
            && group.filters().is_empty();
        if !is_plain {
            return Err(unsupported("groups with effects"));
        }
        for node in group.children() {
            match node {
                Node::Group(group) => self.group(group)?,
                Node::Path(path) => self.path(path)?,
                Node::Text(text) => self.text(text)?,
                Node::Image(_) => return Err(unsupported("images")),
            }
        }
        Ok(())
    }

    fn path(&mut self, path: &Path) -> Result<()> {
        let transform = self.transform.pre_concat(path.abs_transform());
        let Some(data) = path.data().clone().transform(transform) else {
            return Ok(());
        };
        if !path.is_visible() || (path.fill().is_none() && path.stroke().is_none()) {
            return Ok(());
        }
        self.content.save_state();
        let opacity = [
            path.fill().map_or(1.0, |fill| fill.opacity().get()),
            path.stroke().map_or(1.0, |stroke| stroke.opacity().get()),
        ];
        self.opacity(opacity);
        let has_seam = path.rendering_mode() == ShapeRendering::CrispEdges
            && path.stroke().is_none()
            && opacity == [1.0, 1.0];
        if let Some(fill) = path.fill() {
            let colour = rgb(fill.paint())?;
            self.content.set_fill_rgb(colour[0], colour[1], colour[2]);
            if has_seam {
                self.content.set_stroke_rgb(colour[0], colour[1], colour[2]);
                self.content.set_line_width(SEAM);
            }
        }
        if let Some(stroke) = path.stroke() {
            self.stroke(stroke, scale_of(transform))?;
        }
        let content = &mut self.content;
        let mut from = (0.0, 0.0);
        for segment in data.segments() {
            from = segment_to(content, segment, from);
        }
        let even_odd = path.fill().map(Fill::rule) == Some(FillRule::EvenOdd);
        match (path.fill(), path.stroke().is_some() || has_seam) {
            (Some(_), true) if even_odd => content.fill_even_odd_and_stroke(),
            (Some(_), true) => content.fill_nonzero_and_stroke(),
            (Some(_), false) if even_odd => content.fill_even_odd(),
            (Some(_), false) => content.fill_nonzero(),
            (None, _) => content.stroke(),
        };
        content.restore_state();
        Ok(())
    }

    fn stroke(&mut self, stroke: &Stroke, scale: f32) -> Result<()> {
        let [r, g, b] = rgb(stroke.paint())?;
        let content = &mut self.content;
        content.set_stroke_rgb(r, g, b);
        content.set_line_width(short(stroke.width().get() * scale));
        content.set_line_cap(match stroke.linecap() {
            LineCap::Butt => LineCapStyle::ButtCap,
            LineCap::Round => LineCapStyle::RoundCap,
            LineCap::Square => LineCapStyle::ProjectingSquareCap,
        });
        content.set_line_join(match stroke.linejoin() {
            LineJoin::Miter | LineJoin::MiterClip => LineJoinStyle::MiterJoin,
            LineJoin::Round => LineJoinStyle::RoundJoin,
            LineJoin::Bevel => LineJoinStyle::BevelJoin,
        });
        content.set_miter_limit(stroke.miterlimit().get());
        if let Some(dashes) = stroke.dasharray() {
            let dashes = dashes.iter().map(|dash| short(dash * scale));
            content.set_dash_pattern(dashes, short(stroke.dashoffset() * scale));
        }
        Ok(())
    }

    fn text(&mut self, text: &Text) -> Result<()> {
        let transform = self.transform.pre_concat(text.abs_transform());
        for span in text.layouted().iter().filter(|span| span.visible) {
            if span.stroke.is_some() {
                return Err(unsupported("text with outlines"));
            }
            let Some(fill) = &span.fill else { continue };
            let [r, g, b] = rgb(fill.paint())?;
            self.content.save_state();
            self.opacity([fill.opacity().get(), 1.0]);
            self.content.set_fill_rgb(r, g, b).begin_text();
            self.span(span, transform)?;
            self.content.end_text().restore_state();
        }
        Ok(())
    }

    /// The glyphs of a span, those on one line in one face together.
    fn span(&mut self, span: &Span, transform: Transform) -> Result<()> {
        let mut rest = span.positioned_glyphs.as_slice();
        while let Some(first) = rest.first() {
            let number = self.face(first)?;
            let placed = |glyph: &PositionedGlyph| transform.pre_concat(glyph.outline_transform());
            let start = placed(first);
            let follows = |glyph: &&PositionedGlyph| {
                glyph.font == first.font && is_beside(start, placed(glyph))
            };
            let count = rest.iter().take_while(follows).count().max(1);
            let (line, others) = rest.split_at(count);
            rest = others;
            let face = &mut self.faces[number];
            let units = face.units_per_em();
            let along = start.sx.hypot(start.ky);
            let size = short(along * units);
            let upright = 1.0 / along;
            self.content
                .set_font(Name(face_name(number).as_bytes()), size)
                .set_text_matrix([
                    start.sx * upright,
                    start.ky * upright,
                    start.kx * upright,
                    start.sy * upright,
                    short(start.tx),
                    short(start.ty),
                ]);
            let mut shown = self.content.show_positioned();
            let mut items = shown.items();
            let (mut pen, mut codes) = (0.0_f32, Vec::new());
            for glyph in line {
                let at = placed(glyph);
                let (dx, dy) = (at.tx - start.tx, at.ty - start.ty);
                let target = (dx * start.sx + dy * start.ky) / (along * along);
                let back = ((pen - target) * 1000.0 / units).round();
                if back != 0.0 {
                    if !codes.is_empty() {
                        items.show(Str(&std::mem::take(&mut codes)));
                    }
                    items.adjust(back);
                    pen -= back * units / 1000.0;
                }
                codes.extend(face.code(glyph.id.0, &glyph.text).to_be_bytes());
                pen += face.advance(glyph.id.0);
            }
            items.show(Str(&codes));
        }
        Ok(())
    }

    /// Number of the face of a glyph.
    fn face(&mut self, glyph: &PositionedGlyph) -> Result<usize> {
        if let Some(number) = self.faces.iter().position(|face| face.id() == glyph.font) {
            return Ok(number);
        }
        self.faces.push(Embedded::new(self.database, glyph.font)?);
        Ok(self.faces.len() - 1)
    }

    /// Opacities of areas and of lines from here on.
    fn opacity(&mut self, opacity: [f32; 2]) {
        let opacity = opacity.map(short);
        let known = self.opacities.iter().position(|other| *other == opacity);
        let number = known.unwrap_or(self.opacities.len());
        if number == self.opacities.len() {
            // What a page begins with.
            if opacity == [1.0, 1.0] {
                return;
            }
            self.opacities.push(opacity);
        }
        let name = setting_name(number);
        self.content.set_parameters(Name(name.as_bytes()));
    }
}

/// A path goes on from a place; the place where it ends.
fn segment_to(content: &mut Content, segment: PathSegment, from: (f32, f32)) -> (f32, f32) {
    match segment {
        PathSegment::MoveTo(p) => {
            content.move_to(short(p.x), short(p.y));
            (p.x, p.y)
        }
        PathSegment::LineTo(p) => {
            content.line_to(short(p.x), short(p.y));
            (p.x, p.y)
        }
        // The same curve with two control points.
        PathSegment::QuadTo(c, p) => {
            let between = |end: f32, control: f32| short(end + (control - end) * 2.0 / 3.0);
            content.cubic_to(
                between(from.0, c.x),
                between(from.1, c.y),
                between(p.x, c.x),
                between(p.y, c.y),
                short(p.x),
                short(p.y),
            );
            (p.x, p.y)
        }
        PathSegment::CubicTo(c, d, p) => {
            content.cubic_to(
                short(c.x),
                short(c.y),
                short(d.x),
                short(d.y),
                short(p.x),
                short(p.y),
            );
            (p.x, p.y)
        }
        PathSegment::Close => {
            content.close_path();
            from
        }
    }
}

/// Whether a glyph stands on the line of another one, at the same size and angle.
fn is_beside(start: Transform, other: Transform) -> bool {
    let along = start.sx.hypot(start.ky);
    let near = |a: f32, b: f32| (a - b).abs() <= 1e-3 * along;
    let (dx, dy) = (other.tx - start.tx, other.ty - start.ty);
    let aside = (dy * start.sx - dx * start.ky) / along;
    near(start.sx, other.sx)
        && near(start.ky, other.ky)
        && near(start.kx, other.kx)
        && near(start.sy, other.sy)
        && aside.abs() < 0.01
}

/// How much longer a transform makes lengths; the pictures have uniform scales only.
fn scale_of(transform: Transform) -> f32 {
    (transform.sx * transform.sy - transform.kx * transform.ky)
        .abs()
        .sqrt()
}

fn rgb(paint: &Paint) -> Result<[f32; 3]> {
    match paint {
        Paint::Color(Color { red, green, blue }) => {
            Ok([*red, *green, *blue].map(|part| short(f32::from(part) / 255.0)))
        }
        _ => Err(unsupported("gradients and patterns")),
    }
}

/// Rounded to a thousandth.
fn short(value: f32) -> f32 {
    (value * 1000.0).round() / 1000.0
}

fn unsupported(what: &str) -> Error {
    Error::new(
        Code::Unsupported,
        format!("A picture with {what} cannot be written as PDF."),
    )
}
