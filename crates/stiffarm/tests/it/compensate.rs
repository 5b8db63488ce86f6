//! The loaded tip arrives where it is commanded to, and what is left when the truth differs from the model is told.

use crate::common::prelude::*;
use crate::common::random_group;
use stiffarm::work::compensate::{CompensateOptions, command, compensate};

fn load(dice: &mut Dice, force: f64, moment: f64) -> Wrench {
    Wrench { force: dice.direction() * force, moment: dice.direction() * moment }
}

fn with_terms(predictor: &IdentifiedCompliance, terms: &[(ExtraTerm, f64)]) -> IdentifiedCompliance {
    let values = predictor.values.iter().copied();
    let all = values.chain(terms.iter().map(|(_, value)| *value));
    IdentifiedCompliance {
        values: DVector::from_vec(all.collect()),
        extra: terms.iter().map(|(term, _)| *term).collect(),
        ..predictor.clone()
    }
}

/// Shift and turn from one pose to another.
fn gap(from: &Isometry3<f64>, to: &Isometry3<f64>) -> (f64, f64) {
    let shift = (to.translation.vector - from.translation.vector).norm();
    (shift, to.rotation.angle_to(&from.rotation))
}

/// The mirror correction as it is usually described: command, bend, subtract the
/// error from the command, again; each pose reached by Newton's method.
fn mirrored(arm: &LoadedArm, nominal: &[f64], wrench: &Wrench, times: usize) -> Vec<f64> {
    let target = arm.tip_pose(nominal);
    let mut aim = target;
    let mut q = nominal.to_vec();
    for _ in 0..times {
        let loaded = arm.deflect(&q, wrench).unwrap().after;
        aim = Isometry3::from_parts(
            Translation3::from(aim.translation.vector + target.translation.vector - loaded.translation.vector),
            target.rotation * loaded.rotation.inverse() * aim.rotation,
        );
        for _ in 0..20 {
            let pose = arm.tip_pose(&q);
            let shift = aim.translation.vector - pose.translation.vector;
            let turn = (aim.rotation * pose.rotation.inverse()).scaled_axis();
            let error = Vector6::new(shift.x, shift.y, shift.z, turn.x, turn.y, turn.z);
            let terms = arm.terms(&q, wrench).unwrap();
            let jacobian = terms.frames().jacobian(&terms.measuring_points()[0]);
            let in_q = jacobian * arm.robot().coupling();
            let step = in_q.fixed_view::<6, 6>(0, 0).into_owned().lu().solve(&error).unwrap();
            for (angle, change) in q.iter_mut().zip(step.iter()) {
                *angle += change;
            }
        }
    }
    q
}

#[test]
fn the_loaded_tip_arrives_and_the_mirror_correction_converges_to_the_same() {
    let cell = default_cell();
    let arm = LoadedArm::new(&cell, &prior(&cell)).unwrap();
    let mut dice = Dice::new(3);
    for q in random_group() {
        let wrench = load(&mut dice, 900.0, 80.0);
        let commanded = command(&arm, &q, &wrench).unwrap();
        let (shift, turn) = gap(&commanded.nominal, &commanded.loaded);
        assert!(shift < 1e-14 && turn < 1e-14, "{shift:e} m, {turn:e} rad");
        let bent = arm.deflect(&q, &wrench).unwrap();
        assert!(bent.displacement.fixed_rows::<3>(0).norm() > 1e-4);
        let mirrored = mirrored(&arm, &q, &wrench, 8);
        for (ours, other) in commanded.q.iter().zip(&mirrored) {
            assert!((ours - other).abs() < 1e-11);
        }
    }
}

#[test]
fn arrives_for_any_arm_and_with_all_that_gives_way_beyond_the_joints() {
    let mut dice = Dice::new(4);
    let mut most: f64 = 0.0;
    for round in 0..300 {
        let n = 5 + round % 3;
        let model = dice.model(n, round % 4, round % 3 == 0, false);
        let mut cell = model.cell();
        let mut predictor = prior(&cell);
        let beyond = n > 5 && round % 2 == 0;
        if beyond {
            let origin = dice.vector(0.2);
            cell.setup.tool.series_compliance =
                Some(SeriesCompliance::from_stiffness(origin, [1e7; 3], [3e5; 3]).unwrap());
            predictor = with_terms(
                &predictor,
                &[(ExtraTerm::JointTilt(2), 2e-7), (ExtraTerm::BaseTilt, 1e-8), (ExtraTerm::LostMotion(1), 5e-5)],
            );
        }
        let arm = LoadedArm::new(&cell, &predictor).unwrap();
        let q = dice.posture(n);
        let wrench = load(&mut dice, 200.0, 10.0);
        // A random posture may be near singular, which is another test.
        let flexible = arm.cartesian(&q, &wrench).unwrap();
        let principal = flexible.principal;
        let least = |i: usize| principal[i].stiffness_n_per_m.unwrap_or(f64::INFINITY);
        if beyond && least(2) > 100.0 * least(0) {
            continue;
        }
        let commanded = command(&arm, &q, &wrench).unwrap();
        let (shift, turn) = gap(&commanded.nominal, &commanded.loaded);
        most = most.max(shift).max(turn);
        assert!(shift < 1e-11 && turn < 1e-11, "round {round}: {shift:e} m, {turn:e} rad");
    }
    println!("largest gap {most:e}");
}

