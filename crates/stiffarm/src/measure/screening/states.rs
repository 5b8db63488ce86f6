//! Single states that disagree with the kinematic model, or with the other
//! states of their posture.

use super::frame::{Frame, rms, state_pairs};
use super::misfit::{first_angles, gap, give, state_rms};
use super::model::exchanged;
use super::rigid::moved;
use super::sheet::Mean;
use super::{ALIKE, BELIEVED, Cause, Suspicion, Work};
use crate::numerics::arrangements::exchanges_first;
use nalgebra::{Isometry3, Vector3};

/// A posture whose states lie apart: which of them disagree with the model, and why.
pub(super) fn explain(work: &mut Work, frame: &Frame, p: usize, suspects: &[usize]) {
    let transform = &frame.base_from_tracker;
    let give = give(work, p);
    for s in 0..work.sheet.postures[p].states.len() {
        let at = (p, s);
        let q = work.sheet.at(at).q.clone();
        let limit = frame.limit() + give;
        let Some(before) = state_rms(work, transform, at, &q).filter(|r| *r > limit) else {
            continue;
        };
        let allowed = frame.limit() + give;
        let name = work.sheet.at(at).name.clone();
        let posture = work.sheet.postures[p].name.clone();
        // Readings that belong to another posture.
        let other = (0..work.sheet.postures.len()).find(|k| {
            let angles = first_angles(work, *k).filter(|_| *k != p);
            let after = angles.and_then(|q| state_rms(work, transform, at, &q));
            after.is_some_and(|r| r <= allowed && r * BELIEVED < before)
        });
        if let Some(k) = other {
            let twin = work.sheet.postures[k]
                .states
                .iter()
                .position(|s| s.name == name);
            let back = twin.filter(|_| suspects.contains(&k)).map(|t| (k, t));
            let mutual =
                back.filter(|b| state_rms(work, transform, *b, &q).is_some_and(|r| r <= allowed));
            let cause = match mutual {
                Some(_) => Cause::ExchangedPostures,
                None => Cause::OtherPosture,
            };
            let suspicion = Suspicion::new(cause)
                .posture(&posture)
                .posture(&work.sheet.postures[k].name)
                .state(&name)
                .misfit(before, frame.level);
            match mutual {
                Some(back) => {
                    let mine = work.sheet.at(at).positions();
                    let theirs = work.sheet.at(back).positions();
                    work.sheet.at_mut(back).set_positions(mine);
                    work.sheet.at_mut(at).set_positions(theirs);
                }
                None => work.sheet.at_mut(at).points.fill(None),
            }
            work.found.push(suspicion);
            continue;
        }
        let predicted = work.predicted(&q);
        let order = best_order(work, at, |points| {
            rms(transform, &state_pairs(points, &predicted))
        });
        let stray = stray_point(work, transform, at, &predicted, allowed);
        match (order, stray) {
            (Some((order, after)), _) if after <= allowed && after * BELIEVED < before => {
                let suspicion = exchanged(work, &order)
                    .posture(&posture)
                    .state(&name)
                    .misfit(before, after);
                work.sheet.at_mut(at).relabel(&order);
                work.found.push(suspicion);
            }
            (_, Some((a, off))) => {
                let mut suspicion = Suspicion::new(Cause::StrayReading)
                    .posture(&posture)
                    .state(&name)
                    .points([work.point_name(a)])
                    .off(off);
                suspicion.lines = work.sheet.at(at).lines[a].clone();
                work.sheet.at_mut(at).points[a] = None;
                work.sheet.at_mut(at).doubtful.clear();
                work.found.push(suspicion);
            }
            _ => {
                let suspicion = Suspicion::new(Cause::UnexplainedPosture)
                    .posture(&posture)
                    .state(&name)
                    .misfit(before, frame.level);
                work.sheet.at_mut(at).points.fill(None);
                work.found.push(suspicion);
            }
        }
    }
}

/// The one point that lies far from the model while the other points fit.
fn stray_point(
    work: &Work,
    transform: &Isometry3<f64>,
    at: (usize, usize),
    predicted: &[Vector3<f64>],
    allowed: f64,
) -> Option<(usize, f64)> {
    let state = work.sheet.at(at);
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

/// The order of the labels with the smallest misfit, and that misfit.
fn best_order(
    work: &Work,
    at: (usize, usize),
    misfit: impl Fn(&[Option<Mean>]) -> f64,
) -> Option<(Vec<usize>, f64)> {
    let mut best: Option<(Vec<usize>, f64)> = None;
    for order in exchanges_first(work.setup().tool.point_count()) {
        let mut state = work.sheet.at(at).clone();
        state.relabel(&order);
        let value = misfit(&state.points);
        // Exchanges of two come first and win against what is no better.
        if best.as_ref().is_none_or(|(_, b)| value * ALIKE < *b) {
            best = Some((order, value));
        }
    }
    best
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
            let order = best_order(work, (p, s), |points| gap(&first, points));
            let (posture, names) = (
                work.sheet.postures[p].name.clone(),
                [reference, s].map(|s| work.sheet.postures[p].states[s].name.clone()),
            );
            let suspicion = match order.filter(|(_, after)| *after <= give) {
                Some((order, after)) => {
                    let mut out = exchanged(work, &order).misfit(before, after);
                    out.certain = false;
                    work.sheet.at_mut((p, s)).relabel(&order);
                    out
                }
                None => {
                    work.sheet.at_mut((p, s)).points.fill(None);
                    Suspicion::new(Cause::UnexplainedPosture).misfit(before, 0.0)
                }
            };
            let suspicion = suspicion.posture(&posture).state(&names[0]);
            work.found.push(suspicion.state(&names[1]));
        }
    }
}
