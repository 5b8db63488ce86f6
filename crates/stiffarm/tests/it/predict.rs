//! Deflection at work: against the reference numbers, against derivatives and
//! energies, and the bands against simulated experiments.

use crate::common::prelude::*;
use crate::common::{list, matrix, number, numbers, reference};
use stiffarm::estimate::common::CommonErrors;
use stiffarm::model::observation::RowPart;
use stiffarm::model::stiffness::cartesian_stiffness;
use stiffarm::work::predict::{LoadPoint, Prediction};

fn wrench(dice: &mut Dice, force: f64, moment: f64) -> Wrench {
    Wrench { force: dice.direction() * force, moment: dice.direction() * moment }
}

fn at(q: &[f64], wrench: Wrench) -> LoadedPosture {
    LoadedPosture::new("1", q.to_vec(), wrench)
}

/// Postures of the default cell's tasks and Group 1 [rad].
fn postures(cell: &Cell) -> Vec<Vec<f64>> {
    let tasks = cell.tasks.iter().map(|task| task.q.clone());
    tasks.chain(group1()).collect()
}

#[test]
fn deflection_and_stiffness_are_those_of_the_reference() {
    let cell = reference_cell();
    let predictor = prior(&cell);
    let mut count = 0;
    for golden in list(&reference()["postures"]) {
        let q = numbers(&golden["q_deg"]);
        let q: Vec<f64> = q.iter().map(|a| a.to_radians()).collect();
        // The rope pulls at the loading point; measuring point 1 is the tip.
        let arm = LoadedArm::new(&cell, &predictor).unwrap().loaded_at(cell.setup.tool.loading_point);
        let force = numbers(&golden["force"]);
        let pull = Wrench::force(Vector3::from_column_slice(&force[..3]));
        let terms = arm.terms(&q, &pull).unwrap();
        let linear = arm.linear(&terms);
        let expected = numbers(&golden["displacement_m1"]);
        assert!(relative_error(&linear.as_slice()[..expected.len()], &expected) < 1e-9);
        // The command's way to the same number.
        let options = with(|o: &mut PredictOptions| {
            o.model = Model::Linear;
            o.load_at = LoadPoint::LoadingPoint;
        });
        let work = [at(&q, pull)];
        let points = predict(&cell, &predictor, &work, &options, Control::default()).unwrap();
        assert!(relative_error(&points.points[0].shift_m, &expected[..3]) < 1e-9);
        let stiffness = cell.require_prior().unwrap();
        let p = terms.measuring_points()[0];
        // K from the reference's own Jacobian at the tip.
        let jacobian = matrix(&golden["J_measuring_1"]);
        let mut compliance = DMatrix::zeros(6, 6);
        for (j, k) in stiffness.iter().enumerate() {
            compliance += jacobian.column(j) * jacobian.column(j).transpose() / *k;
        }
        let cartesian = arm.cartesian(&q, &pull).unwrap();
        let ours = Matrix6::from_fn(|i, j| cartesian.compliance[i][j]);
        assert!(relative_error(ours.as_slice(), compliance.as_slice()) < 1e-9);
        let expected = compliance.try_inverse().unwrap();
        let ours = Matrix6::from_fn(|i, j| cartesian.matrix.unwrap()[i][j]);
        assert!(relative_error(ours.as_slice(), expected.as_slice()) < 1e-9);
        let salisbury = cartesian_stiffness(&cell.setup.robot, terms.frames(), &p, stiffness, None);
        assert!(relative_error(ours.as_slice(), salisbury.unwrap().unwrap().as_slice()) < 1e-9);
        count += 1;
    }
    assert_eq!(count, 5);
    assert!(number(&reference()["characteristic_length_m"]) > 0.0);
}

