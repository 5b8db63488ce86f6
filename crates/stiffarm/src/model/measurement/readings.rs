//! Raw readings: positions as the tracker gave them, state by state.

use crate::findings::Finding;
use crate::model::load::Wrench;
use crate::model::posture::Posture;
use nalgebra::{Isometry3, Vector3};

/// What a reading was taken of.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub enum ReadingTarget {
    /// A measuring point, by its index in the cell's tool.
    Point(usize),
    /// A reflector on the robot's base, by its name (`base`, `base-2`, …).
    Base(String),
}

impl ReadingTarget {
    /// True for a name that is kept for reflectors on the robot's base: `base`,
    /// `base-2`, `base 3`, `base_left`, in any case.
    pub fn is_base_name(name: &str) -> bool {
        let (word, rest) = name.split_at_checked(4).unwrap_or((name, ""));
        word.eq_ignore_ascii_case("base") && (rest.is_empty() || rest.starts_with(['-', '_', ' ']))
    }
}

/// One position of one reflector.
#[derive(Debug, Clone, PartialEq)]
pub struct Reading {
    /// Which reflector.
    pub target: ReadingTarget,
    /// Its position, tracker axes \[m\].
    pub position: Vector3<f64>,
    /// When \[s\], where recorded.
    pub time: Option<f64>,
    /// Expanded uncertainty of each coordinate as the tracker states it: 95 %, tracker axes \[m\].
    pub expanded: Option<Vector3<f64>>,
    /// Temperature of the air \[°C\], where recorded.
    pub temperature: Option<f64>,
    /// Line of the table it stood on, counted from 1; 0 where there is none.
    pub line: usize,
}

impl Reading {
    /// A position of a reflector, of which nothing else is known.
    pub fn new(target: ReadingTarget, position: Vector3<f64>) -> Self {
        Reading { target, position, time: None, expanded: None, temperature: None, line: 0 }
    }

    /// All its numbers, which must be finite.
    pub(crate) fn numbers(&self) -> impl Iterator<Item = f64> {
        let vectors = [Some(self.position), self.expanded].into_iter().flatten();
        let vectors = vectors.flat_map(|v| [v.x, v.y, v.z]);
        vectors.chain([self.time, self.temperature].into_iter().flatten())
    }
}

/// What a load state is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// No load: the robot and its tool alone (`unloaded`, `unloaded-2`, …).
    Unloaded,
    /// A light load that takes up lost motion (`preload`, `preload-2`, …):
    /// where there is one, differences are taken against it.
    Preload,
    /// A load (any other name).
    Loaded,
}

impl Role {
    /// The role that a state's name says, in any case.
    pub fn of(state: &str) -> Self {
        let state = state.to_lowercase();
        let is = |word: &str| {
            state
                .strip_prefix(word)
                .is_some_and(|rest| rest.is_empty() || rest.starts_with(['-', '_', ' ']) || rest.parse::<u32>().is_ok())
        };
        if is("unloaded") {
            Role::Unloaded
        } else if is("preload") || is("preloaded") {
            Role::Preload
        } else {
            Role::Loaded
        }
    }
}

/// All readings of one posture in one load state.
#[derive(Debug, Clone, PartialEq)]
pub struct StateReadings {
    /// Name of the state.
    pub state: String,
    /// Controller angles in this state \[rad\], where recorded.
    pub angles: Option<Vec<f64>>,
    /// Force and moment as the table has them \[N, N·m\]: as the cell's sensor
    /// reported them, or without a sensor the wrench on the robot at the
    /// loading point in base axes.
    pub wrench: Option<Wrench>,
    /// Force of the cell's rope or weight in this state \[N\], where recorded.
    pub load: Option<f64>,
    /// The readings, repeats included, in the order taken.
    pub readings: Vec<Reading>,
}

/// All readings of one posture.
#[derive(Debug, Clone, PartialEq)]
pub struct PostureReadings {
    /// Name and planned controller angles \[rad\].
    pub posture: Posture,
    /// Its load states, in the order taken.
    pub states: Vec<StateReadings>,
    /// The tracker's station from which all of them were read, where the table names it.
    pub station: Option<String>,
    /// Turns the axes in which that station's tracker read into those of the positions: identity, but where the
    /// readings of several stations were put into the axes of one.
    pub axes: Isometry3<f64>,
}

