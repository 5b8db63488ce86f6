//! `select` says in one call, for each way to work, what it planned, how good that is, and what goes with what.

use crate::common::cases::slip;
use crate::common::prelude::*;
use serde::Serialize;
use serde::de::DeserializeOwned;
use stiffarm::ask::select::{
    CurveSize, Mode, Plan, Planned, SelectInputs, SelectOptions, Stage, plan as planned_from, plan_candidates,
    plan_curve, plan_drop, plan_space_filling,
};
use stiffarm::findings::codes;
use stiffarm::model::cell::MeasuringTime;
use stiffarm::model::elastic::ElasticSizes;
use stiffarm::model::load::LoadCase;
use stiffarm::plan::characteristic_length::with_length;
use stiffarm::plan::evaluated::Evaluated;
use stiffarm::plan::feasibility::{PostureLimits, on_limits};

/// Text of a result that is read back and written again as the same text.
fn saved<T: Serialize + DeserializeOwned>(result: &T) -> String {
    let text = serde_json::to_string(result).unwrap();
    let read: T = serde_json::from_str(&text).unwrap();
    assert_eq!(serde_json::to_string(&read).unwrap(), text);
    text
}

fn quick(count: usize) -> SelectOptions {
    with(|o: &mut SelectOptions| {
        (o.index, o.count) = (Some(Index::ExpectedError), Some(count));
        o.rounds = Some(1);
        o.no_certificate = true;
    })
}

/// A plan from nothing.
fn plan(
    cell: &Cell,
    options: &SelectOptions,
    watch: &mut dyn FnMut(Stage),
    control: Control<'_>,
) -> stiffarm::Result<Planned<Plan>> {
    planned_from(cell, &SelectInputs::default(), options, watch, control)
}

/// A plan from these postures.
fn plan_from(cell: &Cell, inputs: &SelectInputs, options: &SelectOptions) -> stiffarm::Result<Planned<Plan>> {
    planned_from(cell, inputs, options, &mut |_| {}, Control::default())
}

fn example_postures() -> Vec<Posture> {
    numbered(group1())
}

fn names(postures: &[Posture]) -> Vec<&str> {
    postures.iter().map(|p| p.name.as_str()).collect()
}

#[test]
fn a_plan_is_the_selection_with_its_bounds_in_the_order_of_its_route() {
    let cell = default_cell();
    let mut request = quick(3);
    request.no_certificate = false;
    let mut stages = Vec::new();
    let mut watch = |stage: Stage| stages.push(stage.to_string());
    let planned = plan(&cell, &request, &mut watch, Control::default()).unwrap();
    let words = ["selecting: round 1", "bounding what 3 postures can give", "bounding what each joint can have"];
    assert_eq!(stages, words);

    let result = &planned.result;
    let options = rounds(1);
    let alone = select(&planned.cell, request.index(), 3, &options, Control::default()).unwrap();
    let alone = rounded(&cell, &alone.group, 0.01).unwrap();
    // The route may take equivalents in another order: they are worth the same.
    let worth = evaluate(&planned.cell, "", &alone).unwrap();
    let ratio = worth.indices.expected_error.unwrap() / result.selection.value;
    assert!((ratio - 1.0).abs() < 1e-9, "{ratio}");
    let driven: Vec<&Vec<f64>> = planned.postures.iter().map(|p| &p.q).collect();
    assert_eq!(driven, result.selection.group.iter().collect::<Vec<_>>());
    assert_eq!(result.route.order, [0, 1, 2]);
    assert_eq!(names(&planned.postures), ["1", "2", "3"]);
    assert_eq!(result.posture_names, ["1", "2", "3"]);
    let certificate = result.certificate.as_ref().unwrap();
    assert!(certificate.bound <= result.selection.value);
    assert!(result.joint_efficiencies.is_some() && result.sensitivity.is_none());
    let expected = result.selection.evaluation.indices.expected_error;
    assert_eq!(result.evaluation.indices.expected_error, expected);

    assert_eq!(planned.seed, Some(1));
    assert_eq!(planned.options.mode, Mode::Global);
    assert_eq!(planned.options.select.angle_step_deg, 0.01);
    assert!(planned.options.characteristic_length_m.is_some());
    saved(result);
    saved(&planned.options);
}

