//! The order in which postures are driven to: the shortest way through all of them, each in one of its
//! equivalents.
//!
//! Up to about a dozen postures the shortest order is found for certain, by the recursion of Held and Karp
//! (1962, doi:10.1137/0110015) over which postures are behind and where the robot stands. More are
//! ordered by exchanges: stretches turned round, short stretches moved elsewhere, another equivalent
//! taken, from many starts.

use crate::numerics::control::Control;
use crate::numerics::streams::route_rng;
use rand::RngExt;

/// Most steps of the recursion.
const MOST_STEPS: f64 = 4e7;
/// Exchanges tried in all, about.
const EXCHANGES: usize = 30_000_000;
/// Most times that an order is changed at random, to look for a better one from there.
const MOST_KICKS: usize = 1500;
/// Least gain that counts \[s\].
const LEAST: f64 = 1e-9;

/// What is to be put in order: places the robot may stand at, and what a move between two costs.
pub struct Places {
    /// Which posture each place belongs to.
    pub posture: Vec<usize>,
    /// Number of postures.
    pub count: usize,
    /// Cost from place to place, symmetric.
    pub cost: Vec<Vec<f64>>,
    /// Cost from the start to each place and back, where there is a start.
    pub start: Option<Vec<f64>>,
}

impl Places {
    /// Cost of an order, from start to start where there is one.
    pub fn length(&self, order: &[usize]) -> f64 {
        let moves = order.windows(2).map(|pair| self.cost[pair[0]][pair[1]]);
        let ends = [order.first(), order.last()];
        let ends = ends.into_iter().flatten().map(|place| self.end(*place));
        moves.sum::<f64>() + ends.sum::<f64>()
    }

    fn end(&self, place: usize) -> f64 {
        self.start.as_ref().map_or(0.0, |start| start[place])
    }

    /// Whether the recursion is affordable.
    pub fn is_small(&self) -> bool {
        let places = self.posture.len() as f64;
        self.count <= 16 && 2_f64.powi(self.count as i32) * places * places <= MOST_STEPS
    }

