//! Numbers that are allowed but look like a slip of the unit.

use super::beside_arm::longest_tool;
use crate::findings::{Finding, Severity};
use crate::model::cell::Cell;
use crate::model::elastic::{ElasticClass, ElasticSizes};
use crate::model::implausible::{LARGEST_FORCE, NEAR_TOOL, payload_weight, tool_in_metres};
use crate::model::load::Load;
use crate::units::{STANDARD_GRAVITY, m_to_mm, rad_to_deg};
use nalgebra::Vector3;

/// Farthest plausible tool point \[m\].
const FAR_TOOL: f64 = 5.0;
/// Farthest plausible rope anchor \[m\].
const FAR_ANCHOR: f64 = 20.0;
/// Lengths of the cell below this look like metres typed as millimetres \[m\].
const LIKE_METRES: f64 = 0.02;
/// Smallest force that deflects an industrial robot measurably \[N\].
const SMALL_FORCE: f64 = 1.0;
/// What is so many times beyond plausible is no caution any more.
const SERIOUS_RATIO: f64 = 10.0;
/// Plausible joint stiffness of an industrial robot \[N·m/rad\].
const PLAUSIBLE_STIFFNESS: [f64; 2] = [1e3, 1e9];
/// Plausible standard deviation of a tracker reading \[m\].
const PLAUSIBLE_NOISE: [f64; 2] = [1e-7, 1e-3];
/// Largest plausible shift common to the points of a posture \[m\].
const LARGEST_COMMON_SHIFT: f64 = 1e-3;
/// Times the typical size beyond which what gives way beyond the axes is implausible.
const IMPLAUSIBLE_ELASTIC_RATIO: f64 = 30.0;
/// Bounds that all lie below this may be radians \[deg\]: a full turn is 6.28 rad.
const LIKE_RADIANS: f64 = 7.0;
/// Plausible characteristic length \[m\].
const PLAUSIBLE_LENGTH: [f64; 2] = [0.01, 10.0];

struct Slips<'a>(&'a mut Vec<Finding>);

impl Slips<'_> {
    fn add(&mut self, key: &str, sentence: String) {
        self.add_beyond(1.0, key, sentence);
    }

    /// As [`Slips::add`], of a number that is `times` as large as what is plausible.
    fn add_beyond(&mut self, times: f64, key: &str, sentence: String) {
        let severity = if times > SERIOUS_RATIO { Severity::Serious } else { Severity::Caution };
        self.0.push(Finding::new("suspicious-unit", severity, key, sentence));
    }
}

/// Looks at every number of the cell that carries a unit.
pub(super) fn check(cell: &Cell, findings: &mut Vec<Finding>) {
    let mut slips = Slips(findings);
    tool(cell, &mut slips);
    for single_load in cell.setup.load.each() {
        load(cell, single_load, &mut slips);
    }
    limits(cell, &mut slips);
    let degrees = cell.bounds.iter().flatten().map(|b| rad_to_deg(b.abs()));
    let widest = degrees.fold(0.0, f64::max);
    if widest > 0.0 && widest < LIKE_RADIANS {
        slips.add(
            "bounds.q_deg",
            format!("All bounds lie within {widest:.3}° of zero: are they in radians? The unit is degrees."),
        );
    }
    if let Some(prior) = &cell.prior {
        for (k, name) in prior.iter().zip(cell.setup.robot.spring_names()) {
            if !(PLAUSIBLE_STIFFNESS[0]..=PLAUSIBLE_STIFFNESS[1]).contains(k) {
                slips.add(
                    "stiffness.prior_nm_per_rad",
                    format!(
                        "The prior stiffness of {name} is {k:.3e} N·m/rad; industrial robots have 1e4 to 1e8. \
                         The unit is N·m/rad (not per degree, not N·mm)."
                    ),
                );
            }
        }
    }
    elastic(cell, &mut slips);
    let noise = cell.noise.reading_variance.sqrt();
    if noise > 0.0 && !(PLAUSIBLE_NOISE[0]..=PLAUSIBLE_NOISE[1]).contains(&noise) {
        slips.add_beyond(
            noise / PLAUSIBLE_NOISE[1],
            "noise",
            format!(
                "The standard deviation of a reading is {:.3e} mm; a laser tracker has some 0.01 mm. std_um takes it \
                 in µm, variance_mm2 its square in mm².",
                m_to_mm(noise)
            ),
        );
    }
    let common = cell.noise.posture_common_std;
    if common > LARGEST_COMMON_SHIFT {
        slips.add_beyond(
            common / LARGEST_COMMON_SHIFT,
            "noise.posture_common_mm",
            format!(
                "The points of a posture are said to share a shift of {} mm, more than a robot bends: the unit is mm.",
                m_to_mm(common)
            ),
        );
    }
    if let Some(length) = cell.characteristic_length
        && !(PLAUSIBLE_LENGTH[0]..=PLAUSIBLE_LENGTH[1]).contains(&length)
    {
        slips.add(
            "robot.characteristic_length_mm",
            format!("The characteristic length is {length:.3e} m: is it in mm?"),
        );
    }
}

