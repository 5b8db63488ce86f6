//! Cell files: the shipped ones hold the published values, every slip is
//! reported with its place, and the templates can be used as they are.

#![cfg(feature = "files")]

use crate::common;

use nalgebra::Vector3;
use stiffarm::files::builtin;
use stiffarm::files::cell::{
    measurements_template, parse_cell, parse_cell_bytes, postures_template, template,
};
use stiffarm::model::cell::Cell;
use stiffarm::model::cell::Columns;
use stiffarm::model::instruments::{Mount, Tracker, Uncertainty};
use stiffarm::model::load::{Axes, Load};
use stiffarm::model::observation::PostureTerms;
use stiffarm::model::process::{MillingDirection, Process};
use stiffarm::model::robot::catalogue;
use stiffarm::model::work::Work;

type Check = Result<(), Box<dyn std::error::Error>>;

/// Compares numbers that went through different arithmetic.
#[track_caller]
fn assert_close(found: f64, expected: f64) {
    let scale = expected.abs().max(1e-12);
    assert!(
        (found - expected).abs() <= 1e-14 * scale,
        "{found:e} is not {expected:e}"
    );
}

/// Zhang et al. 2021, Table 1 \[deg\].
const TABLE_1: [[f64; 2]; 6] = [
    [-90.0, 90.0],
    [-60.0, 40.0],
    [-180.0, -40.0],
    [-180.0, 180.0],
    [-90.0, 90.0],
    [-180.0, 180.0],
];

/// Zhang et al. 2021, Table 2 \[N·m/rad\].
const TABLE_2: [f64; 6] = [950e3, 3000e3, 900e3, 250e3, 200e3, 150e3];

/// Zhang et al. 2021, Table 5 \[deg\].
const TABLE_5: [[f64; 6]; 3] = [
    [12.81, 33.07, -126.36, 72.81, -67.88, 24.27],
    [-22.25, -34.46, -109.53, -94.38, 49.16, 186.07],
    [-61.35, -10.10, -119.99, -272.36, -55.71, -110.56],
];

/// What the default and the reference cell share: the reference cell's robot,
/// tool and load (`cell-comau.json` of the reference numbers), and the paper's tables.
fn check_comau(cell: &Cell) {
    let robot = &cell.setup.robot;
    assert_eq!(robot.name(), "COMAU SMART5 NJ 165-3.0");
    for (bound, degrees) in cell.bounds.iter().zip(TABLE_1) {
        assert_eq!(*bound, degrees.map(f64::to_radians));
    }
    assert_eq!(cell.prior.as_deref(), Some(&TABLE_2[..]));
    assert_eq!(cell.characteristic_length, Some(0.773));
    let tool = &cell.setup.tool;
    assert_eq!(tool.loading_point.as_slice(), [0.20, 0.0, 0.25]);
    let points = [
        ("1", [0.15, 0.0, 0.2]),
        ("2", [0.0, 0.15, 0.2]),
        ("3", [-0.15, 0.0, 0.2]),
        ("4", [0.0, -0.15, 0.2]),
    ];
    assert_eq!(tool.point_count(), points.len());
    for (point, (name, position)) in tool.measuring_points.iter().zip(points) {
        assert_eq!(point.name, name);
        assert_eq!(point.position.as_slice(), position);
    }
    assert!(!tool.has_sensor && tool.series_compliance.is_none());
    let Load::Rope { anchor, magnitude } = &cell.setup.load else {
        panic!("the load is a rope, not {:?}", cell.setup.load);
    };
    assert_eq!(anchor.as_slice(), [1.8, 0.0, 0.0]);
    assert_eq!(*magnitude, 500.0);
    // Section IV.A: 9.23e-5 mm².
    assert_close(cell.noise.reading_variance, 9.23e-11);
    assert_eq!(cell.noise.readings_per_displacement, 1);
    assert_eq!(cell.noise.posture_common_std, 0.0);
}

#[test]
fn the_default_cell_holds_the_published_values() -> Check {
    let cell = builtin::cell("comau")?;
    check_comau(&cell);
    assert_eq!(builtin::cell_names()[0], "comau");
    let limits = &cell.limits;
    let corners = limits.tool_box.ok_or("no box")?;
    assert_eq!(corners[0].as_slice(), [0.9, -1.9, 0.3]);
    assert_eq!(corners[1].as_slice(), [3.0, 1.9, 3.0]);
    assert_eq!(limits.floor, None);
    assert_eq!(limits.keep_out_radius, Some(0.9));
    assert_eq!(limits.wrist_height, Some(0.3));
    assert_eq!(limits.rope_length, Some([0.8, 3.4]));
    assert_eq!(cell.validation.len(), TABLE_5.len());
    for (i, (posture, degrees)) in cell.validation.iter().zip(TABLE_5).enumerate() {
        assert_eq!(posture.name, format!("V{}", i + 1));
        assert_eq!(posture.q, degrees.map(f64::to_radians));
    }
    // The tasks' tool points down onto the table, inside the limits (the rope
    // is no part of the work).
    assert_eq!(cell.tasks, common::tasks());
    let mut work = cell.limits.clone();
    work.rope_length = None;
    for task in &cell.tasks {
        let terms = PostureTerms::new(&cell.setup, &task.q, None)?;
        assert!(terms.frames().direction(&nalgebra::Vector3::z()).z < -0.85);
        let margin = work.smallest(&cell.setup, &terms).ok_or("no limits")?;
        assert!(margin.margin > 0.05, "{}: {margin:?}", task.name);
    }
    Ok(())
}

