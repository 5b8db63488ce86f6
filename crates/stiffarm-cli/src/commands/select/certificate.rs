//! How good any plan of as many postures could be, in words.

use super::job::shown;
use crate::numbers::{percent, significant};
use stiffarm::Termination;
use stiffarm::findings::list;
use stiffarm::plan::certificate::{Certificate, JointEfficiency};

/// The certificate as one plain sentence.
pub fn sentence(found: &Certificate, chosen_load: bool) -> String {
    let count = found.posture_count;
    let bound = shown(found.index, found.bound);
    let noun = if count == 1 { "posture" } else { "postures" };
    let load = if chosen_load { " with this load" } else { "" };
    let index = found.index.as_str();
    let mut out = match found.measured_count {
        0 => format!("certificate: no {count} {noun}{load} can have {index} below {bound}; "),
        _ => format!("certificate: no {count} further {noun} can bring {index} below {bound}; "),
    };
    out += &match found.efficiency {
        Some(efficiency) => format!("this plan is {} efficient", efficient(efficiency)),
        None if found.outside.is_empty() => "this plan has no value".to_string(),
        None => {
            let outside: Vec<String> = found.outside.iter().map(ToString::to_string).collect();
            format!(
                "nothing is said of this plan, for its posture {} lies outside bounds or limits",
                outside.join(", ")
            )
        }
    };
    out += &format!(
        " (equivalence residual {}{}; the bound rests on {} searches for a posture that helps more, {} of which \
         ended at the same best{})\n",
        significant(found.residual, 2),
        match found.termination {
            Termination::Converged => "",
            _ => ", not converged",
        },
        found.verification.searches,
        found.verification.agreeing,
        found
            .verification
            .doubt()
            .map_or_else(String::new, |doubt| format!("; {doubt}"))
    );
    out
}

/// An efficiency in percent; never rounded up to all there is.
pub fn efficient(efficiency: f64) -> String {
    let percent = 100.0 * efficiency;
    match (99.95..100.0).contains(&percent) {
        true => "> 99.9 %".to_string(),
        false => format!("{percent:.1} %"),
    }
}

/// The joints whose bound is looser than the tolerance, with how much higher a
/// tight one could be at most; empty where there is none.
pub fn loose(joints: &[JointEfficiency]) -> String {
    let loose: Vec<String> = joints
        .iter()
        .filter(|joint| joint.termination != Termination::Converged)
        .map(|joint| {
            // The bound is a root: 1/(1 + residual) of its square is certain.
            let higher = (1.0 + joint.residual).sqrt() - 1.0;
            format!("{} (up to {} % too low)", joint.joint, percent(higher))
        })
        .collect();
    match loose.is_empty() {
        true => String::new(),
        false => format!("not converged: {}\n", list(&loose)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn efficiencies_are_rounded_but_never_up_to_all_there_is() {
        assert_eq!(efficient(0.996_95), "99.7 %");
        assert_eq!(efficient(0.999_4), "99.9 %");
        assert_eq!(efficient(0.999_96), "> 99.9 %");
        assert_eq!(efficient(1.0), "100.0 %");
    }

    #[test]
    fn bounds_that_did_not_converge_are_named() {
        let joint = |name: &str, residual, termination| JointEfficiency {
            joint: name.to_string(),
            bound: 0.01,
            value: Some(0.02),
            efficiency: Some(0.5),
            residual,
            termination,
        };
        let joints = [
            joint("joint 1", 1e-5, Termination::Converged),
            joint("joint 2", 0.21, Termination::IterationLimit),
        ];
        assert_eq!(
            loose(&joints),
            "not converged: joint 2 (up to 10.00 % too low)\n"
        );
        assert_eq!(loose(&joints[..1]), "");
    }
}
