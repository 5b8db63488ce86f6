//! The mixed elastic model is that of dense matrices, of a published example and of other formulations of its springs,
//! and predicts the measured robot.

use crate::common::prelude::*;
use crate::estimators::{dense_covariance, random_system};

use crate::common::random_group;
use nalgebra::Matrix3;
use proptest::prelude::*;
use stiffarm::Wrench;
use stiffarm::estimate::elastic::elastic;
use stiffarm::estimate::mixed::MixedFit;
use stiffarm::estimate::validate::cross_validate_mixed;
use stiffarm::internals::{Block, Covariance, MeasuredSystem, MixedModel, RowLabel, link_axes};
use stiffarm::model::elastic::ElasticClass;
use stiffarm::model::observation::RowPart;

/// V of all rows in units of σ²: readings, shifts and random effects.
pub fn dense(
    system: &MeasuredSystem,
    gamma: f64,
    random: &DMatrix<f64>,
    classes: &[std::ops::Range<usize>],
    ratios: &[f64],
) -> DMatrix<f64> {
    let mut v = dense_covariance(system, gamma);
    for (class, ratio) in classes.iter().zip(ratios) {
        let columns = random.columns(class.start, class.len());
        v += columns * columns.transpose() * *ratio;
    }
    v
}

/// How the readings of a posture belong together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Readings {
    Independent,
    Correlated,
    /// Under equal loads, at twelve postures more: shifts of few sizes, and more of them than unknowns.
    EquallyLoaded,
}

pub fn any_readings() -> impl Strategy<Value = Readings> {
    prop_oneof![Just(Readings::Independent), Just(Readings::Correlated), Just(Readings::EquallyLoaded)]
}

/// A random system with columns of nine random effects in two classes, and their model.
pub fn random_model(
    seed: u64,
    postures: usize,
    unknowns: usize,
    readings: Readings,
) -> (MeasuredSystem, DMatrix<f64>, Vec<std::ops::Range<usize>>, MixedModel) {
    let mut dice = Dice::new(seed);
    let is_equally_loaded = readings == Readings::EquallyLoaded;
    let postures = if is_equally_loaded { postures + 12 } else { postures };
    let mut system = random_system(&mut dice, postures, unknowns, readings == Readings::Correlated);
    if is_equally_loaded {
        let loads = system.blocks.iter_mut().flat_map(|block| block.shared.iter_mut());
        loads.filter(|load| **load != 0.0).for_each(|load| *load = 1.0);
    }
    let random = DMatrix::from_fn(system.psi.nrows(), 9, |_, j| dice.between(-1.0, 1.0) * 3f64.powi(j as i32 / 4));
    let classes = vec![0..4, 4..9];
    let model = MixedModel::new(&system, &random, classes.clone()).unwrap();
    (system, random, classes, model)
}

