//! The command line of `stiffarm measure`.

use super::values::pause;
use clap::Args;
use std::time::Duration;

/// Goals are shares of k; beyond this one says nothing.
const WIDEST: f64 = 0.5;

#[derive(Debug, Args)]
pub struct MeasureArgs {
    /// Cell file
    pub cell: String,
    /// The plan, in measuring order
    #[arg(value_name = "PLAN.csv")]
    pub plan: String,
    /// The files that tracker or engineer fill in; the first need not be there yet
    #[arg(value_name = "READINGS", required = true)]
    pub readings: Vec<String>,
    /// Good enough: every joint's stiffness known to this part of it at 95 %, all errors together
    #[arg(long, value_name = "PERCENT", value_parser = goal)]
    pub until: Option<f64>,
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
    #[arg(long, value_name = "registration.json")]
    pub registration: Option<String>,
    /// Seed of the search for a better posture
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
}

/// `2%` or `2`: a share of k.
fn goal(text: &str) -> Result<f64, String> {
    let number = text.trim().trim_end_matches('%').trim();
    match number.parse::<f64>() {
        Ok(percent) if percent > 0.0 && percent <= 100.0 * WIDEST => Ok(percent / 100.0),
        _ => Err("give a percentage of the stiffness from above 0 to 50, such as 2%".to_string()),
    }
}
