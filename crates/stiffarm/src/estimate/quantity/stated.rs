//! Measurements with what the cell states of them, and with any of its quantities at another value.

use super::facts::Quantity;
use super::value::{QuantityAtValue, QuantityValue};
use crate::error::Result;
use crate::estimate::identify::{Experiment, Fit, MeasuredSystem};
use crate::measure::Measured;
use crate::model::cell::Cell;
use crate::model::instruments::{Mount, Sensor};
use crate::model::kinematics::Frames;
use crate::model::load::{Load, Wrench};
use crate::model::measurement::MeasuredPosture;
use crate::model::observation::{ExtraTerm, PostureTerms, Setup};
use nalgebra::{Matrix3, Vector3};

/// A wrench is the load's own where it is off by at most this share: 1 − cosine of its direction is below 10⁻⁹.
const LOAD_TOLERANCE: f64 = 4.5e-5;

/// Where the wrench of a posture comes from, and so what moves it.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Origin {
    /// The load's own, times this.
    Own(f64),
    /// Read as a force, which acts at the loading point.
    Force,
    /// Read with its moment by the sensor: it acts where the sensor is.
    Sensor,
}

/// Measurements, with what makes their wrenches.
pub(crate) struct StatedExperiment<'a> {
    pub fit: &'a Fit,
    pub experiment: &'a Experiment,
    pub system: &'a MeasuredSystem,
    origins: Vec<Origin>,
}

impl<'a> StatedExperiment<'a> {
    /// Those behind `fit`.
    pub fn of(fit: &'a Fit) -> Self {
        StatedExperiment::new(fit, fit.experiment(), fit.system())
    }

    /// Those of `experiment`, whose rows are those of `system`, in the cell of `fit`.
    pub fn new(fit: &'a Fit, experiment: &'a Experiment, system: &'a MeasuredSystem) -> Self {
        let cell = fit.cell();
        let origin = |(m, posture): (usize, &MeasuredPosture)| {
            let Some(wrench) = posture.wrench else {
                return Origin::Own(1.0);
            };
            let is_read = cell.sensor.is_some() && wrench.moment != Vector3::zeros();
            if is_read {
                return Origin::Sensor;
            }
            let load_factor = experiment.terms(m).and_then(|terms| {
                let setup = cell.setup.of_state(&posture.state).ok()?;
                let load_wrench = setup.load.wrench(terms.frames(), terms.loading_point())?;
                let factor = load_wrench.force.dot(&wrench.force) / load_wrench.force.norm_squared();
                let off = (wrench.force - load_wrench.force * factor).norm()
                    + (wrench.moment - load_wrench.moment * factor).norm();
                (off <= LOAD_TOLERANCE * wrench.force.norm()).then_some(factor)
            });
            load_factor.map_or(Origin::Force, Origin::Own)
        };
        let postures = experiment.postures().iter().enumerate();
        StatedExperiment { fit, experiment, system, origins: postures.map(origin).collect() }
    }