proptest! {
    #![proptest_config(cases(30))]

    #[test]
    fn likelihood_effects_and_predictions_are_those_of_dense_matrices(
        seed in any::<u64>(), postures in 4..8_usize, unknowns in 1..4_usize, readings in any_readings(),
    ) {
        let (system, random, classes, model) = random_model(seed, postures, unknowns, readings);
        let rows = system.psi.nrows();
        let mut constant = None;
        for (gamma, ratios) in [(0.3, [0.5, 0.01]), (1e-3, [2.0, 30.0]), (20.0, [1e-4, 0.2])] {
            let v = dense(&system, gamma, &random, &classes, &ratios);
            let inverse = v.clone().try_inverse().unwrap();
            let information = system.psi.transpose() * &inverse * &system.psi;
            let covariance = information.clone().try_inverse().unwrap();
            let h = &covariance * system.psi.transpose() * &inverse * &system.delta;
            let left = &system.delta - &system.psi * &h;
            let squares = (left.transpose() * &inverse * &left)[(0, 0)];
            let free = (rows - unknowns) as f64;
            let determinant = |m: &DMatrix<f64>| {
                let l = m.clone().cholesky().unwrap().l();
                2.0 * l.diagonal().iter().map(|v| v.ln()).sum::<f64>()
            };
            let direct = free * (squares / free).ln() + determinant(&v) + determinant(&information);
            let (value, gradient) = model.value(gamma, &ratios).unwrap();
            let constant = *constant.get_or_insert(value - direct);
            prop_assert!((value - direct - constant).abs() < 1e-8, "{}", value - direct - constant);

            // h and u = Λ BᵀV⁻¹(Δ − Ψh), and how far an effect may be from its prediction.
            let (ours, ours_covariance, variance) = model.solve(gamma, &ratios, &[]).unwrap();
            prop_assert!((variance / (squares / free) - 1.0).abs() < 1e-9);
            let lambda = DVector::from_fn(9, |j, _| ratios[usize::from(j >= 4)]);
            let u = (random.transpose() * &inverse * &left).component_mul(&lambda);
            let projected = &inverse - &inverse * &system.psi * &covariance * system.psi.transpose() * &inverse;
            for j in 0..unknowns {
                let error = (covariance[(j, j)] * variance).sqrt();
                prop_assert!((ours[j] - h[j]).abs() < 1e-8 * error);
                prop_assert!((ours_covariance[(j, j)].sqrt() / error - 1.0).abs() < 1e-8);
            }
            for j in 0..9 {
                let column = random.column(j);
                let explained = lambda[j].powi(2) * (column.transpose() * &projected * column)[(0, 0)];
                let direct = (lambda[j] - explained) * variance;
                let at = unknowns + j;
                prop_assert!((ours[at] - u[j]).abs() < 1e-8 * (lambda[j] * variance).sqrt());
                prop_assert!((ours_covariance[(at, at)] - direct).abs() < 1e-8 * lambda[j] * variance);
            }

            // The average of observed and expected curvature, with σ² at its best.
            let mut parts = vec![dense_covariance(&system, gamma) - dense_covariance(&system, 0.0)];
            parts.extend(classes.iter().zip(ratios).map(|(class, ratio)| {
                let columns = random.columns(class.start, class.len());
                columns * columns.transpose() * ratio
            }));
            let scattered = parts.iter().map(|part| part * &inverse * &left);
            let scattered = DMatrix::from_columns(&scattered.collect::<Vec<_>>());
            let along = scattered.transpose() * &inverse * &left;
            let average = scattered.transpose() * &projected * &scattered - &along * along.transpose() / squares;
            let ours = model.curvature(gamma, &ratios).unwrap() * (squares / free);
            prop_assert!((&ours - &average).amax() < 1e-8 * average.amax(), "{ours} {average}");

            // Derivatives by differences.
            let at = |k: usize, h: f64| {
                let mut ratios = ratios;
                let gamma = if k == 0 { gamma * h.exp() } else { gamma };
                if k > 0 {
                    ratios[k - 1] *= h.exp();
                }
                model.value(gamma, &ratios).unwrap().0
            };
            for k in 0..3 {
                let h = 1e-5;
                let numeric = (at(k, h) - at(k, -h)) / (2.0 * h);
                prop_assert!((gradient[k] - numeric).abs() < 1e-5 * (1.0 + numeric.abs()), "{k}: {} {numeric}", gradient[k]);
            }
        }
    }
}

/// Travel times in six rails, three readings each: Pinheiro & Bates, Mixed-Effects Models
/// in S and S-PLUS, 2000, section 1.1.
pub fn rails() -> MixedModel {
    let times =
        [55.0, 53.0, 54.0, 26.0, 37.0, 32.0, 78.0, 91.0, 85.0, 92.0, 100.0, 96.0, 49.0, 51.0, 50.0, 80.0, 85.0, 83.0];
    let blocks = (0..6).map(|b| Block {
        posture: b.to_string(),
        rows: 3 * b..3 * b + 3,
        covariance: Covariance::default(),
        shared: DMatrix::zeros(3, 0),
    });
    let labels = (0..6).map(|b| RowLabel { measured: b, displacement: 0, rows: 3 * b..3 * b + 3 });
    let system = MeasuredSystem {
        psi: DMatrix::from_element(18, 1, 1.0),
        delta: DVector::from_column_slice(&times),
        unknowns: vec!["mean".to_string()],
        springs: 1,
        extra: Vec::new(),
        blocks: blocks.collect(),
        labels: labels.collect(),
    };
    let rails = DMatrix::from_fn(18, 6, |i, j| f64::from(u8::from(i / 3 == j)));
    MixedModel::new(&system, &rails, std::iter::once(0..6).collect()).unwrap()
}

/// They print 24.80547 and 4.020779 by REML.
#[test]
fn the_rails_of_pinheiro_and_bates() {
    let model = rails();
    let (gamma, ratios, _) = model.best().unwrap();
    let (values, _, variance) = model.solve(gamma, &ratios, &[]).unwrap();
    assert!((values[0] - 66.5).abs() < 1e-9, "{}", values[0]);
    assert!((variance.sqrt() - 4.020779).abs() < 1e-5, "{}", variance.sqrt());
    let rail = (ratios[0] * variance).sqrt();
    assert!((rail - 24.80547).abs() < 1e-4, "{rail}");
}

