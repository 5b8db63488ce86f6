//! Pictures for papers: as SVG at a stated width and in a stated typeface, with their data beside them.

mod names;

use crate::figure::Figure;
use crate::figure::csv::figure_csv;
use crate::figure::drawing::Drawing;
use crate::figure::layout::Layout;
use crate::figure::svg::{render_drawing_with, render_svg_with};
use names::stems;
use stiffarm::findings::visible;
use stiffarm::{Error, Result};

/// Widths of pictures \[mm\].
const WIDTHS_MM: [f64; 2] = [20.0, 500.0];
/// Sizes of the smallest text \[pt\].
const FONTS_PT: [f64; 2] = [4.0, 30.0];
/// Most characters of a font family.
const FAMILY_LENGTH: usize = 60;

/// What pictures for a paper are written as.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Vectors; the font is named and not part of the file.
    Svg,
    /// The data of charts as a table; drawings have none.
    Csv,
}

impl Format {
    /// All of them.
    pub const ALL: [Format; 2] = [Format::Svg, Format::Csv];

    /// End of the file names, without the dot.
    pub fn extension(self) -> &'static str {
        match self {
            Format::Svg => "svg",
            Format::Csv => "csv",
        }
    }
}

/// How pictures for a paper look and what they are written as.
#[derive(Debug, Clone, PartialEq)]
pub struct PaperOptions {
    /// Width of a picture \[mm\], 20 to 500.
    pub width_mm: f64,
    /// Smallest text \[pt\], 4 to 30.
    pub font_pt: f64,
    /// Font family; empty for the usual list of sans-serif families.
    pub font_family: String,
    /// Whether titles are drawn; in papers they are usually in the caption.
    pub titles: bool,
    /// What is written of each picture.
    pub formats: Vec<Format>,
}

impl Default for PaperOptions {
    /// One column of a journal, text of 8 pt, every format.
    fn default() -> Self {
        PaperOptions {
            width_mm: 88.0,
            font_pt: 8.0,
            font_family: String::new(),
            titles: false,
            formats: Format::ALL.to_vec(),
        }
    }
}

impl PaperOptions {
    /// Whether pictures can be written so.
    ///
    /// # Errors
    /// A number beyond its limits, a family with characters that no family name
    /// has, no format.
    pub fn check(&self) -> Result<()> {
        within("width", self.width_mm, WIDTHS_MM, "mm")?;
        within("font size", self.font_pt, FONTS_PT, "pt")?;
        let is_known = |c: char| c.is_alphanumeric() || " -_.".contains(c);
        let family = &self.font_family;
        if !family.chars().all(is_known) || family.chars().count() > FAMILY_LENGTH {
            let message = format!("{} is not a font family.", visible(family));
            return Err(Error::invalid(message).hint("give the name of one family, for example Times New Roman"));
        }
        if self.formats.is_empty() {
            Err(Error::invalid("There is no format to write.").hint("choose svg, csv or both"))
        } else {
            Ok(())
        }
    }

    /// Formats without those that are there twice, in their own order.
    fn of_picture(&self, has_data: bool) -> impl Iterator<Item = Format> {
        let wanted = move |format: &Format| self.formats.contains(format) && (has_data || *format != Format::Csv);
        Format::ALL.into_iter().filter(wanted)
    }
}

/// The names that [`paper_files`] gives its files, in its order.
pub fn paper_names(figures: &[Figure], drawings: &[Drawing], options: &PaperOptions) -> Vec<String> {
    let ids = figures.iter().map(|figure| &figure.id);
    let ids = ids.chain(drawings.iter().map(|drawing| &drawing.id));
    let stems = stems(ids.map(String::as_str));
    let named = stems.iter().enumerate().flat_map(|(number, stem)| {
        let formats = options.of_picture(number < figures.len());
        formats.map(move |format| format!("{stem}.{}", format.extension()))
    });
    named.collect()
}

/// Pictures as files: name and contents, the figures first. The names come from
/// their ids. Equal inputs give equal bytes.
///
/// # Errors
/// As [`PaperOptions::check`].
///
/// ```
/// use stiffarm_report::paper::{PaperOptions, paper_files};
/// use stiffarm_report::{Axis, Figure, Panel, Series, Style};
///
/// let figure = Figure {
///     id: "deviation".into(),
///     title: "Deviation".into(),
///     caption: String::new(),
///     columns: 1,
///     panels: vec![Panel {
///         title: String::new(),
///         x: Axis::linear("noise level", ""),
///         y: Axis::linear("deviation", "%"),
///         series: vec![Series::new("Group 1", Style::Line, vec![1.0, 2.0], vec![0.5, 0.9])],
///         equal_aspect: false,
///     }],
/// };
/// let files = paper_files(&[figure], &[], &PaperOptions::default())?;
/// assert_eq!(files[0].0, "deviation.svg");
/// assert!(files[0].1.contains(r#"width="88mm""#));
/// # Ok::<(), stiffarm::Error>(())
/// ```
pub fn paper_files(figures: &[Figure], drawings: &[Drawing], options: &PaperOptions) -> Result<Vec<(String, String)>> {
    options.check()?;
    let layout = Layout::paper(options.width_mm, options.font_pt)
        .with_font(options.font_family.as_str())
        .with_title(options.titles);
    let mut contents = Vec::new();
    for figure in figures {
        contents.extend(options.of_picture(true).map(|format| match format {
            Format::Svg => render_svg_with(figure, &layout),
            Format::Csv => figure_csv(figure),
        }));
    }
    for drawing in drawings {
        let formats = options.of_picture(false);
        contents.extend(formats.map(|_| render_drawing_with(drawing, &layout)));
    }
    let names = paper_names(figures, drawings, options);
    Ok(names.into_iter().zip(contents).collect())
}

fn within(what: &str, value: f64, [least, most]: [f64; 2], unit: &str) -> Result<()> {
    if (least..=most).contains(&value) {
        Ok(())
    } else {
        Err(Error::invalid(format!("The {what} of pictures must be {least} to {most} {unit}, got {value}.")))
    }
}
