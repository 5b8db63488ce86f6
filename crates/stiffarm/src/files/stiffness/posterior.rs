//! What the readings left of the common errors of a saved stiffness.

use super::checks::{self, AGREEMENT, LARGEST_LENGTH, SOFTEST, non_negative};
use super::fault;
use super::keys::below;
use crate::error::Result;
use crate::estimate::compliance::IdentifiedCompliance;
use crate::estimate::systematic::{
    PosteriorPart, SystematicErrors, SystematicPosterior, SystematicSource,
};
use crate::model::cell::Cell;
use nalgebra::DVector;

/// Readings that show more than so many times a stated size are no readings.
const MOST_TIMES: f64 = 1e12;

/// Holds the moments of `budget`, which stands at `budget_key`, against the sources, the stiffness and
/// each other.
///
/// # Errors
/// Numbers that cannot be, or that contradict each other, with their key.
pub(super) fn check(
    found: &SystematicPosterior,
    budget: &SystematicErrors,
    compliance: &IdentifiedCompliance,
    budget_key: &str,
    cell: &Cell,
) -> Result<()> {
    let key = &below(budget_key, "posterior");
    let at = |name: &str| below(key, name);
    let parts: Vec<(&SystematicSource, usize)> = budget
        .sources
        .iter()
        .flat_map(|source| (0..source.parts.len().max(1)).map(move |p| (source, p)))
        .collect();
    let count = parts.len();
    if found.parts.len() != count {
        let message = format!("The sources have {count} parts, not {}.", found.parts.len());
        return Err(fault(message).key(at("parts")));
    }
    for (i, (own, (source, p))) in found.parts.iter().zip(parts).enumerate() {
        let key = format!("{}[{i}]", at("parts"));
        part(own, source, p, compliance, &key, cell)?;
    }
    moments(found, count, key)?;
    combined(found, budget, compliance, budget_key)
}

/// One part: that of its source.
fn part(
    own: &PosteriorPart,
    source: &SystematicSource,
    p: usize,
    compliance: &IdentifiedCompliance,
    key: &str,
    cell: &Cell,
) -> Result<()> {
    let (name, change) = match source.parts.get(p) {
        Some(part) => (part.name.as_str(), &part.change),
        None => ("", &source.change),
    };
    if own.source != source.name || own.part != name {
        let message = format!(
            "Parts stand in the order of the sources: here that is \"{name}\" of \"{}\".",
            source.name
        );
        return Err(fault(message).key(below(key, "part")));
    }
    checks::same(own.size, source.size, &below(key, "size"))?;
    if let Some(term) = own.at_work
        && !term.fits(cell.setup.robot.joint_count())
    {
        let message = "The robot does not have this joint.";
        return Err(fault(message.to_string()).key(below(key, "at_work")));
    }
    let key = below(key, "response");
    checks::count(own.response.len(), compliance.values.len(), &key)?;
    for (j, response) in own.response.iter().enumerate() {
        let key = || format!("{key}[{j}]");
        // Further terms may be angles.
        non_negative(Some(response.abs()), SOFTEST.max(LARGEST_LENGTH), key)?;
        let h = compliance.values[j];
        if let Some(change) = change.get(j).copied().flatten()
            && (h / (1.0 + change) - h - response).abs() > AGREEMENT * response.abs().max(1e-6 * h)
        {
            let message = "This is not what the change of the stiffness by this part says.";
            return Err(fault(message.to_string()).key(key()));
        }
    }
    Ok(())
}

/// Mean and covariance: a lower triangle.
fn moments(found: &SystematicPosterior, count: usize, key: &str) -> Result<()> {
    let at = |name: &str| below(key, name);
    let rows = &found.covariance;
    checks::triangle(rows, count, &at("covariance"))?;
    if found.mean.len() != count {
        let message = format!("{} means for {count} parts.", found.mean.len());
        return Err(fault(message).key(at("mean")));
    }
    for (i, mean) in found.mean.iter().enumerate() {
        let key = || format!("{}[{i}]", at("mean"));
        non_negative(Some(mean.abs()), MOST_TIMES, key)?;
    }
    for (i, row) in rows.iter().enumerate() {
        let key = || format!("{}[{i}][{i}]", at("covariance"));
        non_negative(Some(row[i]), MOST_TIMES, key)?;
    }
    let entry = |i: usize, k: usize| Some(rows[i.max(k)][i.min(k)] / MOST_TIMES);
    checks::not_negative(count, entry, SOFTEST, &at("covariance"))
}

/// The sum over all sources is that of the moments.
fn combined(
    found: &SystematicPosterior,
    budget: &SystematicErrors,
    compliance: &IdentifiedCompliance,
    key: &str,
) -> Result<()> {
    let sums = below(key, "combined");
    checks::count(budget.combined.len(), budget.joints.len(), &sums)?;
    let errors = found.common_errors();
    for (j, combined) in budget.combined.iter().enumerate() {
        let Some(combined) = combined else { continue };
        let own = DVector::from_fn(errors.parts.len(), |i, _| errors.parts[i].change[j]);
        let square = own.dot(&(&errors.covariance * &own)) + own.dot(&errors.mean).powi(2);
        let sum = square.max(0.0).sqrt() / compliance.values[j];
        if (sum - combined).abs() > AGREEMENT * sum.max(1e-6) {
            let message = "This is not what the parts and their covariance make of it.";
            return Err(fault(message.to_string()).key(format!("{sums}[{j}]")));
        }
    }
    Ok(())
}
