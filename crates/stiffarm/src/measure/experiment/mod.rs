//! A whole experiment as tracker and sensor would have seen it: raw readings of
//! a simulated arm whose joint stiffness is known.

mod arm;
mod tracker;

use crate::error::{Code, Error, Result};
use crate::model::cell::Cell;
use crate::model::load::Wrench;
use crate::model::measurement::{PostureReadings, ReadingTable, ReadingTarget, Role, StateReadings, WrenchColumns};
use crate::model::observation::{PostureTerms, Setup};
use crate::model::posture::{Posture, PostureGroup};
use crate::model::stiffness::joint_compliance;
use crate::model::tool::NamedPoint;
use crate::numerics::streams::experiment_rng;
use arm::Arm;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use std::borrow::Cow;
use tracker::{SimulatedTracker, normal3};

/// One load state of a simulated experiment.
#[derive(Debug, Clone, PartialEq)]
pub struct ExperimentState {
    /// Name of the state; it says its [`Role`].
    pub name: String,
    /// Factor on the cell's load: 0 unloaded, 1 fully loaded.
    pub load_factor: f64,
    /// Rounds of readings: every round reads each reflector once.
    pub repeats: usize,
}

impl ExperimentState {
    /// A state with one round of readings.
    pub fn new(name: impl Into<String>, load_factor: f64) -> Self {
        ExperimentState { name: name.into(), load_factor, repeats: 1 }
    }
}

/// How the base gives way under the load's wrench about the base frame's origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BaseCompliance {
    /// Turn about each of the base's x and y axes \[rad/(N·m)\].
    pub tilt: f64,
    /// Shift along the force \[m/N\].
    pub shift: f64,
}

/// What hangs on a flange sensor besides the load.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ToolWeight {
    /// Mass \[kg\].
    pub mass_kg: f64,
    /// Its centre, flange axes \[m\].
    pub centre: Vector3<f64>,
}

/// Noise of the tracker's readings.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TrackerNoise {
    /// None.
    None,
    /// The cell's variance on each axis of each reading.
    Isotropic,
    /// The range and angle model of the cell's tracker.
    RangeAndAngle,
}

/// What the table says of the force.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ForceRecord {
    /// Nothing.
    Nothing,
    /// Size of the force of the rope, cylinder or weight in each state.
    Load,
    /// Forces: as the cell's sensor reports them, or without a sensor the force
    /// on the robot in base axes.
    Force,
    /// Forces and moments, likewise; without a sensor about the loading point.
    ForceAndMoment,
}

/// How the load displaces the points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DisplacementModel {
    /// Linear, Δ = ΨH with everything at the unloaded posture, Eq. (7).
    Linear,
    /// The exact equilibrium ([`equilibrium`](crate::model::stiffness::equilibrium)); joint tilt, lost motion and
    /// series compliance are added to it as in the linear model.
    Equilibrium,
}

/// How an experiment is done and what disturbs it. The default has one unloaded
/// and one loaded state, tracker axes equal to base axes, and no disturbance.
#[derive(Debug, Clone, PartialEq)]
pub struct Experiment {
    /// Base frame from tracker frame \[m\].
    pub base_from_tracker: Isometry3<f64>,
    /// The tracker's stations by name, each with its frame in the base frame; the one that the cell sees a posture
    /// from counts, [`base_from_tracker`](Self::base_from_tracker) where it is none of these.
    pub stations: Vec<(String, Isometry3<f64>)>,
    /// Load states of each posture, in the order taken.
    pub states: Vec<ExperimentState>,
    /// How the points move under the load.
    pub model: DisplacementModel,
    /// What is written of the force.
    pub force: ForceRecord,
    /// Reflectors on the base, base frame \[m\].
    pub base_reflectors: Vec<NamedPoint>,
    /// How the base gives way; it carries tool and base reflectors along.
    pub base_compliance: Option<BaseCompliance>,
    /// Time from one reading to the next \[s\]; times are written where it is above zero.
    pub seconds_per_reading: f64,
    /// Drift of the tracker, tracker axes \[m/s\].
    pub drift: Vector3<f64>,
    /// Controller angle that the servo gives way per torque about its joint
    /// \[rad/(N·m)\]; the angles of each state are written where it is given.
    pub servo_deflection: Option<Vec<f64>>,
    /// Compliance of each joint about the two axes across its own \[rad/(N·m)\].
    pub joint_tilt: Option<Vec<f64>>,
    /// Lost motion of each joint: half the gap, taken up in the direction of the
    /// torque \[rad\].
    pub lost_motion: Option<Vec<f64>>,
    /// Weight that a flange sensor carries.
    pub tool_weight: Option<ToolWeight>,
    /// Constant error of the sensor, its axes.
    pub sensor_offset: Wrench,
    /// Noise of the sensor in each state, standard deviation of force \[N\] and
    /// moment \[N·m\] along each axis.
    pub sensor_noise: [f64; 2],
    /// Noise of the tracker.
    pub tracker_noise: TrackerNoise,
    /// Standard deviation τ of a shift common to the measuring points of one
    /// loaded state \[m\].
    pub posture_common_std: f64,
}