#[test]
fn the_reference_cell_has_joint_bounds_only() -> Check {
    let cell = builtin::cell("comau-reference")?;
    check_comau(&cell);
    assert!(cell.limits.is_empty());
    assert!(cell.validation.is_empty());
    assert!(cell.tasks.is_empty());
    Ok(())
}

#[test]
fn the_measured_fanuc_cell() -> Check {
    let cell = builtin::cell("fanuc-r2000ic")?;
    assert_eq!(cell.setup.robot.name(), "FANUC R-2000iC/165F");
    assert_eq!(cell.setup.load, Load::Measured);
    // tcp_in_flange_m of the data set's robot description.
    let tcp = [0.0069, 0.2453, 0.3193];
    assert_eq!(cell.setup.tool.point_count(), 1);
    assert_eq!(cell.setup.tool.measuring_points[0].name, "TCP");
    assert_eq!(cell.setup.tool.tcp(), cell.setup.tool.loading_point);
    for (found, expected) in cell.setup.tool.tcp().iter().zip(tcp) {
        assert_close(*found, expected);
    }
    assert_eq!(cell.prior, None);
    assert_eq!(cell.characteristic_length, None);
    let range: Vec<[f64; 2]> = cell.bounds.iter().map(|b| b.map(f64::to_degrees)).collect();
    assert_close(range[0][0], -125.0);
    assert_close(range[5][1], 240.0);
    Ok(())
}

#[test]
fn group_1_is_in_bounds_and_inside_the_limits() -> Check {
    let cell = builtin::cell("comau")?;
    let group = builtin::postures("comau-group1", &cell.setup.robot)?;
    // cell-comau.json of the reference numbers, without its rounding.
    let degrees = [
        [-35.0, -10.0, -95.0, 10.0, 15.0, -20.0],
        [-20.0, 15.0, -110.0, -15.0, -10.0, 25.0],
        [-5.0, -25.0, -80.0, 5.0, 20.0, 10.0],
        [10.0, 5.0, -100.0, -20.0, -15.0, -30.0],
        [25.0, -20.0, -115.0, 15.0, 10.0, 0.0],
        [40.0, 10.0, -75.0, -5.0, -20.0, 30.0],
    ];
    assert_eq!(group.len(), degrees.len());
    let mut smallest = f64::INFINITY;
    for (posture, degrees) in group.iter().zip(degrees) {
        assert_eq!(posture.q, degrees.map(f64::to_radians));
        let terms = PostureTerms::new(&cell.setup, &posture.q, None)?;
        let margin = cell
            .limits
            .smallest(&cell.setup, &terms)
            .ok_or("no limits")?;
        smallest = smallest.min(margin.margin);
    }
    // "Group 1 satisfies it with 0.039 m to spare" (method, section 10).
    assert!((smallest - 0.039).abs() < 5e-4, "{smallest}");
    Ok(())
}

#[test]
fn copies_for_the_reader_are_the_built_in_files() -> Check {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cells");
    if !folder.exists() {
        // A packaged crate has no workspace around it.
        return Ok(());
    }
    for name in builtin::cell_names() {
        let copy = std::fs::read_to_string(folder.join(format!("{name}.toml")))?;
        assert_eq!(Some(copy.as_str()), builtin::cell_text(name), "{name}");
    }
    for name in builtin::postures_names() {
        let copy = std::fs::read_to_string(folder.join(format!("{name}.csv")))?;
        assert_eq!(Some(copy.as_str()), builtin::postures_text(name), "{name}");
    }
    for name in builtin::pairs_names() {
        let copy = std::fs::read_to_string(folder.join(format!("{name}.csv")))?;
        assert_eq!(Some(copy.as_str()), builtin::pairs_text(name), "{name}");
    }
    let files = std::fs::read_dir(folder)?.count();
    assert_eq!(files, builtin::names().len(), "every copy is built in");
    Ok(())
}

#[test]
fn unknown_built_in_names_are_answered_with_the_nearest() -> Check {
    let error = builtin::cell("comua").unwrap_err().to_string();
    assert!(error.contains("did you mean \"comau\"?"), "{error}");
    let robot = builtin::cell("comau")?.setup.robot;
    let error = builtin::postures("group", &robot).unwrap_err().to_string();
    assert!(error.contains("built in: comau-group1"), "{error}");
    Ok(())
}

/// Half-sine sequence of angles in the bounds: the same on every machine.
fn some_postures(cell: &Cell) -> impl Iterator<Item = Vec<f64>> + '_ {
    (1..400).map(|i| {
        let fraction = |j: usize| (f64::from(i) * (0.37 + 0.23 * j as f64)).rem_euclid(1.0);
        let bounds = cell.bounds.iter().enumerate();
        bounds
            .map(|(j, [low, high])| low + (high - low) * fraction(j))
            .collect()
    })
}

