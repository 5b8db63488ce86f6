//! Estimates that agree with each other and lie where a robot's can.

use super::keys::below;
use super::{fault, interval};
use crate::error::Result;
use crate::estimate::compliance::IdentifiedCompliance;
use crate::estimate::identify::{
    AngleEstimate, Estimates, JointEstimate, NoiseSource, Verdict, quantile as of,
};
use crate::files::names::fault_of;
use crate::model::cell::Cell;
use crate::model::observation::ExtraTerm;
use nalgebra::{DMatrix, SymmetricEigen};
use serde_json::Value;

/// No joint of a robot gives way by more \[rad/(N·m)\]: a radian under the
/// weight of a bar of chocolate held a metre away.
pub(super) const SOFTEST: f64 = 1.0;

/// No joint is stiffer \[N·m/rad\]; the stiffest of industrial robots have 1e8.
const STIFFEST: f64 = 1e15;

/// Largest angle of a lost motion \[rad\].
const LARGEST_LOST_MOTION: f64 = 1.0;

/// Largest displacement and scatter of displacements \[m\]: what a table may hold, a fit
/// may have seen and `identify` saved.
pub(super) const LARGEST_LENGTH: f64 = 1e3;

/// Values that say the same twice may differ by this part: by hand one writes
/// four digits.
pub(super) const AGREEMENT: f64 = 1e-3;

/// No experiment has more rows, nor degrees of freedom.
pub(super) const MOST_ROWS: usize = 1_000_000_000;

/// Eigenvalues of a correlation matrix may be below zero by this, from rounding.
const ROUNDING: f64 = 1e-6;

/// As many values as joints.
pub(super) fn count(found: usize, joints: usize, key: &str) -> Result<()> {
    if found == joints {
        return Ok(());
    }
    let message = format!("{found} stiffness values for the {joints} joints of the cell.");
    Err(fault(message).key(key))
}

/// The name that the cell has, too.
pub(super) fn same_name(found: &str, name: &str, key: &str) -> Result<()> {
    if found == name {
        return Ok(());
    }
    let message = format!(
        "The file has \"{found}\" where the cell has \"{name}\": it belongs to another robot."
    );
    Err(fault(message).key(key))
}

/// A joint's stiffness: above zero, and one that a joint can have.
pub(super) fn stiffness(k: f64, name: &str, key: &str) -> Result<()> {
    if k.is_nan() || k <= 0.0 {
        let message = format!("The stiffness of {name} is {k}; it must be above zero.");
        return Err(fault(message).key(key));
    }
    if !(1.0 / SOFTEST..=STIFFEST).contains(&k) {
        let message = format!(
            "The stiffness of {name} is {k:e} N·m/rad, which no joint has: it must lie between {:e} and {STIFFEST:e}.",
            1.0 / SOFTEST
        );
        return Err(fault(message).key(key));
    }
    Ok(())
}

/// k = 1/H, but for rounding.
pub(super) fn agree(k: f64, h: f64, key: &str) -> Result<()> {
    if (k * h - 1.0).abs() <= AGREEMENT {
        return Ok(());
    }
    let message = format!(
        "The compliance {h:e} rad/(N·m) and the stiffness {k:e} N·m/rad of the same joint contradict each other; one must be 1 divided by the other."
    );
    Err(fault(message)
        .key(key)
        .hint("identify again, or give the stiffness alone: {\"stiffness_nm_per_rad\": [k1, …]}"))
}

/// A number, `null` or nothing.
pub(super) fn optional_number(value: &Value, name: &str, key: &str) -> Result<Option<f64>> {
    match &value[name] {
        Value::Null => Ok(None),
        Value::Number(number) if number.as_f64().is_some() => Ok(number.as_f64()),
        other => {
            let error = fault(format!("{other} is not a number."));
            Err(error.key(below(key, name)))
        }
    }
}

/// A number from 0 to `largest`.
pub(super) fn non_negative(
    value: Option<f64>,
    largest: f64,
    key: impl Fn() -> String,
) -> Result<()> {
    match value {
        Some(value) if !(0.0..=largest).contains(&value) => {
            let message = format!("This is {value:e}; it must lie between 0 and {largest:e}.");
            Err(fault(message).key(key()))
        }
        _ => Ok(()),
    }
}

