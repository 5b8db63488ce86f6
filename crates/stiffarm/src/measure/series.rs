//! Raw readings sorted by posture, reflector and load state, with their means:
//! what screening and reduction both start from. Then, for one reflector in one
//! posture, the drift between the states without load, and pairs of reference
//! and load.

use crate::model::measurement::{PostureReadings, Reading, ReadingTable, ReadingTarget, ReferencePart, Role};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// What places the readings of a posture one after the other.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Clock {
    /// The times of the readings \[s\].
    Time,
    /// The order of the load states: one step from a state to the next.
    Order,
}

/// One reading on the posture's clock.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sample {
    pub clock: f64,
    pub position: Vector3<f64>,
}

/// The readings of one reflector in one load state.
#[derive(Debug, Clone)]
pub(super) struct StateSamples<'a> {
    /// Number of the state in its posture.
    pub state: usize,
    pub role: Role,
    /// As they stand in the table.
    pub readings: Vec<&'a Reading>,
    /// By clock and position, so that no sum depends on the order of rows.
    pub samples: Vec<Sample>,
    pub clock: f64,
    pub position: Vector3<f64>,
}

impl<'a> StateSamples<'a> {
    fn new(state: usize, role: Role, readings: Vec<&'a Reading>, mut samples: Vec<Sample>) -> Self {
        samples.sort_by(|a, b| {
            let by = |i: usize| a.position[i].total_cmp(&b.position[i]);
            let clock = a.clock.total_cmp(&b.clock);
            clock.then(by(0)).then(by(1)).then(by(2))
        });
        let (clock, position) = mean(samples.iter());
        StateSamples { state, role, readings, samples, clock, position }
    }

    pub(super) fn count(&self) -> usize {
        self.samples.len()
    }
}

/// Mean clock and position.
fn mean<'a>(samples: impl Iterator<Item = &'a Sample> + Clone) -> (f64, Vector3<f64>) {
    let count = samples.clone().count() as f64;
    let clock = samples.clone().map(|s| s.clock).sum::<f64>() / count;
    (clock, samples.map(|s| s.position).sum::<Vector3<f64>>() / count)
}

/// A straight line on the clock through readings that should agree.
#[derive(Debug, Clone, Copy)]
pub(super) struct Line {
    /// Motion per unit of the clock, tracker axes.
    pub rate: Vector3<f64>,
    /// Mean clock of the readings behind it.
    pub clock: f64,
    /// Sum of squared distances from the mean clock: a reading's variance over
    /// it is the variance of each component of `rate`.
    pub spread: f64,
    /// First and last reading behind it.
    pub span: [f64; 2],
    /// Role of the states behind it.
    pub role: Role,
}

impl Line {
    fn through(states: &[StateSamples<'_>], role: Role) -> Option<Self> {
        let of_role = states.iter().filter(|s| s.role == role);
        let samples = of_role.flat_map(|s| &s.samples);
        let (low, high) = samples
            .clone()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), s| (low.min(s.clock), high.max(s.clock)));
        if low >= high {
            return None;
        }
        let (clock, position) = mean(samples.clone());
        let mut spread = 0.0;
        let mut product = Vector3::zeros();
        for sample in samples {
            let from_mean = sample.clock - clock;
            spread += from_mean * from_mean;
            product += (sample.position - position) * from_mean;
        }
        (spread > 0.0).then(|| Line { rate: product / spread, clock, spread, span: [low, high], role })
    }

    pub(super) fn covers(&self, clock: f64) -> bool {
        self.span[0] <= clock && clock <= self.span[1]
    }
}

/// Reference and loaded position of one reflector, the drift between removed.
#[derive(Debug, Clone)]
pub(super) struct Pair {
    pub reference: Vector3<f64>,
    pub loaded: Vector3<f64>,
    /// Loaded readings.
    pub readings: u32,
    /// What the readings of each state count in the reference at the clock of
    /// the loaded readings; weights are 1 together.
    pub parts: Vec<ReferencePart>,
    /// Clock of the loaded readings.
    pub clock: f64,
}

impl Pair {
    /// Variance of the reference, in variances of one reading.
    pub(super) fn variance_of_reference(&self) -> f64 {
        ReferencePart::shared(&self.parts, &self.parts)
    }
}

/// One reflector in one posture.
#[derive(Debug, Clone)]
pub(super) struct Series<'a> {
    /// The states in which it was read.
    pub states: Vec<StateSamples<'a>>,
    /// Drift, where states without load lie before and after a loaded one.
    pub line: Option<Line>,
}

