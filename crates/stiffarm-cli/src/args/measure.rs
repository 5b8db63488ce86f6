//! The command line of `stiffarm measure`.

use clap::{Args, ValueHint};
use std::time::Duration;
use stiffarm::ask::values::{pause, seed};
use stiffarm::units::mm_to_m;

/// Goals are shares of k; beyond this one says nothing.
const WIDEST: f64 = 0.5;

#[derive(Debug, Args)]
pub struct MeasureArgs {
    /// Cell file
    #[arg(value_hint = ValueHint::FilePath)]
    pub cell: String,
    /// The plan, in measuring order
    #[arg(value_hint = ValueHint::FilePath, value_name = "PLAN.csv")]
    pub plan: String,
    /// The files that tracker or engineer fill in; without --once they need not be there yet
    #[arg(value_hint = ValueHint::FilePath, value_name = "READINGS", required = true)]
    pub readings: Vec<String>,
    /// Good enough, at 95 % with all errors together: `2%` for every joint's stiffness known to 2 %, or `0.05mm` for
    /// the deflection at each of the cell's tasks predicted to 0.05 mm
    #[arg(long, value_name = "2%|0.05mm", value_parser = goal)]
    pub until: Option<Goal>,
    /// Judge what is there and end, instead of waiting for more
    #[arg(long)]
    pub once: bool,
    /// Seconds between two looks at the files
    #[arg(long, value_name = "S", default_value = "1", value_parser = pause(), conflicts_with = "once")]
    pub every: Duration,
    /// Do not search for a posture that would help more than the next planned one
    #[arg(long)]
    pub no_search: bool,
    /// Result of `register`: places raw readings in the base frame
    #[arg(value_hint = ValueHint::FilePath, long, value_name = "registration.json")]
    pub registration: Option<String>,
    /// Seed of the search for a better posture
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = seed())]
    pub seed: u64,
}

/// What is good enough.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Goal {
    /// Half width of every joint's stiffness (fraction of k).
    Stiffness(f64),
    /// Half width of the deflection at each task \[m\].
    Deflection(f64),
}

impl Goal {
    /// The share of k, where that is the goal.
    pub fn stiffness(self) -> Option<f64> {
        match self {
            Goal::Stiffness(part) => Some(part),
            Goal::Deflection(_) => None,
        }
    }

    /// The length, where that is the goal \[m\].
    pub fn deflection(self) -> Option<f64> {
        match self {
            Goal::Stiffness(_) => None,
            Goal::Deflection(length) => Some(length),
        }
    }
}

/// `2%` or `0.05mm`.
fn goal(text: &str) -> Result<Goal, String> {
    let wrong = || {
        "give a percentage of the stiffness up to 50, such as 2%, or a length, such as 0.05mm"
            .to_string()
    };
    let number = |text: &str| {
        text.trim()
            .parse::<f64>()
            .ok()
            .filter(|v| *v > 0.0 && v.is_finite())
    };
    let text = text.trim();
    if let Some(mm) = text.strip_suffix("mm") {
        let mm = number(mm)
            .filter(|mm| (1e-6..=1e3).contains(mm))
            .ok_or_else(wrong)?;
        return Ok(Goal::Deflection(mm_to_m(mm)));
    }
    let percent = text.strip_suffix('%').and_then(number).ok_or_else(wrong)?;
    if percent <= 100.0 * WIDEST {
        Ok(Goal::Stiffness(percent / 100.0))
    } else {
        Err(wrong())
    }
}
