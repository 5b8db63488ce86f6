//! Which of several points strays, where the rigid shape alone cannot tell: with
//! four reflectors in a plane, one that strays across the plane. Under each
//! candidate the other points must still move as the arm does.

use super::frame::{Frame, item_pairs, items, register};
use super::mean_shape::mean_shape;
use super::motion::{Move, moves};
use super::rigid::moved;
use super::shape::{exceeded_by, stray_distance};
use super::slip::{Slip, Undo, name_states};
use super::{Cause, Suspicion, Work};
use crate::model::measurement::Role;
use crate::numerics::information::Factor;
use nalgebra::{DMatrix, DVector};

/// Chance by which the right candidate is rejected, and a wrong one let pass.
const REJECTED_CHANCE: f64 = 1e-3;
const PASSED_CHANCE: f64 = 1e-6;
/// Surplus of unknowns' worth of rows below which the compliances are not fitted.
const SURPLUS: usize = 6;
/// Relative error of displacements by the prior.
const PRIOR_ERROR: f64 = 0.3;
/// Misfits of the others, in those of good postures, that a right candidate
/// keeps below and every other one exceeds.
const BELOW: f64 = 2.0;
const ABOVE: f64 = 4.0;

/// The point that strays, and by how much \[m\].
type StrayPoint = (usize, f64);

/// Names the stray reading of each doubtful state, or all that it can be.
pub(super) fn settle(work: &mut Work, frame: Option<&Frame>) {
    let doubtful: Vec<(usize, usize)> =
        work.sheet.states().into_iter().filter(|at| !work.sheet.at(*at).doubtful.is_empty()).collect();
    if doubtful.is_empty() {
        return;
    }
    let shape = mean_shape(work);
    let motions = frame.map_or_else(Vec::new, |f| moves(work, &f.base_from_tracker));
    let motion = Motion::new(work, &motions);
    let named: Vec<Option<StrayPoint>> = doubtful
        .iter()
        .map(|at| {
            let by_motion = motion.as_ref().and_then(|m| m.name(work, &motions, *at));
            by_motion.or_else(|| frame.and_then(|_| by_position(work, *at)))
        })
        .collect();
    for (at, named) in doubtful.into_iter().zip(named) {
        let candidates = std::mem::take(&mut work.sheet.at_mut(at).doubtful);
        let suspicion = match named {
            Some((a, off)) => {
                let stray = Slip::new(Undo::Stray(a)).at(&[at]);
                let out = stray.suspicion(work).off(off);
                stray.undo(work);
                out
            }
            None => {
                let state = work.sheet.at(at);
                let distance = |a: &usize| Some(stray_distance(state, shape.as_ref()?, *a));
                let off = candidates.iter().filter_map(distance);
                let off = off.fold(0.0, f64::max);
                let names = candidates.iter().map(|a| work.point_name(*a));
                let mut out = Suspicion::new(Cause::StrayReading).points(names).off(off);
                out.certain = false;
                // Nothing is concluded from a state that nobody can trust.
                work.sheet.at_mut(at).points.fill(None);
                name_states(work, out, &[at])
            }
        };
        work.suspicions.push(suspicion);
    }
}

/// How the points move under load: by compliances fitted to the undoubted
/// states, else by the prior.
struct Motion {
    compliance: DVector<f64>,
    /// Of the fit; `None` with the prior.
    factor: Option<Factor>,
    /// Standard deviation of a displacement component \[m\].
    std: f64,
}

