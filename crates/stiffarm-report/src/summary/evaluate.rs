//! What `evaluate` says: indices and expected errors of given postures.

use super::worth::{UNSURE, Worth, is_beyond_first_order, least_sure, worth_sections};
use crate::summary::{Context, DataTable, Depth, Number, Quantity, Summarise, Summary, Text, counted, shown};
use stiffarm::Result;
use stiffarm::findings::{codes, list, visible};
use stiffarm::model::posture::PostureGroup;
use stiffarm::plan::evaluated::{Evaluated, EvaluatedGroup, EvaluatedOptions};

impl Summarise<EvaluatedOptions> for Evaluated {
    fn summary(&self, options: &EvaluatedOptions, context: &Context<'_>) -> Result<Summary> {
        let result = self;
        let groups: Vec<Worth<'_>> = result
            .groups
            .iter()
            .map(|group| Worth { evaluation: &group.evaluation, posture_names: &group.posture_names })
            .collect();
        let name = |g: usize| visible(&result.groups[g].evaluation.name).into_owned();
        let what_was_done = match groups.len() {
            1 => Text::new(format!(
                "{} with {} was evaluated: what it can tell of the joint stiffness, before anything is measured.",
                name(0),
                counted(groups[0].evaluation.posture_count, "posture")
            )),
            count => Text::new(format!(
                "{count} groups of postures were evaluated: what each can tell of the joint stiffness, before anything \
                 is measured."
            )),
        };
        let best = best(&groups);
        let conclusion = conclusion(result, &groups, best);
        let next_step = match best {
            None => Text::new("Add postures that differ, or measuring points: ")
                .code("stiffarm check")
                .words(" looks for the reason, and ")
                .code("stiffarm select")
                .words(" chooses postures that determine every joint."),
            Some(g) if is_beyond_first_order(groups[g].evaluation) => Text::new("That is too unsure to rely on; ")
                .code("stiffarm select")
                .words(" finds postures that tell more."),
            Some(_) if is_outside(result) => Text::new("Do not drive there as they are: ")
                .code("stiffarm select --initial")
                .words(" moves the postures inside the limits of the cell."),
            Some(_) => Text::new("Measure at these postures, or let ")
                .code("stiffarm select")
                .words(" find a better plan of as many postures."),
        };
        let shown: Vec<PostureGroup> =
            result.groups.iter().filter(|group| !group.postures.is_empty()).map(EvaluatedGroup::group).collect();
        let mut sections = Vec::new();
        if !shown.is_empty() {
            sections.push(context.cell_section(
                &shown,
                "Step through the postures of a group in measuring order, and lay other groups over them.",
            )?);
        }
        sections.extend(worth_sections(context, options.characteristic_length_m, &result.joints, &groups, &[]));
        // All indices are what one asks for.
        sections.iter_mut().for_each(|section| {
            if section.id == "indices" {
                section.depth = Depth::Summary;
            }
        });
        let key = key(result, &groups);
        let heading = match groups.len() {
            1 => format!("What {} can tell", name(0)),
            _ => "What groups of postures can tell".to_string(),
        };
        let unsure = best.is_some_and(|g| is_beyond_first_order(groups[g].evaluation));
        let summary = context.summary(
            result.findings.clone(),
            heading,
            [what_was_done, conclusion, next_step],
            Some(key),
            sections,
        );
        Ok(summary.caution("evaluate", unsure.then_some(UNSURE)))
    }
}

/// Whether some posture lies outside bounds or limits.
fn is_outside(result: &Evaluated) -> bool {
    result.findings.iter().any(|finding| finding.code == codes::POSTURE_OUTSIDE)
}

/// The group with the smallest expected error, else with the smallest condition number.
fn best(groups: &[Worth<'_>]) -> Option<usize> {
    let by = |of: &dyn Fn(&Worth<'_>) -> Option<f64>| {
        let by_group = groups.iter().enumerate();
        let by_group = by_group.filter_map(|(g, group)| Some((g, of(group)?)));
        by_group.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(g, _)| g)
    };
    by(&|group| group.evaluation.indices.expected_error).or_else(|| by(&|group| group.evaluation.indices.condition))
}

fn conclusion(result: &Evaluated, groups: &[Worth<'_>], best: Option<usize>) -> Text {
    let Some(g) = best else {
        return match groups {
            [group] => {
                let joints = shown(&group.evaluation.undetermined_joints);
                Text::new("It cannot determine ").strong(list(&joints)).words(".")
            }
            _ => Text::new("No group determines every joint."),
        };
    };
    let group = &groups[g];
    let mut text = match groups.len() {
        1 => Text::default(),
        _ => Text::new("Best is ").strong(visible(&group.evaluation.name).into_owned()).words(": "),
    };
    if group.evaluation.indices.expected_error.is_none() {
        let condition = Number::new(group.evaluation.indices.condition);
        let begin = if groups.len() == 1 { "The" } else { "the" };
        return text
            .words(format!("{begin} condition number of its observation matrix is "))
            .number(condition)
            .words("; how sure the stiffness will be is not known without a prior stiffness.");
    }
    let begin = if groups.len() == 1 { "The" } else { "the" };
    let error = Number::new(group.evaluation.indices.expected_error);
    text = text
        .words(format!(
            "{begin} joint stiffness can be expected with a relative standard error (RMS over the joints) of "
        ))
        .number(error.of(Quantity::PERCENT.digits(3)));
    text.words(" by noise alone.").then(least_sure(group.evaluation, &result.joints))
}

/// One row per group.
fn key(result: &Evaluated, groups: &[Worth<'_>]) -> DataTable {
    let caption = "The groups; expected errors are relative standard errors of the joint stiffness";
    let indices = |g: usize| &groups[g].evaluation.indices;
    let percent = Quantity::PERCENT.digits(3);
    let ratio = Quantity::RATIO.digits(4);
    let names = groups.iter();
    let names = names.map(|group| visible(&group.evaluation.name).into_owned());
    let left_out = result.findings.iter().filter(|f| f.code == codes::JOINT_LEFT_OUT);
    let left_out: Vec<_> = left_out.map(|f| visible(&f.subject)).collect();
    let which = if left_out.is_empty() { "every joint".to_string() } else { format!("all but {}", list(&left_out)) };
    DataTable::of(caption, "group", names)
        .numbers("postures", Quantity::COUNT, |g| Some(Number::count(groups[g].evaluation.posture_count)))
        .numbers("expected error", percent, |g| Some(Number::new(indices(g).expected_error)))
        .numbers("worst joint", percent, |g| Some(Number::new(indices(g).worst_joint)))
        .numbers("one posture lost", percent, |g| Some(Number::new(indices(g).drop_one)))
        .numbers("cond(Ψ)", ratio, |g| Some(Number::new(indices(g).condition)))
        .numbers("novel index", ratio, |g| Some(Number::new(indices(g).novel)))
        .words("determines", |g| {
            let evaluation = groups[g].evaluation;
            if !evaluation.undetermined_joints.is_empty() {
                let names = list(&shown(&evaluation.undetermined_joints));
                return Text::default().strong(format!("not {names}"));
            }
            let unsure = if is_beyond_first_order(evaluation) { ", but too unsure" } else { "" };
            format!("{which}{unsure}").into()
        })
}
