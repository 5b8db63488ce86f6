//! What predicts displacements: values of the unknowns with their covariance
//! and the noise that a fit saw.

use crate::error::{Code, Error, Result};
use crate::estimate::common::CommonErrors;
use crate::estimate::freedom::{SizeDoubt, SpreadQuantiles};
use crate::estimate::identify::{
    Estimates, Estimator, Identification, MeasuredSystem, NoiseSource, Solution,
};
use crate::findings::{Finding, Severity};
use crate::model::cell::Cell;
use crate::model::observation::ExtraTerm;
use nalgebra::{DMatrix, DVector};

/// How far predictions and readings may scatter.
#[derive(Debug, Clone, PartialEq)]
pub struct Spread {
    /// Covariance of the unknowns.
    pub covariance: DMatrix<f64>,
    /// σ of a displacement component \[m\].
    pub sigma: f64,
    /// τ of a shift common to a posture's points, at its largest load \[m\].
    pub shift: f64,
    /// Degrees of freedom of Student's t; `None` for normal quantiles.
    pub degrees_of_freedom: Option<usize>,
    /// How well the sizes of a mixed model are known: quantiles of its combinations have
    /// degrees of freedom of their own, no more than these.
    pub doubt: Option<SizeDoubt>,
    /// Confidence of the bands.
    pub confidence: f64,
}

impl Spread {
    pub(crate) fn quantiles(&self) -> Result<SpreadQuantiles> {
        SpreadQuantiles::new(
            self.degrees_of_freedom,
            self.confidence,
            self.doubt.as_ref(),
        )
    }
}

/// Values of the unknowns with which displacements are calculated.
#[derive(Debug, Clone, PartialEq)]
pub struct IdentifiedCompliance {
    /// Compliance of each spring, then further terms.
    pub values: DVector<f64>,
    /// The further terms.
    pub extra: Vec<ExtraTerm>,
    /// How sure the values are, where that is known.
    pub spread: Option<Spread>,
    /// What errors common to the whole experiment do to the values, and at work.
    pub common: CommonErrors,
    /// What was seriously wrong with what they were identified from: whatever is
    /// calculated with them says so.
    pub doubts: Vec<Finding>,
}

/// What a serious finding about readings means for whatever is calculated with their stiffness.
fn doubt(finding: &Finding) -> Finding {
    let said = finding.sentence.trim_end_matches('.');
    // What to do about it stands with the identification.
    let first = said.split_once(". ").map_or(said, |(first, _)| first);
    let sentence = format!(
        "The stiffness cannot be used as it is, its readings have a serious fault ({first}): correct them and identify again."
    );
    Finding::new(
        "stiffness-doubtful",
        Severity::Serious,
        "stiffness",
        sentence,
    )
}

/// The noise that a fit saw in its displacements.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct FittedNoise {
    /// σ of a displacement component as the residuals show it \[m\].
    pub residual_std: Option<f64>,
    /// τ of a shift common to a posture's points \[m\].
    pub posture_common_std: Option<f64>,
}

impl IdentifiedCompliance {
    /// Joint stiffness alone, one per spring \[N·m/rad\]: no bands.
    ///
    /// # Errors
    /// A wrong number of values, or one that is not above zero.
    pub fn from_stiffness(cell: &Cell, stiffness: &[f64]) -> Result<Self> {
        crate::model::stiffness::joint_compliance(&cell.setup.robot, stiffness)?;
        Ok(IdentifiedCompliance {
            values: DVector::from_iterator(stiffness.len(), stiffness.iter().map(|k| 1.0 / k)),
            extra: Vec::new(),
            spread: None,
            common: CommonErrors::default(),
            doubts: Vec::new(),
        })
    }

