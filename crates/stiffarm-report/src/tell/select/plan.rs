//! A plan: from a global search, from an initial group, or beside given postures.

use super::super::postures::{FEW, limit_table, posture_table, route_section};
use super::super::worth::{
    UNSURE, Worth, is_beyond_first_order, joint_names, level, worth_sections,
};
use super::planned::Plan;
use super::{details, story};
use crate::selection::{convergence_figure, price_figure};
use crate::tell::Given;
use crate::tell::{Block, DataTable, Section, Text, Told};
use stiffarm::Result;
use stiffarm::findings::visible;
use stiffarm::model::posture::PostureGroup;

/// The part of a page for a plan.
pub(super) fn told(context: &Given<'_>) -> Result<Told> {
    let mut plan: Plan = context.saved.result()?;
    if let Some(evaluation) = &mut plan.evaluation {
        evaluation.name = match plan.given_names.is_empty() {
            true => "the plan".to_string(),
            false => "given and new".to_string(),
        };
    }
    // The plan holds for the load that was chosen with it.
    let with_load = plan.selection.load.as_ref().zip(context.cell);
    let with_load = with_load.map(|(load, cell)| load.applied(cell));
    let context = &Given {
        cell: with_load.as_ref().or(context.cell),
        ..*context
    };
    let count = plan.selection.group.len();
    let postures = posture_table(
        context,
        "The postures in measuring order, controller angles, and the least room beyond what the cell asks for (0: on the limit)",
        &plan.posture_names,
        ("/postures_deg", &plan.selection.group),
        &plan.selection.limits,
    );
    let joints = joint_table(context, &plan);
    let (key, folded) = match joints {
        Some(joints) if count > FEW => (joints, Some(postures)),
        Some(joints) => (postures, Some(joints)),
        None => (postures, None),
    };
    let mut sections = vec![cell_section(context, &plan)?];
    let mut shown = worth(context, &plan);
    if let Some(folded) = folded {
        match count > FEW {
            true => sections.push(Section::new(
                "postures",
                "The postures",
                vec![Block::Table(folded)],
            )),
            false => {
                // The bound of each joint beside its error.
                if let Some(section) = shown.first_mut().filter(|s| s.id == "expected") {
                    section.blocks.truncate(1);
                    section.blocks.push(Block::Table(folded));
                }
            }
        }
    }
    let indices: Vec<Section> = shown.drain(shown.len().min(1)..).collect();
    sections.append(&mut shown);
    sections.extend(search_section(&plan));
    sections.extend(limit_section(context, &plan));
    let route = plan.route.as_ref();
    let way = route.and_then(|route| route_section(context, &plan.posture_names, route));
    sections.extend(way.map(|mut section| {
        section.blocks.extend(details::repeats(&plan));
        section
    }));
    sections.extend(details::load_section(context, &plan));
    sections.extend(details::sensitivity_section(context, &plan));
    sections.extend(indices);
    let heading = match (plan.given_names.is_empty(), count) {
        (false, _) => "Further postures to measure".to_string(),
        (true, 1) => "Plan of one posture".to_string(),
        (true, _) => format!("Plan of {}", story::counted(&plan)),
    };
    let mut told = context.told(heading, story::verdict(context, &plan), Some(key), sections);
    if let Some(cell) = context.cell {
        told.add_findings(cell.posture_findings(&plan.postures()));
    }
    let unsure = plan.evaluation.as_ref().is_some_and(is_beyond_first_order);
    Ok(told.caution("select", unsure.then_some(UNSURE)))
}

fn worth(context: &Given<'_>, plan: &Plan) -> Vec<Section> {
    let Some(after) = &plan.evaluation else {
        return Vec::new();
    };
    let mut groups = Vec::new();
    if let Some(before) = &plan.before {
        groups.push(Worth {
            at: "/before".to_string(),
            evaluation: &before.evaluation,
            posture_names: &before.posture_names,
        });
    }
    let given = plan.given_names.iter();
    let names: Vec<String> = given.chain(&plan.posture_names).cloned().collect();
    groups.push(Worth {
        at: "/evaluation".to_string(),
        evaluation: after,
        posture_names: &names,
    });
    let bounds = plan.joint_efficiencies.iter().flatten().map(|j| j.bound);
    let bounds: Vec<f64> = bounds.collect();
    worth_sections(context, &plan.joints, &groups, &bounds)
}

