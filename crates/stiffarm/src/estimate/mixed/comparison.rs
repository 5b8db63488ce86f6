//! Which elastic model the data call for, and what it gives.

use super::{ElasticClass, MixedFit};
use crate::error::{Code, Result};
use crate::estimate::compliance::{IdentifiedCompliance, Spread};
use crate::estimate::identify::{Fit, JointEstimate, estimate};
use crate::estimate::validate::{cross_validate, cross_validate_mixed};
use crate::findings::{length, percent};
use crate::model::observation::ExtraTerm;
use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

/// Twice the difference of the restricted log-likelihoods beyond which the axes alone
/// are rejected. Three variances at the edge of what they can be: chance goes beyond this
/// in fewer than 5 of 100 experiments (counted, docs/coverage.md).
const LIKELIHOOD_RATIO: f64 = 6.0;
/// Fewest postures from which leaving one out says anything.
const FEWEST_POSTURES: usize = 4;

/// Which elastic model to use.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum ElasticChoice {
    /// The joint axes alone give way: the paper's model.
    #[default]
    Axes,
    /// Joints and base give way in all directions, as far as the data show.
    Mixed,
    /// The one that the data call for.
    Auto,
}

impl ElasticChoice {
    /// Name in options and results.
    pub fn as_str(self) -> &'static str {
        match self {
            ElasticChoice::Axes => "axes",
            ElasticChoice::Mixed => "mixed",
            ElasticChoice::Auto => "auto",
        }
    }
}

/// How much entries of one class scatter.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ElasticSize {
    /// The class.
    pub class: ElasticClass,
    /// Standard deviation ω of an entry on the diagonal; entries beside it have ω/√2
    /// \[m/N; rad/(N·m); rad/N\].
    pub std: f64,
}

/// The compliance of a joint or of the base beyond the joint's axis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct GeneralSpring {
    /// The joint, counted from 1; `None` for the base.
    pub joint: Option<usize>,
    /// Symmetric compliance between \[force; moment\] and \[shift; turn\] at the joint's
    /// origin, axes of the link behind it, row by row \[m/N, rad/N, rad/(N·m)\]. The
    /// joint's own axis is not in it.
    pub compliance: [[f64; 6]; 6],
}

/// The elastic model that predicts, and why.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Elastic {
    /// What was asked for.
    pub asked: ElasticChoice,
    /// What predicts: `axes` or `mixed`.
    pub model: ElasticChoice,
    /// Why, and what to use for what, in sentences.
    pub reasons: Vec<String>,
    /// Twice the difference of the restricted log-likelihoods of mixed model and axes;
    /// `None` where the mixed model cannot be fitted.
    pub likelihood_ratio: Option<f64>,
    /// RMS of displacement components less their prediction from the other postures,
    /// joint axes alone \[m\].
    pub axes_rms_m: Option<f64>,
    /// The same with the mixed model, its sizes found anew without each posture \[m\].
    pub mixed_rms_m: Option<f64>,
    /// The mixed model, where it predicts.
    pub mixed: Option<MixedResult>,
}

/// Values of the mixed model with what is known about them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MixedResult {
    /// One estimate per joint axis, given all that gives way besides.
    pub joints: Vec<JointEstimate>,
    /// Sizes of what gives way besides.
    pub sizes: Vec<ElasticSize>,
    /// σ of a displacement component \[m\].
    pub residual_std_m: f64,
    /// τ of a shift common to a posture's points, at its largest load \[m\].
    pub posture_common_std_m: f64,
    /// Degrees of freedom behind quantiles; `None` for normal ones.
    pub interval_degrees_of_freedom: Option<usize>,
    /// Base first, then joint by joint.
    pub springs: Vec<GeneralSpring>,
    /// Covariance of all unknowns, lower triangle row by row: joint axes, then the
    /// entries of the springs, class by class (shift, turn, coupling), within a class
    /// spring by spring, within a spring by row and column of its upper triangle.
    pub covariance: Vec<Vec<f64>>,
}

/// Fits and compares the elastic models that `asked` calls for. Where the data cannot
/// carry the mixed model, the axes predict, and the reasons say so.
///
/// # Errors
/// Options of `fit` that exclude the mixed model ([`MixedFit::new`]); interrupted.
pub fn elastic(fit: &Fit, asked: ElasticChoice) -> Result<(Elastic, Option<MixedFit>)> {
    let mut out = Elastic {
        asked,
        model: ElasticChoice::Axes,
        reasons: Vec::new(),
        likelihood_ratio: None,
        axes_rms_m: None,
        mixed_rms_m: None,
        mixed: None,
    };
    if asked == ElasticChoice::Axes {
        return Ok((out, None));
    }
    let postures = fit.system().blocks.len();
    if postures < FEWEST_POSTURES {
        out.reasons.push(format!(
            "The joint axes alone predict: {postures} postures cannot show what gives way beyond them."
        ));
        return Ok((out, None));
    }
    let mixed = match MixedFit::new(fit) {
        Ok(mixed) => mixed,
        Err(error) if [Code::TooFewData, Code::NotIdentifiable].contains(&error.code()) => {
            out.reasons
                .push(format!("The joint axes alone predict. {}", error.message()));
            return Ok((out, None));
        }
        Err(error) => return Err(error),
    };
    let rms = |found: Result<crate::estimate::validate::Validation>| match found {
        Ok(found) => Ok(found
            .unpredicted
            .is_empty()
            .then_some(found.component_rms_m)),
        Err(error) if error.code() == Code::NotIdentifiable => Ok(None),
        Err(error) => Err(error),
    };
    out.likelihood_ratio = Some(mixed.likelihood_ratio());
    out.axes_rms_m = rms(cross_validate(fit, postures, None))?;
    out.mixed_rms_m = rms(cross_validate_mixed(&mixed, postures, None))?;
    let rejected = mixed.likelihood_ratio() > LIKELIHOOD_RATIO;
    let better = match (out.axes_rms_m, out.mixed_rms_m) {
        (Some(axes), Some(mixed)) => mixed < axes,
        (None, Some(_)) => true,
        _ => false,
    };
    let is_mixed = asked == ElasticChoice::Mixed || (rejected && better);
    out.reasons = reasons(&out, rejected, is_mixed);
    if is_mixed {
        out.model = ElasticChoice::Mixed;
        out.mixed = Some(mixed.result()?);
    }
    Ok((out, Some(mixed)))
}

