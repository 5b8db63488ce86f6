//! A map in a panel covers it with cells of equal size, coloured by their values.

use super::*;

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
        let v: Vec<f64> = part.split_whitespace().map(|v| v.parse().unwrap()).collect();
        assert_eq!((v.len(), v[4]), (5, v[0]), "{data}");
        [v[0], v[1], v[2], v[3]]
    };
    data.split('M').skip(1).map(|p| shape(p.trim_end_matches('Z'))).collect()
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
    let cells: Vec<Node> = document.descendants().filter(|n| n.attribute("shape-rendering").is_some()).collect();
    // The colour bar has 64 levels, the map three looks, the legend one.
    assert_eq!(cells.len(), 64 + 3 + 1);
    let area = |r: &[f64; 4]| (r[2] - r[0]) * (r[3] - r[1]);
    let looks: Vec<Vec<[f64; 4]>> = cells[..3].iter().map(rectangles).collect();
    let sizes: Vec<f64> = looks.iter().map(|l| l.iter().map(area).sum()).collect();
    let total: f64 = sizes.iter().sum();
    let mut shares: Vec<f64> = sizes.iter().map(|s| 40.0 * s / total).collect();
    shares.sort_by(f64::total_cmp);
    for (share, expected) in shares.iter().zip([1.0, 16.0, 23.0]) {
        assert!((share - expected).abs() < 0.05, "{shares:?}");
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
        assert!(row.windows(2).all(|pair| pair[0][1] < pair[1][0]), "{frames:?}");
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
    let plot = document.descendants().find(|n| n.has_tag_name("rect") && n.attribute("fill") == Some("none")).unwrap();
    let expected = number(&plot, "width") / 4.0;
    assert!(widths.iter().all(|w| (w - expected).abs() < 0.05), "{widths:?} {expected}");
}

#[test]
fn a_map_without_values_is_all_missing_and_has_no_bar() {
    let mut empty = map(3, 3, Axis::default(), |_, _| 0.0);
    empty.series[0].colour = None;
    let svg = render_svg(&figure(vec![empty]));
    check(&svg);
    assert!(svg.contains("#e2e2e2") && !svg.contains("#fde725"));
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
    let cells: Vec<Node> = document.descendants().filter(|n| n.attribute("shape-rendering").is_some()).collect();
    let (bar, legend) = cells[2..].split_at(64);
    // A map that has a value everywhere needs no entry for cells without one.
    assert!(legend.is_empty());
    assert!(!texts(&svg).contains(&"map".to_owned()));
    let left = |n: &&Node| rectangles(n)[0][0];
    let mut places: Vec<&Node> = cells[..2].iter().collect();
    places.sort_by(|a, b| left(a).total_cmp(&left(b)));
    // The smaller value lies on the left and has the colour of the bar's lower end.
    let fill = |n: &Node| n.attribute("fill").unwrap().to_owned();
    let [low, high] = [&bar[0], &bar[63]].map(fill);
    assert_eq!([places[0], places[1]].map(fill), [low.clone(), high.clone()]);
    let green = |colour: &str| u32::from_str_radix(&colour[3..5], 16).unwrap();
    assert!(green(&low) > 220 && green(&high) < 10);
}
