//! Load states of one posture: whether displacement grows in proportion to the
//! load, where the line meets zero load, and whether unloading comes back on
//! the way of loading.
//!
//! The displacements of all points are projected onto the direction in which
//! the model says they move; z is the result, per point. Against the relative
//! load λ (1 at the posture's largest) the line z = α + βλ has the offset α: lost
//! motion where it is positive. With λ² there is a curvature, and
//! down minus up at the same load is the width of the loop. The scatter comes from
//! what the richest of these curves leaves of all components where the states
//! suffice, otherwise from the identification.

mod series;

use super::noise::{Agreement, NoiseTest};
use super::tails::{LEVEL, chi_squared_tails, two_sided};
use crate::error::Result;
use crate::estimate::identify::Fit;
use crate::findings::{Finding, codes, length, length_with_error, percent, probability};
use serde::{Deserialize, Serialize};
use series::{Series, series};

/// Degrees of freedom from which the scatter about the curves is used.
const FEWEST_DEGREES: usize = 6;
/// Level of each of the three pooled tests.
const FAMILY: f64 = LEVEL / 3.0;

/// An estimate with its standard error and the probability of one as large
/// where the truth is zero.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PooledStates {
    /// The estimate: \[m\], or a fraction for a curvature.
    pub value: f64,
    /// Its standard error.
    pub standard_error: f64,
    /// Two-sided probability.
    pub p_value: f64,
}

/// Load states of one posture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PostureStates {
    /// Posture.
    pub posture: String,
    /// Its load states with alike loads, in the order taken.
    pub states: Vec<String>,
    /// Their loads relative to the largest.
    pub loads: Vec<f64>,
    /// Displacement of each along the model's direction, RMS over the points \[m\].
    pub displacements_m: Vec<f64>,
    /// Where the line meets zero load, with its standard error \[m\].
    pub offset_m: Option<[f64; 2]>,
    /// Displacement at the largest load beyond proportion, with its standard
    /// error (fraction of it): positive for a joint that softens.
    pub curvature: Option<[f64; 2]>,
    /// Down minus up at the same load, with its standard error \[m\].
    pub loop_m: Option<[f64; 2]>,
    /// The loop as a share of the displacement at its load.
    pub loop_share: Option<f64>,
}

/// Linearity and hysteresis of an experiment.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LoadStates {
    /// The postures with several load states.
    pub postures: Vec<PostureStates>,
    /// Offset at zero load over all postures \[m\].
    pub offset: Option<PooledStates>,
    /// Curvature over all postures (fraction).
    pub curvature: Option<PooledStates>,
    /// Offset beside the curvature over all postures \[m\].
    pub offset_with_curvature: Option<PooledStates>,
    /// Width of the loop over all postures \[m\].
    pub hysteresis: Option<PooledStates>,
    /// Scatter of a displacement component behind the standard errors \[m\].
    pub scatter_m: f64,
    /// Its degrees of freedom where it comes from the load states themselves.
    pub scatter_degrees_of_freedom: Option<usize>,
    /// Probability of a scatter as large by the cell's noise; `None` where it
    /// was not estimated from the load states.
    pub scatter_p: Option<f64>,
    /// True where displacements are against a preload, which took lost motion up.
    #[serde(skip)]
    pub against_preload: bool,
}

/// Examines the postures with at least two load states whose loads point
/// alike; `None` where there is none.
///
/// # Errors
/// As [`identify`](crate::estimate::identify::identify()).
pub fn load_states(fit: &Fit, noise: Option<&NoiseTest>) -> Result<Option<LoadStates>> {
    let mut all = Vec::new();
    for block in &fit.system().blocks {
        fit.control().check()?;
        all.extend(series(fit, block)?);
    }
    if all.is_empty() {
        return Ok(None);
    }
    let (size, free) =
        all.iter().filter_map(Series::scatter).fold((0.0, 0), |(s, f), (size, free)| (s + size, f + free));
    let expected = fit.cell().noise.displacement_std();
    let (scatter, degrees) = if free >= FEWEST_DEGREES {
        ((size / free as f64).sqrt(), Some(free))
    } else {
        // The cell's noise, if the residuals bear it out.
        match noise {
            Some(test) if test.agreement != Agreement::Larger => (expected, None),
            _ => (fit.solution().residual_std.unwrap_or(expected), None),
        }
    };
    let mut out = LoadStates {
        scatter_m: scatter,
        scatter_degrees_of_freedom: degrees,
        scatter_p: degrees
            .filter(|_| expected > 0.0)
            .and_then(|d| Some(chi_squared_tails(size / expected.powi(2), d)?.0)),
        against_preload: fit.measured().is_against_preload(),
        ..LoadStates::default()
    };
    let mut beside = Vec::new();
    for series in &all {
        let error = |variance: f64| scatter * variance.max(0.0).sqrt();
        let line = series.fit(false);
        let curve = series.fit(true);
        let bend = curve.as_ref().map(|c| {
            // κ over the displacement at the largest load.
            let top: f64 = c.values.rows(0, 3).sum();
            [c.values[2] / top, error(c.covariance[(2, 2)]) / top.abs()]
        });
        beside.push(curve.map(|c| [c.values[0], error(c.covariance[(0, 0)])]));
        let width = series.width(line.as_ref());
        out.postures.push(PostureStates {
            posture: series.posture.clone(),
            states: series.states.clone(),
            loads: series.load.iter().copied().collect(),
            displacements_m: series.z.iter().copied().collect(),
            offset_m: line.map(|l| [l.values[0], error(l.covariance[(0, 0)])]),
            curvature: bend,
            loop_m: width.map(|(w, variance, _)| [w, error(variance)]),
            loop_share: width.map(|(w, _, size)| w / size).filter(|s| s.is_finite()),
        });
    }
    let pooled = |values: &mut dyn Iterator<Item = Option<[f64; 2]>>| pool(values, degrees);
    out.offset = pooled(&mut out.postures.iter().map(|p| p.offset_m));
    out.curvature = pooled(&mut out.postures.iter().map(|p| p.curvature));
    out.offset_with_curvature = pooled(&mut beside.into_iter());
    out.hysteresis = pooled(&mut out.postures.iter().map(|p| p.loop_m));
    Ok(Some(out))
}

