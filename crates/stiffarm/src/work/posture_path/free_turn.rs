//! Paths with a free turn about the tool axis: the cheapest way through the
//! turns and branches of all points.
//!
//! Free turns are a shortest way. Local descent along a path stays in the
//! branch and the turn it began with; dynamic programming over turns and
//! branches finds the best of the grid whatever the start, and three finer
//! passes about it the rest. A price on joint motion keeps the way smooth,
//! since the deflection is flat about its minimum.

use super::{Search, change, turned};
use crate::error::{Code, Error, Result};
use crate::model::inverse::Method;
use crate::model::kinematics::Frames;
use crate::model::load::Wrench;
use crate::model::path::{feed_axes, load_axes, tip_wrench};
use crate::numerics::control::Control;
use crate::numerics::jobs::{in_order, in_order_watched};
use nalgebra::Isometry3;
use std::f64::consts::{PI, TAU};

/// Most points at which turns are chosen; between them they are interpolated.
const KNOTS: usize = 400;
/// Cost of a radian squared between two knots, in the mean squared deflection of
/// the best postures: half a radian costs as much as a whole point, so that
/// large motions are made only where they pay, and in many small steps.
const SMOOTH: f64 = 4.0;
/// Finer grids about the way found, and turns on either side of it.
const REFINEMENTS: usize = 3;
const BESIDE: i32 = 4;
/// Times that points between knots become knots, where the way there is forbidden.
const ROUNDS: usize = 4;
/// Full turns of joints that are kept at a node.
const FULL_TURNS: usize = 4;

/// The way found.
pub(super) struct TurnedPath {
    pub(super) q: Vec<Vec<f64>>,
    /// Turns about the tool axis \[rad\].
    pub(super) turns: Vec<f64>,
}

/// A posture that may be taken at a knot.
#[derive(Debug, Clone)]
struct Node {
    q: Vec<f64>,
    /// Turn about the tool axis \[rad\].
    turn: f64,
    /// What bounds, limits and shapes are from allowing it, where that counts.
    missing: f64,
    /// Squared deflection \[m²\].
    cost: f64,
}

impl Node {
    fn new(search: &Search<'_>, q: Vec<f64>, turn: f64, load: &Wrench) -> Result<Self> {
        Ok(Node { missing: search.counted(&q)?, cost: search.deflection(&q, load)?.powi(2), q, turn })
    }
}

/// Postures with the tip at `poses` up to a turn about z. `unturned_postures` are a way that
/// is known, which the result may not be worse than at the knots.
pub(super) fn postures(
    search: &Search<'_>,
    poses: &[Isometry3<f64>],
    unturned_postures: Option<&[Vec<f64>]>,
    control: Control<'_>,
) -> Result<TurnedPath> {
    let mut knots = knots(poses);
    let mut turned_postures = through(search, poses, &knots, unturned_postures, control)?;
    for _ in 0..ROUNDS {
        let before = knots.len();
        let missing = in_order(&turned_postures.q, |(_, q)| search.counted(q))?;
        knots.extend(worst_of_runs(&missing));
        knots.sort_unstable();
        knots.dedup();
        if knots.len() == before {
            break;
        }
        turned_postures = through(search, poses, &knots, unturned_postures, control)?;
    }
    Ok(turned_postures)
}

/// The point of each run of points with something missing at which most is.
fn worst_of_runs(missing: &[f64]) -> Vec<usize> {
    let mut worst: Vec<usize> = Vec::new();
    for (i, here) in missing.iter().enumerate().filter(|(_, here)| **here > 0.0) {
        match worst.last_mut() {
            Some(last) if i > 0 && missing[*last..i].iter().all(|m| *m > 0.0) => {
                if *here > missing[*last] {
                    *last = i;
                }
            }
            _ => worst.push(i),
        }
    }
    worst
}

