//! What the readings ask of the set-up, in sentences.

use super::{FreedQuantity, Word};
use crate::estimate::quantity::facts::{Numbers, Quantity};
use crate::estimate::quantity::stated::{anchor, gravity, loading_point};
use crate::estimate::quantity::value::{QuantityAtValue, QuantityValue};
use crate::findings::{Finding, codes, length, list, visible};
use crate::model::cell::Cell;
use crate::model::load::Load;
use crate::units::{STANDARD_GRAVITY, m_to_mm, rad_to_deg, rounded};
use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

/// Decimals of a degree at most: pendants show no more.
const MOST_DECIMALS: usize = 4;
/// Standard errors of what is printed behind ±.
const COVERAGE: f64 = 2.0;

/// The key of the cell that states it, else what it is about.
pub(super) fn key(cell: &Cell, quantity: Quantity) -> String {
    let key = quantity.facts().key;
    let of_case = match quantity {
        Quantity::Anchor(i) | Quantity::LoadingPoint(Some(i)) => cell.setup.load.has_cases().then_some(i),
        _ => None,
    };
    match (of_case, key.strip_prefix("load.")) {
        (Some(i), Some(rest)) => format!("load.case[{i}].{rest}"),
        _ if quantity == Quantity::Rows => {
            format!("{key}_{}", cell.setup.robot.convention().name())
        }
        _ => key.to_string(),
    }
}

/// What it is, as another explanation.
fn other(cell: &Cell, quantity: Quantity) -> String {
    let name = match quantity {
        Quantity::Angle(j) => &cell.setup.robot.joints()[j].name,
        _ => cell.setup.load.line(),
    };
    quantity.facts().other.replace("{}", name)
}

/// What the cell states.
pub(super) fn stated(cell: &Cell, quantity: Quantity) -> Vec<f64> {
    let vector = |v: Vector3<f64>| v.iter().copied().collect();
    match quantity {
        Quantity::Anchor(i) => vector(anchor(cell, i)),
        Quantity::LoadingPoint(_) => vector(loading_point(cell, quantity)),
        Quantity::Gravity => vector(down(cell)),
        Quantity::Sign => vec![1.0],
        _ if quantity.facts().numbers == Numbers::None => vec![0.0],
        _ => vec![0.0; quantity.dimension(cell.setup.robot.joint_count())],
    }
}

fn down(cell: &Cell) -> Vector3<f64> {
    let direction = |load: &Load| match load {
        Load::Weight { direction, .. } => Some(*direction),
        _ => None,
    };
    let weight_direction = cell.setup.load.each().find_map(direction);
    weight_direction.unwrap_or(*cell.setup.robot.gravity_direction())
}

/// What the readings ask for.
pub(super) fn asked(cell: &Cell, quantity: Quantity, place: &QuantityValue) -> Vec<f64> {
    let vector = |v: Vector3<f64>| v.iter().copied().collect();
    match quantity {
        Quantity::Anchor(i) => vector(anchor(cell, i) + place.vector()),
        Quantity::LoadingPoint(_) => vector(loading_point(cell, quantity) + place.vector()),
        Quantity::Gravity => vector(gravity(&down(cell), place)),
        Quantity::SensorAxes => vector(turn_vector(&place.rotated())),
        Quantity::Registration => vector(turn_vector(&place.rotated().transpose())),
        _ if quantity.facts().numbers == Numbers::None => vec![place.turn[(0, 0)]],
        Quantity::Points => [vector(place.vector()), vector(turn_vector(&place.rotated()))].concat(),
        _ => place.values.iter().copied().collect(),
    }
}

/// Axis times angle of a turn, of a mirrored one that of its opposite.
fn turn_vector(turn: &Matrix3<f64>) -> Vector3<f64> {
    let proper = turn * turn.determinant().signum();
    UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(proper)).scaled_axis()
}

/// Axes as columns are named: `x is y, y is −x`, where they are exchanged or flipped, else the turn.
fn axes(turn: &Matrix3<f64>) -> String {
    const NAMES: [&str; 3] = ["x", "y", "z"];
    let nearest = turn.map(f64::round);
    let is_exchange = (turn - nearest).norm() < 0.05 && (nearest.determinant().abs() - 1.0).abs() < 1e-9;
    if !is_exchange || nearest == Matrix3::identity() {
        let axis = turn_vector(turn);
        let unit = axis.try_normalize(1e-12).unwrap_or_default();
        return format!(
            "turned by {:.1}° about ({:.2}, {:.2}, {:.2}){}",
            rad_to_deg(axis.norm()),
            unit.x,
            unit.y,
            unit.z,
            if turn.determinant() < 0.0 { " and mirrored" } else { "" }
        );
    }
    let mut out = Vec::new();
    for i in 0..3 {
        let j = (0..3).find(|j| nearest[(i, *j)] != 0.0).unwrap_or(i);
        if nearest[(i, j)] != 1.0 || i != j {
            let sign = if nearest[(i, j)] < 0.0 { "−" } else { "" };
            out.push(format!("{} is {sign}{}", NAMES[i], NAMES[j]));
        }
    }
    list(&out)
}

