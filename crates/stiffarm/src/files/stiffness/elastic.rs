//! The elastic model of a saved stiffness.

use super::checks::{self, LARGEST_LENGTH, MOST_ROWS, SOFTEST, non_negative, same_name};
use super::errors;
use super::fault;
use super::keys::{self, below};
use crate::error::Result;
use crate::estimate::compliance::IdentifiedCompliance;
use crate::estimate::elastic::{Elastic, ElasticChoice};
use crate::estimate::identify::Estimates;
use crate::estimate::mixed::MixedResult;
use crate::model::cell::Cell;
use crate::model::elastic::ElasticClass;
use serde_json::Value;

/// Largest variance of the logarithm of a size; that before any reading is 1, which rounding may pass.
const LEAST_KNOWN: f64 = 1e3;

/// What predicts, where the file says that it is the mixed model.
///
/// # Errors
/// Keys that nobody reads, numbers that contradict each other or lie where no robot's can.
pub(super) fn mixed(
    value: &Value,
    key: &str,
    cell: &Cell,
    estimates: &Estimates,
) -> Result<Option<IdentifiedCompliance>> {
    if value.is_null() {
        return Ok(None);
    }
    keys::check(value, key, keys::ELASTIC)?;
    if !value["mixed"].is_null() {
        keys::check(&value["mixed"], &below(key, "mixed"), keys::MIXED)?;
    }
    let found: Elastic = serde_json::from_value(value.clone())
        .map_err(|e| fault(format!("The elastic model cannot be read: {e}.")).key(key))?;
    let mixed = match (found.model, found.mixed) {
        (ElasticChoice::Mixed, Some(mixed)) => mixed,
        (ElasticChoice::Axes, None) => return Ok(None),
        _ => {
            let message =
                "The values of the mixed model belong to the model \"mixed\", and it needs them.";
            return Err(fault(message.to_string()).key(below(key, "model")));
        }
    };
    let budget_key = below(key, "budget");
    let key = below(key, "mixed");
    values(&mixed, &key, cell)?;
    scatter(&mixed, &key, estimates)?;
    let compliance = mixed.compliance(estimates.confidence)?;
    let count = compliance.values.len();
    checks::triangle(&mixed.covariance, count, &below(&key, "covariance"))?;
    let entry = |i: usize, j: usize| Some(mixed.covariance[i.max(j)][i.min(j)]);
    checks::not_negative(count, entry, SOFTEST, &below(&key, "covariance"))?;
    checks::quantile(&compliance, &key)?;
    let budget = &value["budget"];
    if budget.is_null() {
        return Ok(Some(compliance));
    }
    errors::with_budget(compliance, budget, &budget_key, cell).map(Some)
}

/// Compliances of joints and springs.
fn values(mixed: &MixedResult, key: &str, cell: &Cell) -> Result<()> {
    let at = |name: &str| below(key, name);
    let names = cell.setup.robot.spring_names();
    checks::count(mixed.joints.len(), names.len(), &at("joints"))?;
    for (j, (joint, name)) in mixed.joints.iter().zip(&names).enumerate() {
        let key = format!("{}[{j}]", at("joints"));
        same_name(&joint.name, name, &below(&key, "name"))?;
        let h = joint.compliance;
        if h.is_none_or(|h| h.abs() > SOFTEST) {
            let message =
                format!("The mixed model needs a compliance of {name} that a joint can have.");
            return Err(fault(message).key(below(&key, "compliance")));
        }
        checks::spring(joint, &key)?;
        let variance = mixed.covariance.get(j).and_then(|row| row.get(j));
        if let (Some(variance), Some(error)) = (variance, joint.compliance_standard_error) {
            checks::same(
                variance.max(0.0).sqrt(),
                error,
                &below(&key, "compliance_standard_error"),
            )?;
        }
    }
    let places = cell.setup.robot.joint_count() + 1;
    if mixed.springs.len() != places {
        let message = format!("There must be {places} springs: the base, then joint by joint.");
        return Err(fault(message).key(at("springs")));
    }
    for (i, spring) in mixed.springs.iter().enumerate() {
        let key = format!("{}[{i}]", at("springs"));
        if spring.joint != (i > 0).then_some(i) {
            let message = "Springs stand in order: the base (null), then joint by joint.";
            return Err(fault(message.to_string()).key(below(&key, "joint")));
        }
        entries(&spring.compliance, i > 0, &below(&key, "compliance"))?;
    }
    Ok(())
}

/// A symmetric compliance; that of a joint without its axis.
fn entries(compliance: &[[f64; 6]; 6], is_joint: bool, key: &str) -> Result<()> {
    for row in 0..6 {
        for column in 0..6 {
            let value = compliance[row][column];
            let key = || format!("{key}[{row}][{column}]");
            non_negative(Some(value.abs()), SOFTEST, key)?;
            let mirrored = compliance[column][row];
            if (value - mirrored).abs() > 1e-9 * value.abs().max(mirrored.abs()) {
                let message = "A compliance is the same on both sides of its diagonal.";
                return Err(fault(message.to_string()).key(key()));
            }
        }
    }
    if is_joint && compliance[5][5] != 0.0 {
        let message = "The joint's own axis stands among the joints, not here: this must be 0.";
        return Err(fault(message.to_string()).key(format!("{key}[5][5]")));
    }
    Ok(())
}

/// Noise and its degrees of freedom.
fn scatter(mixed: &MixedResult, key: &str, estimates: &Estimates) -> Result<()> {
    let at = |name: &str| below(key, name);
    for (name, value) in [
        ("residual_std_m", mixed.residual_std_m),
        ("posture_common_std_m", mixed.posture_common_std_m),
    ] {
        non_negative(Some(value), LARGEST_LENGTH, || at(name))?;
    }
    let most = estimates.rows.min(MOST_ROWS);
    let rows = &mixed.size_covariance;
    if !rows.is_empty() {
        let count = 1 + ElasticClass::ALL.len();
        checks::triangle(rows, count, &at("size_covariance"))?;
        let entry = |i: usize, j: usize| Some(rows[i.max(j)][i.min(j)]);
        checks::not_negative(count, entry, LEAST_KNOWN, &at("size_covariance"))?;
    }
    match mixed.interval_degrees_of_freedom {
        Some(dof) if dof == 0 || dof > most => {
            let message = format!("{dof} degrees of freedom cannot come from {most} rows.");
            Err(fault(message).key(at("interval_degrees_of_freedom")))
        }
        _ => Ok(()),
    }
}
