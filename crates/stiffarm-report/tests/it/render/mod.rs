//! Every rendered figure is sound SVG with all its text inside, whatever its data.

mod any_drawing;
mod any_figure;
mod layouts;
mod panel_maps;

use proptest::collection::vec;
use proptest::option;
use proptest::prelude::*;
use roxmltree::{Document, Node};
use stiffarm_report::{Axis, Figure, Panel, Scale, Series, Style, render_svg, series_colour};

const STYLES: [Style; 13] = [
    Style::Line,
    Style::Dashed,
    Style::Curve,
    Style::Points,
    Style::Bars,
    Style::Box,
    Style::Outline,
    Style::Path,
    Style::Hollow,
    Style::Map,
    Style::Band,
    Style::Strokes,
    Style::Landmark,
];

fn panel(x: Axis, y: Axis, series: Vec<Series>) -> Panel {
    Panel { title: "panel".into(), x, y, series, equal_aspect: false }
}

fn figure(panels: Vec<Panel>) -> Figure {
    Figure { id: "test".into(), title: "figure".into(), caption: "caption".into(), columns: 2, panels }
}

pub fn texts(svg: &str) -> Vec<String> {
    let document = Document::parse(svg).expect("the renderer writes XML");
    document
        .descendants()
        .filter(|n| n.has_tag_name("text"))
        .map(|n| n.descendants().filter_map(|t| t.text().filter(|_| t.is_text())).collect())
        .collect()
}

fn number(node: &Node, name: &str) -> f64 {
    node.attribute(name).and_then(|v| v.parse().ok()).expect("the attribute is a number")
}

/// Parses the picture and checks what has to hold for all of them.
pub fn check(svg: &str) {
    let document = Document::parse(svg).expect("the renderer writes XML");
    let root = document.root_element();
    assert_eq!(root.attribute("role"), Some("img"));
    let (w, h) = (number(&root, "width"), number(&root, "height"));
    assert!(w > 0.0 && h > 0.0);
    assert!(root.children().any(|n| n.has_tag_name("title")));
    assert!(root.children().any(|n| n.has_tag_name("desc")));
    for node in document.descendants().filter(|n| n.has_tag_name("text")) {
        let (x, y) = (number(&node, "x"), number(&node, "y"));
        assert!((0.0..=w).contains(&x) && (0.0..=h).contains(&y), "{node:?}");
        if node.attribute("transform").is_some() {
            continue;
        }
        // No font of the family list is narrower on average.
        let letters = node.text().map_or(0, |t| t.chars().count());
        let long = 0.4 * number(&node, "font-size") * letters as f64;
        let from = match node.attribute("text-anchor") {
            Some("middle") => x - 0.5 * long,
            Some("end") => x - long,
            _ => x,
        };
        assert!(from >= 0.0 && from + long <= w, "{node:?} is cut off");
    }
    for node in document.descendants().filter(|n| n.has_tag_name("rect")) {
        assert!(node.attribute("width").is_none_or(|v| !v.starts_with('-')));
        assert!(node.attribute("height").is_none_or(|v| !v.starts_with('-')));
    }
    assert!(!svg.contains("NaN") && !svg.contains("inf"));
    assert!(document.descendants().all(|n| n.attribute("id").is_none()));
}

#[test]
fn texts_are_escaped() {
    let nasty = "a<b> & \"c\" 'd' ]]> \u{1}";
    let mut f = figure(vec![panel(
        Axis::linear(nasty, nasty),
        Axis::categorical(nasty, [nasty]),
        vec![Series::new(nasty, Style::Line, vec![1.0], vec![0.0])],
    )]);
    (f.id, f.title, f.caption) = (nasty.into(), nasty.into(), nasty.into());
    f.panels[0].title = nasty.into();
    let svg = render_svg(&f);
    let document = Document::parse(&svg).expect("the renderer writes XML");
    let shown = nasty.replace('\u{1}', "\u{fffd}");
    let root = document.root_element();
    assert_eq!(root.attribute("data-figure"), Some(shown.as_str()));
    let desc = root.children().find(|n| n.has_tag_name("desc"));
    assert_eq!(desc.and_then(|n| n.text()), Some(shown.as_str()));
    assert!(texts(&svg).iter().filter(|t| t.starts_with("a<b> & ")).count() >= 4);
}

