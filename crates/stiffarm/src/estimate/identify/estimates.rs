//! The estimates of an experiment, whatever its rows are: displacements of a
//! free end-effector or angles of a clamped one.

use super::assumptions::Estimator;
use super::estimate::{JointEstimate, Verdict, estimates, interval_quantile, standard_error};
use super::solve::Solution;
use super::system::MeasuredSystem;
use super::{AngleEstimate, CollinearSet, EstimableCombination, IdentifyOptions, NoiseSource, estimable};
use crate::error::Result;
use crate::findings::{Finding, Severity, codes, list, shown};
use crate::model::cell::Cell;
use crate::model::observation::ExtraTerm;
use crate::numerics::information::Factor;
use serde::{Deserialize, Serialize};

/// Values of the unknowns with what is known about them: the part of a result
/// that free and clamped end-effector share. Either kind of saved result
/// can be read as this.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Estimates {
    /// One estimate per joint (spring).
    pub joints: Vec<JointEstimate>,
    /// Extra springs: tilts of joints and of the base.
    pub extra_springs: Vec<JointEstimate>,
    /// Lost motion.
    pub lost_motion: Vec<AngleEstimate>,
    /// The extra terms, as they were asked for.
    pub extra: Vec<ExtraTerm>,
    /// How the unknowns were estimated.
    pub estimator: Estimator,
    /// Rows used: displacement components, or combinations of angles.
    pub rows: usize,
    /// rows − rank.
    pub degrees_of_freedom: usize,
    /// Degrees of freedom behind the quantile of the intervals; `None` for
    /// normal quantiles.
    pub interval_degrees_of_freedom: Option<usize>,
    /// True where the errors of all rows count as independent because the data
    /// cannot tell what a posture's points share, or the estimator assumes it.
    pub independent_rows: bool,
    /// cond(Ψ), `None` when a joint is undetermined.
    pub condition: Option<f64>,
    /// Condition number of the column-scaled Ψ.
    pub scaled_condition: Option<f64>,
    /// Names of the unknowns: rows and columns of `covariance` and `correlation`.
    pub unknowns: Vec<String>,
    /// Covariance of the unknowns, row by row \[rad²/(N·m)²; rad² for lost
    /// motion\]; `None` beside undetermined ones.
    pub covariance: Vec<Vec<Option<f64>>>,
    /// Correlation of the unknowns, row by row; `None` beside undetermined ones.
    pub correlation: Vec<Vec<Option<f64>>>,
    /// Names of unknowns the data do not determine.
    pub undetermined_joints: Vec<String>,
    /// What the data do determine where they cannot separate the unknowns.
    pub combinations: Vec<EstimableCombination>,
    /// Unknowns that noise lets tell apart only together: their columns of Ψ are
    /// nearly collinear.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub collinear: Vec<CollinearSet>,
    /// Where the size of the noise came from.
    pub noise: NoiseSource,
    /// Confidence of the intervals.
    pub confidence: f64,
}