/// Entries of a general spring are those of C in C w, seen from the base; tilts and what
/// is the same in all directions need no axes.
#[test]
fn springs_are_symmetric_compliances() {
    let cell = default_cell();
    let mut dice = Dice::new(5);
    for q in random_group() {
        let terms = PostureTerms::new(&cell.setup, &q, None).unwrap();
        let p = terms.measuring_points()[1];
        let beside = |joint, row, column| ExtraTerm::Spring { joint, row, column }.twist(&terms, &p);
        // With what counts as the compliance of the axis that follows.
        let spring = |joint: Option<usize>, row: usize, column: usize| {
            let direct = beside(joint, row, column);
            let next = joint.map_or(0, |j| j + 1);
            if row < 3 || next == 6 || (joint.is_some() && row == 5) {
                return direct;
            }
            let axes = joint.map_or(Matrix3::identity(), |j| link_axes(terms.frames(), j));
            let along = |i: usize| axes.column(i - 3).dot(&terms.frames().axes()[next]);
            let twice = if row == column { 1.0 } else { 2.0 };
            direct + beside(Some(next), 5, 5) * (twice * along(row) * along(column))
        };
        // About axis 1 the base's turn is that axis's own.
        assert!(beside(None, 5, 5).norm() < 1e-9 * spring(None, 5, 5).norm());
        for j in 0..6 {
            let tilt = ExtraTerm::JointTilt(j).twist(&terms, &p);
            let same = spring(Some(j), 3, 3) + spring(Some(j), 4, 4);
            assert!((tilt - same).norm() < 1e-9 * tilt.norm(), "{tilt} {same}");
            let shift = (0..3).fold(Vector6::zeros(), |sum, i| sum + spring(Some(j), i, i));
            let force = terms.wrench().force;
            assert!((shift.fixed_rows::<3>(0) - force).norm() < 1e-9 * force.norm());
            // The axis itself: J Γ of Eq. (11).
            let axis = spring(Some(j), 5, 5);
            let column = terms.frames().column(j, &p) * terms.torque()[j];
            assert!((axis.fixed_rows::<3>(0) - column).norm() < 1e-9 * column.norm().max(1.0));
        }
        // The base has the axes of the base frame.
        let c = DMatrix::from_fn(6, 6, |_, _| dice.between(-1.0, 1.0));
        let c = &c + c.transpose();
        let frames = terms.frames();
        let (axis, origin) = (frames.axes()[0], frames.origins()[0]);
        let origin: Vector3<f64> = origin - axis * axis.dot(&origin);
        let wrench = terms.wrench().moved(terms.loading_point(), &origin);
        let w = DVector::from_iterator(6, wrench.force.iter().chain(wrench.moment.iter()).copied());
        let motion = &c * w;
        let turn = Vector3::new(motion[3], motion[4], motion[5]);
        let shift = Vector3::new(motion[0], motion[1], motion[2]) + turn.cross(&(p - origin));
        let mut ours = Vector6::zeros();
        for row in 0..6 {
            for column in row..6 {
                ours += spring(None, row, column) * c[(row, column)];
            }
        }
        assert!((ours.fixed_rows::<3>(0) - shift).norm() < 1e-9 * shift.norm());
        assert!((ours.fixed_rows::<3>(3) - turn).norm() < 1e-9 * turn.norm());
    }
}

/// An even beam is many short springs one after the other: bending about every direction across its line alike, or twist
/// about it. d of a row lies along its axis, a of the next row from there to the next axis.
#[test]
fn beams_are_many_short_springs() {
    let cell = default_cell();
    const PIECES: usize = 2000;
    for q in random_group() {
        let terms = PostureTerms::new(&cell.setup, &q, None).unwrap();
        let p = terms.measuring_points()[1];
        let frames = terms.frames();
        // Row 4 of the robot: a = 250 mm behind joint 3, then d = 1444 mm along joint 4 to the wrist.
        let (origins, axis) = (frames.origins(), frames.axes()[3]);
        for (joint, part, length) in [(2, RowPart::Link, 0.250), (3, RowPart::Axis, 1.444)] {
            let start = origins[joint];
            let end = match part {
                RowPart::Link => origins[3],
                RowPart::Axis => start + axis * length,
            };
            assert!(((end - start).norm() - length).abs() < 1e-9);
            assert!((end - origins[joint + 1]).norm() < 1e-9);
            let line = (end - start) / length;
            for twist in [false, true] {
                let mut sum = Vector6::zeros();
                for piece in 0..PIECES {
                    let at = start + line * length * ((piece as f64 + 0.5) / PIECES as f64);
                    let moment = terms.wrench().moved(terms.loading_point(), &at).moment;
                    let along = line * line.dot(&moment);
                    let turn = if twist { along } else { moment - along };
                    let turn = turn * (length / PIECES as f64);
                    let shift = turn.cross(&(p - at));
                    sum += Vector6::new(shift.x, shift.y, shift.z, turn.x, turn.y, turn.z);
                }
                let beam = ExtraTerm::Beam { joint, part, twist };
                let ours = beam.twist(&terms, &p);
                assert!((ours - sum).norm() < 1e-6 * sum.norm().max(1e-3), "{ours} {sum}");
            }
        }
    }
}

