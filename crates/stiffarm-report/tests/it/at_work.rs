//! What is said of a loaded tool is the same from what a command has at hand and from its file.

use crate::common::{saved_with, story};
use serde::Serialize;
use serde_json::json;
use stiffarm::Control;
use stiffarm::ask::map::MapOptions;
use stiffarm::ask::path::PathOptions;
use stiffarm::ask::predict::{PredictOptions, Predicted};
use stiffarm::ask::region::{Plane, RegionOptions, Steps};
use stiffarm::estimate::saved::Saved;
use stiffarm::findings::{Finding, Severity};
use stiffarm::model::cell::Cell;
use stiffarm::model::path::PathPoint;
use stiffarm::model::process::{ForceAxes, TipLoad};
use stiffarm::nalgebra::{Isometry3, Vector3, Vector4};
use stiffarm::work::compensate::PointCompensation;
use stiffarm::work::map::{PlaceOptions, place, stiffness_map};
use stiffarm_files::builtin;
use stiffarm_files::table::read_path;
use stiffarm_report::figure::Panel;
use stiffarm_report::summary::{
    Block, Context, DataTable, Depth, Outcome, Summarise, Summary, Text, WithCell, summarise,
};
use stiffarm_report::{compensation_figure, prediction_figure};

fn cell() -> (Cell, Saved) {
    let cell = builtin::cell("comau").unwrap();
    let saved = Saved::prior(&cell).unwrap();
    (cell, saved)
}

/// Deflections at the cell's tasks.
fn tasks(cell: &Cell, saved: &Saved, matrix: bool) -> Predicted {
    let request = PredictOptions { matrix, ..PredictOptions::default() };
    let control = Control::default();
    let loaded = request.loaded(cell.clone(), &saved.predictor, None, control);
    request.predict(&loaded.unwrap(), saved, control).unwrap()
}

/// The built-in path.
fn contour(cell: &Cell) -> Vec<PathPoint> {
    let text = builtin::path_text("contour").unwrap();
    read_path(text.as_bytes(), "contour", cell, None).unwrap().points
}

/// What is said of a result of `command`, checked to be the same from the result as it was made as from its file.
fn checked_part<O: Serialize, R: Serialize + Summarise<O>>(
    command: &str,
    cell: &Cell,
    options: &O,
    result: &R,
) -> Summary {
    let whole = saved_with(command, json!(options), json!(result));
    let from_file = summarise(&WithCell::new(&whole, Some(cell)).without_pictures()).unwrap();
    let context = Context { command, name: "result", cell: Some(cell), pictures: false };
    let made = result.summary(options, &context).unwrap();
    assert_eq!(words(&made), words(&from_file));
    // The page has pictures beside the same words.
    let page = summarise(&WithCell::new(&whole, Some(cell))).unwrap();
    assert_eq!(page.verdict, from_file.verdict);
    assert!(page.sections.len() > from_file.sections.len() || command == "map");
    made
}

/// All that is said, as plain text.
fn words(part: &Summary) -> Vec<String> {
    let mut out: Vec<String> = part.verdict.iter().map(Text::plain).collect();
    part.key.iter().for_each(|key| table(key, &mut out));
    for section in &part.sections {
        out.push(section.title.clone());
        section.blocks.iter().for_each(|block| words_of(block, &mut out));
    }
    out
}

/// What stands in the section of this name.
fn words_in(part: &Summary, id: &str) -> Vec<String> {
    let mut out = Vec::new();
    let section = part.sections.iter().find(|section| section.id == id).unwrap();
    section.blocks.iter().for_each(|block| words_of(block, &mut out));
    out
}

fn words_of(block: &Block, out: &mut Vec<String>) {
    match block {
        Block::Text(text) => out.push(text.plain()),
        Block::List(texts) => out.extend(texts.iter().map(Text::plain)),
        Block::Table(data) => table(data, out),
        Block::Details(_, inside) => inside.iter().for_each(|block| words_of(block, out)),
        _ => panic!("no picture is asked for"),
    }
}

fn table(data: &DataTable, out: &mut Vec<String>) {
    out.push(data.caption.clone());
    out.push(data.headings.join(" | "));
    let rows = data.rows.iter();
    out.extend(rows.map(|row| {
        let cells: Vec<String> = row.iter().map(Text::plain).collect();
        cells.join(" | ")
    }));
}

