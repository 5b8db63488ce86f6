//! The measured robot that is built in gets the diagnosis that a careful engineer would give.

use super::*;

#[test]
fn what_a_careful_engineer_would_say() {
    let (cell, measured) = common::readings::measured_robot();
    let diagnosis = diagnose(&Fit::new(&cell, &measured, &IdentifyOptions::default()).unwrap()).unwrap();
    for finding in &diagnosis.findings {
        println!("[{}] {}", finding.code, finding.sentence);
    }
    for signal in &diagnosis.signals {
        println!("{signal:?}");
    }
    let terms = diagnosis.terms.as_ref().unwrap();
    for trial in &terms.trials {
        println!(
            "{:26} {:?} {:?} ± {:?} {:?}",
            trial.name, trial.rms_m, trial.value, trial.standard_error, trial.lost_joints
        );
    }
    let mm = |m: f64| (1e7 * m).round() / 1e4;
    let trial = |term| terms.trials.iter().find(|t| t.term == term).unwrap();
    assert_eq!(mm(terms.rms_m.unwrap()), 0.2339);
    assert_eq!(mm(trial(ExtraTerm::JointTilt(2)).rms_m.unwrap()), 0.1813);
    assert_eq!(mm(trial(ExtraTerm::JointTilt(3)).rms_m.unwrap()), 0.1761);
    assert_eq!(trial(ExtraTerm::JointTilt(3)).lost_joints, ["joint 3"]);
    assert!(trial(ExtraTerm::JointTilt(2)).lost_joints.is_empty());
    insta::assert_snapshot!(terms.finding().unwrap().sentence, @"The tilt of joint 4 lowers the leave-one-out RMS by 24.7 %, from 0.234 mm to 0.176 mm, but then joint 3 has no positive estimate; the tilt of joint 3 lowers it by 22.5 %, to 0.181 mm, and leaves every joint one (joint 6 with a lower bound only). So the axis-only model is rejected.");
    let noise = diagnosis.noise.unwrap();
    assert!((15.0..17.0).contains(&noise.ratio), "{}", noise.ratio);
    let joint_6 = &diagnosis.signals[5];
    assert_eq!(joint_6.torque_rms_nm.round(), 78.0);
    // RMS of components; as norms 0.093 mm against 0.372 mm.
    assert_eq!(mm(joint_6.displacement_rms_m.unwrap()), 0.0536);
    assert_eq!(mm(diagnosis.signals[5].displacement_rms_m.unwrap() / joint_6.to_residual.unwrap()), 0.2148);
    let weak = diagnosis.findings.iter().filter(|f| f.code == "weak-joint");
    assert_eq!(weak.map(|f| f.subject.as_str()).collect::<Vec<_>>(), ["joint 6"]);
}
