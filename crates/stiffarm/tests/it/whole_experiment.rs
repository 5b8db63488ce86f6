//! From the raw readings of a whole simulated experiment to the joint
//! stiffness: tracker anywhere, sensor turned and shifted, tool weight, three
//! load states, repeats, drift, noise.

use crate::common::prelude::*;

fn pose(dice: &mut Dice, reach: f64) -> Isometry3<f64> {
    let mut number = || dice.between(-1.0, 1.0);
    let translation = Translation3::new(reach * number(), reach * number(), reach * number());
    let turn = Vector3::new(number(), number(), number()) * 3.0;
    Isometry3::from_parts(translation, UnitQuaternion::new(turn))
}

fn postures(cell: &Cell, count: usize) -> Vec<Posture> {
    let group = random_group(cell, StartKind::Uniform, count, 21, 0).unwrap();
    group.into_iter().enumerate().map(|(i, q)| Posture { name: (i + 1).to_string(), q }).collect()
}

#[test]
fn stiffness_lies_in_its_intervals() {
    let experiments = runs(24);
    let mut dice = Dice::new(99);
    let mut inside = [0u64; 6];
    let mut worst = 0.0_f64;
    let mut alarms = 0;
    for run in 0..experiments {
        let mut cell = default_cell();
        cell.sensor = Some(Sensor {
            mount: if run % 3 == 0 { Mount::Base } else { Mount::Flange },
            pose: pose(&mut dice, 0.1),
            reports_by_robot: run % 2 == 0,
            mirrored: None,
        });
        let postures = postures(&cell, 8);
        let done = Experiment {
            base_from_tracker: pose(&mut dice, 5.0),
            // The linear model is the truth, so that the intervals are exact.
            model: DisplacementModel::Linear,
            sensor_noise: [0.0; 2],
            ..Experiment::as_measured(&cell)
        };
        let truth = cell.require_prior().unwrap().to_vec();
        let table = experiment(&cell, &postures, &truth, &done, 5, run).unwrap();
        let sane = screen(&cell, &table, None).unwrap();
        let serious = |f: &Finding| f.severity == Severity::Serious;
        assert!(!sane.findings.iter().any(serious), "{:?}", sane.findings);
        alarms += u64::from(!sane.suspicions.is_empty());
        let reduced = reduce(&cell, &table, &ReduceOptions::default()).unwrap();
        cell.noise.readings_per_displacement = 2;
        let identification = identify(&cell, &reduced.measured, &IdentifyOptions::default()).unwrap();
        for (j, (joint, truth)) in identification.estimates.joints.iter().zip(&truth).enumerate() {
            let [low, high] = joint.interval.map(|end| end.unwrap());
            inside[j] += u64::from(low <= *truth && *truth <= high);
            worst = worst.max((joint.stiffness.unwrap() / truth - 1.0).abs());
        }
        // Residuals are the noise: nothing was left in and nothing taken out.
        let ratio = identification.total_std_m.unwrap() / identification.expected_std_m;
        assert!((0.8..1.25).contains(&ratio), "{ratio}");
    }
    // 95 % or more, less four standard errors.
    let least = (experiments as f64 * (0.95 - 4.0 * standard_error(0.95, experiments))) as u64;
    assert!(inside.iter().all(|count| *count >= least), "{inside:?} of {experiments}");
    assert!(worst < 0.25, "{worst}");
    // At most 1 % of clean experiments raise a doubt; 8 of 240 would be too many.
    assert!(alarms <= most(0.03, experiments, 240), "{alarms}");
    println!("{alarms} doubts; inside {inside:?} of {experiments}, largest error {worst}");
}
