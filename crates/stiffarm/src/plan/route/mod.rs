//! A plan as it is driven: angles that one can type, the order of the postures, and the joint moves between
//! them, checked for what they might touch.
//!
//! Selection decides which postures are worth measuring; nothing here changes what they are worth, but
//! for the rounding of their angles. Postures are measured standing still, so the order is free,
//! and of the postures that measure the same (other turns, the wrist the other way round) the one
//! is taken that is nearest.

mod equivalent;
mod order;
mod rounding;
mod search;
mod way;

use crate::error::Result;
use crate::model::cell::{Cell, LimitKind, LimitMargin};
use crate::model::observation::check_angles;
use crate::numerics::control::Control;
use crate::plan::select::repeats;
use equivalent::Equivalents;
use order::Places;
use rounding::Rounding;
use serde::Serialize;
use std::collections::HashMap;
use way::{Way, Ways, between, on_the_way};

/// Steps of the angles of via postures \[deg\].
const VIA_STEP_DEG: f64 = 0.01;
/// Most equivalents of a posture that are looked at, and most of all postures together.
const MOST_EQUIVALENTS: usize = 6;
const MOST_PLACES: usize = 1200;
/// Times that the order is looked for again after moves turned out to be in the way of something.
const MOST_ORDERS: usize = 60;
/// Cost of a move without a known way, against the dearest that has one.
const BLOCKED: f64 = 1e3;
/// Turn between two looks for what comes nearest on a move \[rad\].
const LOOK_EACH: f64 = 0.01;

/// How a route is looked for.
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct RouteOptions {
    /// Keeps the postures in their order.
    pub keep_order: bool,
    /// Keeps their angles; else equivalent postures may stand in.
    pub keep_angles: bool,
    /// Steps of which the plan's angles are whole multiples \[deg\], where they are.
    pub step_deg: Option<f64>,
    /// Seed of the random numbers.
    pub seed: u64,
}

/// Postures in measuring order with the moves between them.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Route {
    /// For each stop the position of its posture in the plan.
    pub order: Vec<usize>,
    /// The stops, controller angles \[rad\]: the plan's postures or equivalents of them.
    #[serde(rename = "postures_deg", with = "crate::units::degrees")]
    #[cfg_attr(
        feature = "schema",
        schemars(
            with = "Vec<Vec<f64>>",
            description = "The stops, controller angles \\[deg\\]: the plan's postures or equivalents of them."
        )
    )]
    pub postures: Vec<Vec<f64>>,
    /// Stops whose angles differ from the plan's.
    pub turned: Vec<usize>,
    /// The moves: to each stop from the one before; with a start also from it and back to it.
    pub moves: Vec<RouteMove>,
    /// Time of all moves at the speed of the cell \[s\], without speeding up and slowing down; `None` where
    /// joint speeds are not known or a way is missing.
    pub travel_s: Option<f64>,
    /// Sum over all moves of the largest turn of a joint \[rad\].
    #[serde(rename = "turn_deg", with = "crate::units::degrees")]
    #[cfg_attr(
        feature = "schema",
        schemars(
            with = "f64",
            description = "Sum over all moves of the largest turn of a joint \\[deg\\]."
        )
    )]
    pub turn: f64,
    /// What moves are kept clear of.
    pub checked: Vec<LimitKind>,
    /// Whether no order is shorter; `None` where the order was given.
    pub shortest: Option<bool>,
}

/// One move of a route.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RouteMove {
    /// Stop it begins at; `None` is the start.
    pub from: Option<usize>,
    /// Stop it ends at; `None` is the start.
    pub to: Option<usize>,
    /// Via postures, controller angles \[rad\].
    #[serde(rename = "via_deg", with = "crate::units::degrees")]
    #[cfg_attr(
        feature = "schema",
        schemars(
            with = "Vec<Vec<f64>>",
            description = "Via postures, controller angles \\[deg\\]."
        )
    )]
    pub via: Vec<Vec<f64>>,
    /// Whether the move, over its via postures, is free; `false` asks for a way of your own.
    pub free: bool,
    /// Time at the speed of the cell \[s\], where joint speeds are known.
    pub time_s: Option<f64>,
    /// Largest turn of a joint, summed over its legs \[rad\].
    #[serde(rename = "turn_deg", with = "crate::units::degrees")]
    #[cfg_attr(
        feature = "schema",
        schemars(
            with = "f64",
            description = "Largest turn of a joint, summed over its legs \\[deg\\]."
        )
    )]
    pub turn: f64,
    /// What comes nearest on the way; `None` where there is nothing to touch.
    pub nearest: Option<NearestOnTheWay>,
}

