//! What predicts displacements: values of the unknowns with their covariance
//! and the noise that a fit saw.

use crate::error::{Code, Error, Result};
use crate::estimate::common::CommonErrors;
use crate::estimate::freedom::{SizeDoubt, SpreadQuantiles};
use crate::estimate::identify::{
    Estimates, Estimator, Identification, JointEstimate, MeasuredSystem, NoiseSource, Solution, Verdict,
};
use crate::findings::{Finding, Severity, codes, list};
use crate::model::cell::Cell;
use crate::model::observation::ExtraTerm;
use crate::numerics::lists;
use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

/// How far predictions and readings may scatter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Spread {
    /// Covariance of the unknowns: row i up to column i; zero beside undetermined ones.
    #[serde(with = "lists::symmetric")]
    #[cfg_attr(feature = "schema", schemars(with = "Vec<Vec<f64>>"))]
    pub covariance: DMatrix<f64>,
    /// σ of a displacement component \[m\].
    #[serde(rename = "sigma_m")]
    pub sigma: f64,
    /// τ of a shift common to a posture's points, at its largest load \[m\].
    #[serde(rename = "shift_m")]
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
        SpreadQuantiles::new(self.degrees_of_freedom, self.confidence, self.doubt.as_ref())
    }
}

/// Values of the unknowns with which displacements are calculated.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct IdentifiedCompliance {
    /// Compliance of each spring \[rad/(N·m)\], then extra terms in their own units. As
    /// they came out: what noise alone may explain can be below zero.
    #[serde(with = "lists::vector")]
    #[cfg_attr(feature = "schema", schemars(with = "Vec<f64>"))]
    pub values: DVector<f64>,
    /// The extra terms.
    pub extra: Vec<ExtraTerm>,
    /// Unknowns that nothing bounds, counted from 0: their value is 0 and means nothing,
    /// and what depends on them cannot be calculated.
    #[serde(default)]
    pub undetermined: Vec<usize>,
    /// How sure the values are, where that is known.
    pub spread: Option<Spread>,
    /// What errors common to the whole experiment do to the values, and at work.
    pub common: CommonErrors,
    /// What to know about the values: whatever is calculated with them says so. Serious
    /// where something was wrong with what they were identified from.
    pub doubts: Vec<Finding>,
}

/// What a serious finding about readings means for whatever is calculated with their stiffness.
fn doubt(finding: &Finding) -> Finding {
    let said = finding.sentence.trim_end_matches('.');
    // What to do about it stands with the identification.
    let first = said.split_once(". ").map_or(said, |(first, _)| first);
    let sentence = format!(
        "The stiffness cannot be used as it is, its readings have a serious fault ({first}): correct them and identify \
         again."
    );
    Finding::serious(codes::STIFFNESS_DOUBTFUL, "stiffness", sentence)
}