#[test]
fn equal_requests_give_equal_bytes() {
    let cell = default_cell();
    let mut request = quick(3);
    request.index = Some(Index::D);
    request.seed = Some(7);
    request.sensitivity = true;
    let text = || {
        let planned = plan(&cell, &request, &mut |_| {}, Control::default()).unwrap();
        assert_eq!(planned.seed, Some(7));
        assert_eq!(planned.result.sensitivity.as_ref().unwrap().options.rounds, 1);
        saved(&planned.result)
    };
    assert_eq!(text(), text());
}

#[test]
fn a_plan_from_an_initial_group_keeps_names_and_draws_nothing() {
    let mut initial = example_postures();
    initial[0].name = "first".to_string();
    let inputs = with(|i: &mut SelectInputs| i.initial = Some(initial.clone()));
    let mut options = with(|o: &mut SelectOptions| o.max_iterations = Some(2));
    let planned = plan_from(&default_cell(), &inputs, &options).unwrap();
    assert_eq!(names(&planned.postures), names(&initial));
    assert_eq!((planned.seed, planned.options.mode), (None, Mode::From));
    assert_eq!(planned.options.select, options);
    // There is no bound from an initial group.
    assert!(planned.result.certificate.is_none());
    assert_eq!(planned.result.before.as_ref().unwrap().evaluation.name, "initial");
    (options.sensitivity, options.index) = (true, Some(Index::O1));
    let examined = plan_from(&default_cell(), &inputs, &options).unwrap();
    assert_eq!(examined.seed, Some(1));
}

#[test]
fn new_postures_meet_no_name_of_the_given_ones() {
    let mut options = quick(2);
    (options.count, options.add) = (None, Some(2));
    let inputs = with(|i: &mut SelectInputs| {
        i.given = example_postures();
        i.given.truncate(3);
        i.given[1].name = "5".to_string();
    });
    let planned = plan_from(&default_cell(), &inputs, &options).unwrap();
    assert_eq!(names(&planned.postures), ["4", "6"]);
    assert_eq!(planned.options.mode, Mode::Add);
    let result = &planned.result;
    assert_eq!(result.given_names, ["1", "5", "3"]);
    assert!(result.selection.value < result.given_value.unwrap());
    assert_eq!(result.evaluation.posture_count, 5);
    saved(result);
}

#[test]
fn options_that_exclude_each_other_are_refused_with_their_name() {
    type Change = fn(&mut SelectInputs, &mut SelectOptions);
    let rows: [(&str, &str, Change); 10] = [
        ("initial", "rounds", |i, o| (i.initial, o.rounds) = (Some(example_postures()), Some(1))),
        ("initial", "given", |i, _| (i.initial, i.given) = (Some(example_postures()), example_postures())),
        ("initial", "time_limit", |i, o| (i.initial, o.time_limit_s) = (Some(example_postures()), Some(1.0))),
        ("initial", "largest_load_n", |i, o| (i.initial, o.largest_load_n) = (Some(example_postures()), Some(500.0))),
        ("prices", "initial", |i, o| (i.initial, o.prices) = (Some(example_postures()), true)),
        ("given", "sensitivity", |i, o| (i.given, o.sensitivity) = (example_postures(), true)),
        ("repeats", "initial", |i, o| (i.initial, o.repeats) = (Some(example_postures()), true)),
        ("minutes", "given", |i, o| (i.given, o.minutes) = (example_postures(), Some(60.0))),
        ("minutes", "count", |_, o| (o.count, o.minutes) = (Some(6), Some(60.0))),
        ("repeats", "an index that says nothing of repeats", |_, o| *o = changed(quick(2), |o| o.repeats = true)),
    ];
    let mut report = String::new();
    for (key, other, change) in rows {
        let (mut inputs, mut options) = (SelectInputs::default(), SelectOptions::default());
        change(&mut inputs, &mut options);
        let error = plan_from(&default_cell(), &inputs, &options).map(|planned| planned.options).expect_err(other);
        assert_eq!(error.code(), Code::Conflict, "{key}, {other}: {error}");
        assert_eq!(error.place().key.as_deref(), Some(key), "{other}: {error}");
        report += &slip::<()>(&format!("{key}, {other}"), Err(error));
    }
    insta::assert_snapshot!("options_that_exclude_each_other", report);
}

