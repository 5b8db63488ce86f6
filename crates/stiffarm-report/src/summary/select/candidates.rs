//! `--candidates`: the best postures out of a list.

use super::super::postures::{FEW, name_of, posture_table};
use super::super::worth::{Worth, index_number, worth_sections};
use crate::summary::{
    Block, Context, DataTable, Number, Quantity, Section, Summarise, Summary, Text, counted, with_stopped,
};
use stiffarm::ask::select::{Chosen, SelectResultOptions};
use stiffarm::findings::visible;
use stiffarm::model::posture::PostureGroup;
use stiffarm::{Result, Termination};

impl Summarise<SelectResultOptions> for Chosen {
    fn summary(&self, options: &SelectResultOptions, context: &Context<'_>) -> Result<Summary> {
        let mut chosen = self.clone();
        chosen.selection.evaluation.name = "chosen postures".to_string();
        let selection = &chosen.selection;
        let index = selection.index;
        let count = chosen.posture_names.len();
        let wrenches = if chosen.measured_wrenches { ", each under its measured wrench" } else { "" };
        let what_was_done = Text::new(format!(
            "Of {} the best {count} were chosen{wrenches}.",
            counted(chosen.candidate_names.len(), "candidate")
        ));
        let mut conclusion = Text::new(index.says()).number(index_number(index, selection.value)).words(".");
        if selection.exact {
            conclusion = conclusion.words(" No other choice of as many candidates is better.");
        } else if selection.bound.is_some() {
            let side = if index.larger_is_better() { "above" } else { "below" };
            conclusion = conclusion
                .words(format!(" No choice of as many candidates can be {side} "))
                .number(index_number(index, selection.bound))
                .words(": this one reaches ")
                .number(Number::new(selection.efficiency).of(Quantity::SHARE))
                .words(" of what is possible.");
        }
        if !selection.forbidden.is_empty() {
            let count = counted(selection.forbidden.len(), "candidate");
            conclusion = conclusion.words(format!(" {count} lie outside bounds or limits."));
        }
        let next_step = if chosen.measured_wrenches {
            Text::new("These are measured already: identify with them alone and compare, or plan more with ")
                .code("stiffarm select --given")
                .words(".")
        } else {
            Text::new("Write the sheet for the readings (")
                .code("--sheet measurements.xlsx")
                .words(") and measure; ")
                .code("stiffarm select")
                .words(" without a list finds postures of its own to compare with.")
        };
        let key = posture_table("The chosen postures, controller angles", &chosen.posture_names, &chosen.postures, &[]);
        let angles = chosen.postures.iter().cloned();
        let group = PostureGroup::named("chosen postures", &chosen.posture_names, angles);
        let mut sections =
            vec![context.cell_section(&[group], "Step through the chosen postures in the order of the list.")?];
        let worth = Worth { evaluation: &selection.evaluation, posture_names: &chosen.posture_names };
        sections.extend(worth_sections(context, options.characteristic_length_m, &chosen.joints, &[worth], &[]));
        if !selection.forbidden.is_empty() {
            let names = selection.forbidden.iter();
            let names = names.map(|forbidden| name_of(&chosen.candidate_names, forbidden.candidate));
            let caption = "Candidates that bounds or limits of the cell forbid";
            let table = DataTable::of(caption, "candidate", names).words("why", |row| {
                let why = visible(&selection.forbidden[row].because);
                why.into_owned().into()
            });
            let section = Section::new("forbidden", "Left out", vec![Block::Table(table)]);
            sections.push(if selection.forbidden.len() > FEW { section } else { section.in_summary() });
        }
        let verdict = [what_was_done, conclusion, next_step];
        let is_stopped = selection.termination == Termination::Interrupted;
        let findings = with_stopped(context, chosen.findings.clone(), is_stopped, &[]);
        Ok(context.summary(findings, "The best of a list".to_string(), verdict, Some(key), sections))
    }
}
