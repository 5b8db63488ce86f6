//! The sources of common error and what each does to the displacements.

use super::believed::Believed;
use crate::error::Result;
use crate::estimate::identify::{Experiment, MeasuredSystem, known_displacement};
use crate::model::cell::Cell;
use crate::model::instruments::Mount;
use crate::model::load::{Load, Wrench};
use crate::model::measurement::MeasuredPosture;
use crate::model::observation::{ExtraTerm, PostureTerms, Setup};
use crate::model::tool::SeriesCompliance;
use nalgebra::{DVector, Matrix6, Rotation3, Vector3};

/// Assumed where the cell says nothing.
pub(crate) const FORCE_SCALE: f64 = 0.01;
/// Coordinate of an anchor measured by tape \[m\].
pub(crate) const ANCHOR: f64 = 5e-3;
/// Coordinate of a loading point by its drawing \[m\].
pub(crate) const LOADING_POINT: f64 = 1e-3;
/// Turn between tracker and base \[rad\].
pub(crate) const REGISTRATION: f64 = 0.5e-3;
/// Tilt of a well-anchored base \[rad/(N·m)\].
const BASE_TILT: f64 = 1e-8;
/// Turn of a force sensor that is there and that nobody models \[rad/(N·m)\].
const SENSOR: f64 = 1e-6;
/// Half the gap of a joint in order, 0.1 arc-minute \[rad\].
const LOST_MOTION: f64 = 0.1 / 60.0 * std::f64::consts::PI / 180.0;
/// Half of what is found otherwise where springs alone are expected: all of it counts as 95 %.
const SPRINGS: f64 = 0.5;
/// Name of the source whose parts are alike.
const LOST_MOTION_NAME: &str = "lost-motion";
/// 1 − cosine below which a force counts as being along the rope.
const ALONG: f64 = 1e-9;

/// A source with what its parts do to the displacements.
pub(super) struct Source {
    pub name: &'static str,
    pub size: f64,
    pub unit: &'static str,
    pub declared: bool,
    /// True where the parts are of one size that is not known better than stated.
    pub alike: bool,
    /// One part without a name for a source that is one number.
    pub parts: Vec<Part>,
}

/// One part of a source.
pub(super) struct Part {
    pub name: String,
    /// Change of the displacements, rows as in the system \[m\].
    pub shift: DVector<f64>,
    /// What acts again at work.
    pub at_work: Option<ExtraTerm>,
    /// Change of the unknowns by one that moves no displacement: readings say nothing of it.
    pub change: Option<DVector<f64>>,
}

/// What is nominal: the measurements with their terms and displacements.
struct Nominal<'a> {
    cell: &'a Cell,
    believed: &'a Believed<'a>,
    /// What stands behind the rows.
    system: &'a MeasuredSystem,
    postures: Vec<(&'a MeasuredPosture, &'a PostureTerms)>,
    /// Modelled displacement of each, 3m.
    displacements: Vec<DVector<f64>>,
}