/// Millimetres in brackets, with the digits that the errors allow.
fn place_mm(values: &[f64], errors: &[f64]) -> String {
    let largest = errors.iter().copied().fold(0.0, f64::max) * COVERAGE;
    let digits = if largest < 1e-4 { 2 } else { usize::from(largest < 2e-3) };
    let one = |v: &f64| format!("{:.digits$}", m_to_mm(*v) + 0.0);
    let all: Vec<String> = values.iter().map(one).collect();
    match largest {
        l if l.is_finite() && l > 0.0 => {
            format!("({}) ± {:.digits$} mm", all.join(", "), m_to_mm(l))
        }
        _ => format!("({}) mm", all.join(", ")),
    }
}

/// Degrees with the decimals that their error has, at least one.
fn with_error_deg(value: f64, error: f64) -> String {
    let shown = |decimals: &usize| error <= 0.0 || error >= 0.5 * 0.1f64.powi(*decimals as i32);
    let decimals = (1..MOST_DECIMALS).find(shown).unwrap_or(MOST_DECIMALS);
    format!("{:.decimals$}° ± {error:.decimals$}°", rounded(value, decimals as i32))
}

fn bare_mm(values: &[f64]) -> String {
    let all: Vec<String> = values.iter().map(|v| format!("{:.0}", m_to_mm(*v) + 0.0)).collect();
    format!("({})", all.join(", "))
}

/// What the readings ask for, in words.
pub(super) fn wanted(cell: &Cell, (quantity, place): &QuantityAtValue, freed: &FreedQuantity) -> String {
    let key = &freed.key;
    let errors = freed.standard_error.iter().map(|e| e.unwrap_or(0.0));
    let (values, errors): (_, &Vec<f64>) = (&freed.asked, &errors.collect());
    match quantity {
        Quantity::Anchor(_) => {
            format!("the anchor at {}; {key} has {}", place_mm(values, errors), bare_mm(&freed.stated))
        }
        Quantity::LoadingPoint(_) => format!(
            "the loading point at {} in flange axes; {key} has {}{}",
            place_mm(values, errors),
            bare_mm(&freed.stated),
            known_point(cell, values, errors)
        ),
        Quantity::Gravity => format!(
            "gravity along ({:.3}, {:.3}, {:.3}) in base axes; {key} has ({:.3}, {:.3}, {:.3})",
            values[0] + 0.0,
            values[1] + 0.0,
            values[2] + 0.0,
            freed.stated[0],
            freed.stated[1],
            freed.stated[2]
        ),
        Quantity::Beside => {
            let force = place.vector();
            let vertical = force.dot(cell.setup.robot.gravity_direction());
            let mass = if vertical > 0.9 * force.norm() {
                format!(", the weight of {:.1} kg", vertical / STANDARD_GRAVITY)
            } else {
                String::new()
            };
            let error = errors.iter().copied().fold(0.0, f64::max) * COVERAGE;
            format!(
                "a constant force beside the load, ({:.1}, {:.1}, {:.1}) ± {error:.1} N in base axes{mass}",
                force.x + 0.0,
                force.y + 0.0,
                force.z + 0.0
            )
        }
        Quantity::Shift => format!("a shift common to all loaded readings, {}", place_mm(values, errors)),
        Quantity::Offset => {
            format!("{:+.0} ± {:.0} N along the load in every loaded state", values[0], COVERAGE * errors[0])
        }
        Quantity::Sign => "the opposite sign of the load".to_string(),
        Quantity::SensorInBase => "forces that are given in base axes, not in those of the sensor".to_string(),
        Quantity::Points => format!(
            "measuring points moved by {} in flange axes and {}",
            place_mm(&values[..3], &errors[..3]),
            axes(&place.rotated())
        ),
        Quantity::SensorAxes => format!("the sensor's axes {}", axes(&place.rotated())),
        Quantity::SensorOrigin => {
            format!("the sensor's origin {} from where {key} has it, in flange axes", place_mm(values, errors))
        }
        Quantity::Registration => format!("other axes of the displacements: {}", axes(&place.rotated().transpose())),
        Quantity::Angle(j) => {
            let joint = &cell.setup.robot.joints()[*j].name;
            let offset = rad_to_deg(place.values[0]);
            let offset = (offset + 180.0).rem_euclid(360.0) - 180.0;
            let sign = place.turn[(0, 0)] < 0.0;
            let error = COVERAGE * rad_to_deg(errors[0]);
            let off = format!("off by {}", with_error_deg(offset, error));
            let said = match (sign, offset.abs() < 0.5) {
                (true, true) => "turning the other way".to_string(),
                (true, false) => format!("turning the other way and {off}"),
                (false, _) => off,
            };
            format!("{joint} {said}")
        }
        Quantity::Coupling => format!("axis 3 that counts {:+.0} times axis 2", place.turn[(0, 0)]),
        Quantity::Rows => format!("{} rows; the cell has them as {key}", cell.setup.robot.convention().other().name()),
        Quantity::LostMotion => format!(
            "lost motion in the joints, up to {:.2} arc-minutes",
            60.0 * rad_to_deg(values.iter().copied().fold(0.0, f64::max))
        ),
        Quantity::BaseTilt => format!("a base that tilts, {:.1e} N·m/rad about each horizontal axis", 1.0 / values[0]),
        // No residual tells these.
        Quantity::ForceScale | Quantity::Sensor => String::new(),
    }
}