impl<'a> Series<'a> {
    /// Collects the readings of `target`; `clocks` has one entry per state and reading.
    pub(super) fn new(
        target: ReadingTarget,
        posture: &'a PostureReadings,
        clocks: &[Vec<f64>],
        reference: Role,
    ) -> Self {
        let mut states = Vec::new();
        for (number, state) in posture.states.iter().enumerate() {
            let clocked = state.readings.iter().zip(&clocks[number]);
            let (readings, samples): (Vec<&Reading>, Vec<Sample>) = clocked
                .filter(|(reading, _)| reading.target == target)
                .map(|(reading, clock)| {
                    let sample = Sample { clock: *clock, position: reading.position };
                    (reading, sample)
                })
                .unzip();
            if !samples.is_empty() {
                states.push(StateSamples::new(number, Role::of(&state.state), readings, samples));
            }
        }
        // Unloaded readings may differ by lost motion, which a preload takes up:
        // they speak of drift only where the preload does not.
        let line =
            [reference, Role::Unloaded].into_iter().filter_map(|role| Line::through(&states, role)).find(|line| {
                let mut loaded = states.iter().filter(|s| s.role == Role::Loaded);
                loaded.any(|s| line.covers(s.clock))
            });
        Series { states, line }
    }

    /// The readings in one state.
    pub(super) fn state(&self, number: usize) -> Option<&StateSamples<'a>> {
        self.states.iter().find(|s| s.state == number)
    }

    /// The loaded state `number` against the states of the role `reference`:
    /// against all of them along the drift's line where it covers the loaded
    /// readings, else against the state nearest on the clock.
    pub(super) fn pair(&self, number: usize, reference: Role) -> Option<Pair> {
        let loaded = self.state(number)?;
        let references: Vec<&StateSamples<'_>> =
            self.states.iter().filter(|s| s.role == reference && s.state != number).collect();
        let count = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
        let Some(line) = self.line.filter(|line| line.covers(loaded.clock)) else {
            let distance = |s: &StateSamples<'_>| (s.clock - loaded.clock).abs();
            let nearest = references.into_iter().min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
            return Some(Pair {
                reference: nearest.position,
                loaded: loaded.position,
                readings: count(loaded.count()),
                parts: vec![ReferencePart {
                    readings: count(nearest.count()),
                    ..ReferencePart::reading(count(nearest.state))
                }],
                clock: loaded.clock,
            });
        };
        if references.is_empty() {
            return None;
        }
        let samples = references.iter().flat_map(|s| &s.samples);
        let (clock, position) = mean(samples.clone());
        let away = loaded.clock - clock;
        let total = samples.count() as f64;
        // The mean of the references, and the line's slope from there.
        let part = |s: &StateSamples<'_>| {
            let of_mean = if s.role == reference && s.state != number { s.count() as f64 / total } else { 0.0 };
            let per_clock = if s.role == line.role { away / line.spread } else { 0.0 };
            let from_line = s.samples.iter().map(|x| x.clock - line.clock);
            let within = s.samples.iter().map(|x| (x.clock - s.clock).powi(2));
            ReferencePart {
                state: count(s.state),
                weight: of_mean + per_clock * from_line.sum::<f64>(),
                slope: per_clock * within.sum::<f64>().sqrt(),
                readings: count(s.count()),
            }
        };
        let parts = self.states.iter().map(part);
        let parts = parts.filter(|part| part.weight != 0.0 || part.slope != 0.0);
        Some(Pair {
            // Both at clock zero, so that reflectors read at different times
            // keep their distances.
            reference: position - line.rate * clock,
            loaded: loaded.position - line.rate * loaded.clock,
            readings: count(loaded.count()),
            parts: parts.collect(),
            clock: loaded.clock,
        })
    }
}

