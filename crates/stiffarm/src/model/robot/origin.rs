//! What is known of a robot beside its mechanism: where it comes from.

use super::{Controller, Doubt, DoubtAbout, Robot};
use nalgebra::Isometry3;

/// Maker, controller and doubts.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Origin {
    pub(super) controller: Option<Controller>,
    /// The controller's base frame in the base frame \[m\].
    controller_base: Isometry3<f64>,
    doubts: Vec<Doubt>,
}

impl Default for Origin {
    fn default() -> Self {
        Origin { controller: None, controller_base: Isometry3::identity(), doubts: Vec::new() }
    }
}

impl Origin {
    /// Forgets doubts that numbers of the user's own have settled.
    pub(super) fn settle(&mut self, about: DoubtAbout) {
        self.doubts.retain(|doubt| doubt.about != about);
    }

    /// Moves the controller's base with the robot.
    pub(super) fn place(&mut self, pose: &Isometry3<f64>) {
        self.controller_base = pose * self.controller_base;
    }
}

impl Robot {
    pub(super) fn with_doubts(mut self, doubts: &[Doubt]) -> Self {
        self.origin.doubts = doubts.to_vec();
        self
    }

    /// Says where the controller's base frame lies in the robot's base frame
    /// \[m\], in which a pendant shows poses: FANUC's lies at the height of axis
    /// 2, that of Universal Robots is turned by half a turn.
    #[must_use]
    pub fn with_controller_base(mut self, pose: &Isometry3<f64>) -> Self {
        self.origin.controller_base = *pose;
        self
    }

    /// The controller's base frame in the base frame \[m\].
    pub fn controller_base(&self) -> &Isometry3<f64> {
        &self.origin.controller_base
    }

    /// What to distrust about this robot of the catalogue. Limits or a coupling
    /// of the user's own settle the doubts about those of the catalogue.
    pub fn doubts(&self) -> &[Doubt] {
        &self.origin.doubts
    }
}
