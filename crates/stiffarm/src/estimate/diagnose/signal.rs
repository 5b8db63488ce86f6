//! What each joint carries and how far it moves the tool, and which unknowns
//! the data can hardly tell apart.

use super::Agreement;
use crate::estimate::identify::{Fit, Identification, NO_LOAD, rms};
use crate::findings::{Finding, codes, length, list, percent};
use crate::numerics::order::sort_by_number;
use serde::{Deserialize, Serialize};

/// Correlation of two estimates above which they are named.
const CORRELATED: f64 = 0.9;
/// Relative standard error above which a joint counts as barely determined.
const BARELY_DETERMINED_ERROR: f64 = 0.2;
/// A joint is weakly loaded below this share of the median torque.
const WEAK_TORQUE: f64 = 0.5;

/// What the measurements ask of one joint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct JointSignal {
    /// Name of the joint.
    pub name: String,
    /// RMS of its torque over postures and load states \[N·m\].
    pub torque_rms_nm: f64,
    /// RMS of the displacement components that its compliance makes \[m\]:
    /// of ψ_j·Ĥ_j; `None` where the joint is not determined.
    pub displacement_rms_m: Option<f64>,
    /// That over the RMS of the residuals; `None` without residuals.
    pub to_residual: Option<f64>,
    /// Relative standard error of the compliance.
    pub relative_error: Option<f64>,
}

/// Signal of each joint.
pub fn joint_signals(fit: &Fit) -> Vec<JointSignal> {
    let (system, solution) = (fit.system(), fit.solution());
    let residual = rms(fit.residual().as_slice());
    let mut torques = vec![Vec::new(); system.springs];
    for (m, terms) in fit.experiment().with_terms() {
        if m.displacements.is_empty() {
            continue;
        }
        let loads = terms.spring_loads(&fit.cell().setup.robot);
        for (torques, load) in torques.iter_mut().zip(loads.iter()) {
            torques.push(*load);
        }
    }
    (0..system.springs)
        .map(|j| {
            let h = solution.values[j];
            let is_determined = !solution.undetermined.contains(&j);
            let moved = rms((system.psi.column(j) * h).as_slice());
            let error = solution.covariance.as_ref().map(|c| c[(j, j)].max(0.0).sqrt());
            JointSignal {
                name: system.unknowns[j].clone(),
                torque_rms_nm: rms(&torques[j]),
                displacement_rms_m: is_determined.then_some(moved),
                to_residual: (is_determined && residual > 0.0).then(|| moved / residual),
                relative_error: error.filter(|_| is_determined && h != 0.0).map(|e| e / h.abs()),
            }
        })
        .collect()
}

