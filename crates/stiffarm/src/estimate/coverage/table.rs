//! Coverage as it was counted: the table behind docs/coverage.md, embedded.
//!
//! `cargo run --release -p stiffarm --example coverage` makes both anew.

use crate::estimate::identify::Estimator;
use serde::{Deserialize, Serialize};
use std::sync::LazyLock;

/// Intervals whose confidence holds only roughly, so that their coverage is
/// measured and printed beside them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Intervals {
    /// Of Huber's estimator.
    Huber,
    /// Of the non-negative fit.
    NonNegative,
    /// Of the estimate with prior stiffness.
    Prior,
    /// Of the bootstrap over postures.
    Bootstrap,
}

impl Intervals {
    /// The intervals of an estimator; `None` where they are exact.
    pub fn of(estimator: Estimator) -> Option<Self> {
        match estimator {
            Estimator::Huber => Some(Intervals::Huber),
            Estimator::NonNegative => Some(Intervals::NonNegative),
            Estimator::Prior => Some(Intervals::Prior),
            Estimator::TwoVariance | Estimator::Ordinary | Estimator::Weighted => None,
        }
    }
}

/// One row of the table.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Record {
    /// Table of the page that it stands in.
    pub table: String,
    /// What was simulated, in words.
    pub situation: String,
    /// The intervals it speaks for, where they are not exact.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub intervals: Option<Intervals>,
    /// True where the situation goes against what the intervals assume.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub adverse: bool,
    /// Number of postures.
    pub postures: usize,
    /// Measuring points of each.
    pub points: usize,
    /// Degrees of freedom of the intervals; `None` for normal quantiles.
    pub degrees_of_freedom: Option<usize>,
    /// Number of experiments.
    pub experiments: usize,
    /// Share of the intervals that held the truth, all joints together (fraction).
    pub coverage: f64,
    /// Its standard error.
    pub standard_error: f64,
    /// The same of the joint with the smallest share.
    pub lowest: f64,
    /// The same of the joint with the largest share.
    pub highest: f64,
    /// Mean half-width of the intervals of the compliance over the true
    /// compliance (fraction).
    pub relative_half_width: Option<f64>,
    /// Share of the intervals that were open above (fraction).
    pub open_above: f64,
}

/// The whole file.
#[derive(Debug, Deserialize)]
struct File {
    records: Vec<Record>,
}

/// How often intervals of a kind held the truth in simulation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MeasuredCoverage {
    /// Degrees of freedom at which it was counted.
    pub degrees_of_freedom: usize,
    /// Share of the 95 % intervals that held the truth where the world is as
    /// the estimator assumes (fraction).
    pub coverage: f64,
    /// Its Monte Carlo standard error.
    pub standard_error: f64,
    /// Number of experiments.
    pub experiments: usize,
    /// What was simulated.
    pub situation: String,
    /// The same where the world is not so.
    pub adverse: Vec<AdverseCoverage>,
}

/// Coverage in a situation that goes against what the intervals assume.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct AdverseCoverage {
    /// What was simulated.
    pub situation: String,
    /// Share of the 95 % intervals that held the truth (fraction).
    pub coverage: f64,
    /// Its Monte Carlo standard error.
    pub standard_error: f64,
}

/// Every row of the table, in the order of the page.
pub fn records() -> &'static [Record] {
    static RECORDS: LazyLock<Vec<Record>> = LazyLock::new(|| {
        let text = include_str!("../../../data/coverage.json");
        // A test reads the embedded file; an unreadable one claims nothing.
        serde_json::from_str(text).map_or_else(|_| Vec::new(), |file: File| file.records)
    });
    &RECORDS
}

/// What 95 % intervals of a kind covered in simulation, at the nearest
/// tabulated degrees of freedom not above the given ones; `None` below the
/// table, where no coverage is claimed.
pub fn measured(intervals: Intervals, degrees_of_freedom: usize) -> Option<MeasuredCoverage> {
    let tabulated = || {
        records()
            .iter()
            .filter(move |r| r.intervals == Some(intervals))
            .filter_map(|r| Some((r.degrees_of_freedom?, r)))
    };
    let nearest =
        tabulated().filter(|(dof, r)| *dof <= degrees_of_freedom && !r.adverse).max_by_key(|(dof, _)| *dof)?;
    let (dof, record) = nearest;
    Some(MeasuredCoverage {
        degrees_of_freedom: dof,
        coverage: record.coverage,
        standard_error: record.standard_error,
        experiments: record.experiments,
        situation: record.situation.clone(),
        adverse: tabulated()
            .filter(|(other, r)| *other == dof && r.adverse)
            .map(|(_, r)| AdverseCoverage {
                situation: r.situation.clone(),
                coverage: r.coverage,
                standard_error: r.standard_error,
            })
            .collect(),
    })
}
