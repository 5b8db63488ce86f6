//! Single states that disagree with the kinematic model, or with the other
//! states of their posture.

use super::frame::Frame;
use super::misfit::{first_angles, gap, give, state_rms};
use super::rigid::moved;
use super::slip::{Rule, Slip, Undo, name_states, settle};
use super::{Cause, Suspicion, Work};
use crate::numerics::arrangements::exchanges_first;
use nalgebra::Isometry3;

/// What may be mixed up in rows of posture `p`: the names of points, and with another posture.
pub(super) fn mix_ups(work: &Work, p: usize) -> impl Iterator<Item = Undo> {
    let orders = exchanges_first(work.setup().tool.point_count()).into_iter();
    let others = (0..work.sheet.postures.len()).filter(move |k| *k != p);
    let others = others.filter_map(|k| Some(Undo::AnglesOf(k, first_angles(work, k)?)));
    orders.map(Undo::Order).chain(others)
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
        let tried = mix_ups(work, p).map(|undo| {
            let slip = Slip::new(undo).at(&[at]);
            let after = slip.left(work, transform, at);
            (slip, after)
        });
        let settled = settle(tried, &Rule::of_places(work, before, most));
        let suspicion = match settled {
            Some(settled) => {
                let mut out = settled.suspicion(work).misfit(before, settled.after);
                if let Undo::AnglesOf(k, _) = settled.slip.undo {
                    out.after_m = Some(frame.level);
                    // Exchanged where the other's row of that name belongs here.
                    let mut names = work.sheet.postures[k].states.iter().map(|s| &s.name);
                    let twin = names.position(|name| *name == work.sheet.at(at).name);
                    let back = twin.filter(|_| suspects.contains(&k)).map(|t| (k, t));
                    let fits =
                        |back: &_| state_rms(work, transform, *back, &q).is_some_and(|r| r <= most);
                    if let Some(back) = back.filter(fits) {
                        out.cause = Cause::ExchangedPostures;
                        work.sheet.exchange_positions(at, back);
                    } else {
                        work.sheet.at_mut(at).points.fill(None);
                    }
                } else {
                    settled.slip.undo(work);
                }
                out
            }
            None => match stray_point(work, transform, at, &q, most) {
                Some((a, off)) => {
                    let stray = Slip::new(Undo::Stray(a)).at(&[at]);
                    let out = stray.suspicion(work).off(off);
                    stray.undo(work);
                    out
                }
                None => {
                    work.sheet.at_mut(at).points.fill(None);
                    let out = Suspicion::new(Cause::UnexplainedPosture).misfit(before, frame.level);
                    name_states(work, out, &[at])
                }
            },
        };
        work.found.push(suspicion);
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
    let far: Vec<(usize, f64)> = (0..predicted.len())
        .filter_map(off)
        .filter(|(_, d)| *d > allowed)
        .collect();
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
            suspicion
                .states
                .insert(0, work.sheet.at((p, reference)).name.clone());
            work.found.push(suspicion);
        }
    }
}