    /// The shortest order, place by place, for certain where [`is_small`](Self::is_small); a stop ends the
    /// exchanges with the best so far.
    pub fn shortest(&self, seed: u64, control: Control<'_>) -> Vec<usize> {
        if self.is_small() {
            self.by_recursion()
        } else {
            self.by_exchanges(seed, control)
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

    /// A short order, by exchanges from many starts.
    pub fn by_exchanges(&self, seed: u64, control: Control<'_>) -> Vec<usize> {
        let mut rng = route_rng(seed, 1);
        let mut best = self.improved(self.nearest_first(0), control);
        let mut length = self.length(&best);
        for first in 1..self.count.min(8) {
            let first = self.nearest_first(first * self.count / self.count.min(8));
            let order = self.improved(first, control);
            let other = self.length(&order);
            if other < length - LEAST {
                (best, length) = (order, other);
            }
        }
        let each = self.count * self.count * 4;
        for _ in 0..(EXCHANGES / each.max(1)).clamp(1, MOST_KICKS) {
            if control.stopped() {
                break;
            }
            let order = self.improved(self.kicked(&best, &mut rng), control);
            let other = self.length(&order);
            if other < length - LEAST {
                (best, length) = (order, other);
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
            let Some(next) = left.min_by(|a, b| self.cost[at][*a].total_cmp(&self.cost[at][*b]))
            else {
                break;
            };
            seen[self.posture[next]] = true;
            order.push(next);
        }
        order
    }

    /// Exchanges while one shortens the order.
    fn improved(&self, mut order: Vec<usize>, control: Control<'_>) -> Vec<usize> {
        loop {
            let turned = self.turn_stretches(&mut order);
            let moved = self.move_stretches(&mut order, control);
            let taken = self.take_equivalents(&mut order);
            if !(turned || moved || taken) || control.stopped() {
                return order;
            }
        }
    }

    /// An order with two neighbouring stretches exchanged, which no single exchange undoes, and other
    /// equivalents of a few postures.
    fn kicked(&self, order: &[usize], rng: &mut impl RngExt) -> Vec<usize> {
        let mut cuts = [0; 3].map(|_: usize| rng.random_range(0..=order.len()));
        cuts.sort_unstable();
        let [a, b, c] = cuts;
        let mut order = [&order[..a], &order[b..c], &order[a..b], &order[c..]].concat();
        if self.posture.len() > self.count {
            for _ in 0..3 {
                let place = rng.random_range(0..self.posture.len());
                let own = |at: &usize| self.posture[*at] == self.posture[place];
                if let Some(at) = order.iter().position(own) {
                    order[at] = place;
                }
            }
        }
        order
    }

    /// Cost of a move between two positions of an order, beyond its ends to the start.
    fn step(&self, order: &[usize], from: Option<usize>, to: Option<usize>) -> f64 {
        match (
            from.and_then(|at| order.get(at)),
            to.and_then(|at| order.get(at)),
        ) {
            (Some(a), Some(b)) => self.cost[*a][*b],
            (Some(place), None) | (None, Some(place)) => self.end(*place),
            (None, None) => 0.0,
        }
    }

    /// Turns stretches round (2-opt).
    fn turn_stretches(&self, order: &mut [usize]) -> bool {
        let mut any = false;
        for i in 0..order.len() {
            for j in i + 1..order.len() {
                let before = i.checked_sub(1);
                let now =
                    self.step(order, before, Some(i)) + self.step(order, Some(j), Some(j + 1));
                let then =
                    self.step(order, before, Some(j)) + self.step(order, Some(i), Some(j + 1));
                if then < now - LEAST {
                    order[i..=j].reverse();
                    any = true;
                }
            }
        }
        any
    }

    /// Moves stretches of up to three postures elsewhere, either way round (or-opt).
    fn move_stretches(&self, order: &mut Vec<usize>, control: Control<'_>) -> bool {
        let mut any = false;
        for size in 1..=3.min(order.len().saturating_sub(1)) {
            let mut i = 0;
            while i + size <= order.len() && !control.stopped() {
                if let Some((to, reversed)) = self.better_place(order, i, size) {
                    let mut stretch: Vec<usize> = order.drain(i..i + size).collect();
                    if reversed {
                        stretch.reverse();
                    }
                    order.splice(to..to, stretch);
                    any = true;
                }
                i += 1;
            }
        }
        any
    }

    /// Where a stretch had better stand, counted without it.
    fn better_place(&self, order: &[usize], i: usize, size: usize) -> Option<(usize, bool)> {
        let rest: Vec<usize> = order[..i]
            .iter()
            .chain(&order[i + size..])
            .copied()
            .collect();
        let joined = self.step(&rest, i.checked_sub(1), Some(i));
        let (first, last) = (order[i], order[i + size - 1]);
        let cost_at = |to: usize, first: usize, last: usize| {
            let link = |at: Option<usize>, place: usize| match at.and_then(|at| rest.get(at)) {
                Some(other) => self.cost[*other][place],
                None => self.end(place),
            };
            let before = to.checked_sub(1);
            let gap = if to == i {
                joined
            } else {
                self.step(&rest, before, Some(to))
            };
            link(before, first) + link(Some(to), last) - gap
        };
        let now = cost_at(i, first, last);
        let mut best = (now - LEAST, None);
        for to in 0..=rest.len() {
            for reversed in [false, true] {
                let (a, b) = if reversed {
                    (last, first)
                } else {
                    (first, last)
                };
                let cost = cost_at(to, a, b);
                if cost < best.0 {
                    best = (cost, Some((to, reversed)));
                }
            }
        }
        best.1
    }

    /// An order of postures with the best equivalents.
    pub fn best_equivalents(&self, postures: Vec<usize>) -> Vec<usize> {
        let first = |posture: usize| self.posture.iter().position(|own| *own == posture);
        let mut order: Vec<usize> = postures.into_iter().filter_map(first).collect();
        self.take_equivalents(&mut order);
        order
    }

    /// For this order of postures the best equivalents, all at once.
    fn take_equivalents(&self, order: &mut Vec<usize>) -> bool {
        if self.posture.len() == self.count {
            return false;
        }
        let mut own: Vec<Vec<usize>> = vec![Vec::new(); self.count];
        for (place, posture) in self.posture.iter().enumerate() {
            own[*posture].push(place);
        }
        let steps: Vec<&Vec<usize>> = order.iter().map(|p| &own[self.posture[*p]]).collect();
        let mut least: Vec<f64> = steps[0].iter().map(|p| self.end(*p)).collect();
        let mut from: Vec<Vec<usize>> = Vec::with_capacity(steps.len());
        for pair in steps.windows(2) {
            let mut next = Vec::with_capacity(pair[1].len());
            let mut back = Vec::with_capacity(pair[1].len());
            for place in pair[1] {
                let costs = pair[0].iter().zip(&least);
                let costs = costs.map(|(before, so_far)| so_far + self.cost[*before][*place]);
                let best = costs.enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
                let (at, cost) = best.unwrap_or((0, f64::INFINITY));
                next.push(cost);
                back.push(at);
            }
            least = next;
            from.push(back);
        }
        let last = &steps[steps.len() - 1];
        let total = |at: &usize| least[*at] + self.end(last[*at]);
        let Some(mut at) = (0..last.len()).min_by(|a, b| total(a).total_cmp(&total(b))) else {
            return false;
        };
        let mut chosen = vec![0; order.len()];
        for step in (0..order.len()).rev() {
            chosen[step] = steps[step][at];
            if step > 0 {
                at = from[step - 1][at];
            }
        }
        let better = self.length(&chosen) < self.length(order) - LEAST;
        if better {
            *order = chosen;
        }
        better
    }
}