#[test]
fn lost_values_are_counted_in_a_note() {
    let series = Series::new("s", Style::Line, vec![1.0, 2.0, 3.0, 4.0, 5.0], vec![1.0, 0.0, f64::NAN, 10.0, 20.0]);
    let svg = render_svg(&figure(vec![panel(Axis::linear("x", ""), Axis::log("y", ""), vec![series.clone()])]));
    assert!(texts(&svg).contains(&"2 values not drawn".to_owned()));
    let svg = render_svg(&figure(vec![panel(
        Axis::linear("x", "").with_range(0.0, 4.5),
        Axis::linear("y", ""),
        vec![series],
    )]));
    let shown = texts(&svg);
    assert!(shown.contains(&"1 value not drawn".to_owned()));
    assert!(shown.contains(&"1 value beyond the axes".to_owned()));
}

#[test]
fn complete_data_has_no_note() {
    let svg = render_svg(&figure(vec![panel(
        Axis::linear("x", ""),
        Axis::linear("y", ""),
        vec![Series::new("s", Style::Points, vec![1.0, 2.0], vec![0.0, -3.0])],
    )]));
    assert!(!svg.contains("not drawn") && !svg.contains("beyond"));
}

#[test]
fn empty_input_is_drawn_as_such() {
    let none = figure(vec![]);
    let bare = figure(vec![panel(Axis::default(), Axis::default(), vec![])]);
    let hollow = figure(vec![
        panel(
            Axis::categorical("", ["a"]),
            Axis::log("", ""),
            STYLES.iter().map(|s| Series::new("", *s, vec![], vec![])).collect(),
        );
        3
    ]);
    for f in [none, bare, hollow] {
        let svg = render_svg(&f);
        check(&svg);
        assert!(texts(&svg).contains(&"no data".to_owned()));
    }
}

#[test]
fn a_single_value_is_enough_for_every_style_and_scale() {
    for style in STYLES {
        for value in [0.0, 1.0, -7.0, 1e-300, 1e300, 5e-324] {
            for y in [Axis::linear("y", ""), Axis::log("y", "")] {
                let series = Series::new("s", style, vec![value], vec![value]);
                let mut p = panel(Axis::linear("x", ""), y, vec![series]);
                p.equal_aspect = true;
                check(&render_svg(&figure(vec![p])));
            }
        }
    }
}

#[test]
fn log_axes_label_decades_and_short_ones_also_two_and_five() {
    let draw = |values: Vec<f64>| {
        texts(&render_svg(&figure(vec![panel(
            Axis::linear("x", "").with_range(0.0, 0.1),
            Axis::log("y", ""),
            vec![Series::new("s", Style::Outline, vec![0.05; 2], values)],
        )])))
    };
    let long = draw(vec![0.05, 2000.0]);
    for label in ["0.1", "1", "10", "100", "1000"] {
        assert!(long.iter().any(|t| t == label), "{label} in {long:?}");
    }
    assert!(!long.iter().any(|t| t == "20" || t == "50"));
    let short = draw(vec![2e4, 9e4]);
    for label in ["2×104", "5×104", "105"] {
        assert!(short.iter().any(|t| t == label), "{label} in {short:?}");
    }
}

