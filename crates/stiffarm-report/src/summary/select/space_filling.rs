//! `--space-filling`: postures that cover the joint space evenly, as a baseline.

use super::super::postures::{near_singular, posture_table, route_section};
use super::super::worth::{UNSURE, Worth, is_beyond_first_order, least_sure, worth_sections};
use crate::summary::{Block, Context, Number, Quantity, Summarise, Summary, Text, counted, shown, with_stopped};
use stiffarm::ask::select::{SelectResultOptions, SpaceFillingPlan};
use stiffarm::findings::list;
use stiffarm::model::posture::PostureGroup;
use stiffarm::{Result, Termination};

impl Summarise<SelectResultOptions> for SpaceFillingPlan {
    fn summary(&self, options: &SelectResultOptions, context: &Context<'_>) -> Result<Summary> {
        let result = self;
        let evaluation = &result.evaluation;
        let mut what_was_done = Text::new(format!(
            "{} spread evenly over the joint space, without any index",
            counted(result.posture_names.len(), "posture")
        ));
        if let Some(distance) = result.smallest_distance {
            what_was_done = what_was_done
                .words("; the nearest two are ")
                .number(Number::new(distance).significant(3))
                .words(" of the joints' ranges apart (root of the sum of squares)");
        }
        what_was_done = what_was_done.words(".");
        if let Some(margin) = result.smallest_margin_m {
            let margin = Number::new(margin).of(Quantity::PLACE);
            what_was_done =
                what_was_done.words(" The smallest margin to the cell's limits is ").number(margin).words(".");
        }
        if result.termination == Termination::Interrupted {
            what_was_done = what_was_done.words(" It was stopped: more exchanges may spread them further.");
        }
        let undetermined = &evaluation.undetermined_joints;
        let conclusion = if !undetermined.is_empty() {
            Text::new("They cannot determine ").strong(list(&shown(undetermined))).words(".")
        } else if let Some(error) = evaluation.indices.expected_error {
            let text = Text::new(
                "The joint stiffness can be expected with a relative standard error (RMS over the joints) of ",
            )
            .number(Number::new(error).of(Quantity::PERCENT.digits(3)))
            .words(".");
            text.then(least_sure(evaluation, &result.joints))
        } else {
            Text::new("The condition number of the observation matrix is ")
                .number(Number::new(evaluation.indices.condition))
                .words(".")
        };
        let next_step = Text::new("This is a baseline: ")
            .code("stiffarm select")
            .words(" with an index finds postures that tell more in as much time.");
        let key = posture_table(
            "The postures in measuring order, controller angles",
            &result.posture_names,
            &result.postures,
            &[],
        );
        let angles = result.postures.iter().cloned();
        let group = PostureGroup::named("space-filling", &result.posture_names, angles);
        let mut sections = vec![context.cell_section(
            &[group],
            "Step through the postures in measuring order; each shows its room and the two bodies that come nearest to \
         each other.",
        )?];
        let worth = Worth { evaluation, posture_names: &result.posture_names };
        sections.extend(worth_sections(context, options.characteristic_length_m, &result.joints, &[worth], &[]));
        let way = route_section(context, &result.posture_names, &result.route, &result.findings);
        sections.extend(way.map(|mut section| {
            let near = near_singular(&result.posture_names, evaluation);
            section.blocks.extend(near.map(Block::Text));
            section
        }));
        let verdict = [what_was_done, conclusion, next_step];
        let is_stopped = result.termination == Termination::Interrupted;
        let findings = with_stopped(context, result.findings.clone(), is_stopped, &[]);
        let summary = context.summary(findings, "Evenly spread postures".to_string(), verdict, Some(key), sections);
        let unsure = if undetermined.is_empty() {
            is_beyond_first_order(evaluation).then_some(UNSURE)
        } else {
            Some("These postures leave a joint undetermined.")
        };
        Ok(summary.caution("select", unsure))
    }
}
