//! An identification in sentences.

use crate::numbers::{mm, percent, significant, stiffness};
use crate::table::red;
use stiffarm::cell::Cell;
use stiffarm::findings::list;
use stiffarm::identify::{Identification, JointEstimate, NoiseSource, Verdict};
use stiffarm::measurement::MeasuredPosture;

/// |correlation| above which two joints cannot be told apart well.
const CORRELATED: f64 = 0.9;
/// Residuals this many times the expected noise hold more than noise.
const MORE_THAN_NOISE: f64 = 1.5;
/// Residuals this many times the expected noise hold mostly something else.
const FAR_MORE_THAN_NOISE: f64 = 4.0;

/// 95 for 0.95, without the last bits of a binary fraction.
pub fn confidence(fraction: f64) -> String {
    let text = format!("{:.6}", fraction * 100.0);
    text.trim_end_matches('0').trim_end_matches('.').to_string()
}

/// What was measured.
pub fn data(measured: &[MeasuredPosture], result: &Identification, excluded: &[String]) -> String {
    let displacements: usize = measured.iter().map(|m| m.displacements.len()).sum();
    let mut names: Vec<&str> = measured.iter().map(|m| m.posture.name.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    let mut line = format!(
        "data: {}, {} ({} components), {}",
        counted(names.len(), "posture"),
        counted(displacements, "displacement"),
        result.rows,
        match result.degrees_of_freedom {
            1 => "1 degree of freedom".to_string(),
            count => format!("{count} degrees of freedom"),
        }
    );
    if !excluded.is_empty() {
        line += &format!("; left out: {}", list(excluded));
    }
    line + "\n"
}

fn counted(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

/// Joints without information, named before any number.
pub fn undetermined(result: &Identification) -> String {
    if result.undetermined_joints.is_empty() {
        return String::new();
    }
    let said = format!(
        "These measurements cannot determine {}.",
        list(&result.undetermined_joints)
    );
    format!("{} `stiffarm check` looks for the reason.\n", red(&said))
}

/// What the numbers say.
pub fn verdicts(result: &Identification) -> Vec<String> {
    let mut out = vec![residual(result)];
    out.extend(
        result
            .joints
            .iter()
            .filter_map(|joint| trouble(joint, result.confidence)),
    );
    out.extend(weakest(result));
    out.extend(correlation(result));
    out
}

/// Residuals against displacements and against the expected noise.
fn residual(result: &Identification) -> String {
    let share = match result.displacement_rms_m {
        rms if rms > 0.0 => format!(" ({} %)", percent(result.residual_rms_m / rms)),
        _ => String::new(),
    };
    let mut text = format!(
        "Residual RMS {} mm, beside a displacement RMS of {} mm{share}.",
        mm(result.residual_rms_m),
        mm(result.displacement_rms_m)
    );
    let Some(std) = result.residual_std_m else {
        text += " There are no degrees of freedom left: nothing checks the model, and there are no intervals.";
        return text;
    };
    let expected = result.expected_std_m;
    if expected <= 0.0 {
        return text;
    }
    let ratio = std / expected;
    // Scatter of a standard deviation estimated from this many degrees of freedom.
    let scatter = 3.0 / (2.0 * result.degrees_of_freedom as f64).sqrt();
    let verdict = if ratio > FAR_MORE_THAN_NOISE {
        "far more than noise; the model, the load, the registration or the readings carry an error of that size"
    } else if ratio > MORE_THAN_NOISE.max(1.0 + scatter) {
        "more than noise; look at the model, the load, the registration and single postures"
    } else if ratio < (1.0 / MORE_THAN_NOISE).min(1.0 - scatter) {
        "less than expected; [noise] of the cell is set too high"
    } else {
        "what noise alone leaves"
    };
    text += &format!(
        " Its standard deviation is {} mm, {} times the {} mm expected from the cell's noise. That is {verdict}.",
        mm(std),
        significant(ratio, 2),
        mm(expected)
    );
    if result.noise == NoiseSource::Known && ratio > MORE_THAN_NOISE.max(1.0 + scatter) {
        text += " The intervals rest on the cell's noise and are too narrow.";
    }
    text
}

/// A joint whose estimate is not simply a number.
fn trouble(joint: &JointEstimate, level: f64) -> Option<String> {
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
        (Verdict::SignOrModelFault, _) => Some(red(&format!(
            "{}: its compliance comes out negative, beyond what noise explains. Check the sign of the force (on the \
             robot), the frames and the model.",
            joint.name
        ))),
        _ => None,
    }
}

/// The determined joint known least well.
fn weakest(result: &Identification) -> Option<String> {
    let half_width = |joint: &JointEstimate| {
        let [low, high] = joint.interval;
        let k = joint
            .stiffness
            .filter(|_| joint.verdict == Verdict::Determined)?;
        Some([1.0 - low? / k, high? / k - 1.0])
    };
    let joints = result
        .joints
        .iter()
        .filter_map(|joint| Some((joint, half_width(joint)?)));
    let (joint, [below, above]) = joints.max_by(|(_, a), (_, b)| a[1].total_cmp(&b[1]))?;
    let above = match above {
        part if part < 1.0 => format!("{} % above", percent(part)),
        _ => format!("{} times the estimate", significant(1.0 + above, 2)),
    };
    Some(format!(
        "Known least well: {}, {} N·m/rad, {} % below to {above} at {} % confidence.",
        joint.name,
        joint.stiffness.map(stiffness).unwrap_or_default(),
        percent(below),
        confidence(result.confidence)
    ))
}

/// The strongest correlation, if two joints are hard to tell apart.
fn correlation(result: &Identification) -> Option<String> {
    let pairs = result.correlation.iter().enumerate().flat_map(|(i, row)| {
        row.iter()
            .take(i)
            .enumerate()
            .filter_map(move |(j, r)| Some((i, j, (*r)?)))
    });
    let (i, j, r) = pairs.max_by(|a, b| a.2.abs().total_cmp(&b.2.abs()))?;
    (r.abs() > CORRELATED).then(|| {
        format!(
            "{} and {} are hard to tell apart: their estimates correlate with {r:.2}.",
            result.joints[j].name, result.joints[i].name
        )
    })
}

/// What the intervals do not hold, and postures that should not be here.
pub fn remarks(cell: &Cell, measured: &[MeasuredPosture], result: &Identification) -> Vec<String> {
    let mut out = Vec::new();
    let shared = measured.iter().any(|m| m.displacements.len() > 1);
    if shared && result.degrees_of_freedom > 0 {
        out.push(if cell.noise.posture_common_std > 0.0 {
            format!(
                "The points of a posture share a shift of {} mm by the cell's noise, and the intervals hold that. \
                 What else they share (the size of the load, geometry) is not in them.",
                mm(cell.noise.posture_common_std)
            )
        } else {
            "The intervals take the errors of all displacements as independent. What the points of one posture \
             share (load, rope, drift) is not in them; where there is such an error the intervals are too narrow. \
             noise.posture_common_mm of the cell can say how large it is."
                .to_string()
        });
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
