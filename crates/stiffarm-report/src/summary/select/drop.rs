//! `--drop`: which given postures are least worth their measuring time.

use super::super::postures::name_of;
use super::super::worth::{index_number, index_quantity};
use crate::selection::worth_figure;
use crate::summary::{Block, Context, DataTable, Number, Quantity, Section, Summarise, Summary, Text, shown};
use stiffarm::Result;
use stiffarm::ask::select::DropResult;
use stiffarm::findings::list;
use stiffarm::model::posture::PostureGroup;

impl<O> Summarise<O> for DropResult {
    fn summary(&self, _options: &O, context: &Context<'_>) -> Result<Summary> {
        let result = self;
        let dropped = &result.dropped;
        let index = dropped.index;
        let names = |positions: &[usize]| -> Vec<String> {
            let each = positions.iter().map(|p| name_of(&result.posture_names, *p));
            each.collect()
        };
        let all = dropped.values.len();
        let what_was_done = if dropped.exhaustive {
            Text::new(format!(
                "Of {all} given postures, every way of leaving out {} was compared.",
                dropped.dropped.len()
            ))
        } else {
            Text::new(format!(
                "Of {all} given postures, {} were left out one after the other, each time the one least missed.",
                dropped.dropped.len()
            ))
        };
        let conclusion = Text::new(index.says())
            .number(index_number(index, dropped.value))
            .words(format!(" without {}, against ", list(&names(&dropped.dropped))))
            .number(index_number(index, dropped.before))
            .words(format!(" with all {all}."));
        let next_step = Text::new(format!(
            "Measure the other {}, where that loss is worth the time saved; else keep them all.",
            dropped.kept.len()
        ));
        let worth = &dropped.values;
        let rows = worth.iter();
        let rows = rows.map(|value| name_of(&result.posture_names, value.posture));
        let without = format!("{} without it", index.in_words());
        let key = DataTable::of("What is lost without one posture, the least first", "posture", rows)
            .numbers(&without, index_quantity(index), |v| Some(Number::new(worth[v].value)))
            .numbers("loss", Quantity::DEVIATION, |v| Some(Number::new(worth[v].loss)))
            .words("verdict", |v| match worth[v].loss {
                _ if dropped.dropped.contains(&worth[v].posture) => Text::default().strong("leave out"),
                None => "needed: a joint is undetermined without it".into(),
                Some(_) => "keep".into(),
            });
        let mut sections = Vec::new();
        let group = |name: &str, positions: &[usize]| {
            let angles = positions.iter().filter_map(|p| result.postures.get(*p).cloned());
            PostureGroup::named(name, &names(positions), angles)
        };
        if !result.postures.is_empty() {
            let groups = [group("postures that stay", &dropped.kept), group("left out", &dropped.dropped)];
            sections.push(context.cell_section(
                &groups,
                "Step through the postures that stay, and lay those that are left out over them.",
            )?);
        }
        let figure = worth_figure(&dropped.values, &shown(&result.posture_names));
        sections.push(Section::new("worth", "What each posture is worth", vec![Block::Figure(figure)]));
        let verdict = [what_was_done, conclusion, next_step];
        Ok(context.summary(result.findings.clone(), "Postures to leave out".to_string(), verdict, Some(key), sections))
    }
}