    pub fn cell(&self) -> &'a Cell {
        self.fit.cell()
    }

    /// The quantities that these measurements depend on.
    pub fn quantities(&self) -> Vec<Quantity> {
        let cell = self.cell();
        let (setups, cases) = (cell.setup.cases(), cell.setup.load.cases());
        let any = |origin: fn(&Origin) -> bool| self.origins.iter().any(origin);
        let is_own = any(|o| matches!(o, Origin::Own(_)));
        let is_sensor = any(|o| *o == Origin::Sensor);
        let by_sensor = cell.sensor.is_some() && !is_own;
        let mut out = vec![Quantity::ForceScale];
        let ropes = (0..setups.len()).filter(|i| matches!(setups[*i].load, Load::Rope { .. }));
        out.extend(ropes.filter(|i| self.owns(*i)).map(Quantity::Anchor));
        if any(|o| *o != Origin::Sensor) {
            let has_own = |i: &usize| cases[*i].loading_point.is_some();
            let with_point: Vec<usize> = (0..cases.len()).filter(has_own).collect();
            if with_point.len() < setups.len() {
                out.push(Quantity::LoadingPoint(None));
            }
            out.extend(with_point.into_iter().map(|i| Quantity::LoadingPoint(Some(i))));
        }
        let weight = |setup: &Setup| matches!(setup.load, Load::Weight { .. });
        if is_own && setups.iter().any(weight) {
            out.push(Quantity::Gravity);
        }
        out.extend([Quantity::Registration, Quantity::BaseTilt, Quantity::Sensor]);
        if by_sensor {
            out.extend([Quantity::SensorAxes, Quantity::SensorInBase]);
            out.extend(is_sensor.then_some(Quantity::SensorOrigin));
        } else {
            // What hangs on the rope hangs on it under a preload too.
            let is_seen = !self.fit.measured().is_against_preload();
            out.extend(is_seen.then_some(Quantity::Beside));
            out.push(Quantity::Offset);
        }
        out.extend([Quantity::Shift, Quantity::Sign]);
        if self.is_table() {
            out.push(Quantity::Points);
            let joints = cell.setup.robot.joint_count();
            out.extend((0..joints).map(Quantity::Angle));
            out.extend((joints > 2).then_some(Quantity::Coupling));
            out.push(Quantity::Rows);
        }
        out.push(Quantity::LostMotion);
        out
    }

    /// True for displacements without the positions behind them, which tell how joints count and where points are.
    pub fn is_table(&self) -> bool {
        self.fit.measured().reduction.is_none()
    }

    /// Whether readings were taken under load `i`, and their wrench follows from the cell.
    fn owns(&self, i: usize) -> bool {
        let load = &self.cell().setup.load;
        let mut all = self.experiment.postures().iter().zip(&self.origins);
        all.any(|(posture, origin)| {
            matches!(origin, Origin::Own(_)) && load.case_of(&posture.state).is_ok_and(|of| of == i)
        })
    }

    /// The set-up with quantities at these values.
    pub fn setup(&self, values: &[QuantityAtValue]) -> Setup {
        let mut setup = self.cell().setup.clone();
        for (quantity, place) in values {
            change_setup(&mut setup, *quantity, place);
        }
        setup
    }

    /// Cell and measurements as they are with quantities at these values.
    ///
    /// # Errors
    /// A load that has no direction there.
    pub fn changed(&self, values: &[QuantityAtValue]) -> Result<(Cell, Measured)> {
        let mut cell = self.cell().clone();
        cell.setup = self.setup(values);
        let postures = 0..self.origins.len();
        let postures = postures.map(|m| self.posture(&cell.setup, m, values));
        let measured = self.fit.measured();
        let measured = Measured {
            postures: postures.collect::<Result<_>>()?,
            readings_per_displacement: measured.readings_per_displacement,
            scatter: measured.scatter,
            ..Measured::default()
        };
        Ok((cell, measured))
    }

    /// Measured posture `m` with quantities at these values, which make the set-up `setup`.
    ///
    /// # Errors
    /// As [`changed`](Self::changed).
    pub fn posture(&self, setup: &Setup, m: usize, values: &[QuantityAtValue]) -> Result<MeasuredPosture> {
        let mut posture = self.experiment.postures()[m].clone();
        let Some(terms) = self.experiment.terms(m) else {
            return Ok(posture);
        };
        change_angles(&mut posture.posture.q, values);
        posture.wrench = self.wrench(setup, m, values)?.map(|(wrench, _)| wrench);
        for (quantity, place) in values {
            let elements = self.elements(m, *quantity, place)?;
            for displacement in &mut posture.displacements {
                let value = &mut displacement.value;
                match quantity {
                    Quantity::Shift => *value -= place.vector(),
                    Quantity::Registration => *value = place.rotated().transpose() * *value,
                    _ => {}
                }
                for (term, size) in &elements {
                    let moved = term.column(terms) * *size;
                    *value -= moved.fixed_rows::<3>(3 * displacement.point);
                }
            }
        }
        Ok(posture)
    }

    /// What gives way beside the model in measured posture `m` where the quantity is an element of the arm.
    ///
    /// # Errors
    /// Angles whose load has no sides.
    pub fn elements(&self, m: usize, quantity: Quantity, place: &QuantityValue) -> Result<Vec<(ExtraTerm, f64)>> {
        let mut out = Vec::new();
        for (i, size) in place.values.iter().enumerate() {
            let Some(term) = quantity.terms(i) else {
                continue;
            };
            let shows = match term {
                ExtraTerm::LostMotion(j) => !self.is_reached_from_load(j, m)?,
                _ => true,
            };
            out.extend(shows.then_some((term, *size)));
        }
        Ok(out)
    }

    /// Whether the joint stood on the side to which the load of the readings turns it before it acted: the cell says
    /// how postures are reached.
    fn is_reached_from_load(&self, joint: usize, m: usize) -> Result<bool> {
        let posture = &self.experiment.postures()[m];
        let Some(terms) = self.experiment.terms(m) else {
            return Ok(false);
        };
        if self.cell().route.approach.is_none() || posture.preload.is_some() {
            return Ok(false);
        }
        let side = self.cell().sides_of_load(&posture.posture.q)?[joint];
        Ok(side.is_some_and(|side| side * terms.torque()[joint] >= 0.0))
    }

    /// The wrench of measured posture `m` with quantities at these values, which make the set-up `setup`, and the
    /// loading point there, about which it is.
    ///
    /// # Errors
    /// A state that is under none of the loads.
    pub fn wrench(
        &self,
        setup: &Setup,
        m: usize,
        values: &[QuantityAtValue],
    ) -> Result<Option<(Wrench, Vector3<f64>)>> {
        let posture = &self.experiment.postures()[m];
        let Some(terms) = self.experiment.terms(m) else {
            return Ok(None);
        };
        let new_frames = values.iter().any(|(quantity, _)| quantity.moves_frames()).then(|| {
            let mut q = posture.posture.q.clone();
            change_angles(&mut q, values);
            Frames::new(&setup.robot, &q)
        });
        let frames = new_frames.as_ref().unwrap_or(terms.frames());
        let setup = setup.of_state(&posture.state)?;
        let at = frames.point(&setup.tool.loading_point);
        let stated = match self.origins[m] {
            Origin::Own(factor) => {
                let load_wrench = setup.load.wrench(frames, &at);
                load_wrench.map(|load_wrench| load_wrench.map(|v| v * factor))
            }
            Origin::Force => posture.wrench,
            Origin::Sensor => posture.wrench.map(|w| w.moved(terms.loading_point(), &at)),
        };
        let Some(mut wrench) = stated else {
            return Ok(None);
        };
        for (quantity, place) in values {
            let sensor = self.cell().sensor.as_ref();
            match (quantity, sensor) {
                (Quantity::ForceScale, _) => wrench = wrench.map(|v| v / (1.0 + place.values[0])),
                (Quantity::SensorAxes, Some(sensor)) => {
                    wrench = read_again(terms, &wrench, &at, sensor, |axes| axes * place.rotated() * axes.transpose());
                }
                (Quantity::SensorInBase, Some(sensor)) if place.turn[(0, 0)] > 0.0 => {
                    wrench = read_again(terms, &wrench, &at, sensor, |axes| axes.transpose());
                }
                (Quantity::SensorOrigin, Some(sensor)) => {
                    let shift = match sensor.mount {
                        Mount::Flange => terms.frames().direction(&place.vector()),
                        Mount::Base => place.vector(),
                    };
                    // What was read about the old origin belongs to the new one.
                    wrench.moment += shift.cross(&wrench.force);
                }
                (Quantity::Beside, _) => wrench.force += place.vector(),
                (Quantity::Offset, _) => {
                    let along = wrench.force.try_normalize(0.0).unwrap_or_default();
                    wrench.force += along * place.values[0];
                }
                (Quantity::Sign, _) => wrench = wrench.map(|v| v * place.turn[(0, 0)]),
                _ => {}
            }
        }
        Ok(Some((wrench, at)))
    }
}

