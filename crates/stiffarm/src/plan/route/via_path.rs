//! Ways around what a straight joint move would touch: over one via posture, else one that is searched for.

use super::moves::Moves;
use super::rounding::nearest;
use super::search::{VIA_STEP_DEG, connect};
use crate::error::Result;
use crate::numerics::order::sort_by_number;
use crate::numerics::streams::spread;
use std::f64::consts::PI;

/// Spread postures that are tried as via postures.
const SPREAD: u32 = 192;

/// A way from one posture to another.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ViaPath {
    /// Via postures, controller angles \[rad\].
    pub via: Vec<Vec<f64>>,
    /// Time at full speed \[s\].
    pub seconds: f64,
}

impl Moves<'_> {
    /// The shortest way that was found, `None` where none was: the joint move itself, else over a via
    /// posture, else, where that is wanted, one that is searched for.
    pub fn way(&mut self, from: &[f64], to: &[f64], search: bool) -> Result<Option<ViaPath>> {
        self.begin(from, to)?;
        if self.is_free(from, to)? {
            return Ok(Some(self.along(from, to, Vec::new())));
        }
        let over_one = self.over_one(from, to)?;
        if over_one.is_some() || !search {
            return Ok(over_one);
        }
        let bounds = self.machine_bounds(from, to);
        let via = connect(self, from, to, &bounds, self.seed)?;
        Ok(via.map(|via| self.along(from, to, via)))
    }

    fn along(&self, from: &[f64], to: &[f64], via: Vec<Vec<f64>>) -> ViaPath {
        let (from, to) = (from.to_vec(), to.to_vec());
        let seconds = self.seconds_along([&from].into_iter().chain(&via).chain([&to]));
        ViaPath { via, seconds }
    }

    /// The shortest way over one via posture: some joints first, then the others, or over one of
    /// postures that are spread over the bounds.
    fn over_one(&mut self, from: &[f64], to: &[f64]) -> Result<Option<ViaPath>> {
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
            vias.push(spread(&bounds, i));
        }
        vias.extend(self.cell.route.start.clone());
        let mut timed: Vec<(f64, Vec<f64>)> =
            vias.into_iter().map(|via| (self.seconds(from, &via) + self.seconds(&via, to), via)).collect();
        sort_by_number(&mut timed, |a| a.0);
        for (_, via) in timed {
            // Typed like every other posture.
            let via = nearest(&via, VIA_STEP_DEG);
            if self.is_clear(&via)? && self.are_free(&[[from, &via], [&via, to]])? {
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
                [low.max(from.min(*to) - PI).min(from.min(*to)), high.min(from.max(*to) + PI).max(from.max(*to))]
            })
            .collect()
    }

    /// Where via postures are tried: the cell's bounds, widened to hold both ends.
    fn bounds(&self, from: &[f64], to: &[f64]) -> Vec<[f64; 2]> {
        let ends = from.iter().zip(to);
        let bounds = self.cell.bounds.iter().zip(ends);
        bounds.map(|(b, (from, to))| [b[0].min(*from).min(*to), b[1].max(*from).max(*to)]).collect()
    }
}