/// What comes nearest on a move.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct NearestOnTheWay {
    /// Kind of limit.
    pub kind: LimitKind,
    /// What comes nearest: two shapes, a point.
    pub subject: String,
    /// Distance \[m\]: of shapes from each other, of a point from the limit; looked at every half degree.
    pub distance_m: f64,
}

/// The postures (controller angles, rad) rounded to whole steps \[deg\], each to the nearest that meets
/// bounds and limits of the cell. One that meets them nowhere near is rounded all the same.
///
/// # Errors
/// A step that is not above zero; angles that do not fit the robot; a rope without a direction.
pub fn rounded<Q: AsRef<[f64]>>(
    cell: &Cell,
    postures: &[Q],
    step_deg: f64,
) -> Result<Vec<Vec<f64>>> {
    let mut rounding = Rounding::new(cell, step_deg)?;
    let each = postures.iter().map(|q| {
        let q = q.as_ref();
        check_angles(&cell.setup.robot, q)?;
        let found = rounding.inside(q)?;
        Ok(found.unwrap_or_else(|| rounding::nearest(q, step_deg)))
    });
    each.collect()
}

/// The route through postures (controller angles, rad): the shortest order by the time of the joint
/// moves, or the given one, with via postures where a move would touch something.
///
/// Moves are joint moves: all joints start and stop together, so a move lasts as long as its slowest
/// joint. Where joint speeds are not known they count as equal.
///
/// ```
/// # fn main() -> stiffarm::Result<()> {
/// # #[cfg(feature = "files")] {
/// use stiffarm::Control;
/// use stiffarm::files::builtin;
/// use stiffarm::plan::route::{RouteOptions, route};
///
/// let cell = builtin::cell("comau-shapes")?;
/// let plan = [vec![0.0, 0.2, -1.6, 0.0, 0.5, 0.0], vec![0.4, 0.3, -1.5, 0.2, 0.4, 0.1]];
/// let route = route(&cell, &plan, &RouteOptions::default(), Control::default())?;
/// assert_eq!(route.moves.len(), 1);
/// assert!(route.moves[0].free);
/// # }
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// No postures; angles that do not fit the robot; stopped before there was a route.
pub fn route<Q: AsRef<[f64]>>(
    cell: &Cell,
    postures: &[Q],
    options: &RouteOptions,
    control: Control<'_>,
) -> Result<Route> {
    let plan: Vec<Vec<f64>> = postures.iter().map(|q| q.as_ref().to_vec()).collect();
    for q in plan.iter().chain(&cell.route.start) {
        check_angles(&cell.setup.robot, q)?;
    }
    let way_cell = on_the_way(cell);
    let speeds = cell.route.joint_speeds.clone();
    let speeds = speeds.unwrap_or_else(|| vec![1.0; cell.setup.robot.joint_count()]);
    let mut ways = Ways::new(&way_cell, speeds, options.seed)?;
    let (stands, of) = standing_places(cell, &plan, options)?;
    let mut search = Search {
        places: places(&ways, cell, &plan, &stands, of),
        stands,
        start: cell.route.start.as_deref(),
        known: HashMap::new(),
        apart: Vec::new(),
    };
    let order = search.order(&mut ways, plan.len(), options, control)?;
    search.finish(cell, &plan, &way_cell, &mut ways, &order, options)
}

/// Where the robot may stand for each posture, and whose each is.
fn standing_places(
    cell: &Cell,
    plan: &[Vec<f64>],
    options: &RouteOptions,
) -> Result<(Vec<Vec<f64>>, Vec<usize>)> {
    let most = (MOST_PLACES / plan.len().max(1)).clamp(1, MOST_EQUIVALENTS);
    let mut equivalents = Equivalents::new(cell, options.step_deg, most)?;
    let (mut stands, mut of) = (Vec::new(), Vec::new());
    for (posture, q) in plan.iter().enumerate() {
        let own = match options.keep_angles {
            true => vec![q.clone()],
            false => equivalents.of(q)?,
        };
        of.extend(std::iter::repeat_n(posture, own.len()));
        stands.extend(own);
    }
    Ok((stands, of))
}

