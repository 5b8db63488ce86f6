//! Loads and cuts that are possible and yet hardly meant for this robot: results that
//! rest on them are printed, with a serious finding.

use crate::findings::{Finding, more};
use crate::model::cell::Cell;
use crate::model::load::Wrench;
use crate::model::path::PathPoint;
use crate::model::process::{Milling, Process};
use crate::model::robot::{Robot, catalogue};
use crate::model::work::Work;
use crate::units::{STANDARD_GRAVITY, m_to_mm};
use nalgebra::Vector3;

/// No process pushes with so many times the weight of a robot's payload.
const MOST_PAYLOADS: f64 = 5.0;
/// Largest force that counts as meant where the payload is unknown \[N\].
const LARGEST_PROCESS_FORCE: f64 = 1e5;
/// Largest load that a robot is tested with where its payload is unknown \[N\].
pub(crate) const LARGEST_FORCE: f64 = 2e4;
/// Length by which a force that counts as meant makes a moment \[m\].
const LEVER: f64 = 2.0;
/// Tangential cutting coefficients that materials have, foam to nickel alloys \[Pa\].
const COEFFICIENT: [f64; 2] = [1e6, 2e10];
/// Feeds per tooth that cutters have \[mm\]; beyond are slips of unit.
pub const FEEDS_PER_TOOTH_MM: [f64; 2] = [5e-4, 5.0];
/// Longest cutters \[m\].
const CUTTER: f64 = 0.3;

/// Nearest plausible tool point: a metre typed as millimetre is below it \[m\].
pub(crate) const NEAR_TOOL: f64 = 1e-3;

/// Says of a point of the tool \[m, flange axes\] that it looks like metres typed as millimetres,
/// where it does.
pub fn tool_in_metres(point: &Vector3<f64>) -> Option<String> {
    let distance = point.norm();
    (distance < NEAR_TOOL)
        .then(|| format!("lies {:.3} mm from the flange: is it in metres? The unit is mm.", m_to_mm(distance)))
}

/// Weight of the robot's payload \[N\], where the catalogue knows it.
pub fn payload_weight(robot: &Robot) -> Option<f64> {
    let entry = catalogue().iter().find(|entry| entry.name == robot.name())?;
    Some(entry.payload_kg()? * STANDARD_GRAVITY)
}

/// Says that the largest of the loads at the tip, each with its place, cannot be
/// meant for `robot`, where that is so.
pub fn load<'a>(robot: &Robot, loads: impl IntoIterator<Item = (&'a str, &'a Wrench)>) -> Option<Finding> {
    let weight = payload_weight(robot);
    let most = weight.map_or(LARGEST_PROCESS_FORCE, |weight| MOST_PAYLOADS * weight);
    let times = |wrench: &Wrench| {
        let (force, moment) = (wrench.force.norm(), wrench.moment.norm());
        (force / most).max(moment / (most * LEVER))
    };
    let (place, wrench) = loads.into_iter().max_by(|a, b| times(a.1).total_cmp(&times(b.1)))?;
    // Not written as `<=`: what is no number is not meant either.
    if times(wrench) < 1.0 {
        return None;
    }
    let (force, moment) = (wrench.force.norm(), wrench.moment.norm());
    let load = if force >= most { format!("{force:.4e} N") } else { format!("{moment:.4e} N·m") };
    let beside = match weight {
        Some(weight) => format!(
            "the payload of {} weighs {weight:.0} N, and no process pushes with {MOST_PAYLOADS} times that",
            robot.name()
        ),
        None => format!("no process pushes an industrial robot with more than {LARGEST_PROCESS_FORCE} N"),
    };
    Some(Finding::serious(
        "implausible-load",
        place,
        format!("A load of {load} can hardly be meant: {beside}. Check its unit (N, N·m)."),
    ))
}

/// What of the cell's process can hardly be meant.
pub fn process(cell: &Cell) -> Vec<Finding> {
    let mut out = Vec::new();
    let of_work = cell.work.process.iter().map(|process| ("work".to_string(), process));
    let of_features = cell.work.features.iter().filter_map(|feature| {
        let table = format!("work.feature \"{}\"", feature.name);
        Some((table, feature.process.as_ref()?))
    });
    for (table, process) in of_work.chain(of_features) {
        let (kind, tip_load) = match process {
            Process::Constant(tip_load, _) => ("force", *tip_load),
            Process::Milling(cut) => {
                milling(cut, &table, &mut out);
                ("milling", cut.mean_load())
            }
            // What it puts on the tip is known where there is a path.
            Process::MillingAtFeed(cut) => {
                milling(cut, &table, &mut out);
                continue;
            }
        };
        let wrench = Wrench { force: tip_load.force, moment: tip_load.moment };
        let key = format!("{table}.{kind}");
        out.extend(load(&cell.setup.robot, [(key.as_str(), &wrench)]));
    }
    out
}

/// That the feed of a path cuts chips that no tooth cuts, where the cell gives the speed of the spindle.
pub fn chips(work: &Work, points: &[PathPoint]) -> Option<Finding> {
    let [low, high] = FEEDS_PER_TOOTH_MM;
    let mut beyond = points.iter().filter_map(|point| {
        let Some(Process::MillingAtFeed(cut)) = work.process_at(point) else {
            return None;
        };
        let chip = m_to_mm(point.feed? * cut.feed_per_tooth);
        (!point.rapid && !(low..=high).contains(&chip)).then_some((point, chip))
    });
    let (first, chip) = beyond.next()?;
    let more = more(beyond.count());
    let sentence = format!(
        "At point {}{more} the feed is {chip:.2e} mm a tooth, and no tooth cuts that: check spindle_rpm, teeth and \
         the unit of the feed.",
        first.name
    );
    Some(Finding::serious("implausible-cut", "work.milling.spindle_rpm", sentence))
}

fn milling(cut: &Milling, table: &str, out: &mut Vec<Finding>) {
    let mut add = |key: &str, sentence: String| {
        let key = format!("{table}.milling.{key}");
        out.push(Finding::serious("implausible-cut", key, sentence));
    };
    let coefficient = cut.coefficients.k_tc;
    if !(COEFFICIENT[0]..=COEFFICIENT[1]).contains(&coefficient) {
        add(
            "k_tc_n_per_mm2",
            format!(
                "A tangential cutting coefficient of {} N/mm² is that of no material: foam has some 5, wood 20, \
                 aluminium 800, steel 2000. Is it in GPa or in Pa? 1 N/mm² is 1 MPa.",
                coefficient / 1e6
            ),
        );
    }
    for (key, length) in [("axial_depth_mm", cut.axial_depth), ("diameter_mm", cut.diameter)] {
        if length > CUTTER {
            add(key, format!("{} mm is more than any cutter has on a robot. The unit is mm.", m_to_mm(length)));
        }
    }
}
