//! The arcs of G2 and G3.

use super::State;
use super::words::Word;
use crate::tool_path::arc::Circle;
use nalgebra::{UnitVector3, Vector3};
use stiffarm::error::Result;

impl State<'_, '_> {
    /// The arc of these words \[m\].
    pub(super) fn circle(
        &self,
        words: &[Word<'_>],
        start: Vector3<f64>,
        end: Vector3<f64>,
        is_left: bool,
    ) -> Result<Option<Circle>> {
        let unit = self.builder.form.unit;
        let mut normal = Vector3::zeros();
        normal[self.plane] = if is_left { 1.0 } else { -1.0 };
        let normal = UnitVector3::new_unchecked(normal);
        let turns = words
            .iter()
            .find(|word| word.letter == b'P' && word.number.value > 1.0);
        if let Some(word) = turns {
            return Err(word.place.wrong("Arcs of several turns are not read here."));
        }
        if let Some(radius) = words.iter().find(|word| word.letter == b'R') {
            let across = (end - start) - normal.as_ref() * normal.dot(&(end - start));
            let (half, r) = (0.5 * across.norm(), radius.number.value * unit);
            let rise = r * r - half * half;
            if half < 1e-9 || rise < -1e-3 * r * r {
                return Err(radius.place.wrong("No circle of this radius leads there."));
            }
            let side = normal.cross(&across) / (2.0 * half);
            let centre = start + 0.5 * across + side * rise.max(0.0).sqrt() * r.signum();
            return Ok(Circle::about(centre, normal, start, end));
        }
        let mut centre = start;
        let mut is_stated = false;
        for word in words
            .iter()
            .filter(|word| (b'I'..=b'K').contains(&word.letter))
        {
            let own = &mut centre[usize::from(word.letter - b'I')];
            *own = word.number.value * unit + if self.centres_absolute { 0.0 } else { *own };
            is_stated = true;
        }
        Ok(is_stated
            .then(|| Circle::about(centre, normal, start, end))
            .flatten())
    }
}
