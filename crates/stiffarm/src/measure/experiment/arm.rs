//! The simulated arm in one posture and load state, and what its sensor reports.

use super::{DisplacementModel, Experiment, ForceRecord, normal3};
use crate::error::Result;
use crate::model::cell::Cell;
use crate::model::instruments::{Mount, Sensor};
use crate::model::kinematics::Frames;
use crate::model::load::{Load, Wrench};
use crate::model::observation::{PostureTerms, Setup};
use crate::model::posture::Posture;
use crate::model::stiffness::equilibrium;
use crate::units::STANDARD_GRAVITY;
use nalgebra::{DMatrix, DVector, Isometry3, Translation3, UnitQuaternion, Vector3};
use rand_chacha::ChaCha8Rng;

/// The arm in one posture and load state, base frame before its base moves.
pub(super) struct Arm {
    /// Controller angles, servo give included.
    pub angles: Vec<f64>,
    pub points: Vec<Vector3<f64>>,
    /// Frames at which the sensor is read.
    frames: Frames,
    /// Wrench on the robot at `loading_point`.
    wrench: Wrench,
    loading_point: Vector3<f64>,
    pub base_motion: Isometry3<f64>,
}

impl Arm {
    pub fn new(
        setup: &Setup,
        posture: &Posture,
        stiffness: &[f64],
        compliance: &DMatrix<f64>,
        options: &Experiment,
        factor: f64,
    ) -> Result<Self> {
        let setup = scaled(setup, factor);
        let robot = &setup.robot;
        let terms = PostureTerms::new(&setup, &posture.q, None)?;
        let torque = DVector::from_column_slice(terms.torque());
        // Torque about the controller's axes: Cᵀ Γ.
        let controller_torque = robot.coupling().tr_mul(&torque);
        let give = match &options.servo_deflection {
            Some(give) => DVector::from_fn(give.len(), |j, _| give[j] * controller_torque[j]),
            None => DVector::zeros(torque.len()),
        };
        let angles: Vec<f64> = posture.q.iter().zip(&give).map(|(q, d)| q + d).collect();
        let mut turns = DVector::zeros(torque.len());
        if let Some(lost) = &options.lost_motion {
            for (j, gap) in lost.iter().enumerate() {
                if torque[j] != 0.0 {
                    turns[j] += gap * torque[j].signum();
                }
            }
        }
        let (frames, wrench, mut points) = match options.model {
            DisplacementModel::Linear => {
                // Δ = J^m (C Δq_m + K_θ⁻¹ Γ), Eqs. (5)–(7).
                turns += robot.coupling() * &give + compliance * &torque;
                let points = terms.measuring_points().to_vec();
                (terms.frames().clone(), *terms.wrench(), points)
            }
            DisplacementModel::Equilibrium => {
                let bent = equilibrium(&setup, &angles, stiffness, None)?;
                let tool = &setup.tool.measuring_points;
                let points = tool.iter().map(|p| bent.frames().point(&p.position));
                (bent.frames().clone(), *bent.wrench(), points.collect())
            }
        };
        let series_shift = terms.known_displacement(&setup.tool);
        for (a, point) in points.iter_mut().enumerate() {
            let at = terms.measuring_points()[a];
            for (j, turn) in turns.iter().enumerate() {
                *point += terms.frames().column(j, &at) * *turn;
            }
            *point += series_shift.fixed_rows::<3>(3 * a);
            if let Some(tilt) = &options.joint_tilt {
                *point += tilted(&terms, tilt, &at);
            }
        }
        let loading_point = frames.point(&setup.tool.loading_point);
        let about_origin = wrench.moved(&loading_point, &Vector3::zeros());
        let base_motion = match options.base_compliance {
            Some(base) => {
                let moment = about_origin.moment;
                let turn = Vector3::new(moment.x, moment.y, 0.0) * base.tilt;
                Isometry3::from_parts(
                    Translation3::from(wrench.force * base.shift),
                    UnitQuaternion::from_scaled_axis(turn),
                )
            }
            None => Isometry3::identity(),
        };
        Ok(Arm { angles, points, frames, wrench, loading_point, base_motion })
    }

    /// What the table says of the force.
    pub fn recorded(&self, cell: &Cell, options: &Experiment, rng: &mut ChaCha8Rng) -> Option<Wrench> {
        if matches!(options.force, ForceRecord::Nothing | ForceRecord::Load) {
            return None;
        }
        let mut reading = match &cell.sensor {
            None => self.wrench,
            Some(sensor) => {
                let weight = options.tool_weight.filter(|_| sensor.mount == Mount::Flange);
                let down = cell.setup.robot.gravity_direction();
                let carried = weight.map(|w| {
                    Wrench::force(down * (STANDARD_GRAVITY * w.mass_kg))
                        .moved(&self.frames.point(&w.centre), &self.loading_point)
                });
                let mut felt = self.wrench;
                if let Some(carried) = carried {
                    felt.force += carried.force;
                    felt.moment += carried.moment;
                }
                sensor_reading(sensor, &self.frames, &felt, &self.loading_point)
            }
        };
        let [force, moment] = options.sensor_noise;
        reading.force += options.sensor_offset.force + normal3(rng) * force;
        reading.moment += options.sensor_offset.moment + normal3(rng) * moment;
        if options.force == ForceRecord::Force {
            reading.moment = Vector3::zeros();
        }
        Some(reading)
    }
}

/// The cell's setup with its load times `factor`.
fn scaled(setup: &Setup, factor: f64) -> Setup {
    let mut out = setup.clone();
    match &mut out.load {
        Load::Rope { magnitude, .. } | Load::Weight { magnitude, .. } => *magnitude *= factor,
        Load::Constant { wrench, .. } => {
            wrench.force *= factor;
            wrench.moment *= factor;
        }
        Load::Measured | Load::Cases(_) => {}
    }
    out
}

/// Shift of the base-frame point `at` because each joint tilts about the two
/// axes across its own.
fn tilted(terms: &PostureTerms, tilt: &[f64], at: &Vector3<f64>) -> Vector3<f64> {
    let frames = terms.frames();
    let mut shift = Vector3::zeros();
    for (j, compliance) in tilt.iter().enumerate() {
        let (axis, origin) = (&frames.axes()[j], &frames.origins()[j]);
        let moment = terms.wrench().moved(terms.loading_point(), origin).moment;
        let across = moment - axis * axis.dot(&moment);
        shift += (across * *compliance).cross(&(at - origin));
    }
    shift
}

/// What a sensor reports of `wrench` on the robot at the base-frame point `at`:
/// the inverse of [`Sensor::wrench_on_robot`].
fn sensor_reading(sensor: &Sensor, frames: &Frames, wrench: &Wrench, at: &Vector3<f64>) -> Wrench {
    let pose = match sensor.mount {
        Mount::Flange => frames.flange() * sensor.pose,
        Mount::Base => sensor.pose,
    };
    let sign = if sensor.reports_by_robot { -1.0 } else { 1.0 };
    let at_sensor = wrench.moved(at, &pose.translation.vector);
    Wrench {
        force: sensor.right_handed(pose.rotation.inverse_transform_vector(&at_sensor.force) * sign),
        moment: sensor.right_handed(pose.rotation.inverse_transform_vector(&at_sensor.moment) * sign),
    }
}
