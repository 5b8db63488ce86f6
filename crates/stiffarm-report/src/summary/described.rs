//! What stands beside the arm, with its size: a slip of the unit shows where one reads what was read.

use super::postures::coarse;
use crate::summary::Number;
use stiffarm::model::cell::Cell;
use stiffarm::model::scene::{Carrier, Part};
use stiffarm::model::shape::Solid;
use stiffarm::nalgebra::{Isometry3, Vector3};
use stiffarm::units::rad_to_shortest_deg;

/// Solids of a part that are told one by one; meshes are covered by more.
const FEW: usize = 2;

/// Rows of the set-up: shapes of tool and surroundings, tracker stations, clearance, start, tip and workpiece.
pub(super) fn beside_arm(cell: &Cell) -> Vec<(&'static str, String)> {
    let mut rows = Vec::new();
    for part in cell.scene.parts() {
        let kind = match part.carrier {
            Carrier::Flange => "shape of the tool",
            Carrier::World if part.name != "base" => "obstacle",
            _ => continue,
        };
        rows.push((kind, format!("{}: {}", part.name, solids(part))));
    }
    let links = |part: &&Part| matches!(part.carrier, Carrier::Link(_)) || part.name == "base";
    let links: Vec<&Part> = cell.scene.parts().iter().filter(links).collect();
    if !links.is_empty() {
        let capsules = links.iter().flat_map(|part| &part.solids);
        let radii = capsules.filter_map(|solid| match solid {
            Solid::Capsule(capsule) => Some(capsule.radius),
            _ => None,
        });
        let (least, most) =
            radii.fold((f64::INFINITY, 0.0_f64), |(low, high), radius| (low.min(radius), high.max(radius)));
        rows.push(("links", format!("capsules of {} to {} radius", length(least), length(most))));
    }
    if !cell.scene.parts().is_empty() {
        rows.push(("clearance", length(cell.scene.clearance())));
    }
    for station in cell.scene.sight().iter().flat_map(|sight| &sight.stations) {
        let at = place(&station.position);
        rows.push(("tracker station", format!("{}: {at}, base axes", station.name)));
    }
    if let Some(start) = &cell.route.start {
        let angles = start.iter().map(|q| rad_to_shortest_deg(*q).to_string());
        let angles = angles.collect::<Vec<_>>().join(", ");
        rows.push(("start", format!("({angles})°")));
    }
    if let Some(tip) = &cell.work.tip {
        rows.push(("tip", format!("{}, flange axes", frame(tip))));
    }
    if cell.work.workpiece != Isometry3::identity() {
        let at = frame(&cell.work.workpiece);
        rows.push(("workpiece", format!("{at}, base axes")));
    }
    rows
}

/// The solids of a part, of many how many there are and the largest.
fn solids(part: &Part) -> String {
    let descriptions: Vec<String> = part.solids.iter().map(solid).collect();
    match descriptions.as_slice() {
        few if few.len() <= FEW => few.join("; "),
        many => format!("{} solids, the first {}", many.len(), many[0]),
    }
}

fn solid(solid: &Solid) -> String {
    match solid {
        Solid::Capsule(capsule) => {
            format!("capsule, radius {}, {} to {}", length(capsule.radius), place(&capsule.a), place(&capsule.b))
        }
        Solid::Block { pose, half } => {
            let size = half.map(|half| 2.0 * half);
            let sides = size.iter().map(|side| coarse(*side).digits());
            let sides = sides.collect::<Vec<_>>().join(" × ");
            format!("box {sides} mm at {}", frame(pose))
        }
        Solid::Cylinder { pose, half_length, radius } => format!(
            "cylinder, radius {}, {} long, its middle at {}",
            length(*radius),
            length(2.0 * half_length),
            place(&pose.translation.vector)
        ),
        Solid::HalfSpace { point, normal } => {
            let height = point.dot(normal);
            let [x, y, z] = [normal.x, normal.y, normal.z].map(|n| Number::computed(n).digits());
            format!("plane at {} along ({x}, {y}, {z})", length(height))
        }
    }
}

fn frame(pose: &Isometry3<f64>) -> String {
    let at = place(&pose.translation.vector);
    let (roll, pitch, yaw) = pose.rotation.euler_angles();
    if pose.rotation.angle() < 1e-9 {
        return at;
    }
    let turn = [roll, pitch, yaw].map(|a| Number::computed(a.to_degrees()).digits());
    format!("{at}, turned by rpy ({})°", turn.join(", "))
}

fn place(position: &Vector3<f64>) -> String {
    let digits: Vec<String> = position.iter().map(|m| coarse(*m).digits()).collect();
    format!("({}) mm", digits.join(", "))
}

/// A length; one that is no whole number of tenths with more digits.
fn length(m: f64) -> String {
    let small = m.abs() < 1e-3 && m != 0.0;
    let number = coarse(m);
    let number = if small { number.decimals(3) } else { number };
    number.text()
}
