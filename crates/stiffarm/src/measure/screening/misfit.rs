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
    let (Some(prior), Some(state)) = (&work.cell.prior, work.sheet.postures[p].states.first())
    else {
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
    both.map(|(a, b)| (a.position - b.position).norm())
        .fold(0.0, f64::max)
}

/// Misfit of one state at the angles `q`; `None` without readings.
pub(super) fn state_rms(
    work: &Work,
    transform: &Isometry3<f64>,
    at: (usize, usize),
    q: &[f64],
) -> Option<f64> {
    let pairs = state_pairs(&work.sheet.at(at).points, &work.predicted(q));
    (!pairs.is_empty()).then(|| rms(transform, &pairs))
}

/// Angles of a posture's first reference state.
pub(super) fn first_angles(work: &Work, p: usize) -> Option<Vec<f64>> {
    let posture = &work.sheet.postures[p];
    let first = posture.references().first().copied()?;
    Some(posture.states[first].q.clone())
}