#[test]
fn stiffness_is_symmetric_and_inverts_the_compliance_of_all_that_gives_way() {
    let mut dice = Dice::new(5);
    for round in 0..200 {
        let model = dice.model(6 + round % 2, round % 4, round % 3 == 0, false);
        let mut cell = model.cell();
        let n = cell.setup.robot.joint_count();
        let mut predictor = prior(&cell);
        if round % 5 == 0 {
            let origin = dice.vector(0.3);
            cell.setup.tool.series_compliance =
                Some(SeriesCompliance::from_stiffness(origin, [1e7, 2e7, 3e7], [2e5, 3e5, 4e5]).unwrap());
        }
        if round % 7 == 0 {
            predictor.extra = vec![ExtraTerm::JointTilt(2), ExtraTerm::BaseTilt];
            predictor.values = DVector::from_iterator(n + 2, predictor.values.iter().copied().chain([3e-7, 1e-8]));
        }
        let arm = LoadedArm::new(&cell, &predictor).unwrap();
        let q = dice.posture(n);
        let load = wrench(&mut dice, 300.0, 20.0);
        let cartesian = arm.cartesian(&q, &load).unwrap();
        let compliance = Matrix6::from_fn(|i, j| cartesian.compliance[i][j]);
        let scale = compliance.amax();
        assert!((compliance - compliance.transpose()).amax() <= 1e-14 * scale);
        // The linear model is this compliance.
        let terms = arm.terms(&q, &load).unwrap();
        let expected = compliance * Vector6::from_iterator(load.force.iter().chain(load.moment.iter()).copied());
        let linear = arm.linear(&terms);
        assert!((linear - expected).amax() <= 1e-10 * linear.amax().max(1e-9), "round {round}");
        let Some(rows) = cartesian.matrix else { continue };
        let stiffness = Matrix6::from_fn(|i, j| rows[i][j]);
        assert!((stiffness - stiffness.transpose()).amax() == 0.0);
        // Rounding grows with the condition number of K.
        let left = (stiffness * compliance - Matrix6::identity()).amax();
        let condition = stiffness.norm() * compliance.norm();
        assert!(left <= 1e-14 * condition, "round {round}: {left:e}, condition {condition:e}");
        let principal = cartesian.principal;
        for (softer, stiffer) in principal.iter().zip(&principal[1..]) {
            let least = |axis: &stiffarm::work::predict::PrincipalAxis| axis.stiffness_n_per_m.unwrap_or(f64::MAX);
            assert!(least(softer) <= least(stiffer));
        }
        let u = Vector3::from(principal[0].direction);
        let block = compliance.fixed_view::<3, 3>(0, 0).into_owned();
        let along = u.dot(&(block * u)) * principal[0].stiffness_n_per_m.unwrap();
        assert!((along - 1.0).abs() < 1e-9);
    }
}

#[test]
fn equilibrium_is_the_one_of_the_constant_wrench_and_linear_in_the_limit() {
    let cell = default_cell();
    let stiffness = cell.require_prior().unwrap().to_vec();
    let arm = LoadedArm::from_stiffness(&cell, &stiffness).unwrap();
    let mut dice = Dice::new(8);
    for q in postures(&cell) {
        let load = wrench(&mut dice, 800.0, 60.0);
        let bent = arm.deflect(&q, &load).unwrap();
        // The same equilibrium by the module that identification uses.
        let mut setup = cell.setup.clone();
        setup.tool.loading_point = setup.tool.tcp();
        let other = equilibrium(&setup, &q, &stiffness, Some(&load)).unwrap();
        let tip = other.frames().point(&setup.tool.tcp());
        assert!((tip - bent.after.translation.vector).norm() < 1e-14);
        // Γ(θ) K⁻¹ = θ − θ₀ there.
        for (j, k) in stiffness.iter().enumerate() {
            let torque = other.terms.torque()[j];
            assert!((other.deflection[j] - torque / k).abs() < 1e-15);
        }
        let small = Wrench { force: load.force * 1e-4, moment: load.moment * 1e-4 };
        let bent = arm.deflect(&q, &small).unwrap();
        assert!((bent.displacement - bent.linear).amax() < 1e-6 * bent.linear.amax());
    }
}