/// The scatter that a fit saw \[m\].
pub(super) fn scatter(result: &Value, name: &str, key: &str) -> Result<Option<f64>> {
    let value = optional_number(result, name, key)?;
    non_negative(value, LARGEST_LENGTH, || below(key, name))?;
    Ok(value)
}

/// Names of the postures, and the largest displacement of one \[m\].
pub(super) fn postures(result: &Value, key: &str) -> Result<(Vec<String>, Option<f64>)> {
    let list = below(key, "postures");
    let postures = match &result["postures"] {
        Value::Null => &[][..],
        Value::Array(postures) => postures.as_slice(),
        _ => return Err(fault("This is not a list.".to_string()).key(list)),
    };
    let mut names = Vec::with_capacity(postures.len());
    let mut largest: Option<f64> = None;
    for (i, posture) in postures.iter().enumerate() {
        let key = format!("{list}[{i}]");
        let Some(name) = posture["posture"].as_str() else {
            let error = fault("The posture has no name.".to_string());
            return Err(error.key(below(&key, "posture")));
        };
        if let Some(wrong) = fault_of(name) {
            return Err(fault(wrong.to_string()).key(below(&key, "posture")));
        }
        names.push(name.to_string());
        if let Some(rms) = scatter(posture, "displacement_rms_m", &key)? {
            largest = Some(largest.map_or(rms, |most| most.max(rms)));
        }
    }
    Ok((names, largest))
}

/// Reads each estimate alone, so that an error knows its place.
pub(super) fn joints_readable(result: &Value, key: &str) -> Result<()> {
    for name in ["joints", "extra_springs"] {
        let items = result[name].as_array().into_iter().flatten();
        for (i, item) in items.enumerate() {
            serde_json::from_value::<JointEstimate>(item.clone()).map_err(|e| {
                let error = fault(format!("The estimate cannot be read: {e}."));
                error.key(format!("{}[{i}]", below(key, name)))
            })?;
        }
    }
    Ok(())
}

/// Everything that is calculated with.
pub(super) fn estimates(found: &Estimates, cell: &Cell, key: &str) -> Result<()> {
    let robot = &cell.setup.robot;
    let at = |name: &str| below(key, name);
    let mut names = robot.spring_names();
    count(found.joints.len(), names.len(), &at("joints"))?;
    for (j, (joint, name)) in found.joints.iter().zip(&names).enumerate() {
        let key = format!("{}[{j}]", at("joints"));
        same_name(&joint.name, name, &below(&key, "name"))?;
        has_stiffness(joint, &key)?;
        spring(joint, &key)?;
    }
    further(found, cell, key)?;
    names.extend(found.extra.iter().map(|term| term.name(robot)));
    if found.unknowns != names {
        let message = format!("The unknowns must be {}.", names.join(", "));
        return Err(fault(message).key(at("unknowns")));
    }
    let errors: Vec<Option<f64>> =
        in_order(found, |s| s.compliance_standard_error, |a| a.standard_error);
    covariance(found, &errors, &at("covariance"))?;
    if !(found.confidence > 0.0 && found.confidence < 1.0) {
        let message = format!(
            "The confidence is {}; it must lie between 0 and 1.",
            found.confidence
        );
        let error = fault(message).key(at("confidence"));
        return Err(match (1.0..100.0).contains(&found.confidence) {
            true => error.hint("95 % is 0.95"),
            false => error,
        });
    }
    if found.rows > MOST_ROWS || found.degrees_of_freedom > found.rows {
        let message = format!(
            "{} degrees of freedom cannot come from {} rows.",
            found.degrees_of_freedom, found.rows
        );
        return Err(fault(message).key(at("degrees_of_freedom")));
    }
    let has_intervals = found.joints.iter().any(|j| j.interval[0].is_some());
    match found.interval_degrees_of_freedom {
        Some(0) if has_intervals => {
            let message = "Intervals without a degree of freedom: they contradict each other.";
            Err(fault(message.to_string()).key(at("interval_degrees_of_freedom")))
        }
        // Repeated readings have degrees of freedom of their own.
        Some(dof)
            if dof > MOST_ROWS || (found.noise != NoiseSource::Repeats && dof > found.rows) =>
        {
            let message = format!(
                "{dof} degrees of freedom cannot come from {} rows.",
                found.rows
            );
            Err(fault(message).key(at("interval_degrees_of_freedom")))
        }
        _ => Ok(()),
    }
}

