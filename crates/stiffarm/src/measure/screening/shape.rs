//! Distances between the measuring points: the tool is rigid, so every state
//! must show the same shape. States are held against their own mean shape,
//! because drawings are rarely exact; the drawing is compared afterwards.

use super::mean_shape::{mean_shape, pairs};
use super::rigid::{Pair, fit, is_spread, moved};
use super::sheet::State;
use super::slip::{Slip, Undo, name_states};
use super::units::{CENTIMETRES, LENGTHS, LIKE_RADIANS, Unit};
use super::{Cause, Suspicion, Work};
use crate::numerics::arrangements::exchanges_first;
use crate::numerics::sample::median;
use nalgebra::Vector3;
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Relative distance from a ratio of units that still counts.
const UNIT_TOLERANCE: f64 = 0.1;
/// Distance of the arm's reach from such a ratio (logarithm), and states that show it.
const REACH_TOLERANCE: f64 = 0.5;
const REACHES: usize = 3;
/// Chance of a false alarm over all states together.
const FALSE_ALARM: f64 = 1e-3;
/// Standard deviations below which a distance is never worth a word.
const LEAST_STDS: f64 = 5.0;
/// Distance from the drawing that is worth a note, and that cannot be meant \[m\].
const DRAWING: [f64; 2] = [3e-4, 5e-3];
/// Share of the states that disagree beyond which the tool is to blame.
const UNSTEADY: f64 = 0.25;

/// Finds coordinates in another unit, and goes on with the right one.
pub(super) fn units(work: &mut Work) {
    let tool = &work.setup().tool.measuring_points;
    let mut off = Vec::new();
    let states = work.sheet.states();
    for &at in &states {
        let state = work.sheet.at(at);
        let seen = state.seen();
        let mut ratios = Vec::new();
        for (i, a) in seen.iter().enumerate() {
            for b in &seen[..i] {
                let (Some(p), Some(q)) = (state.points[*a], state.points[*b]) else {
                    continue;
                };
                let drawn = (tool[*a].position - tool[*b].position).norm();
                if drawn > 0.0 {
                    ratios.push((p.position - q.position).norm() / drawn);
                }
            }
        }
        if ratios.is_empty() {
            continue;
        }
        let ratio = median(&ratios);
        let mut units = LENGTHS.into_iter().chain(CENTIMETRES);
        let unit = units.find(|u| (ratio / u.factor - 1.0).abs() < UNIT_TOLERANCE);
        off.extend(unit.map(|unit| (at, unit)));
    }
    let Some(&(_, first)) = off.first() else {
        reach(work, &states);
        return;
    };
    let all = off.len() == states.len() && off.iter().all(|(_, u)| *u == first);
    if all && spread_agrees(work) {
        // The arm's reach has the right size: the tool in the cell has not.
        let slip = Slip::new(Undo::Times(Cause::ToolUnits, first));
        work.undo(&slip, slip.suspicion(work));
        return;
    }
    for unit in LENGTHS.into_iter().chain(CENTIMETRES) {
        let of_unit = off.iter().filter(|(_, u)| *u == unit);
        let of_unit: Vec<_> = of_unit.map(|(at, _)| *at).collect();
        if !of_unit.is_empty() {
            let slip = Slip::new(Undo::Times(Cause::Units, unit));
            let slip = if all { slip } else { slip.at(&of_unit) };
            work.undo(&slip, slip.suspicion(work));
        }
    }
}

/// Without a hint from the tool's shape: the postures against the arm's reach. One
/// point has no shape, so its coordinates may be in another unit; where a shape is
/// right, the robot's lengths are not.
fn reach(work: &mut Work, states: &[(usize, usize)]) {
    // Angles in radians under a heading in degrees shrink the arm's reach too.
    if states.len() < REACHES || work.sheet.largest_angle() < LIKE_RADIANS {
        return;
    }
    let ratio = spread_ratio(work);
    // The model is that of the flange: the tool's own length is left out.
    let near = |u: &Unit| (ratio / u.factor).ln().abs() < REACH_TOLERANCE;
    let Some(unit) = LENGTHS.into_iter().find(near) else {
        return;
    };
    if work.setup().tool.point_count() == 1 {
        let slip = Slip::new(Undo::Times(Cause::Units, unit));
        work.undo(&slip, slip.suspicion(work));
    } else {
        let mut suspicion = Suspicion::new(Cause::RobotUnits);
        suspicion.factor = Some(unit.factor);
        work.suspicions.push(suspicion);
    }
}

