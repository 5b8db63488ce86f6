//! G-code held against what LinuxCNC's interpreter does at each word (`golden/rs274.txt` says which version).

use super::{cell_with, on_workpiece, read_with};
use nalgebra::Vector3;
use stiffarm::findings::Severity;
use stiffarm::model::path::PathPoint;

const TABLE: &str = include_str!("../../golden/rs274.txt");

/// Chords are 0.01 mm from an arc at most, and the table has four decimals \[mm\].
const TOLERANCE: f64 = 0.012;

/// Where a move ends \[mm\], and whether it is rapid.
type Stop = (Vector3<f64>, bool);

struct Row {
    blocks: String,
    /// Where the interpreter drives to, or why it does not.
    driven: Result<Vec<Stop>, String>,
}

fn rows() -> (String, Vec<Row>) {
    let mut lines = TABLE.lines().peekable();
    let mut head = String::new();
    while let Some(comment) = lines.next_if(|line| line.starts_with('#')) {
        if let Some(blocks) = comment.strip_prefix("# HEAD: ") {
            head = blocks.replace(" / ", "\n") + "\n";
        }
    }
    let mut rows = Vec::new();
    while let (Some(program), Some(result)) = (lines.next(), lines.next()) {
        let (begin, rest) = match program.strip_prefix("/ ") {
            Some(rest) => ("/ ", rest),
            None => ("", program),
        };
        let driven = match result.trim().strip_prefix("! ") {
            Some(why) => Err(why.to_string()),
            None => Ok(result.split('|').filter_map(stop).collect()),
        };
        let blocks = begin.to_string() + &rest.replace(" / ", "\n");
        rows.push(Row { blocks, driven });
    }
    (head, rows)
}

fn stop(text: &str) -> Option<Stop> {
    let mut words = text.split_whitespace();
    let is_rapid = words.next()? == "r";
    let numbers: Vec<f64> = words.map(|word| word.parse().unwrap()).collect();
    Some((Vector3::from_column_slice(&numbers), is_rapid))
}

/// Without moves that lead nowhere.
fn moves(start: Vector3<f64>, stops: &[Stop]) -> Vec<Stop> {
    let mut at = start;
    let moves = stops.iter().filter(|(end, _)| {
        let goes = (end - at).norm() > 1e-6;
        at = *end;
        goes
    });
    moves.copied().collect()
}

/// Whether each end of `ends` lies on the way through `way`, one after the other.
fn covers(start: Vector3<f64>, way: &[Stop], ends: &[Stop]) -> bool {
    let mut at = (0, 0.0);
    ends.iter().all(|(end, is_rapid)| {
        for part in at.0..way.len() {
            let from = part.checked_sub(1).map_or(start, |before| way[before].0);
            let along = way[part].0 - from;
            let share = ((end - from).dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
            let least = if part == at.0 { at.1 - 1e-3 } else { 0.0 };
            let is_near = (from + along * share - end).norm() < TOLERANCE;
            if is_near && share >= least && way[part].1 == *is_rapid {
                at = (part, share);
                return true;
            }
        }
        false
    })
}

fn length(start: Vector3<f64>, way: &[Stop]) -> f64 {
    let starts = std::iter::once(start).chain(way.iter().map(|stop| stop.0));
    let parts = starts.zip(way);
    parts.map(|(from, (to, _))| (to - from).norm()).sum()
}

fn is_same(start: Vector3<f64>, ours: &[Stop], theirs: &[Stop]) -> bool {
    let (ours, theirs) = (moves(start, ours), moves(start, theirs));
    let lengths = [length(start, &ours), length(start, &theirs)];
    covers(start, &ours, &theirs)
        && covers(start, &theirs, &ours)
        && (lengths[0] - lengths[1]).abs() < TOLERANCE + 2e-3 * lengths[1]
}

/// Each word leads where the interpreter leads, is refused, or is said to lead elsewhere.
#[test]
fn each_word_is_read_as_the_interpreter_drives_it() {
    let (head, rows) = rows();
    let cell = cell_with("");
    let start = Vector3::new(1.0, 2.0, 5.0);
    let mut shown = String::new();
    for Row { blocks, driven } in &rows {
        // A feed move for those that only ask what becomes of the end; it changes no other answer.
        let text =
            format!("{}{head}G1 X1 Y2 Z5 F100\nG0 X1 Y2 Z5\n{blocks}\n", if blocks.contains('%') { "%\n" } else { "" });
        let outcome = match read_with("a.ngc", &text, &cell) {
            Err(error) => format!("refused: {}", error.message()),
            Ok(path) => {
                let stops: Vec<Stop> =
                    path.points[1..].iter().map(|point: &PathPoint| (on_workpiece(point).0, point.rapid)).collect();
                let codes = |least| {
                    let findings = path.findings.iter().filter(move |finding| finding.severity >= least);
                    let codes: Vec<&str> = findings.map(|finding| finding.code.as_str()).collect();
                    codes.join(", ")
                };
                let (said, noted) = (codes(Severity::Caution), codes(Severity::Note));
                let same = driven.as_ref().is_ok_and(|driven| is_same(start, &stops, driven));
                let what = match (driven, same) {
                    (Ok(_), true) => "same",
                    (Ok(driven), false) => {
                        assert!(
                            !said.is_empty() || noted.contains("machine-place"),
                            "read as another path without a word:\n{blocks}\n{stops:.3?}\n{driven:.3?}"
                        );
                        "other"
                    }
                    (Err(_), _) => "read",
                };
                if noted.is_empty() { what.to_string() } else { format!("{what}, said: {noted}") }
            }
        };
        let theirs = driven.as_ref().err().map_or(String::new(), |why| format!("   [{why}]"));
        shown += &format!("{}{theirs}\n    {outcome}\n", blocks.replace('\n', " / "));
    }
    insta::assert_snapshot!(shown);
}