/// The sources that matter for the measurements of `experiment`, whose rows are those of `system`; the force scale first.
pub(super) fn sources(
    believed: &Believed<'_>,
    experiment: &Experiment,
    system: &MeasuredSystem,
) -> Result<Vec<Source>> {
    let cell = believed.fit.cell();
    let given = &cell.uncertainty;
    let mut nominal = Nominal {
        cell,
        believed,
        system,
        postures: experiment.with_terms().collect(),
        displacements: Vec::new(),
    };
    nominal.displacements = nominal
        .postures
        .iter()
        .map(|(posture, terms)| nominal.displacement(posture, terms))
        .collect::<Result<_>>()?;

    let mut out = Vec::new();
    let mut add =
        |name, size: Option<f64>, assumed, unit, parts: &dyn Fn(f64) -> Result<Vec<Part>>| {
            let used = size.unwrap_or(assumed);
            let parts = parts(used)?;
            // A source that moves nothing here, whatever its size, is none.
            if !parts.is_empty() {
                out.push(Source {
                    name,
                    size: used,
                    unit,
                    declared: size.is_some(),
                    alike: name == LOST_MOTION_NAME,
                    parts,
                });
            }
            Result::Ok(())
        };
    add(
        "force-scale",
        given.force_scale,
        FORCE_SCALE,
        "1",
        &|size| nominal.force_scale(size),
    )?;
    if cell.setup.load.has_rope() && nominal.uses_rope() {
        add("anchor", given.anchor, ANCHOR, "m", &|size| {
            nominal.anchor(size)
        })?;
    }
    if nominal.uses_loading_point() {
        add(
            "loading-point",
            given.loading_point,
            LOADING_POINT,
            "m",
            &|size| nominal.loading_point(size),
        )?;
    }
    add(
        "registration",
        given.registration,
        REGISTRATION,
        "rad",
        &|size| nominal.registration(size),
    )?;
    add(
        "base-tilt",
        given.base_tilt_compliance,
        BASE_TILT,
        "rad/(N·m)",
        &|size| nominal.terms([("", ExtraTerm::BaseTilt)], size),
    )?;
    let unmodelled = cell.setup.tool.has_sensor && cell.setup.tool.series_compliance.is_none();
    if given.sensor_compliance.is_some() || unmodelled {
        add(
            "sensor",
            given.sensor_compliance,
            SENSOR,
            "rad/(N·m)",
            &|size| nominal.sensor(size),
        )?;
    }
    add(
        LOST_MOTION_NAME,
        given.lost_motion,
        LOST_MOTION,
        "rad",
        &|size| {
            let joints = cell.setup.robot.joints().iter().enumerate();
            let terms = joints.map(|(j, joint)| (&*joint.name, ExtraTerm::LostMotion(j)));
            nominal.terms(terms, size)
        },
    )?;
    if let Some(alone) = &believed.springs_alone {
        add("springs", Some(SPRINGS), SPRINGS, "1", &|size| {
            Ok(vec![Part {
                name: String::new(),
                shift: DVector::zeros(system.delta.len()),
                at_work: None,
                change: Some(alone * size),
            }])
        })?;
    }
    Ok(out)
}