/// True when the postures spread as far as the model has it.
fn spread_agrees(work: &Work) -> bool {
    let ratio = spread_ratio(work);
    ratio > 0.5 && ratio < 2.0
}

/// How far the postures spread over what the model has.
fn spread_ratio(work: &Work) -> f64 {
    let centre = |points: &[Vector3<f64>]| points.iter().sum::<Vector3<f64>>() / (points.len().max(1)) as f64;
    let (mut read, mut modelled) = (Vec::new(), Vec::new());
    for at in work.sheet.states() {
        let state = work.sheet.at(at);
        let points: Vec<_> = state.points.iter().flatten().map(|m| m.position).collect();
        read.push(centre(&points));
        let frames = crate::model::kinematics::Frames::new(&work.setup().robot, &state.q);
        modelled.push(frames.flange().translation.vector);
    }
    let spread = |of: &[Vector3<f64>]| {
        let middle = centre(of);
        of.iter().map(|p| (p - middle).norm_squared()).sum::<f64>().sqrt()
    };
    spread(&read) / spread(&modelled)
}

/// Quantile of χ²: exceeded with this probability.
pub(super) fn exceeded_by(probability: f64, degrees: usize) -> f64 {
    match ChiSquared::new(degrees.max(1) as f64) {
        Ok(distribution) => distribution.inverse_cdf(1.0 - probability),
        Err(_) => f64::INFINITY,
    }
}

/// Distances that `points` of a rigid body leave open: 3·points − 6.
fn rigid_degrees(points: usize) -> usize {
    match points {
        0 | 1 => 0,
        2 => 1,
        _ => 3 * points - 6,
    }
}

/// A state whose shape disagrees.
struct OddShape {
    at: (usize, usize),
    /// Points without which the rest fits.
    candidates: Vec<usize>,
    /// Largest distance from the mean shape \[m\].
    off: f64,
}

/// Finds readings that stray from the mean shape. One that the shape itself
/// names is left out from here on; where several could be it, the state keeps
/// them as doubtful. `last` reports also shapes that no single reading explains.
/// Returns the number of states checked.
pub(super) fn strays(work: &mut Work, last: bool) -> usize {
    let Some(shape) = mean_shape(work) else {
        return 0;
    };
    let states: Vec<_> = work.sheet.states().into_iter().filter(|at| work.sheet.at(*at).seen().len() >= 3).collect();
    // Sum of squares of each state in units of its noise.
    let misfit = |state: &State, without: Option<usize>, scale: f64| -> (f64, f64) {
        let pairs = pairs(state, &shape, without);
        let std = state.std();
        let Some(pose) = fit(&pairs) else {
            return (0.0, 0.0);
        };
        let off = |p: &Pair| (moved(&pose, &p.0) - p.1).norm();
        let largest = pairs.iter().map(off).fold(0.0, f64::max);
        let squares: f64 = pairs.iter().map(|p| off(p).powi(2)).sum();
        (squares / (std * scale).powi(2), largest)
    };
    // The tool may be less rigid than the tracker is exact.
    let relative: Vec<f64> = states
        .iter()
        .map(|at| {
            let state = work.sheet.at(*at);
            let degrees = rigid_degrees(state.seen().len());
            misfit(state, None, 1.0).0 / exceeded_by(0.5, degrees)
        })
        .collect();
    if relative.is_empty() {
        return 0;
    }
    let scale = median(&relative).sqrt().max(1.0);
    // The mean shape has errors of its own.
    let allowance = 1.0 + 2.0 / states.len() as f64;
    let alarm = FALSE_ALARM / states.len() as f64;
    let mut odd = Vec::new();
    for &at in &states {
        let state = work.sheet.at(at);
        if !state.doubtful.is_empty() {
            continue;
        }
        let seen = state.seen();
        let (squares, off) = misfit(state, None, scale);
        let std = state.std();
        let limit = exceeded_by(alarm, rigid_degrees(seen.len())) * allowance;
        if squares <= limit || off < LEAST_STDS * std * scale / 2.0 {
            continue;
        }
        // Mixed up names are a matter for the checks against the model.
        let relabelled = |order: &Vec<usize>| {
            let mut other = state.clone();
            other.relabel(order);
            misfit(&other, None, scale).0 <= limit
        };
        if !last && exchanges_first(state.points.len()).iter().any(relabelled) {
            continue;
        }
        let rest = exceeded_by(alarm, rigid_degrees(seen.len() - 1)) * allowance;
        let fits = |a: &usize| misfit(state, Some(*a), scale).0 <= rest;
        odd.push(OddShape { at, candidates: seen.into_iter().filter(fits).collect(), off });
    }
    report(work, &shape, &odd, last, states.len());
    states.len()
}