/// Values and sizes against dense matrices: entries that cannot be negative share a mean of their own size, and what the
/// doubt says is the prior with which the solution comes out.
#[test]
fn what_cannot_be_negative_scatters_about_a_mean() {
    let (cell, mut measured) = simulated(6);
    bend(&cell, &mut measured, 11, [1e-7, 1.5e-7, 1e-7]);
    let fit = Fit::new(&cell, &measured, &IdentifyOptions::default()).unwrap();
    let mixed = MixedFit::new(&fit).unwrap();
    let estimate = mixed.compliance();
    let spread = estimate.spread.as_ref().unwrap();
    let doubt = spread.doubt.as_ref().unwrap();
    let count = estimate.values.len();
    let mut prior = DMatrix::from_diagonal(&doubt.prior);
    for mean in &doubt.means {
        for i in mean.clone() {
            for k in mean.clone() {
                prior[(i, k)] += (doubt.prior[i] * doubt.prior[k]).sqrt();
            }
        }
    }
    assert!(doubt.means.iter().any(|mean| mean.len() > 10));
    let (mut psi, mut delta) = (Vec::new(), Vec::new());
    for m in &measured {
        let terms = PostureTerms::new(&cell.setup, &m.posture.q, None).unwrap();
        psi.push(terms.block_with(&cell.setup.robot, &estimate.extra));
        delta.extend(m.displacements.iter().flat_map(|d| d.value.data.0[0]));
    }
    let points = cell.setup.tool.point_count();
    let rows = delta.len();
    let all = DMatrix::from_fn(rows, count, |i, j| psi[i / (3 * points)][(i % (3 * points), j)]);
    let delta = DVector::from_vec(delta);
    let mut v = DMatrix::identity(rows, rows) * spread.sigma.powi(2);
    // All loads are alike: a shift of one size in each posture.
    for b in 0..measured.len() {
        for i in 0..3 * points {
            for k in 0..3 * points {
                if i % 3 == k % 3 {
                    v[(3 * points * b + i, 3 * points * b + k)] += spread.shift.powi(2);
                }
            }
        }
    }
    v += &all * &prior * all.transpose();
    let inverse = v.try_inverse().unwrap();
    let fixed = all.columns(0, 6).into_owned();
    let h = (fixed.transpose() * &inverse * &fixed).try_inverse().unwrap() * fixed.transpose() * &inverse * &delta;
    let u = &prior * all.transpose() * &inverse * (&delta - &fixed * &h);
    let of_h = (0..6).map(|j| (h[j] - estimate.values[j]).abs() / h[j].abs());
    assert!(of_h.fold(0.0, f64::max) < 1e-6, "{h} {}", estimate.values.rows(0, 6));
    let scale = u.rows(6, count - 6).amax();
    let off = (u.rows(6, count - 6) - estimate.values.rows(6, count - 6)).amax();
    assert!(off < 1e-6 * scale, "{off} of {scale}");
}

