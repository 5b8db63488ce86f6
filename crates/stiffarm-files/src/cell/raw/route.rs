//! `[route]`: how the robot drives from posture to posture; `[time]`: what measuring takes.

use super::{Deg, List, Number, Text};
use crate::cell::value::{Minutes, Percent};

tables! {
    /// How the robot drives from posture to posture: for the order of a plan, its moves and programs.
    struct RawRoute as "Route" {
        /// Largest speed of each joint, degrees per second (default: the catalogue's, where it has them).
        joint_speeds_deg_s: List<Deg>,
        /// Share of these speeds that is driven at, percent (default: 10).
        speed_percent: Number<Percent>,
        /// Where the robot stands before and after, controller angles, degrees: a safe posture
        /// (default: unknown, and the drive to the first posture is the engineer's).
        start_deg: List<Deg>,
        /// Turn of each joint beyond a posture from which it is reached, degrees, to the side to which the load turns
        /// the joint: so lost motion is taken up before the load acts (default: postures are reached from wherever the
        /// robot comes). Needs start_deg.
        approach_deg: Number<Deg>,
        /// Whether the load is taken off before each move ("off", the default) or stays "on".
        load: Text [with = "Option<String>", extend("enum" = ["off", "on"])],
    }

    /// What measuring takes beside the robot, for the minutes of a plan.
    struct RawTime as "Time" {
        /// A posture, with its readings without load and under the first one, minutes (default: 3).
        posture_min: Number<Minutes>,
        /// Each further load in the same posture, minutes: a weight hung, the rope hooked to another anchor
        /// (default: 1).
        further_load_min: Number<Minutes>,
        /// Each further anchor of a rope, once, minutes: it is set up before the first posture (default: 10).
        further_anchor_min: Number<Minutes>,
    }
}
