//! Intervals from the profile of the likelihood, as a check of the symmetric
//! ones in H: one compliance is held, all else fitted anew, the ratio of the
//! two variances included.
//!
//! With H_j = h held, let P(h) be −2 ln of the restricted likelihood of the
//! displacements Δ − ψ_j h on the other columns, σ² and γ at their best. Without
//! shifts P(h) = (N − r + 1) ln(RSS + (h − Ĥ_j)²/[(ΨᵀΨ)⁻¹]_jj) + const with N
//! rows and rank r, so that P(h) − P(Ĥ_j) = (N − r + 1) ln(1 + T²/(N − r)),
//! T the t statistic. The interval therefore ends where
//!
//! P(h) − min P = (N − r + 1) ln(1 + t²/(N − r)),
//!
//! t the quantile behind the main interval. It is the main interval wherever γ
//! is known; what differs is what the estimate of γ does when h moves.
//! (Profile of a restricted likelihood: Bates, Mächler, Bolker & Walker, J. Stat.
//! Softw. 67(1), 2015, doi:10.18637/jss.v067.i01, there for the full
//! likelihood.)

use super::assumptions::{Estimator, Scale};
use super::estimate::{estimate, quantile};
use super::fit::Fit;
use super::restricted::{Restricted, Sums};

use crate::error::Result;
use crate::findings::{Finding, percent};
use crate::numerics::jobs::in_order;
use crate::numerics::scalar::{minimum, zero};
use serde::{Deserialize, Serialize};

/// Ends of k that differ by more than this from the main interval's are named.
const DIFFERS: f64 = 0.1;
/// Steps outward, in half-widths of the main interval, to find an end.
const STEP: f64 = 0.25;
/// Half-widths beyond which the profile counts as open.
const OPEN_PROFILE_WIDTHS: f64 = 64.0;
/// Relative accuracy of an end.
const TOLERANCE: f64 = 1e-12;

/// Profile interval of one joint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct JointProfile {
    /// Name of the joint.
    pub name: String,
    /// Ends of the compliance's profile interval \[rad/(N·m)\]; `None` where the
    /// joint has no interval or the profile never reaches the level.
    pub compliance_interval: [Option<f64>; 2],
    /// The same as stiffness \[N·m/rad\]; the upper end is `None` where the data
    /// give only a lower bound.
    pub interval: [Option<f64>; 2],
    /// Interval of the main result \[N·m/rad\].
    pub main_interval: [Option<f64>; 2],
    /// Largest relative difference of the ends (fraction); `None` where one of
    /// the two intervals lacks an end that the other has, or both have none.
    pub difference: Option<f64>,
}

/// Profile intervals of all joints.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Profile {
    /// Joint by joint.
    pub joints: Vec<JointProfile>,
    /// The largest difference of all ends (fraction).
    pub difference: Option<f64>,
    /// Whether it agrees with the main result.
    pub finding: Finding,
}

/// Profile intervals beside those of [`identify`](super::identify()); `None`
/// for estimators whose intervals come from no likelihood of the data alone
/// (Huber's, the non-negative, the prior's), and without an interval to check.
///
/// # Errors
/// A quantile or decomposition that fails.
pub fn profile(fit: &Fit) -> Result<Option<Profile>> {
    if !fit.options().estimator.is_exact() {
        return Ok(None);
    }
    let (solution, system) = (fit.solution(), fit.system());
    let (Some(covariance), false) = (&solution.covariance, solution.t_degrees_of_freedom == Some(0)) else {
        return Ok(None);
    };
    let t = quantile(solution.t_degrees_of_freedom, fit.options().confidence)?;
    let criterion = fit.likelihood();
    let names: Vec<usize> = (0..system.springs).collect();
    let joints = in_order(&names, |(_, &j)| {
        let name = &system.unknowns[j];
        fit.control().check()?;
        if solution.undetermined.contains(&j) {
            return Ok(joint_profile(name, [None, None], [None, None]));
        }
        let error = covariance[(j, j)].max(0.0).sqrt();
        let main = estimate(name, Some(solution.values[j]), Some(error), Some(t));
        let ends = ends(fit, &criterion, j, error, t)?;
        Ok(joint_profile(name, ends, main.interval))
    })?;
    // What was cut short is no profile.
    fit.control().check()?;
    let finding = finding(&joints);
    let difference = joints.iter().filter_map(|j| j.difference).reduce(f64::max);
    Ok(Some(Profile { joints, difference, finding }))
}