#[test]
fn sensitivity_is_the_derivative_of_the_shift_by_the_unknowns() {
    let cell = default_cell();
    let mut predictor = prior(&cell);
    predictor.extra = vec![
        ExtraTerm::JointTilt(3),
        ExtraTerm::BaseTilt,
        ExtraTerm::LostMotion(1),
        ExtraTerm::Beam { joint: 3, part: RowPart::Axis, twist: false },
        ExtraTerm::Beam { joint: 2, part: RowPart::Link, twist: true },
    ];
    // All entries of all springs, which the arm puts together.
    for joint in std::iter::once(None).chain((0..6).map(Some)) {
        for column in 0..6 {
            let entry = |row| ExtraTerm::Spring { joint, row, column };
            predictor.extra.extend((0..=column).map(entry));
        }
    }
    let count = predictor.extra.len();
    let mut dice = Dice::new(9);
    let few = [2e-7, 1e-8, 1e-4, 1e-9, 1e-8];
    let entries = (few.len()..count).map(|_| dice.vector(1e-8).x);
    let values: Vec<f64> = few.into_iter().chain(entries).collect();
    let joints = LoadedArm::new(&cell, &prior(&cell)).unwrap();
    let all = predictor.values.iter().chain(&values).copied();
    predictor.values = DVector::from_iterator(6 + count, all);
    let arm = LoadedArm::new(&cell, &predictor).unwrap();
    for q in postures(&cell) {
        let load = wrench(&mut dice, 400.0, 30.0);
        let terms = arm.terms(&q, &load).unwrap();
        let sensitivity = arm.sensitivity(&terms);
        assert_eq!(sensitivity.shape(), (3, 6 + count));
        // The sum of what the terms do one by one.
        let mut sum = joints.linear(&terms);
        for (term, value) in predictor.extra.iter().zip(&values) {
            sum += term.twist(&terms, &terms.measuring_points()[0]) * *value;
        }
        assert!((sum - arm.linear(&terms)).amax() < 1e-14);
        for j in 0..6 + count {
            let mut more = predictor.clone();
            more.values[j] += 1e-3;
            let other = LoadedArm::new(&cell, &more).unwrap();
            // Linear in the unknowns, so that any step is exact.
            let change = (other.linear(&terms) - arm.linear(&terms)) / 1e-3;
            let column = sensitivity.column(j);
            for i in 0..3 {
                let error = (change[i] - column[i]).abs();
                assert!(error <= 1e-9 * column.amax() + 1e-14 * sensitivity.amax(), "unknown {j}: {error:e}");
            }
        }
    }
}

#[test]
fn tip_frame_of_the_cell_counts() {
    let mut cell = default_cell();
    let offset =
        Isometry3::from_parts(Vector3::new(0.02, -0.1, 0.4).into(), UnitQuaternion::from_euler_angles(0.3, -0.2, 1.0));
    cell.work.tip = Some(offset);
    let arm = LoadedArm::from_stiffness(&cell, &cell.prior.clone().unwrap()).unwrap();
    let q = &cell.tasks[0].q;
    let pose = arm.tip_pose(q);
    let flange = pose * offset.inverse();
    let frames = Frames::new(&cell.setup.robot, q);
    assert!((flange.translation.vector - frames.flange().translation.vector).norm() < 1e-14);
}

/// Identifies from one simulated experiment with the exact equilibrium as truth
/// and the cell's noise as the only error.
fn identified(cell: &Cell, group: &[Posture], estimator: Estimator, seed: u64) -> IdentifiedCompliance {
    let truth = cell.require_prior().unwrap();
    let measured = simulate_measurements(cell, group, truth, Model::Equilibrium, seed, 0).unwrap();
    let options = with(|o: &mut IdentifyOptions| {
        o.estimator = estimator;
        o.noise = NoiseSource::Estimated;
    });
    let identification = identify(cell, &measured, &options).unwrap();
    IdentifiedCompliance::from_identification(cell, &identification).unwrap()
}

fn group(cell: &Cell) -> Vec<Posture> {
    numbered(common::random_group().into_iter().chain(postures(cell)))
}

