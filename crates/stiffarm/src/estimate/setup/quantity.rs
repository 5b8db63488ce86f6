//! What the cell and the table state of the set-up, as quantities that can be freed: each is a change of the cell or
//! of what was measured, and the displacements follow from the model as they do without it.

use crate::error::Result;
use crate::estimate::identify::{Fit, known_displacement};
use crate::measure::Measured;
use crate::model::cell::Cell;
use crate::model::instruments::{Mount, Sensor};
use crate::model::kinematics::Frames;
use crate::model::load::{Load, Wrench};
use crate::model::measurement::MeasuredPosture;
use crate::model::observation::{ExtraTerm, PostureTerms, Setup};
use nalgebra::{DVector, Matrix3, Rotation3, Vector3};

/// A wrench is the load's own where it is off by at most this share.
const OWN: f64 = 1e-9;

/// A quantity of the set-up. What has a number belongs to that load case, load group or joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Kind {
    /// Fixed end of a rope or cylinder, base frame.
    Anchor(usize),
    /// Where the load acts, flange axes; with a number that of this load case alone.
    LoadingPoint(Option<usize>),
    /// Direction of a weight, base axes.
    Gravity,
    /// A constant force beside the load, base axes.
    Beside,
    /// A force along the load that every loaded state has more than is stated.
    Offset,
    /// The load, or the displacements, have the opposite sign.
    Sign,
    /// A displacement common to all loaded readings, base axes.
    Shift,
    /// Turn of the force sensor's axes.
    SensorAxes,
    /// Origin of the force sensor.
    SensorOrigin,
    /// The sensor's readings are given in base axes.
    SensorInBase,
    /// The measuring points as a rigid body, flange axes, under a table of displacements: shift and turn.
    Points,
    /// Axes of a table of displacements.
    TableAxes,
    /// Offset of a joint angle under a table of displacements, and the way in which it counts.
    Angle(usize),
    /// The angle of axis 3 counts that of axis 2, under a table of displacements.
    Coupling,
    /// The robot's rows are meant in the other Denavit–Hartenberg convention, under a table of displacements.
    Rows,
    /// Lost motion of every joint: no error of the set-up, but what else may explain the same.
    LostMotion,
}

/// A value of a quantity: first `turn`, which is found by trying, then the numbers, which are found by least squares.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Place {
    pub turn: Matrix3<f64>,
    pub values: DVector<f64>,
}

impl Place {
    pub(super) fn new(turn: Matrix3<f64>, values: Vec<f64>) -> Self {
        let values = DVector::from_vec(values);
        Place { turn, values }
    }

    /// The first three numbers.
    pub fn vector(&self) -> Vector3<f64> {
        Vector3::from_fn(|i, _| self.values.get(i).copied().unwrap_or(0.0))
    }

    /// The last three numbers as a turn, after `turn`.
    pub fn rotated(&self) -> Matrix3<f64> {
        let from = self.values.len().saturating_sub(3);
        let by = Vector3::from_fn(|i, _| self.values.get(from + i).copied().unwrap_or(0.0));
        Rotation3::new(by).matrix() * self.turn
    }
}

/// Where the wrench of a posture comes from, and so what moves it.
#[derive(Debug, Clone, Copy)]
enum Origin {
    /// The load's own, times this.
    Own(f64),
    /// Read as a force, which acts at the loading point.
    Force,
    /// Read with its moment by the sensor: it acts where the sensor is.
    Sensor,
}

/// The measurements behind a fit, with what makes their wrenches.
pub(super) struct Frame<'a> {
    pub fit: &'a Fit,
    origins: Vec<Origin>,
}

