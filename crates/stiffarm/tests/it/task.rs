//! The task index is the error of the deflection predicted where the robot works.

use crate::common::cases::slip;
use crate::common::prelude::*;
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use stiffarm::model::cell::{Task, task_matrix, task_rows};

fn task_index<Q: AsRef<[f64]>>(cell: &Cell, postures: &[Q]) -> f64 {
    evaluate(cell, "", postures).unwrap().indices.task.unwrap()
}

/// B = J diag(Γ) in the springs' coordinates, from the Jacobian of kinematics.
fn block(cell: &Cell, task: &Task) -> DMatrix<f64> {
    let robot = &cell.setup.robot;
    let frames = Frames::new(robot, &task.q);
    let turn = match task.axes {
        Axes::Base => UnitQuaternion::identity(),
        Axes::Tool => frames.flange().rotation,
    };
    let jacobian = frames.jacobian(&frames.point(&task.tip));
    let force = turn * task.wrench.force;
    let moment = turn * task.wrench.moment;
    let wrench = DVector::from_iterator(6, force.iter().chain(moment.iter()).copied());
    let torque = jacobian.tr_mul(&wrench);
    let linear = DMatrix::from_fn(3, torque.len(), |i, j| jacobian[(i, j)]);
    let (columns, loads) = match robot.spring_mixing() {
        None => (linear, torque),
        Some(mixing) => (linear * mixing, mixing.tr_mul(&torque)),
    };
    columns * DMatrix::from_diagonal(&loads)
}

#[test]
fn value_is_that_of_the_formula() {
    let cell = reference_cell();
    let postures = group1();
    let psi = observation_matrix(&cell.setup, &postures, Rows::Translations).unwrap();
    let covariance = (psi.transpose() * &psi).try_inverse().unwrap();
    let sigma = cell.noise.displacement_std();
    let traces = cell.tasks.iter().map(|task| {
        let b = block(&cell, task);
        (&b * &covariance * b.transpose()).trace()
    });
    let expected = sigma * (traces.sum::<f64>() / 3.0).sqrt();
    let ours = task_index(&cell, &postures);
    assert!((ours / expected - 1.0).abs() < 1e-9, "{ours} {expected}");
    // Micrometres, where an arm of this kind bends by tenths of a millimetre.
    assert!((1e-6..1e-4).contains(&ours), "{ours}");
}

#[test]
fn value_is_the_spread_of_predictions_from_simulated_readings() {
    for tau in [0.0, 1.5e-5] {
        let mut cell = reference_cell();
        cell.noise.posture_common_std = tau;
        let postures = group1();
        let sigma = cell.noise.displacement_std();
        let psi = observation_matrix(&cell.setup, &postures, Rows::Translations).unwrap();
        let truth = DVector::from_iterator(6, cell.require_prior().unwrap().iter().map(|k| 1.0 / k));
        // Least squares with the covariance of the readings, by its Cholesky factor.
        let (rows, per_posture) = (psi.nrows(), 12);
        let covariance = DMatrix::from_fn(rows, rows, |i, j| {
            let variance = if i == j { sigma * sigma } else { 0.0 };
            let common = i / per_posture == j / per_posture && i % 3 == j % 3;
            variance + if common { tau * tau } else { 0.0 }
        });
        let lower = covariance.cholesky().unwrap().unpack();
        let factor = Factor::new(&lower.solve_lower_triangular(&psi).unwrap()).unwrap();
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        let runs = runs(400) as u32;
        let mut square = 0.0;
        for _ in 0..runs {
            let white = DVector::from_fn(rows, |_, _| rng.sample::<f64, _>(StandardNormal));
            let readings = &psi * &truth + &lower * white;
            let estimate = factor.solve(&lower.solve_lower_triangular(&readings).unwrap());
            for task in &cell.tasks {
                square += (block(&cell, task) * (&estimate - &truth)).norm_squared() / 3.0;
            }
        }
        let spread = (square / f64::from(runs)).sqrt();
        let ours = task_index(&cell, &postures);
        // Three standard errors of a root mean square, at most
        // as uncertain as with one degree of freedom each.
        let tolerance = 3.0 / (2.0 * f64::from(runs)).sqrt();
        assert!((spread / ours - 1.0).abs() < tolerance, "tau {tau}: {spread} {ours}");
    }
}

#[test]
fn the_predicted_shift_is_the_deflection_of_the_task() {
    let cell = reference_cell();
    let stiffness = cell.require_prior().unwrap();
    let compliance = compliance_of(stiffness);
    for task in &cell.tasks {
        let shift = task.block(&cell.setup.robot).unwrap() * &compliance;
        let setup = task.setup(&cell.setup.robot);
        let exact = equilibrium_displacement(&setup, &task.q, &task.tip, stiffness, None).unwrap();
        let exact = Vector3::new(exact[0], exact[1], exact[2]);
        // The linear model leaves out terms of the second order in the deflection.
        assert!((shift.norm() > 1e-4) && (shift - exact).norm() < 0.02 * exact.norm());
    }
}