#[test]
fn templates_can_be_used_as_they_are() -> Check {
    for entry in catalogue() {
        let text = template(entry.key)?;
        let cell = parse_cell(&text, "cell.toml")?;
        assert_eq!(cell.setup.robot.name(), entry.name);
        assert_eq!(
            cell.prior.is_some(),
            !entry.stiffness.is_empty(),
            "{}",
            entry.key
        );
        // The commented task can be used as it is, too.
        let (above, task) = text.split_once("# [[task]]").ok_or("no task")?;
        let (task, _) = task.split_once("\n\n").ok_or("no end")?;
        let task = task.replace("\n# ", "\n");
        let with_task = parse_cell(&format!("{above}[[task]]{task}"), "cell.toml")?;
        assert_eq!(with_task.tasks[0].name, "roughing");
        assert_eq!(with_task.tasks[0].tip, cell.setup.tool.tcp());
        // So can what is commented out of the instruments and of the columns.
        let tables = [
            "sensor",
            "tracker",
            "uncertainty",
            "columns",
            "work",
            "work.force",
            "work.milling",
        ];
        for table in tables {
            let (above, rest) = text.split_once(&format!("# [{table}]")).ok_or("no table")?;
            let own = rest.split_once("\n\n").map_or(rest, |(own, _)| own);
            let own = own.replace("\n# ", "\n");
            let with_table = parse_cell(&format!("{above}[{table}]{own}"), "cell.toml")?;
            assert_ne!(with_table, cell, "{table}");
        }
        // The limits leave room for postures of this robot.
        let mut inside = 0;
        for q in some_postures(&cell) {
            let terms = PostureTerms::new(&cell.setup, &q, None)?;
            let margin = cell
                .limits
                .smallest(&cell.setup, &terms)
                .ok_or("no limits")?;
            inside += usize::from(margin.margin >= 0.0);
        }
        assert!(
            inside >= 5,
            "{}: {inside} of 399 postures inside",
            entry.key
        );
        // The tables begin with what to fill in, and no rows yet.
        let error = stiffarm::files::table::read_postures(
            postures_template(&cell.setup.robot).as_bytes(),
            "postures.csv",
            &cell.setup.robot,
        );
        assert!(error.unwrap_err().message().contains("no rows"));
        let error = stiffarm::files::table::read_measurements(
            measurements_template(&cell).as_bytes(),
            "measurements.csv",
            &cell,
            None,
        );
        assert!(error.unwrap_err().message().contains("no rows"));
    }
    let error = template("comau").unwrap_err();
    assert_eq!(error.code().as_str(), "unknown-name");
    Ok(())
}

#[test]
fn examples_of_the_templates_are_valid_rows() -> Check {
    let cell = builtin::cell("comau")?;
    let robot = &cell.setup.robot;
    let uncommented = |text: String| -> String {
        let (heading, rest): (Vec<&str>, Vec<&str>) =
            text.lines().partition(|line| line.starts_with("posture,"));
        let rows = rest.into_iter().filter(|line| line.starts_with("# P1,"));
        let rows = rows.map(|line| line.trim_start_matches("# ").replace(",,,,", ",1,2,3,"));
        heading
            .into_iter()
            .map(String::from)
            .chain(rows)
            .collect::<Vec<_>>()
            .join("\n")
    };
    let postures = uncommented(postures_template(robot));
    let postures =
        stiffarm::files::table::read_postures(postures.as_bytes(), "postures.csv", robot)?;
    assert_eq!(postures.len(), 1);
    let sheet = uncommented(measurements_template(&cell));
    let read = stiffarm::files::table::read_readings(sheet.as_bytes(), "m.csv", &cell, None)?;
    let states: Vec<_> = read.postures[0]
        .states
        .iter()
        .map(|state| (state.state.as_str(), state.readings.len()))
        .collect();
    assert_eq!(states, [("unloaded", 4), ("loaded", 4)]);
    Ok(())
}

#[test]
fn the_template_of_the_default_robot() -> Check {
    insta::assert_snapshot!("template_comau", template("comau-nj165-3.0")?);
    let cell = builtin::cell("comau")?;
    insta::assert_snapshot!("template_postures", postures_template(&cell.setup.robot));
    insta::assert_snapshot!("template_measurements", measurements_template(&cell));
    Ok(())
}

/// A cell with every table, on lines of known number.
const FULL: &str = include_str!("../full-cell.toml");