/// The stated loading point, flange axes.
pub(crate) fn loading_point(cell: &Cell, quantity: Quantity) -> Vector3<f64> {
    let case = match quantity {
        Quantity::LoadingPoint(Some(i)) => cell.setup.load.cases().get(i),
        _ => None,
    };
    let case_point = case.and_then(|case| case.loading_point);
    case_point.unwrap_or(cell.setup.tool.loading_point)
}

/// The stated anchor of load `i`, base frame.
pub(crate) fn anchor(cell: &Cell, i: usize) -> Vector3<f64> {
    match cell.setup.load.each().nth(i) {
        Some(Load::Rope { anchor, .. }) => *anchor,
        _ => Vector3::zeros(),
    }
}

/// Direction of gravity where the quantity has this value.
pub(crate) fn gravity(stated: &Vector3<f64>, place: &QuantityValue) -> Vector3<f64> {
    let along = place.turn * stated;
    let least = along.iamin();
    let across = along.cross(&Vector3::ith(least, 1.0)).normalize();
    let moved = across * place.values[0] + along.cross(&across) * place.values[1];
    (along + moved).normalize()
}

fn change_setup(setup: &mut Setup, quantity: Quantity, place: &QuantityValue) {
    let loads: Vec<&mut Load> = match &mut setup.load {
        Load::Cases(cases) => cases.iter_mut().map(|case| &mut case.load).collect(),
        one => vec![one],
    };
    match quantity {
        Quantity::Anchor(i) => {
            if let Some(Load::Rope { anchor, .. }) = loads.into_iter().nth(i) {
                *anchor += place.vector();
            }
        }
        Quantity::Gravity => {
            for load in loads {
                if let Load::Weight { direction, .. } = load {
                    *direction = gravity(direction, place);
                }
            }
        }
        Quantity::Points => {
            for point in &mut setup.tool.measuring_points {
                point.position = place.rotated() * point.position + place.vector();
            }
        }
        Quantity::LoadingPoint(None) => setup.tool.loading_point += place.vector(),
        Quantity::LoadingPoint(Some(i)) => {
            if let Load::Cases(cases) = &mut setup.load
                && let Some(point) = cases.get_mut(i).and_then(|case| case.loading_point.as_mut())
            {
                *point += place.vector();
            }
        }
        Quantity::Rows if place.turn[(0, 0)] > 0.0 => {
            if let Some(robot) = setup.robot.in_other_convention() {
                setup.robot = robot;
            }
        }
        _ => {}
    }
}

fn change_angles(q: &mut [f64], values: &[QuantityAtValue]) {
    for (quantity, place) in values {
        match quantity {
            Quantity::Angle(j) => q[*j] = place.turn[(0, 0)] * q[*j] + place.values[0],
            Quantity::Coupling => q[2] += place.turn[(0, 0)] * q[1],
            _ => {}
        }
    }
}

/// A wrench as the sensor would have given it, turned in base axes by what `turn` makes of the sensor's.
fn read_again(
    terms: &PostureTerms,
    wrench: &Wrench,
    at: &Vector3<f64>,
    sensor: &Sensor,
    turn: impl Fn(&Matrix3<f64>) -> Matrix3<f64>,
) -> Wrench {
    let pose = match sensor.mount {
        Mount::Flange => terms.frames().flange() * sensor.pose,
        Mount::Base => sensor.pose,
    };
    let origin = pose.translation.vector;
    let axes = pose.rotation.to_rotation_matrix();
    let again = turn(axes.matrix());
    wrench.moved(at, &origin).map(|v| again * v).moved(&origin, at)
}
