//! Drift: readings before and after the load that should agree and don't.
//!
//! Drift before base motion. Each reflector, those on the base too, is freed of
//! its own straight line through the readings without load; what then moves on
//! the base is the base. The other way round the tracker's drift would be taken
//! for motion of the base.

use super::messages::{length, postures_first, rate};
use super::repeatability::{SIGNIFICANCE, chi_squared_tails};
use crate::error::Result;
use crate::findings::{Finding, Severity};
use crate::measure::series::{Clock, PostureSeries, Series};
use crate::model::measurement::Role;
use nalgebra::{Isometry3, Vector3};
use serde::{Deserialize, Serialize};

/// Seconds per hour.
const HOUR: f64 = 3600.0;
/// Drift so many times what noise gives asks for a look at its cause.
const LARGE_DRIFT_RATIO: f64 = 3.0;

/// Drift within one posture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PostureDrift {
    /// Posture.
    pub posture: String,
    /// What the straight lines of its points run over.
    pub clock: Clock,
    /// Change from the first to the last reference reading, base axes, mean
    /// over the measuring points \[m\].
    pub change_m: [f64; 3],
    /// Largest change of one measuring point \[m\].
    pub largest_change_m: f64,
}

/// Drift of the whole experiment.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Drift {
    /// The postures with reference readings before and after a load.
    pub postures: Vec<PostureDrift>,
    /// RMS of the points' changes, along an axis \[m\].
    pub rms_m: f64,
    /// The same as noise alone would give it \[m\].
    pub expected_rms_m: f64,
    /// Common rate of all points, base axes \[m/h\], where times are recorded.
    pub rate_m_per_hour: Option<[f64; 3]>,
    /// Standard error of each component of that rate by the noise \[m/h\].
    pub rate_standard_error_m_per_hour: Option<f64>,
    /// Probability that noise alone gives such changes or such a common rate (the
    /// smaller of both, doubled); `None` without noise.
    pub significance: Option<f64>,
}