/// The way with turns chosen at `knots`.
fn through(
    search: &Search<'_>,
    poses: &[Isometry3<f64>],
    knots: &[usize],
    unturned_postures: Option<&[Vec<f64>]>,
    control: Control<'_>,
) -> Result<TurnedPath> {
    let feeds = load_axes(feed_axes(poses));
    // The feed does not depend on the turn.
    let wrench = |i: usize, tip: &Isometry3<f64>| {
        let (process, workpiece) = (search.options.process.as_ref(), &search.options.workpiece);
        tip_wrench(&search.points[i], tip, feeds[i].as_ref(), process, workpiece)
    };
    let count = search.options.turns.max(1);
    let spacing = TAU / count as f64;
    let closed = search.inverse.method() == Method::ClosedForm;
    let mut layers: Vec<Vec<Node>> = if closed {
        in_order_watched(knots, "turns about the tool axis", control, |(_, &i)| {
            let mut layer = Vec::new();
            let mut frames = Frames::zero(search.arm.robot().joint_count());
            for k in 0..count {
                let turn = wrapped(k as f64 * spacing);
                let tip = turned(&poses[i], turn);
                let flange = search.flange(&tip);
                let mut postures = search.inverse.each_posture(&flange).map_err(|e| search.at(i, e))?;
                while let Some(q) = postures.as_mut().and_then(|postures| postures.next(&mut frames)) {
                    add(search, &mut layer, &q, turn, &wrench(i, &tip)?)?;
                }
            }
            Ok(layer)
        })?
    } else {
        swept(search, poses, knots, spacing, count, &wrench, control)?
    };
    if let Some(unturned_postures) = unturned_postures {
        for (layer, &i) in layers.iter_mut().zip(knots) {
            let load = wrench(i, &poses[i])?;
            layer.push(Node::new(search, unturned_postures[i].clone(), 0.0, &load)?);
        }
    }
    if let Some((_, &i)) = layers.iter().zip(knots).find(|(layer, _)| layer.is_empty()) {
        return Err(blocked(search, poses, i));
    }
    let least = layers.iter().map(|l| l.iter().map(|n| n.cost).fold(f64::INFINITY, f64::min));
    let smooth = SMOOTH * least.sum::<f64>() / layers.len() as f64;
    let mut way = cheapest(search, &layers, knots, smooth, control)?;
    let mut finer = spacing;
    for _ in 0..REFINEMENTS {
        finer /= f64::from(BESIDE);
        let around: Vec<(usize, Node)> = knots.iter().copied().zip(way.iter().cloned()).collect();
        layers = in_order_watched(&around, "finer turns", control, |(_, (i, node))| {
            let mut layer = vec![node.clone()];
            for side in -BESIDE..=BESIDE {
                let turn = node.turn + f64::from(side) * finer;
                let tip = turned(&poses[*i], turn);
                // Where the branch ends nearby there is nothing to refine.
                let Ok(q) = search.inverse.follow(&search.flange(&tip), &node.q) else {
                    continue;
                };
                if side != 0 && search.arm.robot().outside_limits(&q).is_none() {
                    layer.push(Node::new(search, q, turn, &wrench(*i, &tip)?)?);
                }
            }
            Ok(layer)
        })?;
        way = cheapest(search, &layers, knots, smooth, control)?;
    }
    between(search, poses, knots, &way)
}

/// Why point `i` has no posture whatever the turn: what the first turn says.
fn blocked(search: &Search<'_>, poses: &[Isometry3<f64>], i: usize) -> Error {
    let joints = search.arm.robot().joints().iter();
    let middle: Vec<f64> = joints.map(|j| 0.5 * (j.limits[0] + j.limits[1])).collect();
    let first = search.inverse.nearest(&search.flange(&poses[i]), &middle);
    let error = first.err().unwrap_or_else(|| {
        let message = "no turn about the tool axis is within the limits.";
        Error::new(Code::OutsideLimits, message)
    });
    search.named(i, &error)
}

/// The points at which turns are chosen: all, or so many evenly along the path.
fn knots(poses: &[Isometry3<f64>]) -> Vec<usize> {
    let count = poses.len();
    if count <= KNOTS {
        return (0..count).collect();
    }
    let mut along = vec![0.0];
    for pair in poses.windows(2) {
        let step = (pair[1].translation.vector - pair[0].translation.vector).norm();
        // A turn on the spot is a way, too.
        let step = step + 1e-3 * pair[0].rotation.angle_to(&pair[1].rotation);
        along.push(along[along.len() - 1] + step);
    }
    let length = along[count - 1];
    let mut knots: Vec<usize> = (0..KNOTS)
        .map(|k| along.partition_point(|s| *s < length * k as f64 / (KNOTS - 1) as f64))
        .map(|i| i.min(count - 1))
        .collect();
    knots[0] = 0;
    knots[KNOTS - 1] = count - 1;
    knots.dedup();
    knots
}

