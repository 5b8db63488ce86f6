//! Several loads, under each of which every posture is measured, count together: in Ψ, plans, readings, fits, checks.

use crate::common::cases::sentences;
use crate::common::differences::assert_gradient;
use crate::common::groups::ln_index;
use crate::common::prelude::*;
use stiffarm::estimate::simulate::ModelErrors;
use stiffarm::estimate::validate::validate;
use stiffarm::model::load::LoadCase;
use stiffarm::model::observation::{Setup, fill_observation_matrix, observation_shape};
use stiffarm::plan::check::check;
use stiffarm::plan::index::evaluate_groups;

fn case(name: &str, load: Load, loading_point: Option<Vector3<f64>>) -> LoadCase {
    LoadCase { name: name.to_string(), load, loading_point }
}

/// Two ropes to either side, a weight at a point of its own, a wrench that turns with the tool.
fn four_loads() -> Cell {
    let mut cell = default_cell();
    let Load::Rope { anchor, magnitude } = cell.setup.load else { panic!("the default cell has a rope") };
    let aside = |y: f64| Load::Rope { anchor: anchor + Vector3::new(0.0, y, 0.0), magnitude };
    let beside = cell.setup.tool.loading_point + Vector3::new(0.05, -0.2, 0.1);
    let weight = Load::Weight { magnitude: 300.0, direction: *cell.setup.robot.gravity_direction() };
    let turning = Load::Constant {
        wrench: Wrench { force: Vector3::new(100.0, 200.0, -50.0), moment: Vector3::new(20.0, -10.0, 30.0) },
        axes: Axes::Tool,
    };
    cell.setup.load = Load::Cases(vec![
        case("left", aside(0.8), None),
        case("right", aside(-0.9), None),
        case("weight", weight, Some(beside)),
        case("torque", turning, None),
    ]);
    cell
}

/// The two ropes of them.
fn two_ropes() -> Cell {
    let mut cell = four_loads();
    let Load::Cases(cases) = &mut cell.setup.load else { unreachable!() };
    cases.truncate(2);
    cell
}

/// Ψ of the loads one by one, put together by hand.
fn by_hand(cell: &Cell, postures: &[Vec<f64>]) -> DMatrix<f64> {
    let Load::Cases(cases) = &cell.setup.load else { unreachable!() };
    let mut rows: Vec<DMatrix<f64>> = Vec::new();
    for q in postures {
        for case in cases {
            let mut setup: Setup = cell.setup.clone();
            setup.load = case.load.clone();
            // A load at another point, moved to the tool's loading point: M = (p − p_f) × F.
            let wrench = case.loading_point.map(|point| {
                let terms = PostureTerms::new(&setup, q, None).unwrap();
                let at = terms.frames().point(&point);
                let wrench = setup.load.wrench(terms.frames(), &at).unwrap();
                wrench.moved(&at, terms.loading_point())
            });
            let terms = PostureTerms::new(&setup, q, wrench.as_ref()).unwrap();
            rows.push(terms.block(&setup.robot));
        }
    }
    let count = rows.iter().map(DMatrix::nrows).sum();
    let mut psi = DMatrix::zeros(count, rows[0].ncols());
    let mut at = 0;
    for block in rows {
        psi.rows_mut(at, block.nrows()).copy_from(&block);
        at += block.nrows();
    }
    psi
}