/// The places with the times of the joint moves between them.
fn places(
    ways: &Ways<'_>,
    cell: &Cell,
    plan: &[Vec<f64>],
    stands: &[Vec<f64>],
    of: Vec<usize>,
) -> Places {
    let row = |a: &Vec<f64>| stands.iter().map(|b| ways.seconds(a, b)).collect();
    let mut cost: Vec<Vec<f64>> = stands.iter().map(row).collect();
    let dearest = cost.iter().flatten().fold(0.0, |most: f64, c| most.max(*c));
    // The same posture twice: drive away in between, or the second time shows nothing of the first.
    let same: Vec<Vec<usize>> = repeats(plan);
    let together =
        |a: usize, b: usize| a != b && same.iter().any(|s| s.contains(&a) && s.contains(&b));
    for (a, row) in cost.iter_mut().enumerate() {
        for (b, cost) in row.iter_mut().enumerate() {
            if together(of[a], of[b]) {
                *cost += 2.0 * dearest;
            }
        }
    }
    let start = cell.route.start.as_ref();
    Places {
        start: start.map(|start| stands.iter().map(|q| ways.seconds(start, q)).collect()),
        posture: of,
        count: plan.len(),
        cost,
    }
}

/// A pair of places; `None` is the start.
type Pair = (Option<usize>, Option<usize>);

struct Search<'a> {
    places: Places,
    stands: Vec<Vec<f64>>,
    start: Option<&'a [f64]>,
    /// Ways that were looked for, the lower place first.
    known: HashMap<Pair, Option<Way>>,
    /// Pairs between which a search found none.
    apart: Vec<Pair>,
}

impl Search<'_> {
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
    fn order(
        &mut self,
        ways: &mut Ways<'_>,
        count: usize,
        options: &RouteOptions,
        control: Control<'_>,
    ) -> Result<Vec<usize>> {
        if count == 0 {
            return Ok(Vec::new());
        }
        for round in 0..MOST_ORDERS {
            control.check()?;
            let order = match options.keep_order {
                true => self.places.best_equivalents((0..count).collect()),
                false => self.places.shortest(options.seed),
            };
            let mut as_thought = true;
            let pairs = self.pairs(&order);
            for (done, pair) in pairs.iter().enumerate() {
                control.report("checking moves", done, pairs.len());
                as_thought &= self.look(ways, *pair)?;
            }
            if as_thought || round + 1 == MOST_ORDERS {
                return Ok(order);
            }
        }
        Ok(Vec::new())
    }

    /// Looks for the way between two places; false where it is longer than was thought.
    fn look(&mut self, ways: &mut Ways<'_>, (a, b): Pair) -> Result<bool> {
        let pair = (a.min(b), a.max(b));
        if self.known.contains_key(&pair) {
            return Ok(true);
        }
        let (from, to) = (self.at(pair.0).to_vec(), self.at(pair.1).to_vec());
        let search = !self.is_apart(pair);
        let way = ways.way(&from, &to, search)?;
        if way.is_none() && search {
            self.apart.push(pair);
        }
        let direct = ways.seconds(&from, &to);
        let more = match &way {
            Some(way) => way.seconds - direct,
            None => BLOCKED * direct.max(1.0),
        };
        self.known.insert(pair, way);
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

    /// Whether a search between places that have ways to these two found none: it need not be made again.
    fn is_apart(&self, (a, b): Pair) -> bool {
        let reached = |from: Option<usize>| {
            let mut seen = vec![from];
            let mut next = 0;
            while next < seen.len() {
                let at = seen[next];
                next += 1;
                let found = self.known.iter().filter(|(_, way)| way.is_some());
                for ((x, y), _) in found {
                    let other = match at {
                        at if at == *x => *y,
                        at if at == *y => *x,
                        _ => continue,
                    };
                    if !seen.contains(&other) {
                        seen.push(other);
                    }
                }
            }
            seen
        };
        if self.apart.is_empty() {
            return false;
        }
        let (a, b) = (reached(a), reached(b));
        let splits =
            |(x, y): &Pair| (a.contains(x) && b.contains(y)) || (a.contains(y) && b.contains(x));
        self.apart.iter().any(splits)
    }

    /// The route of an order.
    fn finish(
        &self,
        cell: &Cell,
        plan: &[Vec<f64>],
        way_cell: &Cell,
        ways: &mut Ways<'_>,
        order: &[usize],
        options: &RouteOptions,
    ) -> Result<Route> {
        let stop_of = |place: Option<usize>| {
            place.and_then(|place| order.iter().position(|other| *other == place))
        };
        let rules = &cell.route;
        let mut moves = Vec::new();
        for (a, b) in self.pairs(order) {
            let known = self.known.get(&(a.min(b), a.max(b))).cloned().flatten();
            let mut via = known.as_ref().map_or(Vec::new(), |way| way.via.clone());
            if a > b {
                via.reverse();
            }
            let mut legs = vec![self.at(a).to_vec()];
            legs.extend(via.iter().cloned());
            legs.push(self.at(b).to_vec());
            moves.push(RouteMove {
                from: stop_of(a),
                to: stop_of(b),
                free: known.is_some(),
                time_s: (known.is_some() && rules.joint_speeds.is_some())
                    .then(|| ways.seconds_along(&legs) / rules.speed_share),
                turn: legs
                    .windows(2)
                    .map(|leg| largest_turn(&leg[0], &leg[1]))
                    .sum(),
                nearest: nearest(way_cell, cell, &legs)?,
                via,
            });
        }
        let posture = |place: &usize| self.places.posture[*place];
        let postures: Vec<Vec<f64>> = order
            .iter()
            .map(|place| self.stands[*place].clone())
            .collect();
        let numbered = order.iter().zip(&postures).enumerate();
        Ok(Route {
            turned: numbered
                .filter(|(_, (place, q))| plan[posture(place)] != **q)
                .map(|(stop, _)| stop)
                .collect(),
            order: order.iter().map(posture).collect(),
            travel_s: moves.iter().map(|m| m.time_s).sum(),
            turn: moves.iter().map(|m| m.turn).sum(),
            checked: way_cell.limit_kinds(),
            shortest: (!options.keep_order).then(|| self.places.is_small()),
            postures,
            moves,
        })
    }
}

