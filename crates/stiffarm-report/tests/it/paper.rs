//! Pictures for papers have the stated size, keep all text inside, and write their data so that it reads back.

use crate::common::{spread, with_shapes};
use crate::gallery;
use roxmltree::{Document, Node};
use stiffarm::Code;
use stiffarm_files::builtin;
use stiffarm_report::paper::{Format, PaperOptions, paper_files, paper_names};
use stiffarm_report::{
    Axis, Drawing, Figure, Full, Layout, Panel, Series, Style, cell_drawing, render_drawing_with, render_svg_with,
};

fn figure(label: &str) -> Figure {
    let line = Series::new(label, Style::Line, vec![1.0, 2.0], vec![0.5, 1.0 / 3.0]);
    let band = Series::new("band", Style::Band, vec![1.0, 2.0], vec![0.5, 0.4]);
    Figure {
        id: "deviation".into(),
        title: label.into(),
        caption: String::new(),
        columns: 1,
        panels: vec![Panel {
            title: "panel".into(),
            x: Axis::linear("noise level σ²", ""),
            y: Axis::log(label, "%"),
            series: vec![line, band.with_error(vec![0.1, 0.1])],
            equal_aspect: false,
        }],
    }
}

fn options(width_mm: f64, formats: &[Format]) -> PaperOptions {
    PaperOptions { width_mm, formats: formats.to_vec(), ..PaperOptions::default() }
}

/// One posture, six, and more than have a look of their own.
fn drawings() -> Vec<Drawing> {
    let mut drawings = Vec::new();
    for cell in [builtin::cell("comau").unwrap(), with_shapes()] {
        for count in [1, 6, 50] {
            let postures = spread(&cell, count);
            drawings.push(cell_drawing(&cell, &postures, Full::Tightest).unwrap());
        }
    }
    drawings
}

