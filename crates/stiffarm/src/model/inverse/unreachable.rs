//! What is said of a pose that the arm does not reach.

use super::closed_form::Outside;
use crate::error::{Code, Error};
use crate::model::robot::Robot;
use crate::units::{m_to_mm, rad_to_deg, rounded, significant};

/// Where an unreachable pose lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Region {
    /// Farther than the stretched arm.
    Beyond,
    /// In the hole about the axis of joint 1 that a lateral offset leaves.
    AboutJointOne,
    /// In the hole about the axis of joint 2 that the folded arm leaves.
    AboutJointTwo,
    /// Outside what the arm reaches; a numeric search does not tell where.
    Outside,
}

/// How far a pose is out of reach, machine limits left aside.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unreachable {
    /// Distance of the flange's position from the nearest one that the arm
    /// reaches with this orientation \[m\]; where it does not reach the
    /// orientation itself, that of the nearest pose found.
    pub distance_m: f64,
    /// What is missing to the orientation \[rad\]: zero for arms that can hold
    /// it somewhere.
    pub rotation_rad: f64,
    /// Where the pose lies.
    pub region: Region,
}

impl Unreachable {
    pub(super) fn closed_form((distance_m, outside): (f64, Outside)) -> Self {
        Unreachable {
            distance_m,
            rotation_rad: 0.0,
            region: match outside {
                Outside::Beyond => Region::Beyond,
                Outside::AxisOne => Region::AboutJointOne,
                Outside::AxisTwo => Region::AboutJointTwo,
            },
        }
    }

    /// The error that tells a user; `robot` gives the joints their names.
    pub fn error(&self, robot: &Robot) -> Error {
        let distance = short(m_to_mm(self.distance_m));
        let about = |joint: usize| {
            let name = robot.joints().get(joint).map_or("the base", |j| &j.name);
            format!("inside the hole about the axis of {name}")
        };
        let message = match self.region {
            _ if self.rotation_rad > 0.0 => {
                let angle = short(rad_to_deg(self.rotation_rad));
                format!(
                    "No posture holds the flange at the pose: the nearest pose found is {distance} mm and {angle}° \
                     away."
                )
            }
            Region::Beyond => format!("The pose lies {distance} mm beyond the arm's reach."),
            Region::AboutJointOne => format!("The pose lies {distance} mm {}.", about(0)),
            Region::AboutJointTwo => format!("The pose lies {distance} mm {} that the folded arm leaves.", about(1)),
            Region::Outside => format!("The pose lies {distance} mm outside the arm's reach."),
        };
        Error::new(Code::Unreachable, message).hint("move or turn the pose, or place the robot's base differently")
    }
}

/// A length or angle with one decimal, smaller ones with two digits.
fn short(value: f64) -> String {
    if value >= 0.1 {
        return format!("{value:.1}");
    }
    // A nanometre and less is what the search leaves.
    rounded(significant(value, 2), 6).to_string()
}
