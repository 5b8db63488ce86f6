//! What the marks of a picture mean.

use super::elements::{Element, Geometry};
use crate::figure::drawing::{DISTINCT_ITEMS, KeyEntry, Sample, Tone};
use crate::scene::Scene;
use crate::scene::arm::Arm;

/// The entries, of what is drawn only; `others` are postures drawn as lines, the same ones together.
pub(super) fn key(scene: &Scene, arms: &[Arm<'_>], others: &[Vec<usize>], elements: &[Element]) -> Vec<KeyEntry> {
    let has = |sample: Sample, tone: Tone, red: bool| {
        elements.iter().any(|element| {
            let same = match element.geometry {
                _ if tone == Tone::Bound => sample == Sample::Line,
                Geometry::Solid(_) | Geometry::Hull(_) => sample == Sample::Area,
                Geometry::Line(_) => matches!(sample, Sample::Line | Sample::LineAndPoint),
                Geometry::Arrow(_) => sample == Sample::Arrow,
                Geometry::Point(_) => sample == Sample::Point,
                Geometry::Level(_) => false,
            };
            same && element.tone == tone && element.caution == red
        })
    };
    let (ropes, forces): (Vec<&str>, Vec<&str>) =
        scene.loads.iter().map(|load| load.kind).partition(|kind| ["rope", "cylinder"].contains(kind));
    let rope = if ropes.contains(&"rope") { "rope" } else { "cylinder" };
    let force = if forces == ["weight"] { "weight" } else { "force" };
    let rows: [(&str, Sample, Tone); 15] = [
        ("arm", Sample::Area, Tone::Body),
        ("joints", Sample::LineAndPoint, Tone::Skeleton),
        ("tool", Sample::Area, Tone::Attached),
        ("flange", Sample::Point, Tone::Attached),
        ("loading point", Sample::Point, Tone::Pull),
        (rope, Sample::Line, Tone::Pull),
        (force, Sample::Arrow, Tone::Pull),
        ("anchor", Sample::Point, Tone::Fixed),
        ("measuring point", Sample::Point, Tone::Target),
        ("tracker station", Sample::Point, Tone::Ray),
        ("beam", Sample::Line, Tone::Ray),
        ("beam, hidden", Sample::Line, Tone::FaintRay),
        ("obstacle", Sample::Area, Tone::Fixed),
        ("floor, wall", Sample::Area, Tone::Ground),
        ("limit", Sample::Line, Tone::Bound),
    ];
    let entry = |label: &str, sample, tone, caution| KeyEntry { label: label.to_string(), sample, tone, caution };
    let mut entries = Vec::new();
    for (label, sample, tone) in rows {
        // In red where nothing of the kind is there in its own colour.
        let red = [false, true].into_iter().find(|red| has(sample, tone, *red));
        entries.extend(red.map(|red| entry(label, sample, tone, red)));
    }
    if elements.iter().any(|element| element.caution) {
        entries.push(entry("violates a limit", Sample::Area, Tone::Body, true));
    }
    let (distinct, rest): (Vec<&Vec<usize>>, Vec<&Vec<usize>>) =
        others.iter().partition(|same| same[0] < DISTINCT_ITEMS);
    for same in distinct {
        let names: Vec<&str> = same.iter().map(|n| arms[*n].posture.name.as_str()).collect();
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