#[test]
fn every_key_arrives_in_si_units() -> Check {
    let cell = parse_cell(FULL, "cell.toml")?;
    let robot = &cell.setup.robot;
    assert_eq!(cell.name, "full");
    assert_eq!(robot.name(), "two joints");
    assert_eq!(robot.spring_names(), ["A1", "A2"]);
    assert_eq!(robot.coupling()[(0, 0)], -1.0);
    assert_eq!(robot.joints()[1].limits, [-75.0, 95.0].map(f64::to_radians));
    assert_eq!(robot.joints()[0].placement.translation.z, 0.0);
    assert_eq!(
        robot.joints()[1].placement.translation.vector.as_slice(),
        [0.4, 0.0, 0.83]
    );
    assert_eq!(robot.gravity_direction().as_slice(), [0.0, 0.0, -1.0]);
    assert_eq!(cell.characteristic_length, Some(0.5));
    let series = cell
        .setup
        .tool
        .series_compliance
        .as_ref()
        .ok_or("no series")?;
    assert_eq!(series.origin.z, 0.06);
    assert_eq!(series.matrix.diagonal().as_slice()[..3], [1e-8, 1e-8, 5e-9]);
    assert_eq!(series.matrix[(5, 5)], 1.0 / 4e5);
    assert!(cell.setup.tool.has_sensor);
    assert_eq!(cell.limits.floor, Some(0.01));
    assert_close(cell.noise.reading_variance, 1e-10);
    assert_eq!(cell.noise.readings_per_displacement, 2);
    assert_close(cell.noise.posture_common_std, 1e-5);
    assert_eq!(cell.prior.as_deref(), Some(&[1e6, 3e6][..]));
    assert_eq!(cell.validation[0].q[1], 90f64.to_radians());
    let [milling, plain] = &cell.tasks[..] else {
        panic!("two tasks");
    };
    assert_eq!(milling.name, "milling");
    assert_eq!(milling.q, [100.0, -70.0].map(f64::to_radians));
    assert_eq!(milling.wrench.force.as_slice(), [300.0, -150.0, 0.0]);
    assert_eq!(milling.wrench.moment.as_slice(), [0.0, 0.0, 12.0]);
    assert_eq!(milling.axes, Axes::Tool);
    assert_eq!(milling.tip.as_slice(), [0.0, 0.01, 0.35]);
    let sensor = cell.sensor.as_ref().ok_or("no sensor")?;
    assert_eq!(sensor.mount, Mount::Base);
    assert!(sensor.reports_by_robot);
    assert_eq!(sensor.pose.translation.vector.as_slice(), [1.8, 0.0, -0.03]);
    // Roll 180° about x, then yaw 90° about z: the sensor's x points along y, its y along x.
    for (axis, expected) in [(Vector3::x(), Vector3::y()), (Vector3::y(), Vector3::x())] {
        assert!((sensor.pose.rotation * axis - expected).norm() < 1e-15);
    }
    let tracker = &cell.tracker;
    let base_from_tracker = tracker.base_from_tracker.ok_or("no pose")?;
    assert_eq!(
        base_from_tracker.translation.vector.as_slice(),
        [3.5, -1.2, 0.9]
    );
    assert_close(base_from_tracker.rotation.angle(), 150f64.to_radians());
    let accuracy = tracker.accuracy.ok_or("no accuracy")?;
    assert_eq!(accuracy.station.as_slice(), [0.0, 0.0, 0.05]);
    assert_close(accuracy.range, 10e-6);
    assert_close(accuracy.range_per_metre, 0.4e-6);
    assert_close(accuracy.angle, 3e-6);
    let uncertainty = &cell.uncertainty;
    let values = [
        (uncertainty.force_scale, 0.005),
        (uncertainty.anchor, 0.005),
        (uncertainty.loading_point, 0.001),
        (uncertainty.registration, 0.2e-3),
        (uncertainty.base_tilt_compliance, 1e-8),
        (uncertainty.sensor_compliance, 1.0 / 3.3e5),
        (uncertainty.lost_motion, (0.2f64 / 60.0).to_radians()),
    ];
    for (found, expected) in values {
        assert_close(found.ok_or("a key is missing")?, expected);
    }
    let tip = cell.work.tip.ok_or("no tip")?;
    assert_eq!(tip.translation.vector.as_slice(), [0.0, 0.02, 0.35]);
    // Pitch 180° about y, then yaw 90° about z: the tip's y points along −x, its z back.
    for (axis, expected) in [(Vector3::y(), -Vector3::x()), (Vector3::z(), -Vector3::z())] {
        assert!((tip.rotation * axis - expected).norm() < 1e-15);
    }
    let workpiece = &cell.work.workpiece;
    assert_eq!(workpiece.translation.vector.as_slice(), [1.5, -0.2, 0.6]);
    assert!((workpiece.rotation * Vector3::x() - Vector3::y()).norm() < 1e-15);
    let Some(Process::Milling(milling)) = cell.work.process else {
        panic!("the process is milling");
    };
    assert_eq!(milling.teeth, 2);
    assert_eq!(milling.direction, MillingDirection::Down);
    let k = milling.coefficients;
    let values = [
        (milling.diameter, 0.016),
        (milling.axial_depth, 0.003),
        (milling.radial_depth, 0.004),
        (milling.feed_per_tooth, 1e-4),
        (k.k_tc, 8e8),
        (k.k_rc, 2e8),
        (k.k_ac, 1e8),
        (k.k_te, 2e4),
        (k.k_re, 2.5e4),
        (k.k_ae, -1e3),
    ];
    for (found, expected) in values {
        assert_close(found, expected);
    }
    assert_eq!(cell.columns.names["x_mm"], "Center X");
    assert_eq!(cell.columns.names["q2_rad"], "A2");
    assert_eq!(cell.columns.ignore, ["Comment", "Target type"]);
    // What may be left out of a task.
    assert_eq!((plain.name.as_str(), plain.axes), ("task 2", Axes::Base));
    assert_eq!(plain.wrench.moment.norm(), 0.0);
    assert_eq!(plain.tip, cell.setup.tool.tcp());
    Ok(())
}

#[test]
fn what_may_be_left_out() -> Check {
    let text = "format = 1\nrobot.catalogue = 'comau-nj165-3.0'\n\
                tool = { loading_point_mm = [200, 0, 250], measuring_point = [{ name = '1', position_mm = [0, 0, 0] }] }\n\
                load = { kind = 'weight', magnitude_n = 300 }";
    let cell = parse_cell(text, "cell.toml")?;
    assert_eq!(cell.name, "COMAU SMART5 NJ 165-3.0");
    assert_eq!(cell.bounds[2], [-230.0, -10.0].map(f64::to_radians));
    assert_eq!(
        cell.prior.as_deref(),
        Some(&TABLE_2[..]),
        "the catalogue's first set"
    );
    assert_eq!(cell.characteristic_length, None);
    assert_eq!(cell.sensor, None);
    assert_eq!(cell.tracker, Tracker::default());
    assert_eq!(cell.uncertainty, Uncertainty::default());
    assert_eq!(cell.columns, Columns::default());
    assert_eq!(cell.work, Work::default());
    assert_close(cell.noise.reading_variance, 9.23e-11);
    let Load::Weight {
        magnitude,
        direction,
    } = cell.setup.load
    else {
        panic!("the load is a weight");
    };
    assert_eq!((magnitude, direction.z), (300.0, -1.0));
    Ok(())
}