/// What comes nearest along the legs of a move.
fn nearest(way_cell: &Cell, cell: &Cell, legs: &[Vec<f64>]) -> Result<Option<NearestOnTheWay>> {
    let mut margins = way_cell.posture_margins()?;
    let mut least: Option<NearestOnTheWay> = None;
    for leg in legs.windows(2) {
        let looks = (largest_turn(&leg[0], &leg[1]) / LOOK_EACH).ceil().max(1.0) as usize;
        for look in 0..=looks {
            let q = between(&leg[0], &leg[1], look as f64 / looks as f64);
            let Some(margin) = margins.smallest(&q)? else {
                return Ok(None);
            };
            let distance_m = margin.margin + allowance(cell, way_cell, &margin);
            if least.as_ref().is_none_or(|l| distance_m < l.distance_m) {
                least = Some(NearestOnTheWay {
                    kind: margin.kind,
                    subject: margin.point,
                    distance_m,
                });
            }
        }
    }
    Ok(least)
}

/// What a margin of the way's cell leaves out of the distance itself.
fn allowance(cell: &Cell, way_cell: &Cell, margin: &LimitMargin) -> f64 {
    let less = |own: Option<f64>, way: Option<f64>| way.zip(own).map_or(0.0, |(w, o)| w - o);
    match margin.kind {
        LimitKind::Shapes => way_cell.scene.clearance(),
        LimitKind::RopeClearance => {
            let rope = way_cell.scene.rope();
            rope.and_then(|rope| rope.clearance).unwrap_or(0.0)
        }
        LimitKind::Floor => less(cell.limits.floor, way_cell.limits.floor),
        LimitKind::KeepOut => less(cell.limits.keep_out_radius, way_cell.limits.keep_out_radius),
        _ => 0.0,
    }
}

fn largest_turn(a: &[f64], b: &[f64]) -> f64 {
    let turns = a.iter().zip(b);
    turns.fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()))
}
