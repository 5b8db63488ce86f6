//! Planted faults are found and named; experiments without fault raise no alarm.

mod alarms;
mod gross_errors;
mod moved;
mod poor_tables;
mod robots;
pub(crate) mod single_faults;

use crate::common::prelude::*;
use rayon::prelude::*;
use stiffarm::measure::screening::{Cause, Screening, Suspicion};
use stiffarm::model::measurement::WrenchColumns;
use stiffarm::units::{mm_to_m, rad_to_deg};

/// The default cell with a turned flange sensor.
fn cell() -> Cell {
    let mut cell = builtin::cell("comau").unwrap();
    cell.sensor = Some(Sensor {
        mount: Mount::Flange,
        pose: Isometry3::new(Vector3::new(0.0, 0.01, 0.08), Vector3::new(0.1, -0.2, 0.7)),
        reports_by_robot: true,
        mirrored: None,
    });
    cell
}

/// Other robots: bounds that suit them, those of joints 2 and 3 given; the default tool and rope.
fn cell_of(robot: &str, q2_deg: [f64; 2], q3_deg: [f64; 2]) -> Cell {
    let mut cell = cell();
    let entry = find_in_catalogue(robot).unwrap();
    cell.setup.robot = entry.robot().unwrap();
    let (first, wrist) = ([-90.0, 90.0], [-170.0, 170.0]);
    let bounds = [first, q2_deg, q3_deg, wrist, [-100.0, 100.0], wrist];
    cell.bounds = bounds.map(|b| b.map(f64::to_radians)).to_vec();
    cell.limits = Limits::default();
    cell.prior = entry.stiffness.first().map(|s| s.values.to_vec());
    cell
}

fn tracker_pose(seed: u64) -> Isometry3<f64> {
    let mut dice = Dice::new(seed);
    let turn = UnitQuaternion::from_scaled_axis(dice.direction() * dice.between(0.0, 3.0));
    Isometry3::from_parts(Translation3::from(dice.vector(4.0)), turn)
}

fn options(seed: u64) -> Experiment {
    Experiment {
        base_from_tracker: tracker_pose(seed),
        force: ForceRecord::ForceAndMoment,
        tool_weight: Some(ToolWeight { mass_kg: 30.0, centre: Vector3::new(0.01, 0.0, 0.15) }),
        sensor_noise: [1.0, 0.2],
        tracker_noise: TrackerNoise::Isotropic,
        ..Experiment::default()
    }
}

fn truth(cell: &Cell) -> Vec<f64> {
    let usual = [1.2e6, 2.6e6, 1.1e6, 2e5, 1.7e5, 1.1e5];
    cell.prior.clone().unwrap_or_else(|| usual.to_vec())
}

fn simulated(cell: &Cell, postures: &[Posture], seed: u64) -> ReadingTable {
    experiment(cell, postures, &truth(cell), &options(seed), seed, 0).unwrap()
}

fn group1_table(seed: u64) -> ReadingTable {
    simulated(&cell(), &numbered(group1()), seed)
}

/// Sentences, with a code before each.
fn sentences(screening: &Screening) -> String {
    let all = screening.findings.iter();
    let all = all.map(|f| format!("[{}] {:?}, {}: {}", f.code, f.severity, f.subject, f.sentence));
    all.collect::<Vec<_>>().join("\n")
}

/// The one suspicion there is.
fn only(screening: &Screening) -> &Suspicion {
    assert_eq!(screening.suspicions.len(), 1, "{}", sentences(screening));
    assert_eq!(screening.findings.len(), 1);
    &screening.suspicions[0]
}

/// What screening says of a table with one fault, and that fault.
fn alone(cell: &Cell, table: &ReadingTable) -> (Screening, Suspicion) {
    let screening = screen(cell, table, None).unwrap();
    let suspicion = only(&screening).clone();
    (screening, suspicion)
}

fn relabel(table: &mut ReadingTable, at: Option<(usize, usize)>, a: usize, b: usize) {
    for (p, posture) in table.postures.iter_mut().enumerate() {
        for (s, state) in posture.states.iter_mut().enumerate() {
            if at.is_some_and(|at| at != (p, s)) {
                continue;
            }
            for reading in &mut state.readings {
                reading.target = match &reading.target {
                    ReadingTarget::Point(i) if *i == a => ReadingTarget::Point(b),
                    ReadingTarget::Point(i) if *i == b => ReadingTarget::Point(a),
                    other => other.clone(),
                };
            }
        }
    }
}

