//! What bounds, limits and shapes of the cell leave of a way, and what keeping them costs.

use super::{PathPostures, Search, turned};
use crate::error::Result;
use crate::findings::{Finding, length, more};
use crate::model::inverse::{Method, Outcome};
use crate::numerics::control::Control;
use crate::numerics::jobs::{in_blocks, in_order, in_order_watched};
use nalgebra::Isometry3;
use std::f64::consts::TAU;

/// Most points at which is looked whether anything would be free.
const LOOKED_AT: usize = 400;

/// Most points by which one of several ways is chosen.
const RANKED_BY: usize = 2000;
/// Ways that differ by less bend alike, as flipped wrists do.
const ALIKE_RMS_SHARE: f64 = 1e-6;

/// A point of a way with what is missing there, in the unit of [`Search::missing`].
struct Shortfall {
    point: usize,
    missing: f64,
}

impl Search<'_> {
    /// How far bounds, limits and shapes are from allowing `q`; 0 where they do.
    pub(super) fn missing(&self, q: &[f64]) -> Result<f64> {
        let at_work = self.arm.at_work();
        Ok(at_work.lacks_room(q)? + at_work.beyond_bounds(q))
    }

    /// The same where the search keeps them, else 0.
    pub(super) fn counted(&self, q: &[f64]) -> Result<f64> {
        if self.keeps { self.missing(q) } else { Ok(0.0) }
    }

    /// What limits and shapes lack along a way, whose postures stand one after the other in `q`, by so many of its
    /// points as can be looked at for each of several ways; 0 where the search does not keep them.
    pub(super) fn lacks_room_along(&self, q: &[f64]) -> Result<f64> {
        if !self.keeps {
            return Ok(0.0);
        }
        let postures = q.chunks(self.arm.robot().joint_count());
        let some: Vec<&[f64]> = postures.clone().step_by(postures.len().div_ceil(RANKED_BY).max(1)).collect();
        let each = in_order(&some, |(_, q)| self.arm.at_work().lacks_room(q))?;
        Ok(each.iter().sum())
    }

    /// What the bounds lack along a way, whose postures stand one after the other in `q`; 0 where the search does not
    /// keep them.
    pub(super) fn beyond_bounds_along(&self, q: &[f64], control: Control<'_>) -> Result<f64> {
        if !self.keeps {
            return Ok(0.0);
        }
        let postures: Vec<&[f64]> = q.chunks(self.arm.robot().joint_count()).collect();
        let beyond = |q: &&[f64]| self.arm.at_work().beyond_bounds(q);
        let each = in_blocks(&postures, "bounds", control.quiet(), |_, block| Ok(block.iter().map(beyond).collect()))?;
        Ok(each.iter().sum())
    }

    /// What is missing at each posture of a way.
    pub(super) fn missing_along(&self, q: &[Vec<f64>], control: Control<'_>) -> Result<Vec<f64>> {
        let at_work = self.arm.at_work();
        in_blocks(q, "limits and shapes", control, |_, block| {
            let mut limits = at_work.limits();
            let missing = |q: &Vec<f64>| Ok(limits.lacks_room(q)? + at_work.beyond_bounds(q));
            block.iter().map(missing).collect()
        })
    }

    /// That the way which bends least was left, and what that cost; nothing where another bends alike.
    pub(super) fn left(&self, first: &PathPostures, missing: &[f64], taken: &PathPostures) -> Option<Finding> {
        if taken.rms <= first.rms * (1.0 + ALIKE_RMS_SHARE) {
            return None;
        }
        let sentence = format!(
            "The way that bends least, {} RMS, is forbidden by the cell's bounds, limits or shapes at {} of {} points: \
             another was taken, which bends by {}.",
            length(first.rms),
            missing.iter().filter(|missing| **missing > 0.0).count(),
            missing.len(),
            length(taken.rms)
        );
        Some(Finding::note("limits-kept", "path", sentence))
    }

    /// Where bounds, limits and shapes leave no way: the worst point at which nothing is free.
    pub(super) fn nothing_free(
        &self,
        poses: &[Isometry3<f64>],
        free: bool,
        way: &PathPostures,
        missing: &[f64],
    ) -> Result<Option<Finding>> {
        let mut lacking: Vec<Shortfall> = missing
            .iter()
            .enumerate()
            .filter(|(_, missing)| **missing > 0.0)
            .map(|(point, missing)| Shortfall { point, missing: *missing })
            .collect();
        lacking.sort_by(|a, b| b.missing.total_cmp(&a.missing));
        lacking.truncate(LOOKED_AT);
        let Some(worst) = lacking.first() else {
            return Ok(None);
        };
        let least = in_order_watched(&lacking, "limits and shapes", Control::default(), |(_, l)| {
            self.least_missing(&poses[l.point], free, &way.q[l.point])
        })?;
        let mut nothing: Vec<(usize, f64, Vec<f64>)> = lacking
            .iter()
            .zip(least)
            .filter(|(_, (missing, _))| *missing > 0.0)
            .map(|(lacking, (missing, q))| (lacking.point, missing, q))
            .collect();
        nothing.sort_by(|a, b| b.1.total_cmp(&a.1));
        let whatever =
            if free { "whatever the branch and the turn about the tool axis" } else { "whatever the branch" };
        let sentence = match nothing.first() {
            Some((point, _, q)) => format!(
                "At point {}{} nothing is free, {whatever}: at best, {}.",
                self.place(*point),
                more(nothing.len() - 1),
                self.arm.at_work().why_not(q)?.unwrap_or_default()
            ),
            None => format!(
                "Each point by itself has a free posture, but no way that was found leads through them all without a \
                 jump{}: at point {}, {}.",
                match self.options.start {
                    Some(_) => " near the posture that is asked for",
                    None => "",
                },
                self.place(worst.point),
                self.arm.at_work().why_not(&way.q[worst.point])?.unwrap_or_default()
            ),
        };
        Ok(Some(Finding::caution("nothing-free", "path", sentence)))
    }

    /// The least that is missing among the postures of a pose, and the posture, beside `way_posture`.
    fn least_missing(&self, pose: &Isometry3<f64>, free: bool, way_posture: &[f64]) -> Result<(f64, Vec<f64>)> {
        let mut least = (self.missing(way_posture)?, way_posture.to_vec());
        if self.inverse.method() == Method::Numeric {
            return Ok(least);
        }
        let count = if free { self.options.turns.max(1) } else { 1 };
        for k in 0..count {
            let tip = turned(pose, k as f64 * TAU / count as f64);
            let Outcome::Reachable(branches) = self.inverse.solve(&self.flange(&tip))? else {
                continue;
            };
            for branch in branches {
                let at_work = self.arm.at_work();
                let beyond = |q: &Vec<f64>| at_work.beyond_bounds(q);
                let turns = self.inverse.turns_within_limits(&branch.q).into_iter();
                let Some(q) = turns.min_by(|a, b| beyond(a).total_cmp(&beyond(b))) else {
                    continue;
                };
                let missing = self.missing(&q)?;
                if missing < least.0 {
                    least = (missing, q);
                }
            }
        }
        Ok(least)
    }

    /// Name of a point, with its line.
    pub(super) fn place(&self, i: usize) -> String {
        let point = &self.points[i];
        match point.line {
            Some(line) => format!("{} (line {line})", point.name),
            None => point.name.to_string(),
        }
    }
}
