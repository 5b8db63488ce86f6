//! Simulated experiments and what their reduction should give.

use super::set_ups::{changed, compliance_of, numbered, with};
use super::{group1, reference_cell};
use nalgebra::{DVector, Isometry3, Translation3, UnitQuaternion, Vector3};
use stiffarm::findings::Finding;
use stiffarm::measure::experiment::{
    BaseCompliance, Experiment, ExperimentState, ForceRecord, TrackerNoise, experiment,
};
use stiffarm::measure::reduction::{ReduceOptions, Reduction, reduce};
use stiffarm::measure::{Measured, prepare};
use stiffarm::model::cell::Cell;
use stiffarm::model::instruments::{Mount, Sensor};
use stiffarm::model::load::Wrench;
use stiffarm::model::measurement::{MeasuredPosture, Reading, ReadingTable, ReadingTarget, StateReadings};
use stiffarm::model::observation::PostureTerms;
use stiffarm::model::posture::Posture;
use stiffarm::model::tool::NamedPoint;
use stiffarm_files::builtin;

/// What the controllers give way per torque \[rad/(N·m)\].
pub const GIVE: [f64; 6] = [2e-8, 1e-8, 3e-8, 5e-8, 4e-8, 6e-8];

/// The cell of the measured FANUC R-2000iC and its 43 displacements.
pub fn measured_robot() -> (Cell, Measured) {
    let cell = builtin::cell("fanuc-r2000ic").unwrap();
    let readings = builtin::measurements("fanuc-r2000ic-readings", &cell).unwrap();
    let measured = prepare(&cell, readings, &Default::default()).unwrap();
    assert_eq!(measured.postures.len(), 43);
    (cell, measured)
}

pub fn postures() -> Vec<Posture> {
    numbered(group1())
}

pub fn pose(x: f64, y: f64, z: f64, turn: [f64; 3]) -> Isometry3<f64> {
    let turn = UnitQuaternion::from_scaled_axis(Vector3::from(turn));
    Isometry3::from_parts(Translation3::new(x, y, z), turn)
}

pub fn tracker_pose() -> Isometry3<f64> {
    pose(2.1, -3.4, 0.8, [0.4, -0.3, 2.2])
}

pub fn sensor() -> Sensor {
    Sensor {
        mount: Mount::Flange,
        pose: pose(0.02, -0.01, 0.06, [0.3, 0.7, -1.1]),
        reports_by_robot: true,
        mirrored: None,
    }
}

pub fn named(name: &str, position: [f64; 3]) -> NamedPoint {
    NamedPoint { name: name.to_string(), position: position.into() }
}

pub fn states(list: &[(&str, f64, usize)]) -> Vec<ExperimentState> {
    let state = |(name, load_factor, repeats): &(&str, f64, usize)| ExperimentState {
        name: name.to_string(),
        load_factor: *load_factor,
        repeats: *repeats,
    };
    list.iter().map(state).collect()
}

/// Unloaded, loaded, unloaded again.
pub fn there_and_back(repeats: usize) -> Vec<ExperimentState> {
    states(&[("unloaded", 0.0, repeats), ("loaded", 1.0, repeats), ("unloaded-2", 0.0, repeats)])
}

/// Three reflectors around the base.
pub fn base_reflectors() -> Vec<NamedPoint> {
    vec![named("base", [0.6, 0.1, 0.2]), named("base-2", [-0.4, 0.7, 0.15]), named("base-3", [-0.3, -0.6, 0.4])]
}

pub fn take(cell: &Cell, options: &Experiment, seed: u64) -> ReadingTable {
    let prior = cell.prior.clone().unwrap();
    experiment(cell, &postures(), &prior, options, seed, 0).unwrap()
}

pub fn reduced(cell: &Cell, table: &ReadingTable) -> Reduction {
    reduce(cell, table, &ReduceOptions::default()).unwrap()
}

/// Reduced with the tracker where it is said to stand.
pub fn reduced_by(cell: &Cell, table: &ReadingTable, transform: Isometry3<f64>) -> Reduction {
    reduce(cell, table, &given(transform)).unwrap()
}

pub fn given(transform: Isometry3<f64>) -> ReduceOptions {
    with(|o: &mut ReduceOptions| o.base_from_tracker = Some(transform))
}

