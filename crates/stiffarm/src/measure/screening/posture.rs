//! Single postures and states that disagree with the kinematic model while the
//! others fit.

use super::frame::{Frame, fitted, items, rms, state_pairs};
use super::misfit::{first_angles, gap, give, state_rms};
use super::model::exchanged;
use super::{ALIKE, BELIEVED, Cause, FITTED, Suspicion, Work, states};
use crate::numerics::arrangements::exchanges_first;
use crate::numerics::order::sort_by_number;
use crate::units::rad_to_deg;
use nalgebra::Isometry3;

/// Angle that is the negative of the one written, but for what a robot misses \[rad\].
const SAME_ANGLE: f64 = 0.01;
/// Steps in which a mistyped angle is looked for, and halvings of the step.
const STEPS: usize = 120;
const HALVINGS: usize = 40;

/// What undoes a fault.
#[derive(Debug, Clone)]
enum Undo {
    /// The angle of a joint, in all states of the posture \[rad\].
    Angle(usize, f64),
    /// Readings of this posture at the points where they were taken.
    Order(Vec<usize>),
    /// The angles of another posture.
    AnglesOf(usize),
}

struct Trial {
    undo: Undo,
    after: f64,
    complexity: usize,
}

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
        let own = at.iter().zip(&frame.bad).zip(&frame.rms);
        let worst = own
            .filter(|((item, bad), _)| item.0 == p && **bad)
            .map(|(_, rms)| *rms)
            .reduce(f64::max);
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
    others.filter(|other| *other != at).any(|other| {
        state_rms(work, &frame.base_from_tracker, other, q).is_some_and(|r| r <= frame.limit())
    })
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
    let mut suspicion = Suspicion::new(Cause::UnexplainedPosture)
        .posture(&posture.name)
        .misfit(before, frame.level);
    // A row copied from another posture keeps its angles.
    let is_same = |other: &&super::sheet::Posture| {
        other.name != posture.name && other.states.iter().any(|state| state.q == q)
    };
    let same = work.sheet.postures.iter().filter(is_same);
    suspicion.alternatives = same.map(|other| other.name.clone()).collect();
    work.found.push(suspicion);
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
    let mut trials: Vec<Trial> = Vec::new();
    let mut attempt = |undo: Undo, after: Option<f64>, complexity: usize| {
        if let Some(after) = after.filter(|a| a * BELIEVED < before && *a <= frame.limit()) {
            trials.push(Trial {
                undo,
                after,
                complexity,
            });
        }
    };
    for j in 0..q.len() {
        let mut flipped = q.clone();
        flipped[j] = -q[j];
        let after = state_rms(work, transform, reference, &flipped);
        attempt(Undo::Angle(j, -q[j]), after, 1);
        let (angle, after) = best_angle(work, transform, reference, &q, j);
        if turn(angle + q[j]).abs() < SAME_ANGLE && turn(2.0 * q[j]).abs() > SAME_ANGLE {
            attempt(Undo::Angle(j, -q[j]), Some(after), 1);
        } else {
            attempt(Undo::Angle(j, customary(work, j, angle)), Some(after), 2);
        }
    }
    for order in exchanges_first(work.setup().tool.point_count()) {
        let mut state = work.sheet.at(reference).clone();
        state.relabel(&order);
        let pairs = state_pairs(&state.points, &work.predicted(&q));
        let complexity = (0..order.len()).filter(|a| order[*a] != *a).count() - 1;
        attempt(Undo::Order(order), Some(rms(transform, &pairs)), complexity);
    }
    for k in (0..work.sheet.postures.len()).filter(|k| *k != p) {
        let other = first_angles(work, k);
        let after = other.and_then(|q| state_rms(work, transform, reference, &q));
        attempt(Undo::AnglesOf(k), after, 1);
    }
    let (first, alternatives) = simplest(work, p, trials)?;
    let mut partner = p;
    let mut suspicion = describe(work, p, &first.undo);
    match &first.undo {
        Undo::Angle(j, angle) => {
            let change = angle - q[*j];
            for state in &mut work.sheet.postures[p].states {
                state.q[*j] += change;
            }
        }
        Undo::Order(order) => {
            for state in &mut work.sheet.postures[p].states {
                state.relabel(order);
            }
        }
        Undo::AnglesOf(k) => {
            let back = work.sheet.postures[*k]
                .references()
                .first()
                .map(|s| (*k, *s));
            let fits = back.and_then(|back| state_rms(work, transform, back, &q));
            let mutual = suspects.contains(k) && fits.is_some_and(|r| r <= frame.limit());
            let other = first_angles(work, *k)?;
            if mutual {
                partner = *k;
                if *k < p {
                    suspicion.postures.reverse();
                }
                suspicion.cause = Cause::ExchangedPostures;
                for state in &mut work.sheet.postures[*k].states {
                    state.q.clone_from(&q);
                }
            }
            for state in &mut work.sheet.postures[p].states {
                state.q.clone_from(&other);
            }
        }
    }
    let mut suspicion = suspicion.misfit(before, first.after);
    suspicion.certain = alternatives.is_empty();
    suspicion.alternatives = alternatives;
    work.found.push(suspicion);
    Some(partner)
}