#[test]
fn loads_and_bases() -> Check {
    let rope = "kind = \"rope\"\nmagnitude_n = 500\nanchor_mm = [1800, 0, 0]";
    let no_rope = FULL
        .replace("rope_length_mm = [800, 3400]\n", "")
        .replace("anchor_mm = 5\n", "");
    let wrench = "kind = \"wrench\"\nforce_n = [1, 2, 3]\nmoment_nm = [4, 5, 6]\naxes = \"tool\"";
    let cell = parse_cell(&no_rope.replace(rope, wrench), "cell.toml")?;
    let Load::Constant {
        wrench,
        axes: Axes::Tool,
    } = cell.setup.load
    else {
        panic!("the load is a wrench in tool axes");
    };
    assert_eq!(wrench.force.as_slice(), [1.0, 2.0, 3.0]);
    assert_eq!(wrench.moment.as_slice(), [4.0, 5.0, 6.0]);

    // Gravity of a wall-mounted robot.
    let weight = no_rope
        .replace(rope, "kind = \"weight\"\nmagnitude_n = 300")
        .replace("down = [0, 0, -2]", "down = [3, 0, 0]");
    let Load::Weight { direction, .. } = parse_cell(&weight, "cell.toml")?.setup.load else {
        panic!("the load is a weight");
    };
    assert_eq!(direction.as_slice(), [1.0, 0.0, 0.0]);

    // A base frame turned by 90° about z and raised by 1 m.
    let based = FULL.replace(
        "down = [0, 0, -2]",
        "base_xyz_mm = [100, 0, 1000]\nbase_rpy_deg = [0, 0, 90]",
    );
    let straight = parse_cell(FULL, "cell.toml")?.setup;
    let turned = parse_cell(&based, "cell.toml")?.setup;
    let q = [0.3, -0.2];
    let p = PostureTerms::new(&straight, &q, None)?
        .loading_point()
        .to_owned();
    let p_turned = PostureTerms::new(&turned, &q, None)?
        .loading_point()
        .to_owned();
    let expected = [0.1 - p.y, p.x, 1.0 + p.z];
    for (found, expected) in p_turned.iter().zip(expected) {
        assert!((found - expected).abs() < 1e-14);
    }
    Ok(())
}

#[test]
fn byte_order_mark_and_carriage_returns_leave_the_places_right() {
    let wrong = FULL.replace("magnitude_n = 500", "magnitude = 500");
    for text in [
        wrong.clone(),
        wrong.replace('\n', "\r\n"),
        format!("\u{feff}{wrong}"),
        format!("\u{feff}{}", wrong.replace('\n', "\r\n")),
    ] {
        let error = parse_cell_bytes(text.as_bytes(), "cell.toml").unwrap_err();
        let place = error.place();
        assert_eq!((place.line, place.column), (Some(28), Some(1)));
        assert_eq!(place.key.as_deref(), Some("load.magnitude"));
        let span = place.span.clone().unwrap_or_default();
        assert_eq!(&text[span], "magnitude");
    }
    let first_line = format!("\u{feff}{}", FULL.replace("format = 1", "format = 1, 2"));
    let error = parse_cell(&first_line, "cell.toml").unwrap_err();
    assert_eq!(error.place().column, Some(11), "{error}");
    let marked = format!("\u{feff}{}", FULL.replace('\n', "\r\n"));
    assert_eq!(
        parse_cell(&marked, "a").unwrap(),
        parse_cell(FULL, "b").unwrap()
    );
}

