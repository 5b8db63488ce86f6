//! `check` names what is wrong with a cell, each fault by its own reason, and
//! agrees with what an evaluation of many postures finds.

use crate::common::cases::{sentences, shown};
use crate::common::prelude::*;
use stiffarm::findings::codes;
use stiffarm::plan::check::{CellCheck, SAMPLES, check};

fn comau() -> Cell {
    builtin::cell("comau").unwrap()
}

/// The built-in COMAU cell with one line of its file replaced.
fn comau_with(from: &str, to: &str) -> Cell {
    let text = builtin::cell_text("comau").unwrap();
    assert!(text.contains(from), "{from}");
    parse_cell(&text.replace(from, to), "cell.toml").unwrap()
}

fn of_code<'a>(check: &'a CellCheck, code: &str) -> Vec<&'a Finding> {
    check.findings.iter().filter(|f| f.code == code).collect()
}

/// The one finding of this code.
#[track_caller]
fn the<'a>(check: &'a CellCheck, code: &str) -> &'a Finding {
    match of_code(check, code)[..] {
        [finding] => finding,
        _ => panic!("not one {code} among {:#?}", check.findings),
    }
}

/// What is said of a cell with something in it that is wrong.
fn said(what: &str, finding: &Finding) -> String {
    format!("» {what}\n{}\n", sentences([finding]))
}

/// Joints that no sampled posture determines, by check and by evaluation.
fn undetermined(cell: &Cell) -> (Vec<String>, Vec<String>) {
    let checked = check(cell).unwrap();
    let names = checked.joints.iter().filter(|j| !j.determined);
    let group = random_group(cell, StartKind::Uniform, 30, 5, 0).unwrap();
    let evaluated = evaluate(cell, "many", &group).unwrap();
    (names.map(|j| j.name.clone()).collect(), evaluated.undetermined_joints)
}

#[test]
fn the_built_in_cells_are_usable() {
    for name in builtin::cell_names() {
        let checked = check(&builtin::cell(name).unwrap()).unwrap();
        assert!(!checked.is_serious(), "{name}: {:#?}", checked.findings);
        assert!(checked.joints.iter().all(|j| j.determined), "{name}");
        assert_eq!(of_code(&checked, "suspicious-unit").len(), 0, "{name}: {:#?}", checked.findings);
        assert_eq!(checked.postures_sampled, SAMPLES as usize);
    }
    let checked = check(&comau()).unwrap();
    assert_eq!(check(&comau()).unwrap(), checked);
    // 27 % of random postures meet the default cell's limits.
    let share = checked.postures_within_limits as f64 / f64::from(SAMPLES);
    assert!((0.2..0.35).contains(&share), "{share}");
    insta::assert_snapshot!(the(&checked, "one-reading").sentence, @"One reading is counted per displacement, as the paper does. A displacement is the difference of a loaded and an unloaded reading: unless the variance is already that of a displacement, give 2.");
    let joint = &checked.joints[1];
    assert!(joint.largest_torque_nm.unwrap() > 500.0 && joint.largest_displacement_m.unwrap() > 1e-4);
}

