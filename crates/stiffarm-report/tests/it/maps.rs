//! Stiffness maps, places of a workpiece and paths: every node and point of the result is in figure and table.

use nalgebra::{Isometry3, Translation3, UnitQuaternion, UnitVector3, Vector3};
use roxmltree::Document;
use stiffarm::Control;
use stiffarm::estimate::compliance::IdentifiedCompliance;
use stiffarm::model::cell::Cell;
use stiffarm::model::load::Wrench;
use stiffarm::model::path::{PathPoint, PathTarget};
use stiffarm::model::process::{ForceAxes, TipLoad};
use stiffarm::plan::zones::{ZoneOptions, zones};
use stiffarm::work::map::{MapOptions, PlaceOptions, Status, StiffnessMap, place, stiffness_map};
use stiffarm_files::builtin;
use stiffarm_report::{
    Figure, PathCurvePoint, Style, map_figure, map_table, path_figure, placement_figure, placement_table, render_svg,
    series_colour, zones_figure,
};

fn cell() -> (Cell, IdentifiedCompliance) {
    let cell = builtin::cell("comau").unwrap();
    let prior = IdentifiedCompliance::from_stiffness(&cell, cell.prior.as_ref().unwrap()).unwrap();
    (cell, prior)
}

fn down() -> UnitQuaternion<f64> {
    UnitQuaternion::from_euler_angles(std::f64::consts::PI, 0.0, 0.0)
}

fn map(steps: [usize; 3]) -> StiffnessMap {
    let (cell, prior) = cell();
    let options = {
        let mut options = MapOptions::new([0.9, -1.9, 0.6], [3.1, 1.9, 2.4], steps);
        options.rotation = down();
        options.free_turn = None;
        options.direction = UnitVector3::new_normalize(Vector3::z());
        options.wrench = Wrench::force(Vector3::new(0.0, 0.0, 100.0));
        options
    };
    stiffness_map(&cell, &prior, &options, Control::default()).unwrap()
}

/// Panels, with the number of nodes and of values of each.
fn cells(figure: &Figure) -> Vec<(usize, usize)> {
    let panel = |panel: &stiffarm_report::Panel| {
        let maps = panel.series.iter().filter(|s| s.style == Style::Map);
        let nodes = maps.clone().map(|s| s.x.len()).sum();
        let values = maps.filter_map(|s| s.colour.as_ref()).map(|c| c.values.len()).sum();
        (nodes, values)
    };
    figure.panels.iter().map(panel).collect()
}

/// Whether small values are bright, for each panel.
fn small_is_bright(figure: &Figure) -> Vec<bool> {
    let maps = figure.panels.iter().filter_map(|p| p.series[0].colour.as_ref());
    maps.map(|colour| colour.small_is_bright).collect()
}

fn check(figure: &Figure) {
    let svg = render_svg(figure);
    assert!(Document::parse(&svg).is_ok());
    for never in ["NaN", "not drawn", "beyond the axes"] {
        assert!(!svg.contains(never), "{never} in {svg}");
    }
}

#[test]
fn a_plane_is_three_maps_with_every_node() {
    for steps in [[9, 13, 1], [1, 9, 7], [8, 1, 6]] {
        let map = map(steps);
        let figure = map_figure(&map);
        check(&figure);
        assert_eq!(cells(&figure), vec![(map.nodes.len(), map.counts.reachable); 3]);
        // The figure's values are the map's.
        let series = &figure.panels[0].series[0];
        let values = &series.colour.as_ref().unwrap().values;
        let [smallest, largest] = [f64::min, f64::max].map(|pick| values.iter().copied().fold(values[0], pick));
        let range = map.deflection_per_newton_m.unwrap();
        assert_eq!([smallest, largest], [range.smallest * 1e6, range.largest * 1e6]);
        // What bends least and what is stiffest have the same colour.
        assert_eq!(small_is_bright(&figure), [true, false, false]);
    }
}