#[test]
fn a_label_has_one_colour_everywhere_and_one_legend_entry() {
    let with = |others: &[&str]| {
        let series = |l: &str| Series::new(l, Style::Points, vec![1.0], vec![1.0]);
        let mut all: Vec<Series> = others.iter().map(|l| series(l)).collect();
        all.push(series("Group 3 (novel)"));
        panel(Axis::linear("x", ""), Axis::linear("y", ""), all)
    };
    let panels = vec![with(&[]), with(&["Group 1", "scaled"]), with(&["other"])];
    let colour = series_colour("Group 3 (novel)");
    let svg = render_svg(&figure(panels));
    // One marker in each of three panels and one in the legend.
    assert_eq!(svg.matches(&format!("fill=\"{colour}\"")).count(), 4);
    let entries = texts(&svg);
    assert_eq!(entries.iter().filter(|t| *t == "Group 3 (novel)").count(), 1);
}

#[test]
fn a_landmark_looks_like_no_data() {
    // More postures than there are colours, so that every one of them is used.
    let mut series: Vec<Series> = (1..=9)
        .map(|p| {
            let at = f64::from(p);
            let x = vec![0.0, at];
            Series::new(format!("Posture {p}"), Style::Path, x, vec![0.0, 1.0])
        })
        .collect();
    let data = render_svg(&figure(vec![panel(Axis::linear("x", "m"), Axis::linear("z", "m"), series.clone())]));
    series.push(Series::new("rope anchor", Style::Landmark, vec![5.0], vec![0.5]));
    let both = render_svg(&figure(vec![panel(Axis::linear("x", "m"), Axis::linear("z", "m"), series)]));
    check(&both);
    let strokes = |svg: &str| -> Vec<String> {
        let document = Document::parse(svg).unwrap();
        let nodes = document.descendants();
        let strokes = nodes.filter_map(|n| n.attribute("stroke").map(str::to_owned));
        strokes.collect()
    };
    let used = strokes(&data);
    let landmark: Vec<String> = strokes(&both).into_iter().filter(|s| !used.contains(s)).collect();
    // Square and cross, in the panel and in the legend.
    assert_eq!(landmark, vec!["#4a4a4a"; 4]);
    assert!(!data.contains("#4a4a4a"));
}

#[test]
fn the_legend_shows_every_label_once_even_if_there_are_many() {
    let labels: Vec<String> = (0..23).map(|i| format!("series number {i}")).collect();
    let series = labels.iter().map(|l| Series::new(l, Style::Line, vec![0.0, 1.0], vec![1.0, 2.0])).collect();
    let svg = render_svg(&figure(vec![panel(Axis::linear("x", ""), Axis::linear("y", ""), series)]));
    check(&svg);
    let shown = texts(&svg);
    for label in &labels {
        assert_eq!(shown.iter().filter(|t| *t == label).count(), 1);
    }
}

#[test]
fn bands_are_areas_and_strokes_are_pieces() {
    let band = Series::new("band", Style::Band, vec![0.0, 1.0, 2.0], vec![1.0, 2.0, 1.0]).with_error(vec![0.5; 3]);
    let strokes = Series::new("strokes", Style::Strokes, vec![0.0, 0.5, 1.0, 1.5], vec![1.0, 1.2, 1.0, 1.2]);
    let panel = panel(Axis::linear("x", ""), Axis::linear("y", ""), vec![band, strokes]);
    let svg = render_svg(&figure(vec![panel]));
    check(&svg);
    let document = Document::parse(&svg).unwrap();
    let path = |wanted: &dyn Fn(&Node) -> bool| {
        let mut paths = document.descendants().filter(|n| n.has_tag_name("path") && wanted(n));
        paths.next().unwrap().attribute("d").unwrap().to_string()
    };
    let area = path(&|n| n.attribute("fill-opacity").is_some());
    assert_eq!((area.matches('L').count(), area.matches('M').count()), (5, 1));
    let pieces = path(&|n| n.attribute("stroke-width") == Some("1.2"));
    assert_eq!((pieces.matches('L').count(), pieces.matches('M').count()), (2, 2));
    // The axis has room for the whole band.
    assert!(!texts(&svg).iter().any(|t| t.contains("beyond")));
}