/// Displacements that an arm with these values would show, with noise.
fn measured(cell: &Cell, truth: &IdentifiedCompliance, group: &[Vec<f64>], dice: &mut Dice) -> Vec<MeasuredPosture> {
    let sigma = cell.noise.displacement_std();
    let postures = group.iter().enumerate();
    postures
        .map(|(i, q)| {
            let at_loading = PostureTerms::new(&cell.setup, q, None).unwrap();
            let points = cell.setup.tool.measuring_points.iter().enumerate();
            let displacements = points.map(|(point, measuring)| {
                let mut view = cell.clone();
                view.work.tip = Some(Isometry3::from_parts(measuring.position.into(), UnitQuaternion::identity()));
                let arm = LoadedArm::new(&view, truth).unwrap().loaded_at(cell.setup.tool.loading_point);
                let bent = arm.deflect(q, at_loading.wrench()).unwrap();
                let shift: Vector3<f64> = bent.displacement.fixed_rows::<3>(0).into_owned();
                Displacement::new(point, shift + dice.noise(sigma))
            });
            let posture = Posture { name: format!("P{}", i + 1), q: q.clone() };
            MeasuredPosture::new(posture, displacements.collect())
        })
        .collect()
}

/// Postures and loads of a path.
fn work(cell: &Cell, dice: &mut Dice, count: usize) -> Vec<LoadedPosture> {
    (0..count)
        .map(|i| {
            let base = &cell.tasks[i % 3].q;
            LoadedPosture {
                name: (i + 1).to_string().into(),
                line: Some(i + 2),
                feature: None,
                q: base.iter().map(|a| a + dice.between(-0.3, 0.3)).collect(),
                wrench: load(dice, 350.0, 10.0),
            }
        })
        .collect()
}

/// RMS errors on the arm `truth`: without compensation and with the commands.
fn errors(
    cell: &Cell,
    truth: &IdentifiedCompliance,
    model: &IdentifiedCompliance,
    work: &[LoadedPosture],
) -> (f64, f64) {
    let real = LoadedArm::new(cell, truth).unwrap();
    let assumed = LoadedArm::new(cell, model).unwrap();
    let (mut before, mut after) = (0.0, 0.0);
    for w in work {
        let target = real.tip_pose(&w.q);
        let bent = real.deflect(&w.q, &w.wrench).unwrap();
        before += gap(&target, &bent.after).0.powi(2);
        let q = command(&assumed, &w.q, &w.wrench).unwrap().q;
        let loaded = real.deflect(&q, &w.wrench).unwrap().after;
        after += gap(&target, &loaded).0.powi(2);
    }
    let count = work.len() as f64;
    ((before / count).sqrt(), (after / count).sqrt())
}

#[test]
fn with_noise_only_the_path_error_falls_fiftyfold() {
    let cell = default_cell();
    let truth = prior(&cell);
    let mut dice = Dice::new(17);
    // Twelve postures within the cell, measured once.
    let group: Vec<Vec<f64>> = random_group().into_iter().chain(group1()).collect();
    let mut factors = Vec::new();
    for _ in 0..50 {
        let measured = measured(&cell, &truth, &group, &mut dice);
        let identification = identify(&cell, &measured, &IdentifyOptions::default()).unwrap();
        let model = IdentifiedCompliance::from_identification(&cell, &identification).unwrap();
        let work = work(&cell, &mut dice, 30);
        let (before, after) = errors(&cell, &truth, &model, &work);
        factors.push(before / after);
        // What the command says to expect is what comes, within the scatter.
        let said = compensate(&cell, &model, &work, &CompensateOptions::default(), Control::default());
        let said = said.unwrap();
        assert!(said.residual_max_m < 1e-13);
        let expected = said.expected_factor.unwrap();
        assert!((0.2..5.0).contains(&(expected / (before / after))));
    }
    factors.sort_by(f64::total_cmp);
    println!("factors: smallest {:.0}, median {:.0}, largest {:.0}", factors[0], factors[25], factors[49]);
    assert!(factors[0] >= 50.0);
}