/// Displacements of the measuring points and wrench under `factor` times the
/// cell's load by the linear model, with the servo's share where it gives way.
pub fn truth(cell: &Cell, q: &[f64], factor: f64, give: Option<[f64; 6]>) -> (Vec<Vector3<f64>>, Wrench) {
    let robot = &cell.setup.robot;
    let terms = PostureTerms::new(&cell.setup, q, None).unwrap();
    let mut moved = terms.block(robot) * compliance_of(cell.require_prior().unwrap()) * factor;
    if let Some(give) = give {
        let torque = robot.coupling().tr_mul(&DVector::from_column_slice(terms.torque()));
        let turn = DVector::from_fn(6, |j, _| factor * give[j] * torque[j]);
        moved += terms.spring_columns(robot) * robot.coupling() * turn;
    }
    let points = moved.as_slice().chunks(3).map(Vector3::from_column_slice);
    let wrench = Wrench { force: terms.wrench().force * factor, moment: terms.wrench().moment * factor };
    (points.collect(), wrench)
}

/// Planned angles of a measured posture.
pub fn planned(m: &MeasuredPosture) -> Vec<f64> {
    let mut list = postures().into_iter();
    list.find(|p| p.name == m.posture.name).unwrap().q
}

/// Largest error of the displacements of `measured` over the largest displacement.
pub fn displacement_error(
    cell: &Cell,
    measured: &[MeasuredPosture],
    factor: impl Fn(&str) -> f64,
    give: Option<[f64; 6]>,
) -> f64 {
    let (mut error, mut scale) = (0.0_f64, 0.0_f64);
    for m in measured {
        let q = &planned(m);
        let (points, _) = truth(cell, q, factor(&m.state), give);
        assert_eq!(m.displacements.len(), points.len());
        for d in &m.displacements {
            assert!(d.value.iter().all(|v| v.is_finite()));
            error = error.max((d.value - points[d.point]).amax());
            scale = scale.max(points[d.point].amax());
        }
    }
    error / scale
}

pub fn wrench_error(cell: &Cell, measured: &[MeasuredPosture], factor: impl Fn(&str) -> f64) -> f64 {
    let errors = measured.iter().map(|m| {
        let q = &planned(m);
        let (_, wrench) = truth(cell, q, factor(&m.state), None);
        let ours = m.wrench.unwrap();
        let scale = wrench.force.norm();
        let force = (ours.force - wrench.force).amax();
        force.max((ours.moment - wrench.moment).amax()) / scale
    });
    errors.fold(0.0, f64::max)
}

/// Asserts that the displacements are those of `factor` times the load, to rounding of coordinates.
#[track_caller]
pub fn assert_displaced(
    cell: &Cell,
    measured: &[MeasuredPosture],
    factor: impl Fn(&str) -> f64,
    give: Option<[f64; 6]>,
) {
    let error = displacement_error(cell, measured, factor, give);
    assert!(error < 1e-11, "{error:e}");
}

pub fn found<'a>(reduction: &'a Reduction, code: &str) -> Vec<&'a Finding> {
    let findings = reduction.findings.iter();
    findings.filter(|f| f.code == code).collect()
}

pub fn codes(reduction: &Reduction) -> Vec<&str> {
    reduction.findings.iter().map(|f| f.code.as_str()).collect()
}

pub fn readings(table: &mut ReadingTable) -> impl Iterator<Item = &mut Reading> {
    let states = table.postures.iter_mut().flat_map(|p| &mut p.states);
    states.flat_map(|s| &mut s.readings)
}

/// Keeps the readings of these targets in one state.
pub fn keep(state: &mut StateReadings, which: impl Fn(&ReadingTarget) -> bool) {
    state.readings.retain(|r| which(&r.target));
}

/// A measuring point, no reflector of the base.
pub fn is_point(target: &ReadingTarget) -> bool {
    matches!(target, ReadingTarget::Point(_))
}

/// An experiment with everything in it, as a table with noise.
pub fn full_table(cell: &Cell, seed: u64) -> ReadingTable {
    let options = Experiment {
        base_from_tracker: tracker_pose(),
        states: states(&[("unloaded", 0.0, 2), ("up", 0.5, 1), ("full", 1.0, 2), ("unloaded-2", 0.0, 1)]),
        force: ForceRecord::ForceAndMoment,
        base_reflectors: base_reflectors(),
        base_compliance: Some(BaseCompliance { tilt: 2e-8, shift: 3e-8 }),
        seconds_per_reading: 8.0,
        drift: Vector3::new(2e-8, -1e-8, 3e-8),
        servo_deflection: Some(GIVE.to_vec()),
        tracker_noise: TrackerNoise::Isotropic,
        sensor_noise: [0.5, 0.1],
        ..Experiment::default()
    };
    take(cell, &options, seed)
}

pub fn sensor_cell() -> Cell {
    changed(reference_cell(), |cell| {
        cell.sensor = Some(sensor());
        cell.noise.reading_variance = 1e-10;
    })
}