/// Every slip: what is replaced in [`FULL`] by what.
const SLIPS: &[(&str, &str)] = &[
    // Format and syntax.
    ("format = 1\n", ""),
    ("format = 1", "format = 2\nnovelty = true"),
    ("format = 1", "format = 0"),
    ("format = 1", "format = \"1\""),
    ("format = 1", "format = 1.0"),
    ("name = \"full\"", "name = full"),
    ("name = \"full\"", "name = \"full"),
    ("magnitude_n = 500", "magnitude_n = 500,5"),
    ("magnitude_n = 500", "magnitude_n = 500\nmagnitude_n = 600"),
    ("[noise]", "[load]"),
    // Unknown keys.
    ("magnitude_n = 500", "magnitude = 500"),
    (
        "magnitude_n = 500",
        "magnitude_n = 500\nbox_min_mm = [0, 0, 0]",
    ),
    ("[noise]", "[nose]"),
    ("[noise]", "[traker]"),
    ("[noise]", "[sensor]"),
    ("position_mm = [0, 150, 200]", "position_m = [0, 0.15, 0.2]"),
    ("origin_mm", "\"origin mm\""),
    ("q_deg = [12.5, 90]", "q_rad = [0.2, 1.5]"),
    ("name = \"full\"", "name = \"full\"\nmagnitude_n = 3"),
    // Missing keys.
    (FULL, "format = 1\n"),
    (
        FULL,
        "format = 1\n[robot]\ncatalogue = \"comau-nj165-3.0\"\n",
    ),
    ("dh_modified = [[0, 0, 830, 0], [-90, 400, 0, -90]]\n", ""),
    ("loading_point_mm = [200, 0, 250]\n", ""),
    ("position_mm = [0, 150, 200]\n", ""),
    ("name = \"b\"\n", ""),
    ("rotational_nm_per_rad = [3e5, 3e5, 4e5]\n", ""),
    ("kind = \"rope\"\n", ""),
    ("magnitude_n = 500\n", ""),
    ("anchor_mm = [1800, 0, 0]\n", ""),
    ("box_min_mm = [900, -1900, 300]\n", ""),
    ("name = \"V1\"\n", ""),
    // Values of the wrong kind.
    ("magnitude_n = 500", "magnitude_n = \"500\""),
    ("magnitude_n = 500", "magnitude_n = \"much\""),
    ("magnitude_n = 500", "magnitude_n = true"),
    ("magnitude_n = 500", "magnitude_n = 1979-05-27"),
    ("anchor_mm = [1800, 0, 0]", "anchor_mm = 1800"),
    (
        "position_mm = [0, 150, 200]",
        "position_mm = [0, \"150\", 200]",
    ),
    ("q_deg = [[-90, 90], [-60, 40]]", "q_deg = [-90, 90]"),
    ("name = \"b\"", "name = 2"),
    ("has_sensor = true", "has_sensor = \"yes\""),
    (
        "readings_per_displacement = 2",
        "readings_per_displacement = 1.5",
    ),
    (
        "readings_per_displacement = 2",
        "readings_per_displacement = 99999999999999999999",
    ),
    (
        "[limits]\nbox_min_mm = [900, -1900, 300]",
        "[[limits]]\nbox_min_mm = [900, -1900, 300]",
    ),
    ("[[validation.posture]]", "[validation.posture]"),
    (FULL, "format = 1\nnoise = 3\n"),
    (FULL, "format = 1\nload = [\"rope\", 500]\n"),
    (FULL, "format = 1\ntool.measuring_point = [[\"a\", 1]]\n"),
    // Numbers.
    ("magnitude_n = 500", "magnitude_n = nan"),
    ("anchor_mm = [1800, 0, 0]", "anchor_mm = [1800, -inf, 0]"),
    ("magnitude_n = 500", "magnitude_n = 1e999"),
    ("magnitude_n = 500", "magnitude_n = 1e40"),
    ("magnitude_n = 500", "magnitude_n = -500"),
    ("magnitude_n = 500", "magnitude_n = 0"),
    ("variance_mm2 = 1e-4", "variance_mm2 = -1e-4"),
    ("posture_common_mm = 0.01", "posture_common_mm = -0.01"),
    (
        "readings_per_displacement = 2",
        "readings_per_displacement = 3",
    ),
    (
        "characteristic_length_mm = 500",
        "characteristic_length_mm = 0",
    ),
    (
        "prior_nm_per_rad = [1e6, 3e6]",
        "prior_nm_per_rad = [1e6, 0]",
    ),
    (
        "rotational_nm_per_rad = [3e5, 3e5, 4e5]",
        "rotational_nm_per_rad = [3e5, -3e5, 4e5]",
    ),
    ("down = [0, 0, -2]", "down = [0, 0, 0]"),
    ("keep_out_radius_mm = 900", "keep_out_radius_mm = 0"),
    (
        "rope_length_mm = [800, 3400]",
        "rope_length_mm = [-1, 3400]",
    ),
    // Lengths of lists.
    (
        "loading_point_mm = [200, 0, 250]",
        "loading_point_mm = [200, 250]",
    ),
    ("q_deg = [[-90, 90], [-60, 40]]", "q_deg = [[-90, 90]]"),
    (
        "q_deg = [[-90, 90], [-60, 40]]",
        "q_deg = [[-90, 90], [-60, 0, 40]]",
    ),
    ("q_deg = [12.5, 90]", "q_deg = [12, 5, 90]"),
    ("prior_nm_per_rad = [1e6, 3e6]", "prior_nm_per_rad = [1e6]"),
    (
        "dh_modified = [[0, 0, 830, 0], ",
        "dh_modified = [[0, 0, 830], ",
    ),
    (
        "dh_modified = [[0, 0, 830, 0], [-90, 400, 0, -90]]",
        "dh_modified = []",
    ),
    (
        "theta_from_q = [[-1, 0], [0, 1]]",
        "theta_from_q = [[-1, 0]]",
    ),
    (
        "theta_from_q = [[-1, 0], [0, 1]]",
        "theta_from_q = [[-1, 0], [0]]",
    ),
    ("joint_names = [\"A1\", \"A2\"]", "joint_names = [\"A1\"]"),
    ("down = [0, 0, -2]", "base_rpy_deg = [90]"),
    // Ranges, limits, names.
    (
        "q_deg = [[-90, 90], [-60, 40]]",
        "q_deg = [[90, -90], [-60, 40]]",
    ),
    (
        "q_deg = [[-90, 90], [-60, 40]]",
        "q_deg = [[-90, 90], [40, 40]]",
    ),
    (
        "q_deg = [[-90, 90], [-60, 40]]",
        "q_deg = [[-90, 90], [-80, 40]]",
    ),
    (
        "q_deg = [[-90, 90], [-60, 40]]",
        "q_deg = [[-90, 171], [-60, 40]]",
    ),
    ("q_deg = [12.5, 90]", "q_deg = [12.5, 95.1]"),
    (
        "limits_deg = [[-170, 170], [-75, 95]]",
        "limits_deg = [[-170, 170], [95, -75]]",
    ),
    (
        "box_max_mm = [3000, 1900, 3000]",
        "box_max_mm = [3000, 1900, 300]",
    ),
    (
        "rope_length_mm = [800, 3400]",
        "rope_length_mm = [3400, 800]",
    ),
    (
        "theta_from_q = [[-1, 0], [0, 1]]",
        "theta_from_q = [[1, 1], [1, 1]]",
    ),
    ("down = [0, 0, -2]", "elastic_from_theta = [[0, 0], [0, 1]]"),
    ("name = \"b\"", "name = \"a\""),
    ("name = \"b\"", "name = \"Base\""),
    ("name = \"b\"", "name = \"base-2\""),
    ("name = \"b\"", "name = \"Base left\""),
    ("name = \"b\"", "name = \" b\""),
    ("name = \"b\"", "name = \"\""),
    ("name = \"b\"", "name = \"b\\nc\""),
    (
        "joint_names = [\"A1\", \"A2\"]",
        "joint_names = [\"A1\", \"A1\"]",
    ),
    // Tasks.
    ("tip_mm = [0, 10, 350]", "tip_m = [0, 0.01, 0.35]"),
    ("tip_mm = [0, 10, 350]", "magnitude_n = 300"),
    ("tip_mm = [0, 10, 350]", "tip_mm = [0, 350]"),
    ("q_deg = [100, -70]\n", ""),
    ("q_deg = [100, -70]", "q_deg = [100, -70, 20]"),
    ("q_deg = [100, -70]", "q_deg = [100, -76]"),
    ("force_n = [300, -150, 0]\n", ""),
    ("force_n = [300, -150, 0]", "force_n = 300"),
    ("force_n = [0, 0, 400]", "force_n = [0, 0, 0]"),
    ("moment_nm = [0, 0, 12]", "moment_nm = [0, 0, nan]"),
    ("axes = \"tool\"", "axes = \"world\""),
    ("name = \"milling\"", "name = \"task 2\""),
    ("name = \"milling\"", "name = \"\""),
    ("[[task]]\nname", "[task]\nname"),
    ("[[task]]\nname", "[[tasks]]\nname"),
    // Sensor, tracker, uncertainty.
    ("mount = \"base\"\n", ""),
    ("mount = \"base\"", "mount = \"flanges\""),
    ("mount = \"base\"", "mount = \"wall\""),
    ("reports = \"by_robot\"\n", ""),
    ("reports = \"by_robot\"", "reports = \"by_the_robot\""),
    ("reports = \"by_robot\"", "reports = -1"),
    ("xyz_mm = [1800, 0, -30]\n", ""),
    ("rpy_deg = [180, 0, 90]\n", ""),
    ("rpy_deg = [180, 0, 90]", "rpy_deg = [180, 90]"),
    ("rpy_deg = [180, 0, 90]", "rpy_rad = [3.14, 0, 1.57]"),
    ("xyz_mm = [3500, -1200, 900]\n", ""),
    ("rpy_deg = [0, 0, 150]\n", ""),
    ("range_um = 10\n", ""),
    ("range_um = 10", "range_um = 0"),
    ("range_um = 10", "range_mm = 0.01"),
    ("range_um_per_m = 0.4", "range_um_per_m = -0.4"),
    ("angle_urad = 3\n", ""),
    ("angle_urad = 3", "angle_urad = nan"),
    ("range_um = 10\nrange_um_per_m = 0.4\nangle_urad = 3\n", ""),
    ("force_scale_percent = 0.5", "force_scale_percent = -0.5"),
    ("force_scale_percent = 0.5", "force_scale = 0.005"),
    (
        "lost_motion_arcmin = 0.2",
        "lost_motion_arcmin = [0.2, 0.3]",
    ),
    (
        "base_tilt_stiffness_nm_per_rad = 1e8",
        "base_tilt_stiffness_nm_per_rad = 0",
    ),
    // Headings of another software.
    ("x_mm = \"Center X\"", "x_cm = \"Center X\""),
    ("x_mm = \"Center X\"", "x = \"Center X\""),
    ("x_mm = \"Center X\"", "postrue = \"Center X\""),
    ("x_mm = \"Center X\"", "q3_deg = \"A3\""),
    ("x_mm = \"Center X\"", "temperature = \"T\""),
    ("x_mm = \"Center X\"", "x_mm = \"\""),
    ("x_mm = \"Center X\"", "x_mm = \"name\""),
    ("x_mm = \"Center X\"", "x_mm = \"Comment\""),
    ("x_mm = \"Center X\"", "x_mm = 3"),
    ("x_mm = \"Center X\"", "x_mm = [\"Center X\"]"),
    ("x_mm = \"Center X\"", "x_mm = \"Center X\"\nX_mm = \"X\""),
    (
        "ignore = [\"Comment\", \"Target type\"]",
        "ignore = \"Comment\"",
    ),
    (
        "ignore = [\"Comment\", \"Target type\"]",
        "ignore = [\"Comment\", 3]",
    ),
    (
        "ignore = [\"Comment\", \"Target type\"]",
        "ignore = [\"Comment\", \"comment\"]",
    ),
    (
        "ignore = [\"Comment\", \"Target type\"]",
        "ignored = [\"Comment\"]",
    ),
    (FULL, "format = 1\ncolumns = [\"x_mm\"]\n"),
    // Contradictions.
    (
        "kind = \"rope\"\nmagnitude_n = 500\nanchor_mm = [1800, 0, 0]\n[limits]\nbox_min_mm = [900, -1900, 300]\n\
         box_max_mm = [3000, 1900, 3000]\nfloor_mm = 10\nkeep_out_radius_mm = 900\nwrist_height_mm = 300\n\
         rope_length_mm = [800, 3400]",
        "kind = \"weight\"\nmagnitude_n = 500",
    ),
    ("[robot]", "[robot]\ncatalogue = \"comau-nj165-3.0\""),
    ("name = \"two joints\"", "dh_standard = [[0, 0, 830, 0]]"),
    (
        "dh_modified = [[0, 0, 830, 0], [-90, 400, 0, -90]]",
        "catalogue = \"comau\"",
    ),
    (
        "down = [0, 0, -2]",
        "base_z_mm = 500\nbase_xyz_mm = [0, 0, 500]",
    ),
    ("kind = \"rope\"", "kind = \"ropes\""),
    ("kind = \"rope\"", "kind = \"gravitation\""),
    ("kind = \"rope\"", "kind = \"weight\""),
    (
        "kind = \"rope\"\nmagnitude_n = 500\nanchor_mm = [1800, 0, 0]",
        "kind = \"measured\"\nforce_n = [1, 0, 0]",
    ),
    (
        "kind = \"rope\"\nmagnitude_n = 500\nanchor_mm = [1800, 0, 0]",
        "kind = \"measured\"",
    ),
    (
        "kind = \"rope\"\nmagnitude_n = 500\nanchor_mm = [1800, 0, 0]",
        "kind = \"wrench\"\naxes = \"base\"",
    ),
    (
        "kind = \"rope\"\nmagnitude_n = 500\nanchor_mm = [1800, 0, 0]",
        "kind = \"wrench\"\nforce_n = [1, 0, 0]",
    ),
    (
        "kind = \"rope\"\nmagnitude_n = 500\nanchor_mm = [1800, 0, 0]",
        "kind = \"wrench\"\nforce_n = [1, 0, 0]\naxes = \"world\"",
    ),
    (
        "kind = \"rope\"\nmagnitude_n = 500\nanchor_mm = [1800, 0, 0]",
        "kind = \"wrench\"\nforce_n = [0, 0, 0]\naxes = \"base\"",
    ),
];

