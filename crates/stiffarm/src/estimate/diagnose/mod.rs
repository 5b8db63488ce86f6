//! What the residuals say about an identification: whether the noise explains
//! them, which reading does not fit, whether load states lie on lines, what the
//! model leaves out, and which joint is barely determined.
//!
//! It stands above `identify` and changes nothing in its result. Tests are made
//! at 1 % (Bonferroni over postures, points and displacements), so
//! that a clean experiment rarely raises a finding.

mod noise;
mod outliers;
mod second_order;
mod signal;
mod states;
mod tails;
mod terms;

pub use noise::{Agreement, NoiseTest, noise_test};
pub use outliers::{Outlier, OutlierKind, Outliers, PointFit, PostureFit, outliers};
pub use second_order::{SecondOrderShare, second_order_shares};
pub use signal::{CorrelatedPair, JointSignal, correlated_pairs, joint_signals};
pub use states::{LoadStates, PooledStates, PostureStates, load_states};
pub use terms::{TermTrial, TermTrials, try_terms};

use crate::error::{Code, Result};
use crate::estimate::identify::{Fit, LeaveOneOut};
use crate::estimate::mixed::MixedFit;
use crate::estimate::quantity::facts::Quantity;
use crate::estimate::setup::SetUp;
use crate::findings::{Finding, codes, list};
use serde::{Deserialize, Serialize};

/// A posture is named when the estimate of an unknown moves by more standard
/// errors than this without it.
const INFLUENCE: f64 = 2.0;

/// All diagnostics of one identification.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Diagnosis {
    /// Residuals against the cell's noise; `None` without noise or degrees of
    /// freedom.
    pub noise: Option<NoiseTest>,
    /// Readings, postures and points that do not fit.
    pub outliers: Outliers,
    /// Influence of each posture; `None` for a single posture.
    pub influence: Option<LeaveOneOut>,
    /// Linearity and hysteresis; `None` where no posture has two load states.
    pub load_states: Option<LoadStates>,
    /// K_C and the equilibrium, posture by posture; empty without a positive
    /// stiffness of each joint.
    pub second_order: Vec<SecondOrderShare>,
    /// Unknowns that the data can hardly tell apart.
    pub correlated: Vec<CorrelatedPair>,
    /// Extra terms, each tried alone; `None` for a single posture.
    pub terms: Option<TermTrials>,
    /// What the cell states of the set-up against the readings, springs beyond the axes granted; left out where it was
    /// not looked at.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub set_up: Option<SetUp>,
    /// What each joint carries and moves.
    pub signals: Vec<JointSignal>,
    /// What to know, in sentences.
    pub findings: Vec<Finding>,
}

impl Diagnosis {
    /// What the readings say against the set-up as the cell states it.
    pub fn rejected(&self) -> Option<&Finding> {
        self.of_set_up(codes::SET_UP)
    }

    /// What they say of it that is not sure.
    pub fn doubted(&self) -> Option<&Finding> {
        self.of_set_up(codes::SET_UP_DOUBTFUL)
    }

    fn of_set_up(&self, code: &str) -> Option<&Finding> {
        let finding = self.set_up.as_ref()?.finding.as_ref();
        finding.filter(|finding| finding.code == code)
    }

    /// The quantity of the set-up that the readings want elsewhere, and how far off it may be.
    pub(crate) fn off(&self) -> Option<(Quantity, f64)> {
        self.set_up.as_ref()?.off
    }
}

/// Diagnoses an identification.
///
/// # Errors
/// As [`identify`](crate::estimate::identify::identify()).
pub fn diagnose(fit: &Fit) -> Result<Diagnosis> {
    diagnose_in(fit, None)
}

/// The same where the mixed model predicts: what contradicts the rest is judged in it.
///
/// # Errors
/// As [`diagnose`].
pub(crate) fn diagnose_in(fit: &Fit, mixed: Option<&MixedFit>) -> Result<Diagnosis> {
    let result = fit.identification()?;
    let mut findings = Vec::new();
    let noise = noise_test(fit)?;
    let outliers = outliers::outliers_in(fit, mixed)?;
    findings.push(match &noise {
        Some(test) => test.finding(outliers.noise_without.as_ref()),
        None => noise::untested(fit.cell()),
    });
    findings.extend(outliers.findings());
    let several = fit.system().blocks.len() > 1;
    let influence = if several { Some(fit.leave_one_out()?) } else { None };
    if let Some(influence) = &influence {
        findings.extend(influence_findings(influence, &result.estimates.unknowns));
    }
    let load_states = load_states(fit, noise.as_ref())?;
    if let Some(states) = &load_states {
        findings.extend(states.findings());
    }
    let second_order = match result.estimates.stiffness() {
        Some(stiffness) => {
            match second_order::watched_shares(fit.cell(), fit.postures(), &stiffness, fit.control()) {
                // Angles and loads went into the fit: nothing but the equilibrium can fail here.
                Err(error) if error.code() == Code::InvalidValue => {
                    findings.push(second_order::unstable());
                    Vec::new()
                }
                shares => shares?,
            }
        }
        None => Vec::new(),
    };
    findings.extend(second_order::finding(&second_order, result.expected_std_m));
    let correlated = correlated_pairs(result);
    findings.extend(correlated.iter().map(CorrelatedPair::finding));
    let terms = if several { Some(try_terms(fit)?) } else { None };
    if let Some(trials) = &terms {
        findings.extend(trials.finding());
    }
    let signals = joint_signals(fit);
    // Single readings set aside, the rest may be no more than noise.
    let tested = outliers.noise_without.as_ref().or(noise.as_ref());
    findings.extend(signal::findings(&signals, result.residual_rms_m, tested.map(|test| test.agreement)));
    Ok(Diagnosis {
        noise,
        outliers,
        influence,
        load_states,
        second_order,
        correlated,
        terms,
        set_up: None,
        signals,
        findings,
    })
}

/// Postures on which an unknown hangs.
fn influence_findings(influence: &LeaveOneOut, unknowns: &[String]) -> Vec<Finding> {
    let mut out = Vec::new();
    for posture in &influence.postures {
        let name = &posture.posture;
        if !posture.lost.is_empty() {
            let message = format!("Without posture {name} the others do not determine {}.", list(&posture.lost));
            out.push(Finding::caution(codes::POSTURE_NEEDED, name, message));
        }
        let moved: Vec<String> = unknowns
            .iter()
            .zip(&posture.shifts)
            .filter_map(|(unknown, shift)| Some((unknown, (*shift)?.abs())))
            .filter(|(_, shift)| *shift > INFLUENCE)
            .map(|(unknown, shift)| format!("{unknown} by {shift:.1}"))
            .collect();
        if !moved.is_empty() {
            let message = format!(
                "Without posture {name} the compliance would move, in standard errors: {}. Look at this posture, and \
                 measure more like it.",
                list(&moved)
            );
            out.push(Finding::note("posture-influence", name, message));
        }
    }
    out
}
