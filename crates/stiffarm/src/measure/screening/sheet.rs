//! The readings as the checks see them: one mean per point and state, repeats
//! that stray set aside, and corrections as faults are found.

use super::{Cause, Suspicion};
use crate::error::{Code, Error, Result};
use crate::measure::series::PostureSeries;
use crate::model::cell::Cell;
use crate::model::load::Wrench;
use crate::model::measurement::{MeasuredPosture, Reading, Role, WrenchColumns};
use crate::model::observation::check_angles;
use crate::numerics::sample::median;
use nalgebra::{Point3, Vector3};
use std::collections::BTreeMap;

/// Standard deviations by which a repeat must lie off to be called stray.
const STRAY_STDS: f64 = 8.0;
/// Smallest distance of a repeat that is worth a word \[m\].
const SMALLEST_STRAY: f64 = 5e-5;
/// Stands in for a noise of zero \[m\].
const SMALLEST_STD: f64 = 1e-7;

/// Mean of the repeats of one point.
#[derive(Debug, Clone, Copy)]
pub(super) struct Mean {
    /// Tracker axes \[m\].
    pub position: Vector3<f64>,
    /// Its standard deviation along each axis, by the cell \[m\].
    pub std: f64,
}

/// One load state of one posture.
#[derive(Debug, Clone)]
pub(super) struct State {
    pub name: String,
    pub role: Role,
    /// Controller angles: of the state where recorded, else of the posture \[rad\].
    pub q: Vec<f64>,
    pub wrench: Option<Wrench>,
    pub load: Option<f64>,
    /// By measuring point.
    pub points: Vec<Option<Mean>>,
    /// Lines of the table, by measuring point.
    pub lines: Vec<Vec<usize>>,
    /// Points one of which strays, where nothing yet tells which.
    pub doubtful: Vec<usize>,
    /// Mean positions of the reflectors on the base, by name, tracker axes \[m\].
    pub base: BTreeMap<String, Vector3<f64>>,
}

/// One posture.
#[derive(Debug, Clone)]
pub(super) struct Posture {
    pub name: String,
    /// The tracker's station, where the table names it.
    pub station: Option<String>,
    pub states: Vec<State>,
}

impl Posture {
    /// States without load; without any, the first one stands in.
    pub fn references(&self) -> Vec<usize> {
        let unloaded = |role| move |s: &usize| self.states[*s].role == role;
        let all = 0..self.states.len();
        for role in [Role::Unloaded, Role::Preload] {
            let references: Vec<usize> = all.clone().filter(unloaded(role)).collect();
            if !references.is_empty() {
                return references;
            }
        }
        all.take(1).collect()
    }
}

/// All readings.
#[derive(Debug, Clone)]
pub(super) struct Sheet {
    pub postures: Vec<Posture>,
    /// Forces come with moments.
    pub has_moments: bool,
}

