//! The errors common to the experiment behind a saved stiffness.

use super::checks::{AGREEMENT, SOFTEST, same_name};
use super::fault;
use super::keys::{self, below};
use super::posterior;
use crate::error::Result;
use crate::estimate::compliance::IdentifiedCompliance;
use crate::estimate::systematic::SystematicErrors;
use crate::model::cell::Cell;
use serde_json::Value;

/// The compliance with the errors of `budget`, which stands at `key`.
///
/// # Errors
/// Unknown keys; another robot's joints; a change that leaves a joint without
/// stiffness, or a sum that is not that of its parts.
pub(super) fn with_budget(
    compliance: IdentifiedCompliance,
    budget: &Value,
    key: &str,
    cell: &Cell,
) -> Result<IdentifiedCompliance> {
    keys::check(budget, key, keys::BUDGET)?;
    keys::check_each(budget, key, "sources", keys::SOURCE)?;
    keys::check_each(budget, key, "uncertainty", keys::UNCERTAINTY)?;
    if !budget["posterior"].is_null() {
        let (posterior, key) = (&budget["posterior"], below(key, "posterior"));
        keys::check(posterior, &key, keys::POSTERIOR)?;
        keys::check_each(posterior, &key, "parts", keys::POSTERIOR_PART)?;
    }
    for (i, source) in budget["sources"]
        .as_array()
        .into_iter()
        .flatten()
        .enumerate()
    {
        let key = format!("{}[{i}]", below(key, "sources"));
        keys::check_each(source, &key, "parts", keys::PART)?;
    }
    let budget: SystematicErrors = serde_json::from_value(budget.clone())
        .map_err(|e| fault(format!("The common-mode errors cannot be read: {e}.")).key(key))?;
    check(&budget, &compliance, key, cell)?;
    if let Some(posterior) = &budget.posterior {
        posterior::check(posterior, &budget, &compliance, key, cell)?;
    }
    Ok(compliance.with_systematic_errors(&budget))
}

fn check(
    budget: &SystematicErrors,
    compliance: &IdentifiedCompliance,
    key: &str,
    cell: &Cell,
) -> Result<()> {
    let names = cell.setup.robot.spring_names();
    if budget.joints.len() != names.len() {
        let message = format!(
            "{} joints of the {} joints of the cell.",
            budget.joints.len(),
            names.len()
        );
        return Err(fault(message).key(below(key, "joints")));
    }
    for (j, (own, name)) in budget.joints.iter().zip(&names).enumerate() {
        same_name(own, name, &format!("{}[{j}]", below(key, "joints")))?;
    }
    let values = compliance.values.as_slice();
    for (i, source) in budget.sources.iter().enumerate() {
        let key = format!("{}[{i}]", below(key, "sources"));
        if !(0.0..f64::INFINITY).contains(&source.size) {
            let message = format!(
                "The size of an error is {}; it must be 0 or more.",
                source.size
            );
            return Err(fault(message).key(below(&key, "size")));
        }
        changes(&source.change, values, names.len(), &below(&key, "change"))?;
        for (p, part) in source.parts.iter().enumerate() {
            let key = format!("{}[{p}].change", below(&key, "parts"));
            changes(&part.change, values, names.len(), &key)?;
        }
        if !source.parts.is_empty() {
            let parts = source.parts.iter().map(|part| &part.change);
            summed(&source.change, parts.collect(), &below(&key, "change"))?;
        }
    }
    if budget.posterior.is_some() {
        return Ok(());
    }
    let sources = budget.sources.iter().map(|source| &source.change);
    summed(&budget.combined, sources.collect(), &below(key, "combined"))
}

/// One change of k for each joint, none of which takes all of its stiffness.
fn changes(changes: &[Option<f64>], values: &[f64], joints: usize, key: &str) -> Result<()> {
    if changes.len() != joints {
        let message = format!(
            "{} values for the {joints} joints of the cell.",
            changes.len()
        );
        return Err(fault(message).key(key));
    }
    for (j, (change, h)) in changes.iter().zip(values).enumerate() {
        let Some(change) = change else { continue };
        let moved = h / (1.0 + change);
        if !(*change > -1.0 && moved.abs() <= SOFTEST) {
            let message = format!(
                "A change of the stiffness by {change} of it leaves none; it must be above −1."
            );
            return Err(fault(message).key(format!("{key}[{j}]")));
        }
    }
    Ok(())
}

/// Root sums of squares are those of their parts.
fn summed(sums: &[Option<f64>], parts: Vec<&Vec<Option<f64>>>, key: &str) -> Result<()> {
    for (j, sum) in sums.iter().enumerate() {
        let squares: Option<f64> = parts
            .iter()
            .map(|part| part.get(j).copied().flatten().map(|c| c * c))
            .sum();
        let agrees = match (sum, squares.map(f64::sqrt)) {
            (Some(sum), Some(of_parts)) => {
                (sum - of_parts).abs() <= AGREEMENT * sum.abs().max(1e-6)
            }
            (None, None) => true,
            _ => false,
        };
        if !agrees {
            let message =
                "This is not the root sum of squares of its parts: they contradict each other.";
            return Err(fault(message.to_string()).key(format!("{key}[{j}]")));
        }
    }
    Ok(())
}
