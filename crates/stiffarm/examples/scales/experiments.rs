//! Experiments of robots of several classes, as engineers do them on arms as they
//! are delivered: a prior that is off joint by joint, joint offsets, a tool beside
//! its drawing, joints that tilt, lost motion, a base that gives way, a force that
//! is read a little wrong.

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use stiffarm::Cell;
use stiffarm::measure::experiment::{
    BaseCompliance, Experiment, ExperimentState, ForceRecord, ToolWeight, TrackerNoise, experiment,
};
use stiffarm::model::cell::Limits;
use stiffarm::model::instruments::{Mount, Sensor};
use stiffarm::model::load::{Load, LoadCase};
use stiffarm::model::measurement::{MeasuredPosture, ReadingTable};
use stiffarm::model::posture::{Posture, PostureGroup};
use stiffarm::model::robot::find_in_catalogue;
use stiffarm::plan::select::{StartKind, random_group};

/// The robots: keys of the catalogue, from 10 kg to 500 kg of payload.
pub const ROBOTS: [&str; 5] =
    ["comau-nj165-3.0", "kuka-kr240-2", "fanuc-r2000ic165f", "abb-irb4600-60-205", "kuka-kr10r1100sixx"];

/// Spread of the prior about the truth, joint by joint (standard deviation of the
/// logarithm), and its largest factor either way.
const PRIOR: (f64, f64) = (0.55, 3.0);
/// Relative error of the force (standard deviation).
const FORCE: f64 = 0.02;

/// How the load is made and recorded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A rope, its force in `load_n`.
    RopeLoads,
    /// A weight, its force in `load_n`.
    WeightLoads,
    /// A rope with the cell's force throughout.
    RopeAlone,
    /// A rope and a force sensor on the flange.
    Sensor,
    /// Two ropes as load cases, one to each side.
    Cases,
    /// A table of displacements with forces.
    Displacements,
}

/// All kinds.
pub const KINDS: [Kind; 6] =
    [Kind::RopeLoads, Kind::WeightLoads, Kind::RopeAlone, Kind::Sensor, Kind::Cases, Kind::Displacements];

/// One experiment.
#[derive(Debug, Clone)]
pub struct Sound {
    /// The cell as its user has it.
    pub cell: Cell,
    /// Raw readings, or
    pub table: ReadingTable,
    /// displacements, for [`Kind::Displacements`].
    pub displacements: Option<Vec<MeasuredPosture>>,
    /// Names of states hold the size of the load.
    pub is_named: bool,
}

/// Random choices of experiment `number` of a robot.
pub struct Dice(ChaCha8Rng);

impl Dice {
    /// A stream of its own for each robot and number.
    pub fn new(seed: u64, robot: usize, number: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(number * ROBOTS.len() as u64 + robot as u64);
        Dice(rng)
    }

    /// Between the two.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.random::<f64>()
    }

    /// From 0 to below `count`.
    pub fn below(&mut self, count: usize) -> usize {
        ((self.0.random::<f64>() * count as f64) as usize).min(count - 1)
    }

    /// Standard normal.
    pub fn normal(&mut self) -> f64 {
        self.0.sample(StandardNormal)
    }

    fn vector(&mut self, half: f64) -> Vector3<f64> {
        Vector3::from_fn(|_, _| self.between(-half, half))
    }
}

/// Joint stiffness that an arm of this payload and reach may have: published sets
/// of 165 kg and 240 kg, scaled by both and spread.
fn stiffness(key: &str, dice: &mut Dice) -> Vec<f64> {
    let entry = find_in_catalogue(key).expect("a robot of the catalogue");
    let first = find_in_catalogue(ROBOTS[0]).expect("the default robot");
    let published = entry.stiffness.first();
    let factor = match published {
        Some(_) => 1.0,
        None => entry.payload_kg().unwrap_or(165.0) / 165.0 * entry.reach_m().unwrap_or(3.0) / 3.0,
    };
    let values = published.unwrap_or(&first.stiffness[0]).values;
    let common = (0.2 * dice.normal()).exp();
    let spread = |k: &f64| k * factor * common * (0.15 * dice.normal()).exp();
    values.iter().map(spread).collect()
}

