//! `--sensitivity`: whether wrong assumptions would change the plan.

use super::job::{number, with_unit};
use crate::numbers::{coarse_mm, deg, optional_percent, percent};
use crate::table::{Table, title};
use stiffarm::plan::select::{PriorCase, Sensitivity, Spread, WORTH_CHANGING};

/// The examination as a table and plain sentences.
pub fn table(found: &Sensitivity) -> String {
    let index = found.index;
    let mut out = title("Sensitivity to what was assumed");
    out += &sentence(found);
    if !found.priors.is_empty() {
        let mut priors = Table::new([
            "joint".to_string(),
            "its prior k".to_string(),
            with_unit(index, "this plan"),
            with_unit(index, "best found"),
            "loss [%]".to_string(),
        ]);
        for case in &found.priors {
            priors.row([
                case.joint.clone(),
                format!("× {}", case.factor),
                number(index, case.value),
                number(index, case.best),
                optional_percent(case.loss),
            ]);
        }
        out += &priors.to_string();
    }
    let spread = |what: &str, spread: &Option<Spread>| match spread {
        Some(spread) => format!(
            "{what}: {} worse by {} % on average, {} % at worst of {} draws\n",
            index.as_str(),
            percent(spread.mean - 1.0),
            percent(spread.worst - 1.0),
            found.options.samples
        ),
        None => format!(
            "{what}: {} does not exist in some of {} draws\n",
            index.as_str(),
            found.options.samples
        ),
    };
    let postures = format!(
        "joint angles off by {}° (1σ)",
        deg(found.options.joint_angle_std)
    );
    let tool = format!(
        "tool points off by {} mm (1σ)",
        coarse_mm(found.options.tool_point_std)
    );
    out += &spread(&postures, &found.postures);
    out + &spread(&tool, &found.tool_points)
}

/// Whether the recommendation would change.
fn sentence(found: &Sensitivity) -> String {
    let index = found.index.as_str();
    let unknown = found.priors.iter().find(|case| case.value.is_none());
    let worst = found
        .priors
        .iter()
        .filter_map(|case| Some((case, case.loss?)))
        .max_by(|a, b| a.1.total_cmp(&b.1));
    let at = |case: &PriorCase| {
        format!(
            "with {} at {} times its prior stiffness",
            case.joint, case.factor
        )
    };
    match (unknown, worst) {
        (Some(case), _) => format!(
            "the recommendation would change: {} this plan has no {index}\n",
            at(case)
        ),
        (None, Some((case, loss))) if found.would_change => format!(
            "the recommendation would change: {} another plan is {} % better\n",
            at(case),
            percent(loss)
        ),
        (None, Some((_, loss))) => format!(
            "the recommendation stands: with any one joint's prior stiffness changed, no plan found is more than \
             {} % better ({} % would count)\n",
            percent(loss),
            percent(WORTH_CHANGING)
        ),
        (None, None) => format!("{index} does not use the prior stiffness\n"),
    }
}