impl Motion {
    fn new(work: &Work, motions: &[Move]) -> Option<Self> {
        let sure: Vec<&Move> = motions.iter().filter(|m| !m.is_doubtful(work)).collect();
        let rows: usize = sure.iter().map(|m| m.shift.len()).sum();
        let n = work.setup().robot.spring_count();
        let noise = motions.iter().map(|m| m.std).fold(0.0, f64::max);
        if rows >= n + SURPLUS {
            let mut psi = DMatrix::zeros(rows, n);
            let mut delta = DVector::zeros(rows);
            let mut row = 0;
            for one in sure {
                let count = one.shift.len();
                psi.rows_mut(row, count).copy_from(&one.block);
                delta.rows_mut(row, count).copy_from(&(&one.shift - &one.series_shift));
                row += count;
            }
            let factor = Factor::new(&psi).ok()?;
            if factor.undetermined().is_empty() {
                let compliance = factor.solve(&delta);
                let left = (delta - psi * &compliance).norm_squared() / (rows - n) as f64;
                return Some(Motion { compliance, factor: Some(factor), std: left.sqrt().max(noise) });
            }
        }
        let prior = work.cell.prior.as_ref()?;
        Some(Motion { compliance: DVector::from_iterator(n, prior.iter().map(|k| 1.0 / k)), factor: None, std: noise })
    }

    /// The one candidate without which the others move as expected.
    fn name(&self, work: &Work, motions: &[Move], at: (usize, usize)) -> Option<StrayPoint> {
        let candidates = &work.sheet.at(at).doubtful;
        for one in motions.iter().filter(|m| m.is_of(at)) {
            if !work.sheet.at(one.other_than(at)).doubtful.is_empty() {
                continue;
            }
            let expected = &one.block * &self.compliance + &one.series_shift;
            let left = &one.shift - &expected;
            let rows = left.len() as f64;
            let model = match &self.factor {
                // What the fit itself leaves open, on average over the rows.
                Some(factor) => factor.mapped_error(&one.block)? * self.std / rows.sqrt(),
                None => PRIOR_ERROR * expected.norm() / rows.sqrt(),
            };
            let variance = self.std.powi(2) + model.powi(2);
            let off = |a: usize| left.fixed_rows::<3>(3 * a).norm();
            let others = |a: usize| -> f64 {
                let seen = 0..one.points.len();
                let rest = seen.filter(|i| one.points[*i] != a);
                rest.map(|i| off(i).powi(2)).sum::<f64>() / variance
            };
            let degrees = 3 * (one.points.len().saturating_sub(1));
            let right: Vec<usize> =
                candidates.iter().copied().filter(|a| others(*a) <= exceeded_by(REJECTED_CHANCE, degrees)).collect();
            let wrong = candidates.iter().filter(|a| others(**a) > exceeded_by(PASSED_CHANCE, degrees)).count();
            if let [a] = right[..]
                && wrong + 1 == candidates.len()
                && let Some(i) = one.points.iter().position(|p| *p == a)
            {
                return Some((a, off(i)));
            }
        }
        None
    }
}

/// An unloaded state: the candidate without which the others lie where the
/// kinematic model has them.
fn by_position(work: &Work, at: (usize, usize)) -> Option<StrayPoint> {
    let state = work.sheet.at(at);
    if state.role == Role::Loaded {
        return None;
    }
    let others: Vec<_> = items(work).into_iter().filter(|i| *i != at).collect();
    let frame = register(&item_pairs(work, work.setup(), &others))?;
    let predicted = work.predicted(&state.q);
    let off = |a: usize| -> Option<f64> {
        let mean = state.points[a]?;
        Some((moved(&frame.base_from_tracker, &mean.position) - predicted[a]).norm())
    };
    let seen = state.seen();
    let score = |a: usize| {
        let rest: Vec<f64> = seen.iter().filter(|b| **b != a).filter_map(|b| off(*b)).collect();
        let squares: f64 = rest.iter().map(|r| r * r).sum();
        (squares / rest.len().max(1) as f64).sqrt() / frame.level.max(work.sheet.typical_std())
    };
    let scores: Vec<(usize, f64)> = state.doubtful.iter().map(|a| (*a, score(*a))).collect();
    let right: Vec<usize> = scores.iter().filter(|s| s.1 < BELOW).map(|s| s.0).collect();
    let wrong = scores.iter().filter(|s| s.1 > ABOVE).count();
    match right[..] {
        [a] if wrong + 1 == scores.len() => Some((a, off(a)?)),
        _ => None,
    }
}
