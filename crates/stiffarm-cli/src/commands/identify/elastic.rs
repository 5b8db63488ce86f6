//! The elastic model that predicts: why, and what it gives.

use super::summary;
use crate::numbers::significant;
use crate::screen::{columns, wrapped};
use crate::table::title;
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
    let joints = summary::table(
        "mixed model",
        &mixed.joints,
        found.budget.as_ref(),
        confidence,
    );
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