#[test]
fn bands_cover_what_they_say_when_noise_is_the_only_error() {
    let cell = default_cell();
    let group = group(&cell);
    let truth = LoadedArm::from_stiffness(&cell, &cell.prior.clone().unwrap()).unwrap();
    let mut dice = Dice::new(21);
    let work: Vec<LoadedPosture> = (0..12)
        .map(|i| {
            let base = &cell.tasks[i % 3].q;
            let q: Vec<f64> = base.iter().map(|a| a + dice.between(-0.3, 0.3)).collect();
            at(&q, wrench(&mut dice, 350.0, 15.0))
        })
        .collect();
    let exact: Vec<Vector6<f64>> = work.iter().map(|w| truth.deflect(&w.q, &w.wrench).unwrap().displacement).collect();
    // Two variances, the default, are conservative where no posture has a shift
    // of its own: 96.0 % in 16,000 experiments, against 94.8 % of the former.
    for (estimator, tolerance) in [(Estimator::Ordinary, 0.01), (Estimator::TwoVariance, 0.015)] {
        let (mut inside, mut size_inside, mut count) = (0, 0, 0);
        let experiments = runs(200);
        let mut squares = 0.0;
        for seed in 0..experiments {
            let predictor = identified(&cell, &group, estimator, seed);
            let prediction = predict(&cell, &predictor, &work, &PredictOptions::default(), Control::default());
            let before = inside;
            for (point, exact) in prediction.unwrap().points.iter().zip(&exact) {
                let band = point.band.unwrap();
                assert_eq!(band.common_m, [0.0; 3]);
                for i in 0..3 {
                    inside += usize::from((point.shift_m[i] - exact[i]).abs() <= band.total_m[i]);
                }
                let size = exact.fixed_rows::<3>(0).norm();
                size_inside += usize::from((point.deflection_m - size).abs() <= band.size_m[3]);
                count += 1;
            }
            squares += ((inside - before) as f64 / (3 * exact.len()) as f64).powi(2);
        }
        let share = inside as f64 / (3 * count) as f64;
        let size_share = size_inside as f64 / count as f64;
        println!("inside: {share:.4} of the components, {size_share:.4} of the sizes");
        // The components of an experiment share its errors: its share is one draw.
        let variance = squares / experiments as f64 - share * share;
        let error = (variance / experiments as f64).sqrt();
        let tolerance = tolerance + slack(error, experiments, 2000);
        assert!((share - 0.95).abs() <= tolerance, "{share}");
        assert!((size_share - 0.95).abs() <= tolerance, "{size_share}");
    }
}

#[test]
fn common_errors_and_the_load_widen_the_band_by_their_size() {
    let cell = default_cell();
    let group = group(&cell);
    let truth = cell.require_prior().unwrap();
    let measured = simulate_measurements(&cell, &group, truth, Model::Equilibrium, 3, 0).unwrap();
    let options = IdentifyOptions::default();
    let identification = identify(&cell, &measured, &options).unwrap();
    let plain = IdentifiedCompliance::from_identification(&cell, &identification).unwrap();
    let systematic = systematic_errors(&Fit::new(&cell, &measured, &options).unwrap()).unwrap();
    let total = plain.clone().with_systematic_errors(&systematic);
    let work = [at(&cell.tasks[1].q, cell.tasks[1].wrench)];
    let arm = LoadedArm::new(&cell, &plain).unwrap();
    let run = |predictor: &IdentifiedCompliance, load: f64| -> Prediction {
        // The bands are those of the linear model.
        let options = with(|o: &mut PredictOptions| {
            o.model = Model::Linear;
            o.load_uncertainty = load;
        });
        predict(&cell, predictor, &work, &options, Control::default()).unwrap()
    };
    let point = run(&total, 0.0).points[0].clone();
    let band = point.band.unwrap();
    let alone = run(&plain, 0.0).points[0].band.unwrap();
    assert_eq!(band.statistical_m, alone.statistical_m);
    assert!(band.size_m[1] > 0.0 && band.load_m == [0.0; 3]);
    // The force scale alone: 1 % of the deflection, at 1.96.
    let mut force = total.clone();
    force.common = total.common.only("force-scale");
    let scale = run(&force, 0.0).points[0].band.unwrap().size_m[1];
    let expected = 1.959_964 * 0.01 / 1.01 * point.deflection_m;
    assert!((scale / expected - 1.0).abs() < 1e-3, "{scale} against {expected}");
    // What an error of the experiment does to the prediction is what the changed
    // stiffness does; what acts again at work moves the tip the other way.
    for part in &total.common.parts {
        let mut moved = plain.clone();
        moved.values += &part.change;
        let shifted = run(&moved, 0.0).points[0].clone();
        let mut change = Vector3::from(point.shift_m) - Vector3::from(shifted.shift_m);
        if let Some((term, size)) = part.at_work {
            let terms = arm.terms(&work[0].q, &work[0].wrench).unwrap();
            change += term.column(&terms) * size;
        }
        let one = IdentifiedCompliance {
            spread: None,
            common: CommonErrors::independent(vec![part.clone()]),
            ..plain.clone()
        };
        let half = run(&one, 0.0).points[0].band.unwrap().common_m;
        for i in 0..3 {
            let expected = 1.959_964 * change[i].abs();
            let error_m = (half[i] - expected).abs();
            assert!(error_m <= 1e-6 * expected + 1e-14, "{}: {error_m}", part.source);
        }
    }
    assert_eq!(total.common.parts.iter().filter(|p| p.at_work.is_some()).count(), 7);
    let load = run(&plain, 0.1).points[0].band.unwrap();
    let expected = 0.195_996_4 * point.deflection_m;
    assert!((load.size_m[2] / expected - 1.0).abs() < 1e-6);
    let parts: f64 = load.size_m[..3].iter().map(|s| s * s).sum();
    assert!((load.size_m[3] - parts.sqrt()).abs() < 1e-15);
}

