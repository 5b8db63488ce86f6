//! Tables of the studies' folders as tables of a page.

use crate::study::{Cell, Table};
use crate::summary::{DataTable, Number, Text};
use stiffarm::findings::visible;

/// The same table; its numbers have four digits.
pub(super) fn data_table(table: &Table) -> DataTable {
    let mut out = DataTable::new(table.caption.clone(), table.headings.clone());
    for row in &table.rows {
        let cells = row.iter().map(|cell| match cell {
            Cell::Text(text) => Text::from(visible(text).into_owned()),
            Cell::Number(value) => Number::computed(*value).into(),
        });
        out.rows.push(cells.collect());
    }
    out
}
