//! Single states that disagree with the kinematic model, or with the other
//! states of their posture.

use super::frame::Frame;
use super::misfit::{first_angles, gap, give, state_rms};
use super::rigid::moved;
use super::slip::{Rule, Slip, StateIndex, Undo, name_states, settle};
use super::{Cause, Suspicion, Work};
use crate::numerics::arrangements::exchanges_first;
use nalgebra::Isometry3;

/// What may be mixed up in the rows `at` of a posture, by the row `row` of them: the names of points, and with another
/// posture. Exchanged are the rows where those of a suspect belong here as well.
pub(super) fn mix_ups(
    work: &Work,
    transform: &Isometry3<f64>,
    at: &[StateIndex],
    row: StateIndex,
    most: f64,
    suspects: &[usize],
) -> Vec<Slip> {
    let state = work.sheet.at(row);
    let orders = exchanges_first(state.points.len()).into_iter();
    let others = (0..work.sheet.postures.len()).filter(|k| *k != row.0);
    let others = others.filter_map(|k| {
        let q = first_angles(work, k)?;
        let first = *work.sheet.postures[k].references().first()?;
        let mut names = work.sheet.postures[k].states.iter().map(|s| &s.name);
        let twin = names.position(|name| *name == state.name);
        let back = if at.len() > 1 { Some(first) } else { twin };
        let left = |s: usize| state_rms(work, transform, (k, s), &state.q);
        let belongs = |s: &usize| left(*s).is_some_and(|left| left <= most);
        let back = back.filter(|_| suspects.contains(&k));
        Some(match back.filter(belongs) {
            Some(back) => Undo::Exchange((k, back), q),
            None => Undo::AnglesOf((k, first), q),
        })
    });
    let all = orders.map(Undo::Order).chain(others);
    all.map(|undo| Slip::new(undo).at(at)).collect()
}

/// A posture whose states lie apart: which of them disagree with the model, and why.
pub(super) fn explain(work: &mut Work, frame: &Frame, p: usize, suspects: &[usize]) {
    let transform = &frame.base_from_tracker;
    let most = frame.limit() + give(work, p);
    for at in (0..work.sheet.postures[p].states.len()).map(|s| (p, s)) {
        let q = work.sheet.at(at).q.clone();
        let Some(before) = state_rms(work, transform, at, &q).filter(|r| *r > most) else {
            continue;
        };
        let mixed = mix_ups(work, transform, &[at], at, most, suspects);
        let tried = mixed.into_iter().map(|slip| {
            let after = slip.left(work, transform, at);
            (slip, after)
        });
        if let Some(settled) = settle(tried, &Rule::of_places(work, before, most)) {
            let after = match settled.slip.undo {
                Undo::Order(_) => settled.after,
                _ => frame.level,
            };
            let suspicion = settled.suspicion(work).misfit(before, after);
            work.undo(&settled.slip, suspicion);
        } else if let Some((a, off)) = stray_point(work, transform, at, &q, most) {
            let stray = Slip::new(Undo::Stray(a)).at(&[at]);
            work.undo(&stray, stray.suspicion(work).off(off));
        } else {
            let out = Suspicion::new(Cause::UnexplainedPosture).misfit(before, frame.level);
            work.suspicions.push(name_states(work, out, &[at]));
            work.sheet.at_mut(at).points.fill(None);
        }
    }
}

/// The one point that lies far from the model while the other points fit.
fn stray_point(
    work: &Work,
    transform: &Isometry3<f64>,
    at: (usize, usize),
    q: &[f64],
    allowed: f64,
) -> Option<(usize, f64)> {
    let (state, predicted) = (work.sheet.at(at), work.predicted(q));
    let off = |a: usize| {
        let mean = state.points[a]?;
        Some((a, (moved(transform, &mean.position) - predicted[a]).norm()))
    };
    let far: Vec<(usize, f64)> = (0..predicted.len()).filter_map(off).filter(|(_, d)| *d > allowed).collect();
    match far[..] {
        [one] if state.seen().len() > 1 => Some(one),
        _ => None,
    }
}

/// Without a model to trust: labels exchanged between the states of a posture.
pub(super) fn between(work: &mut Work) {
    for p in 0..work.sheet.postures.len() {
        let Some(&reference) = work.sheet.postures[p].references().first() else {
            continue;
        };
        let give = give(work, p);
        for s in 0..work.sheet.postures[p].states.len() {
            let first = work.sheet.at((p, reference)).points.clone();
            let before = gap(&first, &work.sheet.at((p, s)).points);
            if before <= give {
                continue;
            }
            let tried = exchanges_first(first.len()).into_iter().map(|order| {
                let slip = Slip::new(Undo::Order(order)).at(&[(p, s)]);
                let mut state = work.sheet.at((p, s)).clone();
                slip.undo_in(&mut state, &work.cell);
                (slip, Some(gap(&first, &state.points)))
            });
            let rule = Rule::of_places(work, f64::INFINITY, give);
            let mut suspicion = match settle(tried, &rule) {
                Some(settled) => {
                    let out = settled.suspicion(work).misfit(before, settled.after);
                    settled.slip.undo(work);
                    out
                }
                None => {
                    work.sheet.at_mut((p, s)).points.fill(None);
                    let out = Suspicion::new(Cause::UnexplainedPosture).misfit(before, 0.0);
                    name_states(work, out, &[(p, s)])
                }
            };
            suspicion.certain = suspicion.cause == Cause::UnexplainedPosture;
            suspicion.states.insert(0, work.sheet.at((p, reference)).name.clone());
            work.suspicions.push(suspicion);
        }
    }
}
