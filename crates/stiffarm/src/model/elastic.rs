//! What every joint and the base may give beyond the joint axes: the entries of
//! symmetric 6 × 6 compliances, in three classes whose entries scatter alike.

use crate::error::Result;
use crate::model::kinematics::Frames;
pub use crate::model::observation::ElasticClass;
use crate::model::observation::{ExtraTerm, RowPart, Setup, places, row_part};
use crate::model::robot::Robot;
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
            ElasticSource::Typical => "typical sizes (none in [elastic] of the cell)",
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
            // What is drawn or planned with declared sizes has no structure.
            ElasticClass::Bearing | ElasticClass::Beam | ElasticClass::Drawing => 0.0,
        }
    }

    /// All sizes times `factor`.
    #[must_use]
    pub fn times(&self, factor: f64) -> Self {
        ElasticSizes { shift: self.shift * factor, turn: self.turn * factor, coupling: self.coupling * factor }
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

/// The compliance of a bearing, of a link or of the base as a drawing or a catalogue gives it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KnownElement {
    /// Which it is: a tilt or a beam.
    pub term: ExtraTerm,
    /// Its compliance \[rad/(N·m); of a beam per m\].
    pub compliance: f64,
    /// Standard uncertainty of that.
    pub std: f64,
}

impl KnownElement {
    /// An element of this stiffness, which may be `factor` times as large or as small (one standard uncertainty).
    pub fn new(term: ExtraTerm, stiffness: f64, factor: f64) -> Self {
        KnownElement { term, compliance: 1.0 / stiffness, std: (factor - 1.0 / factor) / 2.0 / stiffness }
    }

    /// What is not known of it, a random effect.
    pub(crate) fn effect(&self) -> Effect {
        Effect { term: self.term, class: ElasticClass::Drawing, scale: self.std }
    }
}

/// The even beams of a robot: bending and twist of the parts of its rows that have a length.
pub fn beams(robot: &Robot) -> Vec<ExtraTerm> {
    let joints = robot.joint_count();
    let frames = Frames::new(robot, &vec![0.0; joints]);
    let parts = (0..joints).flat_map(|joint| [RowPart::Link, RowPart::Axis].map(|p| (joint, p)));
    let parts = parts.filter(|(j, part)| row_part(&frames, *j, *part)[1].norm() >= SHORTEST_BEAM);
    let both = |(joint, part)| [false, true].map(|twist| ExtraTerm::Beam { joint, part, twist });
    parts.flat_map(both).collect()
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

impl Effect {
    /// True for a compliance that cannot be negative: those of a class scatter about a common mean, which is of their
    /// own size.
    pub(crate) fn is_positive(&self) -> bool {
        match self.term {
            ExtraTerm::Spring { row, column, .. } => row == column,
            _ => true,
        }
    }
}

/// The terms of random effects.
pub(crate) fn terms(effects: &[Effect]) -> Vec<ExtraTerm> {
    effects.iter().map(|effect| effect.term).collect()
}

/// What the entries of a general spring are in proportion to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum ElasticSizing {
    /// Those of each joint to the compliance of its own axis, those of the base to a tenth of the stiffest joint's.
    ByJoint,
    /// Those of all joints and the base are alike.
    Alike,
}

impl ElasticSizing {
    /// All of them: the data choose.
    pub const ALL: [ElasticSizing; 2] = [ElasticSizing::Alike, ElasticSizing::ByJoint];
}

/// The random effects that data are held against, class by class, those that cannot be negative first in their class:
/// the entries of [`effects`], and what an arm is made of: bearings that tilt as their joint gives way (`compliance` of
/// each joint \[rad/(N·m)\], in units of the geometric mean), a base that tilts a tenth of the stiffest joint, and even
/// beams along each row of the robot. What they are in units of was counted on arms of a structural code
/// (bench/structural_arms.py). What a drawing knows of them is a class of its own, the last.
pub(crate) fn fitted(
    robot: &Robot,
    compliance: &[f64],
    sizing: ElasticSizing,
    drawing: &[KnownElement],
) -> Vec<Effect> {
    let joints = robot.joint_count();
    let of_joint = relative(joints, compliance);
    let base = BASE * of_joint.iter().copied().fold(f64::INFINITY, f64::min);
    let mut all = effects(joints);
    all.sort_by_key(|effect| (effect.class as usize, !effect.is_positive()));
    if sizing == ElasticSizing::ByJoint {
        for effect in &mut all {
            effect.scale *= effect.term.joint().map_or(base, |j| of_joint[j]);
        }
    }
    let tilts = of_joint.iter().enumerate();
    let tilts = tilts.map(|(j, size)| (ExtraTerm::JointTilt(j), *size));
    all.extend(tilts.chain([(ExtraTerm::BaseTilt, base)]).map(|(term, scale)| Effect {
        term,
        class: ElasticClass::Bearing,
        scale,
    }));
    all.extend(beams(robot).into_iter().map(|term| Effect { term, class: ElasticClass::Beam, scale: 1.0 }));
    for element in drawing {
        all.retain(|effect| effect.term != element.term);
        all.push(element.effect());
    }
    all
}

/// Term, class and relative size of each random effect that data are held against, for this project's own tests.
pub fn elastic_effects(
    robot: &Robot,
    compliance: &[f64],
    sizing: ElasticSizing,
) -> Vec<(ExtraTerm, ElasticClass, f64)> {
    let all = fitted(robot, compliance, sizing, &[]);
    all.iter().map(|e| (e.term, e.class, e.scale)).collect()
}

/// Compliance of each joint over the geometric mean; one where it is not known or not positive.
fn relative(joints: usize, compliance: &[f64]) -> Vec<f64> {
    let positive = |j: usize| compliance.get(j).copied().filter(|h| *h > 0.0);
    let logarithms: Vec<f64> = (0..joints).filter_map(positive).map(f64::ln).collect();
    let mean = logarithms.iter().sum::<f64>() / logarithms.len().max(1) as f64;
    let size = |j: usize| positive(j).map_or(1.0, |h| (h.ln() - mean).exp());
    (0..joints).map(size).collect()
}

/// The base's tilt over that of the stiffest joint.
const BASE: f64 = 0.1;
/// Parts of a row that are shorter are none \[m\].
const SHORTEST_BEAM: f64 = 1e-3;

/// All random effects of an arm, class by class.
pub(crate) fn effects(joints: usize) -> Vec<Effect> {
    let mut all = Vec::new();
    for class in ElasticClass::ENTRIES {
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
