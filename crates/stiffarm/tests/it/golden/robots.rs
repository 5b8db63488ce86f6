//! Kinematics of robots are those of other programs and of published values.

use super::*;

/// Compares poses and ∂x/∂q with 20 postures computed by Pinocchio.
fn against_pinocchio(text: &str, robot: &Robot) {
    let data: Value = serde_json::from_str(text).unwrap();
    let samples = list(&data["samples"]);
    assert_eq!(samples.len(), 20);
    let (mut pose_error, mut jacobian_error) = (0.0_f64, 0.0_f64);
    for sample in samples {
        let q = numbers(&sample["q"]);
        let frames = Frames::new(robot, &q);
        let pose = frames.flange().to_homogeneous();
        pose_error = pose_error.max((pose - matrix(&sample["T"]).fixed_view::<4, 4>(0, 0)).amax());
        // Pinocchio differentiates by the controller's angles.
        let jacobian = frames.jacobian(&frames.flange().translation.vector) * robot.coupling();
        jacobian_error = jacobian_error.max((jacobian - matrix(&sample["J"])).amax());
    }
    check(&format!("{} pose", robot.name()), pose_error, 1e-12);
    check(&format!("{} jacobian", robot.name()), jacobian_error, 1e-12);
}

#[test]
fn comau_agrees_with_pinocchio() {
    let robot = reference_cell().setup.robot;
    against_pinocchio(include_str!("../../golden/pinocchio/comau_nj165_30_coupled.json"), &robot);
}

#[test]
fn panda_agrees_with_pinocchio() {
    let text = include_str!("../../golden/pinocchio/panda.json");
    against_pinocchio(text, &common::set_ups::panda());
}

#[test]
fn ur10_agrees_with_pinocchio() {
    // The URDF behind the numbers writes π/2 with eleven decimals: short of it by this.
    let short = -4.896_619_23e-12;
    // Standard rows; the URDF's base is turned by half a turn against them.
    let rows = [
        [FRAC_PI_2, 0.0, 0.1273, 0.0],
        [0.0, -0.612, 0.0, short],
        [0.0, -0.5723, 0.0, 0.0],
        [FRAC_PI_2, 0.0, 0.220_941 - 0.1719 + 0.1149, short],
        [-FRAC_PI_2, 0.0, 0.1157, 0.0],
        [-short, 0.0, 0.0922, 0.0],
    ];
    let half_turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), PI);
    let base = Isometry3::from_parts(Vector3::zeros().into(), half_turn);
    let robot = chain("UR10", DhConvention::Standard, &rows).with_base(&base);
    against_pinocchio(include_str!("../../golden/pinocchio/ur10.json"), &robot);
}

/// Flange pose of an entry of `robots.json` by products of 4 × 4 matrices.
fn pose_of(entry: &Value, q: &[f64]) -> Matrix4<f64> {
    let mut frame: M4<f64> = shift(0.0, 0.0, entry.get("base_z").map_or(0.0, number));
    if let Some(rows) = entry.get("mdh") {
        let coupling = matrix(&entry["theta_from_q"]);
        let theta = coupling * DVector::from_column_slice(q);
        for (row, theta) in list(rows).iter().map(numbers).zip(theta.iter()) {
            let [alpha, a, offset, d] = row[..] else { panic!("four numbers a row") };
            frame = times(&times(&frame, &rot_x(alpha)), &shift(a, 0.0, 0.0));
            frame = times(&times(&frame, &rot_z(offset + theta)), &shift(0.0, 0.0, d));
        }
    } else {
        for (row, q) in list(&entry["std_dh"]).iter().map(numbers).zip(q) {
            let [offset, d, a, alpha] = row[..] else { panic!("four numbers a row") };
            frame = times(&times(&frame, &rot_z(offset + q)), &shift(0.0, 0.0, d));
            frame = times(&times(&frame, &shift(a, 0.0, 0.0)), &rot_x(alpha));
        }
    }
    Matrix4::from_fn(|i, j| frame[i][j])
}

#[test]
fn catalogue_has_the_published_kinematics_and_stiffness() {
    let data: Value = serde_json::from_str(include_str!("../../golden/robots.json")).unwrap();
    let mut dice = Dice::new(3);
    let mut compared = 0;
    for golden in list(&data["robots"]) {
        let name = golden["name"].as_str().unwrap();
        if name == "KUKA KR500 R2830 MT" {
            // Its angles were not the pendant's: only the stiffness is left, beside
            // another arm of the series.
            let entry = find_in_catalogue("kuka-kr500-r2800-2").unwrap();
            assert_eq!(entry.stiffness[0].values, numbers(&golden["stiffness"]));
            assert!(!entry.stiffness[0].verified);
            continue;
        }
        if golden.get("mdh").is_none() && golden.get("std_dh").is_none() {
            continue;
        }
        let entry = catalogue().iter().find(|e| e.name == name).unwrap_or_else(|| panic!("{name} is missing"));
        let robot = entry.robot().unwrap();
        let mut error = 0.0_f64;
        for _ in 0..20 {
            let q = dice.posture(6);
            let pose = Frames::new(&robot, &q).flange().to_homogeneous();
            error = error.max((pose - pose_of(golden, &q)).amax());
        }
        check(&format!("{name} pose"), error, 1e-12);
        for key in ["stiffness", "stiffness_simulation", "stiffness_experiment_group3"] {
            if let Some(values) = golden.get(key) {
                assert!(entry.stiffness.iter().any(|s| s.values == numbers(values)), "{name}: {key}");
            }
        }
        match golden.get("limits_deg") {
            Some(limits) => {
                for (joint, limit) in robot.joints().iter().zip(list(limits)) {
                    assert_eq!(joint.limits, [number(&limit[0]).to_radians(), number(&limit[1]).to_radians()]);
                }
            }
            // Where a description has the limits they are held against it.
            None => assert!(!entry.has_limits() || !entry.file.is_empty(), "{name}: limits without a source"),
        }
        compared += usize::from(entry.file.is_empty());
    }
    // The others are held against their robot descriptions.
    let published = catalogue().iter().filter(|e| e.file.is_empty());
    assert_eq!(compared, published.count(), "an entry of the catalogue has no reference");
}