impl<'a> Frame<'a> {
    pub fn new(fit: &'a Fit) -> Self {
        let cell = fit.cell();
        let origin = |(m, posture): (usize, &MeasuredPosture)| {
            let Some(wrench) = posture.wrench else {
                return Origin::Own(1.0);
            };
            let own = fit.experiment().terms(m).and_then(|terms| {
                let setup = cell.setup.of_state(&posture.state).ok()?;
                let own = setup.load.wrench(terms.frames(), terms.loading_point())?;
                let factor = own.force.dot(&wrench.force) / own.force.norm_squared();
                let off = (wrench.force - own.force * factor).norm()
                    + (wrench.moment - own.moment * factor).norm();
                (off <= OWN * wrench.force.norm()).then_some(factor)
            });
            match own {
                Some(factor) => Origin::Own(factor),
                None if cell.sensor.is_some() && wrench.moment != Vector3::zeros() => {
                    Origin::Sensor
                }
                None => Origin::Force,
            }
        };
        let postures = fit.postures().iter().enumerate();
        Frame {
            fit,
            origins: postures.map(origin).collect(),
        }
    }

    /// The quantities that these measurements depend on.
    pub fn quantities(&self) -> Vec<Kind> {
        let cell = self.fit.cell();
        let setups = cell.setup.cases();
        let is_own = self.origins.iter().any(|o| matches!(o, Origin::Own(_)));
        let is_sensor = self.origins.iter().any(|o| matches!(o, Origin::Sensor));
        let by_sensor = cell.sensor.is_some() && !is_own;
        let is_table = self.fit.measured().reduction.is_none();
        let mut out = Vec::new();
        let ropes = (0..setups.len()).filter(|i| matches!(setups[*i].load, Load::Rope { .. }));
        out.extend(ropes.filter(|_| is_own).map(Kind::Anchor));
        let cases = cell.setup.load.cases();
        if !is_sensor {
            let has_own = |i: &usize| cases[*i].loading_point.is_some();
            let own: Vec<usize> = (0..cases.len()).filter(has_own).collect();
            if own.len() < setups.len() {
                out.push(Kind::LoadingPoint(None));
            }
            out.extend(own.into_iter().map(|i| Kind::LoadingPoint(Some(i))));
        }
        let weight = |setup: &Setup| matches!(setup.load, Load::Weight { .. });
        if is_own && setups.iter().any(weight) {
            out.push(Kind::Gravity);
        }
        if by_sensor {
            out.extend([Kind::SensorAxes, Kind::SensorInBase]);
            out.extend(is_sensor.then_some(Kind::SensorOrigin));
        } else {
            out.extend([Kind::Beside, Kind::Offset]);
        }
        out.extend([Kind::Shift, Kind::Sign]);
        if is_table {
            out.extend([Kind::TableAxes, Kind::Points]);
            let joints = cell.setup.robot.joint_count();
            out.extend((0..joints).map(Kind::Angle));
            out.extend((joints > 2).then_some(Kind::Coupling));
            out.push(Kind::Rows);
        }
        if cell.route.approach.is_none() {
            out.push(Kind::LostMotion);
        }
        out
    }

    /// Cell and measurements as they are where the quantity has the value `place`.
    ///
    /// # Errors
    /// A load that has no direction there.
    pub fn changed(&self, kind: Kind, place: &Place) -> Result<(Cell, Measured)> {
        let mut cell = self.fit.cell().clone();
        change_setup(&mut cell.setup, kind, place);
        let postures = 0..self.origins.len();
        let postures = postures.map(|m| self.posture(&cell.setup, m, kind, place));
        let measured = self.fit.measured();
        let measured = Measured {
            postures: postures.collect::<Result<_>>()?,
            readings_per_displacement: measured.readings_per_displacement,
            scatter: measured.scatter,
            ..Measured::default()
        };
        Ok((cell, measured))
    }

