//! The elastic model that predicts: why, and what it gives.

use super::{messages, tables};
use crate::numbers::{NONE, significant, stiffness};
use crate::screen::{columns, wrapped};
use crate::table::{Table, title};
use stiffarm::estimate::elastic::Elastic;
use stiffarm::model::elastic::ElasticClass;

/// Reasons, the joints as the mixed model sees them, and the sizes of the rest.
pub(super) fn elastic(found: &Elastic, confidence: f64) -> String {
    let mut out = title("What gives way");
    for reason in &found.reasons {
        out += &format!("{}\n", wrapped(reason, columns()));
    }
    let Some(mixed) = &found.mixed else {
        return out + "\n";
    };
    // Joints that are hardly told from the rest have no ±, but ends.
    let mut joints = Table::new([
        "mixed model".to_string(),
        "k [N·m/rad]".to_string(),
        format!(
            "{} % interval, all errors [N·m/rad]",
            messages::confidence(confidence)
        ),
    ]);
    for joint in &mixed.joints {
        joints.row([
            joint.name.clone(),
            joint.stiffness.map_or_else(|| NONE.to_string(), stiffness),
            tables::ends(joint.interval),
        ]);
    }
    out += &format!("\n{joints}");
    let sizes: Vec<String> = mixed
        .sizes
        .iter()
        .map(|size| {
            let what = match size.class {
                ElasticClass::Shift => "shifts by forces",
                ElasticClass::Turn => "turns by moments",
                ElasticClass::Coupling => "shifts by moments",
            };
            format!(
                "{what} ± {} {}",
                significant(size.std, 2),
                size.class.unit()
            )
        })
        .collect();
    let sizes = format!(
        "Beyond the axes each joint and the base give way by: {}.",
        sizes.join(", ")
    );
    out + &wrapped(&sizes, columns()) + "\n\n"
}