impl Default for Experiment {
    fn default() -> Self {
        Experiment {
            base_from_tracker: Isometry3::identity(),
            stations: Vec::new(),
            states: vec![ExperimentState::new("unloaded", 0.0), ExperimentState::new("loaded", 1.0)],
            model: DisplacementModel::Linear,
            force: ForceRecord::Nothing,
            base_reflectors: Vec::new(),
            base_compliance: None,
            seconds_per_reading: 0.0,
            drift: Vector3::zeros(),
            servo_deflection: None,
            joint_tilt: None,
            lost_motion: None,
            tool_weight: None,
            sensor_offset: Wrench::force(Vector3::zeros()),
            sensor_noise: [0.0; 2],
            tracker_noise: TrackerNoise::None,
            posture_common_std: 0.0,
        }
    }
}

impl Experiment {
    /// An experiment as an engineer does it: a tracker where the cell has it, else four metres away
    /// in axes of its own, drifting; unloaded, half the load, all of it, half again,
    /// unloaded, or where there are load cases each of them between unloaded states; each
    /// reflector read twice, one of them on the base; what the
    /// force sensor reads where the cell has one, with 12 kg of tool on it, else
    /// the force of the rope, cylinder or weight; the noise of the cell, which plans and forecasts
    /// count with, whatever `tracker.accuracy` says.
    pub fn as_measured(cell: &Cell) -> Self {
        let named = |prefix: &str, factor: f64, otherwise: &str| match cell.setup.load.size() {
            Some(size) => format!("{prefix}-{}", (size * factor).round()),
            None => otherwise.to_string(),
        };
        let state =
            |name: String, load_factor: f64| ExperimentState { repeats: 2, ..ExperimentState::new(name, load_factor) };
        let by_sensor = cell.sensor.is_some();
        Experiment {
            base_from_tracker: cell.tracker.base_from_tracker.unwrap_or_else(|| {
                Isometry3::from_parts(
                    Translation3::new(4.2, -1.8, 0.9),
                    UnitQuaternion::from_euler_angles(0.02, -0.03, 2.4),
                )
            }),
            stations: tracker::set_up(cell),
            states: match cell.setup.load.cases() {
                [] => vec![
                    state("unloaded".to_string(), 0.0),
                    state(named("up", 0.5, "up-half"), 0.5),
                    state(named("up", 1.0, "full"), 1.0),
                    state(named("down", 0.5, "down-half"), 0.5),
                    state("unloaded-2".to_string(), 0.0),
                ],
                // Unloaded before, between and after the loads.
                cases => {
                    let mut states = vec![state("unloaded".to_string(), 0.0)];
                    for (case, number) in cases.iter().zip(2..) {
                        states.push(state(case.name.clone(), 1.0));
                        states.push(state(format!("unloaded-{number}"), 0.0));
                    }
                    states
                }
            },
            model: DisplacementModel::Equilibrium,
            force: match (by_sensor, cell.setup.load.size()) {
                (true, _) => ForceRecord::ForceAndMoment,
                (false, Some(_)) => ForceRecord::Load,
                // Each of several loads is as the cell says.
                (false, None) if cell.setup.load.has_cases() => ForceRecord::Nothing,
                (false, None) if cell.setup.load.has_moment() => ForceRecord::ForceAndMoment,
                (false, None) => ForceRecord::Force,
            },
            base_reflectors: vec![NamedPoint { name: "base".to_string(), position: Vector3::new(0.4, 0.3, 0.1) }],
            seconds_per_reading: 10.0,
            drift: Vector3::new(4e-9, -3e-9, 2e-9),
            tool_weight: by_sensor.then_some(ToolWeight { mass_kg: 12.0, centre: Vector3::new(0.02, -0.01, 0.12) }),
            sensor_noise: [0.3, 0.05],
            tracker_noise: TrackerNoise::Isotropic,
            posture_common_std: cell.noise.posture_common_std,
            ..Experiment::default()
        }
    }
}

