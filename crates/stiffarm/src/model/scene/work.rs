//! Room for one posture, used again for the next, and what is remembered from one to the next.
//!
//! A search moves a posture by small steps, and no part can come nearer than the arm has moved. So
//! a distance that was large need not be looked at again until the joints have turned far enough
//! for it to have become small. What is left out that way is never below what was asked for, so no result
//! depends on it.

use super::Scene;
use super::placed::Shapes;
use crate::model::kinematics::Frames;
use crate::model::observation::Setup;

/// How much farther than asked distances are told, so that they last for some steps \[m\].
const AHEAD: f64 = 0.3;
const BEAM_AHEAD: f64 = 0.1;

/// Room for one posture.
#[derive(Debug, Clone, Default)]
pub(crate) struct Work {
    pub(super) shapes: Shapes,
    pub(super) torques: Vec<f64>,
    pub(super) torque_slope: Vec<f64>,
    pub(super) memory: Memory,
}

impl Work {
    /// Room that remembers distances, for a posture that moves by small steps.
    pub(crate) fn remembering(scene: &Scene, setup: &Setup) -> Self {
        Work {
            memory: Memory {
                reach: reach(scene, setup),
                ..Memory::default()
            },
            ..Work::default()
        }
    }

    /// Forgets all distances: the load has moved.
    pub(crate) fn forget(&mut self) {
        self.memory.known.clear();
        self.memory.beams.clear();
    }
}

/// Distances seen before, and how far the arm may have moved since.
#[derive(Debug, Clone, Default)]
pub(super) struct Memory {
    /// Most that any point moves by a turn of each joint \[m/rad\]; empty where nothing is remembered.
    reach: Vec<f64>,
    last: Vec<f64>,
    travel: f64,
    known: Vec<Known>,
    beams: Vec<Known>,
}

/// A distance that was so large when the arm had moved so far.
#[derive(Debug, Clone, Copy)]
struct Known {
    distance: f64,
    travel: f64,
}

const UNKNOWN: Known = Known {
    distance: f64::NEG_INFINITY,
    travel: 0.0,
};

impl Memory {
    /// True where distances are remembered.
    pub fn remembers(&self) -> bool {
        !self.reach.is_empty()
    }

    /// Notes how far the arm may have moved to these angles.
    pub fn arrive(&mut self, theta: &[f64], margins: usize, beams: usize) {
        if self.reach.is_empty() {
            return;
        }
        if self.last.is_empty() {
            self.last.extend_from_slice(theta);
        }
        let turns = theta.iter().zip(&mut self.last).zip(&self.reach);
        for ((now, last), reach) in turns {
            self.travel += (now - *last).abs() * reach;
            *last = *now;
        }
        self.known.resize(margins, UNKNOWN);
        self.beams.resize(beams, UNKNOWN);
    }

    /// A lower bound of distance `at`, where it is still known to be `enough` or more.
    pub fn still(&self, at: usize, enough: f64) -> Option<f64> {
        still(self.known.get(at)?, self.travel, enough)
    }

    /// The same of a beam's clearance.
    pub fn beam_still(&self, at: usize, enough: f64) -> Option<f64> {
        still(self.beams.get(at)?, self.travel, enough)
    }

    /// How far a distance is to be told so that it lasts.
    pub fn ahead(&self, enough: f64) -> f64 {
        match self.reach.is_empty() {
            true => enough,
            false => enough + AHEAD,
        }
    }

    /// The same of a beam, which always begins near the tool.
    pub fn beam_ahead(&self, enough: f64) -> f64 {
        match self.reach.is_empty() {
            true => enough,
            false => enough + BEAM_AHEAD,
        }
    }

    /// Keeps a distance. An infinite one is not kept: a rope shorter than its free ends touches nothing,
    /// and one that grows longer does at once.
    pub fn note(&mut self, at: usize, distance: f64) {
        if let Some(known) = self.known.get_mut(at) {
            *known = match distance.is_finite() {
                true => Known {
                    distance,
                    travel: self.travel,
                },
                false => UNKNOWN,
            };
        }
    }

    pub fn note_beam(&mut self, at: usize, distance: f64) {
        if let Some(known) = self.beams.get_mut(at) {
            *known = Known {
                distance,
                travel: self.travel,
            };
        }
    }
}

fn still(known: &Known, travel: f64, enough: f64) -> Option<f64> {
    // Both sides of a distance may have moved.
    let least = known.distance - 2.0 * (travel - known.travel);
    (least >= enough).then_some(least)
}

/// Most that any point of arm and tool is away from each joint's axis in any posture \[m\].
fn reach(scene: &Scene, setup: &Setup) -> Vec<f64> {
    let robot = &setup.robot;
    let n = robot.joint_count();
    // Farthest point of what each joint's own frame carries, then from joint to joint.
    let mut farthest = vec![0.0_f64; n];
    let flange = robot.flange();
    let mut on_flange = setup.tool.loading_point.norm();
    for point in &setup.tool.measuring_points {
        on_flange = on_flange.max(point.position.norm());
    }
    let zero = Frames::new(robot, &vec![0.0; n]);
    for part in scene.parts() {
        for capsule in part.capsules() {
            let size = capsule.a.norm().max(capsule.b.norm()) + capsule.radius;
            match part.carrier.moved_by(zero.joint_count()) {
                0 => {}
                _ if part.is_tool() => on_flange = on_flange.max(size),
                i => farthest[i - 1] = farthest[i - 1].max(size),
            }
        }
    }
    farthest[n - 1] = farthest[n - 1].max(flange.translation.vector.norm() + on_flange);
    for i in (1..n).rev() {
        let link = robot.joints()[i].placement.translation.vector.norm();
        farthest[i - 1] = farthest[i - 1].max(link + farthest[i]);
    }
    farthest
}