/// Joints that move the tool by less than the residuals and are therefore
/// barely determined. `agreement` is that of the residuals with the cell's
/// noise; `None` where it was not tested.
pub(super) fn findings(signals: &[JointSignal], residual: f64, agreement: Option<Agreement>) -> Vec<Finding> {
    let median = {
        let torques: Vec<f64> = signals.iter().map(|s| s.torque_rms_nm).collect();
        if torques.is_empty() { 0.0 } else { crate::numerics::sample::median(&torques) }
    };
    let mut out: Vec<Finding> = unloaded(signals).collect();
    for signal in signals {
        let weak = signal.to_residual.is_some_and(|ratio| ratio < 1.0)
            && signal.relative_error.is_none_or(|error| error > BARELY_DETERMINED_ERROR);
        let Some(moved) = signal.displacement_rms_m.filter(|_| weak) else {
            continue;
        };
        let name = &signal.name;
        let strong: Vec<&JointSignal> =
            signals.iter().filter(|s| WEAK_TORQUE * s.torque_rms_nm > signal.torque_rms_nm).collect();
        let others = match strong.as_slice() {
            [] => String::new(),
            strong => {
                let names: Vec<&str> = strong.iter().map(|s| s.name.as_str()).collect();
                let sizes = strong.iter().map(|s| s.torque_rms_nm);
                let low = sizes.clone().fold(f64::INFINITY, f64::min);
                let high = sizes.fold(0.0, f64::max);
                if format!("{low:.0}") == format!("{high:.0}") {
                    format!(" ({high:.0} on {})", list(&names))
                } else {
                    format!(" ({low:.0} to {high:.0} on {})", list(&names))
                }
            }
        };
        let error = signal.relative_error.map_or(String::new(), |e| format!(" (standard error {})", percent(e)));
        // What the model misses comes again with each posture of the same kind;
        // noise averages out.
        let remedy = match (signal.torque_rms_nm < WEAK_TORQUE * median, agreement) {
            (true, Some(Agreement::Larger)) => {
                "More leverage of the load about its axis would help, more postures of this kind would not much."
            }
            (true, Some(_)) => {
                "More leverage of the load about its axis would help most. The residuals are no more than noise, so \
                 more postures help too: four times as many halve the error."
            }
            (true, None) => "More leverage of the load about its axis would help most.",
            (false, _) => "Postures in which its give moves the measuring points more would help.",
        };
        out.push(Finding::caution(
            codes::WEAK_JOINT,
            name,
            format!(
                "The loads put {:.0} N·m RMS on {name}{others}. It moves the measuring points by {} RMS, less than the \
                 residuals of {}: it is barely determined{error}. {remedy}",
                signal.torque_rms_nm,
                length(moved),
                length(residual),
            ),
        ));
    }
    out
}

/// Joints whose torque is nothing beside the largest, and which are therefore
/// not determined.
fn unloaded(signals: &[JointSignal]) -> impl Iterator<Item = Finding> {
    let sizes = signals.iter();
    let most = sizes.max_by(|a, b| a.torque_rms_nm.total_cmp(&b.torque_rms_nm));
    most.into_iter().flat_map(move |most| {
        let nothing = |s: &&JointSignal| s.torque_rms_nm < NO_LOAD * most.torque_rms_nm;
        signals.iter().filter(nothing).map(move |signal| {
            let torque = match signal.torque_rms_nm {
                // Rounding of a load that passes through the axis.
                t if t < 1e-9 * most.torque_rms_nm => "no torque".to_string(),
                t => format!("{t:.1e} N·m RMS"),
            };
            Finding::caution(
                codes::UNLOADED_JOINT,
                &signal.name,
                format!(
                    "The loads put {torque} on {}, beside {:.0} N·m on {}: it carries no load here and is not \
                     determined, whatever the readings.",
                    signal.name, most.torque_rms_nm, most.name
                ),
            )
        })
    })
}

/// Two unknowns that the data can hardly tell apart.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CorrelatedPair {
    /// Names of the two.
    pub unknowns: [String; 2],
    /// Correlation of their estimates.
    pub correlation: f64,
}

/// Pairs of unknowns whose estimates correlate by more than 0.9, the strongest
/// first.
pub fn correlated_pairs(result: &Identification) -> Vec<CorrelatedPair> {
    let mut out = Vec::new();
    for (i, row) in result.estimates.correlation.iter().enumerate() {
        for (j, correlation) in row.iter().enumerate().take(i) {
            if let Some(correlation) = correlation.filter(|c| c.abs() > CORRELATED) {
                out.push(CorrelatedPair {
                    unknowns: [result.estimates.unknowns[j].clone(), result.estimates.unknowns[i].clone()],
                    correlation,
                });
            }
        }
    }
    sort_by_number(&mut out, |a| -a.correlation.abs());
    out
}

impl CorrelatedPair {
    /// What the correlation means.
    pub fn finding(&self) -> Finding {
        let [a, b] = &self.unknowns;
        let meaning = if self.correlation < 0.0 {
            "the sum of what they give is known better than either"
        } else {
            "the difference of what they give is known better than either"
        };
        let message = format!(
            "The data hardly tell {a} and {b} apart (correlation {:.2}): {meaning}, and an error of one is an error of \
             the other.",
            self.correlation
        );
        Finding::caution(codes::CORRELATED, format!("{a}, {b}"), message)
    }
}
