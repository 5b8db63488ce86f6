//! A plan: from a global search, from an initial group, or beside given postures.

use super::super::postures::{FEW, hides_points, limit_table, near_singular, posture_table, route_section};
use super::super::worth::{UNSURE, Worth, is_beyond_first_order, joint_table, worth_sections};
use super::{details, story};
use crate::selection::{convergence_figure, price_figure};
use crate::summary::{Block, Context, Section, Summarise, Summary, with_stopped};
use stiffarm::ask::select::{Plan, SelectResultOptions};
use stiffarm::findings::Finding;
use stiffarm::model::elastic::ElasticSource;
use stiffarm::model::posture::PostureGroup;
use stiffarm::plan::index::Index;
use stiffarm::{Result, Termination};

impl Summarise<SelectResultOptions> for Plan {
    fn summary(&self, options: &SelectResultOptions, context: &Context<'_>) -> Result<Summary> {
        let mut plan = self.clone();
        plan.evaluation.name =
            if plan.given_names.is_empty() { "the plan".to_string() } else { "given and new".to_string() };
        // The plan holds for the load that was chosen with it.
        let with_load = plan.selection.load.as_ref().zip(context.cell);
        let with_load = with_load.map(|(load, cell)| load.applied(cell));
        let context = &Context { cell: with_load.as_ref().or(context.cell), ..*context };
        let count = plan.selection.group.len();
        let postures = posture_table(
            "The postures in measuring order, controller angles, and the least room beyond what the cell asks for (0: \
             on the limit)",
            &plan.posture_names,
            &plan.selection.group,
            &plan.selection.limits,
        );
        let names: Vec<String> = plan.given_names.iter().chain(&plan.posture_names).cloned().collect();
        let groups = worth(&plan, &names);
        let bounds = plan.joint_efficiencies.as_deref().unwrap_or_default();
        let mut shown = worth_sections(context, options.characteristic_length_m, &plan.joints, &groups, bounds);
        let mut sections = vec![cell_section(context, &plan)?];
        let key = match joint_table(&plan.joints, &groups, bounds) {
            // Of a long plan the joints are read first.
            Some(joints) if count > FEW => {
                let postures = vec![Block::Table(postures)];
                sections.push(Section::new("postures", "The postures", postures).in_summary());
                let expected = &mut shown[0].blocks;
                expected.retain(|block| !matches!(block, Block::Table(_)));
                joints
            }
            _ => postures,
        };
        let rest = shown.split_off(usize::from(shown[0].id == "expected"));
        sections.extend(shown);
        let way = route_section(context, &plan.posture_names, &plan.route, &plan.findings);
        sections.extend(way.map(|mut section| {
            let near = near_singular(&plan.posture_names, &plan.evaluation);
            section.blocks.extend(near.map(Block::Text));
            section.blocks.extend(details::repeats(&plan));
            section
        }));
        sections.extend(details::load_section(options, &plan));
        sections.extend(search_section(&plan));
        sections.extend(limit_section(options, context, &plan));
        sections.extend(details::sensitivity_section(&plan));
        sections.extend(rest);
        let heading = match (plan.given_names.is_empty(), count) {
            (false, _) => "Further postures to measure".to_string(),
            (true, 1) => "Plan of one posture".to_string(),
            (true, _) => format!("Plan of {}", story::counted(&plan)),
        };
        let optional_parts = [
            ("sensitivity", options.select.sensitivity, plan.sensitivity.is_some()),
            ("prices", options.select.prices, plan.prices.is_some()),
        ];
        // What was asked for and is not there, with nothing that says why.
        let left_out = optional_parts.into_iter().filter(|(_, wanted, there)| *wanted && !there);
        let left_out: Vec<&str> = left_out.map(|(name, ..)| name).collect();
        let findings = plan.findings.clone();
        let findings = with_stopped(context, findings, is_interrupted(&plan), &left_out);
        let verdict = story::verdict(options, context, &plan);
        let mut summary = context.summary(findings, heading, verdict, Some(key), sections);
        if let Some(cell) = context.cell {
            let group = PostureGroup::named("", &plan.posture_names, plan.selection.group.clone());
            summary.add_findings(cell.posture_findings(&group.postures));
            summary.add_findings(cell.setup.robot.limits_are_unknown().then(|| {
            let sentence = "The machine's limits are not known (±360° stand in): compare the postures with the machine \
                            before driving them.";
            Finding::caution("unknown-limits", "robot.limits_deg", sentence)
        }));
        }
        let sizes = plan.evaluation.indices.prediction_sizes;
        // What is expected of every arm needs no word.
        if let (Index::Prediction, Some(sizes @ ElasticSource::Declared)) = (plan.selection.index, sizes) {
            let sentence = format!("The index prediction takes {}.", sizes.in_words());
            summary.verdict[1] = std::mem::take(&mut summary.verdict[1]).words(format!(" {sentence}"));
        }
        let unsure = is_beyond_first_order(&plan.evaluation);
        Ok(summary.caution("select", unsure.then_some(UNSURE)))
    }
}

