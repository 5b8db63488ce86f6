//! `--curve`: the best value for each number of postures, and what one more gains.

use super::super::worth::{index_number, index_quantity};
use crate::selection::{CountPoint, count_figure};
use crate::summary::{
    Block, Context, DataTable, Number, Quantity, Section, Summarise, Summary, Text, counted, with_stopped,
};
use stiffarm::Result;
use stiffarm::ask::select::{Curve, CurveSize};
use stiffarm::findings::visible;
use stiffarm::plan::index::Index;

/// A posture more that gains less than this is hardly worth its time.
const WORTH_MORE: f64 = 0.1;

impl<O> Summarise<O> for Curve {
    fn summary(&self, _options: &O, context: &Context<'_>) -> Result<Summary> {
        let curve = self;
        let (index, sizes) = (curve.index, &curve.sizes);
        let largest = sizes.last().map_or(0, |size| size.point.postures);
        let what_was_done =
            Text::new(format!("The best plan was searched for every number of postures from 1 to {largest}."));
        let value = |s: usize| index_number(index, sizes[s].point.value);
        let ends = sizes.iter().position(|size| size.point.value.is_some());
        let conclusion = match ends {
            None => Text::new("So few postures cannot determine every joint."),
            Some(first) => Text::new(format!("The index {} goes from ", index.in_words()))
                .number(value(first))
                .words(format!(" with {} to ", counted(sizes[first].point.postures, "posture")))
                .number(value(sizes.len() - 1))
                .words(format!(" with {}.", counted(largest, "posture"))),
        };
        // From here on no posture more gains much.
        let is_worth = |size: &CurveSize| size.gain.is_none_or(|gain| gain >= WORTH_MORE);
        let enough = sizes.iter().rposition(|size| size.gain.is_some() && is_worth(size));
        let enough = enough.map_or(ends, |last| Some(last + 1));
        let next_step = match enough.and_then(|s| Some((s, sizes.get(s)?))) {
            None => Text::new("Search for more postures, or add measuring points."),
            Some((s, size)) => {
                let last = s + 1 >= sizes.len();
                let mut text = if last {
                    Text::new("Even the last posture gains more than a tenth")
                } else {
                    Text::new(format!(
                        "Beyond {} one more gains less than a tenth",
                        counted(size.point.postures, "posture")
                    ))
                };
                text = text.words(": plan with ").code(format!("--count {}", size.point.postures));
                if last {
                    text.words(", or with more where the error is still too large.")
                } else {
                    text.words(" unless the error is still too large.")
                }
            }
        };
        let rows = sizes.iter().map(|size| size.point.postures.to_string());
        let mut key = DataTable::of("Best plan found for each number of postures", "postures", rows).numbers(
            &index.in_words(),
            index_quantity(index),
            |s| Some(Number::new(sizes[s].point.value)),
        );
        if index != Index::ExpectedError {
            let errors = Quantity::PERCENT.digits(4);
            key = key.numbers("expected error", errors, |s| Some(Number::new(sizes[s].point.expected_error)));
        }
        let key = key
            .numbers("one more gains", Quantity::SHARE, |s| Some(Number::new(sizes[s].gain)))
            .numbers("no plan below", index_quantity(index), |s| Some(Number::new(sizes[s].bound)))
            .numbers("of what is possible", Quantity::SHARE, |s| Some(Number::new(sizes[s].efficiency)));
        let points = sizes.iter().map(|size| CountPoint {
            postures: size.point.postures,
            value: size.point.value,
            bound: size.bound,
        });
        let points: Vec<CountPoint> = points.collect();
        let blocks = vec![Block::Figure(count_figure(index, &points))];
        let what_was_done = match &curve.certificate_missing {
            Some(why) => what_was_done.words(format!(" There are no bounds: {}.", visible(why))),
            None => what_was_done,
        };
        let what_was_done = if sizes.iter().any(|size| size.point.value.is_none()) {
            what_was_done.words(" –: so few postures cannot determine every joint.")
        } else {
            what_was_done
        };
        let sections = vec![Section::new("count", "How many postures", blocks)];
        let verdict = [what_was_done, conclusion, next_step];
        let is_stopped = sizes.len() < curve.largest;
        let findings = with_stopped(context, curve.findings.clone(), is_stopped, &[]);
        Ok(context.summary(findings, "How many postures".to_string(), verdict, Some(key), sections))
    }
}
