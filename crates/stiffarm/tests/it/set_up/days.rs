//! Days with robot and tracker that the tests of the set-up share: what is true, and what was read.

use crate::common::prelude::*;
use nalgebra::Matrix6;
use serde_json::Value;
use stiffarm::model::measurement::Role;

/// How the arm gives way beyond its joint axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Beyond {
    Nothing,
    /// Tilts of the joints, and of the base [rad/(N·m)].
    Tilts(f64, f64),
    /// One of the arms of a structural code.
    Structure(&'static str),
    /// Half a gap of every joint [arc minutes].
    LostMotion(f64),
    /// The tracker drifts through the day [m/s].
    Drift(f64),
    /// A shift that the points of a loaded state share, new in each [m].
    Common(f64),
}

/// What is loaded, and how.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kind {
    /// The default cell: a rope, its force written down.
    Rope,
    /// A KUKA with a long lever and a rope.
    Lever,
    /// A weight at the default cell's tool.
    Weight,
    /// The default cell's rope, and a sensor on the flange.
    Sensor,
    /// The same with forces alone.
    Forces,
}

pub struct Day {
    pub cell: Cell,
    pub table: ReadingTable,
}

pub const TRACKER: [f64; 6] = [4.2, -1.8, 0.9, 0.02, -0.03, 2.4];

fn tracker() -> Isometry3<f64> {
    let [x, y, z, a, b, c] = TRACKER;
    Isometry3::from_parts(Translation3::new(x, y, z), UnitQuaternion::from_euler_angles(a, b, c))
}

pub fn cell(kind: Kind) -> Cell {
    let mut cell = default_cell();
    cell.noise.readings_per_displacement = 2;
    match kind {
        Kind::Rope => {}
        Kind::Lever => {
            let entry = find_in_catalogue("kuka-kr240-2").unwrap();
            cell.setup.robot = entry.robot().unwrap();
            let bounds =
                [[-90.0, 90.0], [-120.0, -40.0], [40.0, 130.0], [-170.0, 170.0], [-100.0, 100.0], [-170.0, 170.0]];
            cell.bounds = bounds.map(|b: [f64; 2]| b.map(f64::to_radians)).to_vec();
            cell.setup.tool.loading_point = Vector3::new(0.35, 0.1, 0.3);
            cell.limits.rope_length = Some([0.8, 4.0]);
            *rope_force(&mut cell) = 981.0;
            cell.prior = Some(vec![2.2e6, 3.1e6, 1.9e6, 5.4e5, 5e5, 3.1e5]);
        }
        Kind::Weight => cell.setup.load = hanging(981.0),
        Kind::Sensor | Kind::Forces => {
            cell.sensor = Some(Sensor {
                mount: Mount::Flange,
                pose: Isometry3::new(Vector3::new(0.0, 0.01, 0.08), Vector3::new(0.0, 0.0, 0.7)),
                reports_by_robot: true,
                mirrored: None,
            });
        }
    }
    cell
}

/// Twists of the seven frames of an arm, base first.
pub fn structure(name: &str) -> Vec<Matrix6<f64>> {
    let data: Value = serde_json::from_str(include_str!("../../golden/structural-springs.json")).unwrap();
    let triangle = |rows: &Value| {
        let all = common::numbers(rows);
        Matrix6::from_fn(|i, j| {
            let (i, j) = (i.max(j), i.min(j));
            all[i * (i + 1) / 2 + j]
        })
    };
    common::list(&data["arms"][name]).iter().map(triangle).collect()
}

/// Offsets d along z of the default arm's modified-DH rows: their frames lie there [m].
const OFFSETS: [f64; 6] = [0.83, 0.0, 0.0, 1.444, 0.0, 0.23];

/// What seven springs beyond the axes add to the points' displacement, base axes.
pub fn structural(cell: &Cell, arm: &[Matrix6<f64>], q: &[f64], factor: f64) -> Vec<Vector3<f64>> {
    let terms = PostureTerms::new(&cell.setup, q, None).unwrap();
    structural_at(&terms, arm, factor)
}

/// The same at a posture under a load.
pub fn structural_at(terms: &PostureTerms, arm: &[Matrix6<f64>], factor: f64) -> Vec<Vector3<f64>> {
    let mut frames = vec![Isometry3::identity()];
    let rows = terms.frames().links().iter().zip(OFFSETS);
    frames.extend(rows.map(|(link, d)| link * Translation3::new(0.0, 0.0, d)));
    let mut out = vec![Vector3::zeros(); terms.measuring_points().len()];
    for (frame, compliance) in frames.iter().zip(arm) {
        let origin = frame.translation.vector;
        let wrench = terms.wrench().moved(terms.loading_point(), &origin);
        let (f, m) = (
            frame.rotation.inverse_transform_vector(&wrench.force),
            frame.rotation.inverse_transform_vector(&wrench.moment),
        );
        let twist = compliance * Vector6::new(f.x, f.y, f.z, m.x, m.y, m.z) * factor;
        let shift = frame.rotation * Vector3::new(twist[0], twist[1], twist[2]);
        let turn = frame.rotation * Vector3::new(twist[3], twist[4], twist[5]);
        for (moved, at) in out.iter_mut().zip(terms.measuring_points()) {
            *moved += shift + turn.cross(&(at - origin));
        }
    }
    out
}

