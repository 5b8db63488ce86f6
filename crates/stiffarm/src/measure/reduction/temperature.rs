//! The temperature beside the readings: how it ran, and whether drift goes with it.

use super::drift::Drift;
use super::messages::{length, rate};
use crate::findings::{Finding, Severity};
use crate::measure::series::PostureSeries;
use crate::model::cell::Cell;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Growth of steel \[1/K\].
const STEEL: f64 = 11.5e-6;
/// A change within a posture of more than this is worth a look \[K\].
const LARGE_CHANGE_K: f64 = 1.0;

/// The temperatures that were recorded.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Temperatures {
    /// Lowest of all readings \[°C\].
    pub lowest_c: f64,
    /// Highest of all readings \[°C\].
    pub highest_c: f64,
    /// Largest difference between readings of one posture \[K\].
    pub largest_change_k: f64,
    /// What the drift between reference readings has in common with the change of temperature between
    /// them, base axes \[m/K\]; where both are there.
    pub drift_m_per_k: Option<[f64; 3]>,
    /// Standard error of each component of that by the noise \[m/K\].
    pub drift_standard_error_m_per_k: Option<f64>,
}

/// The range of the temperatures and the drift with them; `None` where none were recorded.
pub(super) fn temperatures(
    postures: &[PostureSeries<'_>],
    drift: Option<&Drift>,
    reading_std: f64,
) -> Option<Temperatures> {
    let mut range = [f64::INFINITY, f64::NEG_INFINITY];
    let mut largest: f64 = 0.0;
    // Σ change·ΔT, Σ ΔT² and the same with what noise gives a mean change: a line through zero.
    let (mut product, mut square, mut noise) = (Vector3::zeros(), 0.0, 0.0);
    for posture in postures {
        let readings = || posture.readings.states.iter().flat_map(|s| &s.readings);
        let temperatures = readings().filter_map(|reading| reading.temperature);
        let [low, high] =
            temperatures.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], t| [t.min(low), t.max(high)]);
        if low > high {
            continue;
        }
        range = [range[0].min(low), range[1].max(high)];
        largest = largest.max(high - low);
        let mut lists = drift.into_iter().flat_map(|drift| &drift.postures);
        let Some(line) = lists.find(|line| line.posture == posture.name()) else {
            continue;
        };
        let mean = |state: usize| {
            let readings = &posture.readings.states[state].readings;
            let temperatures: Vec<f64> = readings.iter().filter_map(|r| r.temperature).collect();
            (!temperatures.is_empty()).then(|| temperatures.iter().sum::<f64>() / temperatures.len() as f64)
        };
        let mut references = posture.states(posture.reference);
        let first = references.next().and_then(mean);
        let Some((first, last)) = first.zip(references.last().and_then(mean)) else {
            continue;
        };
        let change = last - first;
        product += Vector3::from(line.change_m) * change;
        square += change * change;
        noise += change * change * 2.0 / posture.points.len().max(1) as f64;
    }
    (range[0] <= range[1]).then(|| Temperatures {
        lowest_c: range[0],
        highest_c: range[1],
        largest_change_k: largest,
        drift_m_per_k: (square > 0.0).then(|| (product / square).into()),
        drift_standard_error_m_per_k: (square > 0.0).then(|| reading_std * noise.sqrt() / square),
    })
}

/// How the temperature ran.
pub(super) fn finding(cell: &Cell, temperatures: &Temperatures) -> Finding {
    let growth = cell.setup.robot.length() * STEEL;
    let (common, error) = (temperatures.drift_m_per_k, temperatures.drift_standard_error_m_per_k);
    let drift = rate(common, error, "kelvin");
    let drift = drift.map(|rate| format!(" The drift between reference readings goes with it by {rate}."));
    let drift = drift.unwrap_or_default();
    let (severity, advice) = if temperatures.largest_change_k > LARGE_CHANGE_K {
        (Severity::Caution, " Read the unloaded state right before and after the load.")
    } else {
        (Severity::Note, "")
    };
    let sentence = format!(
        "The temperature ran from {:.1} to {:.1} °C, within a posture by {:.1} K at most; a steel arm of this length \
         grows by {} per kelvin.{drift}{advice}",
        temperatures.lowest_c,
        temperatures.highest_c,
        temperatures.largest_change_k,
        length(growth)
    );
    Finding::new("temperature", severity, "temperature_c", sentence)
}
