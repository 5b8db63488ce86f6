//! Joint moves: whether one touches anything.
//!
//! No point of arm and tool moves farther than each joint's turn times that joint's reach. So a posture
//! with room r proves a stretch of a move free on both sides of it, and a move is halved until every
//! stretch is proved or a posture without room is found. Nothing is left between samples.

use crate::error::Result;
use crate::model::cell::{Cell, LimitKind, LimitMargin, Limits, PostureMargins, Slopes};
use crate::model::load::Load;
use crate::numerics::control::Control;
use std::collections::VecDeque;

/// What a move may lack of limits on points \[m\]: postures may lie on them, and a straight
/// joint move between two such postures dips a little.
const DIP: f64 = 1e-3;
/// Stretches this short are not halved further \[m\].
const FINEST: f64 = 1e-4;
/// Most postures that are looked at for one move.
const MOST_LOOKS: usize = 20_000;
/// Distances are told up to here \[m\].
const LARGEST_DISTANCE: f64 = 0.5;

/// The cell as moves see it: shapes keep half their distance, limits on points are
/// respected, and the rope where it stays on. What asks for a good reading does not count.
pub(super) fn on_the_way(cell: &Cell) -> Cell {
    let stays_on = cell.route.load_stays_on;
    let mut way = cell.clone();
    way.scene = cell.scene.on_the_way(stays_on);
    way.limits = Limits {
        floor: cell.limits.floor.map(|z| z - DIP),
        keep_out_radius: cell.limits.keep_out_radius.map(|r| r - DIP),
        rope_length: cell.limits.rope_length.filter(|_| stays_on),
        ..cell.limits.clone()
    };
    if !stays_on {
        // Without a rope: its limits do not count, and no wrench is needed.
        way.setup.load = Load::Measured;
    }
    way.validation = Vec::new();
    way
}

/// Looks at joint moves of a cell made by [`on_the_way`].
pub(super) struct Moves<'a> {
    pub cell: &'a Cell,
    margins: PostureMargins<'a>,
    values: Vec<f64>,
    /// The kind of each margin, once it was asked for.
    kinds: Vec<LimitKind>,
    /// What each margin may lack on the move that is looked at \[m\].
    leeway: Vec<f64>,
    /// Most that any point moves by a turn of each serial joint \[m/rad\].
    reach: Vec<f64>,
    /// Speeds that joint turns are weighed by \[rad/s\].
    pub speeds: Vec<f64>,
    pub seed: u64,
    /// Asked at every posture that is looked at.
    pub control: Control<'a>,
}