/// One value of each unknown, in the order of the covariance.
fn in_order(
    found: &Estimates,
    of_spring: impl Fn(&JointEstimate) -> Option<f64>,
    of_angle: impl Fn(&AngleEstimate) -> Option<f64>,
) -> Vec<Option<f64>> {
    let mut out: Vec<Option<f64>> = found.joints.iter().map(&of_spring).collect();
    let mut springs = found.extra_springs.iter();
    let mut angles = found.lost_motion.iter();
    out.extend(found.extra.iter().map(|term| match term.is_spring() {
        true => springs.next().and_then(&of_spring),
        false => angles.next().and_then(&of_angle),
    }));
    out
}

/// A joint must have a stiffness; if not, why it has none.
fn has_stiffness(joint: &JointEstimate, key: &str) -> Result<()> {
    let name = &joint.name;
    let Some(k) = joint.stiffness else {
        let why = match joint.verdict {
            Verdict::Undetermined => ": the measurements did not determine it",
            Verdict::LowerBoundOnly => ": the measurements gave only a lower bound",
            Verdict::SignOrModelFault => ": its compliance came out negative",
            _ => "",
        };
        let error = fault(format!("The file has no stiffness of {name}{why}."));
        return Err(error.key(below(key, "stiffness")).hint(
            "nothing can be calculated without it: measure postures that load the joint, or identify with --estimator prior",
        ));
    };
    stiffness(k, name, &below(key, "stiffness"))
}

/// One spring against itself.
pub(super) fn spring(spring: &JointEstimate, key: &str) -> Result<()> {
    let at = |name: &str| below(key, name);
    if let Some(h) = spring.compliance
        && h.abs() > SOFTEST
    {
        let message = format!("The compliance is {h:e} rad/(N·m), which no joint has.");
        return Err(fault(message).key(at("compliance")));
    }
    match (spring.stiffness, spring.compliance) {
        (Some(k), Some(h)) => agree(k, h, &at("compliance"))?,
        (Some(_), None) => {
            let message = "A stiffness without a compliance: they contradict each other.";
            return Err(fault(message.to_string()).key(at("compliance")));
        }
        (None, _) => {}
    }
    let error = spring.compliance_standard_error;
    non_negative(error, SOFTEST, || at("compliance_standard_error"))?;
    non_negative(spring.standard_error, f64::MAX, || at("standard_error"))?;
    if let (Some(of_k), Some(of_h), Some(h)) = (spring.standard_error, error, spring.compliance) {
        same(of_k * h * h, of_h, &at("standard_error"))?;
    }
    interval::check(spring, &at("interval"))
}

/// The further terms: as many estimates as terms, of joints that there are.
fn further(found: &Estimates, cell: &Cell, key: &str) -> Result<()> {
    let robot = &cell.setup.robot;
    let at = |name: &str| below(key, name);
    for (i, term) in found.extra.iter().enumerate() {
        let unknown = !term.fits(robot.joint_count());
        if unknown || found.extra[..i].contains(term) {
            let message = match unknown {
                true => format!(
                    "The robot has {} joints, and springs have entries 0 to 5.",
                    robot.joint_count()
                ),
                false => "The term appears twice.".to_string(),
            };
            return Err(fault(message).key(format!("{}[{i}]", at("extra"))));
        }
    }
    let (springs, lost): (Vec<ExtraTerm>, Vec<ExtraTerm>) =
        found.extra.iter().partition(|term| term.is_spring());
    let lists = [
        ("extra_springs", found.extra_springs.len(), springs.len()),
        ("lost_motion", found.lost_motion.len(), lost.len()),
    ];
    for (name, have, want) in lists {
        if have != want {
            let message = format!("{have} estimates for {want} further terms of this kind.");
            return Err(fault(message).key(at(name)));
        }
    }
    for (i, (estimate, term)) in found.extra_springs.iter().zip(&springs).enumerate() {
        let key = format!("{}[{i}]", at("extra_springs"));
        same_name(&estimate.name, &term.name(robot), &below(&key, "name"))?;
        spring(estimate, &key)?;
        if estimate.verdict == Verdict::SignOrModelFault {
            let message = format!(
                "The compliance of the {} is negative beyond what noise explains.",
                estimate.name
            );
            return Err(fault(message)
                .key(below(&key, "verdict"))
                .hint("identify without this term"));
        }
    }
    for (i, (estimate, term)) in found.lost_motion.iter().zip(&lost).enumerate() {
        let key = format!("{}[{i}]", at("lost_motion"));
        same_name(&estimate.name, &term.name(robot), &below(&key, "name"))?;
        let size = estimate.angle.map(f64::abs);
        non_negative(size, LARGEST_LOST_MOTION, || below(&key, "angle"))?;
        non_negative(estimate.standard_error, LARGEST_LOST_MOTION, || {
            below(&key, "standard_error")
        })?;
    }
    Ok(())
}

