//! Joint moves: whether one touches anything, and ways around what it would touch.
//!
//! No point of arm and tool moves farther than each joint's turn times that joint's reach. So a posture
//! with room r proves a stretch of a move free on both sides of it, and a move is halved until every
//! stretch is proved or a posture without room is found. Nothing is left between samples.

use super::search::connect;
use crate::error::Result;
use crate::model::cell::{Cell, Limits, PostureMargins};
use crate::model::load::Load;
use crate::model::posture::Posture;
use sobol_burley::sample;
use std::collections::VecDeque;
use std::f64::consts::PI;

/// What a move may lack of floor and keep-out cylinder \[m\]: postures may lie on them, and a straight
/// joint move between two such postures dips a little.
const DIP: f64 = 1e-3;
/// Stretches this short are not halved further \[m\].
const FINEST: f64 = 1e-4;
/// Most postures that are looked at for one move.
const MOST_LOOKS: usize = 20_000;
/// Distances are told up to here \[m\].
const FAR: f64 = 0.5;
/// Spread postures that are tried as via postures.
const SPREAD: u32 = 192;

/// The cell as moves see it: shapes keep half their distance, floor and keep-out cylinder are
/// respected, and the rope where it stays on. What asks for a good reading does not count.
pub(super) fn on_the_way(cell: &Cell) -> Cell {
    let stays_on = cell.route.load_stays_on;
    let mut way = cell.clone();
    way.scene = cell.scene.on_the_way(stays_on);
    way.limits = Limits {
        floor: cell.limits.floor.map(|z| z - DIP),
        keep_out_radius: cell.limits.keep_out_radius.map(|r| r - DIP),
        ..Limits::default()
    };
    if !stays_on {
        // Without a rope: its limits do not count, and no wrench is needed.
        way.setup.load = Load::Measured;
    }
    way.validation = Vec::<Posture>::new();
    way
}

/// Looks at joint moves of a cell made by [`on_the_way`].
pub(super) struct Ways<'a> {
    cell: &'a Cell,
    margins: PostureMargins<'a>,
    values: Vec<f64>,
    /// Most that any point moves by a turn of each serial joint \[m/rad\].
    reach: Vec<f64>,
    /// Speeds that joint turns are weighed by \[rad/s\].
    pub speeds: Vec<f64>,
    seed: u64,
}

/// A way from one posture to another.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Way {
    /// Via postures, controller angles \[rad\].
    pub via: Vec<Vec<f64>>,
    /// Time at full speed \[s\].
    pub seconds: f64,
}

impl<'a> Ways<'a> {
    pub fn new(way_cell: &'a Cell, speeds: Vec<f64>, seed: u64) -> Result<Self> {
        let margins = way_cell.posture_margins()?;
        // Both ends of the rope's distances move.
        let both = if way_cell.route.load_stays_on {
            2.0
        } else {
            1.0
        };
        let reach = way_cell.scene.reach(&way_cell.setup);
        Ok(Ways {
            values: vec![0.0; margins.count()],
            margins,
            reach: reach.iter().map(|r| r * both).collect(),
            cell: way_cell,
            speeds,
            seed,
        })
    }

    /// True where nothing is there to be touched.
    pub fn nothing_to_touch(&self) -> bool {
        self.values.is_empty()
    }

    /// Time of a joint move at full speed \[s\]: all joints start and stop together.
    pub fn seconds(&self, from: &[f64], to: &[f64]) -> f64 {
        let turns = from.iter().zip(to).zip(&self.speeds);
        turns.fold(0.0, |most: f64, ((a, b), v)| most.max((a - b).abs() / v))
    }

