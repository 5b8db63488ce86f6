//! Pictures of cells are sound, show red exactly where a limit is violated, and have a mark for each posture.

use crate::common::{spread_by, with_shapes};
use crate::render::{check, texts};
use nalgebra::Vector3;
use std::collections::HashSet;
use stiffarm::model::cell::{Cell, LimitKind, LimitMargin};
use stiffarm::model::load::{Axes, Load, Wrench};
use stiffarm::model::observation::PostureTerms;
use stiffarm::model::posture::Posture;
use stiffarm_files::builtin;
use stiffarm_report::figure::drawing::{Drawing, Mark, Shape, Tone};
use stiffarm_report::scene::{SceneGroup, SceneOptions, scene};
use stiffarm_report::{Full, cell_drawing, render_drawing, usual_posture};

/// `count` postures spread over the bounds, among them some that violate each kind of limit.
fn spread(cell: &Cell, count: usize) -> Vec<Posture> {
    let steps = [0.618, 0.755, 0.570, 0.819, 0.430, 0.281];
    spread_by(cell, count, |joint| steps[joint])
}

fn margins(cell: &Cell, posture: &Posture) -> (PostureTerms, Vec<LimitMargin>) {
    let terms = PostureTerms::new(&cell.setup, &posture.q, None).unwrap();
    let margins = cell.margins().named(&terms);
    (terms, margins)
}

fn drawn(cell: &Cell, posture: &Posture) -> Drawing {
    cell_drawing(cell, std::slice::from_ref(posture), Full::Number(0)).unwrap()
}

fn lines(marks: &[Mark], tone: Tone, red: bool) -> usize {
    let of_kind = marks.iter().filter(|m| m.tone == tone && m.caution == red);
    of_kind.filter(|m| matches!(m.shape, Shape::Line(_))).count()
}

#[test]
fn red_is_there_exactly_where_a_limit_is_violated() {
    let cell = with_shapes();
    let mut seen = HashSet::new();
    for posture in spread(&cell, 60) {
        let (_, margins) = margins(&cell, &posture);
        let violated: Vec<&LimitMargin> = margins.iter().filter(|m| m.margin < 0.0).collect();
        seen.extend(violated.iter().map(|m| m.kind.describe()));
        let drawing = drawn(&cell, &posture);
        assert_eq!(drawing.caution_count() > 0, !violated.is_empty());
        // What one kind violates alone is red in every view.
        if violated.iter().all(|m| m.kind == violated[0].kind) && !violated.is_empty() {
            for view in &drawing.views {
                let is_red = view.marks.iter().any(|m| m.caution);
                assert!(is_red, "{:?}: {}", violated[0].kind, view.title);
            }
        }
        let cautions = drawing.notes.iter().filter(|n| n.caution).count();
        assert_eq!(cautions, violated.len().min(4));
        let key = drawing.key.iter().any(|entry| entry.label == "violates a limit");
        assert_eq!(key, !violated.is_empty());
    }
    // Every kind that the cell limits came by, so none is forgotten.
    for kind in LimitKind::ALL {
        let absent = matches!(
            kind,
            LimitKind::Floor | LimitKind::RopeLength | LimitKind::SmallestDisplacement | LimitKind::LargestDisplacement
        );
        assert!(absent || seen.contains(kind.describe()), "{kind:?}");
    }
}

#[test]
fn as_many_beams_are_drawn_as_there_are() {
    let cell = with_shapes();
    for posture in spread(&cell, 20) {
        let (terms, margins) = margins(&cell, &posture);
        let each = cell.scene.seen_by_each(&terms);
        let best = cell.scene.seen(&terms).unwrap();
        assert!(each.contains(&best));
        let seen: usize = each.iter().map(|s| s.points.len()).sum();
        let hidden = terms.measuring_points().len() - best.points.len();
        let violated =
            margins.iter().any(|m| m.margin < 0.0 && matches!(m.kind, LimitKind::Sight | LimitKind::Incidence));
        for view in &drawn(&cell, &posture).views[..2] {
            assert_eq!(lines(&view.marks, Tone::Ray, false), seen);
            assert_eq!(lines(&view.marks, Tone::FaintRay, violated), hidden);
            assert_eq!(lines(&view.marks, Tone::FaintRay, !violated), 0);
        }
    }
}

#[test]
fn every_cell_gives_a_sound_picture() {
    let mut cells: Vec<Cell> =
        ["comau", "comau-reference", "fanuc-r2000ic"].iter().map(|name| builtin::cell(name).unwrap()).collect();
    cells.push(with_shapes());
    for cell in cells {
        let usual = usual_posture(&cell).unwrap();
        check(&render_drawing(&drawn(&cell, &usual)));
        let postures = spread(&cell, 50);
        for full in [Full::Tightest, Full::Number(3), Full::Number(99), Full::None] {
            let drawing = cell_drawing(&cell, &postures, full).unwrap();
            let svg = render_drawing(&drawing);
            check(&svg);
            let again = cell_drawing(&cell, &postures, full).unwrap();
            assert_eq!(svg, render_drawing(&again));
        }
        check(&render_drawing(&cell_drawing(&cell, &[], Full::Tightest).unwrap()));
    }
}