/// What each joint can be expected to have, with its bound.
fn joint_table(context: &Given<'_>, plan: &Plan) -> Option<DataTable> {
    let evaluation = plan.evaluation.as_ref()?;
    if evaluation
        .relative_standard_error
        .iter()
        .all(Option::is_none)
    {
        return None;
    }
    let bounds = plan.joint_efficiencies.as_ref();
    let before = plan.before.as_ref();
    let mut headings = vec!["joint".to_string()];
    headings.extend(before.map(|b| format!("{} [± %]", visible(&b.evaluation.name))));
    headings.push(format!("{} [± %]", visible(&evaluation.name)));
    if bounds.is_some() {
        headings.extend([
            "no plan below [± %]".to_string(),
            "of what is possible [%]".to_string(),
        ]);
    }
    let forecast = evaluation.forecast.as_ref();
    headings.extend(forecast.map(|_| "identified [± %]".to_string()));
    let title = match forecast {
        Some(found) => format!(
            "Expected relative standard error of the joint stiffness by noise alone, and the ± at {} % that identify will \
             print with systematic errors",
            level(found.confidence)
        ),
        None => {
            "Expected relative standard error of the joint stiffness by noise alone".to_string()
        }
    };
    let mut table = DataTable::new(title, headings);
    let percent =
        |below: String| Text::from(context.number(&below).percent().bare().significant(3));
    for (j, joint) in joint_names(&plan.joints, evaluation).iter().enumerate() {
        let mut cells = Vec::new();
        if before.is_some() {
            cells.push(percent(format!("/before/relative_standard_error/{j}")));
        }
        cells.push(percent(format!("/evaluation/relative_standard_error/{j}")));
        if bounds.is_some() {
            cells.push(percent(format!("/joint_efficiencies/{j}/bound")));
            let efficiency = context.number(&format!("/joint_efficiencies/{j}/efficiency"));
            cells.push(efficiency.percent().bare().decimals(1).into());
        }
        if forecast.is_some() {
            let total = context.number(&format!("/evaluation/forecast/total/{j}"));
            cells.push(total.percent().bare().significant(2).into());
        }
        table.row(joint.clone(), cells);
    }
    Some(table)
}

/// The cell with the plan in measuring order; what was there before is laid over it.
fn cell_section(context: &Given<'_>, plan: &Plan) -> Result<Section> {
    let (name, before) = match plan.given_names.is_empty() {
        true => ("the plan", "the initial group"),
        false => ("new postures", "given postures"),
    };
    let angles = plan.selection.group.iter().cloned();
    let mut groups = vec![PostureGroup::named(name, &plan.posture_names, angles)];
    if let Some(known) = plan.before.as_ref().filter(|b| !b.postures.is_empty()) {
        let mut group = known.group();
        group.name = before.to_string();
        groups.push(group);
    }
    let explained = match groups.len() {
        1 => {
            "Step through the postures in measuring order; each shows its room and the two bodies that come nearest to each other."
        }
        _ => {
            "Step through the postures in measuring order, and lay the postures that were there before over them."
        }
    };
    context.cell_section(&groups, explained)
}

fn search_section(plan: &Plan) -> Option<Section> {
    let bound = plan.certificate.as_ref().map(|c| c.bound);
    let mut blocks = Vec::new();
    blocks.extend(convergence_figure(&plan.selection, bound).map(Block::Figure));
    blocks.extend(details::certificate(plan).map(Block::Text));
    (!blocks.is_empty()).then(|| Section::new("search", "How far the search came", blocks))
}

fn limit_section(context: &Given<'_>, plan: &Plan) -> Option<Section> {
    let mut blocks = Vec::new();
    if let Some(prices) = plan.prices.as_ref().filter(|prices| !prices.is_empty()) {
        blocks.push(Block::Figure(price_figure(prices)));
        blocks.push(Block::Table(details::price_table(context, plan, prices)));
    }
    let wanted = context.saved.json.pointer("/options/prices");
    if plan.prices.is_none() && wanted == Some(&serde_json::Value::Bool(true)) {
        blocks.push(Block::Text(
            "What each limit costs is not known: the search was stopped before.".into(),
        ));
    }
    let limits = &plan.selection.limits;
    if let Some(table) = limit_table(context, &plan.posture_names, limits) {
        blocks.push(Block::Details(
            "The room that every limit leaves".to_string(),
            vec![Block::Table(table)],
        ));
    }
    (!blocks.is_empty()).then(|| Section::new("limits", "The limits", blocks))
}
