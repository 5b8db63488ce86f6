//! What may be wrong, a row for each cause: what it is, the stable name of its finding, what that is about where it
//! concerns all postures, and its usual weight.

use crate::findings::Severity;
use serde::{Deserialize, Serialize};

/// Defines the causes by their rows.
macro_rules! causes {
    ($($(#[$about:meta])* $cause:ident: $code:literal, $of_all:literal, $weight:ident;)*) => {
        /// What is likely wrong.
        #[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
        #[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
        #[serde(rename_all = "snake_case")]
        #[non_exhaustive]
        pub enum Cause {
            $($(#[$about])* $cause,)*
        }

        impl Cause {
            /// Name of the finding, what it is about where it concerns all postures, usual weight.
            pub(crate) fn facts(self) -> (&'static str, &'static str, Severity) {
                match self {
                    $(Cause::$cause => ($code, $of_all, Severity::$weight),)*
                }
            }
        }
    };
}

causes! {
    /// Coordinates in another unit than stated.
    Units: "reading-units", "readings", Serious;
    /// The tool's points in the cell in another unit than stated.
    ToolUnits: "tool-units", "tool.measuring_point", Serious;
    /// Measuring points exchanged.
    ExchangedPoints: "exchanged-points", "readings", Serious;
    /// One repeat far from the others.
    StrayRepeat: "stray-repeat", "readings", Caution;
    /// One reading far from where the rigid tool has its point.
    StrayReading: "stray-reading", "readings", Serious;
    /// A reflector that sits elsewhere in several states.
    MovedReflector: "moved-reflector", "readings", Serious;
    /// The measuring points do not keep their distances.
    UnsteadyShape: "unsteady-shape", "readings", Caution;
    /// Measuring points that lie elsewhere than the cell says.
    Drawing: "tool-drawing", "tool.measuring_point", Caution;
    /// The tracker's axes are left-handed, or one is flipped.
    MirroredFrame: "mirrored-frame", "readings", Serious;
    /// Joints that turn the other way than the cell says.
    JointSign: "joint-sign", "robot", Serious;
    /// Axis 3 coupled to axis 2 differently than the cell says.
    Coupling: "joint-coupling", "robot", Serious;
    /// Denavit–Hartenberg rows meant in the other convention.
    DhConvention: "dh-convention", "robot.dh", Serious;
    /// A constant offset of a joint angle.
    JointOffset: "joint-offset", "robot", Serious;
    /// All measuring points, and the tool with them, sit elsewhere on the flange than the cell says.
    ToolPlace: "tool-place", "tool.measuring_point", Serious;
    /// Joint angles in radians under a heading in degrees.
    Radians: "angles-in-radians", "readings", Serious;
    /// The transform that is given for the tracker does not fit the readings.
    GivenTransform: "tracker-transform", "tracker", Serious;
    /// The tracker, or the robot, stands elsewhere from a posture on.
    MovedTracker: "moved-tracker", "readings", Serious;
    /// One joint angle with the wrong sign.
    AngleSign: "angle-sign", "readings", Serious;
    /// One joint angle mistyped.
    MistypedAngle: "mistyped-angle", "readings", Serious;
    /// Rows of two postures exchanged.
    ExchangedPostures: "exchanged-postures", "readings", Serious;
    /// Readings that belong to another posture.
    OtherPosture: "other-posture", "readings", Serious;
    /// A posture that the kinematic model does not explain.
    UnexplainedPosture: "unexplained-posture", "readings", Serious;
    /// A robot that the kinematic model does not explain.
    UnexplainedModel: "unexplained-model", "readings", Serious;
    /// No displacement under load.
    NoDisplacement: "no-displacement", "readings", Serious;
    /// Displacements against the force.
    ReversedForce: "reversed-force", "readings", Serious;
    /// Loaded and unloaded rows exchanged.
    ExchangedStates: "exchanged-states", "readings", Serious;
    /// Displacements of another size than the prior stiffness lets expect.
    DisplacementSize: "displacement-size", "readings", Serious;
    /// One state with displacements of another size than the others.
    OtherLoad: "other-load", "readings", Caution;
    /// Loads or forces of the whole table, or of the cell, in another unit.
    LoadUnits: "load-units", "load", Serious;
    /// The load of single states typed in another unit or with a slipped decimal point.
    LoadEntry: "load-entry", "load", Serious;
    /// Moments in another unit than the forces.
    MomentUnits: "moment-units", "load", Serious;
    /// Displacements in another unit than stated.
    DisplacementUnits: "displacement-units", "measurements", Serious;
    /// The prior stiffness in another unit than stated.
    PriorUnits: "prior-units", "stiffness.prior_nm_per_rad", Caution;
    /// The anchor of rope or cylinder in another unit than stated.
    AnchorUnits: "anchor-units", "load.anchor_mm", Serious;
    /// The loading point in another unit than stated.
    LoadingPointUnits: "loading-point-units", "tool.loading_point_mm", Serious;
    /// The robot's own lengths in another unit than stated.
    RobotUnits: "robot-units", "robot.dh", Serious;
    /// States filed under another load case than they were taken under.
    ExchangedLoadCases: "exchanged-load-cases", "load.case", Serious;
    /// Joint angles in degrees under a heading in radians.
    Degrees: "angles-in-degrees", "readings", Serious;
    /// Too few readings for the checks against the kinematic model.
    #[default]
    NotChecked: "not-checked", "readings", Note;
}
