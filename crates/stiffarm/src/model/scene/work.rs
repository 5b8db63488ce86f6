//! Room for one posture, used again for the next, and what is remembered from one to the next.
//!
//! A search moves a posture by small steps, and no part can come nearer than the arm has moved. So
//! a distance that was large need not be looked at again until the joints have turned far enough
//! for it to have become small. What is left out that way is never below what was asked for, so no result
//! depends on it.

use super::Scene;
use super::displacement::DisplacementWork;
use super::placed_parts::Shapes;
use crate::model::kinematics::Frames;
use crate::model::observation::Setup;

/// How much farther than asked distances are told, so that they last for some steps \[m\].
const AHEAD: f64 = 0.3;

/// Room for one posture.
#[derive(Debug, Clone, Default)]
pub(crate) struct Work {
    pub(super) shapes: Shapes,
    pub(super) torques: Vec<f64>,
    pub(super) torque_slope: Vec<f64>,
    pub(super) displacement: DisplacementWork,
    pub(super) memory: Memory,
}

impl Work {
    /// Room that remembers distances, for a posture that moves by small steps.
    pub(crate) fn remembering(scene: &Scene, setup: &Setup) -> Self {
        Work { memory: Memory { reach: reach(scene, setup), ..Memory::default() }, ..Work::default() }
    }

    /// Forgets all distances: the load has moved.
    pub(crate) fn forget(&mut self) {
        self.memory.distances.clear();
        self.memory.beams.clear();
    }
}

/// Distances seen before, and how far the arm may have moved since.
#[derive(Debug, Clone, Default)]
pub(super) struct Memory {
    /// Most that any point moves by a turn of each joint \[m/rad\]; empty where nothing is remembered.
    reach: Vec<f64>,
    last: Vec<f64>,
    /// How far each joint, alone, may have moved any point so far \[m\].
    turned: Vec<f64>,
    /// Their sums: over the joints before each, and over all.
    travel: Vec<f64>,
    distances: Vec<RememberedDistance>,
    beams: Vec<RememberedDistance>,
}

/// A distance that was so large when the arm had moved so far.
#[derive(Debug, Clone, Copy)]
struct RememberedDistance {
    distance: f64,
    travel: f64,
}

const UNKNOWN: RememberedDistance = RememberedDistance { distance: f64::NEG_INFINITY, travel: 0.0 };

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
            self.turned.resize(theta.len(), 0.0);
            self.travel.resize(theta.len() + 1, 0.0);
        }
        let mut sum = 0.0;
        for (k, now) in theta.iter().enumerate() {
            self.turned[k] += (now - self.last[k]).abs() * self.reach[k];
            self.last[k] = *now;
            sum += self.turned[k];
            self.travel[k + 1] = sum;
        }
        self.distances.resize(margins, UNKNOWN);
        self.beams.resize(beams, UNKNOWN);
    }

    /// How far two things may have moved against each other so far that the first `low` and the first
    /// `high` joints move \[m\]: the joints before both do not count.
    pub fn between(&self, low: usize, high: usize) -> f64 {
        match self.travel.get(low.max(high)) {
            Some(most) => most - self.travel[low.min(high)],
            None => 0.0,
        }
    }

    /// A lower bound of distance `at`, where it is still known to be `enough` or more after this travel.
    pub fn still(&self, at: usize, travel: f64, enough: f64) -> Option<f64> {
        still(self.distances.get(at)?, travel, enough)
    }

    /// The same of a beam's clearance.
    pub fn beam_still(&self, at: usize, travel: f64, enough: f64) -> Option<f64> {
        still(self.beams.get(at)?, travel, enough)
    }

    /// How far a distance is to be told so that it lasts.
    pub fn ahead(&self, enough: f64) -> f64 {
        if self.reach.is_empty() { enough } else { enough + AHEAD }
    }

    /// Keeps a distance. An infinite one is not kept: a rope shorter than its free ends touches nothing,
    /// and one that grows longer does at once.
    pub fn note(&mut self, at: usize, travel: f64, distance: f64) {
        if let Some(noted) = self.distances.get_mut(at) {
            *noted = if distance.is_finite() { RememberedDistance { distance, travel } } else { UNKNOWN };
        }
    }

    pub fn note_beam(&mut self, at: usize, travel: f64, distance: f64) {
        if let Some(noted) = self.beams.get_mut(at) {
            *noted = RememberedDistance { distance, travel };
        }
    }
}

fn still(noted: &RememberedDistance, travel: f64, enough: f64) -> Option<f64> {
    let least = noted.distance - (travel - noted.travel);
    (least >= enough).then_some(least)
}

/// Most that any point of arm and tool is away from each joint's axis in any posture \[m\].
pub(super) fn reach(scene: &Scene, setup: &Setup) -> Vec<f64> {
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
        for solid in &part.solids {
            let size = solid.farthest();
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
