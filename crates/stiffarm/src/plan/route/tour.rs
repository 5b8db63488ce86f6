//! The order of a route, with the ways that it needs.

use super::approach::{Approach, approach};
use super::moves::Moves;
use super::nearest::nearest;
use super::places::Places;
use super::planned_route::{Route, RouteMove, RouteOptions};
use super::via_path::ViaPath;
use crate::error::Result;
use crate::model::cell::Cell;
use crate::model::inverse::largest_change;
use crate::numerics::control::Control;
use std::collections::HashMap;

/// Times that the order is looked for again after moves turned out to be in the way of something.
const MOST_ORDERS: usize = 60;
/// Cost of a move without a known way, against the dearest that has one.
const BLOCKED: f64 = 1e3;

/// A pair of places; `None` is the start.
type Pair = (Option<usize>, Option<usize>);

/// Places, and what is known of the ways between them.
pub(super) struct Tour<'a> {
    places: Places,
    stands: Vec<Vec<f64>>,
    start: Option<&'a [f64]>,
    /// Ways that were looked for, the lower place first.
    pair_ways: HashMap<Pair, Option<ViaPath>>,
    /// Of each place, and last of the start, one that it has ways to; the same for all that are joined.
    joined: Vec<usize>,
    /// Pairs between which a search found none.
    apart: Vec<Pair>,
    /// Places at which something is touched, the start among them: no way leads there.
    touching: Vec<Option<usize>>,
}

impl<'a> Tour<'a> {
    /// Between `places`, which are the postures `stands`, and the start, where there is one.
    pub fn new(places: Places, stands: Vec<Vec<f64>>, start: Option<&'a [f64]>) -> Self {
        Tour {
            places,
            start,
            pair_ways: HashMap::new(),
            joined: (0..=stands.len()).collect(),
            stands,
            apart: Vec::new(),
            touching: Vec::new(),
        }
    }

    fn at(&self, place: Option<usize>) -> &[f64] {
        match (place, self.start) {
            (Some(place), _) => &self.stands[place],
            (None, Some(start)) => start,
            (None, None) => &[],
        }
    }

    /// The moves of an order as pairs of places.
    fn pairs(&self, order: &[usize]) -> Vec<Pair> {
        let mut stops: Vec<Option<usize>> = order.iter().map(|place| Some(*place)).collect();
        if self.start.is_some() {
            stops.insert(0, None);
            stops.push(None);
        }
        stops.windows(2).map(|pair| (pair[0], pair[1])).collect()
    }

    /// The order: joint moves are the least that a way can take, so an order whose ways all are as short as
    /// was thought is the shortest; ways are looked for only where an order uses them.
    pub fn order(
        &mut self,
        ways: &mut Moves<'_>,
        count: usize,
        options: &RouteOptions,
        control: Control<'_>,
    ) -> Result<Vec<usize>> {
        if count == 0 {
            return Ok(Vec::new());
        }
        self.find_touching(ways)?;
        let mut previous: Option<(Vec<usize>, bool)> = None;
        for round in 0..MOST_ORDERS {
            control.check()?;
            let seed = options.seed;
            let order = match &previous {
                _ if options.keep_order => self.places.best_equivalents((0..count).collect()),
                None => self.places.shortest(seed, control),
                // Some moves became dearer: what was short is a good start.
                Some((previous, thorough)) => self.places.again(previous, *thorough, seed, control),
            };
            control.check()?;
            let mut as_thought = true;
            let pairs = self.pairs(&order);
            for (done, pair) in pairs.iter().enumerate() {
                control.report("checking moves", done, pairs.len());
                as_thought &= self.look(ways, *pair)?;
            }
            // What was found soon is searched from once more with all effort.
            let is_certain = options.keep_order || self.places.is_small();
            let is_soon = matches!(previous, Some((_, false))) && !is_certain;
            if round + 1 == MOST_ORDERS || as_thought && !is_soon {
                return Ok(order);
            }
            previous = Some((order, as_thought));
        }
        Ok(Vec::new())
    }

    /// Finds the places at which something is touched; an equivalent that touches nothing is cheaper.
    fn find_touching(&mut self, ways: &mut Moves<'_>) -> Result<()> {
        let dearest = self.places.cost.iter().flatten().fold(1.0, |most: f64, c| most.max(*c));
        let start = self.start.map(|_| None);
        for place in (0..self.stands.len()).map(Some).chain(start) {
            let q = self.at(place).to_vec();
            ways.begin(&q, &q)?;
            if ways.is_clear(&q)? {
                continue;
            }
            self.touching.push(place);
            let Some(place) = place else { continue };
            for other in 0..self.stands.len() {
                self.places.cost[place][other] += BLOCKED * dearest;
                self.places.cost[other][place] += BLOCKED * dearest;
            }
            if let Some(start) = &mut self.places.start {
                start[place] += BLOCKED * dearest;
            }
        }
        Ok(())
    }