impl Sheet {
    /// Means of the table's readings; repeats that stray are left out and noted.
    pub fn new(
        cell: &Cell,
        wrench_columns: WrenchColumns,
        series: &[PostureSeries<'_>],
        suspicions: &mut Vec<Suspicion>,
    ) -> Result<Self> {
        let points = cell.setup.tool.point_count();
        let spread = repeat_spread(series);
        let mut postures = Vec::with_capacity(series.len());
        for posture in series {
            let planned = &posture.readings.posture.q;
            check_angles(&cell.setup.robot, planned)?;
            let mut states = Vec::with_capacity(posture.readings.states.len());
            for (s, state) in posture.readings.states.iter().enumerate() {
                let q = state.angles.as_ref().unwrap_or(planned);
                check_angles(&cell.setup.robot, q)?;
                let mut out = State {
                    wrench: state.wrench,
                    load: state.load,
                    base: base_reflectors(posture, s),
                    ..State::new(&state.state, q, points)
                };
                for a in 0..points {
                    let Some(samples) = posture.point(a).and_then(|series| series.state(s)) else {
                        continue;
                    };
                    let name = &cell.setup.tool.measuring_points[a].name;
                    if samples.readings.iter().any(|r| !is_finite(&r.position)) {
                        return Err(Error::new(
                            Code::NotFinite,
                            format!(
                                "A coordinate of point {name} in posture {} is not a finite number.",
                                posture.name()
                            ),
                        ));
                    }
                    let read = Point3::from(samples.readings[0].position);
                    let read = posture.readings.axes.inverse() * read;
                    let std = reading_std(cell, &read.coords)?;
                    let (agreeing, strays) = sift(&samples.readings, std.max(spread));
                    if let Some(distance) = strays.distance {
                        let mut suspicion = Suspicion::new(Cause::StrayRepeat)
                            .posture(posture.name())
                            .state(&state.state)
                            .points([name])
                            .off(distance);
                        suspicion.lines = strays.lines;
                        suspicion.repeat = strays.repeat;
                        suspicions.push(suspicion);
                    }
                    let position = if agreeing.len() == samples.count() {
                        samples.position
                    } else {
                        let sum: Vector3<f64> = agreeing.iter().map(|r| r.position).sum();
                        sum / agreeing.len() as f64
                    };
                    out.points[a] =
                        (!agreeing.is_empty()).then(|| Mean { position, std: std / (agreeing.len() as f64).sqrt() });
                    out.lines[a] = agreeing.iter().map(|r| r.line).filter(|l| *l > 0).collect();
                }
                states.push(out);
            }
            postures.push(Posture {
                name: posture.name().to_string(),
                station: posture.readings.station.clone(),
                states,
            });
        }
        Ok(Sheet { postures, has_moments: wrench_columns == WrenchColumns::ForceAndMoment })
    }

    /// Lines of the readings that a suspicion names by posture and point. Angles stand in all lines of a posture,
    /// or in another table.
    pub fn add_lines(&self, cell: &Cell, suspicion: &mut Suspicion) {
        let Suspicion { postures, states, points, .. } = &*suspicion;
        if !suspicion.lines.is_empty() || postures.is_empty() || points.is_empty() {
            return;
        }
        let names = &cell.setup.tool.measuring_points;
        let mut lines: Vec<usize> = Vec::new();
        for posture in self.postures.iter().filter(|p| postures.contains(&p.name)) {
            let posture_states = posture.states.iter();
            for state in posture_states.filter(|s| states.is_empty() || states.contains(&s.name)) {
                let of_points = names.iter().zip(&state.lines);
                let of_points = of_points.filter(|(point, _)| points.contains(&point.name));
                lines.extend(of_points.flat_map(|(_, lines)| lines));
            }
        }
        lines.sort_unstable();
        suspicion.lines = lines;
    }

    /// Displacements as positions from the origin, which is where every point is unloaded.
    pub fn of_displacements(cell: &Cell, measured: &[MeasuredPosture]) -> Result<Self> {
        let count = cell.setup.tool.point_count();
        let std = cell.noise.displacement_std().max(SMALLEST_STD);
        let at = |position: Vector3<f64>, readings: usize| Mean {
            position,
            std: std / std::f64::consts::SQRT_2 / (readings.max(1) as f64).sqrt(),
        };
        let mut postures: Vec<Posture> = Vec::new();
        for one in measured {
            let q = &one.posture.q;
            check_angles(&cell.setup.robot, q)?;
            let mut state = State::new(&one.state, q, count);
            state.wrench = one.wrench;
            for a in 0..count {
                let of_point = one.displacements.iter().filter(|d| d.point == a);
                let values: Vec<Vector3<f64>> = of_point.map(|d| d.value).collect();
                if values.iter().any(|v| !is_finite(v)) {
                    let message = format!("A displacement of posture {} is not a finite number.", one.posture.name);
                    return Err(Error::new(Code::NotFinite, message));
                }
                let mean = values.iter().sum::<Vector3<f64>>() / values.len().max(1) as f64;
                state.points[a] = (!values.is_empty()).then(|| at(mean, values.len()));
            }
            // Angles of a posture may differ from state to state.
            let namesake = postures.iter_mut().find(|p| p.name == one.posture.name);
            match namesake.filter(|p| p.states[0].q == *q) {
                Some(posture) => posture.states.push(state),
                None => {
                    let mut unloaded = State::new("unloaded", q, count);
                    unloaded.points.fill(Some(at(Vector3::zeros(), 1)));
                    postures.push(Posture {
                        name: one.posture.name.clone(),
                        station: None,
                        states: vec![unloaded, state],
                    });
                }
            }
        }
        Ok(Sheet {
            postures,
            // A wrench of a table of displacements is whole: it is about the loading point.
            has_moments: true,
        })
    }

    /// Posture and state of every load state with a reading of a measuring point.
    pub fn states(&self) -> Vec<(usize, usize)> {
        let mut out = Vec::new();
        for (p, posture) in self.postures.iter().enumerate() {
            for (s, state) in posture.states.iter().enumerate() {
                if state.points.iter().any(Option::is_some) {
                    out.push((p, s));
                }
            }
        }
        out
    }

    /// One load state.
    pub fn at(&self, (p, s): (usize, usize)) -> &State {
        &self.postures[p].states[s]
    }

    /// One load state, to correct it.
    pub fn at_mut(&mut self, (p, s): (usize, usize)) -> &mut State {
        &mut self.postures[p].states[s]
    }

    /// Exchanges all that was read in two states.
    pub fn exchange(&mut self, one: (usize, usize), other: (usize, usize)) {
        let (mine, theirs) = (self.at(one).clone(), self.at(other).clone());
        for (at, from) in [(one, theirs), (other, mine)] {
            let state = self.at_mut(at);
            let (name, role, q) = (state.name.clone(), state.role, state.q.clone());
            *state = State { name, role, q, ..from };
        }
    }

    /// The largest angle without its sign \[rad\].
    pub fn largest_angle(&self) -> f64 {
        let states = self.postures.iter().flat_map(|p| &p.states);
        let angles = states.flat_map(|s| &s.q);
        angles.fold(0.0_f64, |most, q| most.max(q.abs()))
    }

    /// Typical standard deviation of a mean \[m\].
    pub fn typical_std(&self) -> f64 {
        let all: Vec<f64> =
            self.states().into_iter().flat_map(|at| self.at(at).points.iter().flatten().map(|m| m.std)).collect();
        if all.is_empty() { SMALLEST_STD } else { median(&all) }
    }
}

impl State {
    /// A state without readings.
    fn new(name: &str, q: &[f64], points: usize) -> Self {
        State {
            name: name.to_string(),
            role: Role::of(name),
            q: q.to_vec(),
            wrench: None,
            load: None,
            points: vec![None; points],
            lines: vec![Vec::new(); points],
            doubtful: Vec::new(),
            base: BTreeMap::new(),
        }
    }

