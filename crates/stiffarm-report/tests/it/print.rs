//! Pictures for papers as files.

use crate::gallery;
use resvg::usvg::{Group, Node, Options, Rect, Tree};
use std::collections::BTreeMap;
use std::sync::Arc;
use stiffarm::Code;
use stiffarm::files::builtin;
use stiffarm::files::cell::parse_cell;
use stiffarm::model::cell::Cell;
use stiffarm::model::posture::{Posture, PostureGroup};
use stiffarm_report::print::{Fonts, Format, PaperOptions, paper_files, paper_names, to_pdf};
use stiffarm_report::{
    Axis, Drawing, Figure, Full, Layout, Panel, Series, Style, cell_drawing, render_drawing_with,
    render_svg_with,
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
    PaperOptions {
        width_mm,
        formats: formats.to_vec(),
        ..PaperOptions::default()
    }
}

fn cells() -> Vec<Cell> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../stiffarm/tests/cells/");
    let shapes = std::fs::read_to_string(format!("{folder}comau-shapes.toml")).unwrap();
    let plain = builtin::cell_text("comau").unwrap();
    vec![
        parse_cell(plain, "comau").unwrap(),
        parse_cell(&shapes, "comau-shapes").unwrap(),
    ]
}

/// One posture, six, and more than have a look of their own.
fn drawings() -> Vec<Drawing> {
    let mut drawings = Vec::new();
    for cell in cells() {
        for count in [1, 6, 50] {
            let angles = (0..count).map(|i| {
                let share = |j: usize| (0.5 + (i + 1) as f64 * (0.31 + 0.11 * j as f64)) % 1.0;
                let bounds = cell.bounds.iter().enumerate();
                bounds.map(|(j, [a, b])| a + (b - a) * share(j)).collect()
            });
            let postures: Vec<Posture> = PostureGroup::from_angles("spread", angles).postures;
            drawings.push(cell_drawing(&cell, &postures, Full::Tightest).unwrap());
        }
    }
    drawings
}

/// The numbers of an array in a file, for example of the page's size.
fn array(file: &[u8], key: &str) -> Vec<f64> {
    let text = String::from_utf8_lossy(file);
    let (_, after) = text.split_once(key).unwrap();
    let inside = after.split(['[', ']']).nth(1).unwrap();
    let numbers = inside
        .split_whitespace()
        .map(|number| number.parse().unwrap());
    numbers.collect()
}

#[test]
fn the_page_has_the_stated_width() {
    for width in [20.0, 88.0, 180.0, 500.0] {
        let files = paper_files(&[figure("a")], &[], &options(width, &[Format::Pdf])).unwrap();
        let page = array(&files[0].1, "/MediaBox");
        assert_eq!(page[..2], [0.0, 0.0]);
        assert!((page[2] - width / 25.4 * 72.0).abs() < 1e-3, "{page:?}");
        assert!(page[3] > 20.0);
    }
}

#[test]
fn the_raster_has_the_stated_width_and_says_so() {
    for (width, dpi) in [(88.0, 300.0), (180.0, 72.0), (20.0, 1200.0)] {
        let asked = PaperOptions {
            dpi,
            ..options(width, &[Format::Png])
        };
        let file = paper_files(&[figure("a")], &[], &asked)
            .unwrap()
            .remove(0)
            .1;
        let number = |at: usize| u32::from_be_bytes(file[at..at + 4].try_into().unwrap());
        assert_eq!(number(16), (width / 25.4 * dpi).round() as u32);
        let place = file.windows(4).position(|name| name == b"pHYs").unwrap();
        let per_metre = (dpi / 0.0254).round() as u32;
        assert_eq!([number(place + 4), number(place + 8)], [per_metre; 2]);
        assert_eq!(file[place + 12], 1);
    }
}