    /// Looks for the way between two places; false where it is longer than was thought.
    fn look(&mut self, ways: &mut Moves<'_>, (a, b): Pair) -> Result<bool> {
        let pair = (a.min(b), a.max(b));
        if self.pair_ways.contains_key(&pair) {
            return Ok(true);
        }
        if self.touching.contains(&a) || self.touching.contains(&b) {
            // No other order would spare it.
            self.pair_ways.insert(pair, None);
            return Ok(true);
        }
        let (from, to) = (self.at(pair.0).to_vec(), self.at(pair.1).to_vec());
        let search = !self.is_apart(pair);
        let way = ways.way(&from, &to, search)?;
        if way.is_some() {
            let (a, b) = (self.root(pair.0), self.root(pair.1));
            self.joined[a.max(b)] = a.min(b);
        } else if search {
            self.apart.push(pair);
        }
        let direct = ways.seconds(&from, &to);
        let more = match &way {
            Some(way) => way.seconds - direct,
            None => BLOCKED * direct.max(1.0),
        };
        self.pair_ways.insert(pair, way);
        let add = |cost: &mut f64| *cost += more;
        match pair {
            (Some(a), Some(b)) => {
                add(&mut self.places.cost[a][b]);
                add(&mut self.places.cost[b][a]);
            }
            (_, Some(place)) => {
                if let Some(start) = &mut self.places.start {
                    add(&mut start[place]);
                }
            }
            _ => {}
        }
        Ok(more <= 1e-9)
    }

    /// The one that stands for all that a place, or the start, has ways to.
    fn root(&self, place: Option<usize>) -> usize {
        let mut at = place.unwrap_or(self.stands.len());
        while self.joined[at] != at {
            at = self.joined[at];
        }
        at
    }

    /// Whether a search between places that have ways to these two found none: it need not be made again.
    fn is_apart(&self, (a, b): Pair) -> bool {
        let ends = [self.root(a), self.root(b)];
        let mut apart = self.apart.iter();
        apart.any(|(x, y)| {
            let [x, y] = [self.root(*x), self.root(*y)];
            ends == [x, y] || ends == [y, x]
        })
    }

    /// The route of an order.
    pub fn finish(
        &self,
        cell: &Cell,
        plan: &[Vec<f64>],
        ways: &mut Moves<'_>,
        order: &[usize],
        options: &RouteOptions,
    ) -> Result<Route> {
        let stop_of = |place: Option<usize>| place.and_then(|place| order.iter().position(|other| *other == place));
        let rules = &cell.route;
        let mut moves = Vec::new();
        for (a, b) in self.pairs(order) {
            let way = self.pair_ways.get(&(a.min(b), a.max(b))).cloned().flatten();
            let mut via = way.as_ref().map_or(Vec::new(), |way| way.via.clone());
            if a > b {
                via.reverse();
            }
            let mut approached = Vec::new();
            if let (Some(turn), Some(_), Some(_)) = (rules.approach, &way, b) {
                let last = via.last().map_or(self.at(a), |via| via);
                let Approach { via: end, joints } = approach(cell, ways, last, self.at(b), turn)?;
                via.extend(end);
                approached = joints;
            }
            let mut legs = vec![self.at(a).to_vec()];
            legs.extend(via.iter().cloned());
            legs.push(self.at(b).to_vec());
            moves.push(RouteMove {
                from: stop_of(a),
                to: stop_of(b),
                free: way.is_some(),
                time_s: (way.is_some() && rules.joint_speeds.is_some())
                    .then(|| ways.seconds_along(&legs) / rules.speed_share),
                turn: legs.windows(2).map(|leg| largest_change(&leg[0], &leg[1])).sum(),
                nearest: nearest(cell, ways, &legs, way.is_some())?,
                via,
                approached,
            });
        }
        let posture = |place: &usize| self.places.posture[*place];
        let postures: Vec<Vec<f64>> = order.iter().map(|place| self.stands[*place].clone()).collect();
        let numbered = order.iter().zip(&postures).enumerate();
        Ok(Route {
            repeats: Vec::new(),
            turned: numbered.filter(|(_, (place, q))| plan[posture(place)] != **q).map(|(stop, _)| stop).collect(),
            order: order.iter().map(posture).collect(),
            travel_s: moves.iter().map(|m| m.time_s).sum(),
            turn: moves.iter().map(|m| m.turn).sum::<f64>() + 0.0,
            checked: ways.cell.limit_kinds(),
            // Ways are weighed without their approach.
            shortest: (!options.keep_order).then(|| self.places.is_small() && rules.approach.is_none()),
            postures,
            moves,
        })
    }
}
