//! Tables whose columns know the unit and the digits of their numbers.

use super::{Number, Piece, Quantity, Text};

/// Longest cell of a column of numbers \[characters\]: a number, its ± and a word.
const LONGEST_NUMBER: usize = 40;

/// A table of texts and numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct DataTable {
    /// What it shows.
    pub caption: String,
    /// Headings, units included.
    pub headings: Vec<String>,
    /// Rows, one cell per heading; the first cell names the row.
    pub rows: Vec<Vec<Text>>,
}

impl DataTable {
    /// A table without rows.
    pub fn new<S: Into<String>>(caption: impl Into<String>, headings: impl IntoIterator<Item = S>) -> Self {
        DataTable {
            caption: caption.into(),
            headings: headings.into_iter().map(Into::into).collect(),
            rows: Vec::new(),
        }
    }

    /// A table with a row for each name; columns are added to it.
    pub fn of<T: Into<Text>>(caption: impl Into<String>, heading: &str, names: impl IntoIterator<Item = T>) -> Self {
        let mut table = DataTable::new(caption, [heading]);
        table.rows = names.into_iter().map(|name| vec![name.into()]).collect();
        table
    }

    /// Adds a column of words on the right, a function of the row; one without a word in any row is left out.
    #[must_use]
    pub fn words(mut self, heading: impl Into<String>, cell: impl Fn(usize) -> Text) -> Self {
        let cells: Vec<Text> = (0..self.rows.len()).map(cell).collect();
        let says = |cell: &Text| !["", "–"].contains(&cell.plain().as_str());
        if cells.iter().any(says) {
            self.headings.push(heading.into());
            let rows = self.rows.iter_mut().zip(cells);
            rows.for_each(|(row, cell)| row.push(cell));
        }
        self
    }

    /// Adds a column of numbers on the right, its unit in the heading; one without a number in any row is left out.
    #[must_use]
    pub fn numbers(self, heading: &str, quantity: Quantity, cell: impl Fn(usize) -> Option<Number>) -> Self {
        let heading = match quantity.unit {
            "" => heading.to_string(),
            unit => format!("{heading} [{unit}]"),
        };
        self.words(heading, |row| match cell(row) {
            Some(number) => number.of(quantity).bare().into(),
            None => "–".into(),
        })
    }

    /// Whether each column holds numbers, which stand under each other; one word or sentence makes it one of words.
    pub fn of_numbers(&self) -> Vec<bool> {
        let is_number = |cell: &Text| match cell.0.as_slice() {
            [] => true,
            [Piece::Words(words)] => words.is_empty() || words == "–",
            pieces => {
                let has_number = pieces.iter().any(|p| matches!(p, Piece::Number(_)));
                has_number && cell.plain().chars().count() <= LONGEST_NUMBER
            }
        };
        let columns = 0..self.headings.len();
        let all = |c: usize| self.rows.iter().all(|row| row.get(c).is_none_or(is_number));
        columns.map(|c| c > 0 && all(c)).collect()
    }

    /// Adds a row by its name and its cells.
    pub fn row(&mut self, name: impl Into<Text>, cells: impl IntoIterator<Item = Text>) {
        let row = std::iter::once(name.into()).chain(cells);
        self.rows.push(row.collect());
    }
}
