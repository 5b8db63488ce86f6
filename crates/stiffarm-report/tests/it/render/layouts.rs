//! A picture has the layout of its medium: sizes on paper, what can be clicked on a screen.

use super::{number, panel, texts};
use roxmltree::{Document, Node};
use stiffarm_report::figure::drawing::{Drawing, KeyEntry, Note, Sample, Tone, View};
use stiffarm_report::{Axis, Figure, Layout, Series, Style, render_drawing, render_drawing_with, render_svg_with};

/// A drawing with two views that have axes and one without, and this many numbered things.
fn drawing(items: usize) -> Drawing {
    let view = |title: &str, has_axes: bool| View {
        title: title.into(),
        axes: has_axes.then(|| [Axis::linear("x", "mm"), Axis::linear("z", "mm")]),
        extent: [[0.0, 1000.0], [0.0, 3000.0]],
        marks: Vec::new(),
        labels: Vec::new(),
    };
    Drawing {
        id: "cell".into(),
        title: "a cell".into(),
        caption: "what it shows".into(),
        notes: vec![Note::plain("Least room 0.0 mm."), Note::caution("Too near.")],
        views: vec![view("from the side", true), view("from above", true), view("in perspective", false)],
        key: (0..items)
            .map(|i| KeyEntry {
                label: format!("posture {i}"),
                sample: Sample::LineAndPoint,
                tone: Tone::Item(i),
                caution: false,
            })
            .collect(),
    }
}

fn height_mm(svg: &str) -> f64 {
    let document = Document::parse(svg).unwrap();
    let height = document.root_element().attribute("height").unwrap();
    height.strip_suffix("mm").unwrap().parse().unwrap()
}

#[test]
fn a_drawing_for_a_paper_fits_on_its_page() {
    for width in [60.0, 88.0, 120.0, 150.0, 180.0, 250.0] {
        let svg = render_drawing_with(&drawing(6), &Layout::paper(width, 8.0));
        assert!(height_mm(&svg) <= 220.0, "{} at {width}", height_mm(&svg));
    }
    // What has axes is never left out.
    let narrow = texts(&render_drawing_with(&drawing(6), &Layout::paper(88.0, 8.0)));
    assert!(narrow.contains(&"from the side".into()) && narrow.contains(&"from above".into()));
    assert!(!narrow.contains(&"in perspective".into()));
    let wide = texts(&render_drawing_with(&drawing(6), &Layout::paper(180.0, 8.0)));
    assert!(wide.contains(&"in perspective".into()));
    // A screen is scrolled.
    let screen = texts(&render_drawing_with(&drawing(6), &Layout::screen(360.0, 11.0)));
    assert!(screen.contains(&"in perspective".into()));
}

#[test]
fn notes_go_with_the_title() {
    let paper = Layout::paper(180.0, 8.0);
    let has = |svg: &str, words: &str| texts(svg).iter().any(|t| t == words);
    let svg = render_drawing_with(&drawing(2), &paper);
    assert!(!has(&svg, "Least room 0.0 mm.") && !has(&svg, "Too near."));
    assert!(has(&svg, "posture 1"));
    let slide = render_drawing_with(&drawing(2), &paper.with_title(true));
    assert!(has(&slide, "Least room 0.0 mm.") && has(&slide, "Too near."));
    assert!(has(&render_drawing(&drawing(2)), "Too near."));
}

#[test]
fn all_of_a_legend_entry_answers_a_click() {
    let series = |label: &str| Series::new(label, Style::Line, vec![0.0, 1.0], vec![0.0, 1.0]);
    let long = "a series with a name that needs more than one line of a narrow picture";
    let axis = || Axis::linear("x", "");
    let figure = Figure {
        id: "test".into(),
        title: String::new(),
        caption: String::new(),
        columns: 1,
        panels: vec![panel(axis(), axis(), vec![series("Group 1"), series(long)])],
    };
    let svg = render_svg_with(&figure, &Layout::screen(360.0, 12.0));
    let document = Document::parse(&svg).unwrap();
    let mut nodes = document.descendants();
    let entries = nodes.by_ref().filter(|n| n.has_attribute("data-toggle-series"));
    let entries: Vec<Node> = entries.collect();
    assert_eq!(entries.len(), 2);
    for entry in entries {
        let rects = entry.children().filter(|n| n.attribute("fill-opacity") == Some("0"));
        let rects: Vec<Node> = rects.collect();
        assert_eq!(rects.len(), 1);
        // Nothing lies over it, and it begins before the sample and ends behind every line.
        assert_eq!(entry.children().rfind(Node::is_element), Some(rects[0]));
        let [x, y, w, h] = ["x", "y", "width", "height"].map(|name| number(&rects[0], name));
        let lines: Vec<Node> = entry.children().filter(|n| n.has_tag_name("text")).collect();
        for line in lines {
            let (left, base) = (number(&line, "x"), number(&line, "y"));
            assert!(x + 30.0 < left && left < x + w);
            assert!((y..=y + h).contains(&base), "{base} in {y} {h}");
        }
    }
    // Paper has nothing to click on.
    assert!(!render_svg_with(&figure, &Layout::paper(88.0, 8.0)).contains("fill-opacity=\"0\""));
}