/// All reflectors of one posture.
#[derive(Debug, Clone)]
pub(super) struct PostureSeries<'a> {
    pub readings: &'a PostureReadings,
    pub clock: Clock,
    /// Time of clock zero \[s\].
    pub start: f64,
    /// Role of the states against which differences are taken.
    pub reference: Role,
    /// Controller angles of the reference \[rad\].
    pub q: Vec<f64>,
    /// Mean clock of each state; `None` for a state without readings.
    pub state_clocks: Vec<Option<f64>>,
    /// The measuring points, by index.
    pub points: Vec<(usize, Series<'a>)>,
    /// The base reflectors, by name.
    pub base: Vec<(String, Series<'a>)>,
}

impl<'a> PostureSeries<'a> {
    /// Sorts the readings of a posture by reflector and state.
    pub(super) fn new(posture: &'a PostureReadings) -> Self {
        let (clock, start, clocks) = clocks(posture);
        let has = |role| {
            let mut states = posture.states.iter();
            states.any(|s| Role::of(&s.state) == role && !s.readings.is_empty())
        };
        let reference = if has(Role::Preload) { Role::Preload } else { Role::Unloaded };
        let mut points = std::collections::BTreeSet::new();
        let mut base = std::collections::BTreeSet::new();
        for reading in posture.states.iter().flat_map(|s| &s.readings) {
            match &reading.target {
                ReadingTarget::Point(index) => points.insert(*index),
                ReadingTarget::Base(name) => base.insert(name.clone()),
            };
        }
        let series = |target| Series::new(target, posture, &clocks, reference);
        PostureSeries {
            readings: posture,
            clock,
            start,
            reference,
            q: mean_angles(posture, reference).unwrap_or_else(|| posture.posture.q.clone()),
            state_clocks: clocks
                .iter()
                .map(|c| (!c.is_empty()).then(|| c.iter().sum::<f64>() / c.len() as f64))
                .collect(),
            points: points.into_iter().map(|index| (index, series(ReadingTarget::Point(index)))).collect(),
            base: base.into_iter().map(|name| (name.clone(), series(ReadingTarget::Base(name)))).collect(),
        }
    }

    /// The postures of a table.
    pub(super) fn all(table: &'a ReadingTable) -> Vec<Self> {
        table.postures.iter().map(PostureSeries::new).collect()
    }

    /// The same with differences taken against no load: a preload is then a load like others. Drift stays what it is.
    pub(super) fn against_unloaded(&self) -> Self {
        PostureSeries { reference: Role::Unloaded, ..self.clone() }
    }

    /// Numbers of the states that have displacements against the reference, in the order taken.
    pub(super) fn loaded(&self) -> impl Iterator<Item = usize> + '_ {
        let roles = [Role::Preload, Role::Loaded];
        let states = self.readings.states.iter().enumerate();
        states
            .filter(move |(_, s)| {
                let role = Role::of(&s.state);
                role != self.reference && roles.contains(&role)
            })
            .filter(|(i, _)| self.state_clocks[*i].is_some())
            .map(|(i, _)| i)
    }

    /// The readings of measuring point `index`.
    pub(super) fn point(&self, index: usize) -> Option<&Series<'a>> {
        let place = self.points.binary_search_by_key(&index, |(i, _)| *i);
        place.ok().map(|place| &self.points[place].1)
    }

    /// Name of the posture.
    pub(super) fn name(&self) -> &'a str {
        &self.readings.posture.name
    }

    /// Numbers of the states with the role, in the order taken.
    pub(super) fn states(&self, role: Role) -> impl Iterator<Item = usize> + '_ {
        let states = self.readings.states.iter().enumerate();
        states.filter(move |(i, s)| Role::of(&s.state) == role && self.state_clocks[*i].is_some()).map(|(i, _)| i)
    }
}

/// Mean of the angles recorded in the states of a role.
pub(super) fn mean_angles(posture: &PostureReadings, role: Role) -> Option<Vec<f64>> {
    let recorded: Vec<&Vec<f64>> =
        posture.states.iter().filter(|s| Role::of(&s.state) == role).filter_map(|s| s.angles.as_ref()).collect();
    let first = recorded.first()?;
    // A state with another number of angles is refused later, by name.
    if recorded.iter().any(|q| q.len() != first.len()) {
        return None;
    }
    // Equal angles stay what they are, to the bit.
    let mean = |j: usize| {
        let from_first = recorded.iter().map(|q| q[j] - first[j]);
        first[j] + from_first.sum::<f64>() / recorded.len() as f64
    };
    Some((0..first.len()).map(mean).collect())
}

/// Clock of each reading, state by state, with its kind and the time of its zero.
fn clocks(posture: &PostureReadings) -> (Clock, f64, Vec<Vec<f64>>) {
    let readings = || posture.states.iter().flat_map(|s| &s.readings);
    if readings().all(|r| r.time.is_some()) {
        let times = readings().filter_map(|r| r.time);
        let start = times.fold(f64::INFINITY, f64::min);
        let of_state = |s: &crate::model::measurement::StateReadings| {
            let times = s.readings.iter().filter_map(|r| r.time);
            times.map(|t| t - start).collect()
        };
        let clocks = posture.states.iter().map(of_state).collect();
        return (Clock::Time, start, clocks);
    }
    let states = posture.states.iter().enumerate();
    let clocks = states.map(|(i, s)| vec![i as f64; s.readings.len()]);
    (Clock::Order, 0.0, clocks.collect())
}
