//! The arcs of G2 and G3.

use super::effect::Effect;
use super::{Block, State};
use crate::tool_path::arc::Circle;
use nalgebra::{UnitVector3, Vector3};
use stiffarm::error::Result;

/// More turns than this are no arc.
const MOST_TURNS: f64 = 1000.0;

impl State<'_, '_> {
    /// The arc of a block \[m\].
    pub(super) fn circle(
        &self,
        block: &Block<'_, '_>,
        start: Vector3<f64>,
        end: Vector3<f64>,
        is_left: bool,
    ) -> Result<Option<Circle>> {
        let unit = self.builder.form.unit;
        let mut normal = Vector3::zeros();
        normal[self.plane] = if is_left { 1.0 } else { -1.0 };
        let normal = UnitVector3::new_unchecked(normal);
        let turns = self.turns(block)?;
        let about = |centre| Circle::about(centre, normal, start, end).map(|circle| circle.with_turns(turns));
        if let Some(radius) = block.word(b'R') {
            let across = (end - start) - normal.as_ref() * normal.dot(&(end - start));
            let (half, r) = (0.5 * across.norm(), radius.number.value * unit);
            let rise = r * r - half * half;
            if half < 1e-9 || rise < -1e-3 * r * r {
                return Err(radius.place.wrong("No circle of this radius leads there."));
            }
            let side = normal.cross(&across) / (2.0 * half);
            let centre = start + 0.5 * across + side * rise.max(0.0).sqrt() * r.signum();
            return Ok(about(centre));
        }
        let mut centre = start;
        let mut is_stated = false;
        for (axis, letter) in (b'I'..=b'K').enumerate() {
            if let Some(value) = block.value(letter) {
                centre[axis] = value * unit + if self.centres_absolute { 0.0 } else { start[axis] };
                is_stated = true;
            }
        }
        Ok(is_stated.then(|| about(centre)).flatten())
    }

    /// Turns beyond the arc itself: P counts all of them, TURN those that are added.
    fn turns(&self, block: &Block<'_, '_>) -> Result<f64> {
        let added = block.words.iter().find(|word| word.is(Effect::Turns));
        let all = block.word(b'P').map(|word| (word, word.number.value - 1.0));
        let Some((word, turns)) = added.map(|word| (word, word.number.value)).or(all) else {
            return Ok(0.0);
        };
        if (0.0..=MOST_TURNS).contains(&turns) && turns.fract() == 0.0 {
            Ok(turns)
        } else {
            Err(word.place.wrong("A whole number of turns is needed here."))
        }
    }
}
