//! What measuring takes, beside the robot.

use crate::model::load::Load;
use serde::{Deserialize, Serialize};

/// Time that the parts of an experiment take \[s\].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MeasuringTime {
    /// A posture: the drive there, and its readings without load and under the first one.
    #[serde(rename = "posture_s")]
    pub posture: f64,
    /// Each further load in the same posture: a weight hung, the rope hooked to another anchor.
    #[serde(rename = "further_load_s")]
    pub further_load: f64,
    /// Each further anchor of a rope, once: it is set up before the first posture.
    #[serde(rename = "further_anchor_s")]
    pub further_anchor: f64,
}

/// Three minutes a posture, one for a further load, ten for a further anchor: assumed, as nothing else is known.
impl Default for MeasuringTime {
    fn default() -> Self {
        MeasuringTime { posture: 180.0, further_load: 60.0, further_anchor: 600.0 }
    }
}

impl MeasuringTime {
    /// Of `postures`, each under every load of `load` \[s\].
    pub fn of(&self, postures: usize, load: &Load) -> f64 {
        postures as f64 * self.of_posture(load) + self.of_anchors(load)
    }

    /// Postures that can be measured so within `time` \[s\].
    pub fn postures_within(&self, time: f64, load: &Load) -> usize {
        // A minute is not lost to rounding.
        let each = (time - self.of_anchors(load)) / self.of_posture(load);
        (each + 1e-9).max(0.0) as usize
    }

    /// One posture under every load.
    pub fn of_posture(&self, load: &Load) -> f64 {
        self.posture + self.further_load * load.each().count().saturating_sub(1) as f64
    }

    /// All anchors but the first.
    fn of_anchors(&self, load: &Load) -> f64 {
        let anchors: Vec<_> = load.anchors().collect();
        let first = |(i, anchor)| !anchors[..i].contains(anchor);
        let different = anchors.iter().enumerate().filter(|anchor| first(*anchor)).count();
        self.further_anchor * different.saturating_sub(1) as f64
    }
}
