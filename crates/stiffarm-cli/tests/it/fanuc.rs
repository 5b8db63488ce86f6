//! The measured robot that is built in, from its readings to stiffness.

use crate::support::Folder;

/// Least-squares stiffness of all 43 postures [N·m/rad] and RMS residual [m],
/// from a separate computation in Python: Craig's DH rows of the data set, Ψ in
/// double precision, its normal equations solved in exact rational numbers.
const STIFFNESS: [f64; 6] = [
    860895.9548537335,
    2719582.509057765,
    1959759.5738432342,
    270828.3111045273,
    424693.03118898894,
    206019.7617094478,
];
const RESIDUAL_RMS: f64 = 0.00021484804740675402;

#[test]
fn the_measured_fanuc_is_identified() {
    let folder = Folder::new();
    let out = folder.ok("identify builtin:fanuc-r2000ic builtin:fanuc-r2000ic-readings");
    assert!(out.starts_with("The stiffness is known to ± "), "{out}");
    assert!(out.lines().count() <= 46, "{out}");
    assert!(out.lines().all(|line| line.chars().count() <= 80), "{out}");
    let value = folder.json("identify builtin:fanuc-r2000ic builtin:fanuc-r2000ic-readings");
    let result = &value["result"];
    assert_eq!(result["rows"], 129);
    assert_eq!(result["undetermined_joints"].as_array().unwrap().len(), 0);
    let axes = result["elastic"]["axes"].as_array().unwrap();
    for (joint, k) in axes.iter().zip(STIFFNESS) {
        let stiffness = joint["stiffness"].as_f64().unwrap();
        assert!((stiffness / k - 1.0).abs() < 1e-9, "{}: {stiffness}", joint["name"]);
    }
    assert!((result["residual_rms_m"].as_f64().unwrap() / RESIDUAL_RMS - 1.0).abs() < 1e-9);

    // Every fourth posture kept out: the prediction is better than none.
    let excluded: Vec<String> = (1..=43).step_by(4).map(|i: u32| i.to_string()).collect();
    let excluded = excluded.join(",");
    folder.ok(&format!(
        "identify builtin:fanuc-r2000ic builtin:fanuc-r2000ic-readings --exclude {excluded} --output stiffness.json"
    ));
    let value = folder.json(&format!(
        "validate builtin:fanuc-r2000ic stiffness.json builtin:fanuc-r2000ic-readings --only {excluded}"
    ));
    let result = &value["result"];
    assert_eq!(result["points"].as_array().unwrap().len(), 11);
    let share = result["deviation_rms_m"].as_f64().unwrap() / result["displacement_rms_m"].as_f64().unwrap();
    assert!(share < 0.5, "{share}");

    // Each posture predicted from the other 42; a joint that tilts predicts better.
    let left_out = |terms: &str| {
        let line = format!("validate builtin:fanuc-r2000ic builtin:fanuc-r2000ic-readings --folds all{terms}");
        let ran = folder.run(&format!("{line} --json"));
        let value: serde_json::Value = serde_json::from_str(&ran.out).unwrap();
        let band = &value["result"]["band"];
        println!("{line}: {} of {} inside", band["inside"], band["components"]);
        // The readings scatter as the residuals say, whatever their cause.
        let inside = band["inside"].as_f64().unwrap() / band["components"].as_f64().unwrap();
        assert!((0.9..=0.99).contains(&inside), "{inside}");
        let factor = value["result"]["compensation_factor"].as_f64().unwrap();
        (value["result"]["component_rms_m"].as_f64().unwrap() * 1e3, factor)
    };
    let (axes, of_axes) = left_out(" --elastic axes");
    let (tilt, of_tilt) = left_out(" --extra tilt3");
    println!("compensation factor: {of_axes:.2}, with tilt of joint 3 {of_tilt:.2}");
    assert!((of_axes - 4.266).abs() < 5e-3 && (of_tilt - 5.510).abs() < 5e-3);
    println!("leave one out: {axes:.4} mm, with tilt of joint 3 {tilt:.4} mm");
    // README's first number.
    let (mixed, of_mixed) = left_out("");
    assert!((mixed - 0.1340).abs() < 5e-5 && (of_mixed - 7.474).abs() < 5e-3, "{mixed}");
    assert!((axes - 0.2339).abs() < 5e-5, "{axes}");
    assert!((tilt - 0.1813).abs() < 5e-5, "{tilt}");
}