/// Adds the full turns of `q` that are within the limits.
fn add(search: &Search<'_>, layer: &mut Vec<Node>, q: &[f64], turn: f64, load: &Wrench) -> Result<()> {
    let mut turns = search.inverse.turns_within_limits(q);
    if turns.is_empty() {
        return Ok(());
    }
    turns.sort_by(|a, b| search.off_centre(a).total_cmp(&search.off_centre(b)));
    // Bounds count among full turns alone; each is as good by all else.
    let first = Node::new(search, turns[0].clone(), turn, load)?;
    let beyond = |q: &[f64]| if search.keeps { search.arm.at_work().beyond_bounds(q) } else { 0.0 };
    let room = first.missing - beyond(&first.q);
    for q in turns.into_iter().take(FULL_TURNS) {
        layer.push(Node { missing: room + beyond(&q), q, ..first });
    }
    Ok(())
}

/// Nodes of an arm without closed form: postures of the first knot, swept over
/// the turns and then from knot to knot.
fn swept(
    search: &Search<'_>,
    poses: &[Isometry3<f64>],
    knots: &[usize],
    spacing: f64,
    count: usize,
    wrench: &dyn Fn(usize, &Isometry3<f64>) -> Result<Wrench>,
    control: Control<'_>,
) -> Result<Vec<Vec<Node>>> {
    let inside = |q: &[f64]| search.arm.robot().outside_limits(q).is_none();
    let step = |last: usize, i: usize, turn: f64, from: &[f64]| -> Result<Option<Node>> {
        let tip = turned(&poses[i], turn);
        let Ok(q) = search.inverse.follow(&search.flange(&tip), from) else {
            return Ok(None);
        };
        if !inside(&q) || change(from, &q).1 > search.largest_step(last, i) {
            return Ok(None);
        }
        Node::new(search, q, turn, &wrench(i, &tip)?).map(Some)
    };
    let mut first: Vec<Node> = Vec::new();
    for q in search.branches(0, &poses[0])?.iter().filter(|q| inside(q)) {
        for sign in [1.0, -1.0] {
            let mut from = q.clone();
            for k in 0..=count / 2 {
                let Some(node) = step(0, 0, sign * k as f64 * spacing, &from)? else {
                    break;
                };
                from.clone_from(&node.q);
                first.push(node);
            }
        }
    }
    let mut layers = vec![first];
    for (k, &i) in knots.iter().enumerate().skip(1) {
        if control.stopped() {
            return Err(Error::new(Code::Interrupted, "Interrupted."));
        }
        let mut layer = Vec::new();
        for node in &layers[k - 1] {
            layer.extend(step(knots[k - 1], i, node.turn, &node.q)?);
        }
        layers.push(layer);
        control.report("turns about the tool axis", k, knots.len());
    }
    Ok(layers)
}

/// The sums of a node that no way leads to.
const NO_WAY: (f64, f64) = (f64::INFINITY, f64::INFINITY);