pub(crate) fn each_position(table: &mut ReadingTable, change: impl Fn(&mut Vector3<f64>)) {
    let states = table.postures.iter_mut().flat_map(|p| &mut p.states);
    for reading in states.flat_map(|s| &mut s.readings) {
        change(&mut reading.position);
    }
}

fn names(list: &[&str]) -> Vec<String> {
    list.iter().map(|s| s.to_string()).collect()
}

/// The default cell with the errors of a robot that nobody calibrated: joint
/// offsets, a tool that differs from its drawing.
fn uncalibrated(cell: &Cell, postures: &[Posture], seed: u64) -> (Cell, Vec<Posture>) {
    let mut dice = Dice::new(seed + 1000);
    let mut real = cell.clone();
    let offset: Vec<f64> = (0..6).map(|_| dice.signed(0.0, 0.06).to_radians()).collect();
    for point in &mut real.setup.tool.measuring_points {
        point.position += dice.vector(1e-4);
    }
    let driven = postures
        .iter()
        .map(|p| Posture { name: p.name.clone(), q: p.q.iter().zip(&offset).map(|(q, o)| q + o).collect() })
        .collect();
    (real, driven)
}

/// What the simulated arm has that the cell does not know.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Arm {
    /// Nothing.
    Exact,
    /// Joint offsets and an inexact tool.
    Uncalibrated,
    /// These, and joints that tilt, lost motion, a base that gives way and a
    /// shift common to the points of a posture, three times the noise.
    Rough,
}

/// A random group of postures as the cell has them, measured on that arm.
fn random_table(cell: &Cell, arm: Arm, count: usize, seed: u64) -> ReadingTable {
    let postures = numbered(random_group(cell, StartKind::Uniform, count, seed, 0).unwrap());
    let (real, driven) = match arm {
        Arm::Exact => (cell.clone(), postures.clone()),
        Arm::Uncalibrated | Arm::Rough => uncalibrated(cell, &postures, seed),
    };
    let mut options = options(seed);
    let stiffness = truth(cell);
    if arm == Arm::Rough {
        options.joint_tilt = Some(stiffness.iter().map(|k| 0.2 / k).collect());
        options.lost_motion = Some(vec![2e-5; 6]);
        options.base_compliance = Some(BaseCompliance { tilt: 1e-8, shift: 1e-9 });
        options.posture_common_std = 3e-5;
    }
    let mut table = experiment(&real, &driven, &stiffness, &options, seed, 0).unwrap();
    for (measured, nominal) in table.postures.iter_mut().zip(&postures) {
        measured.posture.q.clone_from(&nominal.q);
    }
    table
}

fn kuka() -> Cell {
    cell_of("kuka-kr240-2", [-60.0, 10.0], [20.0, 120.0])
}

fn big_kuka() -> Cell {
    cell_of("kuka-kr500-r2800-2", [-100.0, -30.0], [20.0, 120.0])
}

fn fanuc() -> Cell {
    cell_of("fanuc-r2000ic165f", [-50.0, 50.0], [-40.0, 40.0])
}

/// UR10 (maker's DH table: a in mm −612, −572.3; d 127.3, 163.941, 115.7, 92.2).
/// A small arm without a spherical wrist and without the usual offset at joint 1.
fn ur10() -> Cell {
    let mut cell = kuka();
    cell.setup.robot = common::set_ups::ur10(0.0);
    cell.bounds = [[-90.0, 90.0], [-120.0, -30.0], [20.0, 120.0], [-160.0, 20.0], [-120.0, 120.0], [-170.0, 170.0]]
        .map(|b: [f64; 2]| b.map(f64::to_radians))
        .to_vec();
    // Orders of magnitude of a small arm, under a small load.
    cell.prior = Some(vec![4e4, 4e4, 3e4, 1e4, 1e4, 1e4]);
    *rope_force(&mut cell) = 80.0;
    cell
}
