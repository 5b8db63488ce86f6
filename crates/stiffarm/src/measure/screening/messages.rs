//! The suspicions in words: what, where, the likely cause, what to do.

use super::facts::{facts, severity};
use super::sizes::{degrees, mistyped, mm, times};
use super::{Cause, Suspicion};
use crate::findings::{Finding, list};
use crate::model::cell::Cell;
use crate::model::load::Load;

/// The finding of one suspicion.
pub(super) fn finding(cell: &Cell, s: &Suspicion) -> Finding {
    let (code, of_all, _) = facts(s.cause);
    let subject = if s.postures.is_empty() {
        of_all.to_string()
    } else {
        subject(s)
    };
    Finding::new(code, severity(s), subject, sentence(cell, s))
}

/// Posture and state, and the point where it is one reading.
fn subject(s: &Suspicion) -> String {
    let mut out = place(s);
    if s.certain && matches!(s.cause, Cause::StrayReading | Cause::StrayRepeat) {
        out += &format!(", point {}", list(&s.points));
    }
    out
}

/// `posture 3, loaded`, or `postures 2 and 5`; empty for all.
fn place(s: &Suspicion) -> String {
    let mut out = match &s.postures[..] {
        [] => return String::new(),
        [one] => format!("posture {one}"),
        more => format!("postures {}", list(more)),
    };
    if !s.states.is_empty() {
        out += &format!(", {}", list(&s.states));
    }
    out
}

/// The place at the beginning of a sentence.
fn opening(s: &Suspicion) -> String {
    let place = place(s);
    match place.strip_prefix('p') {
        Some(rest) => format!("P{rest}"),
        None => "All postures".to_string(),
    }
}

fn lines(s: &Suspicion) -> String {
    let numbers: Vec<String> = s.lines.iter().map(usize::to_string).collect();
    match &numbers[..] {
        [] => String::new(),
        [one] => format!(" (line {one})"),
        more => format!(" (lines {})", list(more)),
    }
}

/// `from 152 mm to 0.03 mm`.
fn fall(s: &Suspicion) -> String {
    match (s.before_m, s.after_m) {
        (Some(before), Some(after)) => format!("from {} to {}", mm(before), mm(after)),
        _ => "clearly".to_string(),
    }
}

fn alternatives(s: &Suspicion) -> String {
    match s.alternatives.len() {
        0 => String::new(),
        _ => format!(" Explains it as well: {}.", list(&s.alternatives)),
    }
}

/// The cause as half a sentence, for lists of alternatives.
pub(super) fn cause(cell: &Cell, s: &Suspicion) -> String {
    let joints = list(&s.joints);
    match s.cause {
        Cause::ExchangedPoints if s.points.len() == 2 => {
            format!("points {} are exchanged", list(&s.points))
        }
        Cause::ExchangedPoints => format!("points {} are mixed up", list(&s.points)),
        Cause::MirroredFrame => {
            "an axis has the wrong sign, or two columns are exchanged".to_string()
        }
        Cause::JointSign if s.joints.len() == 1 => format!("{joints} turns the other way"),
        Cause::JointSign => format!("{joints} turn the other way"),
        Cause::Coupling => {
            let axis = |j: usize| cell.setup.robot.joints().get(j).map_or("", |j| &j.name);
            let stated = cell.setup.robot.coupling()[(2, 1)];
            let mut out = match (stated, s.factor.unwrap_or(0.0)) {
                (0.0, likely) => format!(
                    "{} were coupled to {} (its serial angle contains {likely:+} times the other's; in the cell it does not)",
                    axis(2),
                    axis(1)
                ),
                (stated, 0.0) => format!(
                    "{} were not coupled to {} (in the cell its serial angle contains {stated:+} times the other's)",
                    axis(2),
                    axis(1)
                ),
                (stated, likely) => format!(
                    "the serial angle of {} contained {likely:+} times that of {}, not {stated:+} times",
                    axis(2),
                    axis(1)
                ),
            };
            if !s.joints.is_empty() {
                let turn = if s.joints.len() == 1 { "turns" } else { "turn" };
                out += &format!(" and {joints} {turn} the other way");
            }
            out
        }
        Cause::JointOffset if is_last(cell, s) => format!(
            "the tool sat turned by {} about the axis of {joints} on the flange, or {joints} were off by that throughout",
            angle(s, 0)
        ),
        Cause::JointOffset => {
            format!("{joints} is off by {} throughout", angle(s, 0))
        }
        Cause::Radians => "the angles are in radians".to_string(),
        Cause::Degrees => "the angles are in degrees".to_string(),
        Cause::AngleSign | Cause::MistypedAngle => {
            format!("{joints} is {}, not {}", angle(s, 1), angle(s, 0))
        }
        Cause::DhConvention => {
            let other = cell.setup.robot.convention().other().name();
            format!("its rows were {other} ones")
        }
        Cause::OtherPosture | Cause::ExchangedPostures => match s.postures.get(1) {
            Some(other) => format!("the angles of posture {other}"),
            None => "the angles of another posture".to_string(),
        },
        Cause::ToolPlace => tool_place(s),
        _ => super::scale::messages::phrase(s),
    }
}