/// What springs that are no ordinary ones mean for whatever is calculated with them.
pub(crate) fn open_springs<'a>(springs: impl Iterator<Item = &'a JointEstimate>) -> Vec<Finding> {
    let (mut negative, mut open, mut unknown) = (Vec::new(), Vec::new(), Vec::new());
    for spring in springs {
        let name = spring.name.as_str();
        match (spring.compliance, spring.verdict) {
            (None, _) => unknown.push(name),
            (_, Verdict::SignOrModelFault) => negative.push(name),
            (_, Verdict::LowerBoundOnly) => open.push(name),
            (Some(h), _) if h <= 0.0 => open.push(name),
            _ => {}
        }
    }
    let mut out = Vec::new();
    let mut add = |names: &[&str], code: &str, severity, sentence: &dyn Fn(&str) -> String| {
        if !names.is_empty() {
            let sentence = sentence(&list(names));
            out.push(Finding::new(code, severity, "stiffness", sentence));
        }
    };
    add(&negative, codes::STIFFNESS_DOUBTFUL, Severity::Serious, &|names| {
        format!(
            "The stiffness cannot be used as it is: the compliance of {names} came out negative beyond what noise \
             explains, a fault of sign or model. Find it and identify again."
        )
    });
    add(&open, "stiffness-open", Severity::Caution, &|names| {
        format!(
            "The readings do not tell the compliance of {names} from none. It counts as it came out, with all of its \
             uncertainty: bands are wide where the load bends it."
        )
    });
    let code = "stiffness-undetermined";
    add(&unknown, code, Severity::Caution, &|names| {
        format!("The readings say nothing of {names}: nothing can be calculated where the load bends it.")
    });
    out
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
            undetermined: Vec::new(),
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
        self.doubts.splice(0..0, serious.map(doubt));
        self
    }

    /// What forbids to use the values as they are.
    pub fn serious(&self) -> impl Iterator<Item = &Finding> + Clone {
        let doubts = self.doubts.iter();
        doubts.filter(|finding| finding.severity == Severity::Serious)
    }

    /// `error`, met in calculating with these values, with what is seriously wrong with them as its hint.
    pub(crate) fn explain(&self, error: Error) -> Error {
        error.hint_if(self.serious().next().map(|doubt| doubt.sentence.clone()))
    }

    /// Stiffness of the springs of `cell` \[N·m/rad\]; `None` without a positive one.
    pub fn spring_stiffness(&self, cell: &Cell) -> Vec<Option<f64>> {
        let springs = cell.setup.robot.spring_count();
        let springs = self.values.iter().take(springs);
        springs.map(|h| (*h > 0.0).then(|| 1.0 / h)).collect()
    }

    /// The result of an identification with its covariance.
    ///
    /// # Errors
    /// As [`IdentifiedCompliance::from_estimates`].
    pub fn from_identification(cell: &Cell, result: &Identification) -> Result<Self> {
        let noise =
            FittedNoise { residual_std: result.residual_std_m, posture_common_std: result.posture_common_std_m };
        IdentifiedCompliance::from_estimates(cell, &result.estimates, noise)
    }

    /// The estimates of an identification. Bands take the noise from the fit
    /// where the fit estimated it from displacements, else from the cell.
    ///
    /// # Errors
    /// Estimates of another number of springs, or of which none has a value.
    pub fn from_estimates(cell: &Cell, estimates: &Estimates, noise: FittedNoise) -> Result<Self> {
        let springs = cell.setup.robot.spring_count();
        if estimates.joints.len() != springs {
            let message = format!("{} estimates for the {springs} joints of the cell.", estimates.joints.len());
            return Err(Error::new(Code::Dimension, message));
        }
        let mut undetermined = Vec::new();
        let mut values: Vec<f64> = Vec::with_capacity(springs + estimates.extra.len());
        let mut further = estimates.extra_springs.iter();
        let mut lost = estimates.lost_motion.iter();
        let joints = estimates.joints.iter().map(|joint| joint.compliance);
        let terms = estimates.extra.iter().map(|term| {
            if term.is_spring() { further.next().and_then(|s| s.compliance) } else { lost.next().and_then(|a| a.angle) }
        });
        for (j, value) in joints.chain(terms).enumerate() {
            undetermined.extend(value.is_none().then_some(j));
            values.push(value.unwrap_or(0.0));
        }
        let count = values.len();
        if undetermined.len() == count {
            let message = "The measurements determine nothing: nothing can be predicted with them.";
            return Err(Error::new(Code::NotIdentifiable, message));
        }
        let full = estimates.covariance.len() == count && estimates.covariance.iter().all(|row| row.len() == count);
        let open = |i: usize, j: usize| undetermined.contains(&i) || undetermined.contains(&j);
        let entry = |i: usize, j: usize| {
            if open(i, j) { Some(0.0) } else { estimates.covariance[i][j] }
        };
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
            spread: covariance.filter(|_| estimates.interval_degrees_of_freedom != Some(0)).map(|covariance| Spread {
                covariance,
                sigma,
                shift,
                degrees_of_freedom: estimates.interval_degrees_of_freedom,
                doubt: None,
                confidence: estimates.confidence,
            }),
            common: CommonErrors::default(),
            doubts: open_springs(estimates.joints.iter().chain(&estimates.extra_springs)),
            undetermined,
        })
    }

    /// A fit, with the noise that it estimated or took as known.
    pub(crate) fn from_solution(system: &MeasuredSystem, solution: &Solution, confidence: f64) -> Self {
        let spread =
            solution.covariance.clone().zip(solution.sigma).filter(|_| solution.t_degrees_of_freedom != Some(0)).map(
                |(covariance, sigma)| Spread {
                    covariance,
                    sigma,
                    shift: sigma * solution.gamma.sqrt(),
                    degrees_of_freedom: solution.t_degrees_of_freedom,
                    doubt: None,
                    confidence,
                },
            );
        IdentifiedCompliance {
            values: solution.values.clone(),
            extra: system.extra.clone(),
            undetermined: solution.undetermined.clone(),
            spread,
            common: CommonErrors::default(),
            doubts: Vec::new(),
        }
    }

    /// Compliance of the springs, for models that are not linear in it.
    pub(crate) fn springs(&self, model: &str) -> Result<&[f64]> {
        if self.extra.is_empty() {
            Ok(self.values.as_slice())
        } else {
            Err(Error::new(Code::Unsupported, format!("The {model} model holds the axes' springs alone."))
                .hint("use the linear model, or identify with --elastic axes and without --extra"))
        }
    }
}
