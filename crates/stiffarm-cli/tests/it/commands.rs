//! What the main commands print on built-in inputs, word by word, and the values behind it.

use crate::support;

use insta::assert_snapshot;
use support::{
    Folder, codes, in_lines, measurements, paragraphs, printed_sentence, redact, rounded, sentence, unbroken,
};

/// A folder with simulated measurements of Group 1's six postures.
fn measured() -> Folder {
    Folder::with("simulated.csv", measurements())
}

fn json(folder: &Folder, line: &str) -> String {
    let value = rounded(&folder.json(line));
    redact(&serde_json::to_string_pretty(&value).unwrap())
}

#[test]
fn init() {
    let folder = Folder::new();
    let printed = folder.transcript("init --robot kuka-kr240-2 --output-dir cell");
    assert_snapshot!(printed.replace('\\', "/"));
    assert_eq!(folder.names(), ["cell"]);
    for file in ["cell/cell.toml", "cell/postures.csv", "cell/measurements.csv"] {
        assert!(folder.read(file).contains('#'), "{file} has comments");
    }
    folder.ok("check cell/cell.toml");
}

#[test]
fn check() {
    assert_snapshot!(Folder::new().transcript("check"));
}

#[test]
fn check_finds_a_dark_joint() {
    let folder = Folder::new();
    let cell = stiffarm_files::builtin::cell_text("comau").unwrap();
    folder.write("cell.toml", cell.replace("[200, 0, 250]", "[0, 0, 250]").replace("[1800, 0, 0]", "[1.8, 0, 0]"));
    let ran = folder.run("check cell.toml");
    assert_eq!(ran.code, Some(1));
    assert_snapshot!(ran.transcript("check cell.toml"));
}

#[test]
fn evaluate() {
    let folder = Folder::new();
    folder.ok("select builtin:comau --initial builtin:comau-group1 --output plan.csv");
    assert_snapshot!(folder.transcript("evaluate builtin:comau builtin:comau-group1 plan.csv"));
}

#[test]
fn evaluate_json() {
    assert_snapshot!(json(&Folder::new(), "evaluate builtin:comau-reference builtin:comau-group1"));
}

#[test]
fn evaluate_names_undetermined_joints_first() {
    let folder = Folder::new();
    folder.write("p.csv", "posture,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\nA,0,0,-90,0,0,0\n");
    let line = "evaluate builtin:comau p.csv";
    let ran = folder.run(line);
    assert_eq!(ran.code, Some(1));
    assert!(ran.out.starts_with("It cannot determine "), "{}", ran.out);
    assert_snapshot!(ran.transcript(line));
    let value = folder.json(line);
    let group = &value["result"]["groups"][0];
    assert!(!group["undetermined_joints"].as_array().unwrap().is_empty());
    assert!(group["indices"]["condition"].is_null());
}