/// The cell of a robot: bounds around the middle of its range, a tool and a load
/// that suit its size.
fn cell_of(robot: usize, kind: Kind, dice: &mut Dice) -> Cell {
    let entry = find_in_catalogue(ROBOTS[robot]).expect("a robot of the catalogue");
    let mut cell = stiffarm_files::builtin::cell("comau").expect("the default cell");
    let reach = entry.reach_m().unwrap_or(2.7);
    let payload = entry.payload_kg().unwrap_or(165.0);
    if robot > 0 {
        cell.setup.robot = entry.robot().expect("the robot");
        cell.limits = Limits::default();
        let deg = |low: f64, high: f64| [low.to_radians(), high.to_radians()];
        let arm: [[f64; 2]; 2] = match ROBOTS[robot] {
            "kuka-kr240-2" | "kuka-kr10r1100sixx" => [deg(-100.0, -30.0), deg(20.0, 120.0)],
            _ => [deg(-30.0, 50.0), deg(-40.0, 40.0)],
        };
        cell.bounds =
            vec![deg(-70.0, 70.0), arm[0], arm[1], deg(-150.0, 150.0), deg(-100.0, 100.0), deg(-170.0, 170.0)];
    }
    let size = (reach / 3.0).clamp(0.4, 1.0);
    let tool = &mut cell.setup.tool;
    tool.loading_point *= size;
    for point in &mut tool.measuring_points {
        point.position *= size;
    }
    let force = (payload * 9.806_65 * dice.between(0.25, 0.8)).round();
    let anchor =
        Vector3::new(reach * dice.between(0.5, 0.9), reach * dice.between(-0.3, 0.3), -reach * dice.between(0.1, 0.3));
    let rope = |anchor: Vector3<f64>| Load::Rope { anchor, magnitude: force };
    let down = *cell.setup.robot.gravity_direction();
    cell.setup.load = match kind {
        Kind::WeightLoads => Load::Weight { magnitude: force, direction: down },
        Kind::Cases => Load::Cases(
            [("left", 1.0), ("right", -1.0)]
                .map(|(name, side)| LoadCase {
                    name: name.to_string(),
                    load: rope(anchor + Vector3::new(0.0, side * reach * 0.6, 0.0)),
                    loading_point: None,
                })
                .to_vec(),
        ),
        _ => rope(anchor),
    };
    cell.sensor = (kind == Kind::Sensor).then(|| Sensor {
        mount: Mount::Flange,
        pose: Isometry3::new(Vector3::new(0.0, 0.01, 0.06) * size, dice.vector(0.6)),
        reports_by_robot: false,
        mirrored: None,
    });
    cell
}

