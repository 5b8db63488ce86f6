//! Drilling cycles, as LinuxCNC's interpreter drives them (G98 and G99, L, G91; ISO 6983-1 names them).

use super::effect::{Drill, Feeds, Retract};
use super::words::Word;
use super::{Block, State, known_position};
use crate::tool_path::builder::TipTarget;
use crate::tool_path::{FAR_AWAY, FARTHEST, SPAN};
use nalgebra::Vector3;
use stiffarm::error::Result;
use stiffarm::findings::Severity;

/// How near the bottom of a hole a rapid move comes in the next step \[m\].
const NEAR_BOTTOM: f64 = 0.254e-3;

/// More moves than this are no drilling of one block.
const MOST_MOVES: f64 = 100_000.0;

/// What a cycle keeps from block to block, in units of the program.
#[derive(Default)]
pub struct Cycle {
    /// G98 or G99, where the program says so.
    pub back_to_start: Option<bool>,
    /// Where Z was when the cycle began; none behind its end.
    pub start: Option<f64>,
    /// As they were stated last.
    r: Option<f64>,
    z: Option<f64>,
    q: Option<f64>,
    /// P as it stands in the program.
    wait: Option<String>,
}

impl Cycle {
    /// The cycle is over: what it kept is gone.
    pub fn end(&mut self) {
        *self = Cycle { back_to_start: self.back_to_start, ..Cycle::default() };
    }
}

impl State<'_, '_> {
    /// The moves of a block of a drilling cycle.
    pub(super) fn drill(&mut self, block: &Block<'_, '_>, drill: Drill, last: &Word<'_>) -> Result<()> {
        let line = last.place.line_number();
        let wrong = |message: &str| Err(last.place.wrong(message));
        if self.plane != 2 || self.feeds == Feeds::Inverse {
            return wrong(
                "Drilling is read here along Z (G17), and not with a feed that is the inverse of a time (G93).",
            );
        }
        if block.words.iter().any(|word| word.axis().is_some_and(|axis| axis > 2)) {
            return wrong("The tool turns within a drilling cycle.");
        }
        // FANUC counts with K.
        let repeats = block.value(b'L').or(block.value(b'K')).unwrap_or(1.0);
        if repeats < 1.0 || repeats.fract() != 0.0 {
            return wrong("A cycle is repeated a whole number of times, from 1 on.");
        }
        self.cycle.r = block.value(b'R').or(self.cycle.r);
        self.cycle.z = block.value(b'Z').or(self.cycle.z);
        self.cycle.q = block.value(b'Q').or(self.cycle.q);
        if let Some(word) = block.word(b'P') {
            self.cycle.wait = Some(format!("G4 {}", word.text(&block.file.text)));
        }
        let (Some(r), Some(z)) = (self.cycle.r, self.cycle.z) else {
            return wrong("A cycle begins with Z and R.");
        };
        let stated = [b'X', b'Y'].map(|letter| block.value(letter));
        let Some(mut at) = known_position(&self.position) else {
            self.unknown(line);
            let over = [0, 1]
                .map(|axis| stated[axis].map_or(self.position[axis], |value| self.moved(self.position[axis], value)));
            self.position = [over[0], over[1], None];
            return Ok(());
        };
        self.keeps_steps(line);
        let start = *self.cycle.start.get_or_insert(at.z);
        let (r, bottom) = if self.steps { (start + r, start + r + z) } else { (r, z) };
        if r < bottom {
            return wrong("R lies below Z: the cycle would drill upwards.");
        }
        if self.cycle.back_to_start.is_none() && start > r {
            self.builder.remark("cycle-height", "", line, Severity::Caution, || {
                "Neither G98 nor G99 says how far cycles come out ({}): it is read as to R.".to_string()
            });
        }
        let clear = if self.cycle.back_to_start == Some(true) { start.max(r) } else { r };
        let depths = self.depths(drill, (r, bottom), last)?;
        if depths.len() as f64 * repeats > MOST_MOVES {
            return wrong("The cycle has more than 100 000 steps.");
        }
        let mut moves: Vec<(Vector3<f64>, bool)> = Vec::new();
        let mut bottoms = Vec::new();
        let mut to = |at: &mut Vector3<f64>, end: Vector3<f64>, rapid: bool| {
            if *at != end {
                moves.push((end, rapid));
            }
            *at = end;
            moves.len()
        };
        if start < r {
            let up = Vector3::new(at.x, at.y, r);
            to(&mut at, up, true);
        }
        let near = NEAR_BOTTOM / self.builder.form.unit;
        for _ in 0..repeats as usize {
            let next = [0, 1].map(|axis| match stated[axis] {
                Some(step) if self.steps => at[axis] + step,
                Some(value) => value,
                None => at[axis],
            });
            let over = |z: f64| Vector3::new(next[0], next[1], z);
            let height = at.z.max(clear);
            to(&mut at, over(height), true);
            to(&mut at, over(r), true);
            for (count, depth) in depths.iter().enumerate() {
                if count > 0 {
                    to(&mut at, over(r), true);
                    to(&mut at, over(depths[count - 1] + near), true);
                }
                let number = to(&mut at, over(*depth), false);
                if drill.dwells && count + 1 == depths.len() {
                    // None where the tool has not moved at all.
                    bottoms.extend(number.checked_sub(1));
                }
            }
            match drill.out {
                Retract::Rapid => {}
                Retract::FeedToR => _ = to(&mut at, over(r), false),
                Retract::Feed => _ = to(&mut at, over(clear), false),
            }
            to(&mut at, over(clear), true);
        }
        self.drive(block, &moves, &bottoms, last)
    }