/// What the text of a page says: the strings of its content by the tables of its fonts.
fn page_text(file: &[u8]) -> String {
    let text = String::from_utf8_lossy(file);
    let mut tables = Vec::new();
    for table in text.split("beginbfchar").skip(1) {
        let lines = table.split("endbfchar").next().unwrap().lines();
        let pairs = lines.filter_map(|line| {
            let (code, meaning) = line.trim().trim_matches(['<', '>']).split_once("> <")?;
            let units: Vec<u16> = (0..meaning.len() / 4)
                .map(|i| u16::from_str_radix(&meaning[4 * i..4 * i + 4], 16).unwrap())
                .collect();
            let code = u16::from_str_radix(code, 16).unwrap();
            Some((code, String::from_utf16(&units).unwrap()))
        });
        tables.push(pairs.collect::<BTreeMap<_, _>>());
    }
    let from = file.windows(6).position(|word| word == b"stream").unwrap() + 7;
    let content = miniz_oxide::inflate::decompress_to_vec_zlib(&file[from..]).unwrap();
    let mut found = String::new();
    let (mut face, mut at) = (0, 0);
    while at < content.len() {
        match content[at] {
            b'F' if content[at + 1].is_ascii_digit() => {
                face = usize::from(content[at + 1] - b'0');
            }
            b'<' | b'(' => {
                let (bytes, end) = string(&content, at);
                for code in bytes.chunks(2) {
                    found += &tables[face][&u16::from_be_bytes(code.try_into().unwrap())];
                }
                at = end;
            }
            b'B' if content[at + 1] == b'T' => found.push('\n'),
            _ => {}
        }
        at += 1;
    }
    found
}

/// A string of a content stream and where it ends.
fn string(content: &[u8], from: usize) -> (Vec<u8>, usize) {
    let mut bytes = Vec::new();
    let mut at = from + 1;
    if content[from] == b'<' {
        while content[at] != b'>' {
            let digits = std::str::from_utf8(&content[at..at + 2]).unwrap();
            bytes.push(u8::from_str_radix(digits, 16).unwrap());
            at += 2;
        }
        return (bytes, at);
    }
    while content[at] != b')' {
        let is_escaped = content[at] == b'\\';
        at += usize::from(is_escaped);
        bytes.push(match content[at] {
            b'n' if is_escaped => b'\n',
            b'r' if is_escaped => b'\r',
            b't' if is_escaped => b'\t',
            b'b' if is_escaped => 8,
            b'f' if is_escaped => 12,
            b'0'..=b'7' if is_escaped => {
                let digits = std::str::from_utf8(&content[at..at + 3]).unwrap();
                at += 2;
                u8::from_str_radix(digits, 8).unwrap()
            }
            other => other,
        });
        at += 1;
    }
    (bytes, at)
}

#[test]
fn text_is_text() {
    let files = paper_files(
        &[figure("deviation of k")],
        &[],
        &options(88.0, &[Format::Pdf]),
    );
    let file = files.unwrap().remove(0).1;
    let text = page_text(&file);
    for line in [
        "panel",
        "noise level σ²",
        "deviation of k [%]",
        "deviation of k",
        "1.0",
    ] {
        assert!(text.lines().any(|found| found == line), "{line}: {text}");
    }
    let shown = String::from_utf8_lossy(&file);
    // Two faces, each in a subset of its own.
    assert_eq!(shown.matches("/FontFile2").count(), 2, "{text}");
    assert!(file.len() < 60_000, "{}", file.len());
}

#[test]
fn hostile_labels_stay_text() {
    for nasty in [
        "</script><img onerror=alert(1)>",
        "=cmd|' /C calc'!A0",
        ") Tj ET Q (\\",
        "\u{1b}[31mred",
    ] {
        let mut hostile = figure(nasty);
        hostile.id = nasty.into();
        let files = paper_files(&[hostile], &[], &options(180.0, &Format::ALL)).unwrap();
        for (name, _) in &files {
            let known = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || "-.".contains(c);
            assert!(name.chars().all(known), "{name}");
        }
        let [svg, pdf, _, csv] = &files[..] else {
            panic!("four formats")
        };
        roxmltree::Document::parse(std::str::from_utf8(&svg.1).unwrap()).unwrap();
        let shown = nasty.replace('\u{1b}', "\u{fffd}");
        let text = page_text(&pdf.1);
        assert!(text.contains(&shown), "{nasty}: {text}");
        let csv = String::from_utf8(csv.1.clone()).unwrap();
        assert!(!csv.contains(",=") && !csv.contains("\n="), "{csv}");
    }
}

#[test]
fn equal_pictures_are_equal_bytes() {
    // Two faces and several opacities: whatever comes from an unordered map would show.
    let make = || {
        let figures = [figure("a"), gallery::all().remove(5)];
        let asked = PaperOptions {
            dpi: 72.0,
            titles: true,
            ..PaperOptions::default()
        };
        paper_files(&figures, &drawings()[1..2], &asked).unwrap()
    };
    let first = make();
    assert_eq!(first.len(), 11);
    assert!(first == make() && first == make());
}