impl Experiment {
    /// The station, and its frame, from which a posture is read.
    fn station_at(
        &self,
        cell: &Cell,
        unloaded: &Setup,
        posture: &Posture,
    ) -> Result<Option<&(String, Isometry3<f64>)>> {
        if self.stations.is_empty() {
            return Ok(None);
        }
        let terms = PostureTerms::new(unloaded, &posture.q, None)?;
        let station = cell.scene.station_at(&terms);
        let mut stations = self.stations.iter();
        Ok(station.and_then(|station| stations.find(|(name, _)| *name == station.name)))
    }
}

/// Raw readings of a simulated experiment at `postures` (controller angles, rad),
/// named `1`, `2`, …, as [`Experiment::as_measured`], of an arm with the cell's
/// prior joint stiffness.
///
/// # Errors
/// A cell without prior, or as [`experiment`].
pub fn simulated_readings<Q: AsRef<[f64]>>(cell: &Cell, postures: &[Q], seed: u64) -> Result<ReadingTable> {
    let angles = postures.iter().map(|q| q.as_ref().to_vec());
    let postures = PostureGroup::from_angles("simulated", angles).postures;
    let done = Experiment::as_measured(cell);
    experiment(cell, &postures, cell.require_prior()?, &done, seed, 0)
}

/// Simulates the raw readings of `postures` on an arm with the joint `stiffness`
/// \[N·m/rad\] and the cell's tool, load and sensor. Experiment `stream` of
/// `seed` is always the same.
///
/// # Errors
/// A wrong number of stiffness, servo, tilt or lost-motion values, no states or
/// no repeats, a number that is not finite, noise by range and angle without
/// the cell's `tracker.accuracy`, a measured load (nobody measures here), or a
/// load that buckles the arm.
pub fn experiment(
    cell: &Cell,
    postures: &[Posture],
    stiffness: &[f64],
    options: &Experiment,
    seed: u64,
    stream: u64,
) -> Result<ReadingTable> {
    check(cell, options)?;
    let accuracy = match options.tracker_noise {
        TrackerNoise::RangeAndAngle => Some(cell.tracker.accuracy.as_ref().ok_or_else(|| {
            Error::new(Code::MissingKey, "The cell does not say how exactly the tracker reads.").key("tracker")
        })?),
        TrackerNoise::None | TrackerNoise::Isotropic => None,
    };
    let mut tracker = SimulatedTracker {
        options,
        tracker_from_base: options.base_from_tracker.inverse(),
        noise: match options.tracker_noise {
            TrackerNoise::Isotropic => cell.noise.reading_variance.sqrt(),
            TrackerNoise::None | TrackerNoise::RangeAndAngle => 0.0,
        },
        accuracy,
        time: 0.0,
    };
    let compliance = joint_compliance(&cell.setup.robot, stiffness)?;
    let unloaded = cell.setup.cases().swap_remove(0);
    let mut rng = experiment_rng(seed, stream);
    let mut out = Vec::with_capacity(postures.len());
    for posture in postures {
        let station = options.station_at(cell, &unloaded, posture)?;
        let frame = station.map_or(&options.base_from_tracker, |(_, frame)| frame);
        tracker.tracker_from_base = frame.inverse();
        let mut states = Vec::with_capacity(options.states.len());
        for state in &options.states {
            let factor = state.load_factor;
            // Without load it does not matter which of several it is.
            let setup = match factor {
                0.0 => Cow::Borrowed(&unloaded),
                _ => cell.setup.of_state(&state.name)?,
            };
            let arm = Arm::new(&setup, posture, stiffness, &compliance, options, factor)?;
            let common = match Role::of(&state.name) {
                Role::Loaded => normal3(&mut rng) * options.posture_common_std,
                Role::Unloaded | Role::Preload => Vector3::zeros(),
            };
            let mut readings = Vec::new();
            for _ in 0..state.repeats {
                for (a, point) in arm.points.iter().enumerate() {
                    let at = arm.base_motion * nalgebra::Point3::from(point + common);
                    readings.push(tracker.read(ReadingTarget::Point(a), &at.coords, &mut rng)?);
                }
                for point in &options.base_reflectors {
                    let at = arm.base_motion * nalgebra::Point3::from(point.position);
                    let target = ReadingTarget::Base(point.name.clone());
                    readings.push(tracker.read(target, &at.coords, &mut rng)?);
                }
            }
            states.push(StateReadings {
                state: state.name.clone(),
                angles: options.servo_deflection.is_some().then_some(arm.angles.clone()),
                wrench: arm.recorded(cell, options, &mut rng),
                load: match options.force {
                    ForceRecord::Load => setup.load.size().map(|size| factor * size),
                    _ => None,
                },
                readings,
            });
        }
        out.push(PostureReadings {
            posture: posture.clone(),
            states,
            station: station.map(|(name, _)| name.clone()),
            axes: Isometry3::identity(),
        });
    }
    Ok(ReadingTable {
        postures: out,
        wrench_columns: match options.force {
            ForceRecord::Nothing | ForceRecord::Load => WrenchColumns::None,
            ForceRecord::Force => WrenchColumns::Force,
            ForceRecord::ForceAndMoment => WrenchColumns::ForceAndMoment,
        },
        pending: Vec::new(),
        remarks: Vec::new(),
        incomplete: Vec::new(),
    })
}