fn reasons(found: &Elastic, rejected: bool, is_mixed: bool) -> Vec<String> {
    let mut out = Vec::new();
    if let (Some(axes), Some(mixed)) = (found.axes_rms_m, found.mixed_rms_m) {
        let by = match mixed < axes {
            true => format!("{} less than", percent(1.0 - mixed / axes)),
            false => "no less than".to_string(),
        };
        out.push(format!(
            "With joints and base that give way in all directions, a posture that took no part is missed by {} (RMS), \
             {by} the {} of the joint axes alone{}.",
            length(mixed),
            length(axes),
            match rejected {
                true => ", and the data reject the axes alone",
                false => ", and the data do not need more than the axes",
            }
        ));
    }
    out.push(match is_mixed {
        true => "Predict and compensate with the mixed model; quote the joint stiffness of the axes alone, which depends on \
                 the model (the mixed one's is beside it)."
            .to_string(),
        false => "The joint axes alone predict, and their stiffness can be quoted.".to_string(),
    });
    out
}

impl MixedFit {
    /// The result in numbers.
    ///
    /// # Errors
    /// No degree of freedom.
    pub fn result(&self) -> Result<MixedResult> {
        let found = self.compliance();
        let names = &self.fit().system().unknowns;
        let fixed = names.len();
        let quantile = found.spread.as_ref().map(Spread::quantile).transpose()?;
        let error = |j: usize| {
            let variance = found.spread.as_ref()?.covariance[(j, j)];
            Some(variance.max(0.0).sqrt())
        };
        let joint = |j: usize| estimate(&names[j], Some(found.values[j]), error(j), quantile);
        let joints = self.fit().cell().setup.robot.joint_count();
        let places = std::iter::once(None).chain((0..joints).map(Some));
        let spring = |place: Option<usize>| {
            let mut compliance = [[0.0; 6]; 6];
            for (term, value) in found.extra.iter().zip(found.values.iter().skip(fixed)) {
                if let ExtraTerm::Spring { joint, row, column } = *term
                    && joint == place
                {
                    compliance[row][column] = *value;
                    compliance[column][row] = *value;
                }
            }
            GeneralSpring {
                joint: place.map(|j| j + 1),
                compliance,
            }
        };
        let spread = found.spread.as_ref();
        let row = |s: &Spread, i: usize| (0..=i).map(|j| s.covariance[(i, j)]).collect();
        Ok(MixedResult {
            joints: (0..fixed).map(joint).collect(),
            sizes: ElasticClass::ALL
                .map(|class| ElasticSize {
                    class,
                    std: self.size(class),
                })
                .to_vec(),
            residual_std_m: spread.map_or(0.0, |s| s.sigma),
            posture_common_std_m: spread.map_or(0.0, |s| s.shift),
            interval_degrees_of_freedom: spread.and_then(|s| s.degrees_of_freedom),
            springs: places.map(spring).collect(),
            covariance: spread
                .map(|s| (0..found.values.len()).map(|i| row(s, i)).collect())
                .unwrap_or_default(),
        })
    }
}

impl MixedResult {
    /// What predicts with these values, at a confidence.
    ///
    /// # Errors
    /// Numbers that do not fit each other.
    pub fn compliance(&self, confidence: f64) -> Result<IdentifiedCompliance> {
        let terms = super::effects::terms(self.springs.len().saturating_sub(1));
        let fixed = self.joints.len();
        let count = fixed + terms.len();
        let mut values = DVector::zeros(count);
        for (j, joint) in self.joints.iter().enumerate() {
            values[j] = joint.compliance.unwrap_or(0.0);
        }
        for (i, term) in terms.iter().enumerate() {
            if let ExtraTerm::Spring { joint, row, column } = *term {
                let place = joint.map_or(0, |j| j + 1);
                values[fixed + i] = self.springs[place].compliance[row][column];
            }
        }
        let fits = self.covariance.len() == count
            && self
                .covariance
                .iter()
                .enumerate()
                .all(|(i, row)| row.len() == i + 1);
        let covariance = fits
            .then(|| DMatrix::from_fn(count, count, |i, j| self.covariance[i.max(j)][i.min(j)]));
        Ok(IdentifiedCompliance {
            values,
            extra: terms,
            spread: covariance.map(|covariance| Spread {
                covariance,
                sigma: self.residual_std_m,
                shift: self.posture_common_std_m,
                degrees_of_freedom: self.interval_degrees_of_freedom,
                confidence,
            }),
            common: Vec::new(),
        })
    }
}