/// Sizes of what gives way beyond the axes against those of an arm of this kind.
fn elastic(cell: &Cell, slips: &mut Slips<'_>) {
    let (Some(sizes), Some(prior)) = (&cell.elastic, &cell.prior) else {
        return;
    };
    let Ok(typical) = ElasticSizes::typical(&cell.setup, prior) else {
        return;
    };
    let keys = ["shift_std_m_per_n", "turn_std_rad_per_nm", "coupling_std_rad_per_n"];
    for (class, key) in ElasticClass::ENTRIES.into_iter().zip(keys) {
        let (size, usual) = (sizes.of(class), typical.of(class));
        if size > IMPLAUSIBLE_ELASTIC_RATIO * usual {
            slips.add(
                &format!("elastic.{key}"),
                format!(
                    "The size is {size:.1e} {unit}; an arm of this length and prior stiffness has some {usual:.1e} \
                     {unit}. Are there millimetres in it?",
                    unit = class.unit()
                ),
            );
        }
    }
}

fn tool(cell: &Cell, slips: &mut Slips<'_>) {
    let tool = &cell.setup.tool;
    let longest = longest_tool(&cell.setup.robot);
    let mut point = |key: &str, what: &str, position: &Vector3<f64>| {
        let distance = position.norm();
        if distance > FAR_TOOL {
            slips.add_beyond(
                distance / FAR_TOOL,
                key,
                format!("{what} lies {distance:.0} m from the flange: is it in mm?"),
            );
        } else if distance > longest {
            let sentence = format!(
                "{what} lies {:.0} mm from the flange, and the longest link of the arm is {:.0} mm: is it in base \
                 axes? Points of the tool are in flange axes.",
                m_to_mm(distance),
                m_to_mm(longest)
            );
            slips.add(key, sentence);
        } else if let Some(said) = tool_in_metres(position) {
            slips.add(key, format!("{what} {said}"));
        }
    };
    point("tool.loading_point_mm", "The loading point", &tool.loading_point);
    for (a, measuring) in tool.measuring_points.iter().enumerate() {
        let key = format!("tool.measuring_point[{}].position_mm", a + 1);
        let what = format!("Measuring point \"{}\"", measuring.name);
        point(&key, &what, &measuring.position);
    }
    if let Some(tip) = &cell.work.tip
        && tip.translation.vector.norm() > 0.0
    {
        point("work.tip_mm", "The tip", &tip.translation.vector);
    }
    for (t, task) in cell.tasks.iter().enumerate() {
        if task.tip != tool.tcp() && task.tip.norm() > 0.0 {
            let what = format!("The tip of task \"{}\"", task.name);
            point(&format!("task[{}].tip_mm", t + 1), &what, &task.tip);
        }
    }
    for (b, second) in tool.measuring_points.iter().enumerate() {
        for first in &tool.measuring_points[..b] {
            if (first.position - second.position).norm() < NEAR_TOOL {
                slips.add(
                    &format!("tool.measuring_point[{}].position_mm", b + 1),
                    format!("Measuring points \"{}\" and \"{}\" are the same place.", first.name, second.name),
                );
            }
        }
    }
}

fn load(cell: &Cell, load: &Load, slips: &mut Slips<'_>) {
    let (key, force) = match load {
        Load::Rope { anchor, magnitude } => {
            let line = cell.setup.load.line();
            let distance = anchor.norm();
            if distance > FAR_ANCHOR {
                let sentence = format!("The {line}'s anchor lies {distance:.0} m from the robot's base: is it in mm?");
                slips.add_beyond(distance / FAR_ANCHOR, "load.anchor_mm", sentence);
            } else if distance > 0.0 && distance < LIKE_METRES {
                let sentence = format!(
                    "The {line}'s anchor lies {:.2} mm from the robot's base: is it in metres? The unit is mm.",
                    m_to_mm(distance)
                );
                slips.add("load.anchor_mm", sentence);
            }
            ("load.magnitude_n", magnitude.abs())
        }
        Load::Weight { magnitude, .. } => ("load.magnitude_n", *magnitude),
        Load::Constant { wrench, .. } if wrench.moment.norm() == 0.0 => ("load.force_n", wrench.force.norm()),
        Load::Constant { .. } | Load::Measured | Load::Cases(_) => return,
    };
    if force < SMALL_FORCE {
        slips.add(key, format!("The load is {force} N, too little to deflect a robot. The unit is newtons."));
        return;
    }
    match payload_weight(&cell.setup.robot) {
        Some(weight) if force > weight => slips.add_beyond(
            force / weight,
            key,
            format!(
                "The load of {force:.0} N is more than the weight of the robot's payload, {:.0} kg or {weight:.0} N.",
                weight / STANDARD_GRAVITY
            ),
        ),
        None if force > LARGEST_FORCE => slips.add_beyond(
            force / LARGEST_FORCE,
            key,
            format!("The load of {force:.0} N is beyond the payload of industrial robots."),
        ),
        _ => {}
    }
}

fn limits(cell: &Cell, slips: &mut Slips<'_>) {
    let limits = &cell.limits;
    if let Some([low, high]) = &limits.tool_box {
        let size = high - low;
        if size.max() < LIKE_METRES {
            slips.add(
                "limits.box_max_mm",
                format!("The box is only {:.2} mm long: is it in metres? The unit is mm.", m_to_mm(size.max())),
            );
        }
    }
    if let Some(radius) = limits.keep_out_radius.filter(|r| *r < LIKE_METRES) {
        slips.add(
            "limits.keep_out_radius_mm",
            format!("The keep-out radius is {:.2} mm: is it in metres? The unit is mm.", m_to_mm(radius)),
        );
    }
    if let Some([_, longest]) = limits.rope_length.filter(|r| r[1] < LIKE_METRES) {
        slips.add(
            "limits.rope_length_mm",
            format!(
                "The longest {} is {:.2} mm: is it in metres? The unit is mm.",
                cell.setup.load.line(),
                m_to_mm(longest)
            ),
        );
    }
}