#[test]
fn every_slip_is_reported_with_its_place() {
    let mut report = String::new();
    for (from, to) in SLIPS {
        assert!(FULL.contains(from), "{from}");
        let text = FULL.replacen(from, to, 1);
        let error = match parse_cell(&text, "cell.toml") {
            Ok(_) => panic!("accepted: {to}"),
            Err(error) => error,
        };
        let shown = if to.is_empty() {
            format!("without {}", from.trim_end())
        } else {
            to.trim_end().replace('\n', "; ")
        };
        report += &format!("» {shown}\n[{}] {error}\n\n", error.code().as_str());
    }
    insta::assert_snapshot!("cell_slips", report);
}

#[test]
fn bytes_that_are_not_utf8() {
    let mut report = String::new();
    for bytes in [
        &b"format = 1\nname = \"Pr\xfcfstand\"\n"[..],
        b"\xff\xfef\0o\0",
    ] {
        let error = parse_cell_bytes(bytes, "cell.toml").unwrap_err();
        report += &format!("[{}] {error}\n\n", error.code().as_str());
    }
    insta::assert_snapshot!("cell_encoding", report);
}

#[cfg(feature = "schema")]
mod schema {
    use serde_json::Value;
    use stiffarm::files::builtin;
    use stiffarm::files::cell::{cell_schema, template};

