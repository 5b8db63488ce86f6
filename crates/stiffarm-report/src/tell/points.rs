//! What pages about many points share: those where something is largest, and all of them.

use crate::tell::{Block, DataTable, Section};
use stiffarm::findings::visible;
use stiffarm::work::predict::PathExtremes;

/// Most rows of the table of all points.
const ROWS: usize = 200;

/// Places of values, the largest first.
pub(super) fn largest_first(sizes: impl Iterator<Item = f64>) -> Vec<usize> {
    let mut sizes: Vec<(usize, f64)> = sizes.enumerate().collect();
    sizes.sort_by(|a, b| b.1.total_cmp(&a.1));
    sizes.into_iter().map(|(i, _)| i).collect()
}

/// All of `count` points in a folded table, of very many some evenly along the path; `table` takes a caption and
/// the points.
pub(super) fn all_points(
    summary: &str,
    count: usize,
    table: impl FnOnce(&str, &[usize]) -> DataTable,
) -> Section {
    let (caption, rows): (String, Vec<usize>) = match count <= ROWS {
        true => (
            "All points in their order".to_string(),
            (0..count).collect(),
        ),
        false => (
            format!(
                "{ROWS} of the {count} points, evenly along the path; the result's file has all"
            ),
            (0..ROWS).map(|i| i * (count - 1) / (ROWS - 1)).collect(),
        ),
    };
    let table = Block::Table(table(&caption, &rows));
    let details = Block::Details(summary.to_string(), vec![table]);
    Section::new("points", "Points", vec![details])
}

/// Names and places in the result of the principal axes where the tip bends most and least; `name` is that of a point.
pub(super) fn extreme_rows(
    extremes: &PathExtremes,
    name: impl Fn(usize) -> Option<String>,
) -> Vec<(String, String)> {
    let row = |words: &str, at: usize, key: &str| {
        let name = format!("{words}, point {}", visible(&name(at)?));
        Some((name, format!("/extremes/{key}/principal")))
    };
    let (best, worst) = (extremes.best.at, extremes.worst.at);
    let least = (best != worst).then(|| row("bends least", best, "best"));
    let rows = [row("bends most", worst, "worst"), least.flatten()];
    rows.into_iter().flatten().collect()
}
