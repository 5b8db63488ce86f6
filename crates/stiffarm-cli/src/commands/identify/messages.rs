//! An identification in sentences.

use super::readings::marked;
use crate::numbers::{mm, percent, significant, stiffness};
use crate::table::{red, serious, yellow};
use stiffarm::estimate::coverage::{Intervals, MeasuredCoverage, measured};
use stiffarm::estimate::identified::Identified;
use stiffarm::estimate::identify::{
    CollinearSet, Estimates, Estimator, Identification, JointEstimate, NoiseSource, Verdict,
};
use stiffarm::findings::list;
use stiffarm::model::cell::Cell;
use stiffarm::model::measurement::MeasuredPosture;

/// Residuals this many times the expected noise hold more than noise.
const MORE_THAN_NOISE: f64 = 1.5;

/// 95 for 0.95, without the last bits of a binary fraction.
pub fn confidence(fraction: f64) -> String {
    let text = format!("{:.6}", fraction * 100.0);
    text.trim_end_matches('0').trim_end_matches('.').to_string()
}

/// What was measured, and how the stiffness comes from it.
pub fn data(measured: &[MeasuredPosture], result: &Identification, excluded: &[String]) -> String {
    let displacements: usize = measured.iter().map(|m| m.displacements.len()).sum();
    let mut names: Vec<&str> = measured.iter().map(|m| m.posture.name.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    let mut line = format!(
        "data: {}, {} ({} components)",
        counted(names.len(), "posture"),
        counted(displacements, "displacement"),
        result.estimates.rows,
    );
    if !excluded.is_empty() {
        line += &format!("; left out: {}", list(excluded));
    }
    let quantile = match result.estimates.interval_degrees_of_freedom {
        None => "the cell's noise, normal quantiles".to_string(),
        Some(1) => "t with 1 degree of freedom".to_string(),
        Some(dof) => format!("t with {dof} degrees of freedom"),
    };
    line + &format!(
        "\nestimator: {}, {}, {quantile}\n",
        result.estimates.estimator.as_str(),
        match result.estimates.degrees_of_freedom {
            1 => "1 degree of freedom left".to_string(),
            count => format!("{count} degrees of freedom left"),
        }
    )
}

pub use crate::numbers::counted;

/// Joints without information, named before any number.
pub fn undetermined(names: &[String], combined: bool) -> String {
    if names.is_empty() {
        return String::new();
    }
    let said = format!("These measurements cannot determine {}.", list(names));
    let rest = match combined {
        false => "`stiffarm check` looks for the reason.",
        true => {
            "What they determine together stands below the joints; `stiffarm check` looks for the reason."
        }
    };
    format!("{} {rest}\n", serious(&said))
}

/// Joints that the data tell apart only together, named before any number.
pub fn collinear(sets: &[CollinearSet]) -> String {
    let mut out = String::new();
    for set in sets {
        let determined = match set.determined {
            1 => "only one combination of them is".to_string(),
            count => format!("only {count} combinations of them are"),
        };
        let said = format!(
            "These measurements hardly tell {} apart: their columns are nearly collinear, {determined} determined.",
            list(&set.unknowns)
        );
        out += &format!(
            "{}: {said} Their single values below mean nothing; other postures or loads would separate them.\n",
            yellow("caution")
        );
    }
    out
}

/// Names what the user did not wait for.
pub fn stopped(not_computed: &[String]) -> String {
    if not_computed.is_empty() {
        return String::new();
    }
    let words = |name: &String| match name.as_str() {
        "bootstrap" => "the bootstrap intervals",
        "elastic" => "what gives way beyond the joint axes",
        "profile" => "the profile of the likelihood",
        "budget" => "the errors common to the whole experiment",
        "diagnosis" => "the diagnosis (readings that do not fit, leave-one-out, further terms)",
        _ => "the next posture",
    };
    let names: Vec<&str> = not_computed.iter().map(words).collect();
    let said = format!("Stopped: {} not computed.", are(&names));
    format!(
        "{} The estimates and their intervals are complete.\n",
        red(&said)
    )
}

/// The names with the verb that follows them.
fn are(names: &[&str]) -> String {
    format!(
        "{} {}",
        list(names),
        if names.len() == 1 { "was" } else { "were" }
    )
}

/// What the numbers say.
pub fn verdicts(result: &Identified) -> Vec<String> {
    let found = &result.identification;
    let mut out = Vec::from_iter(variances(found));
    out.extend(estimates(&found.estimates));
    out.extend(coverage(result));
    out.extend(resampled(result));
    let findings = result
        .diagnosis
        .iter()
        .flat_map(|d| &d.findings)
        .chain(result.budget.iter().flat_map(|b| &b.findings))
        .chain(result.profile.iter().map(|p| &p.finding));
    out.extend(findings.map(|f| marked(f).trim_end().to_string()));
    out
}

/// What the estimates say, whatever they come from.
pub fn estimates(result: &Estimates) -> Vec<String> {
    let joints = result.joints.iter().chain(&result.extra_springs);
    let mut out: Vec<String> = joints
        .filter_map(|joint| trouble(joint, result.confidence))
        .collect();
    out.extend(weakest(&result.joints, result.confidence));
    out
}

/// Residuals beside displacements.
pub(super) fn residual(result: &Identification) -> String {
    let share = match result.displacement_rms_m {
        rms if rms > 0.0 => format!(" ({} %)", percent(result.residual_rms_m / rms)),
        _ => String::new(),
    };
    let mut text = format!(
        "Residual RMS {} mm, beside a displacement RMS of {} mm{share}.",
        mm(result.residual_rms_m),
        mm(result.displacement_rms_m)
    );
    if result.residual_std_m.is_none() {
        text += " There are no degrees of freedom left: nothing checks the model, and there are no intervals.";
    }
    if let (NoiseSource::Known, Some(total)) = (result.estimates.noise, result.total_std_m)
        && result.expected_std_m > 0.0
        && total > MORE_THAN_NOISE * result.expected_std_m
    {
        text += " The intervals rest on the cell's noise and are too narrow.";
    }
    text
}

/// The two variances, where both were estimated.
fn variances(result: &Identification) -> Option<String> {
    let (sigma, tau) = (result.residual_std_m?, result.posture_common_std_m?);
    Some(match tau > 0.0 {
        true => format!(
            "Within a posture the displacements scatter by {} mm; what its points share (load, rope, drift, what the \
             model misses) by {} mm.",
            mm(sigma),
            mm(tau)
        ),
        false => format!(
            "The displacements scatter by {} mm; nothing shows that the points of a posture share more than that.",
            mm(sigma)
        ),
    })
}

/// A joint whose estimate is not simply a number.
pub(super) fn trouble(joint: &JointEstimate, level: f64) -> Option<String> {
    match (joint.verdict, joint.interval[0]) {
        (Verdict::LowerBoundOnly, Some(low)) => Some(format!(
            "{}: the data give only a lower bound, k above {} N·m/rad ({} %).",
            joint.name,
            stiffness(low),
            confidence(level)
        )),
        (Verdict::NoInterval, _) => Some(format!(
            "{}: no interval, because the data leave no degree of freedom to judge the noise, or show no deflection.",
            joint.name
        )),
        (Verdict::SignOrModelFault, _) => Some(serious(&format!(
            "{}: its compliance comes out negative, beyond what noise explains. Check the sign of the force (on the \
             robot), the frames and the model.",
            joint.name
        ))),
        _ => None,
    }
}

/// The joints known least well: those without a closed interval, else the one
/// whose interval reaches furthest. `None` where no joint has a closed one: each
/// is named by itself then.
fn weakest(joints: &[JointEstimate], level: f64) -> Option<String> {
    let half_width = |joint: &JointEstimate| {
        let [low, high] = joint.interval;
        let k = joint.stiffness?;
        Some([1.0 - low? / k, high? / k - 1.0])
    };
    let closed = joints
        .iter()
        .filter_map(|joint| Some((joint, half_width(joint)?)));
    let (joint, [below, above]) = closed.max_by(|(_, a), (_, b)| a[1].total_cmp(&b[1]))?;
    let open: Vec<&str> = joints
        .iter()
        .filter(|joint| half_width(joint).is_none())
        .map(|joint| joint.name.as_str())
        .collect();
    let first = match open.len() {
        0 => String::new(),
        1 => format!("{}, without a closed interval; then ", open[0]),
        _ => format!("{}, without closed intervals; then ", list(&open)),
    };
    let above = match above {
        part if part < 1.0 => format!("{} % above", percent(part)),
        _ => format!("{} times the estimate", significant(1.0 + above, 2)),
    };
    Some(format!(
        "Known least well: {first}{}, {} N·m/rad, {} % below to {above} at {} % confidence.",
        joint.name,
        joint.stiffness.map(stiffness).unwrap_or_default(),
        percent(below),
        confidence(level)
    ))
}

/// How often intervals that are not exact held the truth in simulation.
fn coverage(result: &Identified) -> Option<String> {
    let found = &result.identification;
    Intervals::of(found.estimates.estimator)?;
    let dof = found.estimates.interval_degrees_of_freedom?;
    let name = format!("the {} estimator", found.estimates.estimator.as_str());
    Some(held(&name, dof, result.measured_coverage.as_ref()))
}

/// The bootstrap, with what it covers and what it skipped.
pub(super) fn resampled(result: &Identified) -> Option<String> {
    let bootstrap = result.bootstrap.as_ref()?;
    let mut text = format!(
        "Bootstrap: {} resamples of {} postures",
        bootstrap.resamples, bootstrap.postures
    );
    if bootstrap.skipped > 0 {
        text += &format!(
            ", {} of them skipped because they do not determine every joint",
            bootstrap.skipped
        );
    }
    let dof = bootstrap.degrees_of_freedom;
    let measured = measured(Intervals::Bootstrap, dof);
    Some(format!(
        "{text}. {}",
        held("the bootstrap", dof, measured.as_ref())
    ))
}

fn held(name: &str, dof: usize, measured: Option<&MeasuredCoverage>) -> String {
    let Some(measured) = measured else {
        return format!(
            "How often intervals of {name} hold the truth with {dof} degrees of freedom was not measured: no coverage \
             is claimed (docs/coverage.md)."
        );
    };
    let mut text = format!(
        "In simulation the 95 % intervals of {name} held the truth in {} ± {} % ({} experiments, {} degrees of freedom)",
        percent(measured.coverage),
        percent(measured.standard_error),
        measured.experiments,
        measured.degrees_of_freedom
    );
    for adverse in &measured.adverse {
        text += &format!("; {}: {} %", adverse.situation, percent(adverse.coverage));
    }
    text + " (docs/coverage.md)."
}

/// What the intervals do not hold, and postures that should not be here.
pub fn remarks(cell: &Cell, measured: &[MeasuredPosture], result: &Identified) -> Vec<String> {
    let found = &result.identification;
    let mut out = Vec::new();
    let shared = measured.iter().any(|m| m.displacements.len() > 1);
    if shared && found.estimates.degrees_of_freedom > 0 && found.estimates.independent_rows {
        out.push(independent(cell, found));
    }
    let mut kept: Vec<&str> = measured
        .iter()
        .map(|m| m.posture.name.as_str())
        .filter(|name| cell.validation.iter().any(|v| v.name == *name))
        .collect();
    kept.dedup();
    if !kept.is_empty() {
        out.push(format!(
            "{} of the cell's [validation] took part in this identification; leave out with --exclude {}.",
            list(&kept),
            kept.join(",")
        ));
    }
    out
}

/// What a posture's points share and an estimator with independent rows ignores.
fn independent(cell: &Cell, found: &Identification) -> String {
    let declared = cell.noise.posture_common_std;
    match found.estimates.estimator {
        Estimator::Weighted if declared > 0.0 => format!(
            "The points of a posture share a shift of {} mm by the cell's noise, and the intervals hold that. \
             What else they share (the size of the load, geometry) is not in them.",
            mm(declared)
        ),
        Estimator::Ordinary | Estimator::Weighted | Estimator::Huber => {
            "The intervals take the errors of all displacements as independent. Where the points of a posture share one \
             (load, rope, drift) they are too narrow; --estimator two-variance holds that."
                .to_string()
        }
        _ => "There are too few postures to tell what their points share: the intervals take the errors of all \
              displacements as independent, and are too narrow where they are not."
            .to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stiffarm::estimate::identify::IntervalHolds;

    fn joint(
        name: &str,
        k: Option<f64>,
        interval: [Option<f64>; 2],
        verdict: Verdict,
    ) -> JointEstimate {
        JointEstimate {
            name: name.to_string(),
            stiffness: k,
            half_width: None,
            standard_error: None,
            interval,
            interval_holds: IntervalHolds::Readings,
            readings_standard_error: None,
            readings_interval: interval,
            compliance: k.map(|k| 1.0 / k),
            compliance_standard_error: None,
            determined: k.is_some(),
            verdict,
        }
    }

    #[test]
    fn joints_without_a_closed_interval_are_known_least_well() {
        let closed = |name, high| {
            let ends = [Some(9e5), Some(high)];
            joint(name, Some(1e6), ends, Verdict::Determined)
        };
        let mut joints = vec![closed("joint 1", 1.1e6), closed("joint 2", 1.4e6)];
        let said = weakest(&joints, 0.95).unwrap();
        assert!(
            said.starts_with("Known least well: joint 2, 1.000e6 N·m/rad"),
            "{said}"
        );
        joints.push(joint(
            "joint 3",
            Some(2e5),
            [Some(1e5), None],
            Verdict::LowerBoundOnly,
        ));
        let said = weakest(&joints, 0.95).unwrap();
        let expected =
            "Known least well: joint 3, without a closed interval; then joint 2, 1.000e6 N·m/rad";
        assert!(said.starts_with(expected), "{said}");
        joints.push(joint("joint 4", None, [None, None], Verdict::Undetermined));
        let said = weakest(&joints, 0.95).unwrap();
        let expected =
            "Known least well: joint 3 and joint 4, without closed intervals; then joint 2";
        assert!(said.starts_with(expected), "{said}");
        assert_eq!(weakest(&joints[2..], 0.95), None);
    }
}