    /// How far down each step of a hole goes.
    fn depths(&self, drill: Drill, (r, bottom): (f64, f64), last: &Word<'_>) -> Result<Vec<f64>> {
        if !drill.pecks {
            return Ok(vec![bottom]);
        }
        let Some(step) = self.cycle.q.filter(|step| *step > 0.0) else {
            return Err(last.place.wrong("This cycle goes in steps of Q, which must be above 0."));
        };
        if (r - bottom) / step > MOST_MOVES {
            return Err(last.place.wrong("The cycle has more than 100 000 steps."));
        }
        let mut depths = Vec::new();
        let mut depth = r - step;
        // Counted, as a step below the last digit of the depth would not lead on.
        for _ in 0..=((r - bottom) / step).ceil() as usize {
            if depth <= bottom {
                break;
            }
            depths.push(depth);
            depth -= step;
        }
        depths.push(bottom);
        Ok(depths)
    }

    /// Takes the moves of a cycle.
    fn drive(
        &mut self,
        block: &Block<'_, '_>,
        moves: &[(Vector3<f64>, bool)],
        bottoms: &[usize],
        last: &Word<'_>,
    ) -> Result<()> {
        let (line, unit) = (last.place.line_number(), self.builder.form.unit);
        let first = self.builder.points.len();
        let mut waits = Vec::new();
        let mut before = known_position(&self.position);
        for (number, (end, rapid)) in moves.iter().enumerate() {
            if (end * unit).amax() > FARTHEST {
                return Err(last.place.wrong(FAR_AWAY));
            }
            let place = TipTarget::Axis(end * unit, self.axis);
            if let Some(start) = before.filter(|_| !rapid) {
                let start = place.at(start * unit);
                // The correction is there from the beginning of the feed on, so that the hole is straight.
                if self.builder.points.last().is_some_and(|last| last.rapid) {
                    self.builder.point(line, &start, false);
                }
                if (place.position() - start.position()).norm() > SPAN {
                    self.builder.between(line, &start, &place);
                }
            }
            self.builder.point(line, &place, *rapid);
            if self.cycle.wait.is_some() && bottoms.binary_search(&number).is_ok() {
                waits.push(self.builder.points.len() - 1);
            }
            before = Some(*end);
        }
        if let Some(end) = before {
            self.position = [Some(end.x), Some(end.y), Some(end.z)];
        }
        let points = first..self.builder.points.len();
        let wait = self.cycle.wait.clone().unwrap_or_default();
        self.pieces(block, points, true, (waits, wait));
        Ok(())
    }
}