#[test]
fn the_observation_matrix_of_many_postures_has_the_rows_of_each() {
    let cell = four_loads();
    let moved = |i: usize| group1()[i % 6].iter().map(|angle| angle + 1e-3 * i as f64).collect();
    let mut postures: Vec<Vec<f64>> = (0..600).map(moved).collect();
    for rows in [Rows::Translations, Rows::FullPose { length: 0.5 }] {
        let psi = observation_matrix(&cell.setup, &postures, rows).unwrap();
        let (height, width) = observation_shape(&cell.setup, 1, rows);
        assert_eq!(psi.shape(), (600 * height, width));
        for (i, q) in postures.iter().enumerate() {
            let alone = observation_matrix(&cell.setup, &[q], rows).unwrap();
            assert_eq!(psi.rows(i * height, height), alone, "{i} {rows:?}");
        }
    }
    let too_small = fill_observation_matrix(&cell.setup, &[&postures[0]], Rows::Translations, &mut [0.0; 7]);
    assert_eq!(too_small.unwrap_err().code(), Code::Dimension);
    postures[555][2] = f64::NAN;
    let error = observation_matrix(&cell.setup, &postures, Rows::Translations).unwrap_err();
    assert_eq!(error.code(), Code::NotFinite);
}

#[test]
fn the_observation_matrix_has_the_rows_of_each_load() {
    let cell = four_loads();
    let postures = group1();
    let psi = observation_matrix(&cell.setup, &postures, Rows::Translations).unwrap();
    let expected = by_hand(&cell, &postures);
    assert_eq!(psi.nrows(), 4 * 3 * cell.setup.tool.point_count() * postures.len());
    assert!((&psi - &expected).amax() < 1e-12 * expected.amax());
    // The indices shown are those of this matrix.
    let sigma = expected.singular_values();
    let evaluation = evaluate(&cell, "g", &postures).unwrap();
    let condition = sigma[0] / sigma[sigma.len() - 1];
    assert!((evaluation.indices.condition.unwrap() / condition - 1.0).abs() < 1e-9);
    assert_eq!(evaluation.posture_count, postures.len());
    assert_eq!(evaluation.k_jn.len(), postures.len());
    // k(J_N) does not depend on the load.
    let alone = evaluate(&default_cell(), "g", &postures).unwrap();
    assert_eq!(evaluation.k_jn, alone.k_jn);
    // σ k √[(ΨᵀΨ)⁻¹]_jj by another way.
    let inverse = expected.tr_mul(&expected).try_inverse().unwrap();
    let std = cell.noise.displacement_std();
    let prior = cell.prior.as_ref().unwrap();
    for (j, error) in evaluation.relative_standard_error.iter().enumerate() {
        let by_inverse = std * prior[j] * inverse[(j, j)].sqrt();
        assert!((error.unwrap() / by_inverse - 1.0).abs() < 1e-8);
    }
}

#[test]
fn the_same_load_twice_is_worth_twice_the_readings() {
    let alone = default_cell();
    let mut twice = alone.clone();
    let load = alone.setup.load.clone();
    twice.setup.load = Load::Cases(vec![case("a", load.clone(), None), case("b", load, None)]);
    let postures = group1();
    for index in [Index::ExpectedError, Index::WorstJoint, Index::DropOne, Index::D] {
        let one = ln_index(&alone, index, &postures);
        let two = ln_index(&twice, index, &postures);
        assert!((one - two - 0.5 * 2f64.ln()).abs() < 1e-9, "{index:?}");
    }
}

#[test]
fn values_and_gradients_of_the_kernel() {
    let cell = four_loads();
    let q = group1()[..4].concat();
    let indices = [
        Index::Novel,
        Index::ExpectedError,
        Index::ScaledCondition,
        Index::WorstJoint,
        Index::DropOne,
        Index::D,
        Index::O1,
    ];
    let group: Vec<Vec<f64>> = q.chunks(6).map(<[f64]>::to_vec).collect();
    for index in indices {
        let mut function = IndexFunction::new(&cell, index, 4).unwrap();
        let value = function.value(&q);
        let expected = ln_index(&cell, index, &group);
        assert!((value - expected).abs() < 1e-9, "{index:?}: {value} {expected}");
        let mut gradient = vec![0.0; q.len()];
        function.smoothed(&q, 30.0, &mut gradient);
        let mut unused = vec![0.0; q.len()];
        let at = |q: &[f64]| function.smoothed(q, 30.0, &mut unused).objective;
        assert_gradient(index.as_str(), &gradient, &q, at, 2e-4, 1e-7);
    }
}

