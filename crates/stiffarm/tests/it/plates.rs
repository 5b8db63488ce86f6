//! Plates on an arm that stands on the floor: a weight has no torque about joint 1, and everything goes on without it.

use crate::common::differences::assert_gradient;
use crate::common::prelude::*;
use crate::common::{entrywise_error, random_group};
use stiffarm::ask::select::{SelectInputs, SelectOptions, plan};
use stiffarm::estimate::coverage::{CoverageCase, ErrorModel, coverage};
use stiffarm::estimate::mixed::MixedFit;
use stiffarm::estimate::next_posture::planned_errors;
use stiffarm::estimate::simulate::simulate_elastic_measurements;
use stiffarm::estimate::standing::{InterimEstimate, is_better, standing};
use stiffarm::plan::check::determinable;
use stiffarm::plan::select::random_group as draw_group;

/// The reference cell with a weight, and the joints that the weight turns.
fn plates() -> (Cell, Cell) {
    let mut cell = reference_cell();
    cell.setup.load = hanging(500.0);
    let (others, findings) = determinable(cell.clone());
    assert_eq!(findings.len(), 1);
    (cell, others)
}

#[test]
fn a_joint_that_the_load_never_turns_is_left_out_by_name() {
    let (cell, others) = plates();
    let finding = &determinable(cell.clone()).1[0];
    assert_eq!((finding.subject.as_str(), finding.severity), ("joint 1", Severity::Caution));
    insta::assert_snapshot!(finding.sentence, @"No posture within the bounds determines joint 1 under the load of this cell: the load is parallel to its axis in every posture (a purely vertical load on a floor-mounted robot does that to joint 1); pull sideways. Plans and what they promise leave it out, as if it were rigid.");
    assert_eq!(others.setup.robot.spring_count(), 5);
    assert_eq!(others.setup.robot.spring_names()[0], "joint 2");
    assert_eq!(others.prior.as_deref(), cell.prior.as_deref().map(|k| &k[1..]));
    // Once more changes nothing, nor where the load turns every joint, nor where it turns none.
    assert_eq!(determinable(others.clone()), (others, Vec::new()));
    let mut without = cell.clone();
    without.setup.load = hanging(0.0);
    for whole in [reference_cell(), without] {
        assert_eq!(determinable(whole.clone()), (whole, Vec::new()));
    }
    // Loads beside each other count together.
    let mut pulled = cell.clone();
    pulled.setup.load = Load::Cases(
        [reference_cell().setup.load, cell.setup.load.clone()]
            .into_iter()
            .enumerate()
            .map(|(i, load)| stiffarm::model::load::LoadCase { name: i.to_string(), load, loading_point: None })
            .collect(),
    );
    assert!(determinable(pulled).1.is_empty());
}

#[test]
fn the_indices_of_the_others_are_those_of_their_columns() {
    let (cell, others) = plates();
    let group = random_group();
    let whole = observation_matrix(&cell.setup, &group, Rows::Translations).unwrap();
    assert_eq!(whole.column(0).amax(), 0.0);
    let theirs = whole.columns(1, 5).into_owned();
    let psi = observation_matrix(&others.setup, &group, Rows::Translations).unwrap();
    assert_eq!(psi, theirs);

    let evaluated = evaluate(&others, "others", &group).unwrap();
    let sigma = theirs.clone().svd(false, false).singular_values;
    let scaled = DMatrix::from_fn(theirs.nrows(), 5, |i, j| theirs[(i, j)] / others.prior.as_ref().unwrap()[j]);
    let inverse = (scaled.transpose() * &scaled).try_inverse().unwrap();
    let std = others.noise.displacement_std();
    let expected = [
        (Index::Condition, sigma.max() / sigma.min()),
        (Index::ExpectedError, std * (inverse.trace() / 5.0).sqrt()),
        (Index::WorstJoint, std * inverse.diagonal().max().sqrt()),
        (Index::D, std * inverse.determinant().powf(0.1)),
    ];
    for (index, expected) in expected {
        let ours = evaluated.indices.get(index).unwrap();
        assert!((ours / expected - 1.0).abs() < 1e-9, "{index:?} {ours} {expected}");
    }
    let plain = evaluate(&cell, "whole", &group).unwrap();
    assert_eq!(plain.k_jn, evaluated.k_jn);
    let errors = |from: &[Option<f64>]| from.iter().map(|e| e.unwrap()).collect::<Vec<_>>();
    let pair = [&plain.relative_standard_error[1..], &evaluated.relative_standard_error].map(errors);
    assert!(entrywise_error(&pair[0], &pair[1]) < 1e-9);
}

