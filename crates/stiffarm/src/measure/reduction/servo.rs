//! How far the controller itself gives way under load, where its angles were
//! recorded state by state.

use crate::error::Result;
use crate::findings::{Finding, Severity};
use crate::measure::series::{PostureSeries, mean_angles};
use crate::model::cell::Cell;
use crate::model::kinematics::Frames;
use crate::model::measurement::{Displacement, MeasuredPosture, ReferencePart};
use nalgebra::DVector;

/// Angles of the loaded state `number` minus those of its reference, where both
/// are recorded. The reference is what the positions were taken against: the
/// states of `parts`, each with its share, or, where one of them has no
/// angles, the mean of those that have.
pub(super) fn give(posture: &PostureSeries<'_>, number: usize, parts: &[ReferencePart]) -> Option<Vec<f64>> {
    let states = &posture.readings.states;
    let loaded = states[number].angles.as_ref()?;
    let recorded: Option<Vec<(&Vec<f64>, f64)>> =
        parts.iter().map(|part| Some((states[part.state as usize].angles.as_ref()?, part.weight))).collect();
    let reference = match recorded {
        // Equal angles stay what they are, to the bit.
        Some(all) => all.first().map(|(first, _)| {
            let at = |j: usize| {
                let from_first = all.iter().map(|(q, weight)| weight * (q[j] - first[j]));
                first[j] + from_first.sum::<f64>()
            };
            (0..first.len()).map(at).collect()
        }),
        None => None,
    };
    let reference = reference.or_else(|| mean_angles(posture.readings, posture.reference))?;
    Some(loaded.iter().zip(&reference).map(|(a, b)| a - b).collect())
}

/// One servo deflection for all points of a state: the mean of `gives`. Points
/// taken against other references (one was not read in all of them) have the
/// difference taken off their displacement.
///
/// # Errors
/// Angles of the wrong number or not finite.
pub(super) fn one_give(
    cell: &Cell,
    q: &[f64],
    gives: &[Option<Vec<f64>>],
    displacements: &mut [Displacement],
) -> Result<Option<Vec<f64>>> {
    let all_gives: Option<Vec<&Vec<f64>>> = gives.iter().map(Option::as_ref).collect();
    let Some((first, all)) = all_gives.as_ref().and_then(|all| Some((*all.first()?, all))) else {
        return Ok(None);
    };
    if all.iter().all(|give| *give == first) {
        return Ok(Some(first.clone()));
    }
    let robot = &cell.setup.robot;
    crate::model::observation::check_angles(robot, first)?;
    let count = all.len() as f64;
    let mean: Vec<f64> = (0..first.len()).map(|j| all.iter().map(|give| give[j]).sum::<f64>() / count).collect();
    let frames = Frames::new(robot, q);
    for (displacement, give) in displacements.iter_mut().zip(all) {
        let more = DVector::from_fn(mean.len(), |j, _| give[j] - mean[j]);
        let theta = robot.coupling() * more;
        let point = frames.point(&cell.setup.tool.measuring_points[displacement.point].position);
        for (j, angle) in theta.iter().enumerate() {
            displacement.value -= frames.column(j, &point) * *angle;
        }
    }
    Ok(Some(mean))
}

/// Drops angles that are the same in all states: the table repeats the planned
/// ones. Says how far the controller gave way otherwise.
pub(super) fn servo_deflection(cell: &Cell, measured: &mut [MeasuredPosture], findings: &mut Vec<Finding>) {
    let mut largest = (0.0_f64, 0, 0);
    for (i, m) in measured.iter().enumerate() {
        for (j, give) in m.servo_deflection.iter().flatten().enumerate() {
            if give.abs() > largest.0 {
                largest = (give.abs(), i, j);
            }
        }
    }
    let (give, i, j) = largest;
    if give == 0.0 {
        measured.iter_mut().for_each(|m| m.servo_deflection = None);
        return;
    }
    let without = measured.iter().filter(|m| m.servo_deflection.is_none()).count();
    let some = match without {
        0 => String::new(),
        n => format!(" {n} loaded states have no angles: there the servo give stays in the displacements."),
    };
    findings.push(Finding::new(
        "servo-give",
        if without > 0 { Severity::Caution } else { Severity::Note },
        "servo_give",
        format!(
            "The controller's own angles change under load by up to {:.4}° ({}, posture {}, state {}): this share of a \
             displacement is not the joints' elasticity.{some}",
            give.to_degrees(),
            cell.setup.robot.joints()[j].name,
            measured[i].posture.name,
            measured[i].state
        ),
    ));
}
