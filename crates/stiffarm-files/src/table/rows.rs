//! Rows of a table with their fields, whatever file they came from.

use smol_str::SmolStr;
use std::ops::Range;
use stiffarm::findings::list;

/// Runs of lines that a sentence names.
const MOST_NAMED: usize = 12;

/// A field and where it begins, counted from 1: a character column of a text,
/// a column of a spreadsheet.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Field {
    pub(super) text: SmolStr,
    pub(super) column: u32,
    /// The text says what a spreadsheet's cell holds that is neither text nor
    /// number: a date, ….
    pub(super) other: bool,
}

impl Field {
    /// One with nothing in it.
    pub(super) fn empty() -> Self {
        Field { text: SmolStr::default(), column: 1, other: false }
    }
}

/// The heading that the cell file gives to a table without one.
pub(super) fn named(order: &[String]) -> impl Iterator<Item = Field> {
    (1..).zip(order).map(|(column, name)| Field { text: name.as_str().into(), column, other: false })
}

/// A row and its line, counted from 1; it has one field per heading.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Row<'t> {
    pub(super) line: usize,
    pub(super) fields: &'t [Field],
    /// A quotation mark is not closed on this line.
    pub(super) open_quote: bool,
    /// Which of the files it stands in.
    pub(super) source: usize,
}

impl Row<'_> {
    /// True where nothing stands in any field.
    pub(super) fn is_empty(&self) -> bool {
        self.fields.iter().all(|field| field.text.is_empty())
    }
}

/// Rows with their fields one after the other: a million small lists would leave
/// the memory in pieces.
#[derive(Debug, Default)]
pub(super) struct Rows {
    fields: Vec<Field>,
    spans: Vec<Span>,
}

/// Where a row's fields stand.
#[derive(Debug)]
struct Span {
    line: usize,
    fields: Range<usize>,
    open_quote: bool,
    source: usize,
}

impl Rows {
    /// Adds a row.
    pub(super) fn push(&mut self, line: usize, fields: impl IntoIterator<Item = Field>, open_quote: bool) {
        let start = self.fields.len();
        self.fields.extend(fields);
        self.spans.push(Span { line, fields: start..self.fields.len(), open_quote, source: 0 });
    }

    /// Adds a row like `row` with other fields, of the file `source`.
    pub(super) fn push_as(&mut self, row: &Row<'_>, source: usize, fields: impl IntoIterator<Item = Field>) {
        self.push(row.line, fields, row.open_quote);
        if let Some(span) = self.spans.last_mut() {
            span.source = source;
        }
    }

    /// The fields of all rows, to be changed in place.
    pub(super) fn fields_mut(&mut self, row: usize) -> &mut [Field] {
        &mut self.fields[self.spans[row].fields.clone()]
    }

    /// Gives each row empty fields up to `width`.
    pub(super) fn fill_up(&mut self, width: usize) {
        let mut out = Rows::default();
        for row in self.spans.iter().map(|span| self.row(span)) {
            let more = width.saturating_sub(row.fields.len());
            let empty = std::iter::repeat_with(Field::empty).take(more);
            out.push_as(&row, row.source, row.fields.iter().cloned().chain(empty));
        }
        *self = out;
    }

    /// Leaves out the rows for whose number, 0 for the heading, `keep` does not hold.
    pub(super) fn retain(&mut self, keep: impl Fn(usize) -> bool) {
        let mut number = 0..;
        self.spans.retain(|_| number.next().is_some_and(&keep));
    }

    /// How many rows there are, the heading among them.
    pub(super) fn len(&self) -> usize {
        self.spans.len()
    }

    pub(super) fn is_empty(&self) -> bool {
        self.spans.is_empty()
    }

    /// The row with this number; 0 is the heading.
    pub(super) fn at(&self, number: usize) -> Row<'_> {
        self.row(&self.spans[number])
    }

    fn row(&self, span: &Span) -> Row<'_> {
        Row {
            source: span.source,
            line: span.line,
            fields: &self.fields[span.fields.clone()],
            open_quote: span.open_quote,
        }
    }

    /// The rows below the heading, which is the first.
    pub(super) fn below(&self) -> impl Iterator<Item = Row<'_>> {
        self.spans[1..].iter().map(|span| self.row(span))
    }

    /// Leaves empty fields at the ends of rows out, down to `keep` fields:
    /// spreadsheets pad rows.
    pub(super) fn drop_empty_ends(&mut self, keep: usize) {
        for span in &mut self.spans {
            let range = &mut span.fields;
            while range.len() > keep && self.fields[range.end - 1].text.is_empty() {
                range.end -= 1;
            }
        }
    }
}

/// Lines in words, which are in order: `5, 7 and 9 to 14`.
pub(super) fn in_words(lines: &[usize]) -> String {
    let mut runs: Vec<(usize, usize)> = Vec::new();
    for line in lines {
        match runs.last_mut() {
            Some((_, last)) if *last + 1 == *line => *last = *line,
            _ => runs.push((*line, *line)),
        }
    }
    let more = runs.len().saturating_sub(MOST_NAMED);
    let shown = runs.iter().take(MOST_NAMED).map(|(first, last)| match last - first {
        0 => first.to_string(),
        1 => format!("{first}, {last}"),
        _ => format!("{first} to {last}"),
    });
    let mut shown: Vec<String> = shown.collect();
    shown.extend((more > 0).then(|| format!("{more} more")));
    list(&shown)
}