/// States of a day: two, three without another unloaded reading, or as an engineer does it.
pub fn load_states(count: usize) -> Vec<ExperimentState> {
    let all = [("unloaded", 0.0), ("half", 0.5), ("full", 1.0), ("unloaded-2", 0.0)];
    let chosen: &[usize] = match count {
        2 => &[0, 2],
        3 => &[0, 1, 2],
        _ => &[0, 1, 2, 3],
    };
    chosen.iter().map(|i| ExperimentState::new(all[*i].0, all[*i].1)).collect()
}

pub fn day(kind: Kind, beyond: Beyond, postures: usize, states: usize, seed: u64) -> Day {
    let cell = cell(kind);
    let group = random_group(&cell, StartKind::Uniform, postures, seed, 0).unwrap();
    let postures = numbered(group);
    let mut options = Experiment {
        base_from_tracker: tracker(),
        states: load_states(states),
        model: DisplacementModel::Equilibrium,
        force: match kind {
            Kind::Sensor => ForceRecord::ForceAndMoment,
            Kind::Forces => ForceRecord::Force,
            _ => ForceRecord::Load,
        },
        tracker_noise: TrackerNoise::Isotropic,
        sensor_noise: [0.3, 0.05],
        seconds_per_reading: 10.0,
        ..Experiment::default()
    };
    match beyond {
        Beyond::Tilts(joints, base) => {
            options.joint_tilt = Some(vec![joints; 6]);
            options.base_compliance = Some(BaseCompliance { tilt: base, shift: 0.0 });
        }
        Beyond::LostMotion(minutes) => {
            options.lost_motion = Some(vec![(minutes / 60.0).to_radians(); 6]);
        }
        Beyond::Drift(speed) => options.drift = Vector3::new(speed, -speed, 0.5 * speed),
        Beyond::Common(std) => options.posture_common_std = std,
        Beyond::Nothing | Beyond::Structure(_) => {}
    }
    let stiffness = cell.require_prior().unwrap().to_vec();
    let mut table = experiment(&cell, &postures, &stiffness, &options, seed, 0).unwrap();
    if let Beyond::Structure(name) = beyond {
        let arm = structure(name);
        move_states(&mut table, Role::Loaded, |q, state| {
            let factor = options.states.iter().find(|s| s.name == state).unwrap();
            structural(&cell, &arm, q, factor.load_factor)
        });
    }
    Day { cell, table }
}

/// Moves the points of all states of a role by what `moved` gives for angles and state, base axes.
pub fn move_states(table: &mut ReadingTable, role: Role, moved: impl Fn(&[f64], &str) -> Vec<Vector3<f64>>) {
    let turn = tracker().rotation.inverse();
    for posture in &mut table.postures {
        for state in posture.states.iter_mut().filter(|s| Role::of(&s.state) == role) {
            let moved = moved(&posture.posture.q, &state.state);
            for reading in &mut state.readings {
                if let ReadingTarget::Point(a) = reading.target {
                    reading.position += turn * moved[a];
                }
            }
        }
    }
}

/// Adds what the wrench that `wrench` makes of the cell's own moves the points by.
pub fn add_displacement(cell: &Cell, table: &mut ReadingTable, role: Role, wrench: impl Fn(&Wrench) -> Option<Wrench>) {
    let compliance = compliance_of(cell.require_prior().unwrap());
    move_states(table, role, |q, _| {
        let unloaded = PostureTerms::new(&cell.setup, q, None).unwrap();
        let terms = PostureTerms::new(&cell.setup, q, wrench(unloaded.wrench()).as_ref()).unwrap();
        let moved = terms.block(&cell.setup.robot) * &compliance;
        let points = 0..terms.measuring_points().len();
        points.map(|a| moved.fixed_rows::<3>(3 * a).into_owned()).collect()
    });
}

/// Moves every loaded reading, tracker axes.
pub fn each_loaded(table: &mut ReadingTable, change: impl Fn(&mut Vector3<f64>)) {
    let states = table.postures.iter_mut().flat_map(|p| &mut p.states);
    let loaded = states.filter(|s| Role::of(&s.state) == Role::Loaded);
    let readings = loaded.flat_map(|s| &mut s.readings);
    readings.for_each(|reading| change(&mut reading.position));
}

/// The readings of a day under one load as displacements in base axes; the load is the cell's.
pub fn displacements(cell: &Cell, table: &ReadingTable) -> Vec<MeasuredPosture> {
    let reduced = reduce(cell, table, &ReduceOptions::default()).unwrap();
    let mut measured = reduced.measured;
    measured.iter_mut().for_each(|m| m.wrench = None);
    measured
}