/// Ends of the compliance of joint `j`.
fn ends(fit: &Fit, criterion: &Restricted<'_>, j: usize, error: f64, t: f64) -> Result<[Option<f64>; 2]> {
    let (solution, system) = (fit.solution(), fit.system());
    let centre = solution.values[j];
    let half = t * error;
    if half <= 0.0 {
        return Ok([None, None]);
    }
    if let Scale::Known { .. } | Scale::Repeats { .. } = fit.assumed().scale {
        // σ and γ are given: the profile is a parabola.
        return Ok([Some(centre - half), Some(centre + half)]);
    }
    let (rows, rank) = (system.psi.nrows(), solution.factor.rank());
    let free = (rows - rank) as f64;
    let level = (free + 1.0) * (t * t / free).ln_1p();

    if criterion.is_rounding() {
        // The residuals are rounding: there is no likelihood to speak of.
        return Ok([None, None]);
    }
    let whitened = fit.prepared().whitened();
    // Estimate and row of the matrix from coordinates to unknowns, without shifts.
    let plain = whitened.factor().solve(fit.white())[j];
    let along = whitened.factor().right_inverse().row(j).transpose();
    let fixed_sums = match (fit.assumed().estimator, solution.independent_rows) {
        (Estimator::TwoVariance, false) => None,
        _ => Some(criterion.at(solution.gamma)),
    };
    // −2 ln L at h, γ at its best or as given.
    let value = |h: f64| -> Option<f64> {
        if fit.control().stopped() {
            return None;
        }
        let held = |sums: &Sums| sums.held(along.as_slice(), h - plain, rows);
        Some(match &fixed_sums {
            Some(sums) => held(sums),
            None => criterion.best_by(held).1,
        })
    };
    let Some(lowest) = lowest(&value, centre, half) else {
        // The residuals are rounding: there is no likelihood to speak of.
        return Ok([None, None]);
    };
    // Where it lies above or below the level; what has no value lies above.
    let above = |h: f64| value(h).map_or(level, |v| v - lowest.1 - level);
    let end = |sign: f64| -> Option<f64> {
        let mut inside = (lowest.0, -level);
        let mut reach = STEP;
        while reach <= OPEN_PROFILE_WIDTHS {
            let place = lowest.0 + sign * reach * half;
            let outside = (place, above(place));
            if outside.1 >= 0.0 {
                let tolerance = TOLERANCE * half.max(place.abs());
                return Some(zero(above, inside, outside, tolerance));
            }
            inside = outside;
            // Small steps where the end should be, larger ones beyond.
            reach += STEP * reach.max(1.0);
        }
        None
    };
    Ok([end(-1.0), end(1.0)])
}

/// Place and value of the minimum near `centre`.
fn lowest(value: &impl Fn(f64) -> Option<f64>, centre: f64, half: f64) -> Option<(f64, f64)> {
    let start = (centre, value(centre)?);
    let ends = [centre - 0.5 * half, centre + 0.5 * half];
    let value = |h: f64| value(h).unwrap_or(f64::INFINITY);
    Some(minimum(value, ends, start, 1e-6 * half))
}

fn joint_profile(name: &str, compliance_interval: [Option<f64>; 2], main_interval: [Option<f64>; 2]) -> JointProfile {
    let [low, high] = compliance_interval;
    let positive = |h: Option<f64>| h.filter(|h| *h > 0.0).map(|h| 1.0 / h);
    // As in the main result: no interval of k where even the upper end of the
    // compliance is negative.
    let interval = match positive(high) {
        Some(least) => [Some(least), positive(low)],
        None => [None, None],
    };
    let pairs = interval.iter().zip(&main_interval);
    let same_ends = pairs.clone().all(|(a, b)| a.is_some() == b.is_some());
    let difference =
        pairs.filter_map(|(a, b)| Some((a.as_ref()? / b.as_ref()? - 1.0).abs())).reduce(f64::max).filter(|_| same_ends);
    JointProfile { name: name.to_string(), compliance_interval, interval, main_interval, difference }
}

fn finding(joints: &[JointProfile]) -> Finding {
    let words = |[low, high]: [Option<f64>; 2]| match (low, high) {
        (Some(low), Some(high)) => format!("{low:.3e} to {high:.3e}"),
        (Some(low), None) => format!("above {low:.3e}"),
        _ => "none".to_string(),
    };
    let differs = |joint: &&JointProfile| match joint.difference {
        Some(difference) => difference > DIFFERS,
        None => joint.interval != joint.main_interval,
    };
    let differing: Vec<String> = joints
        .iter()
        .filter(differs)
        .map(|joint| {
            format!("{} {} instead of {} N·m/rad", joint.name, words(joint.interval), words(joint.main_interval))
        })
        .collect();
    let largest = joints.iter().filter_map(|j| j.difference).reduce(f64::max);
    if !differing.is_empty() {
        let message = format!(
            "The profile of the likelihood gives other intervals: {}. The ratio of the two variances is poorly known; \
             take the wider of the two.",
            differing.join("; ")
        );
        return Finding::caution("profile-differs", "intervals", message);
    }
    let message = match largest {
        Some(largest) if largest < 1e-6 => "The profile of the likelihood gives the same intervals.".to_string(),
        Some(largest) => {
            format!("The profile of the likelihood agrees with the intervals within {}.", percent(largest))
        }
        None => "No joint has an interval that a profile of the likelihood could check.".to_string(),
    };
    Finding::note("profile-agrees", "intervals", message)
}
