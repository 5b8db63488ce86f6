//! What the marks of a picture mean.

use super::Looked;
use super::things::{Things, What};
use crate::figure::drawing::{DISTINCT_ITEMS, KeyEntry, Sample, Tone};
use stiffarm::model::cell::Cell;
use stiffarm::model::load::Load;

/// The entries, of what is drawn only; `others` are postures drawn as lines, the same ones together.
pub(super) fn key(cell: &Cell, looked: &[Looked<'_>], others: &[Vec<usize>], things: &Things) -> Vec<KeyEntry> {
    let has = |sample: Sample, tone: Tone, red: bool| {
        things.things.iter().any(|thing| {
            let same = match thing.what {
                What::Solid(_) | What::Hull(_) => sample == Sample::Area,
                What::Line(_) => matches!(sample, Sample::Line | Sample::LineAndPoint),
                What::Arrow(_) => sample == Sample::Arrow,
                What::Point(_) => sample == Sample::Point,
                What::Level(_) => false,
            };
            same && thing.tone == tone && thing.caution == red
        })
    };
    let forces = cell.setup.load.each();
    let forces: Vec<&Load> = forces.filter(|load| !matches!(load, Load::Rope { .. })).collect();
    let force = match forces[..] {
        [Load::Weight { .. }] => "weight",
        _ => "force",
    };
    let rows: [(&str, Sample, Tone); 14] = [
        ("arm", Sample::Area, Tone::Body),
        ("joints", Sample::LineAndPoint, Tone::Skeleton),
        ("tool", Sample::Area, Tone::Attached),
        ("flange", Sample::Point, Tone::Attached),
        ("loading point", Sample::Point, Tone::Pull),
        (cell.setup.load.line(), Sample::Line, Tone::Pull),
        (force, Sample::Arrow, Tone::Pull),
        ("anchor", Sample::Point, Tone::Fixed),
        ("measuring point", Sample::Point, Tone::Target),
        ("tracker station", Sample::Point, Tone::Ray),
        ("beam", Sample::Line, Tone::Ray),
        ("beam, hidden", Sample::Line, Tone::FaintRay),
        ("obstacle", Sample::Area, Tone::Fixed),
        ("floor, wall", Sample::Area, Tone::Ground),
    ];
    let entry = |label: &str, sample, tone, caution| KeyEntry { label: label.to_string(), sample, tone, caution };
    let mut entries = Vec::new();
    for (label, sample, tone) in rows {
        for red in [false, true] {
            // Red things of a kind that is there in its own colour, too, go without an entry.
            let first = !red || !has(sample, tone, false);
            if has(sample, tone, red) && first {
                entries.push(entry(label, sample, tone, red));
            }
        }
    }
    let bound = |red| {
        let mut things = things.things.iter();
        things.any(|thing| thing.tone == Tone::Bound && thing.caution == red)
    };
    if bound(false) || bound(true) {
        entries.push(entry("limit", Sample::Line, Tone::Bound, !bound(false)));
    }
    if things.things.iter().any(|thing| thing.caution) {
        entries.push(entry("violates a limit", Sample::Area, Tone::Body, true));
    }
    let (told, rest): (Vec<&Vec<usize>>, Vec<&Vec<usize>>) = others.iter().partition(|same| same[0] < DISTINCT_ITEMS);
    for same in told {
        let names: Vec<&str> = same.iter().map(|n| looked[*n].posture.name.as_str()).collect();
        let label = match names.len() {
            1 => format!("posture {}", names[0]),
            _ => format!("postures {}", names.join(", ")),
        };
        entries.push(entry(&label, Sample::LineAndPoint, Tone::Item(same[0]), false));
    }
    if !rest.is_empty() {
        let count: usize = rest.iter().map(|same| same.len()).sum();
        let label = format!("{count} more");
        entries.push(entry(&label, Sample::Line, Tone::Item(DISTINCT_ITEMS), false));
    }
    entries
}
