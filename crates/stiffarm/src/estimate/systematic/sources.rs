//! The sources of common error: what each does to the displacements, one standard uncertainty of each of its numbers.

use super::predicting_model::PredictingModel;
use crate::error::Result;
use crate::estimate::identify::{Experiment, MeasuredSystem};
use crate::estimate::quantity::answer::Answers;
use crate::estimate::quantity::facts::{self, Facts, Quantity};
use crate::estimate::quantity::stated::StatedExperiment;
use crate::estimate::quantity::value::QuantityValue;
use crate::model::observation::ExtraTerm;
use nalgebra::DVector;

/// A source with what its parts do to the displacements.
pub(super) struct Source {
    pub facts: Facts,
    pub size: f64,
    pub declared: bool,
    /// True where it was identified beside the stiffness.
    pub free: bool,
    /// True where the readings want it elsewhere.
    pub doubtful: bool,
    /// True where the parts are of one size that is not known better than stated.
    pub alike: bool,
    /// One part without a name for a source that is one number.
    pub parts: Vec<Part>,
}

/// One part of a source.
pub(super) struct Part {
    pub name: String,
    /// Change of the displacements, rows as in the system \[m\].
    pub shift: DVector<f64>,
    /// What acts again at work.
    pub at_work: Option<ExtraTerm>,
    /// Change of the unknowns by one that moves no displacement: readings say nothing of it.
    pub change: Option<DVector<f64>>,
}

/// The sources that matter for the measurements of `experiment`, whose rows are those of `system`; the force scale
/// first.
pub(super) fn sources(
    believed: &PredictingModel<'_>,
    experiment: &Experiment,
    system: &MeasuredSystem,
) -> Result<Vec<Source>> {
    let cell = believed.fit.cell();
    let stated = StatedExperiment::new(believed.fit, experiment, system);
    let answers = Answers::new(&stated, believed.extra, believed.values.clone())?;
    let tool = &cell.setup.tool;
    let unmodelled = tool.has_sensor && tool.series_compliance.is_none();
    let mut out: Vec<Source> = Vec::new();
    for quantity in stated.quantities() {
        let facts = quantity.facts();
        let is_free = believed.fit.options().free.iter().any(|name| name == facts.name);
        let stated = quantity.size(&cell.uncertainty, is_free);
        let off = believed.off.filter(|(doubted, size)| *doubted == quantity && *size > stated.0);
        let (size, declared) = off.map_or(stated, |(_, size)| (size, true));
        let is_none = match quantity {
            Quantity::Sensor => !declared && !unmodelled,
            _ => !declared && size == 0.0,
        };
        if is_none {
            continue;
        }
        let names = quantity.parts(cell);
        let count = names.len();
        let mut parts = Vec::new();
        for (i, name) in names.into_iter().enumerate() {
            let at_work = quantity.terms(i);
            // What the unknowns account for already is no error.
            if at_work.is_some_and(|term| believed.holds(&term)) {
                continue;
            }
            parts.push(Part {
                name,
                shift: answers.shift(&[(quantity, QuantityValue::off(count, i, size))])?,
                at_work,
                change: None,
            });
        }
        match out.iter_mut().find(|source| source.facts.name == facts.name) {
            Some(source) => source.parts.extend(parts),
            None if parts.is_empty() => {}
            None => out.push(Source {
                facts,
                size,
                declared,
                free: is_free,
                doubtful: off.is_some(),
                alike: quantity == Quantity::LostMotion,
                parts,
            }),
        }
    }
    if let Some(alone) = &believed.springs_alone {
        let facts = facts::springs();
        out.push(Source {
            size: facts.assumed,
            declared: true,
            free: false,
            doubtful: false,
            alike: false,
            parts: vec![Part {
                name: String::new(),
                shift: DVector::zeros(system.delta.len()),
                at_work: None,
                change: Some(alone * facts.assumed),
            }],
            facts,
        });
    }
    Ok(out)
}
