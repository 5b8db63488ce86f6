//! Exchanges that shorten an order: stretches turned round, short stretches moved elsewhere, another equivalent taken.

use super::places::{LEAST_GAIN, Places};
use crate::numerics::control::Control;
use rand::RngExt;
use std::collections::VecDeque;

/// Longest stretch that is moved elsewhere.
const STRETCH: usize = 3;
/// Stops among which an order is changed at random.
const SPAN: usize = 50;
/// Equivalents that are changed at random.
const OTHERS: usize = 3;

/// An order under exchanges. Stops are counted from 1; stop 0 and the one behind the last are the start, or nowhere.
pub(super) struct Exchanges<'p> {
    places: &'p Places,
    /// Place of each stop; behind all places counts the start, or nowhere.
    order: Vec<usize>,
    /// Cost from place to place, row by row; the last row and column are of the start, or nowhere.
    cost: Vec<f64>,
    /// Stop of each posture.
    at: Vec<usize>,
    /// Postures whose neighbours have changed.
    waiting: VecDeque<usize>,
    waits: Vec<bool>,
    /// Room for [`Exchanges::best`]: cost from each stop to the next.
    gaps: Vec<f64>,
    /// Places of each posture.
    equivalents: Vec<Vec<usize>>,
    /// Room for [`Exchanges::take_equivalents`]: least cost up to a place, and the place before it.
    least: Vec<f64>,
    before: Vec<usize>,
}

/// An exchange.
#[derive(Clone, Copy)]
enum Exchange {
    /// The stops behind the first up to the second, the other way round.
    Turn(usize, usize),
    /// The stops `from` to `to` between `behind` and the next.
    Move { from: usize, to: usize, behind: usize, reversed: bool },
}

impl<'p> Exchanges<'p> {
    pub fn new(places: &'p Places) -> Self {
        let ends: Vec<f64> = (0..places.posture.len()).map(|place| places.end(place)).collect();
        let rows = places.cost.iter().zip(&ends).flat_map(|(row, end)| row.iter().chain([end]));
        Exchanges {
            places,
            order: Vec::new(),
            cost: rows.chain(&ends).chain([&0.0]).copied().collect(),
            at: vec![0; places.count],
            waiting: VecDeque::new(),
            waits: vec![false; places.count],
            gaps: Vec::new(),
            equivalents: places.of_postures(),
            least: vec![0.0; places.posture.len()],
            before: vec![0; places.posture.len()],
        }
    }

    /// The order after all exchanges that shorten it, and its length.
    pub fn improved(&mut self, order: Vec<usize>, control: Control<'_>) -> (Vec<usize>, f64) {
        self.begin_with(&order);
        self.look_again(0, order.len() + 1);
        self.exchange(control);
        (self.stops().to_vec(), self.places.length(self.stops()))
    }

    /// The order with its best equivalents.
    pub fn with_equivalents(&mut self, order: Vec<usize>) -> Vec<usize> {
        self.begin_with(&order);
        self.take_equivalents();
        self.stops().to_vec()
    }

    /// Sets the places of the stops.
    fn begin_with(&mut self, order: &[usize]) {
        let end = self.places.posture.len();
        self.order.clear();
        self.order.push(end);
        self.order.extend_from_slice(order);
        self.order.push(end);
        self.number(1, order.len());
    }

    /// Places of the stops, without both ends.
    fn stops(&self) -> &[usize] {
        &self.order[1..=self.count()]
    }

    /// Number of stops.
    fn count(&self) -> usize {
        self.order.len() - 2
    }

    /// A shorter order, where one is found from `best` with two neighbouring stretches exchanged, which no single
    /// exchange undoes, and other equivalents of a few postures.
    pub fn kicked(
        &mut self,
        best: &[usize],
        length: f64,
        rng: &mut impl RngExt,
        control: Control<'_>,
    ) -> Option<(Vec<usize>, f64)> {
        self.begin_with(best);
        let count = best.len();
        let span = SPAN.min(count);
        let first = rng.random_range(0..=count - span);
        let mut cuts = [0; 3].map(|_: usize| first + rng.random_range(0..=span));
        cuts.sort_unstable();
        let [a, b, c] = cuts;
        self.order[a + 1..=c].rotate_left(b - a);
        self.number(1, count);
        let middle = a + (c - b);
        for cut in [a, middle, c] {
            self.look_again(cut, cut + 1);
        }
        if self.places.posture.len() > self.places.count {
            for _ in 0..OTHERS {
                let place = rng.random_range(0..self.places.posture.len());
                let stop = self.at[self.places.posture[place]];
                self.order[stop] = place;
                self.look_again(stop - 1, stop + 1);
            }
        }
        self.exchange(control);
        let other = self.places.length(self.stops());
        (other < length - LEAST_GAIN).then(|| (self.stops().to_vec(), other))
    }

    /// Exchanges while one shortens the order.
    fn exchange(&mut self, control: Control<'_>) {
        loop {
            while let Some(posture) = self.waiting.pop_front() {
                self.waits[posture] = false;
                while let Some(exchange) = self.best(self.at[posture]) {
                    self.make(exchange);
                }
                if control.stopped() {
                    return;
                }
            }
            if !self.take_equivalents() {
                return;
            }
        }
    }

