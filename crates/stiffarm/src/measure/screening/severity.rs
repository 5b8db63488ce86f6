//! What a suspicion is called and how serious it is.

use super::{Cause, Evidence, Suspicion};
use crate::findings::{Severity, codes};

/// Misfit that a robot as delivered may have \[m\].
const ROBOT_ACCURACY: f64 = 5e-3;

/// Turn between two frames that costs a third of a percent \[deg\].
const SMALL_TURN_DEG: f64 = 0.06;

/// A stray reading below this costs little more than noise does \[m\].
const SMALL_STRAY: f64 = 1e-4;

/// The stable name of the finding.
pub(super) fn code(cause: Cause) -> &'static str {
    match cause {
        Cause::Units => "reading-units",
        Cause::ToolUnits => "tool-units",
        Cause::ExchangedPoints => "exchanged-points",
        Cause::StrayRepeat => "stray-repeat",
        Cause::StrayReading => "stray-reading",
        Cause::MovedReflector => "moved-reflector",
        Cause::UnsteadyShape => "unsteady-shape",
        Cause::Drawing => "tool-drawing",
        Cause::MirroredFrame => "mirrored-frame",
        Cause::JointSign => "joint-sign",
        Cause::Coupling => "joint-coupling",
        Cause::DhConvention => "dh-convention",
        Cause::JointOffset => "joint-offset",
        Cause::ToolPlace => "tool-place",
        Cause::Radians => "angles-in-radians",
        Cause::GivenTransform => "tracker-transform",
        Cause::MovedTracker => "moved-tracker",
        Cause::AngleSign => "angle-sign",
        Cause::MistypedAngle => "mistyped-angle",
        Cause::ExchangedPostures => "exchanged-postures",
        Cause::OtherPosture => "other-posture",
        Cause::UnexplainedPosture => "unexplained-posture",
        Cause::UnexplainedModel => "unexplained-model",
        Cause::NoDisplacement => "no-displacement",
        Cause::ReversedForce => codes::REVERSED_FORCE,
        Cause::ExchangedStates => codes::EXCHANGED_STATES,
        Cause::DisplacementSize => codes::DISPLACEMENT_SIZE,
        Cause::OtherLoad => codes::OTHER_LOAD,
        Cause::LoadUnits => "load-units",
        Cause::LoadEntry => "load-entry",
        Cause::MomentUnits => "moment-units",
        Cause::DisplacementUnits => "displacement-units",
        Cause::PriorUnits => "prior-units",
        Cause::AnchorUnits => "anchor-units",
        Cause::LoadingPointUnits => "loading-point-units",
        Cause::RobotUnits => "robot-units",
        Cause::ExchangedLoadCases => "exchanged-load-cases",
        Cause::Degrees => "angles-in-degrees",
        Cause::NotChecked => "not-checked",
    }
}

/// How serious the finding is.
pub(super) fn severity(s: &Suspicion) -> Severity {
    match s.cause {
        Cause::NotChecked => Severity::Note,
        Cause::Drawing if s.certain => Severity::Note,
        // Where the prior alone speaks, the prior may be what is wrong.
        Cause::LoadUnits | Cause::DisplacementUnits | Cause::PriorUnits if !s.certain => {
            match s.evidence {
                Some(Evidence::Prior) => Severity::Caution,
                _ => Severity::Serious,
            }
        }
        // It weighs the joints when postures are chosen, and no more.
        Cause::PriorUnits => Severity::Caution,
        // The number alone speaks: the readings fit either.
        Cause::LoadingPointUnits if !s.certain => Severity::Caution,
        // A few mm are within what robots miss their positions by.
        Cause::UnexplainedPosture if s.before_m.is_some_and(|b| b < ROBOT_ACCURACY) => {
            Severity::Caution
        }
        // Displacements turn with the frame: by less than 0.3 % they stay what they are.
        Cause::MovedTracker
            if s.divided.is_empty() && s.angles_deg.iter().all(|a| *a < SMALL_TURN_DEG) =>
        {
            Severity::Caution
        }
        Cause::StrayReading if s.off_m.is_some_and(|off| off < SMALL_STRAY) => Severity::Caution,
        Cause::StrayRepeat | Cause::UnsteadyShape | Cause::OtherLoad | Cause::Drawing => {
            Severity::Caution
        }
        _ => Severity::Serious,
    }
}