/// A covariance with the standard errors on its diagonal, or none at all.
fn covariance(found: &Estimates, errors: &[Option<f64>], key: &str) -> Result<()> {
    let (rows, count) = (&found.covariance, errors.len());
    if rows.len() != count || rows.iter().any(|row| row.len() != count) {
        let message = format!("The covariance must have {count} rows of {count} values.");
        return Err(fault(message).key(key));
    }
    if rows.iter().flatten().all(Option::is_none) {
        return Ok(());
    }
    for (j, error) in errors.iter().enumerate() {
        let key = format!("{key}[{j}][{j}]");
        let variance = rows[j][j];
        non_negative(variance, SOFTEST, || key.clone())?;
        if let (Some(variance), Some(error)) = (variance, error) {
            same(variance.sqrt(), *error, &key)?;
        }
    }
    not_negative(count, |i, j| rows[i][j], SOFTEST, key)
}

/// A covariance that is symmetric, gives no combination a variance below zero, and has none above `largest`.
pub(super) fn not_negative(
    count: usize,
    entry: impl Fn(usize, usize) -> Option<f64>,
    largest: f64,
    key: &str,
) -> Result<()> {
    let mut scale = Vec::with_capacity(count);
    for j in 0..count {
        let variance = entry(j, j);
        non_negative(variance, largest, || format!("{key}[{j}][{j}]"))?;
        scale.push(variance.map(f64::sqrt));
    }
    let mut correlation = DMatrix::zeros(count, count);
    for i in 0..count {
        for j in 0..count {
            let key = || format!("{key}[{i}][{j}]");
            let (Some(value), Some(mirrored)) = (entry(i, j), entry(j, i)) else {
                let message = "A covariance with values must have all of them.";
                return Err(fault(message.to_string()).key(key()));
            };
            let size = scale[i].zip(scale[j]).map_or(0.0, |(a, b)| a * b);
            if (value - mirrored).abs() > AGREEMENT * size {
                let message = "The covariance must be the same on both sides of its diagonal.";
                return Err(fault(message.to_string()).key(key()));
            }
            if value.abs() > size * (1.0 + AGREEMENT) {
                let message = format!("The covariance {value:e} is beyond a correlation of ±1.");
                return Err(fault(message).key(key()));
            }
            correlation[(i, j)] = if size > 0.0 { value / size } else { 0.0 };
        }
    }
    let smallest = SymmetricEigen::new(correlation).eigenvalues.min();
    if smallest < -ROUNDING {
        let message =
            "The covariance gives some combination of the unknowns a variance below zero.";
        return Err(fault(message.to_string()).key(key));
    }
    Ok(())
}

/// A covariance is a lower triangle of `count` rows.
pub(super) fn triangle(rows: &[Vec<f64>], count: usize, key: &str) -> Result<()> {
    let fits = rows.iter().enumerate().all(|(i, row)| row.len() == i + 1);
    if rows.len() == count && fits {
        return Ok(());
    }
    let message = format!("The covariance must be a lower triangle of {count} rows.");
    Err(fault(message).key(key))
}

/// Two values that say the same.
pub(super) fn same(a: f64, b: f64, key: &str) -> Result<()> {
    if (a - b).abs() <= AGREEMENT * a.abs().max(b.abs()) {
        return Ok(());
    }
    let message = format!(
        "The standard error contradicts the covariance or the compliance: {a:e} against {b:e}."
    );
    Err(fault(message).key(key))
}

/// Bands must be finite.
pub(super) fn quantile(compliance: &IdentifiedCompliance, key: &str) -> Result<()> {
    let Some(spread) = &compliance.spread else {
        return Ok(());
    };
    match of(spread.degrees_of_freedom, spread.confidence) {
        Ok(value) if value.is_finite() => Ok(()),
        _ => {
            let message = format!(
                "Intervals of confidence {} have no end with these degrees of freedom.",
                spread.confidence
            );
            Err(fault(message).key(below(key, "confidence")))
        }
    }
}
