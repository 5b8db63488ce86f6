//! The mixed model in numbers that can be saved.

use super::MixedFit;
use crate::error::Result;
use crate::estimate::compliance::Spread;
use crate::estimate::identify::{JointEstimate, estimate};
use crate::model::elastic::{ElasticClass, ElasticSizing};
use crate::model::observation::Elements;
use serde::{Deserialize, Serialize};

/// How much the compliances of one class scatter.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ElasticSize {
    /// The class.
    pub class: ElasticClass,
    /// Standard deviation ω of one of them, of a joint whose stiffness is the geometric mean where they go by their
    /// joint; entries beside a diagonal have ω/√2 \[m/N; rad/(N·m); rad/N; rad/(N·m) per m\].
    pub std: f64,
}

/// What a bearing, a beam of a link or the base gives way.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ElasticElement {
    /// Which it is.
    pub name: String,
    /// Its class.
    pub class: ElasticClass,
    /// Its compliance \[rad/(N·m); rad/(N·m) per m\].
    pub compliance: f64,
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

/// What gives way beyond the axes in the mixed model; what predicts with it is sealed in the result.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MixedResult {
    /// Sizes of what gives way besides.
    pub sizes: Vec<ElasticSize>,
    /// σ of a displacement component \[m\].
    pub residual_std_m: f64,
    /// τ of a shift common to a posture's points, at its largest load \[m\].
    pub posture_common_std_m: f64,
    /// Standard deviation of a displacement component by both together \[m\].
    pub total_std_m: f64,
    /// Degrees of freedom behind quantiles; `None` for normal ones.
    pub interval_degrees_of_freedom: Option<usize>,
    /// What the entries of `springs` are in proportion to: the likelier.
    pub sizing: ElasticSizing,
    /// Bearings, the base and the links.
    pub elements: Vec<ElasticElement>,
    /// What joints and base give beside `elements`; base first, then joint by joint.
    pub springs: Vec<GeneralSpring>,
}

impl MixedFit {
    /// One estimate per joint: the stiffness with which the axes alone best reproduce the arm over its cell, with the
    /// scatter of the readings.
    ///
    /// # Errors
    /// No degree of freedom.
    pub fn joints(&self) -> Result<Vec<JointEstimate>> {
        let identified = self.compliance();
        let names = &self.fit().system().unknowns;
        let quantiles = identified.spread.as_ref().map(Spread::quantiles).transpose()?;
        let reproduced = self.reproduced()?;
        let values = reproduced.of(&identified.values);
        let joint = |j: usize| {
            if identified.undetermined.contains(&j) {
                return estimate(&names[j], None, None, None);
            }
            let scatter = identified.spread.as_ref().zip(quantiles.as_ref());
            let scatter = scatter.map(|(spread, quantiles)| {
                let (with, variance) = reproduced.covariance(spread, j);
                (variance.sqrt(), quantiles.of(&with, variance, 0.0))
            });
            let (error, quantile) = scatter.unzip();
            estimate(&names[j], Some(values[j]), error, quantile)
        };
        Ok((0..names.len()).map(joint).collect())
    }

    /// What gives way beyond the axes, in numbers.
    pub fn result(&self) -> MixedResult {
        let identified = self.compliance();
        let fixed = self.fit().system().unknowns.len();
        let joints = self.fit().cell().setup.robot.joint_count();
        let values = &identified.values.as_slice()[fixed..];
        let elements = Elements::new(&identified.extra, values, joints);
        let springs = elements.springs.into_iter();
        let springs = springs.map(|(place, compliance)| GeneralSpring {
            joint: place.map(|j| j + 1),
            // Symmetric: columns are rows.
            compliance: compliance.data.0,
        });
        let spread = identified.spread.as_ref();
        let robot = &self.fit().cell().setup.robot;
        let elements = self.effects.iter().zip(values);
        let elements = elements.filter(|(effect, _)| !ElasticClass::ENTRIES.contains(&effect.class));
        let elements = elements.map(|(effect, value)| ElasticElement {
            name: effect.term.name(robot),
            class: effect.class,
            compliance: *value,
        });
        MixedResult {
            sizing: self.sizing,
            elements: elements.collect(),
            sizes: ElasticClass::ALL.map(|class| ElasticSize { class, std: self.size(class) }).to_vec(),
            residual_std_m: spread.map_or(0.0, |s| s.sigma),
            posture_common_std_m: spread.map_or(0.0, |s| s.shift),
            total_std_m: spread.map_or(0.0, |s| s.sigma.hypot(s.shift)),
            interval_degrees_of_freedom: spread.and_then(|s| s.degrees_of_freedom),
            springs: springs.collect(),
        }
    }
}