impl<'a> Moves<'a> {
    pub fn new(way_cell: &'a Cell, speeds: Vec<f64>, seed: u64, control: Control<'a>) -> Result<Self> {
        let margins = way_cell.posture_margins()?;
        // Both ends of the rope's distances move.
        let both = if way_cell.route.load_stays_on { 2.0 } else { 1.0 };
        let reach = way_cell.scene.reach(&way_cell.setup);
        Ok(Moves {
            values: vec![0.0; margins.count()],
            leeway: vec![0.0; margins.count()],
            kinds: Vec::new(),
            margins,
            reach: reach.iter().map(|r| r * both).collect(),
            cell: way_cell,
            speeds,
            seed,
            control,
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
        postures.windows(2).map(|pair| self.seconds(pair[0], pair[1])).sum()
    }

    /// What each margin at a posture is about.
    pub fn named(&mut self, q: &[f64]) -> Result<Vec<LimitMargin>> {
        self.margins.named(q)
    }

    /// The margins at a posture \[m\]; those of `enough` and more may be told too small, but not below it.
    pub fn margins(&mut self, q: &[f64], enough: f64) -> Result<&[f64]> {
        self.control.check()?;
        self.margins.evaluate(q, enough, &mut self.values, Slopes::default())?;
        Ok(&self.values)
    }

    /// What margins may lack on the move that was begun \[m\].
    pub fn leeway(&self) -> &[f64] {
        &self.leeway
    }

    /// Begins to look at ways between two postures.
    pub fn begin(&mut self, from: &[f64], to: &[f64]) -> Result<()> {
        if self.kinds.is_empty() {
            self.kinds = self.margins.named(from)?.iter().map(|m| m.kind).collect();
        }
        let each = self.kinds.iter().zip(&mut self.leeway);
        each.for_each(|(kind, leeway)| *leeway = if kind.keeps_off() { 0.0 } else { DIP });
        for end in [from, to] {
            self.margins(end, LARGEST_DISTANCE)?;
            let each = self.leeway.iter_mut().zip(&self.values).zip(&self.kinds);
            for ((leeway, value), _) in each.filter(|(_, kind)| !kind.keeps_off()) {
                *leeway = leeway.max(-value);
            }
        }
        Ok(())
    }

    /// Whether a posture touches nothing and is where the move that was begun may be.
    pub fn is_clear(&mut self, q: &[f64]) -> Result<bool> {
        Ok(self.room(q, 0.0)? >= 0.0)
    }

    /// The room of a posture \[m\], or a part of it that is `enough`; negative where it touches.
    fn room(&mut self, q: &[f64], enough: f64) -> Result<f64> {
        self.margins(q, enough.min(LARGEST_DISTANCE))?;
        let each = self.values.iter().zip(&self.leeway);
        Ok(each.fold(f64::INFINITY, |least, (v, leeway)| least.min(v + leeway)))
    }

    /// Farthest that any point may move from one posture to another \[m\].
    pub fn travel(&self, from: &[f64], to: &[f64]) -> f64 {
        let robot = &self.cell.setup.robot;
        let turns = robot.each_serial_angle(from).zip(robot.each_serial_angle(to)).zip(&self.reach);
        turns.map(|((a, b), reach)| (a - b).abs() * reach).sum()
    }

    /// Whether the joint move touches nothing.
    pub fn is_free(&mut self, from: &[f64], to: &[f64]) -> Result<bool> {
        self.are_free(&[[from, to]])
    }

    /// Whether none of these joint moves touches anything.
    pub fn are_free(&mut self, moves: &[[&[f64]; 2]]) -> Result<bool> {
        if self.nothing_to_touch() {
            return Ok(true);
        }
        let travels: Vec<f64> = moves.iter().map(|[from, to]| self.travel(from, to)).collect();
        let mut looks = vec![0; moves.len()];
        let mut open: VecDeque<(usize, f64, f64)> = (0..moves.len()).map(|number| (number, 0.0, 1.0)).collect();
        let mut q = vec![0.0; self.cell.bounds.len()];
        // Wide stretches first, of all moves: one that touches something mostly does so in the middle of one.
        while let Some((number, first, last)) = open.pop_front() {
            looks[number] += 1;
            if looks[number] > MOST_LOOKS {
                return Ok(false);
            }
            let [from, to] = moves[number];
            let middle = 0.5 * (first + last);
            let half = 0.5 * travels[number] * (last - first);
            q.iter_mut().zip(each_between(from, to, middle)).for_each(|(q, angle)| *q = angle);
            let room = self.room(&q, half)?;
            if room < 0.0 {
                return Ok(false);
            }
            if room < half && half > FINEST {
                open.push_back((number, first, middle));
                open.push_back((number, middle, last));
            }
        }
        Ok(true)
    }
}

/// The posture at a share of a joint move.
pub(super) fn between(from: &[f64], to: &[f64], share: f64) -> Vec<f64> {
    each_between(from, to, share).collect()
}

/// Its angles, one after the other.
fn each_between(from: &[f64], to: &[f64], share: f64) -> impl Iterator<Item = f64> {
    let joints = from.iter().zip(to);
    joints.map(move |(a, b)| a + (b - a) * share)
}