/// Joint 6 is free, the others hardly move.
fn hardly_moving(last: [f64; 2]) -> Cell {
    let mut cell = default_cell();
    let bounds = [[-5.0, 5.0], [0.0, 8.0], [-100.0, -92.0], [20.0, 30.0], [50.0, 60.0], last];
    cell.bounds = bounds.map(|b| b.map(f64::to_radians)).to_vec();
    cell
}

#[test]
fn postures_that_are_alike_are_planned_where_they_may_be() {
    let cell = hardly_moving([0.0, 10.0]);
    let mut request = quick(8);
    request.index = None;
    let planned = |cell: &Cell, request: &SelectOptions| plan(cell, request, &mut |_| {}, Control::default());
    let error = planned(&cell, &request).map(|selected| selected.options).unwrap_err();
    insta::assert_snapshot!(error, @"
    No group of 8 postures inside bounds and limits was found of which no two are within 15° of each other in every joint.
      hint: ask for fewer, widen [bounds] or [limits], or let the plan measure postures again (--repeats)
    ");
    request.repeats = true;
    let again = planned(&cell, &request).unwrap();
    assert_eq!(again.postures.len(), 8);
    assert!(again.options.select.repeats);

    // A whole turn makes no other posture: -180° and 180°.
    let cell = hardly_moving([170.0, 180.0]);
    let one = Posture { name: "there".into(), q: [0.0, 4.0, -96.0, 25.0, 55.0, -180.0].map(f64::to_radians).to_vec() };
    let inputs = with(|i: &mut SelectInputs| i.given = vec![one]);
    request.count = None;
    assert!(plan_from(&cell, &inputs, &request).is_ok());
    request.repeats = false;
    assert!(plan_from(&cell, &inputs, &request).is_err());
}

/// The default cell under its rope, and under these loads besides.
fn with_loads(further: &[(&str, Load)]) -> Cell {
    let mut cell = default_cell();
    let rope = ("rope", cell.setup.load.clone());
    let case = |(name, load): &(&str, Load)| LoadCase { name: (*name).into(), load: load.clone(), loading_point: None };
    let all = [rope].into_iter().chain(further.to_vec());
    cell.setup.load = Load::Cases(all.map(|load_case| case(&load_case)).collect());
    cell
}

#[test]
fn minutes_are_spent_on_the_loads_that_predict_best() {
    let weight = ("weight", hanging(500.0));
    let cell = with_loads(&[weight]);
    let mut request = quick(6);
    (request.index, request.count) = (None, None);
    request.minutes = Some(24.0);
    let in_time = |cell: &Cell, request: &SelectOptions| plan(cell, request, &mut |_| {}, Control::default());
    let planned = in_time(&cell, &request).unwrap();
    let result = &planned.result;
    saved(result);
    // The weight alone never turns joint 1.
    let ways: Vec<(&[String], usize, f64)> =
        result.in_time.iter().map(|way| (way.loads.as_slice(), way.postures, way.time_s)).collect();
    let names = ["rope".to_string(), "weight".to_string()];
    assert_eq!(ways, [(&names[..], 6, 1440.0), (&names[..1], 8, 1440.0)]);
    assert_eq!((planned.postures.len(), result.time_s), (6, 1440.0));
    assert_eq!(planned.cell.setup.load, cell.setup.load);
    assert!(result.selection.value <= result.in_time[0].prediction * (1.0 + 1e-3));
    // What the rope alone gives is what its own plan gives: its work is the same.
    let mut alone = request.clone();
    (alone.minutes, alone.count) = (None, Some(8));
    let alone = in_time(&default_cell(), &alone).unwrap().result.selection.value;
    let stated = result.in_time[1].prediction;
    assert!((stated / alone - 1.0).abs() < 1e-3, "{stated} {alone}");

    // Where hanging it takes as long as driving there, it is not hung.
    let mut slow = cell.clone();
    slow.time.further_load = 3000.0;
    let planned = in_time(&slow, &request).unwrap();
    assert_eq!(planned.result.in_time.len(), 1);
    assert_eq!(planned.postures.len(), 8);
    assert_eq!(planned.cell.setup.load.case_names(), "rope");

    // A cell with the rope alone hears what the weight would give, and is not told to hang it.
    let planned = in_time(&default_cell(), &request).unwrap();
    assert_eq!(planned.postures.len(), 8);
    let way = &planned.result.in_time[0];
    assert_eq!((way.postures, way.loads.len()), (6, 0));
    assert!((way.further_mass_kg.unwrap() - 500.0 / 9.80665).abs() < 1e-9);

    // Under another index all loads are taken.
    let mut other = request.clone();
    other.index = Some(Index::ExpectedError);
    let planned = in_time(&cell, &other).unwrap();
    assert_eq!((planned.postures.len(), planned.result.in_time.len()), (6, 0));
    let refused = |minutes: f64| in_time(&cell, &changed(request.clone(), |o| o.minutes = Some(minutes)));
    assert_eq!(refused(1e300).map(|planned| planned.options).unwrap_err().code(), Code::InvalidValue);
    insta::assert_snapshot!(slip("1.5 minutes", refused(1.5)) + &slip("200000 minutes", refused(2e5)), @"
    » 1.5 minutes
    [invalid-value] In 1.5 minutes no posture can be measured: one takes 4 minutes under the loads of this cell.
      hint: give more time, or what measuring takes in your cell: [time]

    » 200000 minutes
    [invalid-value] 200000 minutes would do for 66666 postures.
      hint: a plan has 1000 at most: give less time
    ");
}

#[test]
fn further_loads_and_anchors_take_time() {
    let rope = |y: f64| Load::Rope { anchor: Vector3::new(1.8, y, 0.0), magnitude: 500.0 };
    let (time, single) = (MeasuringTime::default(), rope(0.0));
    let both = with_loads(&[("side", rope(1.0))]).setup.load;
    let same = with_loads(&[("again", rope(0.0)), ("weight", hanging(500.0))]).setup.load;
    for (load, twelve) in [(&single, 36.0), (&both, 12.0 * 4.0 + 10.0), (&same, 12.0 * 5.0)] {
        let seconds = time.of(12, load);
        assert_eq!(seconds, 60.0 * twelve);
        assert_eq!(time.postures_within(seconds, load), 12);
        assert_eq!(time.postures_within(seconds - 1.0, load), 11);
    }
    assert_eq!(time.postures_within(300.0, &both), 0);
}

/// What `check` says that a second anchor would bring is what a cell with it has.
#[test]
fn a_second_anchor_is_worth_what_is_said() {
    // The rope's shortest and longest would leave other postures for the work that a plan is made for.
    let mut cell = default_cell();
    cell.limits = Default::default();
    let mut request = quick(4);
    request.index = None;
    let planned = plan(&cell, &request, &mut |_| {}, Control::default()).unwrap();
    let further = planned.result.further_load.unwrap();
    let anchor = further.anchor.unwrap();
    let [x, y, z] = anchor.position_m;
    let Load::Rope { anchor: first, magnitude } = cell.setup.load else { unreachable!() };
    // A sixth of a turn about axis 1, as far from it and as high.
    assert!((x.hypot(y) - first.x.hypot(first.y)).abs() < 1e-12 && (z - first.z).abs() < 1e-12);
    let second = Load::Rope { anchor: Vector3::new(x, y, z), magnitude };
    for (load, with, minutes) in [(second, anchor.with, 4.0 + 10.0), (hanging(magnitude), further.with, 4.0)] {
        let mut cell = with_loads(&[("further", load)]);
        cell.limits = Default::default();
        let prediction = evaluate(&cell, "", &planned.postures).unwrap().indices.prediction;
        assert!((prediction.unwrap() / with - 1.0).abs() < 1e-9, "{prediction:?} {with}");
        let takes = if minutes > 10.0 { anchor.time_s } else { further.time_s };
        assert_eq!(takes, 60.0 * minutes);
    }
    // An anchor on axis 1 has no other.
    let mut above = cell.clone();
    above.setup.load = Load::Rope { anchor: Vector3::new(0.0, 0.0, 3.5), magnitude };
    let above_plan = plan(&above, &request, &mut |_| {}, Control::default());
    assert!(above_plan.is_ok_and(|planned| planned.result.further_load.is_none_or(|further| further.anchor.is_none())));
}

#[test]
fn a_chosen_load_is_that_of_the_cell_handed_on() {
    let mut request = quick(2);
    request.index = Some(Index::D);
    request.largest_load_n = Some(650.0);
    let planned = plan(&default_cell(), &request, &mut |_| {}, Control::default()).unwrap();
    assert_eq!(planned.cell.setup.load.size(), Some(650.0));
    assert_eq!(planned.options.select, request);
}

#[test]
fn a_stop_leaves_the_bounds_out_and_says_so() {
    use std::sync::atomic::{AtomicBool, Ordering};
    let stop = AtomicBool::new(false);
    let stopped = || stop.load(Ordering::Relaxed);
    let control = Control { stop: Some(&stopped), ..Control::default() };
    let mut request = quick(3);
    request.rounds = None;
    request.no_certificate = false;
    request.sensitivity = true;
    let mut watch = |stage: Stage| {
        if matches!(stage, Stage::Round(_)) {
            stop.store(true, Ordering::Relaxed);
        }
    };
    let planned = plan(&default_cell(), &request, &mut watch, control).unwrap();
    let result = planned.result;
    assert_eq!(result.selection.rounds, Some(1));
    assert!(result.certificate.is_none() && result.sensitivity.is_none());
    let why = result.certificate_missing.unwrap();
    assert_eq!(why, "stopped before the bound was found");
}

#[test]
fn the_best_of_a_list() {
    let cell = default_cell();
    let drawn = random_group(&cell, StartKind::Uniform, 8, 1, 0).unwrap();
    let named = |(i, q): (usize, Vec<f64>)| Candidate::new(format!("c{i}"), q);
    let list: Vec<Candidate> = drawn.into_iter().enumerate().map(named).collect();
    let mut request = with(|o: &mut SelectOptions| o.count = Some(3));
    let planned = plan_candidates(&cell, &list, true, &request, Control::default()).unwrap();
    let result = &planned.result;
    assert_eq!(names(&planned.postures), result.posture_names);
    for (posture, at) in planned.postures.iter().zip(&result.selection.chosen) {
        assert_eq!((&posture.name, &posture.q), (&list[*at].name, &list[*at].q));
    }
    assert_eq!(planned.options.mode, Mode::Candidates);
    assert_eq!((&planned.options.select, planned.seed), (&request, Some(1)));
    assert!(!result.measured_wrenches && result.candidate_names.len() == 8);
    assert!(saved(result).contains(r#""postures_deg":[["#));
    request.no_certificate = true;
    let listed = plan_candidates(&cell, &list, true, &request, Control::default()).unwrap();
    assert!(listed.result.selection.bound.is_none());
}

#[test]
fn evenly_spread_postures() {
    let mut request = with(|o: &mut SelectOptions| {
        (o.count, o.seed) = (Some(4), Some(3));
    });
    let planned = plan_space_filling(&default_cell(), &request, Control::default()).unwrap();
    let result = &planned.result;
    assert_eq!(names(&planned.postures), ["1", "2", "3", "4"]);
    assert_eq!(result.evaluation.posture_count, 4);
    assert!(result.smallest_distance.unwrap() > 0.5 && !result.route.is_blocked());
    for (posture, q) in planned.postures.iter().zip(&result.postures) {
        assert_eq!(&posture.q, q);
        for angle in q {
            let steps = angle.to_degrees() * 100.0;
            assert!((steps - steps.round()).abs() < 1e-6, "{steps}");
        }
    }
    assert_eq!(planned.options.mode, Mode::SpaceFilling);
    assert_eq!(planned.seed, Some(3));
    saved(result);
    request.angle_step_deg = -1.0;
    let refused = plan_space_filling(&default_cell(), &request, Control::default());
    assert_eq!(refused.map(|p| p.options).unwrap_err().code(), Code::InvalidValue);
}

#[test]
fn given_postures_with_two_left_out() {
    let postures = example_postures();
    let mut request = with(|o: &mut SelectOptions| o.drop = Some(2));
    let planned = plan_drop(&default_cell(), &postures, &request, Control::default()).unwrap();
    let result = &planned.result;
    let remaining: Vec<Posture> = result.dropped.kept.iter().map(|p| postures[*p].clone()).collect();
    assert_eq!(planned.postures, remaining);
    assert_eq!(result.postures.len(), postures.len());
    assert_eq!((planned.options.mode, planned.seed), (Mode::Drop, None));
    saved(result);
    request.drop = Some(postures.len());
    let refused = plan_drop(&default_cell(), &postures, &request, Control::default());
    let refused = refused.map(|p| p.options).unwrap_err();
    assert_eq!(refused.hint_text(), Some("leave out 5 at most"));
}

#[test]
fn a_curve_with_its_bounds() {
    let mut request = with(|o: &mut SelectOptions| {
        (o.index, o.count, o.rounds) = (Some(Index::D), Some(4), Some(1));
    });
    let mut stages = Vec::new();
    let mut watch = |stage: Stage| stages.push(stage.to_string());
    let planned = plan_curve(&default_cell(), &request, &mut watch, Control::default()).unwrap();
    let words = ["selecting 4 postures, the last size", "bounding what any group can give"];
    assert_eq!(stages, words);
    let sizes = &planned.result.sizes;
    let counts: Vec<usize> = sizes.iter().map(|s| s.point.postures).collect();
    assert_eq!(counts, [1, 2, 3, 4]);
    let last = &sizes[3];
    assert!(last.efficiency.unwrap() <= 1.0 && last.gain.is_none());
    assert!((sizes[1].bound.unwrap() / last.bound.unwrap() - 2_f64.sqrt()).abs() < 1e-12);
    for pair in sizes.windows(2) {
        let value = |size: &CurveSize| size.point.value;
        let gain = value(&pair[0]).zip(value(&pair[1])).map(|(now, next)| (now - next) / now);
        assert_eq!(pair[0].gain, gain);
        let share = pair[1].bound.zip(value(&pair[1])).map(|(bound, value)| bound / value);
        assert_eq!(pair[1].efficiency, share);
    }
    assert!(planned.postures.is_empty() && planned.options.mode == Mode::Curve);
    saved(&planned.result);
    request.no_certificate = true;
    let quick = plan_curve(&default_cell(), &request, &mut |_| {}, Control::default()).unwrap();
    assert_eq!(quick.result.sizes[3].bound, None);
    assert_eq!(quick.result.certificate_missing, None);
    // O3 is to be large.
    (request.index, request.count) = (Some(Index::O3), Some(3));
    let larger = plan_curve(&default_cell(), &request, &mut |_| {}, Control::default()).unwrap();
    let [_, two, three] = &larger.result.sizes[..] else {
        panic!("three sizes");
    };
    let [two_value, three_value] = [two, three].map(|size| size.point.value.unwrap());
    assert_eq!(two.gain, Some((three_value - two_value) / two_value));
    assert!(two.gain.unwrap() > 0.0);
}

/// What no posture shows stays however many there are: bounds of one size are not those of another over the root of the
/// number, which lay above what was found.
#[test]
fn a_curve_of_predictions_has_the_bound_of_its_largest_plan() {
    let mut cell = default_cell();
    cell.noise.reading_variance = 1e-13;
    cell.elastic = Some(ElasticSizes { shift: 7e-7, turn: 1.2e-6, coupling: 5.2e-7 });
    for largest in [4, 12] {
        let request = with(|o: &mut SelectOptions| {
            (o.count, o.rounds) = (Some(largest), Some(1));
        });
        let curve = plan_curve(&cell, &request, &mut |_| {}, Control::default()).unwrap();
        let curve = curve.result;
        for size in &curve.sizes {
            let holds = size.efficiency.is_none_or(|share| share <= 1.0);
            assert!(holds, "{} postures: {:?}", size.point.postures, size.efficiency);
        }
        let bounded = curve.sizes.iter().filter(|size| size.bound.is_some());
        let bounded: Vec<usize> = bounded.map(|size| size.point.postures).collect();
        assert_eq!(bounded, if largest < 12 { vec![] } else { vec![12] });
    }
}

#[test]
fn a_missing_length_is_computed_or_its_lack_explained() {
    let cell = stiffarm_files::builtin::cell("comau").unwrap();
    let (with, missing) = with_length(cell);
    assert!(with.characteristic_length.is_some() && missing.is_none());
    let mut stated = with.clone();
    stated.characteristic_length = Some(0.123);
    assert_eq!(with_length(stated).0.characteristic_length, Some(0.123));
    // No posture lies within reversed bounds: the reason is kept, the cell goes on without.
    let mut without = with;
    without.characteristic_length = None;
    without.bounds[0] = [f64::NAN, f64::NAN];
    let (without, missing) = with_length(without);
    assert!(without.characteristic_length.is_none() && missing.is_some());
}

/// A machine may refuse its limit, and a distance that is just met is used up by a table that is
/// a little elsewhere: the plan says which postures these are.
#[test]
fn postures_on_limits_and_without_room_to_spare_are_named() {
    let cell = builtin::cell("comau-shapes").unwrap();
    let mut postures = example_postures();
    let of = |postures: &[Posture]| -> Vec<PostureLimits> {
        let all = postures.iter().map(|p| PostureLimits::new(&cell, &p.q));
        all.collect::<Result<_, _>>().unwrap()
    };
    let mut limits = of(&postures);
    assert_eq!(on_limits(&cell, &postures, &limits), []);

    postures[1].q[1] = cell.setup.robot.joints()[1].limits[0] + 1e-4;
    let shapes = limits[2].nearest.iter_mut();
    let shapes = shapes.filter(|near| near.kind == LimitKind::Shapes);
    shapes.for_each(|near| near.margin_m = Some(5e-5));
    // `evaluate` says the same of postures that nobody chose here.
    let group = PostureGroup { name: "mine".to_string(), postures: postures.clone() };
    let evaluated = Evaluated::new(&cell, &[group]).unwrap();
    let finding = evaluated.findings.iter().find(|f| f.code == codes::ON_MACHINE_LIMIT);
    assert_eq!(finding.unwrap().subject, "mine");

    let findings = on_limits(&cell, &postures, &limits);
    let codes: Vec<&str> = findings.iter().map(|f| f.code.as_str()).collect();
    assert_eq!(codes, [codes::ON_MACHINE_LIMIT, codes::NO_ROOM_TO_SPARE]);
    assert_eq!(findings[0].severity, Severity::Caution);
    assert_eq!(findings[0].subject, "bounds.q_deg[2]");
    assert_eq!([&postures[1].name, &postures[2].name], ["2", "3"]);
    insta::assert_snapshot!(format!("{}\n{}", findings[0].sentence, findings[1].sentence), @"
    Posture 2 has joint 2 on the machine's limit, -75°, which the robot may refuse to reach: keep postures, and bounds.q_deg, a degree before it.
    Posture 3 has at most 0.1 mm to spare beyond the distances that [clearance] asks for: how exactly tool, table and rope are where the cell has them is what these distances have to cover.
    ");
}
