//! What the tests share: reference numbers, the reference cell, random cells.

// `it` and `formulas` each use a part of this.
#![allow(dead_code, missing_docs)]

pub mod cases;
pub mod differences;
pub mod groups;
pub mod meshes;
pub mod model;
pub mod prelude;
pub mod random;
pub mod readings;
pub mod runs;
pub mod segments;
pub mod set_ups;
pub mod small;

use nalgebra::{DMatrix, Vector3};
use proptest::test_runner::{Config, RngSeed};
use serde_json::Value;
use std::f64::consts::PI;
use stiffarm::model::cell::{Cell, Limits, Noise, Task};
use stiffarm::model::load::{Axes, Load, Wrench};
use stiffarm::model::observation::Setup;
use stiffarm::model::robot::DhConvention;
use stiffarm::model::tool::{NamedPoint, Tool};

/// The reference cell with its answers.
pub fn reference() -> Value {
    serde_json::from_str(include_str!("../../golden/cell-comau.json")).unwrap()
}

/// The folder of the reference data, for tests that are ignored without it.
pub fn reference_folder() -> std::path::PathBuf {
    std::env::var_os("STIFFARM_REFERENCE_DATA").expect("names a folder").into()
}

pub fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is not a number"))
}

pub fn list(value: &Value) -> &Vec<Value> {
    value.as_array().unwrap_or_else(|| panic!("{value} is not a list"))
}

pub fn numbers(value: &Value) -> Vec<f64> {
    list(value).iter().map(number).collect()
}

pub fn matrix(value: &Value) -> DMatrix<f64> {
    let rows: Vec<Vec<f64>> = list(value).iter().map(numbers).collect();
    DMatrix::from_fn(rows.len(), rows[0].len(), |i, j| rows[i][j])
}

pub fn vector3(value: &Value) -> Vector3<f64> {
    Vector3::from_vec(numbers(value))
}

/// Angles in radians of a list of postures in degrees.
pub fn postures_from_deg(value: &Value) -> Vec<Vec<f64>> {
    list(value).iter().map(|q| numbers(q).iter().map(|a| a.to_radians()).collect()).collect()
}

/// Group 1 of the reference cell: hand-picked, small wrist angles \[rad\].
pub fn group1() -> Vec<Vec<f64>> {
    postures_from_deg(&reference()["group1"]["q_deg"])
}

/// The random group of the reference cell \[rad\].
pub fn random_group() -> Vec<Vec<f64>> {
    postures_from_deg(&reference()["random_group"]["q_deg"])
}

/// The reference cell: the paper's robot, load and noise, no limits beyond the bounds.
pub fn reference_cell() -> Cell {
    let data = reference();
    let rows = list(&data["robot"]["dh_rows_alpha_a_d_offset"]).iter();
    let rows: Vec<[f64; 4]> = rows.map(|row| numbers(row).try_into().unwrap()).collect();
    let robot = set_ups::chain("COMAU NJ 165-3.0", DhConvention::Modified, &rows)
        .with_coupling(matrix(&data["robot"]["theta_from_q"]))
        .unwrap();
    let points = list(&data["tool"]["measuring_points"]).iter().map(vector3);
    let tool = tool(vector3(&data["tool"]["loading_point"]), points);
    let load = Load::Rope { anchor: vector3(&data["load"]["anchor"]), magnitude: number(&data["load"]["magnitude_n"]) };
    let bounds = list(&data["robot"]["bounds_deg"]).iter();
    // Table 3: level 2 is 9.23e-5 mm² per axis, counted once.
    let noise = Noise { reading_variance: 9.23e-11, readings_per_displacement: 1, posture_common_std: 0.0 };
    Cell {
        name: "reference".to_string(),
        bounds: bounds.map(|b| [number(&b[0]).to_radians(), number(&b[1]).to_radians()]).collect(),
        prior: Some(numbers(&data["robot"]["k_theta"])),
        characteristic_length: Some(number(&data["characteristic_length_m"])),
        tasks: tasks(),
        ..plain_cell(Setup { robot, tool, load }, noise)
    }
}

