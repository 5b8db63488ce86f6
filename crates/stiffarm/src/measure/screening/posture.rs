//! Single postures and states that disagree with the kinematic model while the
//! others fit.

use super::frame::{Frame, fitted, items};
use super::misfit::{best_around, gap, give, state_rms};
use super::slip::{Rule, Slip, StateIndex, Undo, settle};
use super::states::mix_ups;
use super::{Cause, Suspicion, Work, states};
use crate::numerics::order::sort_by_number;
use std::f64::consts::TAU;

/// Angle that is the negative of the one written, but for what a robot misses \[rad\].
const SAME_ANGLE: f64 = 0.01;
/// Steps of a turn in which a mistyped angle is looked for, and halvings of the step.
const STEPS: usize = 120;
const HALVINGS: usize = 40;

/// Explains the postures that disagree, undoes what is explained and registers
/// again. Returns the last registration, or `None` where there is none to trust.
pub(super) fn explain(work: &mut Work, frame: Option<Frame>) -> Option<Frame> {
    let Some(frame) = frame else {
        states::between(work);
        return None;
    };
    let mut frame = frame;
    let mut seen = vec![false; work.sheet.postures.len()];
    let mut unexplained = Vec::new();
    // The worst first: what is undone may bring others into line.
    loop {
        let suspects = suspects(work, &frame);
        let Some(p) = suspects.iter().copied().find(|p| !seen[*p]) else {
            break;
        };
        seen[p] = true;
        if is_coherent(work, p) {
            match whole_posture(work, &frame, p, &suspects) {
                Some(partner) => seen[partner] = true,
                None => {
                    unexplained.push(p);
                    continue;
                }
            }
        } else {
            states::explain(work, &frame, p, &suspects);
        }
        frame = fitted(work, None).unwrap_or(frame);
    }
    for p in unexplained {
        report_unexplained(work, &frame, p);
    }
    Some(frame)
}

/// Postures that disagree with the model, or in themselves, the worst first.
fn suspects(work: &Work, frame: &Frame) -> Vec<usize> {
    let at = items(work);
    let mut out: Vec<(usize, f64)> = Vec::new();
    for p in 0..work.sheet.postures.len() {
        let judged_items = at.iter().zip(&frame.bad).zip(&frame.rms);
        let worst = judged_items.filter(|((item, bad), _)| item.0 == p && **bad).map(|(_, rms)| *rms).reduce(f64::max);
        match worst {
            Some(rms) => out.push((p, rms)),
            None if !is_coherent(work, p) => out.push((p, 0.0)),
            None => {}
        }
    }
    sort_by_number(&mut out, |a| -a.1);
    out.into_iter().map(|(p, _)| p).collect()
}

/// True where another state of the posture lies where this one should: exchanged
/// states are a matter for the signs.
fn another_state_fits(work: &Work, frame: &Frame, at: (usize, usize)) -> bool {
    let q = &work.sheet.at(at).q;
    let others = (0..work.sheet.postures[at.0].states.len()).map(|s| (at.0, s));
    others
        .filter(|other| *other != at)
        .any(|other| state_rms(work, &frame.base_from_tracker, other, q).is_some_and(|r| r <= frame.limit()))
}

/// Notes a posture that still disagrees.
fn report_unexplained(work: &mut Work, frame: &Frame, p: usize) {
    let posture = &work.sheet.postures[p];
    let Some(reference) = posture.references().first().map(|s| (p, *s)) else {
        return;
    };
    let q = work.sheet.at(reference).q.clone();
    let misfit = state_rms(work, &frame.base_from_tracker, reference, &q);
    let Some(before) = misfit.filter(|r| *r > frame.limit()) else {
        return;
    };
    if another_state_fits(work, frame, reference) {
        return;
    }
    let mut suspicion = Suspicion::new(Cause::UnexplainedPosture).posture(&posture.name).misfit(before, frame.level);
    // A row copied from another posture keeps its angles.
    let is_same =
        |other: &&super::sheet::Posture| other.name != posture.name && other.states.iter().any(|state| state.q == q);
    let same = work.sheet.postures.iter().filter(is_same);
    suspicion.alternatives = same.map(|other| other.name.clone()).collect();
    work.suspicions.push(suspicion);
}

/// True when all states of a posture lie where its first reference state does.
fn is_coherent(work: &Work, p: usize) -> bool {
    let posture = &work.sheet.postures[p];
    let Some(&reference) = posture.references().first() else {
        return true;
    };
    let give = give(work, p);
    let first = &posture.states[reference].points;
    posture.states.iter().all(|s| gap(first, &s.points) <= give)
}

/// A posture whose states agree with each other but not with the model. Returns
/// the posture it was exchanged with, itself where another cause was undone, and
/// `None` where nothing explains it.
fn whole_posture(work: &mut Work, frame: &Frame, p: usize, suspects: &[usize]) -> Option<usize> {
    let transform = &frame.base_from_tracker;
    let references = work.sheet.postures[p].references();
    let reference = (p, *references.first()?);
    let q = work.sheet.at(reference).q.clone();
    let before = state_rms(work, transform, reference, &q)?;
    if another_state_fits(work, frame, reference) {
        return None;
    }
    let states = 0..work.sheet.postures[p].states.len();
    let places: Vec<StateIndex> = states.map(|s| (p, s)).collect();
    let most = frame.limit();
    let with = |slip: Slip| {
        let after = slip.left(work, transform, reference);
        (slip, after)
    };
    let angles = (0..q.len()).flat_map(|j| {
        let turned = |change: f64| {
            let mut q = q.clone();
            q[j] += change;
            state_rms(work, transform, reference, &q).unwrap_or(f64::INFINITY)
        };
        let (change, after) = best_around(TAU, STEPS, HALVINGS, turned);
        let angle = q[j] + change;
        let is_sign = turn(angle + q[j]).abs() < SAME_ANGLE && turn(2.0 * q[j]).abs() > SAME_ANGLE;
        let likely = if is_sign { -q[j] } else { customary(work, j, angle) };
        let [sign, fitted] = [-q[j], likely].map(|likely| Slip::new(Undo::Angle(j, [q[j], likely])).at(&places));
        [with(sign), (fitted, Some(after))]
    });
    let mixed = mix_ups(work, transform, &places, reference, most, suspects);
    let all = angles.chain(mixed.into_iter().map(with));
    let settled = settle(all, &Rule::of_places(work, before, most))?;
    let suspicion = settled.suspicion(work).misfit(before, settled.after);
    work.undo(&settled.slip, suspicion);
    match settled.slip.undo {
        Undo::Exchange((k, _), _) => Some(k),
        _ => Some(p),
    }
}

/// An angle without full turns, −π to π.
fn turn(angle: f64) -> f64 {
    angle - TAU * (angle / TAU).round()
}

/// The same angle within the cell's bounds, else within half a turn.
fn customary(work: &Work, j: usize, angle: f64) -> f64 {
    let within = |a: &f64| {
        let bounds = work.cell.bounds.get(j);
        bounds.is_some_and(|b| (b[0]..=b[1]).contains(a))
    };
    let angle = turn(angle);
    let same = [angle, angle - TAU, angle + TAU];
    same.into_iter().find(within).unwrap_or(angle)
}
