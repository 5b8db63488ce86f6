//! The mixed model in numbers that can be saved.

use super::{MixedFit, size_doubt};
use crate::error::Result;
use crate::estimate::compliance::{IdentifiedCompliance, Spread};
use crate::estimate::identify::{JointEstimate, estimate};
use crate::model::elastic::{ElasticClass, effects, terms};
use crate::model::observation::ExtraTerm;
use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

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
    /// How well the sizes are known: covariance of ln σ² and of the logarithms of the
    /// ratios of the classes' variances to σ², lower triangle row by row. Empty in results
    /// of earlier versions, which take the sizes as known.
    #[serde(default)]
    pub size_covariance: Vec<Vec<f64>>,
    /// Base first, then joint by joint.
    pub springs: Vec<GeneralSpring>,
    /// Covariance of all unknowns, lower triangle row by row: joint axes, then the
    /// entries of the springs, class by class (shift, turn, coupling), within a class
    /// spring by spring, within a spring by row and column of its upper triangle.
    pub covariance: Vec<Vec<f64>>,
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
        let quantiles = found.spread.as_ref().map(Spread::quantiles).transpose()?;
        let error = |j: usize| {
            let variance = found.spread.as_ref()?.covariance[(j, j)];
            Some(variance.max(0.0).sqrt())
        };
        let quantile = |j: usize| {
            let covariance = &found.spread.as_ref()?.covariance;
            Some(quantiles.as_ref()?.of_unknown(covariance, j))
        };
        let joint = |j: usize| estimate(&names[j], Some(found.values[j]), error(j), quantile(j));
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
            size_covariance: spread
                .and_then(|s| s.doubt.as_ref())
                .map(|doubt| triangle(&doubt.covariance))
                .unwrap_or_default(),
            springs: places.map(spring).collect(),
            covariance: spread.map(|s| triangle(&s.covariance)).unwrap_or_default(),
        })
    }
}

impl MixedResult {
    /// What predicts with these values, at a confidence.
    ///
    /// # Errors
    /// Numbers that do not fit each other.
    pub fn compliance(&self, confidence: f64) -> Result<IdentifiedCompliance> {
        let effects = effects(self.springs.len().saturating_sub(1));
        let terms = terms(&effects);
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
        let covariance = symmetric(&self.covariance, count);
        let sizes = 1 + ElasticClass::ALL.len();
        let std = |class: ElasticClass| {
            let own = self.sizes.iter().find(|size| size.class == class);
            own.map_or(0.0, |size| size.std)
        };
        let doubt = symmetric(&self.size_covariance, sizes)
            .map(|covariance| size_doubt(&effects, fixed, std, covariance));
        Ok(IdentifiedCompliance {
            values,
            extra: terms,
            spread: covariance.map(|covariance| Spread {
                covariance,
                sigma: self.residual_std_m,
                shift: self.posture_common_std_m,
                degrees_of_freedom: self.interval_degrees_of_freedom,
                doubt,
                confidence,
            }),
            common: Default::default(),
            doubts: Vec::new(),
        })
    }
}

/// The lower triangle row by row.
fn triangle(matrix: &DMatrix<f64>) -> Vec<Vec<f64>> {
    let row = |i: usize| (0..=i).map(|j| matrix[(i, j)]).collect();
    (0..matrix.nrows()).map(row).collect()
}

/// The matrix of this size with a lower triangle; `None` for another.
fn symmetric(rows: &[Vec<f64>], count: usize) -> Option<DMatrix<f64>> {
    let fits = rows.len() == count && rows.iter().enumerate().all(|(i, row)| row.len() == i + 1);
    fits.then(|| DMatrix::from_fn(count, count, |i, j| rows[i.max(j)][i.min(j)]))
}