#[test]
fn joints_that_no_posture_determines() {
    let on_axis = comau_with("loading_point_mm = [200, 0, 250]", "loading_point_mm = [0, 0, 250]");
    let hanging = changed(comau(), |cell| {
        cell.setup.load = hanging(500.0);
        cell.limits.rope_length = None;
    });
    let anchored = comau_with("anchor_mm = [1800, 0, 0]", "anchor_mm = [0, 0, 1000]");
    let mut report = String::new();
    for (cell, joint, what) in [
        (&on_axis, "joint 6", "loading point on axis 6"),
        (&hanging, "joint 1", "weight"),
        (&anchored, "joint 1", "anchor on axis 1"),
    ] {
        let checked = check(cell).unwrap();
        let finding = the(&checked, codes::JOINT_LEFT_OUT);
        assert_eq!((&*finding.subject, finding.severity), (joint, Severity::Caution), "{what}");
        report += &said(what, finding);
        let (checked, evaluated) = undetermined(cell);
        assert_eq!((&checked[..], &evaluated), (&[joint.to_string()][..], &checked), "{what}");
    }
    insta::assert_snapshot!(report, @"
    » loading point on axis 6
    [joint-left-out] joint 6: No posture within the bounds determines joint 6 under the load of this cell: the loading point lies on its axis, so that the load has no lever; move the loading point off the axis. Plans and what they promise leave it out, as if it were rigid.

    » weight
    [joint-left-out] joint 1: No posture within the bounds determines joint 1 under the load of this cell: the load is parallel to its axis in every posture (a purely vertical load on a floor-mounted robot does that to joint 1); pull sideways. Plans and what they promise leave it out, as if it were rigid.

    » anchor on axis 1
    [joint-left-out] joint 1: No posture within the bounds determines joint 1 under the load of this cell: the rope's anchor lies on its axis, so that the force passes through the axis; move the anchor. Plans and what they promise leave it out, as if it were rigid.
    ");
    // Hanging from a wall, the same weight excites every joint.
    let mut cell = hanging;
    cell.setup.load = Load::Weight { magnitude: 500.0, direction: Vector3::x() };
    assert!(check(&cell).unwrap().joints.iter().all(|j| j.determined));
}

#[test]
fn reflectors_on_the_last_axis() {
    let mut cell = comau();
    cell.setup.tool.measuring_points[1].position = Vector3::new(0.0, 0.0, 0.2);
    let checked = check(&cell).unwrap();
    insta::assert_snapshot!(sentences([the(&checked, "blind-point")]), @r#"[blind-point] tool.measuring_point[2].position_mm: Measuring point "2" lies on the axis of joint 6 and tells nothing about it; the other points do."#);
    assert!(!checked.is_serious());
    cell.setup.tool.measuring_points.truncate(2);
    cell.setup.tool.measuring_points[0].position = Vector3::new(0.0, 0.0, 0.3);
    let checked = check(&cell).unwrap();
    insta::assert_snapshot!(sentences([the(&checked, codes::JOINT_LEFT_OUT)]), @"[joint-left-out] joint 6: No posture within the bounds determines joint 6 under the load of this cell: every measuring point lies on its axis and stays where it is; put a reflector beside the axis. Plans and what they promise leave it out, as if it were rigid.");
    assert_eq!(of_code(&checked, "blind-point").len(), 0);
}

#[test]
fn a_load_of_nothing_and_a_moment_about_nothing() {
    let mut cell = comau();
    cell.limits.rope_length = None;
    let zero = Vector3::zeros();
    let constant = |force, moment| Load::Constant { wrench: Wrench { force, moment }, axes: Axes::Tool };
    cell.setup.load = constant(zero, zero);
    let checked = check(&cell).unwrap();
    let dark = of_code(&checked, "undetermined-joint");
    assert_eq!(dark.len(), 6);
    insta::assert_snapshot!(sentences(dark), @"
    [undetermined-joint] joint 1: With this cell no posture within the bounds determines joint 1: the load is zero.
    [undetermined-joint] joint 2: With this cell no posture within the bounds determines joint 2: the load is zero.
    [undetermined-joint] joint 3: With this cell no posture within the bounds determines joint 3: the load is zero.
    [undetermined-joint] joint 4: With this cell no posture within the bounds determines joint 4: the load is zero.
    [undetermined-joint] joint 5: With this cell no posture within the bounds determines joint 5: the load is zero.
    [undetermined-joint] joint 6: With this cell no posture within the bounds determines joint 6: the load is zero.
    ");
    // A pure moment across the last axis, turning with the tool.
    cell.setup.load = constant(zero, Vector3::new(100.0, 0.0, 0.0));
    let checked = check(&cell).unwrap();
    insta::assert_snapshot!(sentences([the(&checked, codes::JOINT_LEFT_OUT)]), @"[joint-left-out] joint 6: No posture within the bounds determines joint 6 under the load of this cell: the load has no moment about its axis. Plans and what they promise leave it out, as if it were rigid.");
}

#[test]
fn measured_forces_on_the_last_axis_are_a_caution() {
    let mut cell = builtin::cell("fanuc-r2000ic").unwrap();
    assert!(check(&cell).unwrap().joints.iter().all(|j| j.largest_torque_nm.is_none()));
    cell.setup.tool.loading_point = Vector3::new(0.0, 0.0, 0.3);
    let checked = check(&cell).unwrap();
    let finding = the(&checked, "undetermined-joint");
    assert_eq!(finding.severity, Severity::Caution);
    insta::assert_snapshot!(sentences([finding]), @"[undetermined-joint] joint 6: With this cell no force at the loading point determines joint 6: the loading point lies on its axis, so that the load has no lever; move the loading point off the axis.");
}

#[test]
fn a_joint_that_drowns_in_the_noise() {
    let cell = comau_with("loading_point_mm = [200, 0, 250]", "loading_point_mm = [2, 0, 250]");
    let checked = check(&cell).unwrap();
    let finding = the(&checked, "weak-joint");
    assert_eq!(finding.severity, Severity::Caution);
    insta::assert_snapshot!(sentences([finding]), @"[weak-joint] joint 6: By the prior stiffness joint 6 moves no measuring point by more than 0.0010 mm, and the noise of a displacement is 0.0096 mm: its stiffness will be uncertain. Pull harder, or lengthen the lever.");
}

#[test]
fn limits_that_nothing_or_little_meets() {
    let cell = comau_with("box_min_mm = [900, -1900, 300]", "box_min_mm = [2990, -1900, 2990]");
    let checked = check(&cell).unwrap();
    assert_eq!(checked.postures_within_limits, 0);
    insta::assert_snapshot!(the(&checked, "unreachable-limits").sentence, @"Of 256 postures spread over the bounds none meet every limit; violated most often: the box for tool points and flange (100 %), the keep-out cylinder about axis 1 (29 %), the length of rope or cylinder (16 %). Without the box for tool points and flange 149 postures would do. Check the limits' frame (robot base) and unit (mm).");
    assert!(checked.is_serious());
    // The load is looked at all the same.
    assert!(checked.joints.iter().all(|j| j.determined));
    let cell = comau_with("wrist_height_mm = 300", "wrist_height_mm = 2700");
    insta::assert_snapshot!(the(&check(&cell).unwrap(), "cramped-limits").sentence, @"Of 256 postures spread over the bounds 3 meet every limit; violated most often: the lowest height of the wrist centre (82 %), the box for tool points and flange (72 %), the keep-out cylinder about axis 1 (29 %).");
    let unlimited = check(&builtin::cell("comau-reference").unwrap()).unwrap();
    insta::assert_snapshot!(the(&unlimited, "no-limits").sentence, @"There are no limits on where the tool may be: a selection may bring it below the floor, into the robot's own column or onto the load's anchor.");
}

/// A line of the file, what it should not be, and the key that is named.
const SLIPS: &str = r#"
loading_point_mm = [200, 0, 250] | loading_point_mm = [0.2, 0, 0.25] | tool.loading_point_mm
position_mm = [0, 150, 200] | position_mm = [0, 150000, 200000] | tool.measuring_point[2].position_mm
position_mm = [-150, 0, 200] | position_mm = [150, 0, 200] | tool.measuring_point[3].position_mm
anchor_mm = [1800, 0, 0] | anchor_mm = [1.8, 0, 0] | load.anchor_mm
anchor_mm = [1800, 0, 0] | anchor_mm = [180000, 0, 0] | load.anchor_mm
magnitude_n = 500 | magnitude_n = 0.5 | load.magnitude_n
magnitude_n = 500 | magnitude_n = 5000 | load.magnitude_n
variance_mm2 = 9.23e-5 | variance_mm2 = 9.6 | noise
variance_mm2 = 9.23e-5 | variance_mm2 = 9e-11 | noise
[950000, | [950, | stiffness.prior_nm_per_rad
characteristic_length_mm = 773 | characteristic_length_mm = 0.773 | robot.characteristic_length_mm
keep_out_radius_mm = 900 | keep_out_radius_mm = 0.9 | limits.keep_out_radius_mm
rope_length_mm = [800, 3400] | rope_length_mm = [0.8, 3.4] | limits.rope_length_mm
"#;

#[test]
fn slips_of_the_unit() {
    let elastic = "[elastic]\nshift_std_m_per_n = 9e-5\nturn_std_rad_per_nm = 1.4e-7\n\
                   coupling_std_rad_per_n = 7.6e-8\n[noise]";
    let mut slips = table(SLIPS);
    slips.push(["[noise]", elastic, "elastic.shift_std_m_per_n"]);
    let mut report = String::new();
    for [from, to, key] in slips {
        let checked = check(&comau_with(from, to)).unwrap();
        let finding = the(&checked, "suspicious-unit");
        assert_eq!(finding.subject, key, "{to}");
        assert!(finding.severity >= Severity::Caution, "{to}");
        report += &said(&shown("", to), finding);
    }
    insta::assert_snapshot!("slips_of_the_unit", report);
}

/// What is possible and cannot be meant for this robot ends `check` with exit code 1.
#[test]
fn work_that_cannot_be_meant_is_serious() {
    let cut = |line: &str| {
        let cut = "[work.milling]\nteeth = 4\ndiameter_mm = 20\naxial_depth_mm = 5\nradial_depth_mm = 10\n\
                   feed_per_tooth_mm = 0.05\ndirection = \"down\"\nk_tc_n_per_mm2 = 800\nk_rc_n_per_mm2 = 300\n";
        let key = line.split(' ').next().unwrap();
        let others = cut.lines().filter(|l| !l.starts_with(key));
        format!("{}\n{line}\n", others.collect::<Vec<_>>().join("\n"))
    };
    let task =
        |force: &str| format!("[[task]]\nq_deg = [0, 0, -90, 0, 30, 0]\nforce_n = {force}\ntip_mm = [0, 0, 300]\n");
    let cases = [
        (task("[200000, 0, 0]"), "task[1].force_n"),
        ("[work.force]\nforce_n = [0, 0, 20000]\naxes = \"base\"\n".to_string(), "work.force"),
        (cut("k_tc_n_per_mm2 = 0.8"), "work.milling.k_tc_n_per_mm2"),
        (cut("axial_depth_mm = 400"), "work.milling.axial_depth_mm"),
        ("[work]\nworkpiece_mm = [1.2, 0, 0.8]\n".to_string(), "work.workpiece_mm"),
    ];
    let text = builtin::cell_text("comau").unwrap();
    // Tasks and work of the built-in cell make room.
    let end = text.find("[[task]]").unwrap();
    let before = |work: &str| parse_cell(&format!("{}\n{work}", &text[..end]), "cell.toml").unwrap();
    assert!(!check(&before(&cut("teeth = 4"))).unwrap().is_serious());
    assert!(!check(&before(&task("[300, 0, 0]"))).unwrap().is_serious());
    let mut report = String::new();
    for (work, subject) in cases {
        let checked = check(&before(&work)).unwrap();
        let serious = |f: &&Finding| f.severity == Severity::Serious && f.subject == subject;
        let finding = checked.findings.iter().find(serious);
        let finding = finding.unwrap_or_else(|| panic!("{work}: {:#?}", checked.findings));
        report += &said(&shown("", &work), finding);
    }
    insta::assert_snapshot!("work_that_cannot_be_meant", report);
    let noisy = comau_with("posture_common_mm = 0", "posture_common_mm = 100");
    let noisy = check(&noisy).unwrap();
    assert!(noisy.is_serious(), "{:#?}", noisy.findings);
}

#[test]
fn a_box_in_metres_is_named_beside_what_it_does() {
    let cell = comau_with(
        "box_min_mm = [900, -1900, 300]\nbox_max_mm = [3000, 1900, 3000]",
        "box_min_mm = [0.9, -1.9, 0.3]\nbox_max_mm = [3, 1.9, 3]",
    );
    let checked = check(&cell).unwrap();
    assert_eq!(checked.findings[0].severity, Severity::Serious);
    let findings = ["unreachable-limits", "suspicious-unit"].map(|code| the(&checked, code));
    insta::assert_snapshot!(sentences(findings), @"
    [unreachable-limits] limits: Of 256 postures spread over the bounds none meet every limit; violated most often: the box for tool points and flange (100 %), the keep-out cylinder about axis 1 (29 %), the length of rope or cylinder (16 %). Without the box for tool points and flange 149 postures would do. Check the limits' frame (robot base) and unit (mm).
    [suspicious-unit] limits.box_max_mm: The box is only 3.80 mm long: is it in metres? The unit is mm.
    ");
}

/// The nose of a spindle has a flat end, as the pictures draw it: 100 mm before a table are 100 mm.
#[test]
fn a_spindle_is_judged_as_it_is_drawn() {
    let text = include_str!("../cells/comau-shapes.toml");
    let q = vec![0.4, 0.2, -1.5, 0.3, 0.8, 0.5];
    let cell = parse_cell(text, "cell.toml").unwrap();
    let frames = Frames::new(&cell.setup.robot, &q);
    let flange = frames.flange();
    let (roll, pitch, yaw) = flange.rotation.euler_angles();
    // Its cylinder is 260 mm long and 80 mm thick about the flange's z.
    let centre = (flange * nalgebra::Point3::new(0.0, 0.0, 0.26 + 0.1 + 0.05)).coords * 1e3;
    let table = format!(
        "\n[[obstacle]]\nname = \"new table\"\nkind = \"box\"\ncenter_mm = [{}, {}, {}]\nsize_mm = [600, 600, 100]\n\
         rpy_deg = [{}, {}, {}]\n",
        centre.x,
        centre.y,
        centre.z,
        roll.to_degrees(),
        pitch.to_degrees(),
        yaw.to_degrees()
    );
    let cell = parse_cell(&(text.to_string() + &table), "cell.toml").unwrap();
    let named = cell.posture_margins().unwrap().named(&q).unwrap();
    let margin = named.iter().find(|m| m.point == "spindle and new table").unwrap();
    let apart = margin.margin + cell.scene.clearance();
    assert!((apart - 0.1).abs() < 1e-9, "{apart}");
}

/// A fence between the tracker and everything hides each posture, and some are outside the box as well: what
/// no posture meets is blamed, as a selection does, not what is violated by most millimetres.
#[test]
fn a_fence_before_the_tracker_is_blamed_not_the_box() {
    let text = include_str!("../cells/comau-shapes.toml");
    let fence = |name: &str, at: &str, size: &str| {
        format!("\n[[obstacle]]\nname = \"{name}\"\nkind = \"box\"\ncenter_mm = [{at}]\nsize_mm = [{size}]\n")
    };
    let fence =
        fence("fence", "4600, 1200, 1500", "400, 3000, 3000") + &fence("screen", "1500, 3600, 1800", "3000, 400, 3000");
    let cell = parse_cell(&(text.to_string() + &fence), "cell.toml").unwrap();
    let checked = check(&cell).unwrap();
    assert_eq!(checked.postures_within_limits, 0);
    insta::assert_snapshot!(the(&checked, "unreachable-limits").sentence, @"Of 256 postures spread over the bounds none meet every limit; violated most often: the tracker's line of sight (100 %), the reflectors' acceptance angle (83 %), the box for tool points and flange (72 %). Without the tracker's line of sight and the joints' torque 17 postures would do. Check the limits' frame (robot base) and unit (mm).");
}

#[test]
fn shapes_too_large_are_named_with_the_way_to_leave_them_out() {
    let text = include_str!("../cells/comau-shapes.toml");
    let apart = text.replace("ignore = [[\"link 1\", \"beam\"]]", "shapes_mm = 300");
    let torques = "[900, 1600, 1200, 300, 250, 120]";
    assert!(apart.contains(torques));
    let text = apart.replace(torques, "[9000, 16000, 12000, 3000, 2500, 1200]");
    let checked = check(&parse_cell(&text, "cell.toml").unwrap()).unwrap();
    insta::assert_snapshot!(the(&checked, "unreachable-limits").sentence, @"Of 256 postures spread over the bounds none meet every limit; violated most often: the distance between shapes (85 %, most often link 2 and base), the reflectors' acceptance angle (78 %), the box for tool points and flange (72 %). Without the distance between shapes 19 postures would do. Shapes drawn too large may be left out: `ignore` in [clearance] names their pairs. Check the limits' frame (robot base) and unit (mm).");
}

#[test]
fn bounds_in_radians() {
    let mut cell = comau();
    for bounds in &mut cell.bounds {
        *bounds = bounds.map(f64::to_radians);
    }
    let checked = check(&cell).unwrap();
    assert!(of_code(&checked, "suspicious-unit").iter().any(|f| f.subject == "bounds.q_deg"));
}

#[test]
fn what_is_missing_or_contradicts() {
    let mut cell = comau();
    cell.prior = None;
    cell.setup.tool.has_sensor = true;
    cell.noise.readings_per_displacement = 2;
    let checked = check(&cell).unwrap();
    insta::assert_snapshot!(sentences(["no-prior", "sensor-compliance"].map(|code| the(&checked, code))), @"
    [no-prior] stiffness.prior_nm_per_rad: There is no prior joint stiffness: expected errors, the indices built on them and the simulation are not available. Orders of magnitude suffice.
    [sensor-compliance] tool.series_compliance: A force sensor sits between flange and reflectors, but its compliance is not given: what the sensor yields is taken for the joints' (10 to 20 % on the wrist joints for a usual sensor).
    ");
    assert_eq!(of_code(&checked, "one-reading").len(), 0);
    assert!(checked.joints.iter().all(|j| j.largest_displacement_m.is_none()));

    let mut q = vec![0.0; 6];
    q[2] = -1.5;
    q[1] = 3.0;
    cell.validation = vec![Posture { name: "V9".to_string(), q }];
    cell.bounds[0][1] = 4.0;
    let checked = check(&cell).unwrap();
    let outside = ["validation-outside-machine-limits", "bounds-outside-machine-limits"];
    insta::assert_snapshot!(sentences(outside.map(|code| the(&checked, code))), @"
    [validation-outside-machine-limits] validation.posture: Validation posture V9 has joint 2 at 171.887339°, outside the machine's limits, -75° to 95°.
    [bounds-outside-machine-limits] bounds.q_deg[1]: The bounds of joint 1 reach beyond the machine's limits.
    ");
    cell.validation[0].q[1] = cell.setup.robot.joints()[1].limits[1];
    let on_limit = check(&cell).unwrap();
    insta::assert_snapshot!(sentences([the(&on_limit, "on-machine-limit")]), @"[on-machine-limit] validation.posture: Posture V9 has joint 2 on the machine's limit, 95°, which the robot may refuse to reach: keep postures, and bounds.q_deg, a degree before it.");
    let order: Vec<Severity> = checked.findings.iter().map(|f| f.severity).collect();
    assert!(order.is_sorted_by(|a, b| a >= b), "{order:?}");
}

#[test]
fn a_cell_whose_bounds_do_not_fit_the_robot_is_an_error() {
    let mut cell = comau();
    cell.bounds.pop();
    assert!(check(&cell).is_err());
}

#[test]
fn limits_of_a_full_turn_that_are_given_are_no_unknown_ones() {
    let rows = "dh_modified = [[0, 0, 300, 0], [-90, 0, 0, 0], [0, 500, 0, 0], [-90, 0, 450, 0], [90, 0, 0, 0], [-90, 0, 80, 0]]\n";
    let from = "catalogue = \"comau-nj165-3.0\"\n";
    let unknown = comau_with(from, rows);
    insta::assert_snapshot!(the(&check(&unknown).unwrap(), "unknown-limits").sentence, @"The machine's limits are not known: -360° to 360° stand in for them. Give robot.limits_deg, or bounds that the machine can reach, before a plan is driven.");
    let limits = format!("{rows}limits_deg = [{}]\n", ["[-360, 360]"; 6].join(", "));
    let limited = comau_with(from, &limits);
    assert!(of_code(&check(&limited).unwrap(), "unknown-limits").is_empty());
}

#[test]
fn two_stories_of_one_noise_are_told() {
    let tracker = |range: f64, angle: f64| {
        let table = format!("[tracker]\nrange_um = {range}\nangle_urad = {angle}\n\n[noise]\n");
        check(&comau_with("[noise]\n", &table)).unwrap()
    };
    for (range, angle) in [(10.0, 3.0), (5.0, 1.0), (7.0, 5.0)] {
        assert!(of_code(&tracker(range, angle), "two-noises").is_empty());
    }
    let checks = [tracker(40.0, 20.0), tracker(0.5, 0.2)];
    insta::assert_snapshot!(sentences(checks.iter().map(|checked| the(checked, "two-noises"))), @"
    [two-noises] noise: [noise] has a reading scatter by 9.6 µm along an axis, [tracker] by 0.040 mm at 2 m and 0.165 mm at 10 m: plans, forecasts and simulated readings count with [noise], `--weights tracker` with [tracker].
    [two-noises] noise: [noise] has a reading scatter by 9.6 µm along an axis, [tracker] by 0.4 µm at 2 m and 1.7 µm at 10 m: plans, forecasts and simulated readings count with [noise], `--weights tracker` with [tracker].
    ");
}