    /// For this order of postures the best equivalents, all at once; whether one changed.
    fn take_equivalents(&mut self) -> bool {
        if self.places.posture.len() == self.places.count {
            return false;
        }
        let equivalents = |place: usize| &self.equivalents[self.places.posture[place]];
        for place in equivalents(self.order[1]) {
            self.least[*place] = self.places.end(*place);
        }
        for pair in self.order[1..=self.count()].windows(2) {
            for place in equivalents(pair[1]) {
                let mut least = (f64::INFINITY, 0);
                for before in equivalents(pair[0]) {
                    let cost = self.least[*before] + self.places.cost[*before][*place];
                    if cost < least.0 {
                        least = (cost, *before);
                    }
                }
                (self.least[*place], self.before[*place]) = least;
            }
        }
        let total = |place: &usize| self.least[*place] + self.places.end(*place);
        let last = equivalents(self.order[self.count()]).iter();
        let Some(last) = last.copied().min_by(|a, b| total(a).total_cmp(&total(b))) else {
            return false;
        };
        if total(&last) >= self.places.length(self.stops()) - LEAST_GAIN {
            return false;
        }
        let mut place = last;
        for stop in (1..=self.count()).rev() {
            if self.order[stop] != place {
                self.order[stop] = place;
                self.look_again(stop - 1, stop + 1);
            }
            place = self.before[place];
        }
        true
    }

    /// The exchange that shortens the order most, of those at a stop.
    fn best(&mut self, stop: usize) -> Option<Exchange> {
        let mut gaps = std::mem::take(&mut self.gaps);
        gaps.clear();
        gaps.extend((0..=self.count()).map(|other| self.step(other, other + 1)));
        let best = self.best_across(stop, &gaps);
        self.gaps = gaps;
        best
    }

    /// The same with the cost from each stop to the next.
    fn best_across(&self, stop: usize, gaps: &[f64]) -> Option<Exchange> {
        let count = self.count();
        let mut most = LEAST_GAIN;
        let mut best = None;
        // The place of each stop with that of the next.
        let neighbours = || self.order.iter().zip(&self.order[1..]);
        for link in [stop - 1, stop] {
            let joined = gaps[link];
            let [ahead, behind] = [link, link + 1].map(|stop| self.row(stop));
            for (other, ((place, next), gap)) in neighbours().zip(gaps).enumerate() {
                let now = joined + gap;
                let then = ahead[*place] + behind[*next];
                if now - then > most && link != other {
                    (most, best) = (now - then, Some(Exchange::Turn(link.min(other), link.max(other))));
                }
            }
        }
        for length in 1..=STRETCH.min(count.saturating_sub(1)) {
            let at_end = (length > 1).then(|| (stop + 1).checked_sub(length)).flatten();
            for from in [Some(stop), at_end].into_iter().flatten() {
                let to = from + length - 1;
                if from == 0 || to > count {
                    continue;
                }
                let freed = gaps[from - 1] + gaps[to] - self.step(from - 1, to + 1);
                if freed <= most {
                    continue;
                }
                let [first, last] = [from, to].map(|stop| self.row(stop));
                for (behind, ((place, next), gap)) in neighbours().zip(gaps).enumerate() {
                    let along = first[*place] + last[*next];
                    let back = last[*place] + first[*next];
                    let gain = freed + gap - along.min(back);
                    let elsewhere = behind + 1 < from || behind > to;
                    if gain > most && elsewhere {
                        most = gain;
                        let reversed = back < along;
                        best = Some(Exchange::Move { from, to, behind, reversed });
                    }
                }
            }
        }
        best
    }

    fn make(&mut self, exchange: Exchange) {
        match exchange {
            Exchange::Turn(low, high) => {
                self.order[low + 1..=high].reverse();
                self.number(low + 1, high);
                self.look_again(low, low + 1);
                self.look_again(high, high + 1);
            }
            Exchange::Move { from, to, behind, reversed } => {
                let length = to - from + 1;
                let (first, low, high) = if behind > to {
                    self.order[from..=behind].rotate_left(length);
                    (behind - length + 1, from, behind)
                } else {
                    self.order[behind + 1..=to].rotate_right(length);
                    (behind + 1, behind + 1, to)
                };
                if reversed {
                    self.order[first..first + length].reverse();
                }
                self.number(low, high);
                self.look_again(first - 1, first);
                self.look_again(first + length - 1, first + length);
                self.look_again(low - 1, low);
                self.look_again(high, high + 1);
            }
        }
    }

    /// Numbers the stops from one to another.
    fn number(&mut self, from: usize, to: usize) {
        for stop in from..=to {
            self.at[self.places.posture[self.order[stop]]] = stop;
        }
    }

    /// The postures of these stops have new neighbours.
    fn look_again(&mut self, from: usize, to: usize) {
        for stop in from.max(1)..=to.min(self.count()) {
            let posture = self.places.posture[self.order[stop]];
            if !std::mem::replace(&mut self.waits[posture], true) {
                self.waiting.push_back(posture);
            }
        }
    }

    /// Cost of a move between two stops.
    #[inline]
    fn step(&self, from: usize, to: usize) -> f64 {
        self.row(from)[self.order[to]]
    }

    /// Cost from a stop to each place, and back.
    #[inline]
    fn row(&self, stop: usize) -> &[f64] {
        let width = self.places.posture.len() + 1;
        &self.cost[self.order[stop] * width..][..width]
    }
}