/// k of a joint is the stiffness with which joint axes alone best reproduce what the model predicts over the cell: by 4000 others, and by least squares on them.
#[test]
fn k_reproduces_the_arm_over_the_cell() {
    let (cell, mut measured) = simulated(7);
    bend(&cell, &mut measured, 12, [1e-7, 1.5e-7, 1e-7]);
    let fit = Fit::new(&cell, &measured, &IdentifyOptions::default()).unwrap();
    let mixed = MixedFit::new(&fit).unwrap();
    let estimate = mixed.compliance();
    let postures = stiffarm::plan::select::random_group(&cell, StartKind::Uniform, 4000, 77, 0).unwrap();
    let (mut information, mut right) = (DMatrix::zeros(6, 6), DVector::zeros(6));
    for q in &postures {
        let terms = PostureTerms::new(&cell.setup, q, None).unwrap();
        let all = terms.block_with(&cell.setup.robot, &estimate.extra);
        let axes = all.columns(0, 6).into_owned();
        information += axes.tr_mul(&axes);
        right += axes.tr_mul(&(&all * &estimate.values));
    }
    let direct = information.try_inverse().unwrap() * right;
    // Springs by chance, as large as these: 4000 postures against 1000 leave some percent.
    let mut apart: f64 = 0.0;
    for (joint, h) in mixed.joints().unwrap().iter().zip(direct.iter()) {
        let ratio = joint.stiffness.unwrap() * h;
        assert!((ratio - 1.0).abs() < 0.12, "{}: {ratio}", joint.name);
        let estimated = estimate.values[joint.name[6..].parse::<usize>().unwrap() - 1];
        apart = apart.max((h / estimated - 1.0).abs());
    }
    // It is not what the model has for the joint's own axis.
    assert!(apart > 0.5, "{apart}");
}

fn simulated(seed: u64) -> (Cell, Vec<MeasuredPosture>) {
    let mut cell = default_cell();
    cell.noise.readings_per_displacement = 2;
    let angles = group1().into_iter().chain(random_group());
    let postures = numbered(angles);
    let truth = cell.prior.clone().unwrap();
    let measured = simulate_measurements(&cell, &postures, &truth, Model::Linear, seed, 0).unwrap();
    (cell, measured)
}

/// Adds what springs beyond the axes do: sizes of shift, turn and coupling.
pub fn bend(cell: &Cell, measured: &mut [MeasuredPosture], seed: u64, sizes: [f64; 3]) {
    let mut dice = Dice::new(seed);
    let mut normal = || (0..12).map(|_| dice.between(0.0, 1.0)).sum::<f64>() - 6.0;
    let mut springs = Vec::new();
    for joint in std::iter::once(None).chain((0..6).map(Some)) {
        for row in 0..6 {
            for column in row..6 {
                let size = sizes[ElasticClass::of(row, column) as usize];
                let size = if row == column { size } else { size * 0.5f64.sqrt() };
                if joint.is_none() || (row, column) != (5, 5) {
                    springs.push((ExtraTerm::Spring { joint, row, column }, size * normal()));
                }
            }
        }
    }
    move_points(cell, measured, |terms| {
        let columns = springs.iter().map(|(term, value)| term.column(terms) * *value);
        columns.reduce(|sum, column| sum + column).unwrap()
    });
}

/// Where only noise is beyond the axes, the mixed model is theirs; where more gives
/// way, it says how much and predicts better.
#[test]
fn the_data_decide_what_gives_way() {
    let (cell, measured) = simulated(3);
    let options = IdentifyOptions::default();
    let fit = Fit::new(&cell, &measured, &options).unwrap();
    let (choice, mixed) = elastic(&fit, true).unwrap();
    assert!(choice.likelihood_ratio.unwrap() < 6.0 && !choice.is_better());
    insta::assert_snapshot!(choice.reasons[0], @"With joints and base that give way in all directions, a posture that took no part is missed by 0.013 mm (RMS), no less than the 0.013 mm of the joint axes alone, and the data do not need more than the axes.");
    let mixed = mixed.unwrap();
    let by_axes = &fit.identification().unwrap().estimates.joints;
    for (axis, joint) in by_axes.iter().zip(mixed.joints().unwrap()) {
        let ratio = joint.stiffness.unwrap() / axis.stiffness.unwrap();
        assert!((ratio - 1.0).abs() < 1e-3, "{}: {ratio}", axis.name);
    }

    let (cell, mut measured) = simulated(4);
    bend(&cell, &mut measured, 9, [1e-7, 1.5e-7, 1e-7]);
    let fit = Fit::new(&cell, &measured, &options).unwrap();
    let (choice, mixed) = elastic(&fit, true).unwrap();
    assert_eq!(choice.model, ElasticChoice::Mixed, "{:?}", choice.reasons);
    assert!(choice.mixed_rms_m.unwrap() < choice.axes_rms_m.unwrap());
    let mixed = mixed.unwrap();
    let by = validate_with(&cell, mixed.compliance(), measured, Model::Linear, None).unwrap();
    assert!(by.component_rms_m < choice.mixed_rms_m.unwrap());
}

