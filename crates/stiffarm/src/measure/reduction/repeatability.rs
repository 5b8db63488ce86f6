//! How well repeated readings of one reflector in one state agree.

use super::messages::length;
use crate::error::{Code, Error, Result};
use crate::findings::{Finding, codes};
use crate::measure::series::PostureSeries;
use crate::model::cell::Cell;
use serde::{Deserialize, Serialize};
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Error probability of a finding that rests on a test.
pub(super) const SIGNIFICANCE: f64 = 1e-3;
/// Degrees of freedom from which the repeats, not the cell, say how large the
/// noise of a reading is.
const FEWEST_DEGREES: usize = 12;

/// Standard deviation of a single reading, from the repeats.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Repeatability {
    /// Along one axis, pooled over axes, points, states and postures \[m\].
    pub std_m: f64,
    /// Its degrees of freedom.
    pub degrees_of_freedom: usize,
    /// Readings that repeat another of their state to the last digit.
    pub identical_readings: usize,
}

/// Pools the repeats of the measuring points; `None` without repeats. Drift
/// within a state is removed by the rate of the point's line.
pub(super) fn repeatability(postures: &[PostureSeries<'_>]) -> Option<Repeatability> {
    let mut sum = 0.0;
    let mut freedom = 0.0;
    let mut identical = 0;
    for (_, series) in postures.iter().flat_map(|p| &p.points) {
        let rate = series.line.map_or_else(Default::default, |line| line.rate);
        for state in &series.states {
            let mut clocks = 0.0;
            for sample in &state.samples {
                let from_mean = sample.clock - state.clock;
                let deviation = sample.position - state.position - rate * from_mean;
                sum += deviation.norm_squared();
                clocks += from_mean * from_mean;
            }
            freedom += 3.0 * (state.count() - 1) as f64;
            // The rate is estimated: from these very readings, which takes
            // degrees of freedom, or from others, which adds its variance.
            if let Some(line) = series.line {
                let sign = if line.role == state.role { -1.0 } else { 1.0 };
                freedom += 3.0 * sign * clocks / line.spread;
            }
            let pairs = state.samples.windows(2);
            identical += pairs.filter(|w| w[0].position == w[1].position).count();
        }
    }
    let degrees_of_freedom = freedom.round().max(0.0) as usize;
    (degrees_of_freedom > 0).then(|| Repeatability {
        std_m: (sum / freedom).sqrt(),
        degrees_of_freedom,
        identical_readings: identical,
    })
}

/// Standard deviation of one reading along one axis \[m\]: from the repeats
/// where there are enough, else the cell's.
pub(super) fn reading_std(cell: &Cell, repeatability: Option<&Repeatability>) -> f64 {
    match repeatability {
        Some(r) if r.degrees_of_freedom >= FEWEST_DEGREES && r.identical_readings == 0 => r.std_m,
        _ => cell.noise.reading_variance.sqrt(),
    }
}

/// Share of a χ² distribution below and above `value`.
pub(super) fn chi_squared_tails(value: f64, degrees_of_freedom: usize) -> Result<[f64; 2]> {
    let distribution = ChiSquared::new(degrees_of_freedom as f64)
        .map_err(|_| Error::new(Code::Internal, "A χ² distribution could not be set up."))?;
    Ok([distribution.cdf(value), distribution.sf(value)])
}

/// What the repeats say about the cell's noise.
pub(super) fn findings(cell: &Cell, result: &Repeatability) -> Result<Vec<Finding>> {
    let mut out = Vec::new();
    if result.identical_readings > 0 {
        let (readings, repeat) = match result.identical_readings {
            1 => ("1 reading".to_string(), "repeats"),
            n => (format!("{n} readings"), "repeat"),
        };
        out.push(Finding::caution(
            codes::IDENTICAL_READINGS,
            "repeatability",
            format!(
                "{readings} {repeat} another of the same state to the last digit. Copied rows? They make the \
                 repeatability look better than it is."
            ),
        ));
    }
    let expected = cell.noise.reading_variance.sqrt();
    if expected <= 0.0 {
        return Ok(out);
    }
    let freedom = result.degrees_of_freedom;
    let chi_squared = (result.std_m / expected).powi(2) * freedom as f64;
    let [below, above] = chi_squared_tails(chi_squared, freedom)?;
    let measured = format!(
        "Repeated readings scatter by {} along an axis ({freedom} degrees of freedom), the cell's noise says {}",
        length(result.std_m),
        length(expected)
    );
    if above < SIGNIFICANCE / 2.0 {
        out.push(Finding::caution(
            "repeats-worse-than-noise",
            "noise.variance_mm2",
            format!(
                "{measured}: intervals from the cell's noise would be too narrow. Set noise.variance_mm2 = {:.3e} in \
                 the cell, or let the noise be estimated.",
                result.std_m.powi(2) * 1e6
            ),
        ));
    } else if below < SIGNIFICANCE / 2.0 {
        out.push(Finding::note(
            "repeats-better-than-noise",
            "noise.variance_mm2",
            format!(
                "{measured}. Repeats taken at once share what makes readings differ over hours; trust them for the \
                 tracker alone."
            ),
        ));
    }
    Ok(out)
}
