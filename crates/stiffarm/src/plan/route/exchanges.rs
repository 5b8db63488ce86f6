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
    order: Vec<usize>,
    /// Stop of each posture.
    at: Vec<usize>,
    /// Postures whose neighbours have changed.
    waiting: VecDeque<usize>,
    waits: Vec<bool>,
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
        Exchanges {
            places,
            order: Vec::new(),
            at: vec![0; places.count],
            waiting: VecDeque::new(),
            waits: vec![false; places.count],
            equivalents: places.of_postures(),
            least: vec![0.0; places.posture.len()],
            before: vec![0; places.posture.len()],
        }
    }

    /// The order after all exchanges that shorten it, and its length.
    pub fn improved(&mut self, order: Vec<usize>, control: Control<'_>) -> (Vec<usize>, f64) {
        self.order = order;
        self.number(1, self.order.len());
        self.look_again(0, self.order.len() + 1);
        self.exchange(control);
        (self.order.clone(), self.places.length(&self.order))
    }

    /// The order with its best equivalents.
    pub fn with_equivalents(&mut self, order: Vec<usize>) -> Vec<usize> {
        self.order = order;
        self.number(1, self.order.len());
        self.take_equivalents();
        std::mem::take(&mut self.order)
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
        self.order.clear();
        self.order.extend_from_slice(best);
        let count = best.len();
        let span = SPAN.min(count);
        let first = rng.random_range(0..=count - span);
        let mut cuts = [0; 3].map(|_: usize| first + rng.random_range(0..=span));
        cuts.sort_unstable();
        let [a, b, c] = cuts;
        self.order[a..c].rotate_left(b - a);
        self.number(1, count);
        let middle = a + (c - b);
        for cut in [a, middle, c] {
            self.look_again(cut, cut + 1);
        }
        if self.places.posture.len() > self.places.count {
            for _ in 0..OTHERS {
                let place = rng.random_range(0..self.places.posture.len());
                let stop = self.at[self.places.posture[place]];
                self.order[stop - 1] = place;
                self.look_again(stop - 1, stop + 1);
            }
        }
        self.exchange(control);
        let other = self.places.length(&self.order);
        (other < length - LEAST_GAIN).then(|| (self.order.clone(), other))
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
        for place in equivalents(self.order[0]) {
            self.least[*place] = self.places.end(*place);
        }
        for pair in self.order.windows(2) {
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
        let last = equivalents(self.order[self.order.len() - 1]).iter();
        let Some(last) = last.copied().min_by(|a, b| total(a).total_cmp(&total(b))) else {
            return false;
        };
        if total(&last) >= self.places.length(&self.order) - LEAST_GAIN {
            return false;
        }
        let mut place = last;
        for stop in (1..=self.order.len()).rev() {
            if self.order[stop - 1] != place {
                self.order[stop - 1] = place;
                self.look_again(stop - 1, stop + 1);
            }
            place = self.before[place];
        }
        true
    }

    /// The exchange that shortens the order most, of those at a stop.
    fn best(&self, stop: usize) -> Option<Exchange> {
        let count = self.order.len();
        let mut most = LEAST_GAIN;
        let mut best = None;
        for link in [stop - 1, stop] {
            let joined = self.step(link, link + 1);
            for other in 0..=count {
                let (low, high) = (link.min(other), link.max(other));
                let now = joined + self.step(other, other + 1);
                let then = self.step(low, high) + self.step(low + 1, high + 1);
                if low < high && now - then > most {
                    (most, best) = (now - then, Some(Exchange::Turn(low, high)));
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
                let freed = self.step(from - 1, from) + self.step(to, to + 1) - self.step(from - 1, to + 1);
                if freed <= most {
                    continue;
                }
                let elsewhere = (0..from - 1).chain(to + 1..=count);
                for behind in elsewhere {
                    let gap = self.step(behind, behind + 1);
                    let along = self.step(behind, from) + self.step(to, behind + 1);
                    let back = self.step(behind, to) + self.step(from, behind + 1);
                    let gain = freed + gap - along.min(back);
                    if gain > most {
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
                self.order[low..high].reverse();
                self.number(low + 1, high);
                self.look_again(low, low + 1);
                self.look_again(high, high + 1);
            }
            Exchange::Move { from, to, behind, reversed } => {
                let length = to - from + 1;
                let (first, low, high) = if behind > to {
                    self.order[from - 1..behind].rotate_left(length);
                    (behind - length + 1, from, behind)
                } else {
                    self.order[behind..to].rotate_right(length);
                    (behind + 1, behind + 1, to)
                };
                if reversed {
                    self.order[first - 1..first - 1 + length].reverse();
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
            self.at[self.places.posture[self.order[stop - 1]]] = stop;
        }
    }

    /// The postures of these stops have new neighbours.
    fn look_again(&mut self, from: usize, to: usize) {
        for stop in from.max(1)..=to.min(self.order.len()) {
            let posture = self.places.posture[self.order[stop - 1]];
            if !std::mem::replace(&mut self.waits[posture], true) {
                self.waiting.push_back(posture);
            }
        }
    }

    /// Cost of a move between two stops.
    #[inline]
    fn step(&self, from: usize, to: usize) -> f64 {
        let place = |stop: usize| self.order.get(stop.wrapping_sub(1));
        match (place(from), place(to)) {
            (Some(a), Some(b)) => self.places.cost[*a][*b],
            (Some(place), None) | (None, Some(place)) => self.places.end(*place),
            (None, None) => 0.0,
        }
    }
}