/// The cheapest way through the layers without a jump.
fn cheapest(
    search: &Search<'_>,
    layers: &[Vec<Node>],
    knots: &[usize],
    smooth: f64,
    control: Control<'_>,
) -> Result<Vec<Node>> {
    // What is missing first, then the deflections.
    let mut sums: Vec<(f64, f64)> = layers[0].iter().map(|n| (n.missing + from_start(search, n), n.cost)).collect();
    let mut back: Vec<Vec<u32>> = vec![Vec::new()];
    for (k, pair) in layers.windows(2).enumerate() {
        if control.stopped() {
            return Err(Error::new(Code::Interrupted, "Interrupted."));
        }
        let (from, to) = (&pair[0], &pair[1]);
        // Neighbours in the first joint: only these can be near in all of them.
        let mut order: Vec<u32> = (0..from.len() as u32).collect();
        let first = |a: &u32| from[*a as usize].q[0];
        order.sort_by(|a, b| first(a).total_cmp(&first(b)));
        let reach = search.largest_step(knots[k], knots[k + 1]);
        let indices: Vec<usize> = (0..to.len()).collect();
        let steps = in_order(&indices, |(_, &b)| {
            let node = &to[b];
            let begin = order.partition_point(|a| first(a) < node.q[0] - reach);
            let mut best = (NO_WAY, u32::MAX);
            for &a in order[begin..].iter().take_while(|a| first(a) <= node.q[0] + reach) {
                let sum = sums[a as usize];
                if sum >= best.0 {
                    continue;
                }
                let before = &from[a as usize].q;
                if change(before, &node.q).1 > reach {
                    continue;
                }
                let way: f64 = before.iter().zip(&node.q).map(|(a, b)| (a - b).powi(2)).sum();
                let total = (sum.0, sum.1 + smooth * way);
                if total < best.0 {
                    best = (total, a);
                }
            }
            let (missing, cost) = best.0;
            Ok(((missing + node.missing, cost + node.cost), best.1))
        })?;
        sums = steps.iter().map(|s| s.0).collect();
        back.push(steps.into_iter().map(|s| s.1).collect());
        if sums.iter().all(|s| s.0.is_infinite()) {
            let (before, i) = (knots[k], knots[k + 1]);
            let message = format!(
                "From point {} to {} every posture jumps, whatever the turn about the tool axis.",
                search.points[before].name, search.points[i].name
            );
            let error = Error::invalid(message).hint("give more points between these two, or allow larger steps");
            return Err(search.at(i, error));
        }
    }
    let mut at = (0..sums.len())
        .min_by(|a, b| {
            let order = sums[*a].0.total_cmp(&sums[*b].0);
            order.then(sums[*a].1.total_cmp(&sums[*b].1))
        })
        .unwrap_or(0);
    let mut way = Vec::with_capacity(layers.len());
    for (layer, back) in layers.iter().zip(&back).rev() {
        way.push(layer[at].clone());
        at = back.get(at).map_or(0, |a| *a as usize);
    }
    way.reverse();
    Ok(way)
}

/// Keeps the first posture near the wanted one, where one is.
fn from_start(search: &Search<'_>, node: &Node) -> f64 {
    match &search.options.start {
        Some(start) if change(start, &node.q).1 > PI / 2.0 => f64::MAX / 4.0,
        _ => 0.0,
    }
}

/// All points: turns interpolated between the knots, postures followed.
fn between(search: &Search<'_>, poses: &[Isometry3<f64>], knots: &[usize], way: &[Node]) -> Result<TurnedPath> {
    let pairs: Vec<_> = knots.windows(2).zip(way.windows(2)).collect();
    let parts = in_order(&pairs, |(_, (pair, nodes))| {
        let (start, end) = (pair[0], pair[1]);
        // The short way round.
        let arc = wrapped(nodes[1].turn - nodes[0].turn);
        let mut part = vec![(nodes[0].q.clone(), nodes[0].turn)];
        for i in start + 1..end {
            let share = (i - start) as f64 / (end - start) as f64;
            let turn = nodes[0].turn + share * arc;
            let last = &part[i - 1 - start].0;
            let q = search
                .inverse
                .follow(&search.flange(&turned(&poses[i], turn)), last)
                .map_err(|e| search.named(i, &e))?;
            if search.arm.robot().outside_limits(&q).is_some() || change(last, &q).1 > search.largest_step(i - 1, i) {
                let error = Error::new(
                    Code::OutsideLimits,
                    "between two points with postures that suit, the arm meets a limit or jumps.",
                )
                .hint("give the path in parts, or with fewer points");
                return Err(search.named(i, &error));
            }
            part.push((q, turn));
        }
        Ok(part)
    })?;
    let last = way.last().map(|node| (node.q.clone(), node.turn));
    let (q, turns) = parts.into_iter().flatten().chain(last).unzip();
    Ok(TurnedPath { q, turns })
}

/// An angle in (−π, π].
fn wrapped(angle: f64) -> f64 {
    let turn = angle.rem_euclid(TAU);
    if turn > PI { turn - TAU } else { turn }
}