#[test]
fn good_zones_have_the_same_colour_in_every_panel() {
    let (cell, _) = cell();
    let mut options = ZoneOptions::default();
    options.steps = 7;
    let figure = zones_figure(&zones(&cell, &options, stiffarm::Control::default()).unwrap());
    check(&figure);
    // Dexterity is good where it is large, the influence of K_C where it is small.
    assert_eq!(small_is_bright(&figure), [false, true, true]);
}

#[test]
fn strokes_lie_along_the_softest_direction() {
    let map = map([9, 13, 1]);
    let figure = map_figure(&map);
    let strokes = figure.panels[2].series.iter().find(|s| s.style == Style::Strokes).unwrap();
    let mut seen = 0;
    for node in map.nodes.iter().filter(|n| n.status == Status::Reachable) {
        let [x, y, _] = node.position_m.map(|p| 1e3 * p);
        let at = (0..strokes.x.len() / 2).find(|i| {
            let middle = |v: &[f64]| 0.5 * (v[2 * i] + v[2 * i + 1]);
            (middle(&strokes.x) - x).abs() < 1e-6 && (middle(&strokes.y) - y).abs() < 1e-6
        });
        let Some(i) = at else { continue };
        seen += 1;
        let stroke = [strokes.x[2 * i + 1] - strokes.x[2 * i], strokes.y[2 * i + 1] - strokes.y[2 * i]];
        let softest = node.values.as_ref().unwrap().softest.direction;
        let across = stroke[0] * softest[1] - stroke[1] * softest[0];
        assert!(across.abs() < 1e-6 && stroke[0].hypot(stroke[1]) > 0.0);
    }
    assert_eq!(seen, strokes.x.len() / 2);
    assert!(seen > 20);
}

#[test]
fn a_box_is_planes_with_one_colour_bar_and_a_line_is_curves() {
    let box_map = map([5, 6, 4]);
    let figure = map_figure(&box_map);
    check(&figure);
    assert_eq!(figure.panels.len(), 4);
    assert_eq!(figure.panels[0].title, "z = 600 mm");
    assert_eq!(cells(&figure).iter().map(|c| c.0).sum::<usize>(), box_map.nodes.len());
    let ranges = figure.panels.iter().map(|p| p.series[0].colour.as_ref().unwrap().axis.range);
    let ranges: Vec<_> = ranges.collect();
    assert_eq!(small_is_bright(&figure), [true; 4]);
    assert!(ranges[0].is_some() && ranges.iter().all(|r| *r == ranges[0]));
    // No more than nine planes, first and last among them.
    let many = map_figure(&map([12, 13, 11]));
    assert_eq!(many.panels.len(), 9);
    assert_eq!(many.panels[8].title, "z = 2400 mm");
    let along = map_figure(&map([30, 1, 1]));
    check(&along);
    assert_eq!(along.panels.len(), 3);
    assert_eq!(along.panels[0].x.heading(), "x [mm]");
    assert!(along.panels.iter().all(|p| p.y.from_zero));
    check(&map_figure(&map([1, 1, 1])));
}

#[test]
fn the_table_has_a_row_per_node() {
    let map = map([5, 4, 2]);
    let table = map_table(&map);
    let csv = table.csv();
    let lines: Vec<&str> = csv.lines().collect();
    assert_eq!(lines.len(), 41);
    let wide = lines[0].split(',').count();
    assert_eq!(wide, 16 + 6);
    assert!(lines[0].starts_with("x_mm,y_mm,z_mm,status,reason"));
    let reachable = lines.iter().filter(|line| line.split(',').nth(3) == Some("reachable")).count();
    assert_eq!(reachable, map.counts.reachable);
    assert!(lines[1].starts_with("900,-1900,600,") && lines[2].starts_with("900,-1900,2400,"));
}