#[test]
fn a_plan_keeps_the_limits_under_every_load_and_is_certified() {
    let mut cell = two_ropes();
    cell.limits.rope_length = Some([1.0, 2.2]);
    let options = rounds(3);
    let plan = select(&cell, Index::ExpectedError, 4, &options, Control::default()).unwrap();
    for q in &plan.group {
        for case in cell.cases() {
            let terms = PostureTerms::new(&case.setup, q, None).unwrap();
            let length = case.setup.load.rope_length(terms.loading_point()).unwrap();
            assert!((1.0..=2.2).contains(&length), "{length}");
            assert!(case.margins().least(&terms) >= 0.0);
        }
    }
    assert!(smallest_margin(&cell, &plan.group).unwrap().unwrap() >= 0.0);
    let certificate =
        certify(&cell, Index::ExpectedError, &plan.group, &CertificateOptions::default(), Control::default()).unwrap();
    assert!((certificate.value.unwrap() / plan.value - 1.0).abs() < 1e-9);
    let efficiency = certificate.efficiency.unwrap();
    assert!((0.85..=1.0 + 1e-9).contains(&efficiency), "{efficiency}");
    // Two loads tell more than either of them alone with the same postures.
    for case in cell.cases() {
        let alone = evaluate(&case, "g", &plan.group).unwrap();
        assert!(alone.indices.expected_error.unwrap() > plan.value);
    }
}

#[test]
fn candidates_count_with_every_load() {
    let cell = two_ropes();
    let list: Vec<Candidate> = random_group(&cell, StartKind::Uniform, 12, 1, 0)
        .unwrap()
        .into_iter()
        .enumerate()
        .map(|(i, q)| Candidate::new(i.to_string(), q))
        .collect();
    let options = CandidateOptions::default();
    let index = Index::ExpectedError;
    let best = select_candidates(&cell, index, 3, &list, &options, Control::default()).unwrap();
    assert!(best.exact);
    // All 220 groups, one by one.
    let mut least = f64::INFINITY;
    for i in 0..12 {
        for j in i + 1..12 {
            for k in j + 1..12 {
                let group = [&list[i].q, &list[j].q, &list[k].q];
                let evaluation = evaluate(&cell, "g", &group).unwrap();
                least = least.min(evaluation.indices.expected_error.unwrap_or(f64::INFINITY));
            }
        }
    }
    assert!((best.value / least - 1.0).abs() < 1e-9);
}

/// Readings of the four loads without noise, each between unloaded ones.
fn readings(cell: &Cell, noise: TrackerNoise) -> Measured {
    let mut done = Experiment::as_measured(cell);
    assert_eq!(done.states.len(), 9);
    done.model = DisplacementModel::Linear;
    done.tracker_noise = noise;
    done.drift = Vector3::zeros();
    let truth = cell.prior.clone().unwrap();
    let postures = numbered(group1());
    let table = experiment(cell, &postures, &truth, &done, 1, 0).unwrap();
    prepare(cell, table, &Default::default()).unwrap()
}

#[test]
fn readings_under_several_loads_give_the_stiffness_back() {
    let cell = four_loads();
    let measured = readings(&cell, TrackerNoise::None);
    let identification = identify(&cell, &measured, &IdentifyOptions::default()).unwrap();
    let stiffness = identification.estimates.stiffness().unwrap();
    for (k, prior) in stiffness.iter().zip(cell.prior.as_ref().unwrap()) {
        assert!((k / prior - 1.0).abs() < 1e-8, "{k} {prior}");
    }
}

