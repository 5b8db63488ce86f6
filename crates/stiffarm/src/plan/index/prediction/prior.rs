//! What is expected of an arm beyond its joint axes before it is measured: the entries of
//! all springs as linear combinations of independent effects of variance one.

use crate::error::Result;
use crate::model::cell::Cell;
use crate::model::elastic::{
    Effect, ElasticClass, ElasticSizes, ElasticSizing, ElasticSource, KnownElement, effects, fitted,
};
use crate::model::kinematics::Frames;
use crate::model::observation::ExtraTerm;
use crate::model::robot::Robot;
use crate::model::stiffness::joint_compliance;
use nalgebra::DMatrix;

/// Sizes of the classes of [`fitted`], sized by their joint, over what the prior compliance c (geometric mean over the
/// joints) and the length L of the arm make of their units: c L², c, c L, c, c/L. The geometric mean, one digit, of
/// what the mixed model finds on 43 measured postures of a FANUC R-2000iC/165F (0.003, 0, 0.01, 0, 0.7) and on 30
/// postures of fourteen arms of a structural code (0.0001, 0.005, 0.0004, 0.06, 0.3; bench/structural_arms.py), zeros
/// left out. A plan hardly depends on them, what it promises does.
const EXPECTED: [f64; 5] = [0.0005, 0.005, 0.002, 0.06, 0.5];

/// Entries of all springs, and the square root of their prior covariance.
#[derive(Debug, Clone)]
pub(super) struct Prior {
    /// All entries, those of the joints' own axes among them, as they are.
    pub(super) entries: Vec<Effect>,
    /// Entries × effects: what an effect of variance one adds to each entry.
    pub(super) root: DMatrix<f64>,
    /// How many of the effects, the last, a drawing knows: they are as far off as it says, whatever is expected
    /// besides.
    pub(super) drawn: usize,
}

impl Prior {
    /// As the cell declares, each entry for itself, else as an arm of its length and prior stiffness may be expected to
    /// be made, all sizes times `factor`; and what a drawing says, as exactly as it says it.
    ///
    /// # Errors
    /// The cell declares nothing and has no prior.
    pub(super) fn of_cell(cell: &Cell, factor: f64) -> Result<(Self, ElasticSource)> {
        let robot = &cell.setup.robot;
        if let Some(sizes) = cell.elastic {
            let prior = Prior::alike(robot, &sizes.times(factor), &cell.known_elements);
            return Ok((prior, ElasticSource::Declared));
        }
        let prior = cell.require_prior()?;
        let compliance = joint_compliance(robot, prior)?.diagonal();
        let c = (-prior.iter().map(|k| k.ln()).sum::<f64>() / prior.len() as f64).exp();
        let length = robot.length() + cell.setup.tool.tcp().norm();
        let units = [c * length * length, c, c * length, c, c / length];
        let (compliance, drawing) = (compliance.as_slice(), &cell.known_elements);
        let mut all = fitted(robot, compliance, ElasticSizing::ByJoint, drawing);
        for effect in &mut all {
            let class = effect.class as usize;
            if let (Some(expected), Some(unit)) = (EXPECTED.get(class), units.get(class)) {
                effect.scale *= factor * expected * unit;
            }
        }
        Ok((Prior::new(robot, &all, true), ElasticSource::Typical))
    }

    /// Entries that scatter around zero with these sizes, and what a drawing says.
    pub(super) fn alike(robot: &Robot, sizes: &ElasticSizes, drawing: &[KnownElement]) -> Self {
        let mut all = effects(robot.joint_count());
        for effect in &mut all {
            effect.scale *= sizes.of(effect.class);
        }
        all.extend(drawing.iter().map(KnownElement::effect));
        Prior::new(robot, &all, false)
    }

    /// Effects with their standard deviations as scale, those of a drawing last; with `means` those of a class that
    /// cannot be negative scatter about a common mean, which is of their own size.
    fn new(robot: &Robot, effects: &[Effect], means: bool) -> Self {
        let joints = robot.joint_count();
        let entries = all_entries(joints);
        let frames = Frames::new(robot, &vec![0.0; joints]);
        let column = |effect: &Effect| -> Vec<f64> {
            let (place, spring) = effect.term.compliance(&frames);
            let of = |entry: &Effect| match entry.term {
                ExtraTerm::Spring { joint, row, column } if joint == place => spring[(row, column)] * effect.scale,
                _ => 0.0,
            };
            entries.iter().map(of).collect()
        };
        let drawn = effects.iter().filter(|e| e.class == ElasticClass::Drawing);
        let (expected, drawn) = effects.split_at(effects.len() - drawn.count());
        let mut columns: Vec<Vec<f64>> = expected.iter().map(column).collect();
        if means {
            for class in ElasticClass::ALL {
                let members = effects.iter().zip(&columns);
                let members = members.filter(|(e, _)| e.class == class && e.is_positive());
                let sum = members.fold(vec![0.0; entries.len()], |sum, (_, column)| {
                    sum.iter().zip(column).map(|(s, c)| s + c).collect()
                });
                columns.push(sum);
            }
        }
        columns.extend(drawn.iter().map(column));
        columns.retain(|column| column.iter().any(|v| *v != 0.0));
        Prior {
            drawn: drawn.len(),
            root: DMatrix::from_fn(entries.len(), columns.len(), |i, j| columns[j][i]),
            entries,
        }
    }
}

/// Every entry of every spring.
fn all_entries(joints: usize) -> Vec<Effect> {
    let mut all = effects(joints);
    for effect in &mut all {
        effect.scale = 1.0;
    }
    all.extend((0..joints).map(|j| Effect {
        term: ExtraTerm::Spring { joint: Some(j), row: 5, column: 5 },
        class: ElasticClass::Turn,
        scale: 1.0,
    }));
    all
}