    /// Ψ h − Δ where the quantity has the value `place`, rows as in the system; h are `values`. No more is computed than
    /// that.
    ///
    /// # Errors
    /// As [`changed`](Self::changed).
    pub fn missed(&self, kind: Kind, place: &Place, values: &DVector<f64>) -> Result<DVector<f64>> {
        let system = self.fit.system();
        let mut setup = self.fit.cell().setup.clone();
        change_setup(&mut setup, kind, place);
        let mut out = DVector::zeros(system.delta.len());
        for labels in system.labels.chunk_by(|a, b| a.measured == b.measured) {
            let posture = self.posture(&setup, labels[0].measured, kind, place)?;
            let own = setup.of_state(&posture.state)?;
            let terms = posture.terms(&own, posture.wrench.as_ref())?;
            let moved = terms.block_with(&setup.robot, &system.extra) * values;
            let moved = moved + known_displacement(&setup, &terms, &posture)?;
            for label in labels {
                let displacement = &posture.displacements[label.displacement];
                let left = moved.fixed_rows::<3>(3 * displacement.point) - displacement.value;
                out.fixed_rows_mut::<3>(label.rows.start).copy_from(&left);
            }
        }
        Ok(out)
    }

    /// Measured posture `m` where the quantity has the value `place`, and so the cell is `setup`.
    fn posture(
        &self,
        setup: &Setup,
        m: usize,
        kind: Kind,
        place: &Place,
    ) -> Result<MeasuredPosture> {
        let mut posture = self.fit.postures()[m].clone();
        let Some(terms) = self.fit.experiment().terms(m) else {
            return Ok(posture);
        };
        change_posture(&mut posture, terms, kind, place);
        let frames = match kind {
            Kind::Angle(_) | Kind::Coupling | Kind::Rows => {
                &Frames::new(&setup.robot, &posture.posture.q)
            }
            _ => terms.frames(),
        };
        self.change_wrench(setup, m, &mut posture, (terms, frames), kind, place)?;
        Ok(posture)
    }

    fn change_wrench(
        &self,
        setup: &Setup,
        m: usize,
        posture: &mut MeasuredPosture,
        (terms, frames): (&PostureTerms, &Frames),
        kind: Kind,
        place: &Place,
    ) -> Result<()> {
        let setup = setup.of_state(&posture.state)?;
        let at = frames.point(&setup.tool.loading_point);
        let mut wrench = match self.origins[m] {
            Origin::Own(factor) => {
                let own = setup.load.wrench(frames, &at);
                own.map(|own| own.map(|v| v * factor))
            }
            Origin::Force => posture.wrench,
            Origin::Sensor => posture.wrench.map(|w| w.moved(terms.loading_point(), &at)),
        };
        let changed = wrench.as_mut().zip(self.fit.cell().sensor.as_ref());
        match (kind, changed) {
            (Kind::SensorAxes, Some((wrench, sensor))) => {
                *wrench = read_again(terms, wrench, &at, sensor, |axes| {
                    axes * place.rotated() * axes.transpose()
                });
            }
            (Kind::SensorInBase, Some((wrench, sensor))) if place.turn[(0, 0)] > 0.0 => {
                *wrench = read_again(terms, wrench, &at, sensor, |axes| axes.transpose());
            }
            (Kind::SensorOrigin, Some((wrench, sensor))) => {
                let shift = match sensor.mount {
                    Mount::Flange => terms.frames().direction(&place.vector()),
                    Mount::Base => place.vector(),
                };
                // What was read about the old origin belongs to the new one.
                wrench.moment += shift.cross(&wrench.force);
            }
            (Kind::Beside, _) => {
                if let Some(wrench) = &mut wrench {
                    wrench.force += place.vector();
                }
            }
            (Kind::Offset, _) => {
                if let Some(wrench) = &mut wrench {
                    let along = wrench.force.try_normalize(0.0).unwrap_or_default();
                    wrench.force += along * place.values[0];
                }
            }
            (Kind::Sign, _) => wrench = wrench.map(|w| w.map(|v| v * place.turn[(0, 0)])),
            _ => {}
        }
        posture.wrench = wrench;
        Ok(())
    }

    /// How many numbers it has.
    pub fn dimension(&self, kind: Kind) -> usize {
        match kind {
            Kind::Gravity => 2,
            Kind::Angle(_) | Kind::Offset => 1,
            Kind::Coupling | Kind::Rows | Kind::Sign | Kind::SensorInBase => 0,
            Kind::Points => 6,
            Kind::LostMotion => self.fit.cell().setup.robot.joint_count(),
            _ => 3,
        }
    }
}