    /// Time along several postures \[s\].
    pub fn seconds_along<'q>(&self, postures: impl IntoIterator<Item = &'q Vec<f64>>) -> f64 {
        let postures: Vec<&Vec<f64>> = postures.into_iter().collect();
        postures
            .windows(2)
            .map(|pair| self.seconds(pair[0], pair[1]))
            .sum()
    }

    /// Whether a posture touches nothing.
    pub fn is_clear(&mut self, q: &[f64]) -> Result<bool> {
        Ok(self.room(q, 0.0)? >= 0.0)
    }

    /// The room of a posture \[m\], or a part of it that is `enough`; negative where it touches.
    fn room(&mut self, q: &[f64], enough: f64) -> Result<f64> {
        self.margins
            .evaluate(q, enough.min(FAR), &mut self.values, None)?;
        Ok(self
            .values
            .iter()
            .fold(f64::INFINITY, |least, v| least.min(*v)))
    }

    /// Farthest that any point may move from one posture to another \[m\].
    fn travel(&self, from: &[f64], to: &[f64]) -> f64 {
        let robot = &self.cell.setup.robot;
        let (a, b) = (robot.serial_angles(from), robot.serial_angles(to));
        let turns = a.iter().zip(&b).zip(&self.reach);
        turns.map(|((a, b), reach)| (a - b).abs() * reach).sum()
    }

    /// Whether the joint move touches nothing.
    pub fn is_free(&mut self, from: &[f64], to: &[f64]) -> Result<bool> {
        if self.nothing_to_touch() {
            return Ok(true);
        }
        let travel = self.travel(from, to);
        let mut open = VecDeque::from([(0.0_f64, 1.0_f64)]);
        let mut looks = 0;
        // Wide stretches first: a move that touches something mostly does so in the middle of one.
        while let Some((first, last)) = open.pop_front() {
            looks += 1;
            if looks > MOST_LOOKS {
                return Ok(false);
            }
            let middle = 0.5 * (first + last);
            let half = 0.5 * travel * (last - first);
            let room = self.room(&between(from, to, middle), half)?;
            if room < 0.0 {
                return Ok(false);
            }
            if room < half && half > FINEST {
                open.push_back((first, middle));
                open.push_back((middle, last));
            }
        }
        Ok(true)
    }

    /// The shortest way that was found, `None` where none was: the joint move itself, else over a via
    /// posture, else, where that is wanted, one that is searched for.
    pub fn way(&mut self, from: &[f64], to: &[f64], search: bool) -> Result<Option<Way>> {
        if self.is_free(from, to)? {
            return Ok(Some(self.along(from, to, Vec::new())));
        }
        if !self.is_clear(from)? || !self.is_clear(to)? {
            return Ok(None);
        }
        let over_one = self.over_one(from, to)?;
        if over_one.is_some() || !search {
            return Ok(over_one);
        }
        let bounds = self.machine_bounds(from, to);
        let found = connect(self, from, to, &bounds, self.seed)?;
        Ok(found.map(|via| self.along(from, to, via)))
    }

    fn along(&self, from: &[f64], to: &[f64], via: Vec<Vec<f64>>) -> Way {
        let (from, to) = (from.to_vec(), to.to_vec());
        let seconds = self.seconds_along([&from].into_iter().chain(&via).chain([&to]));
        Way { via, seconds }
    }

    /// The shortest way over one via posture: some joints first, then the others, or over one of
    /// postures that are spread over the bounds.
    fn over_one(&mut self, from: &[f64], to: &[f64]) -> Result<Option<Way>> {
        let n = from.len();
        let moving: Vec<usize> = (0..n).filter(|j| from[*j] != to[*j]).collect();
        let mut vias: Vec<Vec<f64>> = Vec::new();
        let few = moving.len().min(8);
        for choice in 1_u32..(1 << few) - 1 {
            let mut via = from.to_vec();
            for (bit, j) in moving.iter().enumerate().take(few) {
                if choice >> bit & 1 == 1 {
                    via[*j] = to[*j];
                }
            }
            vias.push(via);
        }
        let bounds = self.bounds(from, to);
        for i in 0..SPREAD {
            let joints = (0..).zip(&bounds);
            vias.push(
                joints
                    .map(|(j, b)| b[0] + (b[1] - b[0]) * f64::from(sample(i, j % 256, j / 256)))
                    .collect(),
            );
        }
        vias.extend(self.cell.route.start.clone());
        let mut timed: Vec<(f64, Vec<f64>)> = vias
            .into_iter()
            .map(|via| (self.seconds(from, &via) + self.seconds(&via, to), via))
            .collect();
        timed.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (_, via) in timed {
            // Typed like every other posture.
            let via = super::rounding::nearest(&via, super::VIA_STEP_DEG);
            if self.is_clear(&via)? && self.is_free(from, &via)? && self.is_free(&via, to)? {
                return Ok(Some(self.along(from, to, vec![via])));
            }
        }
        Ok(None)
    }

    /// Where a way is searched for: within the machine's limits, half a turn about the ends at most.
    fn machine_bounds(&self, from: &[f64], to: &[f64]) -> Vec<[f64; 2]> {
        let joints = self.cell.setup.robot.joints().iter();
        let joints = joints.zip(from.iter().zip(to));
        joints
            .map(|(joint, (from, to))| {
                let [low, high] = joint.limits;
                [
                    low.max(from.min(*to) - PI).min(from.min(*to)),
                    high.min(from.max(*to) + PI).max(from.max(*to)),
                ]
            })
            .collect()
    }

    /// Where via postures are tried: the cell's bounds, widened to hold both ends.
    fn bounds(&self, from: &[f64], to: &[f64]) -> Vec<[f64; 2]> {
        let ends = from.iter().zip(to);
        let bounds = self.cell.bounds.iter().zip(ends);
        bounds
            .map(|(b, (from, to))| [b[0].min(*from).min(*to), b[1].max(*from).max(*to)])
            .collect()
    }
}

/// The posture at a share of a joint move.
pub(super) fn between(from: &[f64], to: &[f64], share: f64) -> Vec<f64> {
    let joints = from.iter().zip(to);
    joints.map(|(a, b)| a + (b - a) * share).collect()
}