/// Which columns of force the table had.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WrenchColumns {
    /// None: the cell's load gives the wrench.
    None,
    /// Forces only.
    Force,
    /// Forces and moments.
    ForceAndMoment,
}

/// A table of raw readings.
#[derive(Debug, Clone, PartialEq)]
pub struct ReadingTable {
    /// The postures, in the order in which they first appear.
    pub postures: Vec<PostureReadings>,
    /// Which columns of force there were.
    pub wrench_columns: WrenchColumns,
    /// Rows that name a reading and have no position: not measured yet, posture by posture.
    pub pending: Vec<PendingReading>,
    /// Postures that give no displacement as long as their pending rows are empty: read
    /// unloaded and not yet loaded, or the other way round.
    pub incomplete: Vec<PostureReadings>,
    /// What was taken for granted when the table was read.
    pub remarks: Vec<Finding>,
}

/// A reading that is not taken yet.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PendingReading {
    /// Name of the posture.
    pub posture: String,
    /// Name of the load state.
    pub state: String,
    /// Name of the measuring point, or of the reflector on the base.
    pub point: String,
    /// Name of the tracker's station, where the table names it.
    pub station: Option<String>,
    /// Line of the table it stands on, counted from 1.
    pub line: usize,
}

impl ReadingTable {
    /// The stations from which the postures were read, in the order in which they first appear; none where the table
    /// names none.
    pub fn stations(&self) -> Vec<&str> {
        let mut out: Vec<&str> = Vec::new();
        for name in self.postures.iter().filter_map(|p| p.station.as_deref()) {
            if !out.contains(&name) {
                out.push(name);
            }
        }
        out
    }

    /// The table in the order of its times, where every reading has one: the rows may then stand in any order.
    pub fn in_order_of_time(mut self) -> Self {
        let mut states = self.postures.iter().flat_map(|posture| &posture.states);
        let is_timed = states.all(|state| state.readings.iter().all(|one| one.time.is_some()));
        if !is_timed {
            return self;
        }
        let time = |reading: &Reading| reading.time.unwrap_or_default();
        for posture in &mut self.postures {
            for state in &mut posture.states {
                state.readings.sort_by(|a, b| {
                    let by = |i: usize| a.position[i].total_cmp(&b.position[i]);
                    let order = time(a).total_cmp(&time(b)).then(a.target.cmp(&b.target));
                    order.then(by(0)).then(by(1)).then(by(2))
                });
            }
            let mean = |state: &StateReadings| {
                let times = state.readings.iter().map(time);
                times.sum::<f64>() / state.readings.len().max(1) as f64
            };
            posture.states.sort_by(|a, b| mean(a).total_cmp(&mean(b)).then_with(|| a.state.cmp(&b.state)));
        }
        let first = |posture: &PostureReadings| {
            let readings = posture.states.iter().flat_map(|state| &state.readings);
            readings.map(time).fold(f64::INFINITY, f64::min)
        };
        self.postures.sort_by(|a, b| {
            let names = || a.posture.name.cmp(&b.posture.name);
            first(a).total_cmp(&first(b)).then_with(names)
        });
        self
    }

    /// Rows that are filled in.
    pub fn filled(&self) -> usize {
        self.states().map(|(_, state)| state.readings.len()).sum()
    }

    /// True where a posture of this name has a reading.
    pub fn has_readings_of(&self, posture: &str) -> bool {
        self.states().any(|(name, _)| name == posture)
    }

    /// True where a posture of this name has a reading in this state.
    pub fn has_readings_in(&self, posture: &str, state: &str) -> bool {
        self.states().any(|(name, readings)| name == posture && readings.state == state)
    }

    /// The states that have readings, with the names of their postures.
    fn states(&self) -> impl Iterator<Item = (&str, &StateReadings)> {
        let postures = self.postures.iter().chain(&self.incomplete);
        postures.flat_map(|posture| {
            let states = posture.states.iter().filter(|s| !s.readings.is_empty());
            states.map(|state| (posture.posture.name.as_str(), state))
        })
    }
}