#[test]
fn without_tasks_there_is_none_and_the_error_says_how_to_add_one() {
    let mut cell = reference_cell();
    cell.tasks.clear();
    assert_eq!(evaluate(&cell, "", &group1()).unwrap().indices.task, None);
    let (options, control) = (Options::default(), Control::default());
    let mut report = String::new();
    for (what, error) in [
        ("the matrix", task_matrix(&cell).err()),
        ("the index", IndexFunction::new(&cell, Index::Task, 3).err()),
        ("a selection", select_from(&cell, Index::Task, &group1(), options, control).err()),
    ] {
        let error = error.expect(what);
        assert_eq!(error.code(), Code::MissingKey, "{what}: {error}");
        assert_eq!(error.place().key.as_deref(), Some("task"), "{what}: {error}");
        report += &slip::<()>(what, Err(error));
    }
    insta::assert_snapshot!(report, @"
    » the matrix
    [missing-key] task: This needs your own machining postures and loads, and the cell has none.
      hint: add [[task]] with q_deg and force_n, once per posture of your work

    » the index
    [missing-key] task: This needs your own machining postures and loads, and the cell has none.
      hint: add [[task]] with q_deg and force_n, once per posture of your work

    » a selection
    [missing-key] task: This needs your own machining postures and loads, and the cell has none.
      hint: add [[task]] with q_deg and force_n, once per posture of your work
    ");
}

#[test]
fn tasks_that_make_no_sense_are_errors() {
    let mut cell = reference_cell();
    cell.tasks[1].q.pop();
    let error = evaluate(&cell, "", &group1()).unwrap_err();
    assert_eq!(error.code(), Code::Dimension);
    let mut cell = reference_cell();
    cell.tasks.truncate(1);
    cell.tasks[0].wrench.force = Vector3::zeros();
    let error = task_matrix(&cell).unwrap_err();
    assert_eq!(error.code(), Code::InvalidValue);
    assert_eq!(error.place().key.as_deref(), Some("task"));
}

#[test]
fn needs_no_prior_and_nothing_of_the_load_but_what_is_measured() {
    let cell = reference_cell();
    let ours = task_index(&cell, &group1());
    let mut blank = cell.clone();
    blank.prior = None;
    blank.characteristic_length = None;
    assert_eq!(task_index(&blank, &group1()), ours);
    // What only a measurement tells cannot be planned.
    blank.setup.load = Load::Measured;
    assert!(evaluate(&blank, "", &group1()).is_err());
    assert!(task_matrix(&blank).is_ok());
}

#[test]
fn selection_for_the_tasks_beats_selection_for_the_joints_at_them() {
    let cell = default_cell();
    let plan = |index| {
        let options = Options::default();
        select_from(&cell, index, &group1(), options, Control::default()).unwrap()
    };
    let (tasks, joints) = (plan(Index::Task), plan(Index::ExpectedError));
    let at_start = task_index(&cell, &group1());
    assert!(tasks.value < 0.7 * at_start, "{} {at_start}", tasks.value);
    let by_joints = joints.evaluation.indices.task.unwrap();
    assert!(tasks.value < by_joints, "{} {by_joints}", tasks.value);
    assert!(tasks.evaluation.indices.expected_error > joints.evaluation.indices.expected_error);
    assert!(tasks.smallest_margin_m.unwrap() >= 0.0);
}

proptest! {
    #![proptest_config(cases(24))]

    #[test]
    fn ignores_the_prior_and_follows_force_noise_and_copies(
        n in 3..8_usize,
        kind in 0..4_usize,
        elastic in any::<bool>(),
        common in any::<bool>(),
        seed in any::<u64>(),
    ) {
        let mut dice = Dice::new(seed);
        let cell = dice.model(n, kind, elastic, common).cell();
        let postures = dice.postures(n, 5);
        let before = evaluate(&cell, "", &postures).unwrap();
        prop_assume!(before.indices.condition.is_some_and(|c| c < 1e5));
        let before = before.indices.task.unwrap();
        let close = |cell: &Cell, expected: f64| {
            let ours = task_index(cell, &postures);
            prop_assert!((ours / expected - 1.0).abs() < 1e-9, "{ours} {expected}");
            Ok(())
        };

        let mut other = cell.clone();
        other.prior = Some((0..n).map(|_| 10f64.powf(dice.between(4.0, 7.0))).collect());
        prop_assert_eq!(task_index(&other, &postures), before);

        let mut stronger = cell.clone();
        let factor = dice.between(0.1, 10.0);
        for task in &mut stronger.tasks {
            task.wrench.force *= factor;
            task.wrench.moment *= factor;
        }
        close(&stronger, factor * before)?;

        let mut noisier = cell.clone();
        noisier.noise.reading_variance *= factor * factor;
        noisier.noise.posture_common_std *= factor;
        close(&noisier, factor * before)?;

        // A mean over tasks: the same ones twice change nothing.
        let mut twice = cell.clone();
        twice.tasks.extend(cell.tasks.clone());
        close(&twice, before)?;

        // A wrench in tool axes is that wrench turned into base axes.
        let mut turned = cell.clone();
        for task in turned.tasks.iter_mut().filter(|task| task.axes == Axes::Tool) {
            let rotation = Frames::new(&cell.setup.robot, &task.q).flange().rotation;
            task.wrench.force = rotation * task.wrench.force;
            task.wrench.moment = rotation * task.wrench.moment;
            task.axes = Axes::Base;
        }
        close(&turned, before)?;

        // The blocks are J diag(Γ) in the springs' coordinates.
        let rows = task_rows(&cell).unwrap();
        let share = (cell.tasks.len() as f64).sqrt();
        for (t, task) in cell.tasks.iter().enumerate() {
            let golden = block(&cell, task);
            let rows_of_task = rows.rows(3 * t, 3) * share;
            prop_assert!((rows_of_task - &golden).amax() < 1e-12 * golden.amax());
        }
        let matrix = task_matrix(&cell).unwrap();
        prop_assert!((rows.tr_mul(&rows) - &matrix).amax() <= 1e-14 * matrix.amax());
    }
}
