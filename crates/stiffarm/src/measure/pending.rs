//! What is said of a table itself: what of it is not measured yet, what was taken for granted.

use crate::error::{Code, Error};
use crate::findings::{Finding, codes, list};
use crate::model::measurement::{PendingReading, ReadingTable};

/// Postures that the sentence names one by one.
const MOST_NAMED: usize = 12;

/// True for what is said of the table itself and not of its numbers.
pub fn is_of_table(finding: &Finding) -> bool {
    [
        codes::NOT_MEASURED_YET,
        codes::MERGED_CELLS,
        codes::NAMES_BY_SHEET,
        codes::LOADS_FROM_NAMES,
        codes::HIDDEN_CELLS,
        codes::CARRIED_DOWN,
        codes::ROWS_LEFT_OUT,
        codes::READING_RESOLUTION,
    ]
    .contains(&finding.code.as_str())
}

/// Says in one sentence which rows of a table are not filled in yet; `None` where all are.
pub fn not_measured_yet(table: &ReadingTable) -> Option<Finding> {
    if table.pending.is_empty() {
        return None;
    }
    let filled = table.filled();
    let rows = filled + table.pending.len();
    let mut seen: Vec<&str> = Vec::new();
    for row in &table.pending {
        // Rows of a posture mostly stand together.
        if seen.last() != Some(&row.posture.as_str()) && !seen.contains(&row.posture.as_str()) {
            seen.push(&row.posture);
        }
    }
    let open: Vec<String> = seen
        .iter()
        .map(|posture| if table.has_readings_of(posture) { missing(table, posture) } else { (*posture).to_string() })
        .collect();
    let left_out: Vec<&str> = table.incomplete.iter().map(|posture| posture.posture.name.as_str()).collect();
    let left_out = match left_out.as_slice() {
        [] => String::new(),
        names => format!(" Left out until measured both unloaded and loaded: {}.", shortened(names)),
    };
    Some(Finding::note(
        codes::NOT_MEASURED_YET,
        "readings",
        format!(
            "Not measured yet: {} {}; {filled} of {rows} rows are filled in.{left_out}",
            if open.len() == 1 { "posture" } else { "postures" },
            shortened(&open)
        ),
    ))
}

/// Why a table without a single complete posture gives nothing.
pub(super) fn nothing_measured(table: &ReadingTable) -> Option<Error> {
    if !table.postures.is_empty() || (table.pending.is_empty() && table.incomplete.is_empty()) {
        return None;
    }
    let error = match table.filled() {
        0 => Error::new(
            Code::TooFewData,
            format!("The sheet is not filled in: all {} rows lack their position.", table.pending.len()),
        ),
        _ => Error::new(Code::TooFewData, "No posture is measured both unloaded and loaded yet."),
    };
    Some(
        error.hint(
            "fill in x, y and z of a posture without the load and under it; rows left empty are not measured yet",
        ),
    )
}

/// `3 (loaded; unloaded-2 at 4)`: the states that are missing, with the points where only
/// some are.
fn missing(table: &ReadingTable, posture: &str) -> String {
    let rows: Vec<&PendingReading> = table.pending.iter().filter(|row| row.posture == posture).collect();
    let mut states: Vec<&str> = Vec::new();
    for row in &rows {
        if !states.contains(&row.state.as_str()) {
            states.push(&row.state);
        }
    }
    let each = states.iter().map(|state| {
        if !table.has_readings_in(posture, state) {
            return (*state).to_string();
        }
        let points = rows.iter().filter(|row| row.state == *state);
        let points: Vec<&str> = points.map(|row| row.point.as_str()).collect();
        format!("{state} at {}", list(&points))
    });
    format!("{posture} ({})", each.collect::<Vec<_>>().join("; "))
}

fn shortened<S: AsRef<str>>(names: &[S]) -> String {
    let shown = names.len().min(MOST_NAMED);
    let mut shown: Vec<String> = names[..shown].iter().map(|n| n.as_ref().to_string()).collect();
    if names.len() > MOST_NAMED {
        shown.push(format!("{} more", names.len() - MOST_NAMED));
    }
    list(&shown)
}
