//! The data of a figure as a table of comma-separated values.

use super::{Axis, Figure, Style};
use std::fmt::Write;

/// The data of a figure in long form: one row per point, every digit.
///
/// Columns: `panel` (from 1), `panel title`, `series`, `style`, the headings of
/// the axes with their units (`x axis`, `y axis`, `value axis`) and the numbers
/// `x`, `y`, `error` and `value`; on an axis with categories the name instead of
/// the number. A figure with error bars that reach farther to one side has two columns more, their ends `from`
/// and `to`; `to` is empty where the bar is open above. A cell without a value is empty. LF line ends. Text that a
/// spreadsheet program would take for a formula begins with an apostrophe.
///
/// ```
/// use stiffarm_report::{Axis, Figure, Panel, Series, Style, figure_csv};
///
/// let figure = Figure {
///     id: "deviation".into(),
///     title: String::new(),
///     caption: String::new(),
///     columns: 1,
///     panels: vec![Panel {
///         title: String::new(),
///         x: Axis::categorical("joint", ["1", "2"]),
///         y: Axis::linear("deviation", "%"),
///         series: vec![Series::new("Group 1", Style::Bars, vec![0.0], vec![0.1])],
///         equal_aspect: false,
///     }],
/// };
/// let csv = figure_csv(&figure);
/// assert_eq!(csv.lines().nth(1), Some("1,,Group 1,bars,joint,deviation [%],,1,0.1,,"));
/// ```
pub fn figure_csv(figure: &Figure) -> String {
    let mut out = String::from("panel,panel title,series,style,x axis,y axis,value axis,x,y,error,value");
    let mut all = figure.panels.iter().flat_map(|panel| &panel.series);
    let has_ends = all.any(|series| !series.interval.is_empty());
    out += if has_ends { ",from,to\n" } else { "\n" };
    for (i, panel) in figure.panels.iter().enumerate() {
        for series in &panel.series {
            let colour = series.colour.as_ref();
            let head = [
                text(&panel.title),
                text(&series.label),
                style(series.style).to_owned(),
                text(&panel.x.heading()),
                text(&panel.y.heading()),
                text(&colour.map(|c| c.axis.heading()).unwrap_or_default()),
            ]
            .join(",");
            for point in 0..series.x.len().max(series.y.len()) {
                let at = |values: &[f64]| values.get(point).copied();
                let _ = write!(
                    out,
                    "{},{head},{},{},{},{}",
                    i + 1,
                    place(&panel.x, at(&series.x)),
                    place(&panel.y, at(&series.y)),
                    number(at(&series.error)),
                    number(colour.and_then(|c| at(&c.values))),
                );
                if has_ends {
                    let [from, to] = series.interval.get(point).copied().unwrap_or_default();
                    let _ = write!(out, ",{},{}", number(from), number(to));
                }
                out.push('\n');
            }
        }
    }
    out
}

/// A coordinate: a number, or the name of its category.
fn place(axis: &Axis, value: Option<f64>) -> String {
    let Some(value) = value.filter(|v| v.is_finite()) else {
        return String::new();
    };
    let whole = value >= 0.0 && value.fract() == 0.0;
    match axis.categories.get(value as usize) {
        Some(name) if whole => text(name),
        _ => number(Some(value)),
    }
}

/// Shortest form that reads back as the same number; empty for none.
pub fn number(value: Option<f64>) -> String {
    match value.filter(|v| v.is_finite()) {
        // Without an exponent, tiny and huge values would be hundreds of digits.
        Some(v) if v != 0.0 && !(1e-7..1e17).contains(&v.abs()) => format!("{v:e}"),
        Some(v) => v.to_string(),
        None => String::new(),
    }
}

/// A cell that spreadsheet programs take as text, quoted where needed.
pub fn text(cell: &str) -> String {
    let is_number = cell.trim().parse::<f64>().is_ok_and(f64::is_finite);
    let formula = cell.starts_with(['=', '+', '-', '@', '\t', '\r']) && !is_number;
    let cell = if formula { format!("'{cell}") } else { cell.to_owned() };
    if cell.contains([',', ';', '"', '\n', '\r', '\t']) { format!("\"{}\"", cell.replace('"', "\"\"")) } else { cell }
}

fn style(style: Style) -> &'static str {
    match style {
        Style::Line => "line",
        Style::Curve => "curve",
        Style::Dashed => "dashed",
        Style::Points => "points",
        Style::Bars => "bars",
        Style::Box => "box",
        Style::Outline => "outline",
        Style::Path => "path",
        Style::Hollow => "hollow",
        Style::Map => "map",
        Style::Band => "band",
        Style::Landmark => "landmark",
        Style::Strokes => "strokes",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formulas_become_text_and_numbers_stay() {
        assert_eq!(text("=cmd|' /C calc'!A0"), "'=cmd|' /C calc'!A0");
        assert_eq!(text("@x"), "'@x");
        assert_eq!(text("-12.5"), "-12.5");
        assert_eq!(text("+a,b"), "\"'+a,b\"");
        assert_eq!(text("\tx"), "\"'\tx\"");
        assert_eq!(text("a \"b\""), "\"a \"\"b\"\"\"");
    }

    #[test]
    fn numbers_read_back() {
        for value in [0.0, -0.1, 1e-300, 1.0 / 3.0, 1e300, 5e-324, 123456789.25] {
            assert_eq!(number(Some(value)).parse(), Ok(value));
        }
        assert_eq!(number(Some(f64::NAN)), "");
    }
}
