//! Key tables of results, number by number.

use super::agreement::{StiffnessChange, changes};
use crate::order::in_order;
use crate::page::{DataTable, Number, Part, Piece, Text};
use crate::report::WithCell;

/// The numbers of the key tables beside each other.
pub(super) struct Numbers {
    /// One row each, with the difference of each further result from the first in the last columns.
    pub table: DataTable,
    /// How many differ.
    pub differ: usize,
    /// The joint stiffness that differs most.
    pub stiffness: Option<StiffnessChange>,
}

impl Numbers {
    /// Every number of the key tables; nothing where a result has no such table.
    pub(super) fn of(saved_results: &[WithCell<'_>], parts: &[(usize, &Part)]) -> Option<Self> {
        let results: Vec<&WithCell<'_>> = parts.iter().filter_map(|(number, _)| saved_results.get(*number)).collect();
        let mut all_changes = changes(&results);
        let tables: Vec<&DataTable> = parts.iter().map(|(_, part)| part.key.as_ref()).collect::<Option<_>>()?;
        let names: Vec<&String> = parts.iter().map(|(_, part)| &part.name).collect();
        let differences = names.iter().skip(1).map(|name| match names.len() {
            2 => "difference".to_string(),
            _ => format!("difference of {name}"),
        });
        let headings =
            std::iter::once("number".to_string()).chain(names.iter().map(ToString::to_string)).chain(differences);
        let mut out = DataTable::new(
            "The key tables, number by number; what is in percent differs by percentage points",
            headings,
        );
        let rows = tables.iter().flat_map(|table| &table.rows);
        let rows = rows.map(|row| row.first().map(Text::plain).unwrap_or_default());
        let rows = in_order(rows);
        let columns = tables.iter().flat_map(|table| &table.headings[1..]);
        let columns = in_order(columns);
        let mut differ = 0;
        let mut stiffness: Option<StiffnessChange> = None;
        // All of one quantity together: what is sought first, then how sure it is.
        for column in &columns {
            for row in &rows {
                let cells: Vec<Option<&Text>> = tables.iter().map(|table| cell(table, row, column)).collect();
                let is_number = |text: &Text| text.0.iter().any(|p| matches!(p, Piece::Number(_)));
                if !cells.iter().flatten().any(|text| is_number(text)) {
                    continue;
                }
                let shown = cells.iter();
                let shown = shown.map(|cell| cell.cloned().unwrap_or_else(|| "–".into()));
                let shown: Vec<Text> = shown.collect();
                let others = shown.iter().skip(1);
                let mut differences: Vec<Text> = others.map(|other| difference(&shown[0], other, column)).collect();
                let differs = |text: &Text| matches!(text.0[0], Piece::Different(_));
                differ += usize::from(differences.iter().any(differs));
                if column.starts_with("k [") {
                    for (i, text) in differences.iter_mut().enumerate() {
                        let is_of_row = |change: &StiffnessChange| {
                            change.result == i + 1 && change.joint == row.replace('\u{a0}', " ")
                        };
                        let Some(position) = all_changes.iter().position(is_of_row) else {
                            continue;
                        };
                        let change = all_changes.swap_remove(position);
                        if change.is_beyond() {
                            text.0.push(Piece::Words(" beyond ±".to_string()));
                        }
                        // One beyond its ± says more than a larger one within.
                        let weight = |c: &StiffnessChange| (c.is_beyond(), c.change);
                        if stiffness.as_ref().is_none_or(|most| weight(most) < weight(&change)) {
                            stiffness = Some(change);
                        }
                    }
                }
                out.row(format!("{row} · {column}"), shown.into_iter().chain(differences));
            }
        }
        (!out.rows.is_empty()).then_some(Self { table: out, differ, stiffness })
    }

    /// How many of them differ.
    pub(super) fn sentence(&self) -> String {
        match (self.differ, self.table.rows.len()) {
            (0, all) => format!("All {all} numbers of the key tables are the same."),
            (differ, all) => format!("{differ} of {all} numbers of the key tables differ; they are marked with ≠."),
        }
    }
}

/// The first number of a cell, as it is shown.
fn value(cell: &Text) -> Option<f64> {
    cell.0.iter().find_map(|piece| match piece {
        Piece::Number(number) => number.value.map(|value| value * number.factor),
        _ => None,
    })
}

/// The cell of a table by the name of its row and its column's heading.
fn cell<'a>(table: &'a DataTable, row: &str, column: &str) -> Option<&'a Text> {
    let place = table.headings.iter().position(|heading| heading == column)?;
    let mut rows = table.rows.iter();
    let row = rows.find(|cells| cells.first().is_some_and(|name| name.plain() == row))?;
    row.get(place)
}

/// How far another cell of a column is from the first, where that shows. Percent differ by percentage points: a
/// percentage of a percentage says little.
fn difference(first: &Text, other: &Text, column: &str) -> Text {
    if first.plain() == other.plain() {
        return Text::from("same");
    }
    let in_percent = column.contains('%') || [first, other].iter().any(|cell| is_percent(cell));
    let said = match (value(first), value(other)) {
        (Some(a), Some(b)) if in_percent => signed(b - a, 2) + "\u{a0}points",
        (Some(a), Some(b)) if a != 0.0 => signed(100.0 * (b - a) / a.abs(), 3) + " %",
        (Some(_), Some(_)) => "differs".to_string(),
        (Some(_), None) => "missing".to_string(),
        (None, _) => "new".to_string(),
    };
    Text(vec![Piece::Different(said)])
}

/// A number with its sign.
fn signed(value: f64, digits: usize) -> String {
    let sign = if value > 0.0 { "+" } else { "" };
    let number = Number::computed(value).significant(digits);
    format!("{sign}{}", number.digits())
}

/// Whether the number of a cell is shown in percent.
fn is_percent(cell: &Text) -> bool {
    let mut numbers = cell.0.iter();
    numbers.any(|piece| matches!(piece, Piece::Number(number) if number.unit == "%"))
}