fn report(work: &mut Work, shape: &[Option<Vector3<f64>>], odd: &[OddShape], last: bool, states: usize) {
    let unexplained: Vec<&OddShape> = odd.iter().filter(|o| o.candidates.is_empty()).collect();
    if last && !unexplained.is_empty() {
        let off = unexplained.iter().map(|o| o.off).fold(0.0, f64::max);
        let many = unexplained.len() >= 3 && unexplained.len() as f64 > UNSTEADY * states as f64;
        let mut suspicion = Suspicion::new(Cause::UnsteadyShape).off(off);
        if !many {
            let at: Vec<_> = unexplained.iter().map(|o| o.at).collect();
            suspicion = name_states(work, suspicion, &at);
        }
        work.suspicions.push(suspicion);
    }
    for a in 0..work.setup().tool.point_count() {
        let named = odd.iter().filter(|o| o.candidates == [a]);
        let named: Vec<_> = named.map(|o| o.at).collect();
        if !named.is_empty() {
            let off = named.iter().map(|at| stray_distance(work.sheet.at(*at), shape, a));
            let off = off.fold(0.0, f64::max);
            let stray = Slip::new(Undo::Stray(a)).at(&named);
            work.undo(&stray, stray.suspicion(work).off(off));
        }
    }
    for one in odd.iter().filter(|o| o.candidates.len() > 1) {
        work.sheet.at_mut(one.at).doubtful = one.candidates.clone();
    }
}

/// Distance of point `a` from where the other points and the shape have it \[m\].
pub(super) fn stray_distance(state: &State, shape: &[Option<Vector3<f64>>], a: usize) -> f64 {
    let others = pairs(state, shape, Some(a));
    // Two points leave a turn open: then all must share the pose.
    let all = match others.len() {
        0..3 => pairs(state, shape, None),
        _ => others,
    };
    match (fit(&all), shape[a], state.points[a]) {
        (Some(pose), Some(point), Some(mean)) => (moved(&pose, &point) - mean.position).norm(),
        _ => 0.0,
    }
}

/// Compares the mean shape with the tool in the cell. `gross` looks only for one
/// point that is far off, and goes on with it where the readings have it: the
/// model is held against the tool next.
pub(super) fn drawing(work: &mut Work, gross: bool) {
    let Some(shape) = mean_shape(work) else {
        return;
    };
    let tool = &work.setup().tool.measuring_points;
    let both = |without: Option<usize>| -> Vec<Pair> {
        (0..tool.len())
            .filter(|a| without != Some(*a))
            .filter_map(|a| shape[a].map(|p| (tool[a].position, p)))
            .collect()
    };
    let all = both(None);
    let drawn: Vec<_> = all.iter().map(|p| p.0).collect();
    let Some(pose) = fit(&all).filter(|_| is_spread(&drawn)) else {
        return;
    };
    let worst = |pose: &nalgebra::Isometry3<f64>, pairs: &[Pair]| {
        let off = pairs.iter().map(|(a, b)| (moved(pose, a) - b).norm());
        off.fold(0.0, f64::max)
    };
    let off = worst(&pose, &all);
    let noise = LEAST_STDS * work.sheet.typical_std();
    let least = if gross { DRAWING[1] } else { DRAWING[0] };
    if off <= least.max(noise) {
        return;
    }
    // One point that lies elsewhere leaves the others in place.
    let mut single = Vec::new();
    for a in 0..tool.len() {
        let others = both(Some(a));
        if let (Some(pose), Some(point), true) = (fit(&others), shape[a], tool.len() > 3)
            && worst(&pose, &others) < off / super::BELIEVED_RATIO
        {
            let seen = moved(&pose.inverse(), &point);
            single.push((a, (tool[a].position - seen).norm(), seen));
        }
    }
    if gross && single.len() != 1 {
        return;
    }
    let mut suspicion = Suspicion::new(Cause::Drawing).off(off);
    if let [(a, distance, seen)] = single[..] {
        suspicion = suspicion.points([work.point_name(a)]).off(distance);
        work.cell.setup.tool.measuring_points[a].position = seen;
    }
    suspicion.certain = off < DRAWING[1];
    work.suspicions.push(suspicion);
}
