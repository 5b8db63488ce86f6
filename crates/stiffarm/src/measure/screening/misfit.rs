//! How far the readings of a posture are from one rigid tool and from its angles.

use super::Work;
use super::frame::{rms, state_pairs};
use super::sheet::Mean;
use crate::model::observation::PostureTerms;
use nalgebra::{DVector, Isometry3};

/// How far a state may lie from the unloaded one without a prior \[m\].
const GIVE: f64 = 1e-2;

/// Times the expected displacement that a state may lie off with a prior.
const GIVE_FACTOR: f64 = 5.0;

/// How far a state of posture `p` may lie from its unloaded one \[m\].
pub(super) fn give(work: &Work, p: usize) -> f64 {
    let (Some(prior), Some(state)) = (&work.cell.prior, work.sheet.postures[p].states.first()) else {
        return GIVE;
    };
    let compliance = DVector::from_iterator(prior.len(), prior.iter().map(|k| 1.0 / k));
    let mut most = GIVE;
    for setup in work.setup().cases() {
        let Ok(terms) = PostureTerms::new(&setup, &state.q, None) else {
            return GIVE;
        };
        let expected = terms.block(&setup.robot) * &compliance;
        most = most.max(GIVE_FACTOR * expected.amax());
    }
    most
}

/// Largest distance between the points of two states \[m\].
pub(super) fn gap(a: &[Option<Mean>], b: &[Option<Mean>]) -> f64 {
    let both = a.iter().zip(b).filter_map(|(a, b)| Some(((*a)?, (*b)?)));
    both.map(|(a, b)| (a.position - b.position).norm()).fold(0.0, f64::max)
}

/// Misfit of one state at the angles `q`; `None` without readings.
pub(super) fn state_rms(work: &Work, transform: &Isometry3<f64>, at: (usize, usize), q: &[f64]) -> Option<f64> {
    let pairs = state_pairs(&work.sheet.at(at).points, &work.predicted(q));
    (!pairs.is_empty()).then(|| rms(transform, &pairs))
}

/// Where on a circle `left` is smallest, from half a `turn` before zero to half a turn behind it, and what it is there:
/// in steps all around, then in halved ones.
pub(super) fn best_around(turn: f64, steps: usize, halvings: usize, mut left: impl FnMut(f64) -> f64) -> (f64, f64) {
    let mut step = turn / steps as f64;
    let mut best = (0.0, f64::INFINITY);
    let all = (0..steps).map(|i| (i as f64 - steps as f64 / 2.0) * step);
    let mut places: Vec<f64> = all.collect();
    for _ in 0..=halvings {
        for at in places {
            let value = left(at);
            if value < best.1 {
                best = (at, value);
            }
        }
        step /= 2.0;
        places = vec![best.0 - step, best.0 + step];
    }
    best
}

/// Angles of a posture's first reference state.
pub(super) fn first_angles(work: &Work, p: usize) -> Option<Vec<f64>> {
    let posture = &work.sheet.postures[p];
    let first = posture.references().first().copied()?;
    Some(posture.states[first].q.clone())
}