#[test]
fn gradients_of_the_others_are_those_of_differences() {
    let (_, mut others) = plates();
    let group = random_group();
    // Work that pushes sideways turns the joint that was left out.
    let indices = evaluate(&others, "sideways", &group).unwrap().indices;
    assert_eq!(indices.task, None);
    // Anywhere else it counts what does not turn it.
    assert!(indices.prediction.is_some());
    let refused = IndexFunction::new(&others, Index::Task, group.len());
    let error = refused.err().unwrap();
    assert_eq!(error.code(), Code::NotIdentifiable, "{error}");
    insta::assert_snapshot!(error, @"
    task: Task aluminium, left turns joint 1, of which the load of the cell tells nothing.
      hint: leave the task out, or add a load that turns the joint (load.case)
    ");
    for task in &mut others.tasks {
        (task.wrench, task.axes) = (Wrench::force(Vector3::z() * -300.0), Axes::Base);
    }
    let at: Vec<f64> = group.iter().flatten().copied().collect();
    for index in Index::ALL {
        let mut function = IndexFunction::new(&others, index, group.len()).unwrap();
        let (value, gradient) = function.log_and_gradient(&at);
        assert!(value.is_finite(), "{index:?}");
        let value = |q: &[f64]| function.value(q);
        assert_gradient(index.as_str(), &gradient, &at, value, 1e-4, 1e-5);
    }
}

#[test]
fn a_plan_for_the_others_is_bounded_and_says_what_it_leaves_out() {
    let (cell, others) = plates();
    let options = with(|o: &mut SelectOptions| {
        (o.index, o.rounds) = (Some(Index::ExpectedError), Some(2));
    });
    let inputs = SelectInputs::default();
    let planned = plan(&cell, &inputs, &options, &mut |_| {}, Control::default()).unwrap();
    let result = &planned.result;
    assert_eq!(result.joints, others.setup.robot.spring_names());
    assert!(result.findings.iter().any(|f| f.code == "joint-left-out"));
    let efficiency = result.certificate.as_ref().unwrap().efficiency.unwrap();
    assert!((0.9..=1.0 + 1e-9).contains(&efficiency), "{efficiency}");
    let error = |group: &[Vec<f64>]| {
        let evaluated = evaluate(&others, "group", group).unwrap();
        evaluated.indices.expected_error.unwrap()
    };
    let group: Vec<Vec<f64>> = planned.postures.iter().map(|p| p.q.clone()).collect();
    assert!(error(&group) < 0.7 * error(&random_group()));
    assert!((error(&group) / result.selection.value - 1.0).abs() < 1e-9);
}

#[test]
fn the_mixed_model_of_the_others_does_not_hear_of_the_joint() {
    let (cell, others) = plates();
    let postures = numbered(random_group());
    let measured = simulate_elastic_measurements(&cell, &postures, 3).unwrap();
    let options = IdentifyOptions::default();
    let of = |cell: &Cell| MixedFit::new(&Fit::new(cell, &measured, &options).unwrap()).unwrap();
    let (whole, fewer) = (of(&cell), of(&others));
    let (a, b) = (whole.compliance(), fewer.compliance());
    assert_eq!((&a.undetermined, a.values[0]), (&vec![0], 0.0));
    assert!((whole.likelihood_ratio() - fewer.likelihood_ratio()).abs() < 1e-6);
    let values = a.values.as_slice();
    assert!(relative_error(&values[1..], b.values.as_slice()) < 1e-6);
    let [a, b] = [a, b].map(|fit| fit.spread.as_ref().unwrap());
    assert!((a.sigma / b.sigma - 1.0).abs() < 1e-9);
    assert_eq!(a.covariance.row(0).amax(), 0.0);
    let reduced = a.covariance.clone().remove_row(0).remove_column(0);
    assert!(relative_error(reduced.as_slice(), b.covariance.as_slice()) < 1e-5);
    let joints = whole.joints().unwrap();
    assert_eq!(joints[0].verdict, Verdict::Undetermined);
    assert!(joints[1..].iter().all(|joint| joint.interval[0].is_some()));
}

#[test]
fn coverage_counts_the_others() {
    let (cell, others) = plates();
    let postures = numbered(random_group());
    let case = CoverageCase {
        options: IdentifyOptions::default(),
        world: ErrorModel { common_ratio: 1.0, lost_motion_rad: 1e-6, ..ErrorModel::default() },
        resamples: None,
        experiments: 1000,
        seed: 3,
    };
    let of = |cell: &Cell| coverage(cell, &postures, &case, Control::default()).unwrap();
    let (ours, theirs) = (of(&cell), of(&others));
    assert_eq!(ours.findings, determinable(cell).1);
    assert_eq!(ours.joints.len(), 5);
    assert_eq!(ours.joints, theirs.joints);
    assert!(theirs.findings.is_empty());
}

#[test]
fn the_next_posture_is_the_best_for_the_others() {
    let (cell, _) = plates();
    let postures = numbered(random_group());
    let truth = cell.prior.clone().unwrap();
    let measured = simulate_measurements(&cell, &postures, &truth, Model::Linear, 3, 0).unwrap();
    let fit = Fit::new(&cell, &measured, &IdentifyOptions::default()).unwrap();
    let next = next_posture(&fit, &rounds(2), Control::default()).unwrap();
    assert_eq!((next.before[0], next.after[0]), (None, None));
    let rms = |errors: &[Option<f64>]| {
        let determined: Vec<f64> = errors[1..].iter().map(|error| error.unwrap()).collect();
        (determined.iter().map(|e| e * e).sum::<f64>() / determined.len() as f64).sqrt()
    };
    assert!((next.expected_error / rms(&next.after) - 1.0).abs() < 1e-12);
    let with = |q: &Vec<f64>| planned_errors(&fit, std::slice::from_ref(q)).unwrap();
    let planned = with(&next.angles);
    assert!((rms(&planned.after[0]) / next.expected_error - 1.0).abs() < 1e-9);
    // None of many others brings as much, and what is planned is not left for what it brings itself.
    for q in draw_group(&cell, StartKind::Uniform, 100, 5, 0).unwrap() {
        assert!(rms(&with(&q).after[0]) > next.expected_error);
    }
    assert!(!is_better(&next, &planned));
}

#[test]
fn a_goal_is_asked_of_the_joints_that_the_load_turns() {
    let (cell, others) = plates();
    let postures = numbered(random_group());
    let truth = cell.prior.clone().unwrap();
    let measured = simulate_measurements(&cell, &postures, &truth, Model::Linear, 3, 0).unwrap();
    let of = |cell: &Cell, goal: f64| {
        let fit = Fit::new(cell, &measured, &IdentifyOptions::default()).unwrap();
        standing(&InterimEstimate::new(&fit).unwrap(), &postures[..2], Some(goal)).unwrap()
    };
    let now = of(&cell, 0.9);
    let largest = now.joints[1..].iter().filter_map(|joint| joint.total).fold(0.0, f64::max);
    assert_eq!((now.largest, now.reached), (Some(largest), Some(true)));
    assert_eq!((now.joints[0].total, now.joints[0].with_all), (None, None));
    assert_eq!(now.findings, determinable(cell.clone()).1);
    assert!((largest / of(&others, 0.9).largest.unwrap() - 1.0).abs() < 1e-9);
    // A goal between what is there and what two further postures bring is two postures away at most.
    let all = now.joints[1..].iter().filter_map(|joint| joint.with_all).fold(0.0, f64::max);
    assert!(all < largest);
    let ahead = of(&cell, 0.5 * (all + largest));
    assert_eq!(ahead.reached, Some(false));
    assert!(matches!(ahead.postures_to_goal, Some(1 | 2)));
}

/// A table may bring forces of its own, which turn what the load of the cell does not.
#[test]
fn a_joint_that_measured_forces_turn_counts() {
    let (cell, _) = plates();
    let pulled = reference_cell();
    let postures = numbered(random_group());
    let truth = pulled.prior.clone().unwrap();
    let mut measured = simulate_measurements(&pulled, &postures, &truth, Model::Linear, 3, 0).unwrap();
    for reading in &mut measured {
        let terms = PostureTerms::new(&pulled.setup, &reading.posture.q, None).unwrap();
        reading.wrench = Some(*terms.wrench());
    }
    let fit = Fit::new(&cell, &measured, &IdentifyOptions::default()).unwrap();
    let now = standing(&InterimEstimate::new(&fit).unwrap(), &postures[..1], Some(0.9)).unwrap();
    assert!(now.findings.is_empty());
    assert!(now.joints.iter().all(|joint| joint.total.is_some()));
    let largest = now.joints.iter().filter_map(|joint| joint.total);
    assert_eq!(now.largest, largest.reduce(f64::max));
    let next = next_posture(&fit, &rounds(1), Control::default()).unwrap();
    assert!(next.after.iter().all(Option::is_some));
}
