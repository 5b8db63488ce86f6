//! What is drawn of arm, tool and surroundings.

use super::data::{ArmShapes, Body, BodyKind};
use stiffarm::model::cell::Cell;
use stiffarm::model::robot::Robot;
use stiffarm::model::scene::{Carrier, Part};
use stiffarm::model::shape::{Capsule, Solid};
use stiffarm::nalgebra::{Isometry3, Vector3};

/// Radius of the first and the last tube of an arm without shapes, as shares of its length.
const THICK: [f64; 2] = [0.07, 0.03];

/// The bodies of a cell, and how many of them are the robot's and come before those of the cell's scene.
pub(super) fn bodies(cell: &Cell) -> (ArmShapes, usize, Vec<Body>) {
    let robot = &cell.setup.robot;
    let parts = cell.scene.parts();
    let has_arm = parts.iter().any(|p| matches!(p.carrier, Carrier::Link(_)));
    let (shapes, arm) = if has_arm {
        (ArmShapes::Own, Vec::new())
    } else {
        match Part::of_links(robot) {
            links if links.is_empty() => (ArmShapes::Tubes, tubes(robot)),
            links => (ArmShapes::Own, links),
        }
    };
    let bodies = arm.iter().chain(parts).map(|part| body(part, robot.joint_count()));
    (shapes, arm.len(), bodies.collect())
}

fn body(part: &Part, joints: usize) -> Body {
    Body {
        name: part.name.clone(),
        kind: match part.carrier {
            Carrier::Flange => BodyKind::Tool,
            Carrier::World if part.name != "base" => BodyKind::Standing,
            _ => BodyKind::Arm,
        },
        carrier: match part.carrier {
            Carrier::World => 0,
            Carrier::Link(i) => i,
            Carrier::Flange => joints + 1,
        },
        solids: part.solids.clone(),
    }
}

/// Tubes from joint to joint and a drum about each axis, thinner towards the flange, so that an arm
/// without shapes is recognised by its proportions.
fn tubes(robot: &Robot) -> Vec<Part> {
    let n = robot.joint_count();
    let radius = |link: usize| {
        let share = link as f64 / n as f64;
        robot.length() * (THICK[0] + (THICK[1] - THICK[0]) * share)
    };
    // Where link i ends, in its own frame.
    let end = |link: usize| -> Isometry3<f64> {
        let next = robot.joints().get(link).map(|joint| joint.placement);
        next.unwrap_or(*robot.flange())
    };
    let parts = (0..=n).map(|link| {
        let to = end(link).translation.vector;
        let mut solids = Vec::new();
        // Where two axes meet, the drums show the link.
        if to.norm() > radius(link) {
            let tube = Capsule::new(Vector3::zeros(), to, 0.8 * radius(link));
            solids.extend(tube.ok().map(Solid::Capsule));
        }
        let along = Vector3::z() * (1.15 * radius(link));
        if link > 0 {
            // The first drum stands on the base, not half below it.
            let at_base = link == 1 && end(0).translation.vector.norm() <= radius(0);
            let middle = if at_base { along * to.z.signum() } else { Vector3::zeros() };
            solids.extend(Solid::cylinder(middle - along, middle + along, radius(link)).ok());
            Part::new(format!("link {link}"), Carrier::Link(link), solids)
        } else {
            Part::new("base", Carrier::World, solids)
        }
    });
    parts.filter(|part| !part.solids.is_empty()).collect()
}
