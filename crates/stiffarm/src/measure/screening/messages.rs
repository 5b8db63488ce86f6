//! The suspicions in words: what, where, the likely cause, what to do.

use super::words::{
    alternatives, angle, below_or_above, cause, fall, is_last, lines, mistyped, mm, number, opening, place, times,
    typed, where_loads_stand,
};
use super::{Cause, Evidence, Suspicion};
use crate::findings::{Finding, list};
use crate::model::cell::Cell;
use crate::model::load::Load;
use crate::units::{m_to_mm, rad_to_shortest_deg};

/// The finding of one suspicion.
pub(super) fn finding(cell: &Cell, s: &Suspicion) -> Finding {
    let (code, of_all, _) = s.cause.facts();
    let reading = matches!(s.cause, Cause::StrayReading | Cause::StrayRepeat) && s.certain;
    let subject = match place(s) {
        all if all.is_empty() => of_all.to_string(),
        place if reading => format!("{place}, point {}", list(&s.points)),
        place => place,
    };
    Finding::new(code, s.severity(), subject, sentence(cell, s))
}

/// One of several sentences, by the cause: the words in braces are variables at hand.
macro_rules! sentences {
    ($cause:expr; $($of:pat $(if $when:expr)? => $sentence:literal)*) => {
        match $cause {
            $($of $(if $when)? => format!($sentence),)*
        }
    };
}