    /// Every position of the state, those of base reflectors included.
    pub fn each_position(&mut self, mut change: impl FnMut(&mut Vector3<f64>)) {
        for mean in self.points.iter_mut().flatten() {
            change(&mut mean.position);
        }
        self.base.values_mut().for_each(change);
    }

    /// Puts the readings at the points where they were really taken.
    pub fn relabel(&mut self, order: &[usize]) {
        let (points, lines) = (self.points.clone(), self.lines.clone());
        for (a, to) in order.iter().enumerate() {
            self.points[*to] = points[a];
            self.lines[*to].clone_from(&lines[a]);
        }
    }

    /// The largest standard deviation of its means \[m\].
    pub fn std(&self) -> f64 {
        let means = self.points.iter().flatten();
        means.map(|m| m.std).fold(0.0, f64::max)
    }

    /// Indices of the points that were read.
    pub fn seen(&self) -> Vec<usize> {
        (0..self.points.len()).filter(|a| self.points[*a].is_some()).collect()
    }
}

fn is_finite(position: &Vector3<f64>) -> bool {
    position.iter().all(|v| v.is_finite())
}

/// Mean position of each reflector on the base in state `s`; one that is not
/// finite is left out, the reduction refuses it.
fn base_reflectors(posture: &PostureSeries<'_>, s: usize) -> BTreeMap<String, Vector3<f64>> {
    let means = posture.base.iter().filter_map(|(name, series)| {
        let position = series.state(s)?.position;
        is_finite(&position).then(|| (name.clone(), position))
    });
    means.collect()
}

/// Standard deviation of one reading along each axis \[m\].
fn reading_std(cell: &Cell, position: &Vector3<f64>) -> Result<f64> {
    let std = match &cell.tracker.accuracy {
        Some(accuracy) => (accuracy.covariance(position)?.trace() / 3.0).sqrt(),
        None => cell.noise.reading_variance.sqrt(),
    };
    Ok(std.max(SMALLEST_STD))
}

/// What the repeats themselves scatter along each axis, resistant to a few
/// that stray \[m\]; zero without repeats.
fn repeat_spread(series: &[PostureSeries<'_>]) -> f64 {
    let mut deviations = Vec::new();
    let points = series.iter().flat_map(|posture| &posture.points);
    for samples in points.flat_map(|(_, series)| &series.states) {
        // Differences of neighbours: slow drift does not count.
        for pair in samples.readings.windows(2) {
            let difference = pair[1].position - pair[0].position;
            deviations.extend(difference.iter().map(|v| v.abs()));
        }
    }
    match deviations.len() {
        0..12 => 0.0,
        // Median of |N(0, 1)| is 0.6745.
        _ => median(&deviations) / 0.6745 / std::f64::consts::SQRT_2,
    }
}

/// Which repeats stray.
#[derive(Default)]
struct StrayRepeats {
    lines: Vec<usize>,
    /// Number of the repeat, counted from 1, where it is clear which one.
    repeat: Option<usize>,
    distance: Option<f64>,
}

/// Keeps the repeats that agree. Of two that disagree neither is kept.
fn sift<'a>(readings: &[&'a Reading], std: f64) -> (Vec<&'a Reading>, StrayRepeats) {
    let limit = (STRAY_STDS * std).max(SMALLEST_STRAY);
    let lines = |of: &[&Reading]| of.iter().map(|r| r.line).filter(|l| *l > 0).collect();
    if let [first, second] = readings {
        let distance = (first.position - second.position).norm();
        if distance > limit * std::f64::consts::SQRT_2 {
            let strays = StrayRepeats { lines: lines(readings), repeat: None, distance: Some(distance) };
            return (Vec::new(), strays);
        }
    }
    if readings.len() < 3 {
        return (readings.to_vec(), StrayRepeats::default());
    }
    let middle = Vector3::from_fn(|i, _| median(&readings.iter().map(|r| r.position[i]).collect::<Vec<f64>>()));
    let off = |r: &Reading| (r.position - middle).norm();
    let strays: Vec<&Reading> = readings.iter().copied().filter(|r| off(r) > limit).collect();
    let worst = strays.iter().map(|r| off(r)).reduce(f64::max);
    let agreeing = readings.iter().copied().filter(|r| off(r) <= limit).collect();
    let repeat = readings.iter().position(|r| off(r) > limit).map(|i| i + 1);
    let strays = StrayRepeats { lines: lines(&strays), repeat: repeat.filter(|_| strays.len() == 1), distance: worst };
    (agreeing, strays)
}