#[test]
fn with_other_elements_in_the_truth_the_factor_falls_and_the_diagnosis_says_so() {
    let cell = default_cell();
    let truth = with_terms(
        &prior(&cell),
        &[
            (ExtraTerm::BaseTilt, 2e-8),
            (ExtraTerm::LostMotion(1), 0.2 / 60.0_f64 * PI / 180.0),
            (ExtraTerm::JointTilt(2), 4e-7),
        ],
    );
    let mut dice = Dice::new(18);
    let group: Vec<Vec<f64>> = random_group().into_iter().chain(group1()).collect();
    let measured = measured(&cell, &truth, &group, &mut dice);
    let options = IdentifyOptions::default();
    let identification = identify(&cell, &measured, &options).unwrap();
    let model = IdentifiedCompliance::from_identification(&cell, &identification).unwrap();
    let (before, after) = errors(&cell, &truth, &model, &work(&cell, &mut dice, 60));
    println!("factor {:.1}", before / after);
    assert!(before / after < 30.0 && before / after > 1.0);
    let diagnosis = diagnose(&Fit::new(&cell, &measured, &options).unwrap()).unwrap();
    for finding in &diagnosis.findings {
        println!("{:?} {}: {}", finding.severity, finding.code, finding.sentence);
    }
    let noise = diagnosis.noise.as_ref().unwrap();
    println!("{noise:?}");
    let best = &diagnosis.terms.as_ref().unwrap().trials[0];
    println!("{best:?}");
    assert!(best.ratio.unwrap() < 0.8 && best.p_value.unwrap() < 1e-3);
}

#[test]
fn limits_are_respected_and_named() {
    let cell = default_cell();
    let predictor = prior(&cell);
    let mut q = cell.tasks[1].q.clone();
    let wrench = Wrench::force(Vector3::new(0.0, 0.0, -800.0));
    let arm = LoadedArm::new(&cell, &predictor).unwrap();
    // Which way the command goes, found first without the limit.
    let free = command(&arm, &q, &wrench).unwrap().q;
    let high = free[1] > q[1];
    let [least, most] = cell.setup.robot.joints()[1].limits;
    let limits = if high { [least, q[1]] } else { [q[1], most] };
    let mut narrow = cell.clone();
    limit_joint(&mut narrow, 1, limits);
    let options = CompensateOptions::default();
    let run = |q: &[f64]| {
        let mut work = LoadedPosture::new("7", q.to_vec(), wrench);
        work.line = Some(8);
        compensate(&narrow, &predictor, &[work], &options, Control::default())
    };
    let error = run(&q).unwrap_err();
    assert_eq!(error.place().line, Some(8));
    insta::assert_snapshot!(error.message(), @"Point 7: the command would move joint 2 to 19.9740°, outside the machine's limits, 20° to 360°.");
    q[1] += if high { -0.02 } else { 0.02 };
    assert!(run(&q).is_ok());
}

#[test]
fn warns_where_a_correction_is_less_than_its_uncertainty_or_beyond_the_data() {
    let cell = default_cell();
    let mut dice = Dice::new(19);
    let group = random_group();
    let measured = measured(&cell, &prior(&cell), &group, &mut dice);
    let identification = identify(&cell, &measured, &IdentifyOptions::default()).unwrap();
    let mut model = IdentifiedCompliance::from_identification(&cell, &identification).unwrap();
    let work = work(&cell, &mut dice, 10);
    let run = |model: &IdentifiedCompliance, options: CompensateOptions| {
        let compensation = compensate(&cell, model, &work, &options, Control::default()).unwrap();
        // The work's random postures may leave the cell's limits, and its tip is that of the cell: other matters.
        let codes = compensation.findings.iter().map(|f| f.code.clone());
        let other = |code: &String| ["forbidden", "tip-assumed"].contains(&code.as_str());
        let codes: Vec<String> = codes.filter(|code| !other(code)).collect();
        (compensation, codes)
    };
    let (sure, codes) = run(&model, CompensateOptions::default());
    assert_eq!(codes, ["correction-beyond-uncertainty"]);
    assert_eq!(sure.beyond_uncertainty, Some(10));
    let (_, codes) = run(
        &model,
        with(|o: &mut CompensateOptions| {
            o.load_uncertainty = 0.6;
            o.measured_up_to = Some(1e-5);
        }),
    );
    assert_eq!(codes, ["correction-within-uncertainty", "beyond-measured"]);
    let (forced, codes) = run(&model, with(|o: &mut CompensateOptions| o.loaded_up_to = Some(1.0)));
    assert_eq!(codes[1], "beyond-load");
    assert!(forced.objections().any(|f| f.code == "beyond-load"));
    model.spread = None;
    let (alone, codes) = run(&model, CompensateOptions::default());
    assert_eq!(codes, ["no-band"]);
    assert_eq!(alone.expected_factor, None);
}