fn sentence(cell: &Cell, s: &Suspicion) -> String {
    let (opening, place, cause) = (opening(s), place(s), cause(cell, s));
    let (fall, also, lines) = (fall(s), alternatives(s), lines(s));
    let [joints, points, postures, states, same, confirmed] =
        [&s.joints, &s.points, &s.postures, &s.states, &s.alternatives, &s.confirmed_by].map(|of| list(of));
    let [off, before, after] = [s.off_m, s.before_m, s.after_m].map(|l| l.map_or_else(String::new, mm));
    let [written, likely] = [0, 1].map(|i| angle(s, i));
    let (typed, where_loads_stand) = (typed(s), where_loads_stand(cell));
    let (many, size) = times(s.factor);
    let factor = s.factor.unwrap_or(1.0);
    let [factor, inverse] = [factor, 1.0 / factor].map(number);
    let is_whole = s.postures.is_empty();
    if s.cause == Cause::MovedTracker {
        return super::moved::sentence(s, [&before, &after, &off]);
    }
    // Where.
    let all = if is_whole { "all postures" } else { &place };
    let [entry, filed] = if is_whole {
        [format!("State {states}, in every posture"), "In the whole table".to_string()]
    } else {
        [opening.clone(), format!("In posture {postures}")]
    };
    let in_state = if s.states.is_empty() { String::new() } else { format!(" in state {states}") };
    let in_one = if s.states.len() > 1 { " in one of the two states" } else { "" };
    let either_point = points.replace(" and ", " or ");
    let [first, second] = [0, 1].map(|i| s.postures.get(i).map_or("", String::as_str));
    let (nth, away) = (s.repeat.unwrap_or(0), m_to_mm(s.off_m.unwrap_or_default()));
    // What.
    let heading = match s.factor {
        Some(f) if f < 0.002 => "metres under a heading in millimetres, or millimetres under one in micrometres",
        Some(f) if f > 900.0 => "micrometres under a heading in millimetres, or millimetres under one in metres",
        Some(f) if (f - 25.4).abs() < 0.1 => "millimetres under a heading in inches",
        Some(f) if (f * 25.4 - 1.0).abs() < 0.01 => "inches under a heading in millimetres",
        Some(f) if f < 1.0 => "a larger unit than the heading's",
        _ => "a smaller unit than the heading's",
    };
    let distances = match cell.setup.tool.point_count() {
        1 => "positions spread",
        _ => "distances between the measuring points are",
    };
    let apart = if size == "small" { "far" } else { "close" };
    let drawn = match s.points.len() {
        1 => format!("Point {points} lies {off} from where the cell has it"),
        _ => format!("The points lie up to {off} from where the cell has them"),
    };
    let how = match s.angles_deg[..] {
        [written, likely] => mistyped(rad_to_shortest_deg(written.to_radians()), likely),
        _ => "",
    };
    let percent = |i: usize| s.misfits.map_or(0.0, |misfits| 100.0 * misfits[i]);
    let [as_typed, with_it] = [0, 1].map(|i| format!("{:.0} %", percent(i)));
    let misfits = format!("{with_it} of the displacement is left unexplained, as it stands {as_typed}");
    // The stiffness beside what is known beforehand, for what is on everything.
    let usual = match cell.prior {
        Some(_) => "the prior",
        None => "what robots of this class have",
    };
    let stiffness = below_or_above(s.ratio.unwrap_or(1.0));
    let rests_on = match s.evidence {
        Some(Evidence::Prior) => {
            " Only this comparison speaks for it: look at the numbers before relying on the result.".to_string()
        }
        Some(Evidence::File) => format!(" The file itself says so too: {confirmed}."),
        _ => String::new(),
    };
    let by_readings = s.evidence == Some(Evidence::Readings);
    let beside = format!(
        "factor {factor}. As typed, the joint stiffness comes out {stiffness} {usual}, all joints \
         alike.{rests_on}{also}"
    );
    // What to do.
    let first_check = match s.axis_slips.join(" or ").as_str() {
        "" => "Which it is the readings cannot tell: look at the export.".to_string(),
        slips => {
            format!("First check {slips}: so the tracker stands as given, or parallel to the base.")
        }
    };
    let convention = cell.setup.robot.convention();
    let (stated, other) = (convention.name(), convention.other().name());
    let check = match s.cause {
        Cause::JointOffset => "Check robot.dh (offset) against the pendant".to_string(),
        Cause::DhConvention => format!("Name the rows robot.dh_{other}, not robot.dh_{stated}"),
        _ => "Check robot.theta_from_q against the pendant".to_string(),
    };
    let copied = match s.alternatives.len() {
        0 => String::new(),
        _ => format!(" Its angles equal those of posture {same}: copied?"),
    };
    let reversed = match (&cell.sensor, &cell.setup.load) {
        (Some(_), _) => {
            "the sensor reports the force by the robot where the cell says on it, or the other way round \
             (sensor.reports), or its axes are turned"
        }
        (None, Load::Measured) => "the forces are those by the robot instead of those on it",
        _ => "the load's direction in the cell is wrong",
    };
    // The heading says kilonewtons, or the cell's load is a thousand times too large.
    let kilonewtons = match factor.as_str() {
        "1/1000" => ", and whether a heading says kn (load_kn, fx_kn) above numbers in newtons",
        _ => "",
    };
    sentences! { s.cause;
        Cause::Units =>
            "In {all} the {distances} {many} times too {size}: the coordinates seem to be {heading}. Correct the \
             heading's unit or the numbers."
        Cause::ToolUnits =>
            "The tool's measuring points lie {many} times too {apart} apart in the cell, while the arm's reach is \
             right: check the unit of tool.measuring_point."
        Cause::ExchangedPoints if is_whole =>
            "In all postures {cause}: with that undone the misfit falls {fall}.{also} Correct the names in the \
             readings or the positions in the cell."
        Cause::ExchangedPoints =>
            "{opening}: {cause}{in_one}; with that undone the misfit falls {fall}.{also} Correct the names of the \
             points."
        Cause::StrayRepeat if s.repeat.is_some() =>
            "{opening}: reading {nth} of point {points} lies {off} from the others{lines}. Remove it or measure again."
        Cause::StrayRepeat =>
            "{opening}: readings of point {points} lie {off} apart{lines}, and nothing tells which is right. Measure \
             again."
        Cause::StrayReading if s.certain =>
            "{opening}: point {points} is read {off} from where the other points have it{lines}. Check that reading \
             (reflector not seated, typing slip), remove it or measure it again."
        Cause::StrayReading =>
            "{opening}: one of the points {either_point} is read about {off} off; the readings do not tell which. \
             Measure this state again or leave it out."
        Cause::MovedReflector =>
            "{opening}: point {points} lies up to {off} elsewhere than in the other postures. Its reflector was moved \
             or badly seated: leave the point out there or measure again."
        Cause::UnsteadyShape if is_whole =>
            "The measuring points do not keep their distances (up to {off}): the tool yields or reflectors are loose. \
             Displacements contain that motion."
        Cause::UnsteadyShape =>
            "{opening}: the points lie up to {off} from the tool's shape in the other states, and no single reading \
             explains it. Measure again or leave it out."
        Cause::Drawing if s.certain => "{drawn}; all states agree with each other, so the drawing is inexact."
        Cause::Drawing => "{drawn}: check tool.measuring_point in the cell."
        Cause::MirroredFrame =>
            "The readings are mirrored: {cause}. With that undone the misfit of the unloaded points falls \
             {fall}.{also} {first_check}"
        Cause::ToolPlace =>
            "The unloaded points fit the robot if all measuring points are {cause} in flange axes: the misfit falls \
             {fall}. Check origin and axes of tool.measuring_point, and of tool.loading_point_mm with them."
        // The tool is all that hangs on the last joint.
        Cause::JointOffset if is_last(cell, s) =>
            "The cell does not fit its unloaded readings, but would if {cause}: the misfit falls {fall}.{also} Check \
             the turn of tool.measuring_point first, then robot.dh (offset) against the pendant."
        Cause::JointSign | Cause::Coupling | Cause::JointOffset | Cause::DhConvention =>
            "The robot's description does not fit its unloaded readings, but would if {cause}: the misfit falls \
             {fall}.{also} {check}."
        Cause::Radians if s.misfits.is_none() =>
            "The joint angles seem to be radians under a heading in degrees: read so, the misfit of the unloaded \
             points falls {fall}.{also} Convert them."
        Cause::Radians =>
            "The joint angles seem to be radians under a heading in degrees: with them converted {misfits}. Convert \
             them."
        Cause::Degrees =>
            "The joint angles seem to be degrees under a heading in radians: read so, the arm is where the readings \
             have it. Name the columns q1_deg and so on, or convert them."
        Cause::GivenTransform =>
            "The given transform from tracker to base leaves the unloaded points {before} from the kinematic model, \
             the best one {after}; they differ by a turn of {written}. Was the tracker moved after registration?"
        Cause::AngleSign =>
            "{opening}: the readings fit if {cause} (sign?); the misfit falls {fall}.{also} Correct the angle."
        Cause::MistypedAngle =>
            "{opening}: the readings fit if {joints} is {likely}, not {written}{how}; the misfit falls {fall}.{also} \
             Compare with the controller's log."
        Cause::ExchangedPostures =>
            "The readings of postures {postures}{in_state} are exchanged: with that undone the misfit falls \
             {fall}.{also} Exchange the rows."
        Cause::OtherPosture =>
            "The readings of posture {first}{in_state} were taken at the angles of posture {second}: the misfit falls \
             {fall}.{also} Copied rows, or the robot was not moved?"
        Cause::UnexplainedPosture if s.states.len() > 1 =>
            "{opening}: the points of these states lie up to {before} apart, more than any load moves them. Check the \
             rows, or leave the posture out."
        Cause::UnexplainedPosture =>
            "{opening}: the points lie {before} from the kinematic model, in the other postures {after}.{copied} No \
             single slip of an angle or a name explains it: check its angles and readings, and that the tracker stood \
             still, or leave it out."
        Cause::UnexplainedModel =>
            "The unloaded points do not fit the kinematic model: they lie {off} from it, and no single cause (signs, \
             coupling, offsets, names of points, mirrored axes) explains it. Check the robot and the tool in the cell."
        Cause::NoDisplacement =>
            "{opening}: the points do not move under the load. Are the loaded rows copies of the unloaded ones, or was \
             the load not applied?"
        Cause::ReversedForce =>
            "The points move against the force in every posture. Either {reversed}, or loaded and unloaded rows are \
             exchanged."
        Cause::ExchangedStates =>
            "{opening}: the points move against the force, in the other postures along it. The loaded and the unloaded \
             rows are exchanged there, or the force has the wrong sign."
        Cause::DisplacementSize =>
            "The displacements are {many} times too {size} for the prior stiffness. Check the unit of the force (N, \
             not kN), the load and stiffness.prior_nm_per_rad (N·m/rad)."
        Cause::OtherLoad =>
            "{opening}: the displacements are {many} times too {size} compared with the other states. Was the load \
             another one?"
        Cause::LoadUnits if by_readings =>
            "The forces are {factor} times too small for the moments, by the stated loading point: they seem to be in \
             {typed}. Give {where_loads_stand}."
        Cause::LoadUnits => "The loads look like {typed}: {beside} Check {where_loads_stand}{kilonewtons}."
        Cause::LoadEntry =>
            "{entry}: what is typed as load looks like {typed}: factor {factor}. With it {misfits}.{also} Check \
             {where_loads_stand} there."
        Cause::MomentUnits =>
            "The moments seem to be {typed}: with {factor} times what is typed they are the forces times their lever \
             about the sensor. Give mx_nm, my_nm, mz_nm in N·m, or name the columns mx_nmm, my_nmm, mz_nmm."
        Cause::DisplacementUnits if by_readings =>
            "{opening}: the displacements look like {typed}: factor {factor}. With it {misfits}.{also} Correct the \
             rows."
        Cause::DisplacementUnits => "The displacements look like {typed}: {beside} Check dx_mm, dy_mm, dz_mm."
        Cause::PriorUnits =>
            "The prior stiffness looks like it is {typed}: {beside} Check stiffness.prior_nm_per_rad."
        Cause::AnchorUnits =>
            "The displacements point to another direction of the load: with load.anchor_mm times {factor}, {misfits}. \
             Check the unit of load.anchor_mm (mm)."
        Cause::LoadingPointUnits if by_readings =>
            "The displacements point to another loading point: with tool.loading_point_mm times {factor}, {misfits}. \
             Check the unit of tool.loading_point_mm (mm)."
        Cause::LoadingPointUnits =>
            "The loading point lies {away:.2} mm from the flange's origin, and no measuring point is near: it looks \
             like metres typed as millimetres, factor {factor}. Check tool.loading_point_mm (mm)."
        Cause::RobotUnits =>
            "The robot's reach is {inverse} times that of the readings, while the tool is right: check the unit of the \
             robot's lengths (robot.dh rows in mm)."
        Cause::ExchangedLoadCases =>
            "{filed} the load cases {states} are exchanged: with the names the other way {misfits}. Correct the names \
             in the column state, or the loads of [load]."
        Cause::NotChecked | Cause::MovedTracker =>
            "Too few unloaded readings to register the tracker: the checks against the kinematic model were left out."
    }
}