/// Mean with weights by the standard errors.
fn pool(values: &mut dyn Iterator<Item = Option<[f64; 2]>>, degrees: Option<usize>) -> Option<PooledStates> {
    let (mut sum, mut weights) = (0.0, 0.0);
    for [value, error] in values.flatten() {
        if error > 0.0 && error.is_finite() && value.is_finite() {
            sum += value / (error * error);
            weights += 1.0 / (error * error);
        }
    }
    if weights <= 0.0 {
        return None;
    }
    let (value, standard_error) = (sum / weights, 1.0 / weights.sqrt());
    Some(PooledStates { value, standard_error, p_value: two_sided(value / standard_error, degrees)? })
}

impl LoadStates {
    /// Linearity and hysteresis in words.
    pub fn findings(&self) -> Vec<Finding> {
        let mut out = Vec::new();
        let significant = |p: &Option<PooledStates>| p.filter(|p| p.p_value < FAMILY);
        let mut add = |code, message| {
            out.push(Finding::caution(code, "load states", message));
        };
        let curved = significant(&self.curvature);
        if let Some(bend) = curved {
            let way = if bend.value > 0.0 { "softens" } else { "stiffens" };
            add(
                "load-curvature",
                format!(
                    "The arm {way} with the load: at the largest load {} ± {} of the displacement is beyond \
                     proportion.",
                    percent(bend.value),
                    percent(bend.standard_error)
                ),
            );
        }
        // A curvature alone moves the line's end as well.
        let real = curved.is_none() || significant(&self.offset_with_curvature).is_some();
        if let Some(offset) = significant(&self.offset).filter(|_| real) {
            let size = length_with_error(offset.value, offset.standard_error);
            let meaning = if offset.value > 0.0 && self.against_preload {
                "lost motion that the preload has not taken up. Give it more load"
            } else if offset.value > 0.0 {
                "lost motion. Take differences against a light preload, or add the lost motion of the joints as \
                     extra terms"
            } else {
                "friction that holds small loads, or forces that are read too large by a constant"
            };
            add(
                codes::LOAD_OFFSET,
                format!(
                    "The lines through the load states miss zero by {size} in the direction of the displacement: \
                     {meaning}."
                ),
            );
        }
        if let Some(width) = significant(&self.hysteresis) {
            let shares: Vec<f64> = self.postures.iter().filter_map(|p| p.loop_share).collect();
            let share = crate::numerics::sample::mean(&shares);
            add(
                "hysteresis",
                format!(
                    "Coming down, the points are {} {} than going up at the same load ({} of the displacement): \
                     friction in the joints. Measure both ways and keep both.",
                    length_with_error(width.value.abs(), width.standard_error),
                    if width.value > 0.0 { "further out" } else { "less far out" },
                    percent(share.abs()),
                ),
            );
        }
        if let Some(p) = self.scatter_p.filter(|p| *p < 0.5 * LEVEL) {
            add(
                "load-scatter",
                format!(
                    "Load states scatter about their curves by {}, more than the cell's noise explains ({}): drift, or \
                     a load that had not settled.",
                    length(self.scatter_m),
                    probability(p)
                ),
            );
        }
        if out.is_empty()
            && let Some(offset) = self.offset
        {
            out.push(Finding::note(
                "load-linear",
                "load states",
                format!(
                    "Displacements grow in proportion to the load: the lines through the load states meet zero at {}.",
                    length_with_error(offset.value, offset.standard_error)
                ),
            ));
        }
        out
    }
}
