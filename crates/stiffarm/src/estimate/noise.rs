//! Drawn numbers: measurement noise as a cell states it.

use crate::model::cell::Noise;
use nalgebra::DVector;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// Noise of the displacements of `postures` postures with `points` points each.
pub(crate) fn draw_noise(rng: &mut ChaCha8Rng, noise: &Noise, postures: usize, points: usize) -> DVector<f64> {
    let sigma = noise.displacement_std();
    let tau = noise.posture_common_std;
    let mut out = DVector::zeros(3 * points * postures);
    for p in 0..postures {
        let common: [f64; 3] = if tau > 0.0 { std::array::from_fn(|_| normal(rng) * tau) } else { [0.0; 3] };
        for i in 0..3 * points {
            out[3 * points * p + i] = normal(rng) * sigma + common[i % 3];
        }
    }
    out
}

/// One standard normal number.
pub(crate) fn normal(rng: &mut ChaCha8Rng) -> f64 {
    StandardNormal.sample(rng)
}
