//! Cell files: the shipped ones hold the published values, every slip is
//! reported with its place, and the templates can be used as they are.

mod built_in;
mod drawing;
mod meshes;
mod own_rows;
mod schema;
mod slips;
mod templates;

use crate::common;

use nalgebra::Vector3;
use stiffarm::model::cell::Cell;
use stiffarm::model::cell::Columns;
use stiffarm::model::elastic::ElasticSource;
use stiffarm::model::instruments::{Mount, Tracker, Uncertainty};
use stiffarm::model::load::{Axes, Load};
use stiffarm::model::observation::PostureTerms;
use stiffarm::model::process::{MillingDirection, Process};
use stiffarm::model::robot::catalogue;
use stiffarm::model::work::Work;
use stiffarm_files::builtin;
use stiffarm_files::cell::{measurements_template, parse_cell, parse_cell_bytes, postures_template, template};

type Check = Result<(), Box<dyn std::error::Error>>;

/// Compares numbers that went through different arithmetic.
fn close(actual: f64, expected: f64) -> bool {
    (actual - expected).abs() <= 1e-14 * expected.abs().max(1e-12)
}

#[track_caller]
fn assert_close(actual: f64, expected: f64) {
    assert!(close(actual, expected), "{actual:e} is not {expected:e}");
}

/// A cell with every table, on lines of known number.
const FULL: &str = include_str!("../../full-cell.toml");

/// Zhang et al. 2021, Table 2 \[N·m/rad\].
const TABLE_2: [f64; 6] = [950e3, 3000e3, 900e3, 250e3, 200e3, 150e3];

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
    assert_eq!(robot.joints()[1].placement.translation.vector.as_slice(), [0.4, 0.0, 0.83]);
    assert_eq!(robot.gravity_direction().as_slice(), [0.0, 0.0, -1.0]);
    assert_eq!(cell.characteristic_length, Some(0.5));
    let series = cell.setup.tool.series_compliance.as_ref().ok_or("no series")?;
    assert_eq!(series.origin.z, 0.06);
    assert_eq!(series.matrix.diagonal().as_slice()[..3], [1e-8, 1e-8, 5e-9]);
    assert_eq!(series.matrix[(5, 5)], 1.0 / 4e5);
    assert!(cell.setup.tool.has_sensor);
    assert_eq!(cell.limits.floor, Some(0.01));
    assert_eq!(cell.noise.readings_per_displacement, 2);
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
    assert_eq!(base_from_tracker.translation.vector.as_slice(), [3.5, -1.2, 0.9]);
    let accuracy = tracker.accuracy.ok_or("no accuracy")?;
    assert_eq!(accuracy.station.as_slice(), [0.0, 0.0, 0.05]);
    let sizes = cell.elastic.ok_or("no sizes")?;
    assert_eq!([sizes.shift, sizes.turn, sizes.coupling], [9e-8, 1.4e-7, 0.0]);
    let (stated, source) = cell.elastic_sizes()?;
    assert_eq!((stated, source), (sizes, ElasticSource::Declared));
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
    let (k, uncertainty) = (milling.coefficients, &cell.uncertainty);
    for (what, in_si, expected) in [
        ("variance of a reading", Some(cell.noise.reading_variance), 1e-10),
        ("common to a posture", Some(cell.noise.posture_common_std), 1e-5),
        ("turn of the tracker", Some(base_from_tracker.rotation.angle()), 150f64.to_radians()),
        ("range", Some(accuracy.range), 10e-6),
        ("range per metre", Some(accuracy.range_per_metre), 0.4e-6),
        ("angle", Some(accuracy.angle), 3e-6),
        ("force scale", uncertainty.force_scale, 0.005),
        ("anchor", uncertainty.anchor, 0.005),
        ("loading point", uncertainty.loading_point, 0.001),
        ("registration", uncertainty.registration, 0.2e-3),
        ("base tilt", uncertainty.base_tilt_compliance, 1e-8),
        ("sensor", uncertainty.sensor_compliance, 1.0 / 3.3e5),
        ("lost motion", uncertainty.lost_motion, (0.2f64 / 60.0).to_radians()),
        ("diameter", Some(milling.diameter), 0.016),
        ("axial depth", Some(milling.axial_depth), 0.003),
        ("radial depth", Some(milling.radial_depth), 0.004),
        ("feed per tooth", Some(milling.feed_per_tooth), 1e-4),
        ("k_tc", Some(k.k_tc), 8e8),
        ("k_rc", Some(k.k_rc), 2e8),
        ("k_ac", Some(k.k_ac), 1e8),
        ("k_te", Some(k.k_te), 2e4),
        ("k_re", Some(k.k_re), 2.5e4),
        ("k_ae", Some(k.k_ae), -1e3),
    ] {
        assert!(in_si.is_some_and(|in_si| close(in_si, expected)), "{what}: {in_si:?} is not {expected:e}");
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
    assert_eq!(cell.prior.as_deref(), Some(&TABLE_2[..]), "the catalogue's first set");
    assert_eq!(cell.characteristic_length, None);
    assert_eq!(cell.elastic, None);
    assert_eq!(cell.elastic_sizes()?.1, ElasticSource::Typical);
    assert_eq!(cell.sensor, None);
    assert_eq!(cell.tracker, Tracker::default());
    assert_eq!(cell.uncertainty, Uncertainty::default());
    assert_eq!(cell.columns, Columns::default());
    assert_eq!(cell.work, Work::default());
    assert_close(cell.noise.reading_variance, 9.23e-11);
    let Load::Weight { magnitude, direction } = cell.setup.load else {
        panic!("the load is a weight");
    };
    assert_eq!((magnitude, direction.z), (300.0, -1.0));
    Ok(())
}

