//! Which of its postures an arm with a spherical wrist takes, in words, and
//! KUKA's Status and Turn.

use crate::model::kinematics::Frames;
use crate::model::robot::Robot;
use nalgebra::Vector3;
use serde::Serialize;

/// How far axes may miss each other and still count as a spherical wrist (of
/// the arm's length), so that calibrated arms keep their words.
const WRIST_TOLERANCE: f64 = 1e-3;
/// An angle this little below zero counts as zero \[rad\].
const ZERO: f64 = 1e-9;

/// On which side of axis 1 the wrist centre lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Shoulder {
    /// On the side of axis 2.
    Front,
    /// On the other side: the arm reaches over its shoulder.
    Back,
}

/// Where the elbow lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Elbow {
    /// Above the line from axis 2 to the wrist centre.
    Up,
    /// Below it.
    Down,
}

/// How the wrist is bent.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Wrist {
    /// The turn from axis 4 to axis 6 about axis 5 is not negative.
    NoFlip,
    /// It is negative.
    Flip,
}

/// The configuration of a six-joint arm with a spherical wrist.
///
/// Axis 5 has the direction that the Denavit–Hartenberg rows give it; in the
/// catalogue it is that of KUKA's A5, against FANUC's J5.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Configuration {
    /// Front or back.
    pub shoulder: Shoulder,
    /// Up or down.
    pub elbow: Elbow,
    /// Flipped or not.
    pub wrist: Wrist,
}

impl Configuration {
    /// The configuration at the controller angles `q` \[rad\]; `None` for an arm
    /// without a spherical wrist, or whose axes 1 and 2 meet, so that front and
    /// back are the same.
    ///
    /// # Panics
    /// If `q` does not have one entry per joint.
    pub fn of(robot: &Robot, q: &[f64]) -> Option<Self> {
        let arm = Arm::of(robot, q)?;
        let shoulder = if arm.is_front() { Shoulder::Front } else { Shoulder::Back };
        // Behind axis 1 the arm is seen from the other side.
        let elbow = if arm.is_bent_down() == arm.is_front() { Elbow::Up } else { Elbow::Down };
        let wrist = if arm.wrist_sine >= -ZERO { Wrist::NoFlip } else { Wrist::Flip };
        Some(Configuration { shoulder, elbow, wrist })
    }

    /// In words, for example `front, elbow up, no flip`.
    pub fn words(&self) -> String {
        let shoulder = match self.shoulder {
            Shoulder::Front => "front",
            Shoulder::Back => "back",
        };
        let elbow = match self.elbow {
            Elbow::Up => "up",
            Elbow::Down => "down",
        };
        let wrist = match self.wrist {
            Wrist::NoFlip => "no flip",
            Wrist::Flip => "flip",
        };
        format!("{shoulder}, elbow {elbow}, {wrist}")
    }
}

/// The points and directions that tell configurations apart \[m\], base axes.
struct Arm {
    /// From axis 1 towards axis 2, at right angles to both.
    forward: Vector3<f64>,
    /// Axis 1 × forward.
    left: Vector3<f64>,
    /// From axis 1, axis 2 and the elbow on axis 3 …
    from_base: Vector3<f64>,
    from_shoulder: Vector3<f64>,
    upper_arm: Vector3<f64>,
    /// Sine of the turn from axis 4 to axis 6 about axis 5.
    wrist_sine: f64,
}

impl Arm {
    fn of(robot: &Robot, q: &[f64]) -> Option<Self> {
        if robot.joint_count() != 6 {
            return None;
        }
        let frames = Frames::new(robot, q);
        let (z, o) = (frames.axes(), frames.origins());
        let near = WRIST_TOLERANCE * robot.length();
        // Axes 5 and 6 are at right angles: their common point is well defined.
        let normal = z[4].cross(&z[5]).try_normalize(0.9)?;
        let along = z[5].cross(&normal);
        let way = (o[4] - o[5]).dot(&along) / z[4].dot(&along);
        let centre = o[4] - z[4] * way;
        let off = |i: usize| (centre - o[i]).cross(&z[i]).norm();
        if [3, 4, 5].into_iter().any(|i| off(i) > near) || z[1].cross(&z[2]).norm() > WRIST_TOLERANCE {
            return None;
        }
        let normal = z[0].cross(&z[1]).try_normalize(0.9)?;
        let offset = (o[1] - o[0]).dot(&normal);
        if offset.abs() <= WRIST_TOLERANCE * near {
            return None;
        }
        let forward = normal * offset.signum();
        Some(Arm {
            forward,
            left: z[0].cross(&forward),
            from_base: centre - o[0],
            from_shoulder: centre - o[1],
            upper_arm: o[2] - o[1],
            wrist_sine: z[4].dot(&z[3].cross(&z[5])),
        })
    }

    fn is_front(&self) -> bool {
        self.from_base.dot(&self.forward) >= 0.0
    }

    /// Whether the forearm is bent from the upper arm towards the front, seen in
    /// the posture with the upper arm upright.
    fn is_bent_down(&self) -> bool {
        self.upper_arm.cross(&self.from_shoulder).dot(&self.left) >= 0.0
    }
}

/// KUKA's Status S of a posture at controller angles `q` \[rad\].
///
/// Bit 0: the wrist centre lies behind axis 1 (its x in the frame that turns
/// with A1 is negative). Bit 1: the forearm is bent forward from the stretched
/// arm, A3 above 0° where axes 3 and 4 meet, above the angle that stretches the
/// arm where the forearm is offset. Bit 2: A5 is negative. Bit 0
/// follows KUKA's expert programming manual as users quote it; bits 1 and 2 were
/// held against no manual and no controller: compare one posture with the pendant.
///
/// `None` as for [`Configuration::of`].
///
/// # Panics
/// If `q` does not have one entry per joint.
pub fn kuka_status(robot: &Robot, q: &[f64]) -> Option<u8> {
    let arm = Arm::of(robot, q)?;
    let bits = [!arm.is_front(), arm.is_bent_down(), q[4] < -ZERO];
    Some(packed(bits))
}

/// KUKA's Turn T: bit i − 1 is set where Ai is negative.
pub fn kuka_turn(q: &[f64]) -> u8 {
    packed(q.iter().take(6).map(|angle| *angle < -ZERO))
}

fn packed(bits: impl IntoIterator<Item = bool>) -> u8 {
    let bits = bits.into_iter().enumerate();
    bits.fold(0, |sum, (i, bit)| sum | u8::from(bit) << i)
}