/// How all measuring points sit elsewhere: `moved by (0.0, 0.0, 100.0) mm and turned by 90.0° about (0.00, 0.00, 1.00)`.
fn tool_place(s: &Suspicion) -> String {
    let vector = |of: &[f64], digits: usize| {
        let all = of.iter().map(|v| format!("{:.digits$}", v + 0.0));
        all.collect::<Vec<_>>().join(", ")
    };
    let size = s.angles_deg.iter().map(|a| a * a).sum::<f64>().sqrt();
    let axis: Vec<f64> = s.angles_deg.iter().map(|a| a / size).collect();
    let mut out = format!("moved by ({}) mm", vector(&s.tool_shift_mm, 1));
    if size > 0.05 {
        out += &format!(" and turned by {size:.1}° about ({})", vector(&axis, 2));
    }
    out
}

/// True where the last joint alone is meant.
fn is_last(cell: &Cell, s: &Suspicion) -> bool {
    let last = cell.setup.robot.joints().last();
    last.is_some_and(|last| s.joints == [last.name.as_str()])
}

fn angle(s: &Suspicion, i: usize) -> String {
    s.angles_deg
        .get(i)
        .map_or_else(String::new, |a| degrees(*a))
}

fn sentence(cell: &Cell, s: &Suspicion) -> String {
    let (opening, place, cause) = (opening(s), place(s), cause(cell, s));
    let (fall, also, lines) = (fall(s), alternatives(s), lines(s));
    let (joints, points) = (list(&s.joints), list(&s.points));
    let [off, before, after] =
        [s.off_m, s.before_m, s.after_m].map(|l| l.map_or_else(String::new, mm));
    let [written, likely] = [0, 1].map(|i| angle(s, i));
    let (times, size) = times(s.factor);
    let state = match &s.states[..] {
        [] => String::new(),
        states => format!(" in state {}", list(states)),
    };
    match s.cause {
        Cause::Units => {
            let typed = match s.factor {
                Some(f) if f < 0.002 => "metres under a heading in millimetres, or millimetres under one in micrometres",
                Some(f) if f > 900.0 => "micrometres under a heading in millimetres, or millimetres under one in metres",
                Some(f) if (f - 25.4).abs() < 0.1 => "millimetres under a heading in inches",
                Some(f) if (f * 25.4 - 1.0).abs() < 0.01 => "inches under a heading in millimetres",
                Some(f) if f < 1.0 => "a larger unit than the heading's",
                _ => "a smaller unit than the heading's",
            };
            let where_ = if place.is_empty() { "all postures" } else { &place };
            let what = match cell.setup.tool.point_count() {
                1 => "positions spread",
                _ => "distances between the measuring points are",
            };
            format!(
                "In {where_} the {what} {times} times too {size}: the coordinates seem to be {typed}. Correct the \
                 heading's unit or the numbers."
            )
        }
        Cause::ToolUnits => {
            let (times, size) = super::sizes::times(s.factor.map(|f| 1.0 / f));
            let size = if size == "large" { "far" } else { "close" };
            format!(
                "The tool's measuring points lie {times} times too {size} apart in the cell, while the arm's reach is \
                 right: check the unit of tool.measuring_point."
            )
        }
        Cause::ExchangedPoints if place.is_empty() => format!(
            "In all postures {cause}: with that undone the misfit falls {fall}.{also} Correct the names in the readings \
             or the positions in the cell."
        ),
        Cause::ExchangedPoints => {
            let one = if s.states.len() > 1 { " in one of the two states" } else { "" };
            format!(
                "{opening}: {cause}{one}; with that undone the misfit falls {fall}.{also} Correct the names of the points."
            )
        }
        Cause::StrayRepeat => match s.repeat {
            Some(number) => format!(
                "{opening}: reading {number} of point {points} lies {off} from the others{lines}. Remove it or measure again."
            ),
            None => format!(
                "{opening}: readings of point {points} lie {off} apart{lines}, and nothing tells which is right. Measure again."
            ),
        },
        Cause::StrayReading if s.certain => format!(
            "{opening}: point {points} is read {off} from where the other points have it{lines}. Check that reading \
             (reflector not seated, typing slip), remove it or measure it again."
        ),
        Cause::StrayReading => {
            let either = points.replace(" and ", " or ");
            format!(
                "{opening}: one of the points {either} is read about {off} off; the readings do not tell which. Measure \
                 this state again or leave it out."
            )
        }
        Cause::MovedReflector => format!(
            "{opening}: point {points} lies up to {off} elsewhere than in the other postures. Its reflector was moved or \
             badly seated: leave the point out there or measure again."
        ),
        Cause::UnsteadyShape if place.is_empty() => format!(
            "The measuring points do not keep their distances (up to {off}): the tool yields or reflectors are loose. \
             Displacements contain that motion."
        ),
        Cause::UnsteadyShape => format!(
            "{opening}: the points lie up to {off} from the tool's shape in the other states, and no single reading \
             explains it. Measure again or leave it out."
        ),
        Cause::Drawing => {
            let what = match s.points.len() {
                1 => format!("Point {points} lies {off} from where the cell has it"),
                _ => format!("The points lie up to {off} from where the cell has them"),
            };
            if s.certain {
                format!("{what}; all states agree with each other, so the drawing is inexact.")
            } else {
                format!("{what}: check tool.measuring_point in the cell.")
            }
        }
        Cause::MirroredFrame => {
            let which = match s.axis_slips.join(" or ").as_str() {
                "" => "Which it is the readings cannot tell: look at the export.".to_string(),
                slips => format!("First check {slips}: so the tracker stands as given, or parallel to the base."),
            };
            format!(
                "The readings are mirrored: {cause}. With that undone the misfit of the unloaded points falls {fall}.{also} \
                 {which}"
            )
        }
        Cause::ToolPlace => format!(
            "The unloaded points fit the robot if all measuring points are {cause} in flange axes: the misfit falls {fall}. \
             Check origin and axes of tool.measuring_point, and of tool.loading_point_mm with them."
        ),
        // The tool is all that hangs on the last joint.
        Cause::JointOffset if is_last(cell, s) => format!(
            "The cell does not fit its unloaded readings, but would if {cause}: the misfit falls {fall}.{also} Check the \
             turn of tool.measuring_point first, then robot.dh (offset) against the pendant."
        ),
        Cause::JointSign | Cause::Coupling | Cause::JointOffset | Cause::DhConvention => {
            let own = cell.setup.robot.convention();
            let rows = format!("Name the rows robot.dh_{}, not robot.dh_{}", own.other().name(), own.name());
            let check = match s.cause {
                Cause::JointOffset => "Check robot.dh (offset) against the pendant",
                Cause::DhConvention => &rows,
                _ => "Check robot.theta_from_q against the pendant",
            };
            format!(
                "The robot's description does not fit its unloaded readings, but would if {cause}: the misfit falls \
                 {fall}.{also} {check}."
            )
        }
        Cause::Radians if s.misfits.is_none() => format!(
            "The joint angles seem to be radians under a heading in degrees: read so, the misfit of the unloaded points \
             falls {fall}.{also} Convert them."
        ),
        Cause::GivenTransform => format!(
            "The given transform from tracker to base leaves the unloaded points {before} from the kinematic model, the \
             best one {after}; they differ by a turn of {written}. Was the tracker moved after registration?"
        ),
        Cause::MovedTracker => super::moved::sentence(s, [&before, &after, &off]),
        Cause::AngleSign => format!(
            "{opening}: the readings fit if {cause} (sign?); the misfit falls {fall}.{also} Correct the angle."
        ),
        Cause::MistypedAngle => {
            let how = match s.angles_deg[..] {
                [written, likely] => mistyped(crate::units::rad_to_shortest_deg(written.to_radians()), likely),
                _ => "",
            };
            format!(
                "{opening}: the readings fit if {joints} is {likely}, not {written}{how}; the misfit falls {fall}.{also} \
                 Compare with the controller's log."
            )
        }
        Cause::ExchangedPostures => {
            let both = list(&s.postures);
            format!(
                "The readings of postures {both}{state} are exchanged: with that undone the misfit falls {fall}.{also} \
                 Exchange the rows."
            )
        }
        Cause::OtherPosture => {
            let [first, second] = [0, 1].map(|i| s.postures.get(i).map_or("", String::as_str));
            format!(
                "The readings of posture {first}{state} were taken at the angles of posture {second}: the misfit falls \
                 {fall}.{also} Copied rows, or the robot was not moved?"
            )
        }
        Cause::UnexplainedPosture if s.states.len() > 1 => format!(
            "{opening}: the points of these states lie up to {before} apart, more than any load moves them. Check the \
             rows, or leave the posture out."
        ),
        Cause::UnexplainedPosture => {
            let copied = match &s.alternatives[..] {
                [] => String::new(),
                same => format!(" Its angles equal those of posture {}: copied?", list(same)),
            };
            format!(
                "{opening}: the points lie {before} from the kinematic model, in the other postures {after}.{copied} No \
                 single slip of an angle or a name explains it: check its angles and readings, and that the tracker stood \
                 still, or leave it out."
            )
        }
        Cause::UnexplainedModel => format!(
            "The unloaded points do not fit the kinematic model: they lie {off} from it, and no single cause (signs, \
             coupling, offsets, names of points, mirrored axes) explains it. Check the robot and the tool in the cell."
        ),
        Cause::NoDisplacement => format!(
            "{opening}: the points do not move under the load. Are the loaded rows copies of the unloaded ones, or was the \
             load not applied?"
        ),
        Cause::ReversedForce => {
            let either = match (&cell.sensor, &cell.setup.load) {
                (Some(_), _) => {
                    "the sensor reports the force by the robot where the cell says on it, or the other way round \
                     (sensor.reports), or its axes are turned"
                }
                (None, Load::Measured) => "the forces are those by the robot instead of those on it",
                _ => "the load's direction in the cell is wrong",
            };
            format!(
                "The points move against the force in every posture. Either {either}, or loaded and unloaded rows are \
                 exchanged."
            )
        }
        Cause::ExchangedStates => format!(
            "{opening}: the points move against the force, in the other postures along it. The loaded and the unloaded \
             rows are exchanged there, or the force has the wrong sign."
        ),
        Cause::DisplacementSize => format!(
            "The displacements are {times} times too {size} for the prior stiffness. Check the unit of the force (N, not \
             kN), the load and stiffness.prior_nm_per_rad (N·m/rad)."
        ),
        Cause::OtherLoad => format!(
            "{opening}: the displacements are {times} times too {size} compared with the other states. Was the load \
             another one?"
        ),
        Cause::NotChecked => {
            "Too few unloaded readings to register the tracker: the checks against the kinematic model were left out."
                .to_string()
        }
        _ => super::scale::messages::sentence(cell, s, &opening),
    }
}