#[test]
fn a_cell_without_shapes_shows_its_arm_and_each_load_its_pull() {
    let mut cell = builtin::cell("comau").unwrap();
    let loads = [
        cell.setup.load.clone(),
        Load::Weight { magnitude: 500.0, direction: -Vector3::z() },
        Load::Constant { wrench: Wrench::force([0.0, 300.0, 100.0]), axes: Axes::Tool },
        Load::Measured,
    ];
    let pulls = loads.map(|load| {
        cell.setup.load = load;
        let drawing = drawn(&cell, &usual_posture(&cell).unwrap());
        let marks = &drawing.views[0].marks;
        assert!(lines(marks, Tone::Skeleton, false) >= 5);
        let of_load = marks.iter().filter(|m| m.tone == Tone::Pull);
        let shapes = of_load.map(|m| match m.shape {
            Shape::Line(_) => "rope",
            Shape::Arrow(_) => "arrow",
            _ => "point",
        });
        shapes.collect::<Vec<_>>().join(" ")
    });
    assert_eq!(pulls, ["rope point", "arrow point", "arrow point", "point"]);
}

#[test]
fn each_posture_has_its_own_mark_and_entry() {
    let cell = builtin::cell("comau").unwrap();
    let postures = spread(&cell, 20);
    let drawing = cell_drawing(&cell, &postures, Full::Number(4)).unwrap();
    let items: HashSet<usize> = drawing.views[0]
        .marks
        .iter()
        .filter_map(|mark| match (&mark.shape, mark.tone) {
            (Shape::Point(_), Tone::Item(number)) => Some(number),
            _ => None,
        })
        .collect();
    assert_eq!(items.len(), 19);
    assert!(!items.contains(&4));
    let names = texts(&render_drawing(&drawing));
    for (number, posture) in postures.iter().enumerate() {
        let entry = format!("posture {}", posture.name);
        assert_eq!(names.contains(&entry), number != 4, "{entry}");
    }
    insta::assert_snapshot!(drawing.caption, @"The cell from the side, from above and in perspective. In full: posture 5 of 20. The others as lines. It meets its limits. Least room: 101 mm at the box for tool points and flange (measuring point 3). Ringed in red, a limit violated too: 1, 2, 4, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 17, 18, 19, 20.");
}

#[test]
fn the_same_postures_are_drawn_once_and_named_together() {
    let cell = builtin::cell("comau").unwrap();
    let mut postures = spread(&cell, 5);
    postures[3].q = postures[1].q.clone();
    postures[4].q = postures[0].q.clone();
    let drawing = cell_drawing(&cell, &postures, Full::Number(4)).unwrap();
    let labels: Vec<&str> = drawing.key.iter().map(|e| e.label.as_str()).collect();
    assert!(labels.ends_with(&["postures 2, 4", "posture 3"]), "{labels:?}");
    assert_eq!(drawing.notes[0].text, "In full: posture 5 of 5; the same as 1. The others as lines.");
}

#[test]
fn the_usual_posture_meets_the_limits_where_one_does() {
    let meets = |cell: &Cell, p: &Posture| margins(cell, p).1.iter().all(|m| m.margin >= 0.0);
    let middle = "the middle of the bounds";
    assert_eq!(usual_posture(&builtin::cell("comau").unwrap()).unwrap().name, middle);
    let mut cell = builtin::cell("comau").unwrap();
    cell.limits.wrist_height = Some(1.9);
    cell.validation.clear();
    let near = usual_posture(&cell).unwrap();
    assert_eq!(near.name, "a posture near the middle of the bounds");
    assert!(meets(&cell, &near));
    assert_eq!(drawn(&cell, &near).caution_count(), 0);
    let mut second = near.clone();
    second.name = "V2".into();
    let mut low = second.clone();
    low.q[1] += 1.0;
    assert!(!meets(&cell, &low));
    cell.validation = vec![low, second.clone()];
    assert_eq!(usual_posture(&cell).unwrap(), second);
    cell.limits.floor = Some(9.0);
    let usual = usual_posture(&cell).unwrap();
    assert_eq!(usual.name, middle);
    assert!(drawn(&cell, &usual).caution_count() > 0);
}

#[test]
fn a_drawing_is_a_projection_of_its_scene() {
    let cell = with_shapes();
    let postures = spread(&cell, 6);
    let groups = [SceneGroup::new("a", &postures[..4]), SceneGroup::new("b", &postures[4..])];
    let scene = scene(&cell, &groups, &SceneOptions::default()).unwrap();
    for full in [Full::Tightest, Full::Number(2), Full::None] {
        assert_eq!(scene.drawing(Some(0), full), cell_drawing(&cell, &postures[..4], full).unwrap());
        assert_eq!(scene.drawing(None, full), cell_drawing(&cell, &postures, full).unwrap());
    }
}
