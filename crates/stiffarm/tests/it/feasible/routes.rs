//! Routes in random cells: every move that is called free is looked at densely by the checker, every one that is
//! not must touch something on the straight way, and the order is held against all orders.

use super::cases::Case;
use super::checker::Checker;
use super::run::leave_out;
use crate::common::prelude::*;
use stiffarm::plan::route::{Route, RouteOptions, route};

/// Turn between two looks \[rad\].
const LOOK_EACH: f64 = 1.5e-3;
/// What a dense look may find less than half the distance \[m\]: stretches that the library takes as
/// proved are this short.
const TOLERANCE: f64 = 1.5e-4;

/// First cell of the test.
const FIRST: u64 = 15;

/// What became of one plan.
#[derive(Debug, Default, Clone, Copy)]
pub struct Looked {
    pub moves: u64,
    pub over_vias: u64,
    pub blocked: u64,
    /// Length of the order over that of the best one.
    pub excess: f64,
    pub looks: u64,
}

/// A plan of random feasible postures in cell `number`; `None` where the cell allows none.
///
/// # Errors
/// What is wrong.
pub fn look(number: u64) -> Result<Option<Looked>, String> {
    let case = Case::new(number);
    let mut checker = Checker::new(&case);
    let Ok(cell) = parse_cell(&case.text(), "random.toml") else {
        return Ok(None);
    };
    leave_out(&mut checker, &case, &cell, number)?;
    let count = 3 + Dice::new(40_000 + number).below(8);
    let Ok(plan) = random_group(&cell, StartKind::Uniform, count, number, 7) else {
        return Ok(None);
    };
    let route = routed(&cell, &plan, false)?;
    let mut looked = Looked::default();
    for each in &route.moves {
        looked.moves += 1;
        let ends = [each.from, each.to].map(|stop| route.postures[stop.unwrap()].clone());
        let [from, to] = ends;
        if !each.free {
            looked.blocked += 1;
            // The pair is named, and rightly: the straight way does touch something.
            let (least, looks) = least_room(&checker, &[from, to]);
            looked.looks += looks;
            if least > TOLERANCE {
                return Err(format!("a move is called blocked and has {least} m"));
            }
            continue;
        }
        looked.over_vias += u64::from(!each.via.is_empty());
        let legs = [vec![from], each.via.clone(), vec![to]].concat();
        let (least, looks) = least_room(&checker, &legs);
        looked.looks += looks;
        if least < -TOLERANCE {
            return Err(format!("a move called free lacks {} m", -least));
        }
    }
    // A pair without a way is looked for at length, and all pairs of such a plan would take minutes.
    if looked.blocked == 0 {
        looked.excess = excess(&cell, &plan, &route)?;
    }
    Ok(Some(looked))
}

fn routed(cell: &Cell, plan: &[Vec<f64>], keep_order: bool) -> Result<Route, String> {
    let mut options = RouteOptions::default();
    options.keep_angles = true;
    options.keep_order = keep_order;
    route(cell, plan, &options, Control::default()).map_err(|error| error.to_string())
}

/// The least room along joint moves, and the number of looks.
fn least_room(checker: &Checker<'_>, legs: &[Vec<f64>]) -> (f64, u64) {
    let (mut least, mut looks) = (f64::INFINITY, 0);
    for leg in legs.windows(2) {
        let turns = leg[0].iter().zip(&leg[1]).map(|(a, b)| (a - b).abs());
        let steps = (turns.fold(0.0, f64::max) / LOOK_EACH).ceil().max(1.0);
        for step in 0..=steps as u64 {
            let share = step as f64 / steps;
            let q: Vec<f64> = leg[0].iter().zip(&leg[1]).map(|(a, b)| a * (1.0 - share) + b * share).collect();
            least = least.min(checker.room_on_the_way(&q));
            looks += 1;
        }
    }
    (least, looks)
}

/// How much longer the route's order is than the best, all ways being what the library finds for each pair.
fn excess(cell: &Cell, plan: &[Vec<f64>], route: &Route) -> Result<f64, String> {
    let n = plan.len();
    let mut length = vec![vec![0.0; n]; n];
    for a in 0..n {
        for b in a + 1..n {
            let pair = routed(cell, &[plan[a].clone(), plan[b].clone()], true)?;
            let turn = if pair.moves[0].free {
                pair.moves[0].time_s.unwrap_or(pair.moves[0].turn)
            } else {
                // No way: never in the best order if there is another.
                1e4
            };
            (length[a][b], length[b][a]) = (turn, turn);
        }
    }
    let total: f64 = route.order.windows(2).map(|p| length[p[0]][p[1]]).sum();
    Ok(total / shortest(&length) - 1.0)
}

/// The length of the shortest way through all points, by going through all orders but for those that
/// are longer already.
fn shortest(length: &[Vec<f64>]) -> f64 {
    fn on(length: &[Vec<f64>], seen: u32, at: usize, so_far: f64, best: &mut f64) {
        if so_far >= *best {
            return;
        }
        if seen.count_ones() as usize == length.len() {
            *best = so_far;
            return;
        }
        for next in 0..length.len() {
            if seen >> next & 1 == 0 {
                let longer = so_far + length[at][next];
                on(length, seen | 1 << next, next, longer, best);
            }
        }
    }
    let mut best = f64::INFINITY;
    for first in 0..length.len() {
        on(length, 1 << first, first, 0.0, &mut best);
    }
    best
}

#[test]
fn free_moves_touch_nothing_and_the_order_is_the_shortest() {
    let plans = runs(4);
    let (mut total, mut seen) = (Looked::default(), 0);
    // Cells with something in the way are among the first of these.
    for number in FIRST..FIRST + plans {
        match look(number) {
            Ok(None) => {}
            Ok(Some(looked)) => {
                seen += 1;
                total.moves += looked.moves;
                total.over_vias += looked.over_vias;
                total.blocked += looked.blocked;
                total.excess = total.excess.max(looked.excess);
            }
            Err(what) => panic!("cell {number}: {what}"),
        }
    }
    assert!(total.excess < 0.05, "{total:?}");
    // Cells in which something is in the way are among them, and ways around it.
    assert!(2 * seen > plans && total.over_vias > 0, "{total:?}");
    assert!(10 * total.blocked < total.moves, "{total:?}");
}