/// The finding about the quantity that explains most.
pub(super) fn finding(
    cell: &Cell,
    quantity: Quantity,
    freed: &FreedQuantity,
    alike: &[Quantity],
    word: &Word,
) -> Finding {
    let wanted = match quantity {
        Quantity::Sign => "The points move against the stated load: the readings ask for its opposite sign".to_string(),
        _ => format!("The readings ask for {}", freed.words),
    };
    let remedy = match (quantity, &cell.sensor) {
        (Quantity::Sign, Some(_)) => {
            "Look up whether the sensor reports the force on the robot or by it (sensor.reports); a displacement is \
             the loaded position less the unloaded one"
        }
        _ => quantity.facts().check,
    };
    let names: Vec<String> = alike
        .iter()
        .map(|quantity| match (other(cell, *quantity), quantity.facts().apart) {
            (name, "") => name,
            (name, apart) => format!("{name} (told apart by {apart})"),
        })
        .collect();
    let others = match names.as_slice() {
        [] => String::new(),
        names => format!(" As well explained by {}.", list(names).replace(" and ", " or ")),
    };
    let [before, after] = freed.residual_rms_m.map(length);
    let fits = match quantity {
        Quantity::Sign => "With that no joint yields against its torque.".to_string(),
        _ => format!("With that the joint axes alone leave {after} instead of {before} (RMS)."),
    };
    let how = match word {
        Word::Rejected => None,
        Word::Likely => Some(". That is likely, not sure".to_string()),
        Word::BySprings => Some(", as far as springs beyond the axes do not excuse it".to_string()),
        Word::ByPosture(name) => Some(format!(". Posture {} alone says most of that: measure it again", visible(name))),
    };
    if let Some(how) = how {
        let sentence = format!("{wanted}{how}.{others} {remedy}. Until that is settled the total ± holds it.");
        return Finding::caution(codes::SET_UP_DOUBTFUL, freed.key.as_str(), sentence);
    }
    let sentence = format!("{wanted}. {fits}{others} {remedy}");
    match quantity {
        // No error of the set-up: it is measured around.
        Quantity::LostMotion => Finding::caution("lost-motion-seen", freed.key.as_str(), sentence + "."),
        Quantity::BaseTilt => Finding::caution("base-tilt-seen", freed.key.as_str(), sentence + "."),
        _ => Finding::serious(codes::SET_UP, freed.key.as_str(), sentence + "; until then no stiffness is known."),
    }
}

/// A point of the tool that lies where the readings want the loading point.
fn known_point(cell: &Cell, values: &[f64], errors: &[f64]) -> String {
    let at = Vector3::from_column_slice(values);
    let within = 3.0 * Vector3::from_column_slice(errors).norm();
    let points = cell.setup.tool.measuring_points.iter();
    let near = points.filter(|point| (point.position - at).norm() < within.max(2e-3));
    let nearest = near.min_by(|a, b| (a.position - at).norm().total_cmp(&(b.position - at).norm()));
    nearest.map_or_else(String::new, |point| format!(" (measuring point {} lies there)", point.name))
}

#[cfg(test)]
mod tests {
    use super::with_error_deg;

    #[test]
    fn a_small_angle_has_the_decimals_of_its_error() {
        assert_eq!(with_error_deg(-1.234, 0.21), "-1.2° ± 0.2°");
        assert_eq!(with_error_deg(-0.0123, 0.0044), "-0.012° ± 0.004°");
        assert_eq!(with_error_deg(-0.00001, 1e-7), "0.0000° ± 0.0000°");
        assert_eq!(with_error_deg(90.0, 0.0), "90.0° ± 0.0°");
    }
}
