//! A way around, where one via posture is not enough: two trees of free moves that grow towards each
//! other (Kuffner and LaValle 2000, RRT-Connect, doi:10.1109/ROBOT.2000.844730), and the way then shortened.

use super::moves::{Moves, between};
use super::rounding::nearest;
use crate::error::Result;
use crate::model::inverse::largest_change;
use crate::numerics::streams::{route_rng, uniform};
use rand::RngExt;

/// Steps of the angles of via postures \[deg\].
pub(super) const VIA_STEP_DEG: f64 = 0.01;
/// Times that the trees are grown.
const GROWTHS: usize = 2000;
/// Lengths of the branches that are tried, by the largest turn of a joint \[rad\].
const BRANCHES: [f64; 4] = [0.6, 0.2, 0.06, 0.02];
/// Shortcuts that are tried.
const SHORTCUTS: usize = 60;

struct Tree {
    postures: Vec<Vec<f64>>,
    parents: Vec<usize>,
}

impl Tree {
    fn new(root: &[f64]) -> Self {
        Tree { postures: vec![root.to_vec()], parents: vec![0] }
    }

    /// Grows from its nearest posture towards `goal` by one branch: the posture reached.
    fn grow(&mut self, ways: &mut Moves<'_>, goal: &[f64]) -> Result<Option<usize>> {
        let distance = |q: &Vec<f64>| largest_change(q, goal);
        let numbered = self.postures.iter().map(distance).enumerate();
        let Some((near, apart)) = numbered.min_by(|a, b| a.1.total_cmp(&b.1)) else {
            return Ok(None);
        };
        if apart == 0.0 {
            return Ok(Some(near));
        }
        // Out of a narrow place only short branches lead.
        for length in BRANCHES {
            let share = (length / apart).min(1.0);
            let next = if share < 1.0 {
                nearest(&between(&self.postures[near], goal, share), VIA_STEP_DEG)
            } else {
                goal.to_vec()
            };
            if ways.is_clear(&next)? && ways.is_free(&self.postures[near], &next)? {
                self.postures.push(next);
                self.parents.push(near);
                return Ok(Some(self.postures.len() - 1));
            }
        }
        Ok(None)
    }

    /// From a posture to the root.
    fn back(&self, mut at: usize) -> Vec<Vec<f64>> {
        let mut out = vec![self.postures[at].clone()];
        while at != 0 {
            at = self.parents[at];
            out.push(self.postures[at].clone());
        }
        out
    }
}

/// Via postures of a free way, `None` where none was found.
pub(super) fn connect(
    ways: &mut Moves<'_>,
    from: &[f64],
    to: &[f64],
    bounds: &[[f64; 2]],
    seed: u64,
) -> Result<Option<Vec<Vec<f64>>>> {
    let mut rng = route_rng(seed, 0);
    let mut trees = [Tree::new(from), Tree::new(to)];
    for growth in 0..GROWTHS {
        let goal = uniform(bounds, &mut rng);
        let (grown, other) = (growth % 2, 1 - growth % 2);
        let Some(new) = trees[grown].grow(ways, &goal)? else {
            continue;
        };
        let aim = trees[grown].postures[new].clone();
        // The other tree comes as far as it can.
        while let Some(met) = trees[other].grow(ways, &aim)? {
            if largest_change(&trees[other].postures[met], &aim) == 0.0 {
                let (mut first, second) = (trees[grown].back(new), trees[other].back(met));
                first.reverse();
                first.extend(second.into_iter().skip(1));
                if grown == 1 {
                    first.reverse();
                }
                return shortened(ways, first, &mut rng).map(Some);
            }
        }
    }
    Ok(None)
}

/// Leaves out postures of a way while the rest stays free; the ends are not given back.
fn shortened(ways: &mut Moves<'_>, mut way: Vec<Vec<f64>>, rng: &mut impl RngExt) -> Result<Vec<Vec<f64>>> {
    for _ in 0..SHORTCUTS {
        if way.len() <= 2 {
            break;
        }
        let first = rng.random_range(0..way.len() - 2);
        let last = rng.random_range(first + 2..way.len());
        if ways.is_free(&way[first], &way[last])? {
            way.drain(first + 1..last);
        }
    }
    way.pop();
    way.remove(0);
    Ok(way)
}
