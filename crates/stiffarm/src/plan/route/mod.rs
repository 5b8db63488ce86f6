//! A plan as it is driven: angles that one can type, the order of the postures, and the joint moves between
//! them, checked for what they might touch.
//!
//! Selection decides which postures are worth measuring; nothing here changes what they are worth, but
//! for the rounding of their angles. Postures are measured standing still, so the order is free,
//! and of the postures that measure the same (other turns; about the axes alone also the wrist the other
//! way round, see [`RouteOptions::keep_wrist`]) the one is taken that is nearest.

mod approach;
mod equivalent;
mod exchanges;
mod moves;
mod nearest;
mod order;
pub(crate) mod places;
mod planned_route;
mod remarks;
mod rounding;
mod search;
mod tour;
mod via_path;

pub use planned_route::{NearestOnTheWay, Route, RouteMove, RouteOptions};
pub use remarks::{not_approached, route_findings};

use crate::error::Result;
use crate::model::cell::Cell;
use crate::model::observation::{PostureTerms, check_angles};
use crate::numerics::control::Control;
use crate::plan::select::repeats;
use equivalent::Equivalents;
use moves::{Moves, on_the_way};
use places::Places;
use rounding::Rounding;
use tour::Tour;

/// Most equivalents of a posture that are looked at, and most of all postures together.
const MOST_EQUIVALENTS: usize = 6;
const MOST_PLACES: usize = 1200;

/// The postures (controller angles, rad) rounded to whole steps \[deg\], each to the nearest that meets
/// bounds and limits of the cell. One that meets them nowhere near is rounded all the same.
///
/// # Errors
/// A step that is not above zero; angles that do not fit the robot; a rope without a direction.
pub fn rounded<Q: AsRef<[f64]>>(cell: &Cell, postures: &[Q], step_deg: f64) -> Result<Vec<Vec<f64>>> {
    let mut rounding = Rounding::new(cell, step_deg)?;
    let each = postures.iter().map(|q| {
        let q = q.as_ref();
        check_angles(&cell.setup.robot, q)?;
        let rounded = rounding.inside(q)?;
        Ok(rounded.unwrap_or_else(|| rounding::nearest(q, step_deg)))
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
/// use stiffarm::Control;
/// use stiffarm_files::builtin;
/// use stiffarm::plan::route::{RouteOptions, route};
///
/// let cell = builtin::cell("comau-shapes")?;
/// let plan = [vec![0.0, 0.2, -1.6, 0.0, 0.5, 0.0], vec![0.4, 0.3, -1.5, 0.2, 0.4, 0.1]];
/// let route = route(&cell, &plan, &RouteOptions::default(), Control::default())?;
/// assert_eq!(route.moves.len(), 1);
/// assert!(route.moves[0].free);
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// Angles that do not fit the robot; stopped before there was a route.
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
    let mut ways = Moves::new(&way_cell, speeds, options.seed, control)?;
    let (stands, of) = standing_places(cell, &plan, options, control)?;
    let alike = alike(&stands, &of);
    let places = places(&ways, cell, plan.len(), &stands, of, &alike);
    let mut tour = Tour::new(places, stands, cell.route.start.as_deref());
    let order = tour.order(&mut ways, plan.len(), options, control)?;
    let mut route = tour.finish(cell, &plan, &mut ways, &order, options)?;
    route.repeats = repeated(&route.order, &alike);
    Ok(route)
}

/// Where the robot may stand for each posture, and whose each is.
fn standing_places(
    cell: &Cell,
    plan: &[Vec<f64>],
    options: &RouteOptions,
    control: Control<'_>,
) -> Result<(Vec<Vec<f64>>, Vec<usize>)> {
    let most = (MOST_PLACES / plan.len().max(1)).clamp(1, MOST_EQUIVALENTS);
    let mut equivalents = Equivalents::new(cell, options, most)?;
    let (mut stands, mut of) = (Vec::new(), Vec::new());
    for (posture, q) in plan.iter().enumerate() {
        control.check()?;
        let alternatives = if options.keep_angles { vec![q.clone()] } else { equivalents.of(q)? };
        of.extend(std::iter::repeat_n(posture, alternatives.len()));
        stands.extend(alternatives);
    }
    Ok((stands, of))
}

/// For each posture the first one that measures the same: in one of their equivalents they are the
/// same within half a degree in every joint.
fn alike(stands: &[Vec<f64>], of: &[usize]) -> Vec<usize> {
    let count = of.last().map_or(0, |last| last + 1);
    let mut first: Vec<usize> = (0..count).collect();
    for group in repeats(stands) {
        let mut firsts: Vec<usize> = group.iter().map(|stand| first[of[*stand]]).collect();
        firsts.sort_unstable();
        firsts.dedup();
        for other in first.iter_mut().filter(|other| firsts.contains(other)) {
            *other = firsts[0];
        }
    }
    first
}

/// Groups of stops that measure the same.
fn repeated(order: &[usize], alike: &[usize]) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for stop in 0..order.len() {
        let same = |group: &&mut Vec<usize>| alike[order[group[0]]] == alike[order[stop]];
        match groups.iter_mut().find(same) {
            Some(group) => group.push(stop),
            None => groups.push(vec![stop]),
        }
    }
    groups.retain(|group| group.len() > 1);
    groups
}

/// The places with the times of the joint moves between them.
fn places(ways: &Moves<'_>, cell: &Cell, count: usize, stands: &[Vec<f64>], of: Vec<usize>, same: &[usize]) -> Places {
    let row = |a: &Vec<f64>| stands.iter().map(|b| ways.seconds(a, b)).collect();
    let mut cost: Vec<Vec<f64>> = stands.iter().map(row).collect();
    let dearest = cost.iter().flatten().fold(0.0, |most: f64, c| most.max(*c));
    // The same posture twice: drive away in between, or the second time shows nothing of the first.
    let together = |a: usize, b: usize| a != b && same[a] == same[b];
    // No move is worth carrying the tracker to another station and back.
    let station = |q: &Vec<f64>| {
        let terms = PostureTerms::new(&cell.setup, q, None).ok()?;
        cell.scene.station_at(&terms).map(|station| station.name.as_str())
    };
    let stations: Vec<Option<&str>> = stands.iter().map(station).collect();
    let carried = dearest * count as f64;
    for (a, row) in cost.iter_mut().enumerate() {
        for (b, cost) in row.iter_mut().enumerate() {
            if together(of[a], of[b]) {
                *cost += 2.0 * dearest;
            }
            if stations[a] != stations[b] {
                *cost += carried;
            }
        }
    }
    let start = cell.route.start.as_ref();
    Places {
        start: start.map(|start| stands.iter().map(|q| ways.seconds(start, q)).collect()),
        posture: of,
        count,
        cost,
    }
}
