//! What every joint and the base may give beyond the joint axes: the entries of
//! symmetric 6 × 6 compliances, in three classes whose entries scatter alike.

use crate::error::Result;
pub use crate::model::observation::ElasticClass;
use crate::model::observation::{ExtraTerm, Setup, places};
use crate::model::stiffness::joint_compliance;
use serde::{Deserialize, Serialize};

/// Standard deviations of the entries of each class: of those on the diagonal; entries
/// beside it have them over √2.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ElasticSizes {
    /// Shifts by forces \[m/N\].
    pub shift: f64,
    /// Turns by moments \[rad/(N·m)\].
    pub turn: f64,
    /// Shifts by moments and turns by forces \[rad/N\].
    pub coupling: f64,
}

/// Where the sizes behind a result come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum ElasticSource {
    /// `[elastic]` of the cell.
    Declared,
    /// [`ElasticSizes::typical`].
    Typical,
}

impl ElasticSource {
    /// The sizes in sentences, behind "takes" or "with".
    pub fn in_words(self) -> &'static str {
        match self {
            ElasticSource::Declared => "the sizes that the cell declares in [elastic]",
            ElasticSource::Typical => "typical sizes (no [elastic] in the cell)",
        }
    }
}

/// Sizes over what the prior compliance c (geometric mean over the joints) and the length
/// L of the arm make of their units: c L², c and c L. As the mixed model finds them on
/// the 43 measured postures of a FANUC R-2000iC/165F, one digit: 0.009, 0.10 and 0.020
/// (L = 2.98 m, k = 7.8e5 N·m/rad with the joint axes alone).
const TYPICAL: [f64; 3] = [0.01, 0.1, 0.02];

impl ElasticSizes {
    /// The size of a class.
    pub fn of(&self, class: ElasticClass) -> f64 {
        match class {
            ElasticClass::Shift => self.shift,
            ElasticClass::Turn => self.turn,
            ElasticClass::Coupling => self.coupling,
        }
    }

    /// All sizes times `factor`.
    #[must_use]
    pub fn times(&self, factor: f64) -> Self {
        ElasticSizes {
            shift: self.shift * factor,
            turn: self.turn * factor,
            coupling: self.coupling * factor,
        }
    }

    /// What an arm of this length and prior joint stiffness \[N·m/rad\] may be expected
    /// to have, by what was measured on a FANUC R-2000iC/165F: entries of a tenth of the
    /// joints' compliance for turns, the others in proportion by the arm's length. An
    /// order of magnitude, for plans.
    ///
    /// # Errors
    /// A wrong number of values, or one that is not above zero.
    pub fn typical(setup: &Setup, prior: &[f64]) -> Result<Self> {
        joint_compliance(&setup.robot, prior)?;
        let logarithms: f64 = prior.iter().map(|k| k.ln()).sum();
        let turn = (-logarithms / prior.len() as f64).exp();
        let length = setup.robot.length() + setup.tool.tcp().norm();
        Ok(ElasticSizes {
            shift: TYPICAL[0] * turn * length * length,
            turn: TYPICAL[1] * turn,
            coupling: TYPICAL[2] * turn * length,
        })
    }
}

/// One entry of a spring's compliance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Effect {
    pub(crate) term: ExtraTerm,
    pub(crate) class: ElasticClass,
    /// Its standard deviation in units of the class's: 1 on the diagonal, 1/√2 beside
    /// it, so that turning the axes changes nothing (the Gaussian orthogonal ensemble).
    pub(crate) scale: f64,
}

/// The terms of random effects.
pub(crate) fn terms(effects: &[Effect]) -> Vec<ExtraTerm> {
    effects.iter().map(|effect| effect.term).collect()
}

/// The random effects that data are held against: those of [`effects`], and ahead of those of a class that has a
/// diagonal its mean, because real compliances are positive. It scatters as its entries do, which suits matrices
/// drawn around zero, and semidefinite ones whose mean and scatter are of one size
/// (`bench/elastic_truths.py` counts both).
pub(crate) fn fitted(joints: usize) -> Vec<Effect> {
    let own = effects(joints);
    let of = |class| {
        let common = (class != ElasticClass::Coupling).then_some(Effect {
            term: ExtraTerm::MeanSpring(class),
            class,
            scale: 1.0,
        });
        let single = own.iter().copied().filter(move |e| e.class == class);
        common.into_iter().chain(single).collect::<Vec<_>>()
    };
    ElasticClass::ALL.into_iter().flat_map(of).collect()
}

/// All random effects of an arm, class by class.
pub(crate) fn effects(joints: usize) -> Vec<Effect> {
    let mut all = Vec::new();
    for class in ElasticClass::ALL {
        for joint in places(joints) {
            for row in 0..6 {
                for column in row..6 {
                    // The joint's own axis is the fixed effect.
                    let is_axis = joint.is_some() && (row, column) == (5, 5);
                    if ElasticClass::of(row, column) == class && !is_axis {
                        all.push(Effect {
                            term: ExtraTerm::Spring { joint, row, column },
                            class,
                            scale: if row == column { 1.0 } else { 0.5f64.sqrt() },
                        });
                    }
                }
            }
        }
    }
    all
}