#[test]
fn data_read_back_as_they_are() {
    for figure in gallery::all() {
        let files = paper_files(
            std::slice::from_ref(&figure),
            &[],
            &options(88.0, &[Format::Csv]),
        );
        let csv = String::from_utf8(files.unwrap().remove(0).1).unwrap();
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
    let asked = options(60.0, &[Format::Csv, Format::Svg, Format::Csv]);
    let files = paper_files(&figures, drawings, &asked).unwrap();
    let names: Vec<&String> = files.iter().map(|(name, _)| name).collect();
    let expected = paper_names(&figures, drawings, &asked);
    assert!(names.into_iter().eq(&expected));
    // Drawings have no table.
    assert_eq!(expected.len(), 2 * figures.len() + 1);
}

/// Why pictures are refused, if they are.
fn refusal(asked: &PaperOptions) -> Option<Code> {
    let made = paper_files(&[figure("a")], &[], asked);
    made.err().map(|error| error.code())
}

#[test]
fn what_cannot_be_meant_is_refused() {
    let usual = PaperOptions::default;
    let wrong = [
        PaperOptions {
            width_mm: 19.0,
            ..usual()
        },
        PaperOptions {
            width_mm: f64::NAN,
            ..usual()
        },
        PaperOptions {
            font_pt: 31.0,
            ..usual()
        },
        PaperOptions {
            dpi: 1201.0,
            ..usual()
        },
        PaperOptions {
            font_family: "A'; x".into(),
            ..usual()
        },
        PaperOptions {
            formats: Vec::new(),
            ..usual()
        },
    ];
    for asked in wrong {
        assert_eq!(refusal(&asked), Some(Code::InvalidValue), "{asked:?}");
    }
    let absent = PaperOptions {
        font_family: "No Such Face".into(),
        ..usual()
    };
    assert_eq!(refusal(&absent), Some(Code::UnknownName));
    // SVG only names its font.
    let named = PaperOptions {
        formats: vec![Format::Svg],
        ..absent
    };
    let svg = paper_files(&[figure("a")], &[], &named)
        .unwrap()
        .remove(0)
        .1;
    assert!(String::from_utf8(svg).unwrap().contains("'No Such Face'"));
    // 500 mm at 1200 dpi is 23,622 pixels wide.
    let huge = PaperOptions {
        dpi: 1200.0,
        ..options(500.0, &[Format::Png])
    };
    assert_eq!(refusal(&huge), Some(Code::InvalidValue));
}

#[test]
fn pictures_with_more_than_paths_are_refused() {
    let fonts = Fonts::usual();
    let svg = |inside: &str| {
        format!(r#"<svg xmlns="http://www.w3.org/2000/svg" width="9" height="9">{inside}</svg>"#)
    };
    assert!(to_pdf(&svg(r#"<rect width="5" height="5"/>"#), "", &fonts).is_ok());
    let effect =
        svg(r#"<g opacity="0.5"><rect width="5" height="5"/><rect width="9" height="9"/></g>"#);
    let error = to_pdf(&effect, "", &fonts).unwrap_err();
    assert_eq!(error.code(), Code::Unsupported);
    assert!(to_pdf("<svg", "", &fonts).is_err());
}

/// Boxes of all texts, and what they say.
fn boxes(group: &Group, found: &mut Vec<(Rect, String)>) {
    for node in group.children() {
        match node {
            Node::Group(group) => boxes(group, found),
            Node::Text(text) => {
                let words = text.chunks().iter().map(|chunk| chunk.text());
                found.push((text.abs_bounding_box(), words.collect()));
            }
            _ => {}
        }
    }
}

/// Every text lies within the picture when it is set in DejaVu Sans, the widest of the usual families.
fn all_inside(svg: &str, what: &str) {
    let mut options = Options::default();
    let fonts = Arc::make_mut(&mut options.fontdb);
    fonts.load_font_data(dejavu::sans::regular().to_vec());
    fonts.load_font_data(dejavu::sans::bold().to_vec());
    let tree = Tree::from_str(svg, &options).unwrap();
    let mut found = Vec::new();
    boxes(tree.root(), &mut found);
    assert!(!found.is_empty(), "{what}");
    let (width, height) = (tree.size().width(), tree.size().height());
    for (rect, text) in found {
        let inside = rect.left() >= 0.0
            && rect.top() >= 0.0
            && rect.right() <= width
            && rect.bottom() <= height;
        assert!(inside, "{what}: {text:?} {rect:?} of {width} × {height}");
    }
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
