//! The random effects: what every joint and the base may give beyond the joint
//! axes.

use crate::model::observation::ExtraTerm;
use serde::{Deserialize, Serialize};

/// Entries of the springs' compliances that share one size.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum ElasticClass {
    /// Shifts by forces \[m/N\].
    Shift,
    /// Turns by moments, but for the joint's own axis \[rad/(N·m)\].
    Turn,
    /// Shifts by moments and turns by forces \[rad/N\].
    Coupling,
}

impl ElasticClass {
    /// All classes, in the order of results.
    pub const ALL: [ElasticClass; 3] = [
        ElasticClass::Shift,
        ElasticClass::Turn,
        ElasticClass::Coupling,
    ];

    /// The class of an entry: rows and columns 0 to 2 are shifts and forces, 3 to 5 turns
    /// and moments.
    pub fn of(row: usize, column: usize) -> Self {
        match (row < 3, column < 3) {
            (true, true) => ElasticClass::Shift,
            (false, false) => ElasticClass::Turn,
            _ => ElasticClass::Coupling,
        }
    }

    /// Unit of the entries.
    pub fn unit(self) -> &'static str {
        match self {
            ElasticClass::Shift => "m/N",
            ElasticClass::Turn => "rad/(N·m)",
            ElasticClass::Coupling => "rad/N",
        }
    }
}

/// One entry of a spring's compliance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Effect {
    pub(super) term: ExtraTerm,
    pub(super) class: ElasticClass,
    /// Its standard deviation in units of the class's: 1 on the diagonal, 1/√2 beside
    /// it, so that turning the axes changes nothing (the Gaussian orthogonal ensemble).
    pub(super) scale: f64,
}

/// The terms of random effects.
pub(super) fn terms(effects: &[Effect]) -> Vec<ExtraTerm> {
    effects.iter().map(|effect| effect.term).collect()
}

/// All random effects of an arm, class by class.
pub(super) fn effects(joints: usize) -> Vec<Effect> {
    let places = || std::iter::once(None).chain((0..joints).map(Some));
    let mut all = Vec::new();
    for class in ElasticClass::ALL {
        for joint in places() {
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
