//! `--space-filling`: postures that cover the joint space evenly, as a baseline.

use super::super::postures::{posture_table, route_section};
use super::super::worth::{UNSURE, Worth, is_beyond_first_order, least_sure, worth_sections};
use crate::tell::Given;
use crate::tell::{Text, Told};
use serde::Deserialize;
use stiffarm::Result;
use stiffarm::findings::{list, visible};
use stiffarm::model::posture::PostureGroup;
use stiffarm::plan::index::GroupEvaluation;
use stiffarm::plan::route::Route;
use stiffarm::units::deg_to_rad;

/// What `select --space-filling` writes.
#[derive(Deserialize)]
struct SpaceFilling {
    #[serde(default)]
    joints: Vec<String>,
    postures_deg: Vec<Vec<f64>>,
    posture_names: Vec<String>,
    smallest_distance: Option<f64>,
    evaluation: GroupEvaluation,
    route: Option<Route>,
}

/// The part of a page for evenly spread postures.
pub(super) fn told(context: &Given<'_>) -> Result<Told> {
    let result: SpaceFilling = context.saved.result()?;
    let evaluation = &result.evaluation;
    let mut done = Text::new(format!(
        "{} postures were spread evenly over the joint space, without any index",
        result.posture_names.len()
    ));
    if result.smallest_distance.is_some() {
        done = done
            .words("; the nearest two are ")
            .number(context.number("/smallest_distance").significant(3))
            .words(" of the joints' ranges apart");
    }
    done = done.words(".");
    let undetermined = &evaluation.undetermined_joints;
    let came = if !undetermined.is_empty() {
        let names: Vec<String> = undetermined
            .iter()
            .map(|n| visible(n).into_owned())
            .collect();
        Text::new("They cannot determine ")
            .strong(list(&names))
            .words(".")
    } else if evaluation.indices.expected_error.is_some() {
        let error = context.number("/evaluation/indices/expected_error");
        let mut text = Text::new(
            "The joint stiffness can be expected with a relative standard error (RMS over the joints) of ",
        )
        .number(error.percent().significant(3))
        .words(".");
        text = text.then(least_sure(
            context,
            "/evaluation",
            evaluation,
            &result.joints,
        ));
        text
    } else {
        Text::new("The condition number of the observation matrix is ")
            .number(context.number("/evaluation/indices/condition"))
            .words(".")
    };
    let next = Text::new("This is a baseline: ")
        .code("stiffarm select")
        .words(" with an index finds postures that tell more in as much time.");
    let key = posture_table(
        context,
        "The postures in measuring order, controller angles",
        &result.posture_names,
        ("/postures_deg", &result.postures_deg),
        &[],
    );
    let angles = result.postures_deg.iter();
    let angles = angles.map(|q| q.iter().copied().map(deg_to_rad).collect());
    let group = PostureGroup::named("space-filling", &result.posture_names, angles);
    let mut sections = vec![context.cell_section(
        &[group],
        "Step through the postures in measuring order; each shows its room and the two bodies that come nearest to each other.",
    )?];
    let worth = Worth {
        at: "/evaluation".to_string(),
        evaluation,
        posture_names: &result.posture_names,
    };
    sections.extend(worth_sections(context, &result.joints, &[worth], &[]));
    let route = result.route.as_ref();
    sections.extend(route.and_then(|route| route_section(context, &result.posture_names, route)));
    let verdict = [done, came, next];
    let told = context.told(
        "Evenly spread postures".to_string(),
        verdict,
        Some(key),
        sections,
    );
    let unsure = match undetermined.is_empty() {
        true => is_beyond_first_order(evaluation).then_some(UNSURE),
        false => Some("These postures leave a joint undetermined."),
    };
    Ok(told.caution("select", unsure))
}