impl Nominal<'_> {
    /// Modelled displacement of all measuring points, 3m.
    fn displacement(
        &self,
        posture: &MeasuredPosture,
        terms: &PostureTerms,
    ) -> Result<DVector<f64>> {
        let moved =
            terms.block_with(&self.cell.setup.robot, self.believed.extra) * self.believed.values;
        Ok(moved + known_displacement(&self.cell.setup, terms, posture)?)
    }

    /// A part whose displacements differ, posture by posture, by `shift`.
    fn part(
        &self,
        name: &str,
        shift: impl Fn(&MeasuredPosture, &PostureTerms, &DVector<f64>) -> Result<DVector<f64>>,
    ) -> Result<Part> {
        let mut all = Vec::with_capacity(self.postures.len());
        for ((posture, terms), displacement) in self.postures.iter().zip(&self.displacements) {
            self.believed.fit.control().check()?;
            all.push(shift(posture, terms, displacement)?);
        }
        let system = self.system;
        let mut rows = DVector::zeros(system.delta.len());
        for (i, label) in system.labels.iter().enumerate() {
            let point = self.postures[label.measured].0.displacements[label.displacement].point;
            rows.fixed_rows_mut::<3>(3 * i)
                .copy_from(&all[label.measured].fixed_rows::<3>(3 * point));
        }
        Ok(Part {
            name: name.to_string(),
            shift: rows,
            at_work: None,
            change: None,
        })
    }

    /// The three axes of a source.
    fn axes(&self, part: impl Fn(&str, Vector3<f64>) -> Result<Part>) -> Result<Vec<Part>> {
        ["x", "y", "z"]
            .iter()
            .enumerate()
            .map(|(i, name)| part(name, Vector3::ith(i, 1.0)))
            .collect()
    }

    /// The true wrench is the stated one over 1 + size.
    fn force_scale(&self, size: f64) -> Result<Vec<Part>> {
        let part = self.part("", |posture, terms, nominal| {
            let truth = terms.wrench().map(|v| v / (1.0 + size));
            let setup = self.cell.setup.of_state(&posture.state)?;
            let terms = posture.terms(&setup, Some(&truth))?;
            Ok(self.displacement(posture, &terms)? - nominal)
        })?;
        Ok(vec![part])
    }

    /// Each rope's anchor: of several load cases one after the other.
    fn anchor(&self, size: f64) -> Result<Vec<Part>> {
        let setups = self.cell.setup.cases();
        let ropes = (0..setups.len()).filter(|i| matches!(setups[*i].load, Load::Rope { .. }));
        let groups: Vec<_> = ropes.map(|i| (self.load_name(i), vec![i])).collect();
        let shift = |truth: &mut Setup, axis: Vector3<f64>| {
            if let Load::Rope { anchor, .. } = &mut truth.load {
                *anchor += axis * size;
            }
        };
        self.of_loads(&setups, &groups, shift, |_| true)
    }

    /// The tool's loading point, and those of load cases that have one of their own.
    fn loading_point(&self, size: f64) -> Result<Vec<Part>> {
        let setups = self.cell.setup.cases();
        let cases = self.cell.setup.load.cases();
        let own = |i: &usize| cases.get(*i).is_some_and(|c| c.loading_point.is_some());
        let (alone, shared): (Vec<usize>, Vec<usize>) = (0..setups.len()).partition(own);
        let mut groups = vec![(String::new(), shared)];
        groups.extend(alone.into_iter().map(|i| (self.load_name(i), vec![i])));
        groups.retain(|(_, loads)| !loads.is_empty());
        let shift = |truth: &mut Setup, axis: Vector3<f64>| {
            truth.tool.loading_point += axis * size;
        };
        self.of_loads(&setups, &groups, shift, |p| !self.measures_moment(p))
    }

    /// Of several load cases the name of one, with a space behind it.
    fn load_name(&self, number: usize) -> String {
        let case = self.cell.setup.load.cases().get(number);
        case.map_or_else(String::new, |case| format!("{} ", case.name))
    }

    /// The three axes of a source that loads have, for each group of loads that have it in
    /// common: `shift` moves their setups by it, in the states that it `concerns`.
    fn of_loads(
        &self,
        setups: &[Setup],
        groups: &[(String, Vec<usize>)],
        shift: impl Fn(&mut Setup, Vector3<f64>),
        concerns: impl Fn(&MeasuredPosture) -> bool,
    ) -> Result<Vec<Part>> {
        let mut parts = Vec::new();
        for (load, members) in groups {
            parts.extend(self.axes(|axis_name, axis| {
                let mut truths = setups.to_vec();
                truths.iter_mut().for_each(|truth| shift(truth, axis));
                self.part(&format!("{load}{axis_name}"), |posture, terms, nominal| {
                    let case = self.cell.setup.load.case_of(&posture.state)?;
                    if members.contains(&case) && concerns(posture) {
                        self.moved(&truths[case], posture, terms, nominal)
                    } else {
                        Ok(nominal * 0.0)
                    }
                })
            })?);
        }
        Ok(parts)
    }

    /// Change of the displacements where `truth` holds instead of the cell.
    fn moved(
        &self,
        truth: &Setup,
        posture: &MeasuredPosture,
        terms: &PostureTerms,
        nominal: &DVector<f64>,
    ) -> Result<DVector<f64>> {
        let q = &posture.posture.q;
        let wrench = match &posture.wrench {
            Some(wrench) if self.is_along_rope(posture, terms) => {
                // Its size was measured, its direction follows the rope.
                let rope = PostureTerms::new(truth, q, None)?.wrench().force;
                let stated = self.cell.setup.of_state(&posture.state)?;
                let nominal = PostureTerms::new(&stated, q, None)?.wrench().force;
                let sign = wrench.force.dot(&nominal).signum();
                let unit = rope.try_normalize(0.0).unwrap_or_default();
                Some(Wrench::force(unit * (sign * wrench.force.norm())))
            }
            given => *given,
        };
        let terms = posture.terms(truth, wrench.as_ref())?;
        Ok(self.displacement(posture, &terms)? - nominal)
    }

    /// True where the posture's force is, or points along, the cell's rope.
    fn is_along_rope(&self, posture: &MeasuredPosture, terms: &PostureTerms) -> bool {
        let Ok(setup) = self.cell.setup.of_state(&posture.state) else {
            return false;
        };
        let Some(wrench) = &posture.wrench else {
            return matches!(setup.load, Load::Rope { .. });
        };
        if wrench.moment != Vector3::zeros() {
            return false;
        }
        let rope = match &setup.load {
            Load::Rope { anchor, .. } => anchor - terms.loading_point(),
            _ => return false,
        };
        let product = rope.norm() * wrench.force.norm();
        product > 0.0 && rope.dot(&wrench.force).abs() >= (1.0 - ALONG) * product
    }

    fn uses_rope(&self) -> bool {
        self.postures
            .iter()
            .any(|(posture, terms)| self.is_along_rope(posture, terms))
    }

    /// True where the sensor measured the moment too: the wrench is known at
    /// the sensor's origin.
    fn measures_moment(&self, posture: &MeasuredPosture) -> bool {
        let moment = posture.wrench.map(|w| w.moment);
        self.cell.sensor.is_some() && moment.is_some_and(|m| m != Vector3::zeros())
    }

    fn uses_loading_point(&self) -> bool {
        !self
            .postures
            .iter()
            .all(|(posture, _)| self.measures_moment(posture))
    }

    /// Displacements turned by a registration that is off by `size`.
    fn registration(&self, size: f64) -> Result<Vec<Part>> {
        self.axes(|name, axis| {
            let turn = Rotation3::new(axis * size);
            self.part(name, |_, _, nominal| {
                let mut out = nominal.clone();
                for point in 0..nominal.len() / 3 {
                    let before = nominal.fixed_rows::<3>(3 * point).into_owned();
                    out.fixed_rows_mut::<3>(3 * point)
                        .copy_from(&(turn * before - before));
                }
                Ok(out)
            })
        })
    }

    /// Further elastic elements, or lost motion, of this size: those that the fit
    /// does not have among its unknowns. They stay with the arm.
    fn terms<'n>(
        &self,
        named: impl IntoIterator<Item = (&'n str, ExtraTerm)>,
        size: f64,
    ) -> Result<Vec<Part>> {
        let named = named
            .into_iter()
            .filter(|(_, term)| !self.believed.holds(term));
        named
            .map(|(name, term)| {
                let part = self.part(name, |posture, terms, _| {
                    let shows = match term {
                        ExtraTerm::LostMotion(j) => {
                            !self.is_reached_from_load(j, posture, terms)?
                        }
                        _ => true,
                    };
                    Ok(term.column(terms) * if shows { size } else { 0.0 })
                })?;
                Ok(Part {
                    at_work: Some(term),
                    ..part
                })
            })
            .collect()
    }

    /// Whether the joint stood on the side to which the load of the readings turns it before it acted: the cell says how
    /// postures are reached.
    fn is_reached_from_load(
        &self,
        joint: usize,
        posture: &MeasuredPosture,
        terms: &PostureTerms,
    ) -> Result<bool> {
        if self.cell.route.approach.is_none() || posture.preload.is_some() {
            return Ok(false);
        }
        let side = self.cell.sides_of_load(&posture.posture.q)?[joint];
        Ok(side.is_some_and(|side| side * terms.torque()[joint] >= 0.0))
    }

    /// What the part beyond the sensor does when the sensor turns.
    fn sensor(&self, size: f64) -> Result<Vec<Part>> {
        let tool = &self.cell.setup.tool;
        let at_sensor = self
            .cell
            .sensor
            .as_ref()
            .filter(|s| s.mount == Mount::Flange);
        let origin = match (at_sensor, &tool.series_compliance) {
            (Some(sensor), _) => sensor.pose.translation.vector,
            (None, Some(series)) => series.origin,
            (None, None) => Vector3::zeros(),
        };
        let mut matrix = Matrix6::zeros();
        for axis in 3..6 {
            matrix[(axis, axis)] = size;
        }
        let mut soft = tool.clone();
        soft.series_compliance = Some(SeriesCompliance { origin, matrix });
        let part = self.part("", |_, terms, _| Ok(terms.known_displacement(&soft)))?;
        Ok(vec![part])
    }
}