/// Summarises the lines of all measuring points; `None` where there is none.
///
/// # Errors
/// A quantile that cannot be computed.
pub(super) fn drift(
    postures: &[PostureSeries<'_>],
    base_from_tracker: &Isometry3<f64>,
    reading_std: f64,
) -> Result<Option<Drift>> {
    let mut out = Vec::new();
    let (mut sum, mut expected, mut statistic, mut lines) = (0.0, 0.0, 0.0, 0_usize);
    // Σ rate·spread and Σ spread, by time and by order.
    let mut common = [(Vector3::zeros(), 0.0); 2];
    for posture in postures {
        let with_line = posture.points.iter().filter_map(|(_, s)| s.line);
        let changes: Vec<Vector3<f64>> =
            with_line.clone().map(|line| line.rate * (line.span[1] - line.span[0])).collect();
        if changes.is_empty() {
            continue;
        }
        for (line, change) in with_line.zip(&changes) {
            lines += 1;
            sum += change.norm_squared();
            expected += (line.span[1] - line.span[0]).powi(2) / line.spread;
            statistic += line.rate.norm_squared() * line.spread;
            let (weighted, weight) = &mut common[(posture.clock == Clock::Order) as usize];
            *weighted += line.rate * line.spread;
            *weight += line.spread;
        }
        let mean = changes.iter().sum::<Vector3<f64>>() / changes.len() as f64;
        out.push(PostureDrift {
            posture: posture.name().to_string(),
            clock: posture.clock,
            change_m: (base_from_tracker.rotation * mean).into(),
            largest_change_m: changes.iter().map(Vector3::norm).fold(0.0, f64::max),
        });
    }
    if out.is_empty() {
        return Ok(None);
    }
    let significance = if reading_std > 0.0 {
        // A drift that differs from point to point, or one common to all.
        let rates = common.iter().filter(|(_, weight)| *weight > 0.0);
        let rate: f64 = rates.clone().map(|(v, w)| v.norm_squared() / w).sum();
        let tail = |sum: f64, freedom: usize| Ok(chi_squared_tails(sum / reading_std.powi(2), freedom)?[1]);
        let common: f64 = tail(rate, 3 * rates.count())?;
        Some((2.0 * common.min(tail(statistic, 3 * lines)?)).min(1.0))
    } else {
        None
    };
    let (weighted, weight) = common[0];
    Ok(Some(Drift {
        postures: out,
        rms_m: (sum / (3 * lines) as f64).sqrt(),
        expected_rms_m: reading_std * (expected / lines as f64).sqrt(),
        rate_m_per_hour: (weight > 0.0).then(|| (base_from_tracker.rotation * weighted * (HOUR / weight)).into()),
        rate_standard_error_m_per_hour: (weight > 0.0).then(|| reading_std / weight.sqrt() * HOUR),
        significance,
    }))
}

/// What was done about drift, and how large it is.
pub(super) fn findings(postures: &[PostureSeries<'_>], drift: Option<&Drift>) -> Vec<Finding> {
    let mut out = Vec::new();
    let mixed: Vec<&str> = postures
        .iter()
        .filter(|p| p.clock == Clock::Order)
        .filter(|p| p.readings.states.iter().flat_map(|s| &s.readings).any(|r| r.time.is_some()))
        .map(PostureSeries::name)
        .collect();
    if !mixed.is_empty() {
        out.push(Finding::note(
            "times-incomplete",
            "time_s",
            format!(
                "{}: some readings have no time, so the order of the states stands for the times.",
                postures_first(&mixed)
            ),
        ));
    }
    let loaded = |p: &&PostureSeries<'_>| p.states(Role::Loaded).next().is_some();
    let open: Vec<&str> = postures
        .iter()
        .filter(loaded)
        .filter(|p| p.points.iter().any(|(_, s)| !covered(s, p.reference)))
        .map(PostureSeries::name)
        .collect();
    if !open.is_empty() {
        out.push(Finding::note(
            "drift-unknown",
            "drift",
            format!(
                "{}: not every loaded reading has reference readings before and after it, so drift between them \
                 stays in its displacement. A state unloaded-2 after the load would remove it.",
                postures_first(&open)
            ),
        ));
    }
    let Some(drift) = drift else { return out };
    let by = if drift.postures.iter().all(|p| p.clock == Clock::Time) {
        "a straight line in time"
    } else {
        "a straight line over the order of the states"
    };
    let (common, error) = (drift.rate_m_per_hour, drift.rate_standard_error_m_per_hour);
    let rate = rate(common, error, "hour").map(|rate| format!(", in common {rate}"));
    let rate = rate.unwrap_or_default();
    let (severity, verdict) = match drift.significance {
        Some(p) if p < SIGNIFICANCE => (
            if drift.rms_m > LARGE_DRIFT_RATIO * drift.expected_rms_m { Severity::Caution } else { Severity::Note },
            ": the tracker, the robot or a stand drifts, or the arm does not come back (lost motion)",
        ),
        Some(_) => (Severity::Note, ": no more than noise"),
        None => (Severity::Note, ""),
    };
    out.push(Finding::new(
        "drift",
        severity,
        "drift",
        format!(
            "Reference readings before and after the load differ by {} along an axis (RMS; by noise alone {}){rate}\
             {verdict}. Removed point by point by {by}.",
            length(drift.rms_m),
            length(drift.expected_rms_m)
        ),
    ));
    out
}

/// True where a line covers every loaded state of the reflector, or where no
/// state could be its reference.
fn covered(series: &Series<'_>, reference: Role) -> bool {
    let has = |role| series.states.iter().any(|s| s.role == role);
    let mut loaded = series.states.iter().filter(|s| s.role == Role::Loaded);
    !has(reference) || loaded.all(|s| series.line.is_some_and(|line| line.covers(s.clock)))
}