    /// The same with what was seriously wrong among `findings` of the readings they
    /// come from.
    #[must_use]
    pub fn with_doubts<'a>(mut self, findings: impl IntoIterator<Item = &'a Finding>) -> Self {
        let serious = findings.into_iter();
        let serious = serious.filter(|finding| finding.severity == Severity::Serious);
        self.doubts = serious.map(doubt).collect();
        self
    }

    /// Stiffness of the springs of `cell` \[N·m/rad\].
    pub fn spring_stiffness(&self, cell: &Cell) -> Vec<f64> {
        let springs = cell.setup.robot.spring_count();
        self.values.iter().take(springs).map(|h| 1.0 / h).collect()
    }

    /// The result of an identification with its covariance.
    ///
    /// # Errors
    /// As [`IdentifiedCompliance::from_estimates`].
    pub fn from_identification(cell: &Cell, result: &Identification) -> Result<Self> {
        let noise = FittedNoise {
            residual_std: result.residual_std_m,
            posture_common_std: result.posture_common_std_m,
        };
        IdentifiedCompliance::from_estimates(cell, &result.estimates, noise)
    }

    /// The estimates of an identification. Bands take the noise from the fit
    /// where the fit estimated it from displacements, else from the cell.
    ///
    /// # Errors
    /// Estimates of another number of springs, or an unknown without a value.
    pub fn from_estimates(cell: &Cell, estimates: &Estimates, noise: FittedNoise) -> Result<Self> {
        let springs = cell.setup.robot.spring_count();
        if estimates.joints.len() != springs {
            let message = format!(
                "{} estimates for the {springs} joints of the cell.",
                estimates.joints.len()
            );
            return Err(Error::new(Code::Dimension, message));
        }
        let missing = |name: &str| {
            Error::new(
                Code::NotIdentifiable,
                format!("There is no value for {name}: nothing can be predicted with it."),
            )
        };
        let mut values: Vec<f64> = Vec::with_capacity(springs + estimates.extra.len());
        for joint in &estimates.joints {
            values.push(joint.compliance.ok_or_else(|| missing(&joint.name))?);
        }
        let mut further = estimates.extra_springs.iter();
        let mut lost = estimates.lost_motion.iter();
        for term in &estimates.extra {
            let name = term.name(&cell.setup.robot);
            let value = match term.is_spring() {
                true => further.next().and_then(|s| s.compliance),
                false => lost.next().and_then(|a| a.angle),
            };
            values.push(value.ok_or_else(|| missing(&name))?);
        }
        let count = values.len();
        let full = estimates.covariance.len() == count
            && estimates.covariance.iter().all(|row| row.len() == count);
        let entry = |i: usize, j: usize| estimates.covariance[i][j];
        let covariance = (full && (0..count).all(|i| (0..count).all(|j| entry(i, j).is_some())))
            .then(|| DMatrix::from_fn(count, count, |i, j| entry(i, j).unwrap_or(0.0)));
        let declared = (cell.noise.displacement_std(), cell.noise.posture_common_std);
        let (sigma, shift) = match (estimates.noise, noise.residual_std) {
            (NoiseSource::Estimated, Some(std)) => {
                let ratio = match estimates.estimator {
                    // What the cell declares was taken as given.
                    Estimator::Weighted if declared.0 > 0.0 => declared.1 / declared.0,
                    _ => 0.0,
                };
                (std, noise.posture_common_std.unwrap_or(std * ratio))
            }
            _ => declared,
        };
        Ok(IdentifiedCompliance {
            values: DVector::from_vec(values),
            extra: estimates.extra.clone(),
            // Without a degree of freedom nothing is known of how well.
            spread: covariance
                .filter(|_| estimates.interval_degrees_of_freedom != Some(0))
                .map(|covariance| Spread {
                    covariance,
                    sigma,
                    shift,
                    degrees_of_freedom: estimates.interval_degrees_of_freedom,
                    doubt: None,
                    confidence: estimates.confidence,
                }),
            common: CommonErrors::default(),
            doubts: Vec::new(),
        })
    }

    /// A fit, with the noise that it estimated or took as known.
    pub(crate) fn from_solution(
        system: &MeasuredSystem,
        solution: &Solution,
        confidence: f64,
    ) -> Self {
        let spread = solution
            .covariance
            .clone()
            .zip(solution.sigma)
            .filter(|_| solution.t_degrees_of_freedom != Some(0))
            .map(|(covariance, sigma)| Spread {
                covariance,
                sigma,
                shift: sigma * solution.gamma.sqrt(),
                degrees_of_freedom: solution.t_degrees_of_freedom,
                doubt: None,
                confidence,
            });
        IdentifiedCompliance {
            values: solution.values.clone(),
            extra: system.extra.clone(),
            spread,
            common: CommonErrors::default(),
            doubts: Vec::new(),
        }
    }

    /// Stiffness of the springs, for models that are not linear in the compliance.
    pub(crate) fn stiffness(&self, model: &str) -> Result<Vec<f64>> {
        if !self.extra.is_empty() {
            return Err(Error::new(
                Code::Unsupported,
                format!("The {model} model cannot use further terms."),
            )
            .hint("use the linear model, or a stiffness identified without further terms"));
        }
        Ok(self.values.iter().map(|h| 1.0 / h).collect())
    }
}
