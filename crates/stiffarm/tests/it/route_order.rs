//! The order of a route is held against every other order.

use crate::common::prelude::*;
use rand::RngExt;
use stiffarm::internals::Places;
use stiffarm::internals::streams::route_rng;

/// As many as the product makes.
const KICKS: usize = 2000;

/// Random places with some equivalents, at the distances of points in space.
fn random(rng: &mut impl RngExt, count: usize, most: usize, start: bool) -> Places {
    let mut posture = Vec::new();
    for p in 0..count {
        posture.extend(std::iter::repeat_n(p, rng.random_range(1..=most)));
    }
    let mut point = || [0; 4].map(|_: i32| rng.random::<f64>());
    let points: Vec<[f64; 4]> = posture.iter().map(|_| point()).collect();
    let home = point();
    let apart = |a: &[f64; 4], b: &[f64; 4]| {
        let turns = a.iter().zip(b).map(|(a, b)| (a - b).abs());
        turns.fold(0.0, f64::max)
    };
    Places {
        cost: points.iter().map(|a| points.iter().map(|b| apart(a, b)).collect()).collect(),
        start: start.then(|| points.iter().map(|p| apart(p, &home)).collect()),
        posture,
        count,
    }
}

/// The shortest length by trying every order with every equivalent.
fn exhaustive(places: &Places, order: &mut Vec<usize>, best: &mut f64) {
    if order.len() == places.count {
        *best = best.min(places.length(order));
        return;
    }
    for place in 0..places.posture.len() {
        let posture = places.posture[place];
        if order.iter().all(|other| places.posture[*other] != posture) {
            order.push(place);
            exhaustive(places, order, best);
            order.pop();
        }
    }
}

#[test]
fn the_recursion_finds_the_shortest_of_all_orders() {
    let mut rng = route_rng(3, 9);
    for case in 0..40 {
        let places = random(&mut rng, 1 + case % 5, 1 + case % 3, case % 2 == 0);
        let order = places.by_recursion();
        let mut seen: Vec<usize> = order.iter().map(|p| places.posture[*p]).collect();
        seen.sort_unstable();
        assert_eq!(seen, (0..places.count).collect::<Vec<_>>());
        let mut best = f64::INFINITY;
        exhaustive(&places, &mut Vec::new(), &mut best);
        assert!((places.length(&order) - best).abs() < 1e-12, "case {case}");
    }
}

#[test]
fn exchanges_come_close_to_the_shortest_order() {
    let mut rng = route_rng(4, 9);
    let (mut worst, mut sum) = (0.0_f64, 0.0);
    for case in 0..200 {
        let places = random(&mut rng, 4 + case % 7, 1 + case % 3, case % 2 == 0);
        let best = places.length(&places.by_recursion());
        let length = places.length(&places.by_exchanges(None, KICKS, 1, Control::default()));
        let excess = length / best - 1.0;
        worst = worst.max(excess);
        sum += excess;
    }
    assert!(worst < 0.05, "{worst}, mean {}", sum / 200.0);
}

/// What was short is where the search goes on from, once some of its moves cost more.
#[test]
fn an_order_that_is_known_is_never_made_longer() {
    let mut rng = route_rng(5, 9);
    for (count, start) in [(1, false), (2, true), (20, false), (60, true), (130, false)] {
        let mut places = random(&mut rng, count, 3, start);
        let tour = places.by_exchanges(None, KICKS, 1, Control::default());
        for pair in tour.windows(2).step_by(4) {
            places.cost[pair[0]][pair[1]] += 0.3;
            places.cost[pair[1]][pair[0]] += 0.3;
        }
        let again = places.by_exchanges(Some(&tour), KICKS, 1, Control::default());
        let mut seen: Vec<usize> = again.iter().map(|p| places.posture[*p]).collect();
        seen.sort_unstable();
        assert_eq!(seen, (0..count).collect::<Vec<_>>());
        let [before, after] = [&tour, &again].map(|order| places.length(order));
        assert!(after <= before + 1e-9, "{count}: {before} {after}");
        // Nothing is gained by a search from nowhere.
        let anew = places.length(&places.by_exchanges(None, KICKS, 1, Control::default()));
        assert!(after <= 1.02 * anew, "{count}: {after} {anew}");
    }
}
