//! Properties every rendered figure has, whatever its data.

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
    Panel {
        title: "panel".into(),
        x,
        y,
        series,
        equal_aspect: false,
    }
}

fn figure(panels: Vec<Panel>) -> Figure {
    Figure {
        id: "test".into(),
        title: "figure".into(),
        caption: "caption".into(),
        columns: 2,
        panels,
    }
}

fn texts(svg: &str) -> Vec<String> {
    let document = Document::parse(svg).expect("the renderer writes XML");
    document
        .descendants()
        .filter(|n| n.has_tag_name("text"))
        .map(|n| {
            n.descendants()
                .filter_map(|t| t.text().filter(|_| t.is_text()))
                .collect()
        })
        .collect()
}

fn number(node: &Node, name: &str) -> f64 {
    node.attribute(name)
        .and_then(|v| v.parse().ok())
        .expect("the attribute is a number")
}

/// Parses the picture and checks what has to hold for all of them.
fn check(svg: &str) {
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
fn equal_figures_give_equal_bytes() {
    let make = || {
        figure(vec![panel(
            Axis::categorical("joint", ["1", "2"]),
            Axis::log("deviation", "%"),
            STYLES
                .iter()
                .map(|s| Series::new("Group 1", *s, vec![0.0, 1.0], vec![3.0, 40.0]))
                .collect(),
        )])
    };
    let svg = render_svg(&make());
    assert_eq!(svg, render_svg(&make()));
    check(&svg);
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
    assert!(
        texts(&svg)
            .iter()
            .filter(|t| t.starts_with("a<b> & "))
            .count()
            >= 4
    );
}

#[test]
fn lost_values_are_counted_in_a_note() {
    let series = Series::new(
        "s",
        Style::Line,
        vec![1.0, 2.0, 3.0, 4.0, 5.0],
        vec![1.0, 0.0, f64::NAN, 10.0, 20.0],
    );
    let svg = render_svg(&figure(vec![panel(
        Axis::linear("x", ""),
        Axis::log("y", ""),
        vec![series.clone()],
    )]));
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
        vec![Series::new(
            "s",
            Style::Points,
            vec![1.0, 2.0],
            vec![0.0, -3.0],
        )],
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
            STYLES
                .iter()
                .map(|s| Series::new("", *s, vec![], vec![]))
                .collect(),
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
    assert_eq!(
        entries.iter().filter(|t| *t == "Group 3 (novel)").count(),
        1
    );
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
    let data = render_svg(&figure(vec![panel(
        Axis::linear("x", "m"),
        Axis::linear("z", "m"),
        series.clone(),
    )]));
    series.push(Series::new(
        "rope anchor",
        Style::Landmark,
        vec![5.0],
        vec![0.5],
    ));
    let both = render_svg(&figure(vec![panel(
        Axis::linear("x", "m"),
        Axis::linear("z", "m"),
        series,
    )]));
    check(&both);
    let strokes = |svg: &str| -> Vec<String> {
        let document = Document::parse(svg).unwrap();
        let nodes = document.descendants();
        let strokes = nodes.filter_map(|n| n.attribute("stroke").map(str::to_owned));
        strokes.collect()
    };
    let used = strokes(&data);
    let own: Vec<String> = strokes(&both)
        .into_iter()
        .filter(|s| !used.contains(s))
        .collect();
    // Square and cross, in the panel and in the legend.
    assert_eq!(own, vec!["#4a4a4a"; 4]);
    assert!(!data.contains("#4a4a4a"));
}

#[test]
fn the_legend_shows_every_label_once_even_if_there_are_many() {
    let labels: Vec<String> = (0..23).map(|i| format!("series number {i}")).collect();
    let series = labels
        .iter()
        .map(|l| Series::new(l, Style::Line, vec![0.0, 1.0], vec![1.0, 2.0]))
        .collect();
    let svg = render_svg(&figure(vec![panel(
        Axis::linear("x", ""),
        Axis::linear("y", ""),
        series,
    )]));
    check(&svg);
    let shown = texts(&svg);
    for label in &labels {
        assert_eq!(shown.iter().filter(|t| *t == label).count(), 1);
    }
}

/// A map of `columns` × `rows` cells, one unit each, from (0, 0).
fn map(columns: usize, rows: usize, axis: Axis, value: impl Fn(usize, usize) -> f64) -> Panel {
    let places = || (0..rows).flat_map(|r| (0..columns).map(move |c| (c, r)));
    let series = Series::new(
        "no value",
        Style::Map,
        places().map(|(c, _)| c as f64).collect(),
        places().map(|(_, r)| r as f64).collect(),
    );
    let values = places().map(|(c, r)| value(c, r)).collect();
    panel(
        Axis::linear("x", "deg").with_range(-0.5, columns as f64 - 0.5),
        Axis::linear("y", "deg").with_range(-0.5, rows as f64 - 0.5),
        vec![series.with_colour(axis, values)],
    )
}

/// Rectangles of one element, as (left, top, right, bottom).
fn rectangles(node: &Node) -> Vec<[f64; 4]> {
    let data = node.attribute("d").unwrap();
    let shape = |part: &str| {
        let part = part.replace(['H', 'V'], " ");
        let v: Vec<f64> = part
            .split_whitespace()
            .map(|v| v.parse().unwrap())
            .collect();
        assert_eq!((v.len(), v[4]), (5, v[0]), "{data}");
        [v[0], v[1], v[2], v[3]]
    };
    data.split('M')
        .skip(1)
        .map(|p| shape(p.trim_end_matches('Z')))
        .collect()
}

#[test]
fn a_map_covers_its_panel_with_cells_of_equal_size() {
    // Two bands of one colour each, and one cell without a value.
    let panel = map(8, 5, Axis::linear("value", "mm"), |c, r| match (c, r) {
        (3, 1) => f64::NAN,
        (_, 0..=2) => 1.0,
        _ => 2.0,
    });
    let svg = render_svg(&figure(vec![panel]));
    check(&svg);
    let document = Document::parse(&svg).unwrap();
    let cells: Vec<Node> = document
        .descendants()
        .filter(|n| n.attribute("shape-rendering").is_some())
        .collect();
    // The colour bar has 64 levels, the map three looks, the legend one.
    assert_eq!(cells.len(), 64 + 3 + 1);
    let area = |r: &[f64; 4]| (r[2] - r[0]) * (r[3] - r[1]);
    let looks: Vec<Vec<[f64; 4]>> = cells[..3].iter().map(rectangles).collect();
    let sizes: Vec<f64> = looks.iter().map(|l| l.iter().map(area).sum()).collect();
    let total: f64 = sizes.iter().sum();
    let mut shares: Vec<f64> = sizes.iter().map(|s| 40.0 * s / total).collect();
    shares.sort_by(f64::total_cmp);
    for (found, expected) in shares.iter().zip([1.0, 16.0, 23.0]) {
        assert!((found - expected).abs() < 0.05, "{shares:?}");
    }
    // Cells of one colour in a row are one rectangle: 2 whole rows of 1, the row with the gap as 2.
    let mut counts: Vec<usize> = looks.iter().map(Vec::len).collect();
    counts.sort_unstable();
    assert_eq!(counts, [1, 2, 4]);
    // Low values are dark, and at the bottom of the bar.
    let fill = |node: &Node| {
        let fill = node.attribute("fill").unwrap();
        u32::from_str_radix(&fill[3..5], 16).unwrap()
    };
    let bar = &cells[3..67];
    assert!(fill(&bar[0]) < 10 && fill(&bar[63]) > 220);
    assert!(rectangles(&bar[0])[0][1] > rectangles(&bar[63])[0][1]);
    let shown = texts(&svg);
    assert!(shown.contains(&"value [mm]".to_owned()));
    assert!(shown.contains(&"no value".to_owned()));
    assert!(!svg.contains("not drawn"));
}

#[test]
fn small_values_are_bright_where_asked_for() {
    let axis = Axis::linear("value", "mm").with_range(0.0, 1.0);
    let mut panel = map(2, 1, axis, |c, _| c as f64);
    let series = panel.series.remove(0);
    panel.series.push(series.with_small_bright(true));
    let svg = render_svg(&figure(vec![panel]));
    check(&svg);
    let document = Document::parse(&svg).unwrap();
    let cells: Vec<Node> = document
        .descendants()
        .filter(|n| n.attribute("shape-rendering").is_some())
        .collect();
    let (bar, legend) = cells[2..].split_at(64);
    assert_eq!(legend.len(), 1);
    let left = |n: &&Node| rectangles(n)[0][0];
    let mut places: Vec<&Node> = cells[..2].iter().collect();
    places.sort_by(|a, b| left(a).total_cmp(&left(b)));
    // The smaller value lies on the left and has the colour of the bar's lower end.
    let fill = |n: &Node| n.attribute("fill").unwrap().to_owned();
    let [low, high] = [&bar[0], &bar[63]].map(fill);
    assert_eq!(
        [places[0], places[1]].map(fill),
        [low.clone(), high.clone()]
    );
    let green = |colour: &str| u32::from_str_radix(&colour[3..5], 16).unwrap();
    assert!(green(&low) > 220 && green(&high) < 10);
}

#[test]
fn the_colour_bar_follows_the_axis_and_has_room() {
    let value = |c: usize, _| 10f64.powi(c as i32);
    let log = map(4, 2, Axis::log("deviation", "%"), value);
    let svg = render_svg(&figure(vec![log.clone(), log.clone(), log]));
    check(&svg);
    let shown = texts(&svg);
    for label in ["1", "10", "100", "1000"] {
        assert!(shown.iter().any(|t| t == label), "{label} in {shown:?}");
    }
    // Equal ratios are equal steps of colour: four columns, four looks.
    let document = Document::parse(&svg).unwrap();
    let fills: std::collections::BTreeSet<&str> = document
        .descendants()
        .filter(|n| n.attribute("shape-rendering").is_some())
        .take(4)
        .filter_map(|n| n.attribute("fill"))
        .collect();
    assert_eq!(fills.len(), 4);
    // Bars of one row lie between the plot areas, not on them.
    let frames: Vec<[f64; 2]> = document
        .descendants()
        .filter(|n| n.has_tag_name("rect") && n.attribute("stroke") == Some("#555555"))
        .map(|n| [number(&n, "x"), number(&n, "x") + number(&n, "width")])
        .collect();
    assert_eq!(frames.len(), 6);
    for row in [&frames[0..4], &frames[4..6]] {
        assert!(
            row.windows(2).all(|pair| pair[0][1] < pair[1][0]),
            "{frames:?}"
        );
    }
}

#[test]
fn maps_of_a_panel_share_a_grid_and_look_different_where_they_miss() {
    // Values on the left, two kinds of missing cells on the right.
    let mut panel = map(2, 4, Axis::linear("v", ""), |c, r| (c + 2 * r) as f64);
    panel.series[0].label = String::new();
    panel.x = Axis::linear("x", "deg").with_range(-0.5, 3.5);
    let column = |label: &str, at: f64| {
        let y: Vec<f64> = (0..4).map(f64::from).collect();
        Series::new(label, Style::Map, vec![at; 4], y)
    };
    panel.series.push(column("forbidden", 2.0));
    panel.series.push(column("unreachable", 3.0));
    let svg = render_svg(&figure(vec![panel]));
    check(&svg);
    let document = Document::parse(&svg).unwrap();
    let cells: Vec<(Node, [f64; 4])> = document
        .descendants()
        .filter(|n| n.attribute("shape-rendering").is_some())
        .flat_map(|n| rectangles(&n).into_iter().map(move |r| (n, r)))
        .collect();
    let fill = |n: &Node| n.attribute("fill").unwrap().to_string();
    let of = |colour: &str| cells.iter().filter(|(n, _)| fill(n) == colour).count();
    // Four cells each, and the sample in the legend.
    assert_eq!((of("#e2e2e2"), of("#f1f1f1")), (5, 5));
    // All cells of the grid are of one width, those without a value too.
    let widths: Vec<f64> = cells
        .iter()
        .filter(|(n, _)| ["#e2e2e2", "#f1f1f1"].contains(&fill(n).as_str()))
        .take(4)
        .map(|(_, [left, _, right, _])| right - left)
        .collect();
    let plot = document
        .descendants()
        .find(|n| n.has_tag_name("rect") && n.attribute("fill") == Some("none"))
        .unwrap();
    let expected = number(&plot, "width") / 4.0;
    assert!(
        widths.iter().all(|w| (w - expected).abs() < 0.05),
        "{widths:?} {expected}"
    );
}

#[test]
fn bands_are_areas_and_strokes_are_pieces() {
    let band = Series::new(
        "band",
        Style::Band,
        vec![0.0, 1.0, 2.0],
        vec![1.0, 2.0, 1.0],
    )
    .with_error(vec![0.5; 3]);
    let strokes = Series::new(
        "strokes",
        Style::Strokes,
        vec![0.0, 0.5, 1.0, 1.5],
        vec![1.0, 1.2, 1.0, 1.2],
    );
    let panel = panel(
        Axis::linear("x", ""),
        Axis::linear("y", ""),
        vec![band, strokes],
    );
    let svg = render_svg(&figure(vec![panel]));
    check(&svg);
    let document = Document::parse(&svg).unwrap();
    let path = |wanted: &dyn Fn(&Node) -> bool| {
        let mut found = document
            .descendants()
            .filter(|n| n.has_tag_name("path") && wanted(n));
        found.next().unwrap().attribute("d").unwrap().to_string()
    };
    let area = path(&|n| n.attribute("fill-opacity").is_some());
    assert_eq!(
        (area.matches('L').count(), area.matches('M').count()),
        (5, 1)
    );
    let pieces = path(&|n| n.attribute("stroke-width") == Some("1.2"));
    assert_eq!(
        (pieces.matches('L').count(), pieces.matches('M').count()),
        (2, 2)
    );
    // The axis has room for the whole band.
    assert!(!texts(&svg).iter().any(|t| t.contains("beyond")));
}

#[test]
fn a_map_without_values_is_all_missing_and_has_no_bar() {
    let mut empty = map(3, 3, Axis::default(), |_, _| 0.0);
    empty.series[0].colour = None;
    let svg = render_svg(&figure(vec![empty]));
    check(&svg);
    assert!(svg.contains("#e2e2e2") && !svg.contains("#fde725"));
}

/// Any bit pattern, and ordinary values often enough to reach the drawing.
fn value() -> impl Strategy<Value = f64> {
    prop_oneof![
        any::<u64>().prop_map(f64::from_bits),
        -10.0..10.0_f64,
        (0..6_u8).prop_map(f64::from),
    ]
}

fn axis() -> impl Strategy<Value = Axis> {
    (
        any::<bool>(),
        0..5_usize,
        option::of([value(), value()]),
        any::<bool>(),
        any::<bool>(),
    )
        .prop_map(|(log, categories, range, named, from_zero)| Axis {
            label: "quantity".into(),
            unit: "unit".into(),
            scale: if log { Scale::Log } else { Scale::Linear },
            categories: if named {
                (0..categories)
                    .map(|c| format!("place number {c}"))
                    .collect()
            } else {
                Vec::new()
            },
            range,
            from_zero,
        })
}

fn series() -> impl Strategy<Value = Series> {
    (
        0..STYLES.len(),
        0..4_u8,
        vec(value(), 0..12),
        vec(value(), 0..12),
        vec(value(), 0..12),
        option::of((axis(), vec(value(), 0..12))),
    )
        .prop_map(|(style, label, x, y, error, colour)| {
            let series =
                Series::new(format!("label {label}"), STYLES[style], x, y).with_error(error);
            match colour {
                Some((axis, values)) => series.with_colour(axis, values),
                None => series,
            }
        })
}

fn any_figure() -> impl Strategy<Value = Figure> {
    let panels = (axis(), axis(), vec(series(), 0..5), any::<bool>()).prop_map(
        |(x, y, series, equal_aspect)| Panel {
            title: "a title".into(),
            x,
            y,
            series,
            equal_aspect,
        },
    );
    (any::<usize>(), 0..5_usize, vec(panels, 0..5)).prop_map(|(wild, tame, panels)| Figure {
        columns: if wild % 2 == 0 { wild } else { tame },
        ..figure(panels)
    })
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 400,
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn any_values_give_a_sound_picture(f in any_figure()) {
        check(&render_svg(&f));
    }

    #[test]
    fn any_texts_give_a_sound_picture(texts in vec(any::<String>(), 8)) {
        let mut p = panel(
            Axis::categorical(&texts[0], [&texts[1], &texts[2]]),
            Axis::linear(&texts[3], &texts[4]),
            vec![Series::new(&texts[5], Style::Line, vec![0.0, 1.0], vec![1.0, 2.0])],
        );
        p.title.clone_from(&texts[6]);
        let mut f = figure(vec![p]);
        f.title.clone_from(&texts[7]);
        f.id.clone_from(&texts[7]);
        f.caption.clone_from(&texts[7]);
        let svg = render_svg(&f);
        prop_assert!(Document::parse(&svg).is_ok());
        prop_assert!(series_colour(&texts[5]).starts_with('#'));
    }
}
