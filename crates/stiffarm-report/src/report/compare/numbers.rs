//! Key tables of results, number by number.

use crate::page::{DataTable, Number, Part, Piece, Text};

/// Heading of the total ± of a stiffness.
const TOTAL: &str = "± total [%]";

/// The numbers of the key tables beside each other.
pub(super) struct Numbers {
    /// One row each, with the difference in the last column.
    pub table: DataTable,
    /// How many differ.
    pub differ: usize,
    /// The joint stiffness that differs most.
    pub stiffness: Option<StiffnessChange>,
}

/// By how much a joint stiffness differs between results.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct StiffnessChange {
    /// Name of the joint.
    pub joint: String,
    /// Difference from the first result \[%\], without its sign.
    pub change: f64,
    /// The larger total ± of the two \[%\].
    pub total: f64,
}

impl StiffnessChange {
    /// Whether it is more than either result says of itself.
    pub(super) fn is_beyond(&self) -> bool {
        self.change > self.total
    }
}

impl Numbers {
    /// Every number of the key tables; nothing where a result has no such table.
    pub(super) fn of(parts: &[(usize, &Part)]) -> Option<Self> {
        let tables: Vec<(usize, &DataTable)> = parts
            .iter()
            .map(|(number, part)| Some((*number, part.key.as_ref()?)))
            .collect::<Option<_>>()?;
        let names = parts.iter().map(|(_, part)| part.name.clone());
        let headings = std::iter::once("number".to_string())
            .chain(names)
            .chain(["difference".to_string()]);
        let mut out = DataTable::new("The key tables, number by number", headings);
        let mut rows: Vec<String> = Vec::new();
        for row in tables.iter().flat_map(|(_, table)| &table.rows) {
            let name = row.first().map(Text::plain).unwrap_or_default();
            if !rows.contains(&name) {
                rows.push(name);
            }
        }
        let mut columns: Vec<&String> = Vec::new();
        for heading in tables
            .iter()
            .flat_map(|(_, table)| table.headings.iter().skip(1))
        {
            if !columns.contains(&heading) {
                columns.push(heading);
            }
        }
        let mut differ = 0;
        let mut stiffness: Option<StiffnessChange> = None;
        for row in &rows {
            for column in &columns {
                let cells: Vec<Option<(usize, &Text)>> = tables
                    .iter()
                    .map(|(number, table)| Some((*number, cell(table, row, column)?)))
                    .collect();
                let is_number = |text: &Text| text.0.iter().any(|p| matches!(p, Piece::Number(_)));
                if !cells.iter().flatten().any(|(_, text)| is_number(text)) {
                    continue;
                }
                let shown = cells.iter().map(|cell| match cell {
                    Some((number, text)) => of_result(text, *number),
                    None => Text::from("–"),
                });
                let shown: Vec<Text> = shown.collect();
                let mut difference = difference(&shown);
                differ += usize::from(matches!(difference.0[0], Piece::Different(_)));
                if column.starts_with("k [") {
                    let totals = tables.iter().map(|(_, table)| cell(table, row, TOTAL));
                    let totals: Vec<Option<f64>> = totals.map(|cell| value(cell?)).collect();
                    for change in changes(row, &shown, &totals) {
                        if change.is_beyond() {
                            difference.0.push(Piece::Words(" beyond ±".to_string()));
                        }
                        // One beyond its ± says more than a larger one within.
                        let weight = |c: &StiffnessChange| (c.is_beyond(), c.change);
                        if stiffness
                            .as_ref()
                            .is_none_or(|most| weight(most) < weight(&change))
                        {
                            stiffness = Some(change);
                        }
                    }
                }
                out.row(
                    format!("{row} · {column}"),
                    shown.into_iter().chain([difference]),
                );
            }
        }
        (!out.rows.is_empty()).then_some(Self {
            table: out,
            differ,
            stiffness,
        })
    }

    /// How many of them differ.
    pub(super) fn sentence(&self) -> String {
        match (self.differ, self.table.rows.len()) {
            (0, all) => format!("All {all} numbers of the key tables are the same."),
            (differ, all) => format!(
                "{differ} of {all} numbers of the key tables differ; they are marked with ≠."
            ),
        }
    }
}

/// The stiffness of a joint in the other results against the first, where both say their total ±.
fn changes(joint: &str, shown: &[Text], totals: &[Option<f64>]) -> Vec<StiffnessChange> {
    let Some((first, own)) = value(&shown[0]).zip(totals[0]) else {
        return Vec::new();
    };
    let others = shown.iter().zip(totals).skip(1);
    let others = others.filter_map(|(text, total)| {
        Some(StiffnessChange {
            joint: joint.to_string(),
            change: 100.0 * (value(text)? - first).abs() / first.abs(),
            total: total.as_ref()?.max(own),
        })
    });
    others.collect()
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
    let place = table
        .headings
        .iter()
        .position(|heading| heading == column)?;
    let mut rows = table.rows.iter();
    let row = rows.find(|cells| cells.first().is_some_and(|name| name.plain() == row))?;
    row.get(place)
}

/// How far the others are from the first, where that shows.
fn difference(cells: &[Text]) -> Text {
    let first = &cells[0];
    if cells.iter().all(|cell| cell.plain() == first.plain()) {
        return Text::from("same");
    }
    let others = cells[1..]
        .iter()
        .map(|cell| match (value(first), value(cell)) {
            (Some(a), Some(b)) if a != 0.0 => {
                let change = Number::new("", Some(100.0 * (b - a) / a.abs())).significant(3);
                let sign = if b > a { "+" } else { "" };
                format!("{sign}{} %", change.digits())
            }
            (Some(_), Some(_)) => "differs".to_string(),
            (Some(_), None) => "missing".to_string(),
            (None, _) => "new".to_string(),
        });
    let others: Vec<String> = others.collect();
    Text(vec![Piece::Different(others.join(", "))])
}

/// A text whose numbers say which result they stand in.
pub(super) fn of_result(text: &Text, result: usize) -> Text {
    let pieces = text.0.iter().cloned().map(|piece| match piece {
        Piece::Number(number) => Piece::Number(Number {
            result: Some(result),
            ..number
        }),
        other => other,
    });
    Text(pieces.collect())
}
