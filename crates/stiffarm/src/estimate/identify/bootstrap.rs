//! Bootstrap over postures: intervals that assume nothing of the errors but
//! that postures are alike and independent of each other.

use super::assumptions::{Assumptions, Estimator};
use super::estimate::{JointEstimate, estimate};
use super::fit::Fit;
use super::solve::{Prepared, Solution};
use super::system::MeasuredSystem;
use super::{IdentifyOptions, check};
use crate::error::{Code, Error, Result};
use crate::numerics::control::Control;
use crate::numerics::jobs::in_order_watched;
use crate::numerics::sample::{mean, quantile_of};
use crate::numerics::streams::resample_rng;
use nalgebra::DVector;
use rand::RngExt;
use serde::{Deserialize, Serialize};

/// Resamples that must lie beyond each end of an interval.
const IN_TAIL: f64 = 5.0;
/// Largest number of resamples.
const MAX_RESAMPLES: usize = 1_000_000;

/// Intervals from postures drawn with replacement.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Bootstrap {
    /// One estimate per joint (spring): values of the fit to all postures,
    /// standard errors and intervals from the resamples.
    pub joints: Vec<JointEstimate>,
    /// How the unknowns were estimated.
    pub estimator: Estimator,
    /// Postures drawn from, and in each resample.
    pub postures: usize,
    /// Resamples asked for.
    pub resamples: usize,
    /// Resamples that did not determine every unknown that all postures
    /// determine; they are not in the intervals.
    pub skipped: usize,
    /// Degrees of freedom that postures as independent units leave,
    /// 3·postures − n, at most rows − n: the key to the measured coverage.
    pub degrees_of_freedom: usize,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Confidence of the intervals.
    pub confidence: f64,
}

/// Percentile intervals of the compliances from `resamples` sets of postures
/// drawn with replacement (Efron & Tibshirani, An Introduction to the
/// Bootstrap, 1993, chapter 13). All load states of a posture stay together.
///
/// # Errors
/// As [`super::identify`]; fewer than two postures; too few resamples for the
/// confidence; or too few of them that determine the joints.
pub fn bootstrap(fit: &Fit, resamples: usize, seed: u64, confidence: f64) -> Result<Bootstrap> {
    check(&IdentifyOptions { confidence, ..fit.options().clone() })?;
    let rows = Rows { system: fit.system(), prepared: fit.prepared(), assumed: fit.assumed(), control: fit.control() };
    resampled(&rows, &fit.system().delta, fit.solution(), resamples, seed, confidence)
}

/// What a bootstrap draws from.
#[derive(Clone, Copy)]
pub(crate) struct Rows<'a> {
    /// Ψ x = Δ; its Δ is not read.
    pub system: &'a MeasuredSystem,
    /// What depends on Ψ only.
    pub prepared: &'a Prepared,
    /// What is assumed.
    pub assumed: &'a Assumptions,
    /// How the caller stops it.
    pub control: Control<'a>,
}

/// [`bootstrap`] of displacements `delta`, to which `all` is the fit.
///
/// # Errors
/// As [`bootstrap`].
pub(crate) fn resampled(
    rows: &Rows<'_>,
    delta: &DVector<f64>,
    all: &Solution,
    resamples: usize,
    seed: u64,
    confidence: f64,
) -> Result<Bootstrap> {
    let Rows { system, prepared, assumed, control } = *rows;
    let postures = system.blocks.len();
    if postures < 2 {
        let message = "Postures can only be resampled where there are at least two.";
        return Err(Error::new(Code::TooFewData, message));
    }
    let tail = 0.5 * (1.0 - confidence);
    let least = (IN_TAIL / tail).ceil() as usize;
    if resamples < least || resamples > MAX_RESAMPLES {
        let message = format!(
            "Intervals of {} % need from {least} to {MAX_RESAMPLES} resamples, not {resamples}.",
            100.0 * confidence
        );
        return Err(Error::invalid(message));
    }
    let white = prepared.whitened().whiten(delta);
    let numbers: Vec<usize> = (0..resamples).collect();
    let drawn = in_order_watched(&numbers, "resampling postures", control, |(_, r)| {
        let mut rng = resample_rng(seed, *r);
        let chosen: Vec<usize> = (0..postures).map(|_| rng.random_range(0..postures)).collect();
        let (prepared, white) = prepared.select(&chosen, &white)?;
        let solution = prepared.solve_white(&white, assumed)?;
        let lost = solution.undetermined.iter().any(|j| !all.undetermined.contains(j));
        Ok((!lost).then_some(solution.values))
    })?;
    let solutions: Vec<_> = drawn.iter().flatten().collect();
    if solutions.len() < least {
        let message =
            format!("Only {} of {resamples} resamples of {postures} postures determine the joints.", solutions.len());
        return Err(Error::new(Code::TooFewData, message)
            .hint("measure more postures, or use the intervals of the estimator itself"));
    }
    let joint = |j: usize| -> JointEstimate {
        let value = (!all.undetermined.contains(&j)).then(|| all.values[j]);
        let values: Vec<f64> = solutions.iter().map(|v| v[j]).collect();
        let mut out = estimate(&system.unknowns[j], value, Some(standard_deviation(&values)), None);
        if value.is_some() {
            out.close(quantile_of(&values, tail), quantile_of(&values, 1.0 - tail));
        }
        out
    };
    let rank = all.factor.rank();
    Ok(Bootstrap {
        joints: (0..system.springs).map(joint).collect(),
        estimator: assumed.estimator,
        postures,
        resamples,
        skipped: resamples - solutions.len(),
        degrees_of_freedom: system.shifts().min(system.psi.nrows()).saturating_sub(rank),
        seed,
        confidence,
    })
}

fn standard_deviation(values: &[f64]) -> f64 {
    let centre = mean(values);
    let squares: f64 = values.iter().map(|v| (v - centre).powi(2)).sum();
    (squares / (values.len() - 1) as f64).sqrt()
}