    type Check = Result<(), Box<dyn std::error::Error>>;

    /// The schema of the value `schema` stands for, references followed.
    fn resolve<'s>(root: &'s Value, schema: &'s Value) -> &'s Value {
        match schema.get("$ref").and_then(Value::as_str) {
            Some(path) => root
                .pointer(path.trim_start_matches('#'))
                .expect("a valid reference"),
            None => schema,
        }
    }

    /// Checks what JSON Schema says of keys, kinds and lengths.
    fn check(root: &Value, schema: &Value, value: &toml::Value, path: &str) {
        let described = schema.get("description").is_some() || path.ends_with(']');
        let schema = resolve(root, schema);
        assert!(
            described || schema.get("description").is_some(),
            "{path} has no description"
        );
        let kind = schema["type"]
            .as_str()
            .unwrap_or_else(|| panic!("{path}: {schema}"));
        match value {
            toml::Value::Table(table) => {
                assert_eq!(kind, "object", "{path}");
                assert_eq!(schema["additionalProperties"], false, "{path}");
                for required in schema["required"].as_array().into_iter().flatten() {
                    let name = required.as_str().unwrap_or_default();
                    assert!(table.contains_key(name), "{path}.{name}");
                }
                for (key, value) in table {
                    let mut child = &schema["properties"][key];
                    if child.is_null() && key.starts_with('q') {
                        // The angles of any number of joints.
                        child = &schema["patternProperties"]["^q[1-9][0-9]*_(deg|rad)$"];
                    }
                    assert!(child.is_object(), "{path}.{key} is not in the schema");
                    check(root, child, value, &format!("{path}.{key}"));
                }
            }
            toml::Value::Array(entries) => {
                assert_eq!(kind, "array", "{path}");
                for (bound, wrong) in [("minItems", true), ("maxItems", false)] {
                    if let Some(bound) = schema[bound].as_u64() {
                        let short = (entries.len() as u64) < bound;
                        let long = (entries.len() as u64) > bound;
                        assert!(if wrong { !short } else { !long }, "{path}");
                    }
                }
                for (i, entry) in entries.iter().enumerate() {
                    check(root, &schema["items"], entry, &format!("{path}[{}]", i + 1));
                }
            }
            toml::Value::Integer(_) => assert!(["integer", "number"].contains(&kind), "{path}"),
            toml::Value::Float(_) => assert_eq!(kind, "number", "{path}"),
            toml::Value::Boolean(_) => assert_eq!(kind, "boolean", "{path}"),
            toml::Value::String(_) => assert_eq!(kind, "string", "{path}"),
            toml::Value::Datetime(_) => panic!("{path}: a date"),
        }
    }

    #[test]
    fn shipped_cells_and_templates_follow_the_schema() -> Check {
        let schema = cell_schema();
        let root = schema.as_value();
        let mut texts = vec![super::FULL.to_string()];
        for name in builtin::cell_names() {
            texts.push(builtin::cell_text(name).unwrap_or_default().to_string());
        }
        for entry in stiffarm::model::robot::catalogue() {
            texts.push(template(entry.key)?);
        }
        for text in texts {
            let table: toml::Table = toml::from_str(&text)?;
            check(root, root, &toml::Value::Table(table), "");
        }
        Ok(())
    }

    #[test]
    fn the_schema_has_no_null_and_no_rust_names() -> Check {
        let text = serde_json::to_string_pretty(&cell_schema())?;
        for word in ["null", "Raw", "anyOf", "\"double\"", "\"int64\""] {
            assert!(!text.contains(word), "{word}");
        }
        insta::assert_snapshot!("cell_schema", text);
        Ok(())
    }
}