/// Experiment `number` of `robot`, without fault.
pub fn sound(robot: usize, number: u64, kind: Kind, seed: u64) -> Sound {
    let mut dice = Dice::new(seed, robot, number);
    let mut cell = cell_of(robot, kind, &mut dice);
    let truth = stiffness(ROBOTS[robot], &mut dice);
    let off = |dice: &mut Dice| {
        let log: f64 = PRIOR.0 * dice.normal();
        log.exp().clamp(1.0 / PRIOR.1, PRIOR.1)
    };
    let prior = truth.iter().map(|k| k * off(&mut dice)).collect();
    cell.prior = Some(prior);
    let count = 6 + dice.below(15);
    let postures = random_group(&cell, StartKind::Uniform, count, seed + number, robot as u64)
        .expect("postures within the limits");
    let postures = PostureGroup::from_angles("plan", postures).postures;
    // The arm as it is delivered.
    let offsets: Vec<f64> = truth.iter().map(|_| (0.05 * dice.normal()).to_radians()).collect();
    let driven: Vec<Posture> = postures
        .iter()
        .map(|p| Posture { name: p.name.clone(), q: p.q.iter().zip(&offsets).map(|(q, o)| q + o).collect() })
        .collect();
    let mut real = cell.clone();
    for point in &mut real.setup.tool.measuring_points {
        point.position += dice.vector(1e-4);
    }
    let pose =
        Isometry3::from_parts(Translation3::from(dice.vector(4.0)), UnitQuaternion::from_scaled_axis(dice.vector(2.0)));
    let is_named = dice.below(2) == 0;
    let nominal = cell.setup.load.size().unwrap_or(0.0);
    let repeats = 1 + dice.below(3);
    let state = |name: &str, factor: f64| ExperimentState { repeats, ..ExperimentState::new(name, factor) };
    let named = |prefix: &str, factor: f64, otherwise: &str| {
        let name = if is_named { format!("{prefix}-{:.0}", nominal * factor) } else { otherwise.to_string() };
        state(&name, factor)
    };
    let states = match (kind, dice.below(3)) {
        (Kind::Cases, _) => {
            vec![state("unloaded", 0.0), state("left", 1.0), state("unloaded-2", 0.0), state("right", 1.0)]
        }
        (Kind::RopeAlone | Kind::Displacements, _) => {
            vec![state("unloaded", 0.0), state("loaded", 1.0)]
        }
        (_, 0) => vec![state("unloaded", 0.0), named("load", 1.0, "loaded")],
        (Kind::Sensor, _) | (_, 1) => vec![
            state("unloaded", 0.0),
            named("up", 0.5, "up-half"),
            named("load", 1.0, "full"),
            named("down", 0.5, "down-half"),
            state("unloaded-2", 0.0),
        ],
        _ => vec![state("preload", 0.2), named("up", 0.6, "up-some"), named("load", 1.0, "full")],
    };
    let by_sensor = kind == Kind::Sensor;
    let small = cell.setup.robot.joint_count() as f64;
    let options = Experiment {
        base_from_tracker: pose,
        states,
        force: match kind {
            Kind::RopeLoads | Kind::WeightLoads => ForceRecord::Load,
            Kind::Sensor => ForceRecord::ForceAndMoment,
            Kind::Displacements => ForceRecord::Force,
            Kind::RopeAlone | Kind::Cases => ForceRecord::Nothing,
        },
        joint_tilt: Some(truth.iter().map(|k| 0.1 / k).collect()),
        lost_motion: Some(vec![1e-4 / small; truth.len()]),
        base_compliance: Some(BaseCompliance { tilt: 0.01 / truth[0], shift: 1e-9 }),
        tool_weight: by_sensor
            .then(|| ToolWeight { mass_kg: dice.between(3.0, 30.0), centre: Vector3::new(0.01, 0.0, 0.12) }),
        sensor_noise: [0.5, 0.1],
        tracker_noise: TrackerNoise::Isotropic,
        posture_common_std: 2e-5,
        ..Experiment::default()
    };
    let scale = 1.0 + FORCE * dice.normal();
    scale_loads(&mut real.setup.load, 1.0 / scale);
    let mut table = experiment(&real, &driven, &truth, &options, seed, number).expect("an experiment");
    for (measured, nominal) in table.postures.iter_mut().zip(&postures) {
        measured.posture.q.clone_from(&nominal.q);
        for state in &mut measured.states {
            state.load = state.load.map(|load| (load * scale).round());
            if let Some(wrench) = &mut state.wrench {
                wrench.force *= scale;
                wrench.moment *= scale;
            }
        }
    }
    let displacements = (kind == Kind::Displacements).then(|| {
        let reduced = stiffarm::prepare(&cell, table.clone(), &Default::default());
        reduced.expect("displacements").postures
    });
    Sound {
        cell,
        table,
        displacements,
        is_named: is_named && !matches!(kind, Kind::RopeAlone | Kind::Cases | Kind::Displacements),
    }
}

/// Multiplies the forces of a load.
pub fn scale_loads(load: &mut Load, factor: f64) {
    match load {
        Load::Rope { magnitude, .. } | Load::Weight { magnitude, .. } => *magnitude *= factor,
        Load::Cases(cases) => {
            for case in cases {
                scale_loads(&mut case.load, factor);
            }
        }
        _ => {}
    }
}