#[test]
fn says_which_model_and_whether_the_linear_one_would_do() {
    let cell = default_cell();
    let predictor = prior(&cell);
    let run = |force: f64, model| {
        let load = Wrench::force(Vector3::new(0.0, 0.0, -force));
        let options = with(|o: &mut PredictOptions| o.model = model);
        let work = [at(&cell.tasks[1].q, load)];
        predict(&cell, &predictor, &work, &options, Control::default()).unwrap()
    };
    let light = run(100.0, Model::Equilibrium);
    assert!(light.linear_suffices && light.linear_difference_max_m > 0.0);
    let heavy = run(2e4, Model::Linear);
    assert!(!heavy.linear_suffices);
    let codes: Vec<&str> = heavy.findings.iter().map(|f| f.code.as_str()).collect();
    assert_eq!(codes, ["model", "no-band", "tip-assumed"]);
    // A ± of many times the deflection makes a tenth of the deflection no small difference.
    let mut unsure = identified(&cell, &group(&cell), Estimator::TwoVariance, 1);
    unsure.spread.as_mut().unwrap().covariance *= 1e10;
    let load = Wrench::force(Vector3::new(0.0, 0.0, -1e5));
    let work = [at(&cell.tasks[1].q, load)];
    let options = PredictOptions::default();
    let heavy = predict(&cell, &unsure, &work, &options, Control::default()).unwrap();
    let point = &heavy.points[0];
    assert!(point.linear_difference_m > 0.1 * point.deflection_m);
    assert!(point.linear_difference_m < 0.1 * point.band.unwrap().size_m[3]);
    assert!(!heavy.linear_suffices);
    let none = run(0.0, Model::Equilibrium);
    assert!(none.findings.iter().any(|f| f.code == "no-load"));
    assert_eq!(none.deflection_max_m, 0.0);
}

#[test]
fn bad_input_is_refused_with_its_line() {
    let cell = default_cell();
    let predictor = prior(&cell);
    let options = PredictOptions::default();
    let run = |work: &[LoadedPosture]| predict(&cell, &predictor, work, &options, Control::default());
    assert!(run(&[]).is_err());
    let mut short = at(&[0.0; 5], Wrench::force(Vector3::x()));
    short.line = Some(7);
    assert_eq!(run(&[short]).unwrap_err().place().line, Some(7));
    let mut buckles = at(&cell.tasks[0].q, Wrench::force(Vector3::z() * -1e8));
    buckles.line = Some(9);
    let error = run(&[buckles]).unwrap_err();
    assert_eq!(error.place().line, Some(9));
    insta::assert_snapshot!(error, @"
    The loaded arm has no stable equilibrium near this posture.
      hint: check the load's magnitude and the unit of the joint stiffness (N·m/rad)
    ");
    // What noise made of a stiff joint is a value like any other; what is no number is not.
    for (value, is_used) in [(-1e-8, true), (f64::NAN, false), (f64::INFINITY, false)] {
        let mut other = predictor.clone();
        other.values[5] = value;
        let work = [at(&cell.tasks[0].q, Wrench::force(Vector3::x()))];
        let prediction = predict(&cell, &other, &work, &options, Control::default());
        assert_eq!(prediction.is_ok(), is_used, "{value}");
    }
}