/// A tool with these points, named 1, 2, 3, …
pub fn tool(loading_point: Vector3<f64>, points: impl Iterator<Item = Vector3<f64>>) -> Tool {
    let point = |(i, position): (usize, Vector3<f64>)| NamedPoint { name: (i + 1).to_string(), position };
    Tool {
        loading_point,
        measuring_points: points.enumerate().map(point).collect(),
        has_sensor: false,
        series_compliance: None,
    }
}

/// A cell of which nothing else is known, bounds ±π.
pub fn plain_cell(setup: Setup, noise: Noise) -> Cell {
    Cell {
        name: "plain".to_string(),
        bounds: vec![[-PI, PI]; setup.robot.joint_count()],
        setup,
        limits: Limits::default(),
        scene: Default::default(),
        noise,
        prior: None,
        elastic: None,
        known_elements: Vec::new(),
        characteristic_length: None,
        validation: Vec::new(),
        tasks: Vec::new(),
        sensor: None,
        tracker: Default::default(),
        uncertainty: Default::default(),
        route: Default::default(),
        time: Default::default(),
        columns: Default::default(),
        work: Default::default(),
    }
}

/// The tasks of the built-in default cell.
pub fn tasks() -> Vec<Task> {
    let task = |name: &str, q: [f64; 6], force: [f64; 3], axes| Task {
        name: name.to_string(),
        q: q.map(f64::to_radians).to_vec(),
        wrench: Wrench::force(Vector3::from(force)),
        axes,
        tip: Vector3::new(0.15, 0.0, 0.2),
    };
    vec![
        task("aluminium, left", [-30.0, 5.0, -115.0, 0.0, 60.0, 20.0], [-220.0, 140.0, 90.0], Axes::Base),
        task("titanium, front", [0.0, 20.0, -120.0, 0.0, 50.0, 0.0], [150.0, -320.0, 180.0], Axes::Base),
        task("aluminium, right", [35.0, -10.0, -125.0, 30.0, 60.0, -30.0], [-150.0, 80.0, -60.0], Axes::Tool),
    ]
}

/// The reference cell with limits on where the tool may be: the default cell.
pub fn default_cell() -> Cell {
    Cell {
        name: "default".to_string(),
        limits: Limits {
            tool_box: Some([Vector3::new(0.9, -1.9, 0.3), Vector3::new(3.0, 1.9, 3.0)]),
            floor: None,
            keep_out_radius: Some(0.9),
            wrist_height: Some(0.3),
            rope_length: Some([0.8, 3.4]),
        },
        ..reference_cell()
    }
}

/// Largest difference of two lists relative to the largest reference entry.
pub fn relative_error(ours: &[f64], reference: &[f64]) -> f64 {
    assert_eq!(ours.len(), reference.len(), "lengths differ");
    let scale = reference.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    let worst = ours.iter().zip(reference).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
    // NaN must not slip through max().
    assert!(ours.iter().all(|v| v.is_finite()), "an entry is not finite: {ours:?}");
    worst / scale
}

/// Largest relative difference, entry by entry.
pub fn entrywise_error(ours: &[f64], reference: &[f64]) -> f64 {
    assert_eq!(ours.len(), reference.len(), "lengths differ");
    ours.iter().zip(reference).fold(0.0_f64, |m, (a, b)| m.max(relative_error(&[*a], &[*b])))
}

/// Property tests draw the same cases each time, unless `PROPTEST_RNG_SEED`
/// or `PROPTEST_CASES` ask for others; `STIFFARM_TEST_RUNS` multiplies them.
pub fn cases(count: u32) -> Config {
    let default = Config::default();
    Config {
        cases: if std::env::var_os("PROPTEST_CASES").is_some() {
            default.cases
        } else {
            runs::runs(count.into()) as u32
        },
        rng_seed: match default.rng_seed {
            RngSeed::Random => RngSeed::Fixed(2021),
            seed @ RngSeed::Fixed(_) => seed,
        },
        failure_persistence: None,
        ..default
    }
}