/// Step for a derivative by differences: small beside any geometry, large beside rounding \[m; N; rad\].
pub(super) fn step(kind: Kind) -> f64 {
    match kind {
        Kind::Beside | Kind::Offset => 1.0,
        Kind::LostMotion => 1e-5,
        _ => 1e-4,
    }
}

/// The stated loading point, flange axes.
pub(super) fn loading_point(cell: &Cell, kind: Kind) -> Vector3<f64> {
    let own = match kind {
        Kind::LoadingPoint(Some(i)) => cell.setup.load.cases().get(i),
        _ => None,
    };
    let own = own.and_then(|case| case.loading_point);
    own.unwrap_or(cell.setup.tool.loading_point)
}

/// The stated anchor of load `i`, base frame.
pub(super) fn anchor(cell: &Cell, i: usize) -> Vector3<f64> {
    match cell.setup.load.each().nth(i) {
        Some(Load::Rope { anchor, .. }) => *anchor,
        _ => Vector3::zeros(),
    }
}

/// Direction of gravity where the quantity has this value.
pub(super) fn gravity(stated: &Vector3<f64>, place: &Place) -> Vector3<f64> {
    let along = place.turn * stated;
    let least = along.iamin();
    let across = along.cross(&Vector3::ith(least, 1.0)).normalize();
    let moved = across * place.values[0] + along.cross(&across) * place.values[1];
    (along + moved).normalize()
}

fn change_setup(setup: &mut Setup, kind: Kind, place: &Place) {
    let loads: Vec<&mut Load> = match &mut setup.load {
        Load::Cases(cases) => cases.iter_mut().map(|case| &mut case.load).collect(),
        one => vec![one],
    };
    match kind {
        Kind::Anchor(i) => {
            if let Some(Load::Rope { anchor, .. }) = loads.into_iter().nth(i) {
                *anchor += place.vector();
            }
        }
        Kind::Gravity => {
            for load in loads {
                if let Load::Weight { direction, .. } = load {
                    *direction = gravity(direction, place);
                }
            }
        }
        Kind::Points => {
            for point in &mut setup.tool.measuring_points {
                point.position = place.rotated() * point.position + place.vector();
            }
        }
        Kind::LoadingPoint(None) => setup.tool.loading_point += place.vector(),
        Kind::Rows if place.turn[(0, 0)] > 0.0 => {
            if let Some(robot) = setup.robot.in_other_convention() {
                setup.robot = robot;
            }
        }
        Kind::LoadingPoint(Some(i)) => {
            if let Load::Cases(cases) = &mut setup.load
                && let Some(point) = cases
                    .get_mut(i)
                    .and_then(|case| case.loading_point.as_mut())
            {
                *point += place.vector();
            }
        }
        _ => {}
    }
}

fn change_posture(posture: &mut MeasuredPosture, terms: &PostureTerms, kind: Kind, place: &Place) {
    let q = &mut posture.posture.q;
    match kind {
        Kind::Angle(j) => q[j] = place.turn[(0, 0)] * q[j] + place.values[0],
        Kind::Coupling => q[2] += place.turn[(0, 0)] * q[1],
        _ => {}
    }
    let lost = match kind {
        Kind::LostMotion => Some(place.values.iter().enumerate().fold(
            DVector::zeros(3 * terms.measuring_points().len()),
            |all, (j, angle)| all + ExtraTerm::LostMotion(j).column(terms) * *angle,
        )),
        _ => None,
    };
    for displacement in &mut posture.displacements {
        match (kind, &lost) {
            (Kind::Shift, _) => displacement.value -= place.vector(),
            (Kind::TableAxes, _) => displacement.value = place.rotated() * displacement.value,
            (_, Some(lost)) => {
                displacement.value -= lost.fixed_rows::<3>(3 * displacement.point).into_owned();
            }
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
    wrench
        .moved(at, &origin)
        .map(|v| again * v)
        .moved(&origin, at)
}
