//! The posture that would help most, in words.

use super::messages::counted;
use crate::numbers::{optional_percent, significant};
use crate::table::{Table, title};
use stiffarm::estimate::identified::Identified;
use stiffarm::model::cell::Cell;
use stiffarm::units::rad_to_shortest_deg;

/// The posture that would help most.
pub fn next(cell: &Cell, result: &Identified) -> String {
    let Some(advice) = &result.next_posture else {
        return match &result.next_posture_missing {
            Some(reason) => format!(
                "{}No suggestion: {reason}\n",
                title("One more posture that would help most")
            ),
            None => String::new(),
        };
    };
    let mut out = title("One more posture that would help most");
    let angles: Vec<String> = advice
        .angles
        .iter()
        .map(|q| rad_to_shortest_deg(*q))
        .map(|q| format!("{:.2}", (q * 100.0).round() / 100.0 + 0.0))
        .collect();
    out += &format!("q [deg]: {}\n", angles.join(", "));
    if let Some(load) = &advice.assumed_load {
        let vector = |v: &[f64; 3], unit: f64, digits: usize| {
            v.map(|c| format!("{:.*}", digits, c * unit + 0.0))
                .join(", ")
        };
        out += &match (&load.anchor_m, &load.direction) {
            (Some(anchor), _) if load.pushes => format!(
                "Assumed: a cylinder that pushes with {} N from ({}) mm, where the measured forces meet.\n",
                significant(load.magnitude_n, 3),
                vector(anchor, 1e3, 0)
            ),
            (Some(anchor), _) => format!(
                "Assumed: a rope of {} N to ({}) mm, where the measured forces meet.\n",
                significant(load.magnitude_n, 3),
                vector(anchor, 1e3, 0)
            ),
            (None, Some(direction)) => format!(
                "Assumed: a force of {} N along ({}), as measured on average.\n",
                significant(load.magnitude_n, 3),
                vector(direction, 1.0, 2)
            ),
            (None, None) => String::new(),
        };
    }
    out += &format!(
        "Assumed: measured as posture {} was, {} at the same points and in the same load states; noise as in this fit.\n",
        advice.measured_as,
        counted(advice.displacements, "displacement")
    );
    let mut table = Table::new(
        std::iter::once("relative error [%]".to_string()).chain(cell.setup.robot.spring_names()),
    );
    for (name, errors) in [("now", &advice.before), ("with it", &advice.after)] {
        let mut row = vec![name.to_string()];
        row.extend(errors.iter().map(|e| optional_percent(*e)));
        table.row(row);
    }
    out + &table.to_string()
}