#[test]
fn a_state_of_no_load_is_refused() {
    let cell = two_ropes();
    let postures = numbered(group1());
    let truth = cell.prior.clone().unwrap();
    let done = Experiment {
        states: vec![ExperimentState::new("unloaded", 0.0), ExperimentState::new("above", 1.0)],
        ..Experiment::default()
    };
    let error = experiment(&cell, &postures, &truth, &done, 1, 0).unwrap_err();
    insta::assert_snapshot!(error, @r#"
    state: The state "above" belongs to no load case of the cell.
      hint: name states after the load cases, with -2 and so on where one is taken again: left, right
    "#);
    // What takes one load says so.
    let error = PostureTerms::new(&cell.setup, &postures[0].q, None).unwrap_err();
    insta::assert_snapshot!(error, @"
    load.case: The cell has several load cases, and one load is asked for.
      hint: put one of the loads alone into [load]
    ");
}

#[test]
fn simulation_validation_and_what_is_common_to_all_readings() {
    let mut cell = two_ropes();
    let prior = cell.prior.clone().unwrap();
    let group = PostureGroup::from_angles("g", group1());
    let mut options = SimulationOptions::default();
    options.variance_factors = vec![1.0];
    options.runs = 400;
    let simulation = simulate(&cell, std::slice::from_ref(&group), &options, Control::default()).unwrap();
    let level = &simulation.groups[0].levels[0];
    let expected = evaluate(&cell, "g", &group.postures).unwrap();
    for j in 0..6 {
        let deviation = expected.expected_deviation[j].unwrap();
        assert!((level.expected_deviation[j] / deviation - 1.0).abs() < 1e-12);
        let off = level.compliance_mean_deviation[j] - level.expected_deviation[j];
        assert!(off.abs() < 4.0 * level.compliance_standard_error[j]);
    }
    // A force scale of 1 % common to all loads moves every stiffness by 1 %.
    options.model_errors = ModelErrors { force_scale: 0.01, ..ModelErrors::default() };
    cell.noise.reading_variance = 0.0;
    let scaled = simulate(&cell, std::slice::from_ref(&group), &options, Control::default());
    let level = &scaled.unwrap().groups[0].levels[0];
    let spread = level.compliance_mean_deviation.clone();
    assert!(spread.iter().all(|d| (d / spread[0] - 1.0).abs() < 1e-6), "{spread:?}");

    cell.noise.reading_variance = 1e-12;
    let measured = simulate_measurements(&cell, &group.postures, &prior, Model::Linear, 1, 0).unwrap();
    assert_eq!(measured.len(), 2 * group.postures.len());
    let result = validate(&cell, &prior, &measured, Model::Linear, None).unwrap();
    assert!(result.component_rms_m < 3e-6);
    let fit = Fit::new(&cell, &measured, &IdentifyOptions::default()).unwrap();
    let errors = systematic_errors(&fit).unwrap();
    let parts = |name: &str| -> Vec<String> {
        let named = errors.sources.iter().filter(|s| s.name == name);
        named.flat_map(|s| s.parts.iter().map(|p| p.name.clone())).collect()
    };
    assert_eq!(parts("anchor"), ["left x", "left y", "left z", "right x", "right y", "right z"]);
    assert_eq!(parts("loading-point"), ["x", "y", "z"]);
    let next = next_posture(&fit, &rounds(1), Control::default()).unwrap();
    assert!(next.expected_error < fit_error(&next.before));
    // As many displacements as the posture it is measured like has under both loads.
    assert_eq!(next.displacements, 2 * cell.setup.tool.point_count());
}

fn fit_error(relative: &[Option<f64>]) -> f64 {
    let squares: f64 = relative.iter().map(|e| e.unwrap().powi(2)).sum();
    (squares / relative.len() as f64).sqrt()
}

#[test]
fn a_check_looks_at_all_loads() {
    // A weight alone leaves joint 1 in the dark; with a rope beside it nothing is.
    let mut cell = four_loads();
    let Load::Cases(cases) = &mut cell.setup.load else { unreachable!() };
    let (rope, weight) = (cases[0].clone(), cases[2].clone());
    *cases = vec![weight.clone()];
    let dark = check(&cell).unwrap();
    assert!(!dark.joints[0].determined && dark.joints[1].determined);
    cell.setup.load = Load::Cases(vec![weight, rope]);
    assert!(check(&cell).unwrap().joints.iter().all(|j| j.determined));
}

#[test]
fn candidates_that_the_cell_forbids_are_left_out() {
    let mut cell = two_ropes();
    let feasible = random_group(&cell, StartKind::Uniform, 6, 1, 0).unwrap();
    let mut list = feasible.clone();
    // Outside the bounds, and with the tool behind the robot.
    list.insert(2, vec![2.0, 0.0, -1.5, 0.1, 0.2, 0.3]);
    list.insert(4, vec![0.0, -1.0, -3.1, 0.1, 0.2, 0.3]);
    let list: Vec<Candidate> = list.into_iter().enumerate().map(|(i, q)| Candidate::new(i.to_string(), q)).collect();
    let mut options = CandidateOptions::default();
    let control = Control::default;
    let index = Index::ExpectedError;
    let selection = select_candidates(&cell, index, 6, &list, &options, control()).unwrap();
    assert_eq!(selection.chosen, [0, 1, 3, 5, 6, 7]);
    let forbidden: Vec<usize> = selection.forbidden.iter().map(|f| f.candidate).collect();
    assert_eq!(forbidden, [2, 4]);
    insta::assert_snapshot!(selection.forbidden[0].because, @"has joint 1 at 114.591559°, outside the cell's bounds, -90° to 90°");
    let error = select_candidates(&cell, index, 7, &list, &options, control()).unwrap_err();
    insta::assert_snapshot!(error, @"
    7 postures cannot be chosen: 6 of 8 candidates meet the cell's bounds and limits. Candidate 2 has joint 1 at 114.591559°, outside the cell's bounds, -90° to 90°.
      hint: give more candidates, ask for fewer postures, or relax [bounds] and [limits]
    ");
    // What was measured was driven.
    options.limits = false;
    let all = select_candidates(&cell, index, 8, &list, &options, control()).unwrap();
    assert!(all.forbidden.is_empty() && all.chosen.len() == 8);
    cell.limits.rope_length = Some([8.0, 9.0]);
    options.limits = true;
    let error = select_candidates(&cell, index, 2, &list, &options, control()).unwrap_err();
    insta::assert_snapshot!(error, @"
    2 postures cannot be chosen: 0 of 8 candidates meet the cell's bounds and limits. Candidate 0 has its rope 6773 mm beyond the rope's length (load case right).
      hint: give more candidates, ask for fewer postures, or relax [bounds] and [limits]
    ");
}

#[test]
fn measured_candidates_count_with_the_loads_that_they_were_measured_under() {
    let cell = two_ropes();
    let truth = cell.prior.clone().unwrap();
    let postures = numbered(group1());
    let mut measured = simulate_measurements(&cell, &postures, &truth, Model::Linear, 1, 0).unwrap();
    let mut options = CandidateOptions::default();
    options.limits = false;
    let index = Index::ExpectedError;
    let value_of = |measured: &[MeasuredPosture]| {
        let list = Candidate::of_measured(&cell.setup, measured);
        let count = list.len();
        let selection = select_candidates(&cell, index, count, &list, &options, Control::default()).unwrap();
        selection.value
    };
    let whole = evaluate(&cell, "g", &group1()).unwrap().indices.expected_error.unwrap();
    assert!((value_of(&measured) / whole - 1.0).abs() < 1e-9);
    // Measured forces, and a second state under each load with less force, change nothing.
    let mut more = Vec::new();
    for reading in &mut measured {
        let setup = cell.setup.of_state(&reading.state).unwrap();
        let terms = PostureTerms::new(&setup, &reading.posture.q, None).unwrap();
        reading.wrench = Some(*terms.wrench());
        let mut half = reading.clone();
        half.state += "-2";
        half.wrench = Some(Wrench::force(terms.wrench().force * 0.5));
        more.push(half);
    }
    measured.extend(more);
    assert!((value_of(&measured) / whole - 1.0).abs() < 1e-9);
    // Only one of the loads was measured.
    measured.retain(|reading| reading.state == "left");
    let left = evaluate(&cell.under("left").unwrap(), "g", &group1()).unwrap();
    let left = left.indices.expected_error.unwrap();
    assert!((value_of(&measured) / left - 1.0).abs() < 1e-9);
}

#[test]
fn a_posture_without_one_of_the_loads_is_named() {
    let cell = four_loads();
    let mut done = Experiment::as_measured(&cell);
    done.tracker_noise = TrackerNoise::None;
    let truth = cell.prior.clone().unwrap();
    let postures = numbered(group1());
    let mut table = experiment(&cell, &postures, &truth, &done, 1, 0).unwrap();
    table.postures[1].states.retain(|state| state.state != "weight");
    let measured = prepare(&cell, table, &Default::default()).unwrap();
    let missing = measured.findings().filter(|f| f.code == "load-case-not-measured");
    insta::assert_snapshot!(sentences(missing), @"[load-case-not-measured] 2: Posture 2: not measured under weight, which the plan counted.");
}

#[test]
fn limits_name_the_load_that_violates_them() {
    let mut cell = two_ropes();
    cell.limits.rope_length = Some([0.5, 1.0]);
    let q = &group1()[0];
    let named = cell.posture_margins().unwrap().named(q).unwrap();
    let ropes: Vec<_> = named.iter().filter(|m| m.kind.is_of_load()).collect();
    assert!(ropes.iter().any(|m| m.load.as_deref() == Some("left")));
    assert!(ropes.iter().any(|m| m.load.as_deref() == Some("right")));
    let smallest = cell.posture_margins().unwrap().smallest(q).unwrap().unwrap();
    insta::assert_snapshot!(smallest.violation(), @"has its rope 1732 mm beyond the rope's length (load case right)");
}

/// Indices of many groups at once are those of each alone: where the information is well conditioned to nine digits, and
/// elsewhere, or where there are none, to the last bit. Groups of one posture again and again, of nearly the same one, of
/// random ones.
#[test]
fn indices_of_many_groups_are_those_of_each() {
    for (cell, common) in [(default_cell(), 0.0), (four_loads(), 1e-5)] {
        let mut cell = cell;
        cell.noise.posture_common_std = common;
        let random = random_group(&cell, StartKind::Uniform, 600, 5, 0).unwrap();
        let mut groups: Vec<Vec<Vec<f64>>> = random.chunks(4).map(<[_]>::to_vec).collect();
        for (i, far) in [0.0, 1e-9, 1e-6, 1e-3].into_iter().enumerate() {
            let moved = |n: usize| random[i].iter().map(|q| q + far * n as f64).collect();
            groups.push((0..4).map(moved).collect());
        }
        groups.push(random[..9].to_vec());
        let mut wanted = Index::ALL.to_vec();
        wanted.retain(|index| *index != Index::Prediction);
        let many = evaluate_groups(&cell, &groups, &wanted).unwrap();
        let (mut alike, mut off) = (0, 0.0_f64);
        for (group, many) in groups.iter().zip(&many) {
            let one = evaluate(&cell, "", group).unwrap().indices;
            for index in &wanted {
                let (many, one) = (many.get(*index), one.get(*index));
                assert_eq!(many.is_some(), one.is_some(), "{index:?} {group:?}");
                let both = many.zip(one);
                alike += u32::from(many == one);
                off = both.map_or(off, |(many, one)| off.max((many / one - 1.0).abs()));
            }
        }
        assert!(off < 1e-9, "{off}");
        // Not all went by the decompositions.
        assert!(alike < many.len() as u32 * wanted.len() as u32 / 2, "{alike}");
    }
}