fn summary_titles(part: &Summary) -> Vec<&str> {
    let sections = part.sections.iter();
    let shown = sections.filter(|section| section.depth == Depth::Summary);
    shown.map(|section| section.id.as_str()).collect()
}

#[test]
fn deflections_are_said_with_the_matrices_that_were_asked_for() {
    let (cell, prior) = cell();
    let predicted = tasks(&cell, &prior, false);
    let plain = checked_part("predict", &cell, &PredictOptions::default(), &predicted);
    insta::assert_snapshot!(story(&plain.verdict), @"
    The deflection of the tool tip was predicted at the 3 tasks of the cell, each under its own load.
    The tool bends away by 1.3098 mm (RMS), at most 1.9679 mm at point titanium, front; nothing says how sure that is.
    Predict with an identified stiffness, so that the deflection has a ±: stiffarm identify cell.toml readings.csv --output k.json writes it.
    ");
    assert_eq!(plain.outcome, Outcome::Caution);
    assert!(summary_titles(&plain).is_empty());
    // A column without a number is left out.
    let headings = &plain.key.as_ref().unwrap().headings;
    assert!(headings.iter().all(|heading| !heading.contains('±')), "{headings:?}");
    let predicted = tasks(&cell, &prior, true);
    let matrices = checked_part("predict", &cell, &PredictOptions::default(), &predicted);
    assert_eq!(summary_titles(&matrices), ["matrices"]);
}

#[test]
fn what_is_serious_stands_before_the_numbers() {
    let (cell, mut prior) = cell();
    let sentence = "The stiffness cannot be used as it is.";
    let doubt = Finding::new("stiffness-doubtful", Severity::Serious, "stiffness", sentence);
    prior.predictor.doubts.push(doubt);
    let predicted = tasks(&cell, &prior, false);
    let part = checked_part("predict", &cell, &PredictOptions::default(), &predicted);
    insta::assert_snapshot!(story(&part.verdict), @"
    The deflection of the tool tip was predicted at the 3 tasks of the cell, each under its own load.
    The stiffness cannot be used as it is. As it is: The tool bends away by 1.3098 mm (RMS), at most 1.9679 mm at point titanium, front; nothing says how sure that is.
    Do not use these numbers: correct the readings behind the stiffness, identify again, and then this again.
    ");
    assert_eq!(part.outcome, Outcome::Serious);
}

#[test]
fn corrections_and_what_they_leave() {
    let (cell, prior) = cell();
    let options = PathOptions::default();
    let control = Control::default();
    let points = contour(&cell);
    let followed = options.follow(&cell, &prior.predictor, &points, control).unwrap();
    let compensated = options.compensate(&cell, &prior, &followed, control).unwrap();
    let part = checked_part("compensate", &cell, &options, &compensated);
    insta::assert_snapshot!(story(&part.verdict), @"
    The path of 61 points was changed so that the loaded tool follows the nominal path. The postures come from inverse kinematics in closed form, with steps of a joint up to 1.03°.
    Without correction the tool bends away by 1.4447 mm (RMS), at most 1.8459 mm; nothing says how much of that the correction takes away on the real arm.
    Identify the joint stiffness first: stiffarm identify cell.toml readings.csv --output k.json says how sure it is, and so whether this correction helps.
    ");
    let key = part.key.unwrap();
    assert_eq!((key.rows.len(), key.headings[0].as_str()), (12, "worst points"));
}

#[test]
fn a_map_names_its_places() {
    let (cell, prior) = cell();
    let map = |from: f64| {
        let plane = Plane { axis: 2, mm: 800.0 };
        let region = RegionOptions {
            plane: (from < 5000.0).then_some(plane),
            from_mm: Some([from, -500.0, 800.0]),
            to_mm: Some([from + 800.0, 500.0, 800.0]),
            steps: Some(Steps::Longest(5)),
        };
        let request = MapOptions { region, ..MapOptions::default() };
        let options = request.map_options(&cell).unwrap();
        let mapped = stiffness_map(&cell, &prior.predictor, &options, Control::default());
        let options = request.options(&options, &cell);
        checked_part("map", &cell, &options, &mapped.unwrap())
    };
    let said = map(1400.0);
    insta::assert_snapshot!(story(&said.verdict), @"
    The tool tip was held at 20 positions, x 1400 to 2200 mm, y −500 to 500 mm, z = 800 mm, with its axis along (0, 0, −1), under a force of (0, 0, 1) N, 1 N along the direction: the cell's [work] gives a load in the axes of a path, which a map has not; 20 of them are reachable within all limits.
    The tip gives way least at x = 1400.0, y = −500.0, z = 800.0 mm, by 3.45 µm; 1.2 times as much at x = 2200.0, y = −500.0, z = 800.0 mm, by 4.14 µm.
    Put the work where the tip gives way little; stiffarm map cell.toml k.json --place path.csv finds the place for a whole path, and an identified stiffness instead of the assumed one gives every number its ±.
    ");
    assert_eq!(summary_titles(&said), ["map"]);
    insta::assert_snapshot!(words_in(&said, "postures").join("\n"), @"
    Controller angles there, of the posture that bends least
    place | q1 [°] | q2 [°] | q3 [°] | q4 [°] | q5 [°] | q6 [°]
    stiffest | 21.80 | −16.05 | −129.66 | 0.00 | 50.34 | −158.20
    softest | 13.71 | 20.99 | −128.22 | 0.00 | 51.78 | −166.29
    ");
    // Where nothing is reachable that is what came out.
    let nowhere = map(5000.0);
    insta::assert_snapshot!(story(&nowhere.verdict), @"
    The tool tip was held at 20 positions, x 5000 to 5800 mm, y −500 to 500 mm, z = 800 mm, with its axis along (0, 0, −1), under a force of (0, 0, 1) N, 1 N along the direction: the cell's [work] gives a load in the axes of a path, which a map has not; 0 of them are reachable within all limits.
    No node of the map is reachable with this orientation. Closest comes x = 5000, y = 0, z = 800 mm: 1827.5 mm out of the arm's reach.
    Map another region, or turn the tool: --from-mm, --to-mm and --rpy-deg.
    ");
    assert!(nowhere.key.is_none());
}

#[test]
fn the_best_place_comes_as_lines_of_the_cell() {
    let (cell, prior) = cell();
    let options = {
        let mut options = PlaceOptions::default();
        options.lower = [1.5, -0.5, 0.8];
        options.upper = [2.1, 0.5, 0.8];
        options.steps = [3, 3, 1];
        options
    };
    let points = contour(&cell);
    let placement = place(&cell, &prior.predictor, &points, &options, Control::default());
    let said = checked_part("map", &cell, &MapOptions::default().of_places(&options), &placement.unwrap());
    assert_eq!(summary_titles(&said), ["lines"]);
    insta::assert_snapshot!(words_in(&said, "lines").join("\n"), @"
    workpiece_mm = [1500, 0, 800]
    workpiece_rpy_deg = [0, 0, 0]
    ");
    insta::assert_snapshot!(story(&said.verdict), @"
    27 places of the workpiece in x 1500 to 2100 mm, y −500 to 500 mm, z = 800 mm were tried for a path of 61 points under its loads; at 27 of them the arm can go along.
    At x = 1500.0, y = 0.0, z = 800.0 mm the path bends the tip by 1.2727 mm (RMS), at most 1.5554 mm, 1.14 times less than at the given place (1.4447 mm).
    Put the best place into [work] of the cell, check fixture, cables and collisions there, and predict again.
    ");
}

/// Curves of a panel by their label, one after the other.
fn curve(panel: &Panel, label: &str) -> Vec<[f64; 2]> {
    let curves = panel.series.iter().filter(|series| series.label == label);
    curves.flat_map(|series| series.x.iter().zip(&series.y).map(|(x, y)| [*x, *y])).collect()
}

#[test]
fn the_part_is_drawn_in_the_workpiece_frame() {
    let (mut cell, saved) = cell();
    cell.work.workpiece = Isometry3::new(Vector3::new(1.7, -0.2, 0.8), Vector3::new(0.1, -0.2, 0.6));
    let mut points = contour(&cell);
    // Air in the middle of the path.
    for point in &mut points[20..25] {
        point.load = Some(TipLoad { force: Vector3::zeros(), moment: Vector3::zeros(), axes: ForceAxes::Base });
    }
    let options = PathOptions::default();
    let control = Control::default();
    let followed = options.follow(&cell, &saved.predictor, &points, control).unwrap();
    let compensation = options.compensate(&cell, &saved, &followed, control).unwrap().compensation;
    let figure = compensation_figure(&compensation, Some(&cell.work.workpiece));
    let plain = compensation_figure(&compensation, None);
    assert_eq!(figure.panels[..plain.panels.len()], plain.panels);
    let panel = &figure.panels[plain.panels.len()];
    let times: f64 = panel.title.split(' ').find_map(|word| word.parse().ok()).unwrap();
    // The path lies in the workpiece's xy plane, and each curve has a gap.
    assert_eq!((panel.x.label.as_str(), panel.y.label.as_str()), ("x", "y"));
    assert_eq!(panel.series.len(), 3 * 2);
    let working: Vec<usize> = (0..points.len()).filter(|i| !(20..25).contains(i)).collect();
    let frame = cell.work.workpiece.to_homogeneous().try_inverse().unwrap();
    let inside = |tip: [f64; 3], shift: [f64; 3]| {
        let [x, y, z] = [0, 1, 2].map(|i| tip[i] + times * shift[i]);
        let at = frame * Vector4::new(x, y, z, 1.0);
        [1e3 * at.x, 1e3 * at.y]
    };
    let of = |shift: fn(&PointCompensation) -> [f64; 3]| -> Vec<[f64; 2]> {
        let drawn = working.iter().map(|i| {
            let point = &compensation.points[*i];
            inside(point.tip_m, shift(point))
        });
        drawn.collect()
    };
    let expected: [(&str, Vec<[f64; 2]>); 3] = [
        ("as it should be", of(|_| [0.0; 3])),
        ("as the tool bends away", of(|point| point.uncompensated_shift_m)),
        ("as it is commanded", of(|point| point.correction_m)),
    ];
    for (label, expected) in expected {
        let drawn = curve(panel, label);
        assert_eq!(drawn.len(), expected.len(), "{label}");
        for (drawn, expected) in drawn.iter().flatten().zip(expected.iter().flatten()) {
            assert!((drawn - expected).abs() < 1e-9, "{label}: {drawn} {expected}");
        }
    }
    // The largest shift is drawn at a tenth of the part at most, and at more than a thirtieth.
    let nominal = curve(panel, "as it should be");
    let span = |axis: usize| {
        let values = nominal.iter().map(|at| at[axis]);
        values.clone().fold(f64::MIN, f64::max) - values.fold(f64::MAX, f64::min)
    };
    let largest = compensation.points.iter().map(|point| point.uncompensated_m).fold(0.0, f64::max);
    let share = 1e3 * largest * times / span(0).max(span(1));
    assert!((1.0 / 30.0..=0.1).contains(&share), "{share}");
}

#[test]
fn what_is_not_bent_has_no_picture_of_the_part() {
    let (mut cell, saved) = cell();
    cell.work.process = None;
    let points = contour(&cell);
    let request = PredictOptions::default();
    let control = Control::default();
    let loaded = request.loaded(cell.clone(), &saved.predictor, Some(&points), control);
    let prediction = request.predict(&loaded.unwrap(), &saved, control).unwrap().prediction;
    let workpiece = Some(&cell.work.workpiece);
    assert_eq!(prediction_figure(&prediction, workpiece), prediction_figure(&prediction, None));
}

/// What rules the ± stands in the first lines, and not once more below them.
#[test]
fn loads_that_were_never_applied_stand_in_the_verdict() {
    let (cell, prior) = cell();
    let mut predicted = tasks(&cell, &prior, false);
    let sentence = "Of the 0.7 mm 0.6 mm lie in directions in which no reading has loaded the arm.";
    let finding = Finding::caution("never-loaded", "load", sentence);
    predicted.prediction.findings.push(finding);
    let made = checked_part("predict", &cell, &PredictOptions::default(), &predicted);
    assert!(made.verdict[1].plain().ends_with(sentence));
    assert!(made.findings.iter().all(|f| f.code != "never-loaded"));
    assert_eq!(made.outcome, Outcome::Caution);
}