fn check(cell: &Cell, options: &Experiment) -> Result<()> {
    let n = cell.setup.robot.joint_count();
    let invalid = |message: String| Err(Error::invalid(message));
    if options.states.is_empty() {
        return invalid("An experiment needs at least one load state.".to_string());
    }
    for state in &options.states {
        if state.repeats == 0 || !state.load_factor.is_finite() {
            return invalid(format!(
                "State \"{}\" needs at least one reading of each point and a finite load.",
                state.name
            ));
        }
    }
    for (what, values) in [
        ("servo give", &options.servo_deflection),
        ("joint tilt", &options.joint_tilt),
        ("lost motion", &options.lost_motion),
    ] {
        let Some(values) = values else { continue };
        if values.len() != n || values.iter().any(|v| !v.is_finite()) {
            return invalid(format!("The {what} needs one finite number for each of the {n} joints."));
        }
    }
    let mut numbers: Vec<f64> = options.drift.iter().copied().collect();
    let stations = options.stations.iter().map(|(_, frame)| frame);
    for frame in stations.chain([&options.base_from_tracker]) {
        numbers.extend(frame.translation.vector.iter());
        numbers.extend(frame.rotation.coords.iter());
    }
    numbers.extend(options.base_reflectors.iter().flat_map(|p| p.position.iter()));
    let offset = &options.sensor_offset;
    numbers.extend(offset.force.iter().chain(offset.moment.iter()));
    if let Some(base) = options.base_compliance {
        numbers.extend([base.tilt, base.shift]);
    }
    if let Some(weight) = &options.tool_weight {
        numbers.push(weight.mass_kg);
        numbers.extend(weight.centre.iter());
    }
    if numbers.iter().any(|v| !v.is_finite()) {
        return invalid("A number of the experiment is not finite.".to_string());
    }
    let spreads =
        [options.seconds_per_reading, options.sensor_noise[0], options.sensor_noise[1], options.posture_common_std];
    if spreads.iter().any(|v| !(v.is_finite() && *v >= 0.0)) {
        return invalid("Times and standard deviations must be finite numbers, 0 or above.".to_string());
    }
    Ok(())
}