/// With the loading point on the axis of joint 6 the others are told alone.
#[test]
fn what_the_load_never_turns_is_left_out() {
    let folder = Folder::new();
    let cell = stiffarm_files::builtin::cell_text("comau").unwrap();
    folder.write("cell.toml", cell.replace("[200, 0, 250]", "[0, 0, 250]"));
    let lines = [
        "evaluate cell.toml builtin:comau-group1",
        "select cell.toml --initial builtin:comau-group1",
        "select cell.toml --given builtin:comau-group1 --drop 1",
        "select cell.toml --candidates builtin:comau-group1 --count 5",
        "simulate cell.toml builtin:comau-group1 --runs 10",
        "coverage cell.toml builtin:comau-group1 --runs 100",
    ];
    let mut sentences = Vec::new();
    for line in lines {
        let ran = folder.run(line);
        assert_eq!(ran.code, Some(1), "{line}: {}", ran.out);
        let value = folder.json(line);
        let finding = &value["result"]["findings"][0];
        assert_eq!((&finding["code"], &finding["severity"]), (&"joint-left-out".into(), &"caution".into()), "{line}");
        let sentence = finding["sentence"].as_str().unwrap();
        assert!(unbroken(&ran.out).contains(&format!("caution: {sentence}")), "{line}: {}", ran.out);
        sentences.push(sentence.to_string());
        if let Some(joints) = value["result"]["joints"].as_array() {
            let last = joints.last().unwrap();
            assert_eq!(*last.get("name").unwrap_or(last), "joint 5", "{line}");
        }
    }
    sentences.dedup();
    assert_snapshot!(in_lines(sentences.join("\n")), @r"
    No posture within the bounds determines joint 6 under the load of this cell: the loading point lies
    on its axis, so that the load has no lever; move the loading point off the axis. Plans and what they
    promise leave it out, as if it were rigid.
    ");
}

#[test]
fn evaluate_notes_postures_outside_bounds_and_limits() {
    let folder = Folder::new();
    folder.write(
        "p.csv",
        "posture,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\nA,10,0,-90,10,50,20\nB,100,60,-90,200,50,20\n",
    );
    assert_snapshot!(folder.transcript("evaluate builtin:comau p.csv"));
}

#[test]
fn simulate() {
    let line = "simulate builtin:comau builtin:comau-group1 --levels 0.5,2 --runs 100 --seed 3";
    assert_snapshot!(Folder::new().transcript(line));
}

#[test]
fn simulate_with_model_errors_is_worse_than_expected() {
    let folder = Folder::new();
    let line = "simulate builtin:comau builtin:comau-group1 --levels 1 --runs 50 --force-scale-error-percent 5";
    assert_snapshot!(in_lines(printed_sentence(&folder.ok(line), "50 identifications")), @r"
    50 identifications with fresh tracker noise and errors of the model were simulated for one group of
    postures at one noise level.
    ");
    let level = &folder.json(line)["result"]["groups"][0]["levels"][0];
    assert!(level["compliance_mean_deviation"][0].as_f64() > level["expected_deviation"][0].as_f64());
}

#[test]
fn simulate_an_arm_that_gives_way_beyond_its_axes() {
    let folder = Folder::new();
    let line = "simulate builtin:comau builtin:comau-group1 --elastic mixed --runs 3 --levels 1,4";
    assert_snapshot!(folder.transcript(line));
}

#[test]
fn simulated_measurements_bend_by_the_sizes_of_the_cell() {
    let folder = Folder::new();
    let cell = stiffarm_files::builtin::cell_text("comau").unwrap();
    let with = |size: f64| {
        format!(
            "{cell}\n[elastic]\nshift_std_m_per_n = {size}\nturn_std_rad_per_nm = {size}\ncoupling_std_rad_per_n = {size}\n"
        )
    };
    folder.write("rigid.toml", with(0.0));
    folder.write("soft.toml", with(1e-7));
    let line = |cell: &str, elastic: &str, file: &str| {
        format!("simulate {cell} builtin:comau-group1 --runs 1 --levels 1{elastic} --measurements {file}")
    };
    folder.ok(&line("builtin:comau", "", "axes.csv"));
    let out = folder.ok(&line("rigid.toml", " --elastic axes", "same.csv"));
    let again = folder.ok(&line("rigid.toml", "", "again.csv"));
    assert_eq!(out.replace("same.csv", "again.csv"), again);
    folder.ok(&line("rigid.toml", " --elastic mixed", "rigid.csv"));
    let out = folder.ok(&line("soft.toml", " --elastic mixed", "soft.csv"));
    assert_snapshot!(in_lines(printed_sentence(&out, "In each of 1 runs")), @r"
    In each of 1 runs an arm was drawn that gives way at joints and base beyond its axes, by springs
    with the sizes that the cell declares in [elastic] of 1.0e-7 m/N, 1.0e-7 rad/(N·m), 1.0e-7 rad/N; it
    was measured, identified, and its deflections were predicted at the cell's tasks.
    ");
    // Without springs the arm bends as ever; with them it does not.
    assert_eq!(folder.read("rigid.csv"), folder.read("axes.csv"));
    assert_eq!(folder.read("same.csv"), folder.read("axes.csv"));
    assert_ne!(folder.read("soft.csv"), folder.read("axes.csv"));
    let identified = folder.json("identify builtin:comau soft.csv");
    assert_eq!(identified["result"]["elastic"]["model"], "mixed");
}

#[test]
fn a_study_may_hold_arms_that_give_way_beyond_their_axes() {
    let folder = Folder::new();
    folder.ok("study --runs 1 --initial-groups 0 --elastic mixed --output-dir out");
    let page = folder.read("out/report.html");
    let said = "Arms that give way beyond their joint axes were simulated with typical sizes";
    assert!(page.contains(said));
    assert_snapshot!(redact(&paragraphs(&page, "r0-made")), @r"
    stiffarm [version], seed 1. The same inputs, options and seed give the same bytes. The command, with the inputs by the names below:
    stiffarm study --runs 1 --initial-groups 0 --elastic mixed
    Inputs
    ");
    let table = folder.read("out/elastic.csv");
    let names: Vec<&str> = table.lines().skip(1).filter_map(|line| line.split(',').next()).collect();
    let expected = ["Group 1", "Group 3 (novel)", "expected error", "prediction", "random"];
    assert_eq!(names, expected);
    // Nothing of it in a study that was not asked for it.
    let plain = folder.json("study --runs 1 --initial-groups 0 --output-dir plain");
    assert!(plain["result"]["elastic"].is_null());
    assert_eq!(plain["options"]["study"]["elastic"], "axes");
    assert!(!folder.read("plain/report.html").contains(said));
}

#[test]
fn identify() {
    assert_snapshot!(measured().transcript("identify builtin:comau simulated.csv"));
}

/// What the summary leaves out.
#[test]
fn identify_details() {
    assert_snapshot!(measured().transcript("identify builtin:comau simulated.csv --details"));
}

/// The first lines are a verdict, then the table; all of it fits a screen.
#[test]
fn identify_fits_a_screen() {
    let folder = measured();
    for options in ["", " --brief", " --estimator huber", " --exclude 5,6"] {
        let out = folder.ok(&format!("identify builtin:comau simulated.csv{options}"));
        assert!(out.starts_with("The stiffness is known to ± "), "{out}");
        assert!(out.lines().count() <= 38, "{out}");
        for line in out.lines() {
            assert!(line.chars().count() <= 80, "{line}");
        }
        assert!(out.lines().last().is_some_and(|l| !l.is_empty()));
    }
}

#[test]
fn identify_json() {
    assert_snapshot!(json(&measured(), "identify builtin:comau simulated.csv --exclude 6 --noise known"));
}

#[test]
fn identify_names_undetermined_joints_before_any_number() {
    let folder = measured();
    let cell = stiffarm_files::builtin::cell_text("comau").unwrap();
    folder.write("cell.toml", cell.replace("[200, 0, 250]", "[0, 0, 250]"));
    let line = "identify cell.toml simulated.csv --output stiffness.json";
    let ran = folder.run(line);
    assert_eq!(ran.code, Some(1));
    assert_snapshot!(ran.transcript(line));
    // The full result is there all the same, and says what cannot be calculated with it.
    let line = "validate cell.toml stiffness.json simulated.csv";
    let ran = folder.run(line);
    assert_eq!(ran.code, Some(1), "{}", ran.err);
    let remarks = folder.json(line)["result"]["remarks"].clone();
    assert_eq!(codes(&remarks), ["stiffness-doubtful", "stiffness-open", "stiffness-undetermined", "seen-postures"]);
    let shown = sentence(&remarks, "stiffness-undetermined");
    assert_snapshot!(shown, @"The readings say nothing of joint 6: nothing can be calculated where the load bends it.");
    assert!(unbroken(&ran.out).contains(sentence(&remarks, "stiffness-undetermined")), "{}", ran.out);
    let ran = folder.run("predict cell.toml stiffness.json");
    assert_eq!(ran.code, Some(1), "{}", ran.out);
    assert_snapshot!(ran.err, @r"
    not-identifiable

      × Nothing is known of how joint 6 gives way, and the load bends it here.
      help: The stiffness cannot be used as it is, its readings have a serious fault (The readings ask for the loading point at (200, 1, 240) ± 19 mm in flange axes; tool.loading_point_mm has (0, 0, 250)): correct them and identify again.
    ");
}

/// The rows of joints in a printed table.
fn rows(printed: &str) -> Vec<&str> {
    let rows: Vec<&str> = printed.lines().filter(|line| line.starts_with("joint ") && line.len() > 20).collect();
    rows[rows.len() - 6..].to_vec()
}

#[test]
fn identify_says_when_the_sign_is_wrong_and_when_only_a_bound_is_left() {
    let folder = measured();
    let mut lines = folder.read("simulated.csv").lines().map(String::from).collect::<Vec<_>>();
    // Displacements against the force: every compliance turns negative.
    for line in lines.iter_mut().skip(1) {
        let mut fields: Vec<String> = line.split(',').map(String::from).collect();
        for field in &mut fields[3..6] {
            *field = (-field.parse::<f64>().unwrap()).to_string();
        }
        *line = fields.join(",");
    }
    folder.write("wrong-sign.csv", lines.join("\n"));
    let ran = folder.run("identify builtin:comau wrong-sign.csv");
    assert_eq!(ran.code, Some(1));
    let shown = printed_sentence(&ran.out, "SERIOUS:");
    assert_snapshot!(shown, @"SERIOUS: The points move against the stated load: the readings ask for its opposite sign.");
    assert!(rows(&ran.out).iter().all(|row| row.ends_with(" negative")), "{}", ran.out);

    let cell = stiffarm_files::builtin::cell_text("comau").unwrap();
    folder.write("noisy.toml", cell.replace("variance_mm2 = 9.23e-5", "variance_mm2 = 9.23e-2"));
    let ran = folder.run("identify noisy.toml simulated.csv --noise known");
    assert_eq!(ran.code, Some(1));
    let begins = ["No ± for", "caution: The residuals"].map(|begin| printed_sentence(&ran.out, begin));
    assert_snapshot!([begins.join("\n"), rows(&ran.out).join("\n")].join("\n"), @r"
    No ± for joint 2, joint 4, joint 5 and joint 6: the table has their bounds.
    caution: The residuals are 0.04 times the cell's noise (0.011 mm against 0.304 mm, p < 0.001): the noise is stated too large.
    joint 1     0.9509      18         15          11  lost motion *  weak
    joint 2      2.990       –         47          26  lost motion *  1.95 to 6.42
    joint 3     0.9016      22         21         6.7  lost motion *  weak
    joint 4     0.2487       –          –          27  lost motion *  above 0.0443
    joint 5     0.1989       –         65         9.0  lost motion *  0.120 to 0.578
    joint 6     0.1562       –          –          20  lost motion *  above 0.0323
    ");
}

#[test]
fn validate() {
    let folder = measured();
    folder.ok("identify builtin:comau simulated.csv --exclude 5,6 --output stiffness.json");
    assert_snapshot!(
        folder.transcript("validate builtin:comau stiffness.json simulated.csv --only 5,6 --tolerance-mm 0.2")
    );
    let strict = folder.run("validate builtin:comau stiffness.json simulated.csv --tolerance-mm 0.001");
    assert_eq!(strict.code, Some(1));
    assert_snapshot!(["The tolerance", "caution:"].map(|begin| printed_sentence(&strict.out, begin)).join("\n"), @r"
    The tolerance of 0.0010 mm is not kept.
    caution: Postures 1, 2, 3 and 4 took part in the identification: their deviations say little.
    ");
    // Another version of the cell is named.
    let line = "validate builtin:comau-reference stiffness.json simulated.csv --only 5";
    let remarks = folder.json(line)["result"]["remarks"].clone();
    assert_eq!(codes(&remarks), ["other-cell"]);
    let shown = printed_sentence(&folder.ok(line), "caution:");
    assert_snapshot!(shown, @"caution: The stiffness was identified with another version of this cell.");
}

#[test]
fn validate_json_takes_a_bare_list() {
    let folder = measured();
    folder.write("k.json", r#"{"stiffness_nm_per_rad": [950000, 3000000, 900000, 250000, 200000, 150000]}"#);
    let value = folder.json("validate builtin:comau k.json simulated.csv --model equilibrium");
    let result = &value["result"];
    // The truth leaves the noise alone.
    let ratio = result["deviation_rms_m"].as_f64().unwrap() / result["noise_expectation_m"].as_f64().unwrap();
    assert!((0.7..1.6).contains(&ratio), "{ratio}");
    assert_eq!(result["points"][0]["label"], "1-1");
}

#[test]
fn robots() {
    let folder = Folder::new();
    let list = folder.transcript("robots");
    assert!(list.lines().all(|line| line.chars().count() <= 80), "{list}");
    assert_snapshot!(list);
    assert_snapshot!("robots_one", folder.transcript("robots abb-irb4400l-30-243"));
    let value = folder.json("robots comau-nj165-3.0");
    assert_eq!(value["result"]["robots"][0]["stiffness"][0]["verified"], true);
    let value = folder.json("robots fanuc-m10ia");
    let robot = &value["result"]["robots"][0];
    assert_eq!(robot["theta_from_q"][2][1], -1.0);
    assert_eq!(robot["controller_base_mm_deg"][2], 450.0);
    assert_eq!(robot["dh_deg_mm_mm_deg"][1][1], 150.0);
    assert_eq!(robot["doubts"][0]["about"], "limits");
    let value = folder.json("robots ur5e");
    let robot = &value["result"]["robots"][0];
    assert_eq!(robot["capsules"][0]["link"], 0);
    assert!(robot["capsules"][0]["radius_mm"].as_f64().unwrap() > 50.0);
    // Frames of the rows lie beyond those of the joints by d1, 162.5 mm.
    assert_eq!(robot["dh_deg_mm_mm_deg"][0][2], 162.5);
    let shown = printed_sentence(&folder.ok("robots abb-irb2400-12-155"), "The levers");
    assert_snapshot!(shown, @"The levers of the parallelogram are in no capsule.");
}

/// A robot with doubts says them wherever its numbers are used, once.
#[test]
fn doubts_are_said_where_the_robot_is_used() {
    let folder = Folder::new();
    let doubt = "The limits of joint 3 are those";
    let times = |text: &str| text.matches(doubt).count();
    let init = folder.ok("init --robot fanuc-m10ia --output-dir cell");
    assert_eq!(times(&init), 1, "{init}");
    let text = folder.read("cell/cell.toml").replace("\n# ", " ");
    assert_eq!(times(&text), 1);
    assert_eq!(times(&folder.ok("check cell/cell.toml")), 1);
    for line in [
        "select cell/cell.toml -n 3 --rounds 1 --index condition --no-certificate --output plan.csv",
        "select cell/cell.toml --space-filling -n 3",
        "pose cell/cell.toml plan.csv",
    ] {
        assert_eq!(times(&folder.ok(line)), 1, "{line}");
        let line = line.replace(" --output plan.csv", "");
        let findings = &folder.json(&line)["result"]["findings"];
        assert_eq!(findings[0]["code"], "robot-doubt", "{line}");
        assert_eq!(findings[0]["severity"], "caution");
    }
    // Limits of one's own settle it.
    let limits = "limits_deg = [[-90, 90], [-90, 150], [-100, 200], [-180, 180], [-180, 180], [-350, 350]]";
    let limited = folder.read("cell/cell.toml").replace("# limits_deg", &format!("{limits}\n# limits_deg"));
    let limited =
        limited.replace("[-88.954374, 158.855225]", "[-89, 150]").replace("[-178.908748, 180]", "[-100, 180]");
    folder.write("own.toml", limited);
    let checked = folder.run("check own.toml");
    assert_eq!(times(&checked.out), 0, "{}{}", checked.out, checked.err);
    // All else is told as ever.
    assert!(
        checked.out.lines().any(|line| line.starts_with("characteristic length")),
        "{}{}",
        checked.out,
        checked.err
    );
}

#[test]
fn coverage_draws_the_shift_that_a_posture_shares() {
    let folder = Folder::new();
    let cell = stiffarm_files::builtin::cell_text("comau").unwrap();
    let shifted = cell.replace("posture_common_mm = 0", "posture_common_mm = 0.03");
    assert_ne!(cell, shifted);
    folder.write("shifted.toml", &shifted);
    let of = |cell: &str| {
        let line = format!("coverage {cell} builtin:comau-group1 --runs 200 --estimator ordinary");
        folder.json(&line)["result"]["coverage"].as_f64().unwrap()
    };
    // Least squares that know of no shift promise too much under one.
    let (plain, shifted) = (of("builtin:comau"), of("shifted.toml"));
    assert!(plain > 0.92 && shifted < 0.8, "{plain} {shifted}");
}

#[test]
fn schemas_describe_what_the_commands_print() {
    let folder = measured();
    folder.ok("identify builtin:comau simulated.csv --output stiffness.json");
    folder.write("poses.csv", "x_mm,y_mm,z_mm,a_deg,b_deg,c_deg\n1800,0,1500,0,90,0\n9000,0,0,0,0,0\n");
    let lines = [
        ("result-check", "check"),
        ("result-capsules", "capsules builtin:spindle.obj --unit mm --tool"),
        ("result-evaluate", "evaluate builtin:comau builtin:comau-group1"),
        ("result-select", "select builtin:comau --initial builtin:comau-group1"),
        ("result-select", "select builtin:comau -n 2 --rounds 1 --sensitivity --anchor-box-mm 1700,0,0,1800,0,0"),
        ("result-select", "select builtin:comau --given builtin:comau-group1 --rounds 1"),
        ("result-select-drop", "select builtin:comau --given builtin:comau-group1 --drop"),
        ("result-select-curve", "select builtin:comau --curve -n 2 --rounds 1"),
        ("result-select-space-filling", "select builtin:comau --space-filling"),
        ("result-simulate", "simulate builtin:comau builtin:comau-group1 --runs 2 --levels 1"),
        ("result-simulate-elastic", "simulate builtin:comau builtin:comau-group1 --elastic mixed --runs 1"),
        ("result-register", "register builtin:example-pairs"),
        ("result-identify", "identify builtin:comau simulated.csv"),
        ("result-validate", "validate builtin:comau stiffness.json simulated.csv"),
        ("result-validate", "validate builtin:comau simulated.csv --folds 3 --extra tilt3 --estimator ordinary"),
        ("result-zones", "zones --steps 5"),
        ("result-pose", "pose builtin:comau builtin:comau-group1"),
        ("result-pose-poses", "pose builtin:comau --poses poses.csv --convention kuka"),
        (
            "result-export",
            "export builtin:comau builtin:comau-group1 --language rapid --controller abb --output-dir program",
        ),
        (
            "result-export-compare",
            "export builtin:comau builtin:comau-group1 --language rapid --controller abb --compare program/measure_comau_group1.mod",
        ),
        ("result-study", "study --runs 2 --initial-groups 2 --output-dir study"),
        ("result-study", "study --runs 1 --initial-groups 0 --elastic mixed --output-dir study-elastic"),
    ];
    for (name, line) in lines {
        let schema: serde_json::Value = serde_json::from_str(&folder.ok(&format!("schema {name}"))).unwrap();
        let printed = folder.json(line);
        same_keys(&schema, &schema, &printed, name);
    }
}

/// Every key that is printed is described, and every required key is printed.
fn same_keys(root: &serde_json::Value, schema: &serde_json::Value, printed: &serde_json::Value, at: &str) {
    if let Some(name) = schema["$ref"].as_str() {
        return same_keys(root, root.pointer(name.trim_start_matches('#')).unwrap(), printed, at);
    }
    if let Some(options) = schema["anyOf"].as_array() {
        let option = options.iter().find(|o| o["type"] != "null").unwrap();
        if !printed.is_null() {
            same_keys(root, option, printed, at);
        }
        return;
    }
    match (printed, schema["properties"].as_object()) {
        (serde_json::Value::Object(object), Some(properties)) => {
            for (key, value) in object {
                let described = properties.get(key).unwrap_or_else(|| panic!("{at}.{key} is not described"));
                same_keys(root, described, value, &format!("{at}.{key}"));
            }
            let required = schema["required"].as_array().into_iter().flatten();
            for key in required.filter_map(|key| key.as_str()) {
                assert!(object.contains_key(key), "{at}.{key} is not printed");
            }
        }
        (serde_json::Value::Array(items), _) => {
            for item in items {
                same_keys(root, &schema["items"], item, &format!("{at}[]"));
            }
        }
        _ => {}
    }
}
