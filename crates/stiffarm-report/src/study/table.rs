//! One table, for a CSV file and for the page.

use crate::figure::csv;

/// One cell: the page rounds numbers, the CSV file has every digit.
#[derive(Debug, Clone, PartialEq)]
pub enum Cell {
    /// A name or a remark.
    Text(String),
    /// A number, or none.
    Number(Option<f64>),
}

impl Cell {
    /// A fraction in percent.
    pub(super) fn percent(fraction: Option<f64>) -> Self {
        Cell::Number(fraction.map(|f| 100.0 * f))
    }

    /// Every digit, empty for none; text as a table of comma-separated values has it.
    fn exact(&self) -> String {
        match self {
            Cell::Text(text) => csv::text(text),
            Cell::Number(value) => csv::number(*value),
        }
    }
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Cell::Text(text.to_string())
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Cell::Text(text)
    }
}

impl From<f64> for Cell {
    fn from(value: f64) -> Self {
        Cell::Number(Some(value))
    }
}

impl From<Option<f64>> for Cell {
    fn from(value: Option<f64>) -> Self {
        Cell::Number(value)
    }
}

/// A table: file name stem, caption, headings, rows of cells.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Stem of the CSV file.
    pub id: String,
    /// What it shows.
    pub caption: String,
    /// Headings, units included.
    pub headings: Vec<String>,
    /// Rows; every row has one cell per heading.
    pub rows: Vec<Vec<Cell>>,
}

impl Table {
    pub(super) fn new(id: &str, caption: impl Into<String>, headings: Vec<String>) -> Self {
        Table { id: id.into(), caption: caption.into(), headings, rows: Vec::new() }
    }

    /// The table as CSV, LF line ends, cells quoted where needed. Text that a spreadsheet program would take for a
    /// formula begins with an apostrophe.
    pub fn csv(&self) -> String {
        let headings = self.headings.iter().map(|heading| csv::text(heading));
        let mut lines = vec![headings.collect::<Vec<_>>()];
        lines.extend(self.rows.iter().map(|row| row.iter().map(Cell::exact).collect()));
        lines.iter().map(|cells| cells.join(",") + "\n").collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formulas_in_names_stay_text_and_numbers_numbers() {
        let mut table = Table::new("t", "", vec!["=group".into(), "value [%]".into()]);
        table.rows.push(vec!["=cmd|' /C calc'!A0".into(), (-0.5).into()]);
        table.rows.push(vec!["@SUM(A1,A2)".into(), None.into()]);
        table.rows.push(vec!["-3".into(), 1e-12.into()]);
        let lines = "'=group,value [%]\n'=cmd|' /C calc'!A0,-0.5\n\"'@SUM(A1,A2)\",\n-3,1e-12\n";
        assert_eq!(table.csv(), lines);
    }
}
