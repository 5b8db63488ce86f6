//! How often the statistical tests repeat, and limits that follow from the count.
//!
//! The variable `STIFFARM_TEST_RUNS` is a factor on every count: 1, the default,
//! is what each change can afford; the nightly workflow sets 10.

use statrs::distribution::{Binomial, DiscreteCDF};

/// Probability that chance alone exceeds one limit of a count.
const FALSE_ALARM: f64 = 1e-3;

/// `base` times the factor that `STIFFARM_TEST_RUNS` asks for, at least 1.
pub fn runs(base: u64) -> u64 {
    let factor = match std::env::var("STIFFARM_TEST_RUNS") {
        Ok(text) => text
            .parse()
            .ok()
            .filter(|factor: &f64| factor.is_finite() && *factor > 0.0)
            .unwrap_or_else(|| panic!("STIFFARM_TEST_RUNS must be a number above 0, got `{text}`")),
        Err(_) => 1.0,
    };
    ((base as f64 * factor).round() as u64).max(1)
}

/// The most of `runs` that a share of `share` allows: the share itself from
/// `whole` runs on, and with fewer runs what chance makes of it.
pub fn most(share: f64, runs: u64, whole: u64) -> u64 {
    let plain = (share * runs as f64).floor() as u64;
    if runs >= whole {
        return plain;
    }
    let binomial = Binomial::new(share, runs).unwrap();
    binomial.inverse_cdf(1.0 - FALSE_ALARM)
}

/// The fewest of `runs` that a share of `share` allows, as [`most`].
pub fn fewest(share: f64, runs: u64, whole: u64) -> u64 {
    runs - most(1.0 - share, runs, whole)
}

/// The standard error of a share of `runs` independent runs.
pub fn standard_error(share: f64, runs: u64) -> f64 {
    (share * (1.0 - share) / runs as f64).sqrt()
}

/// What fewer than `whole` runs add to a limit that `whole` runs meet: four of
/// their own standard errors.
pub fn slack(standard_error: f64, runs: u64, whole: u64) -> f64 {
    if runs >= whole { 0.0 } else { 4.0 * standard_error }
}

/// By how much fewer than `whole` runs widen the limits of a mean.
pub fn wider(runs: u64, whole: u64) -> f64 {
    (whole as f64 / runs as f64).sqrt().max(1.0)
}
