//! Whether results of one experiment after another agree in the joint stiffness.

use crate::report::WithCell;
use serde_json::Value;
use statrs::distribution::{ContinuousCDF, Normal};
use stiffarm::findings::visible;

/// By how much a joint stiffness differs from that of the first result.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct StiffnessChange {
    /// Name of the joint.
    pub joint: String,
    /// Place of the result among those that are compared; the first is 0.
    pub result: usize,
    /// Names of the first result and of this.
    pub names: [String; 2],
    /// Difference from the first result (fraction of its k), without its sign.
    pub change: f64,
    /// The difference that the errors of both leave open, on the same scale.
    pub allowed: f64,
}

impl StiffnessChange {
    /// Whether it is more than the errors of both explain.
    pub(super) fn is_beyond(&self) -> bool {
        self.change > self.allowed
    }
}

/// What a result says of a joint.
struct Joint {
    name: String,
    /// H \[rad/(N·m)\], whose estimate is normal; that of k is not.
    compliance: f64,
    /// Half width of its interval \[rad/(N·m)\].
    half_width: f64,
    has_stiffness: bool,
}

/// The joints of a result whose intervals are known: the lower end of k is 1/(H + half width).
fn joints(with: &WithCell<'_>) -> Vec<Joint> {
    let all = with.saved.json["result"]["joints"].as_array();
    let joints = all.into_iter().flatten().filter_map(|joint: &Value| {
        let compliance = joint["compliance"].as_f64()?;
        let low = joint["interval"][0].as_f64().filter(|low| *low > 0.0)?;
        Some(Joint {
            name: visible(joint["name"].as_str()?).into_owned(),
            compliance,
            half_width: 1.0 / low - compliance,
            has_stiffness: compliance > 0.0,
        })
    });
    joints.collect()
}

/// Every joint stiffness of further results against the first: |H_a − H_b| against √(w_a² + w_b²), the half width of
/// a difference of independent estimates, widened so that honest repeats of one experiment contradict each other as
/// rarely in any of these comparisons as a single one may by its confidence.
pub(super) fn changes(results: &[&WithCell<'_>]) -> Vec<StiffnessChange> {
    let Some((first, others)) = results.split_first() else {
        return Vec::new();
    };
    let first_joints = joints(first);
    let mut out = Vec::new();
    for (i, other) in others.iter().enumerate() {
        for joint in joints(other) {
            let Some(base) = first_joints.iter().find(|base| base.name == joint.name) else {
                continue;
            };
            if !(base.has_stiffness && joint.has_stiffness) {
                continue;
            }
            // |k_b − k_a|/k_a is |H_a − H_b|/H_b.
            let of_first = |compliance: f64| compliance / joint.compliance;
            out.push(StiffnessChange {
                joint: joint.name.clone(),
                result: i + 1,
                names: [first, other].map(|with| visible(&with.saved.name).into_owned()),
                change: of_first((base.compliance - joint.compliance).abs()),
                allowed: of_first(base.half_width.hypot(joint.half_width)),
            });
        }
    }
    let confidence = first.saved.json["result"]["confidence"].as_f64();
    let widening = widening(confidence.unwrap_or(0.95), out.len());
    out.iter_mut().for_each(|change| change.allowed *= widening);
    out
}

/// Half width at which any of `count` normal quantities lies beyond as rarely as one beyond its own half width, over
/// the latter (Bonferroni).
fn widening(confidence: f64, count: usize) -> f64 {
    let tail = 0.5 * (1.0 - confidence);
    let normal = Normal::standard();
    normal.inverse_cdf(tail / count.max(1) as f64) / normal.inverse_cdf(tail)
}