/// An angle without full turns, −π to π.
fn turn(angle: f64) -> f64 {
    let full = std::f64::consts::TAU;
    angle - full * (angle / full).round()
}

/// The same angle within the cell's bounds, else within half a turn.
fn customary(work: &Work, j: usize, angle: f64) -> f64 {
    let within = |a: &f64| {
        let bounds = work.cell.bounds.get(j);
        bounds.is_some_and(|b| (b[0]..=b[1]).contains(a))
    };
    let angle = turn(angle);
    let full = std::f64::consts::TAU;
    let same = [angle, angle - full, angle + full];
    same.into_iter().find(within).unwrap_or(angle)
}

/// The simplest of the explanations that explain alike, with the others in words.
fn simplest(work: &Work, p: usize, mut trials: Vec<Trial>) -> Option<(Trial, Vec<String>)> {
    let weighed = |t: &Trial| match (&t.undo, t.complexity) {
        (Undo::Angle(..), 2..) => t.after * FITTED,
        _ => t.after,
    };
    let best = trials.iter().map(weighed).reduce(f64::min)?;
    let noise = work.sheet.typical_std();
    trials.retain(|t| weighed(t) <= ALIKE * best + FITTED * noise);
    let complexity = trials.iter().map(|t| t.complexity).min()?;
    trials.retain(|t| t.complexity == complexity);
    sort_by_number(&mut trials, |a| a.after);
    let first = trials.remove(0);
    let phrase = |t: &Trial| super::messages::cause(&work.cell, &describe(work, p, &t.undo));
    let mut others: Vec<String> = trials.iter().map(phrase).collect();
    // The sign of an angle is tried both as it stands and as fitted.
    others.retain(|other| *other != phrase(&first));
    others.dedup();
    Some((first, others))
}

fn describe(work: &Work, p: usize, undo: &Undo) -> Suspicion {
    let posture = &work.sheet.postures[p];
    match undo {
        Undo::Angle(j, angle) => {
            let written = first_angles(work, p).map_or(0.0, |q| q[*j]);
            let cause = if *angle == -written {
                Cause::AngleSign
            } else {
                Cause::MistypedAngle
            };
            let mut out = Suspicion::new(cause).joints(&work.cell, &[*j]);
            out.angles_deg = vec![rad_to_deg(written), rad_to_deg(*angle)];
            out.posture(&posture.name)
        }
        Undo::Order(order) => exchanged(work, order).posture(&posture.name),
        Undo::AnglesOf(k) => Suspicion::new(Cause::OtherPosture)
            .posture(&posture.name)
            .posture(&work.sheet.postures[*k].name),
    }
}

/// The angle of joint `j`, within half a turn, at which the readings fit best,
/// and the misfit there.
fn best_angle(
    work: &Work,
    transform: &Isometry3<f64>,
    at: (usize, usize),
    q: &[f64],
    j: usize,
) -> (f64, f64) {
    let mut trial = q.to_vec();
    let mut score = |change: f64| {
        trial[j] = q[j] + change;
        state_rms(work, transform, at, &trial).unwrap_or(f64::INFINITY)
    };
    let mut step = std::f64::consts::TAU / STEPS as f64;
    let mut best = (f64::INFINITY, 0.0);
    for i in 0..STEPS {
        let change = (i as f64 - STEPS as f64 / 2.0) * step;
        let value = score(change);
        if value < best.0 {
            best = (value, change);
        }
    }
    for _ in 0..HALVINGS {
        step /= 2.0;
        for change in [best.1 - step, best.1 + step] {
            let value = score(change);
            if value < best.0 {
                best = (value, change);
            }
        }
    }
    (q[j] + best.1, best.0)
}