impl Estimates {
    /// Puts a solution into words and numbers.
    pub(crate) fn new(
        cell: &Cell,
        system: &MeasuredSystem,
        solution: &Solution,
        options: &IdentifyOptions,
    ) -> Result<Self> {
        let count = system.unknowns.len();
        let is_determined = |j: usize| !solution.undetermined.contains(&j);
        let quantile = interval_quantile(solution, options.confidence)?;
        let springs = |which| estimates(&system.unknowns, which, solution, quantile);
        let is_spring = |j: usize| system.extra[j - system.springs].is_spring();
        let further = system.springs..count;
        let lost_motion = further.clone().filter(|j| !is_spring(*j)).map(|j| {
            let value = is_determined(j).then(|| solution.values[j]);
            let error = standard_error(solution, j);
            let half = error.zip(quantile).map(|(e, t)| e * t);
            let ends = value.zip(half);
            AngleEstimate {
                name: system.unknowns[j].clone(),
                angle: value,
                standard_error: error,
                interval: [ends.map(|(v, h)| v - h), ends.map(|(v, h)| v + h)],
            }
        });
        let reference = reference_sizes(cell, system);
        let matrix = |entry: &dyn Fn(usize, usize) -> Option<f64>| -> Vec<Vec<Option<f64>>> {
            (0..count).map(|i| (0..count).map(|j| entry(i, j)).collect()).collect()
        };
        let covariance = matrix(&|i, j| {
            let covariance = solution.covariance.as_ref()?;
            (is_determined(i) && is_determined(j)).then(|| covariance[(i, j)])
        });
        let inverse = solution.factor.inverse_information();
        let correlation = matrix(&|i, j| {
            (is_determined(i) && is_determined(j))
                .then(|| if i == j { 1.0 } else { inverse[(i, j)] / (inverse[(i, i)] * inverse[(j, j)]).sqrt() })
        });
        let condition = if solution.undetermined.is_empty() && options.extra.is_empty() {
            let s = Factor::new(&system.psi)?.singular_values(|_| 1.0)?;
            Some(s[0] / s[count - 1])
        } else {
            None
        };
        let collinear = estimable::collinear_sets(system, solution, &reference);
        let mut joints = springs(0..system.springs);
        for joint in &mut joints {
            let mut together = collinear.iter().flat_map(|set| &set.unknowns);
            // A compliance that is negative beyond what noise explains is a fault in any company.
            let valued = joint.determined && joint.verdict != Verdict::SignOrModelFault;
            if valued && together.any(|name| *name == joint.name) {
                joint.verdict = Verdict::NotByItself;
            }
        }
        Ok(Estimates {
            joints,
            extra_springs: further.filter(|j| is_spring(*j)).flat_map(|j| springs(j..j + 1)).collect(),
            lost_motion: lost_motion.collect(),
            extra: system.extra.clone(),
            estimator: options.estimator,
            rows: system.psi.nrows(),
            degrees_of_freedom: solution.degrees_of_freedom,
            interval_degrees_of_freedom: solution.t_degrees_of_freedom,
            independent_rows: solution.independent_rows,
            condition,
            scaled_condition: solution.factor.scaled_condition(),
            unknowns: system.unknowns.clone(),
            covariance,
            correlation,
            undetermined_joints: solution.undetermined.iter().map(|&j| system.unknowns[j].clone()).collect(),
            combinations: estimable::estimable_combinations(system, solution, &reference),
            collinear,
            noise: options.noise,
            confidence: options.confidence,
        })
    }

    /// Stiffness of all joints, if each has a positive one.
    pub fn stiffness(&self) -> Option<Vec<f64>> {
        self.joints.iter().map(|j| j.stiffness.filter(|k| *k > 0.0)).collect()
    }

    /// True when every joint has a stiffness with a closed interval.
    pub fn is_complete(&self) -> bool {
        self.joints.iter().all(|j| j.interval[1].is_some())
    }
}

/// Size of each unknown against which an error counts as large: the prior
/// compliance, else what would explain its share of the rows alone.
fn reference_sizes(cell: &Cell, system: &MeasuredSystem) -> Vec<f64> {
    let count = system.unknowns.len();
    let share = system.delta.norm() / (count as f64).sqrt();
    (0..count)
        .map(|j| {
            let prior = cell.prior.as_ref().filter(|_| j < system.springs);
            let norm = system.psi.column(j).norm();
            match prior {
                Some(prior) => 1.0 / prior[j],
                None if norm > 0.0 && share > 0.0 => share / norm,
                None => 1e-6,
            }
        })
        .collect()
}

impl Estimates {
    /// Joints whose estimate is not simply a number.
    pub fn findings(&self) -> Vec<Finding> {
        let mut out = Vec::new();
        if !self.undetermined_joints.is_empty() {
            let rest = if self.combinations.is_empty() {
                ""
            } else {
                "What they determine together stands below the joints; "
            };
            let names = list(&shown(&self.undetermined_joints));
            let sentence =
                format!("These measurements cannot determine {names}. {rest}`stiffarm check` looks for the reason.");
            out.push(Finding::serious("undetermined", names, sentence));
        }
        let of = |verdict: Verdict| {
            let all = self.joints.iter().chain(&self.extra_springs);
            let joints = all.filter(|joint| joint.verdict == verdict);
            shown(joints.map(|joint| &joint.name))
        };
        let mut add = |code: &str, severity: Severity, names: Vec<String>, said: &str| {
            if !names.is_empty() {
                let sentence = format!("{}: {said}", list(&names));
                out.push(Finding::new(code, severity, list(&names), sentence));
            }
        };
        add(
            codes::NEGATIVE_COMPLIANCE,
            Severity::Serious,
            of(Verdict::SignOrModelFault),
            "the compliance comes out negative, beyond what noise explains, which is a sign or model fault. Check the \
             sign of the force (on the robot), the frames and the model.",
        );
        add(
            "no-interval",
            Severity::Caution,
            of(Verdict::NoInterval),
            "no interval, because the data leave no degree of freedom to judge the noise, or show no deflection.",
        );
        out
    }
}