#[test]
fn places_are_a_panel_per_turn_with_given_and_best() {
    let (mut cell, prior) = cell();
    cell.work.workpiece = Isometry3::translation(1.7, 0.5, 0.8);
    let points: Vec<PathPoint> = (0..10)
        .map(|i| {
            let local = Isometry3::from_parts(Translation3::new(0.03 * f64::from(i), 0.0, 0.0), down());
            PathPoint {
                feature: None,
                feed: None,
                rapid: false,
                name: i.to_string().into(),
                line: None,
                target: PathTarget::Pose(cell.work.workpiece * local),
                load: Some(TipLoad {
                    force: Vector3::new(0.0, 200.0, 50.0),
                    moment: Vector3::zeros(),
                    axes: ForceAxes::Path,
                }),
            }
        })
        .collect();
    let options = {
        let mut options = PlaceOptions::default();
        options.lower = [1.0, -1.0, 0.8];
        options.upper = [3.4, 1.0, 0.8];
        options.steps = [5, 4, 1];
        options.yaws = vec![0.0, 1.0];
        options.refinements = 1;
        options
    };
    let placement = place(&cell, &prior, &points, &options, Control::default()).unwrap();
    let figure = placement_figure(&placement);
    check(&figure);
    assert_eq!(cells(&figure).iter().map(|c| c.0).collect::<Vec<_>>(), [20, 20]);
    assert_eq!(small_is_bright(&figure), [true, true]);
    let marks = |label: &str| {
        let series = figure.panels.iter().flat_map(|p| &p.series);
        series.filter(|s| s.label == label).count()
    };
    assert_eq!((marks("given place"), marks("best place")), (1, 1));
    assert_eq!(placement_table(&placement).csv().lines().count(), placement.candidates.len() + 1);
    assert!(placement.candidates.len() > 40);
}

#[test]
fn a_path_keeps_its_extremes_when_it_is_thinned() {
    let mut points: Vec<PathCurvePoint> = (0..20_000)
        .map(|i| PathCurvePoint {
            along_m: 1e-4 * f64::from(i),
            deflection_m: 1e-4,
            half_width_m: Some(1e-5),
            left_m: Some(1e-6),
        })
        .collect();
    points[7_777].deflection_m = 5e-4;
    points[11_111].left_m = Some(1e-9);
    let figure = path_figure(&points, Some(0.95));
    check(&figure);
    assert_eq!(figure.panels.len(), 2);
    for panel in &figure.panels {
        assert!(panel.series.iter().all(|s| s.x.len() < 1000));
        assert!(panel.series.iter().any(|s| s.y.contains(&0.5)));
        let last = panel.series.iter().map(|s| s.x[s.x.len() - 1]);
        assert!(last.into_iter().all(|x| (x - 1999.9).abs() < 1e-9));
    }
    let left = &figure.panels[1].series[1];
    assert!(left.y.iter().any(|y| (y - 1e-6).abs() < 1e-18));
    let colours = figure.panels[1].series.iter().map(|s| series_colour(&s.label));
    let colours: Vec<_> = colours.collect();
    assert_ne!(colours[0], colours[1]);
    // The deflection begins at zero; a line is not called a band.
    assert!(figure.panels[0].y.from_zero);
    assert_eq!(figure.panels[0].x.heading(), "distance along the path [mm]");
    let labels: Vec<(Style, &str)> =
        figure.panels.iter().flat_map(|p| &p.series).map(|s| (s.style, s.label.as_str())).collect();
    assert_eq!(
        labels,
        [
            (Style::Band, "without compensation, its 95 % band"),
            (Style::Curve, "without compensation"),
            (Style::Curve, "without compensation"),
            (Style::Curve, "left after compensation, upper end of its 95 % band"),
        ]
    );
    // Without bands, without compensation, without a length.
    let bare: Vec<PathCurvePoint> =
        (0..5).map(|i| PathCurvePoint { deflection_m: 1e-4 * f64::from(i), ..PathCurvePoint::default() }).collect();
    let figure = path_figure(&bare, None);
    check(&figure);
    assert_eq!((figure.panels.len(), figure.panels[0].series.len()), (1, 1));
    assert_eq!(figure.panels[0].series[0].x, [1.0, 2.0, 3.0, 4.0, 5.0]);
}