#[test]
fn loads_and_bases() -> Check {
    let rope = "kind = \"rope\"\nmagnitude_n = 500\nanchor_mm = [1800, 0, 0]";
    let no_rope = FULL.replace("rope_length_mm = [800, 3400]\n", "").replace("anchor_mm = 5\n", "");
    let wrench = "kind = \"wrench\"\nforce_n = [1, 2, 3]\nmoment_nm = [4, 5, 6]\naxes = \"tool\"";
    let cell = parse_cell(&no_rope.replace(rope, wrench), "cell.toml")?;
    let Load::Constant { wrench, axes: Axes::Tool } = cell.setup.load else {
        panic!("the load is a wrench in tool axes");
    };
    assert_eq!(wrench.force.as_slice(), [1.0, 2.0, 3.0]);
    assert_eq!(wrench.moment.as_slice(), [4.0, 5.0, 6.0]);

    // Gravity of a wall-mounted robot.
    let weight =
        no_rope.replace(rope, "kind = \"weight\"\nmagnitude_n = 300").replace("down = [0, 0, -2]", "down = [3, 0, 0]");
    let Load::Weight { direction, .. } = parse_cell(&weight, "cell.toml")?.setup.load else {
        panic!("the load is a weight");
    };
    assert_eq!(direction.as_slice(), [1.0, 0.0, 0.0]);

    // A base frame turned by 90° about z and raised by 1 m.
    let based = FULL.replace("down = [0, 0, -2]", "base_xyz_mm = [100, 0, 1000]\nbase_rpy_deg = [0, 0, 90]");
    let straight = parse_cell(FULL, "cell.toml")?.setup;
    let turned = parse_cell(&based, "cell.toml")?.setup;
    let q = [0.3, -0.2];
    let p = PostureTerms::new(&straight, &q, None)?.loading_point().to_owned();
    let p_turned = PostureTerms::new(&turned, &q, None)?.loading_point().to_owned();
    let expected = [0.1 - p.y, p.x, 1.0 + p.z];
    for (coordinate, expected) in p_turned.iter().zip(expected) {
        assert!((coordinate - expected).abs() < 1e-14);
    }
    Ok(())
}
