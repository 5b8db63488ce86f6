//! The order in which postures are driven to: the shortest way through all of them, each in one of its
//! equivalents.
//!
//! Up to about a dozen postures the shortest order is found for certain, by the recursion of Held and Karp
//! (1962, doi:10.1137/0110015) over which postures are behind and where the robot stands. More are
//! ordered by exchanges, from many starts.

use super::exchanges::Exchanges;
use super::places::{LEAST_GAIN, Places};
use crate::numerics::control::Control;
use crate::numerics::streams::route_rng;

/// Most steps of the recursion.
const MOST_STEPS: f64 = 4e7;
/// Most times that an order is changed at random, to look for a better one from there.
const MOST_KICKS: usize = 2000;
/// The same where an order was found before some moves became dearer.
const KICKS_AGAIN: usize = 200;

impl Places {
    /// Whether the recursion is affordable.
    pub fn is_small(&self) -> bool {
        let places = self.posture.len() as f64;
        self.count <= 16 && 2_f64.powi(self.count as i32) * places * places <= MOST_STEPS
    }

    /// The shortest order, place by place, for certain where [`is_small`](Self::is_small); a stop ends the
    /// exchanges with the best so far.
    pub fn shortest(&self, seed: u64, control: Control<'_>) -> Vec<usize> {
        if self.is_small() { self.by_recursion() } else { self.by_exchanges(None, MOST_KICKS, seed, control) }
    }

    /// The same where `previous` was found before some moves became dearer: soon, or with all effort where that is
    /// `thorough`.
    pub fn again(&self, previous: &[usize], thorough: bool, seed: u64, control: Control<'_>) -> Vec<usize> {
        match (self.is_small(), thorough) {
            (true, _) => self.by_recursion(),
            (false, true) => self.by_exchanges(Some(previous), MOST_KICKS, seed, control),
            (false, false) => self.by_exchanges(Some(previous), KICKS_AGAIN, seed, control),
        }
    }

    /// The shortest order for certain.
    pub fn by_recursion(&self) -> Vec<usize> {
        let places = self.posture.len();
        let all = (1_usize << self.count) - 1;
        // Least cost of having seen a set of postures and standing at a place, and the place before.
        let mut least = vec![f64::INFINITY; (all + 1) * places];
        let mut before = vec![u32::MAX; (all + 1) * places];
        for place in 0..places {
            least[(1 << self.posture[place]) * places + place] = self.end(place);
        }
        for seen in 1..=all {
            for place in 0..places {
                let so_far = least[seen * places + place];
                if !so_far.is_finite() {
                    continue;
                }
                for next in 0..places {
                    let bit = 1 << self.posture[next];
                    if seen & bit != 0 {
                        continue;
                    }
                    let at = (seen | bit) * places + next;
                    let cost = so_far + self.cost[place][next];
                    if cost < least[at] {
                        least[at] = cost;
                        before[at] = place as u32;
                    }
                }
            }
        }
        let total = |place: &usize| least[all * places + place] + self.end(*place);
        let last = (0..places).min_by(|a, b| total(a).total_cmp(&total(b)));
        let mut order = Vec::with_capacity(self.count);
        let (mut seen, mut place) = (all, last.unwrap_or(0));
        while seen != 0 && places > 0 {
            order.push(place);
            let at = before[seen * places + place];
            seen &= !(1 << self.posture[place]);
            place = at as usize;
        }
        // Both directions cost the same: the one that begins with the earlier posture.
        if self.posture[order[0]] < self.posture[order[order.len() - 1]] {
            return order;
        }
        order.reverse();
        order
    }

    /// A short order, by exchanges: from many starts, or on from a `previous` order.
    pub fn by_exchanges(
        &self,
        previous: Option<&[usize]>,
        kicks: usize,
        seed: u64,
        control: Control<'_>,
    ) -> Vec<usize> {
        let mut rng = route_rng(seed, 1);
        let starts: Vec<Vec<usize>> = match previous {
            Some(previous) => vec![previous.to_vec()],
            None => {
                let some = self.count.min(8);
                let firsts = (0..some).map(|i| i * self.count / some);
                firsts.map(|first| self.nearest_first(first)).collect()
            }
        };
        let mut work = Exchanges::new(self);
        let (mut best, mut length) = (Vec::new(), f64::INFINITY);
        for start in starts {
            let (order, other) = work.improved(start, control);
            if other < length - LEAST_GAIN {
                (best, length) = (order, other);
            }
        }
        for _ in 0..kicks {
            if control.stopped() {
                break;
            }
            if let Some(better) = work.kicked(&best, length, &mut rng, control) {
                (best, length) = better;
            }
        }
        best
    }

    /// From a posture always on to the nearest that is left.
    fn nearest_first(&self, first: usize) -> Vec<usize> {
        let start = (0..self.posture.len()).find(|place| self.posture[*place] == first);
        let mut order = vec![start.unwrap_or(0)];
        let mut seen = vec![false; self.count];
        seen[first] = true;
        while order.len() < self.count {
            let at = order[order.len() - 1];
            let left = (0..self.posture.len()).filter(|place| !seen[self.posture[*place]]);
            let Some(next) = left.min_by(|a, b| self.cost[at][*a].total_cmp(&self.cost[at][*b])) else {
                break;
            };
            seen[self.posture[next]] = true;
            order.push(next);
        }
        order
    }

    /// An order of postures with the best equivalents.
    pub fn best_equivalents(&self, postures: Vec<usize>) -> Vec<usize> {
        let equivalents = self.of_postures();
        let order = postures.into_iter().filter_map(|posture| equivalents[posture].first().copied());
        Exchanges::new(self).with_equivalents(order.collect())
    }
}
