//! A plan held against its own postures: a saved result may have been edited.

use super::planned::Plan;
use stiffarm::findings::{Finding, Severity};
use stiffarm::model::cell::Cell;
use stiffarm::plan::index::evaluate;

/// Relative difference beyond which a value is another one.
const DIFFERENT: f64 = 1e-6;

/// What a file says that its postures do not give.
pub(super) fn disagreement(cell: &Cell, plan: &Plan) -> Option<Finding> {
    let index = plan.selection.index;
    // k(J_N) needs a length that may have been computed, and given postures may have had loads of their own.
    if index.uses_dexterity() || !plan.given_names.is_empty() {
        return None;
    }
    let found = evaluate(cell, "the plan", &plan.selection.group).ok()?;
    let (own, said) = (found.indices.get(index)?, plan.selection.value);
    let sentence = format!(
        "The file does not agree with itself: it says {said:.6e} for the index {}, and its postures give {own:.6e} in this \
         cell. It was edited, or another version wrote it; choose the postures anew.",
        index.as_str()
    );
    let differs = (own - said).abs() > DIFFERENT * own.abs();
    differs.then(|| Finding::new("edited-result", Severity::Serious, "plan", sentence))
}
