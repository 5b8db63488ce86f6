//! What a suspicion is called, what it is about where it concerns all postures, and how serious it is.

use super::{Cause, Evidence, Suspicion};
use crate::findings::Severity::{self, Caution, Note, Serious};

/// Misfit that a robot as delivered may have \[m\].
const ROBOT_ACCURACY: f64 = 5e-3;

/// Turn between two frames that costs a third of a percent \[deg\].
const SMALL_TURN_DEG: f64 = 0.06;

/// A stray reading below this costs little more than noise does \[m\].
const SMALL_STRAY: f64 = 1e-4;

/// The stable name of the finding, what it is about where it concerns all postures, and its usual weight.
pub(super) fn facts(cause: Cause) -> (&'static str, &'static str, Severity) {
    match cause {
        Cause::Units => ("reading-units", "readings", Serious),
        Cause::ToolUnits => ("tool-units", "tool.measuring_point", Serious),
        Cause::ExchangedPoints => ("exchanged-points", "readings", Serious),
        Cause::StrayRepeat => ("stray-repeat", "readings", Caution),
        Cause::StrayReading => ("stray-reading", "readings", Serious),
        Cause::MovedReflector => ("moved-reflector", "readings", Serious),
        Cause::UnsteadyShape => ("unsteady-shape", "readings", Caution),
        Cause::Drawing => ("tool-drawing", "tool.measuring_point", Caution),
        Cause::MirroredFrame => ("mirrored-frame", "readings", Serious),
        Cause::JointSign => ("joint-sign", "robot", Serious),
        Cause::Coupling => ("joint-coupling", "robot", Serious),
        Cause::DhConvention => ("dh-convention", "robot.dh", Serious),
        Cause::JointOffset => ("joint-offset", "robot", Serious),
        Cause::ToolPlace => ("tool-place", "tool.measuring_point", Serious),
        Cause::Radians => ("angles-in-radians", "readings", Serious),
        Cause::GivenTransform => ("tracker-transform", "tracker", Serious),
        Cause::MovedTracker => ("moved-tracker", "readings", Serious),
        Cause::AngleSign => ("angle-sign", "readings", Serious),
        Cause::MistypedAngle => ("mistyped-angle", "readings", Serious),
        Cause::ExchangedPostures => ("exchanged-postures", "readings", Serious),
        Cause::OtherPosture => ("other-posture", "readings", Serious),
        Cause::UnexplainedPosture => ("unexplained-posture", "readings", Serious),
        Cause::UnexplainedModel => ("unexplained-model", "readings", Serious),
        Cause::NoDisplacement => ("no-displacement", "readings", Serious),
        Cause::ReversedForce => ("reversed-force", "readings", Serious),
        Cause::ExchangedStates => ("exchanged-states", "readings", Serious),
        Cause::DisplacementSize => ("displacement-size", "readings", Serious),
        Cause::OtherLoad => ("other-load", "readings", Caution),
        Cause::LoadUnits => ("load-units", "load", Serious),
        Cause::LoadEntry => ("load-entry", "load", Serious),
        Cause::MomentUnits => ("moment-units", "load", Serious),
        Cause::DisplacementUnits => ("displacement-units", "measurements", Serious),
        Cause::PriorUnits => ("prior-units", "stiffness.prior_nm_per_rad", Caution),
        Cause::AnchorUnits => ("anchor-units", "load.anchor_mm", Serious),
        Cause::LoadingPointUnits => ("loading-point-units", "tool.loading_point_mm", Serious),
        Cause::RobotUnits => ("robot-units", "robot.dh", Serious),
        Cause::ExchangedLoadCases => ("exchanged-load-cases", "load.case", Serious),
        Cause::Degrees => ("angles-in-degrees", "readings", Serious),
        Cause::NotChecked => ("not-checked", "readings", Note),
    }
}

/// How serious the finding is.
pub(super) fn severity(s: &Suspicion) -> Severity {
    match s.cause {
        Cause::Drawing if s.certain => Note,
        // Where the prior alone speaks, the prior may be what is wrong.
        Cause::LoadUnits | Cause::DisplacementUnits | Cause::PriorUnits if !s.certain => {
            match s.evidence {
                Some(Evidence::Prior) => Caution,
                _ => Serious,
            }
        }
        // The number alone speaks: the readings fit either.
        Cause::LoadingPointUnits if !s.certain => Caution,
        // A few mm are within what robots miss their positions by.
        Cause::UnexplainedPosture if s.before_m.is_some_and(|b| b < ROBOT_ACCURACY) => Caution,
        // Displacements turn with the frame: by less than 0.3 % they stay what they are.
        Cause::MovedTracker
            if s.divided.is_empty() && s.angles_deg.iter().all(|a| *a < SMALL_TURN_DEG) =>
        {
            Caution
        }
        Cause::StrayReading if s.off_m.is_some_and(|off| off < SMALL_STRAY) => Caution,
        _ => facts(s.cause).2,
    }
}
