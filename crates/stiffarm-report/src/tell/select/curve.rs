//! `--curve`: the best value for each number of postures, and what one more gains.

use super::super::worth::index_number;
use crate::selection::{CountPoint, IndexUnit, count_figure, index_name};
use crate::tell::Given;
use crate::tell::{Block, DataTable, Section, Text, Told};
use serde::Deserialize;
use stiffarm::Result;
use stiffarm::findings::visible;
use stiffarm::plan::index::Index;
use stiffarm::plan::select::ErrorAtCount;

/// A posture more that gains less than this is hardly worth its time.
const WORTH_MORE: f64 = 0.1;

/// What `select --curve` writes.
#[derive(Deserialize)]
struct Curve {
    index: Index,
    sizes: Vec<Size>,
    certificate_missing: Option<String>,
}

#[derive(Deserialize)]
struct Size {
    #[serde(flatten)]
    point: ErrorAtCount,
    gain: Option<f64>,
    bound: Option<f64>,
}

/// The part of a page for the best value against the number of postures.
pub(super) fn told(context: &Given<'_>) -> Result<Told> {
    let curve: Curve = context.saved.result()?;
    let (index, sizes) = (curve.index, &curve.sizes);
    let largest = sizes.last().map_or(0, |size| size.point.postures);
    let done = Text::new(format!(
        "The best plan was searched for every number of postures from 1 to {largest}."
    ));
    let value = |s: usize| index_number(context, index, &format!("/sizes/{s}/value"));
    let ends = sizes.iter().position(|size| size.point.value.is_some());
    let came = match ends {
        None => Text::new("So few postures cannot determine every joint."),
        Some(first) => Text::new(format!("The index {} goes from ", index_name(index)))
            .number(value(first))
            .words(format!(
                " with {} to ",
                counted(sizes[first].point.postures)
            ))
            .number(value(sizes.len() - 1))
            .words(format!(" with {}.", counted(largest))),
    };
    // From here on no posture more gains much.
    let is_worth = |size: &Size| size.gain.is_none_or(|gain| gain >= WORTH_MORE);
    let enough = sizes
        .iter()
        .rposition(|size| size.gain.is_some() && is_worth(size));
    let enough = enough.map_or(ends, |last| Some(last + 1));
    let next = match enough.and_then(|s| Some((s, sizes.get(s)?))) {
        None => Text::new("Search for more postures, or add measuring points."),
        Some((s, size)) => {
            let last = s + 1 >= sizes.len();
            let mut text = match last {
                true => Text::new("Even the last posture gains more than a tenth"),
                false => Text::new(format!(
                    "Beyond {} one more gains less than a tenth",
                    counted(size.point.postures)
                )),
            };
            text = text
                .words(": plan with ")
                .code(format!("--postures {}", size.point.postures));
            match last {
                true => text.words(", or with more where the error is still too large."),
                false => text.words(" unless the error is still too large."),
            }
        }
    };
    let unit = match IndexUnit::of(index).unit {
        "" => String::new(),
        unit => format!(" [{unit}]"),
    };
    let has_bound = sizes.iter().any(|size| size.bound.is_some());
    let mut headings = vec![
        "postures".to_string(),
        format!("{}{unit}", index_name(index)),
        "one more gains [%]".to_string(),
    ];
    if has_bound {
        headings.push(format!("no plan below{unit}"));
        headings.push("of what is possible [%]".to_string());
    }
    let mut key = DataTable::new("Best plan found for each number of postures", headings);
    for (s, size) in sizes.iter().enumerate() {
        let percent = |key: &str| {
            let number = context.number(&format!("/sizes/{s}/{key}"));
            Text::from(number.percent().bare().decimals(1))
        };
        let mut cells = vec![Text::from(value(s).bare()), percent("gain")];
        if has_bound {
            let bound = index_number(context, index, &format!("/sizes/{s}/bound"));
            cells.extend([bound.bare().into(), percent("efficiency")]);
        }
        key.row(size.point.postures.to_string(), cells);
    }
    let points = sizes.iter().map(|size| CountPoint {
        postures: size.point.postures,
        value: size.point.value,
        bound: size.bound,
    });
    let points: Vec<CountPoint> = points.collect();
    let mut blocks = vec![Block::Figure(count_figure(index, &points))];
    if let Some(why) = &curve.certificate_missing {
        let why = format!("There are no bounds: {}.", visible(why));
        blocks.push(Block::Text(why.into()));
    }
    let sections = vec![Section::new("count", "How many postures", blocks)];
    let verdict = [done, came, next];
    Ok(context.told(
        "How many postures".to_string(),
        verdict,
        Some(key),
        sections,
    ))
}

fn counted(count: usize) -> String {
    match count {
        1 => "one posture".to_string(),
        count => format!("{count} postures"),
    }
}