#[test]
fn a_picture_has_the_stated_width() {
    for width in [20.0, 88.0, 180.0, 500.0] {
        let files = paper_files(&[figure("a")], &[], &options(width, &[Format::Svg])).unwrap();
        let stated = format!(r#"width="{width}mm""#);
        assert!(files[0].1.contains(&stated), "{stated}: {}", files[0].1);
    }
}

#[test]
fn labels_in_the_data_are_no_formulas() {
    let figures = [figure("=cmd|' /C calc'!A0")];
    let files = paper_files(&figures, &[], &options(180.0, &[Format::Csv])).unwrap();
    let csv = &files[0].1;
    assert!(csv.contains(",'=cmd") && !csv.contains(",="), "{csv}");
}

#[test]
fn data_read_back_as_they_are() {
    for figure in gallery::all() {
        let files = paper_files(std::slice::from_ref(&figure), &[], &options(88.0, &[Format::Csv]));
        let csv = files.unwrap().remove(0).1;
        let mut rows = csv.lines().skip(1);
        for panel in &figure.panels {
            for series in &panel.series {
                for (i, y) in series.y.iter().enumerate() {
                    let row = rows.next().unwrap();
                    // The last four cells are numbers or names of categories.
                    let cells: Vec<&str> = row.rsplitn(5, ',').collect();
                    let same = |cell: &str, value: f64| match cell.parse::<f64>() {
                        Ok(read) => read == value,
                        Err(_) => cell.is_empty() && !value.is_finite(),
                    };
                    if panel.y.categories.is_empty() {
                        assert!(same(cells[2], *y), "{row}");
                    }
                    if let Some(error) = series.error.get(i) {
                        assert!(same(cells[1], *error), "{row}");
                    }
                    if let Some(colour) = &series.colour {
                        assert!(same(cells[0], colour.values[i]), "{row}");
                    }
                }
            }
        }
        assert_eq!(rows.next(), None);
    }
}

#[test]
fn names_are_those_of_the_files() {
    let figures = gallery::all();
    let drawings = &drawings()[..1];
    let request = options(60.0, &[Format::Csv, Format::Svg, Format::Csv]);
    let files = paper_files(&figures, drawings, &request).unwrap();
    let names: Vec<&String> = files.iter().map(|(name, _)| name).collect();
    let expected = paper_names(&figures, drawings, &request);
    assert!(names.into_iter().eq(&expected));
    // Drawings have no table.
    assert_eq!(expected.len(), 2 * figures.len() + 1);
}

/// Why pictures are refused, if they are.
fn refusal(options: &PaperOptions) -> Option<Code> {
    let made = paper_files(&[figure("a")], &[], options);
    made.err().map(|error| error.code())
}

#[test]
fn what_cannot_be_meant_is_refused() {
    let usual = PaperOptions::default;
    let wrong = [
        PaperOptions { width_mm: 19.0, ..usual() },
        PaperOptions { width_mm: f64::NAN, ..usual() },
        PaperOptions { font_pt: 31.0, ..usual() },
        PaperOptions { font_family: "A'; x".into(), ..usual() },
        PaperOptions { formats: Vec::new(), ..usual() },
    ];
    for options in wrong {
        assert_eq!(refusal(&options), Some(Code::InvalidValue), "{options:?}");
    }
    // The font is only named: whether it is there shows where the picture is looked at.
    let absent = PaperOptions { font_family: "No Such Face".into(), ..usual() };
    let svg = paper_files(&[figure("a")], &[], &absent).unwrap().remove(0).1;
    assert!(svg.contains("'No Such Face'"));
}

/// Widths of the characters from the space to `~` in DejaVu Sans 2.37, in 1/2048 of its size, and in its bold face.
#[rustfmt::skip]
const WIDTHS: [[u16; 95]; 2] = [[
    651, 821, 942, 1716, 1303, 1946, 1597, 563, 799, 799, 1024, 1716, 651, 739, 651, 690, 1303, 1303, 1303,
    1303, 1303, 1303, 1303, 1303, 1303, 1303, 690, 690, 1716, 1716, 1716, 1087, 2048, 1401, 1405, 1430,
    1577, 1294, 1178, 1587, 1540, 604, 604, 1343, 1141, 1767, 1532, 1612, 1235, 1612, 1423, 1300, 1251,
    1499, 1401, 2025, 1403, 1251, 1403, 799, 690, 799, 1716, 1024, 1024, 1255, 1300, 1126, 1300, 1260, 721,
    1300, 1298, 569, 569, 1186, 569, 1995, 1298, 1253, 1300, 1300, 842, 1067, 803, 1298, 1212, 1675, 1212,
    1212, 1075, 1303, 690, 1303, 1716,
], [
    713, 934, 1067, 1716, 1425, 2052, 1786, 627, 936, 936, 1071, 1716, 778, 850, 778, 748, 1425, 1425, 1425,
    1425, 1425, 1425, 1425, 1425, 1425, 1425, 819, 819, 1716, 1716, 1716, 1188, 2048, 1585, 1561, 1503,
    1700, 1399, 1399, 1681, 1714, 762, 762, 1587, 1305, 2038, 1714, 1741, 1501, 1741, 1577, 1475, 1397,
    1663, 1585, 2259, 1579, 1483, 1485, 936, 748, 936, 1716, 1024, 1024, 1382, 1466, 1214, 1466, 1389, 891,
    1466, 1458, 702, 702, 1362, 702, 2134, 1458, 1407, 1466, 1466, 1010, 1219, 979, 1458, 1335, 1892, 1321,
    1335, 1192, 1458, 748, 1458, 1716,
]];
/// How far the letters of DejaVu Sans reach above and below their line, in units of its size.
const REACH: [f64; 2] = [0.928, 0.236];

/// Width of a text in DejaVu Sans. Beyond ASCII the widest that pictures use stands for all.
fn width(text: &str, size: f64, is_bold: bool) -> f64 {
    let face = WIDTHS[usize::from(is_bold)];
    let units = text.chars().map(|c| {
        let place = u32::from(c).checked_sub(32);
        place.map_or(0, |i| face.get(i as usize).copied().unwrap_or(1716))
    });
    units.map(f64::from).sum::<f64>() / 2048.0 * size
}

/// Every text lies within the picture when it is set in DejaVu Sans, the widest of the usual families.
fn all_inside(svg: &str, what: &str) {
    let document = Document::parse(svg).unwrap();
    let root = document.root_element();
    let numbers = |text: &str| -> Vec<f64> {
        let parts = text.split(|c: char| !c.is_ascii_digit() && !"-.".contains(c));
        parts.filter_map(|part| part.parse().ok()).collect()
    };
    let of = |node: &Node, name: &str| numbers(node.attribute(name).unwrap_or_default());
    let frame = of(&root, "viewBox");
    let mut count = 0;
    for node in document.descendants().filter(|n| n.has_tag_name("text")) {
        let is_bold = node.attribute("font-weight").is_some();
        let size = of(&node, "font-size")[0];
        let pieces = node.descendants().filter(Node::is_text).map(|piece| {
            let sizes = piece.parent().map_or(Vec::new(), |parent| of(&parent, "font-size"));
            let size = sizes.first().copied().unwrap_or(size);
            width(piece.text().unwrap_or_default(), size, is_bold)
        });
        let long: f64 = pieces.sum();
        let (x, y) = (of(&node, "x")[0], of(&node, "y")[0]);
        let from = match node.attribute("text-anchor") {
            Some("middle") => -0.5 * long,
            Some("end") => -long,
            _ => 0.0,
        };
        let turn = of(&node, "transform").first().copied().unwrap_or(0.0);
        let (sin, cos) = turn.to_radians().sin_cos();
        for a in [from, from + long] {
            for b in [-REACH[0] * size, REACH[1] * size] {
                let at = [x + a * cos - b * sin, y + a * sin + b * cos];
                let inside = (0..2).all(|i| (frame[i]..=frame[i] + frame[i + 2]).contains(&at[i]));
                assert!(inside, "{what}: {node:?} {at:?} of {frame:?}");
            }
        }
        count += 1;
    }
    assert!(count > 0, "{what}");
}

fn layouts() -> [(&'static str, Layout); 3] {
    [
        ("88 mm", Layout::paper(88.0, 8.0)),
        ("180 mm", Layout::paper(180.0, 8.0).with_title(true)),
        ("360 px", Layout::screen(360.0, 11.0)),
    ]
}

#[test]
fn no_label_of_a_figure_is_cut_off() {
    for (size, layout) in layouts() {
        for figure in gallery::all() {
            let what = format!("{} at {size}", figure.id);
            all_inside(&render_svg_with(&figure, &layout), &what);
        }
    }
}

#[test]
fn no_label_of_a_drawing_is_cut_off() {
    for (size, layout) in layouts() {
        for (number, drawing) in drawings().iter().enumerate() {
            let what = format!("drawing {number} at {size}");
            all_inside(&render_drawing_with(drawing, &layout), &what);
        }
    }
}