#[test]
fn few_postures_and_other_estimators_are_refused_with_reasons() {
    let (cell, measured) = simulated(5);
    let few = measured[..3].to_vec();
    let fit = Fit::new(&cell, &few, &IdentifyOptions::default()).unwrap();
    let (choice, mixed) = elastic(&fit, false).unwrap();
    assert_eq!(choice.model, ElasticChoice::Axes);
    assert!(mixed.is_none());
    insta::assert_snapshot!(choice.reasons[0], @"The joint axes alone predict. Fewer than 4 postures cannot show what gives way beyond them.");
    let mut options = IdentifyOptions::default();
    options.extra = vec![ExtraTerm::JointTilt(2)];
    let fit = Fit::new(&cell, &measured, &options).unwrap();
    let error = MixedFit::new(&fit).err().unwrap();
    assert_eq!(error.code(), Code::Conflict);
}

/// Few postures of an arm that gives way much may leave an axis of the mixed model without a
/// positive compliance. It is a broad one: what is predicted holds all the same.
#[test]
fn an_axis_without_positive_compliance_is_a_broad_one() {
    let (mut inside, mut components, mut open) = (0, 0, 0);
    for seed in 0..40 {
        let (cell, all) = simulated(seed);
        let mut all = all;
        bend(&cell, &mut all, seed + 100, [4e-7, 6e-7, 4e-7]);
        let left_out = all.split_off(5);
        let fit = Fit::new(&cell, &all, &IdentifyOptions::default()).unwrap();
        let Ok(mixed) = MixedFit::new(&fit) else {
            continue;
        };
        let predictor = mixed.compliance();
        if predictor.values.rows(0, 6).min() > 0.0 {
            continue;
        }
        open += 1;
        let (choice, _) = elastic(&fit, false).unwrap();
        assert_eq!(choice.model, ElasticChoice::Mixed, "{:?}", choice.reasons);
        assert!(predictor.spring_stiffness(&cell).contains(&None));
        let joints = mixed.joints().unwrap();
        assert!(joints.iter().any(|j| j.compliance < Some(0.0) && j.stiffness.is_none_or(|k| k < 0.0)));
        let validation = validate_with(&cell, predictor, &left_out, Model::Linear, None).unwrap();
        let band = validation.band.unwrap();
        inside += band.inside;
        components += band.components;
        let force = Wrench::force([100.0, -200.0, -300.0]);
        let work = [LoadedPosture::new("a", left_out[0].posture.q.clone(), force)];
        let options = Default::default();
        let bent = predict(&cell, predictor, &work, &options, Control::default()).unwrap();
        assert!(bent.deflection_max_m < 0.1 && bent.points[0].band.is_some());
        if open as u64 == runs(2) {
            break;
        }
    }
    assert!(open > 1);
    assert!(inside as f64 > 0.85 * components as f64, "{inside} of {components}");
}

/// The measured robot: what the documentation says of it.
#[test]
fn the_measured_robot_needs_the_mixed_model() {
    let (cell, measured) = crate::common::readings::measured_robot();
    let fit = Fit::new(&cell, &measured, &IdentifyOptions::default()).unwrap();
    let (choice, mixed) = elastic(&fit, true).unwrap();
    assert_eq!(choice.model, ElasticChoice::Mixed);
    let mm = |m: f64| (1e7 * m).round() / 1e4;
    assert_eq!(mm(choice.axes_rms_m.unwrap()), 0.2339);
    let nested = mm(choice.mixed_rms_m.unwrap());
    assert!(nested <= 0.135, "{nested}");
    let mixed = mixed.unwrap();
    // The load is measured, so that k reproduces the measured postures: what least squares with the axes alone find, but
    // that shifts in proportion to the load weigh these a little differently.
    let ordinary = by(Estimator::Ordinary);
    let plain = identify(&cell, &measured, &ordinary).unwrap();
    for (joint, axis) in mixed.joints().unwrap().iter().zip(&plain.estimates.joints) {
        let ratio = joint.stiffness.unwrap() / axis.stiffness.unwrap();
        assert!((ratio - 1.0).abs() < 0.03, "{}: {ratio}", joint.name);
    }
    let by = cross_validate_mixed(&mixed, 43, None).unwrap();
    let factor = by.compensation_factor.unwrap();
    assert!(factor >= 6.3, "{factor}");
    let share = by.band.unwrap();
    let inside = share.inside as f64 / share.components as f64;
    assert!((0.93..=0.97).contains(&inside), "{inside}");
}