/// Whether some part of it ended early because the user wanted so.
fn is_interrupted(plan: &Plan) -> bool {
    let bound = plan.certificate.iter().map(|certificate| certificate.termination);
    let joints = plan.joint_efficiencies.iter().flatten();
    let mut ends = bound.chain(joints.map(|joint| joint.termination));
    plan.selection.termination == Termination::Interrupted || ends.any(|end| end == Termination::Interrupted)
}

/// What was there before and what there is with the plan.
fn worth<'a>(plan: &'a Plan, names: &'a [String]) -> Vec<Worth<'a>> {
    let before = plan
        .before
        .as_ref()
        .map(|before| Worth { evaluation: &before.evaluation, posture_names: &before.posture_names });
    let after = Worth { evaluation: &plan.evaluation, posture_names: names };
    before.into_iter().chain([after]).collect()
}

/// The cell with the plan in measuring order; what was there before is laid over it.
fn cell_section(context: &Context<'_>, plan: &Plan) -> Result<Section> {
    let (name, before) = if plan.given_names.is_empty() {
        ("the plan", "the initial group")
    } else {
        ("new postures", "given postures")
    };
    let angles = plan.selection.group.iter().cloned();
    let mut groups = vec![PostureGroup::named(name, &plan.posture_names, angles)];
    if let Some(earlier) = plan.before.as_ref().filter(|b| !b.postures.is_empty()) {
        let mut group = earlier.group();
        group.name = before.to_string();
        groups.push(group);
    }
    let explained = match groups.len() {
        1 => {
            "Step through the postures in measuring order; each shows its room and the two bodies that come nearest to \
             each other."
        }
        _ => "Step through the postures in measuring order, and lay the postures that were there before over them.",
    };
    context.cell_section(&groups, explained)
}

fn search_section(plan: &Plan) -> Option<Section> {
    let bound = plan.certificate.as_ref().map(|c| c.bound);
    let mut blocks = Vec::new();
    blocks.extend(convergence_figure(&plan.selection, bound).map(Block::Figure));
    blocks.extend(details::certificate(plan).map(Block::Text));
    if blocks.is_empty() {
        return None;
    }
    let section = Section::new("search", "How far the search came", blocks);
    let doubtful = plan.certificate.as_ref().is_some_and(|certificate| {
        let tight = certificate.termination == Termination::Converged && certificate.outside.is_empty();
        !tight || certificate.verification.doubt().is_some()
    });
    Some(if doubtful { section.in_summary() } else { section })
}

fn limit_section(options: &SelectResultOptions, context: &Context<'_>, plan: &Plan) -> Option<Section> {
    let mut blocks = Vec::new();
    let priced = plan.prices.as_ref().filter(|prices| !prices.is_empty());
    if let Some(prices) = priced {
        blocks.push(Block::Figure(price_figure(prices)));
        blocks.push(Block::Table(details::price_table(plan, prices)));
        blocks.push(Block::Text(
            "Each row is a search of its own; a difference of a few tenths of a per cent may be its luck.".into(),
        ));
    }
    if plan.prices.is_none() && options.select.prices {
        blocks.push(Block::Text("What each limit costs is not known: the search was stopped before.".into()));
    }
    let limits = &plan.selection.limits;
    if hides_points(context, limits) {
        blocks.push(Block::Text(
            "The tracker does not see every point. Hidden points count in the index as if they were read: the plan is \
             a little worse than it says."
                .into(),
        ));
    }
    let is_short = blocks.is_empty();
    if let Some(table) = limit_table(context, &plan.posture_names, limits) {
        blocks.push(Block::Details("The room that every limit leaves".to_string(), vec![Block::Table(table)]));
    }
    let section = Section::new("limits", "The limits", blocks);
    match section.blocks.len() {
        0 => None,
        _ if is_short => Some(section),
        _ => Some(section.in_summary()),
    }
}
