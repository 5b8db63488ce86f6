//! Whether readings without names stand in the order of their sheet: one that was taken twice or
//! left out moves all that follow.

use crate::table::grid::{Column, Row, Table};
use crate::table::heading::{ColumnDefinition, stem};
use crate::table::quantity::Quantity;
use crate::table::rows::in_words;
use nalgebra::Vector3;
use std::collections::BTreeMap;
use stiffarm::error::{Code, Error, Result};

/// The columns that a sheet leaves to the readings.
pub(super) const POSITION: [&str; 3] = ["x", "y", "z"];

/// Readings of one point in one posture lie this near to each other \[m\].
const SAME_POINT_DISTANCE: f64 = 0.02;

/// Readings that must lie elsewhere before another order is looked for.
const MOST_STRAY: usize = 2;

/// Rows among which the one without a reading may be.
const MOST_NAMED: usize = 12;

/// Readings that may be compared in search of it.
const MOST_WORK: usize = 200_000_000;

/// Readings and the rows of the sheet that name them.
struct Order<'o> {
    table: &'o Table<'o>,
    sheet: &'o Table<'o>,
    readings: &'o [Row<'o>],
    rows: &'o [Row<'o>],
    positions: Vec<Vector3<f64>>,
    /// For each row of the sheet the number of its posture and point.
    groups: Vec<usize>,
}

/// Says which reading was taken twice, which is missing, and what lies between.
///
/// # Errors
/// The readings fit their rows only with one of them left out.
pub(super) fn check(
    table: &Table<'_>,
    sheet: &Table<'_>,
    readings: &[Row<'_>],
    rows: &[Row<'_>],
    growing: bool,
) -> Result<()> {
    // The rows that have come, and one reading more or less among them.
    let come = |more: usize| &rows[..(readings.len() + more).min(rows.len())];
    let Some(order) = Order::new(table, sheet, readings, if growing { come(0) } else { rows }) else {
        return Ok(());
    };
    if growing && readings.len() < rows.len() {
        return order.so_far(come(1));
    }
    match readings.len() as i64 - rows.len() as i64 {
        0 => order.shifted(),
        1 => order.twice(),
        -1 => order.missing(),
        _ => Ok(()),
    }
}

impl<'o> Order<'o> {
    /// `None` where a number cannot be read: that has an error of its own.
    fn new(table: &'o Table<'o>, sheet: &'o Table<'o>, readings: &'o [Row<'o>], rows: &'o [Row<'o>]) -> Option<Self> {
        let column = |axis: &str| -> Option<Column> {
            let definition = ColumnDefinition::of(axis, Quantity::Length, "position");
            let mut headings = table.headings.iter().enumerate();
            headings.find_map(|(at, heading)| definition.column(&heading.name, at).filter(|_| !heading.ignored))
        };
        let [x, y, z] = POSITION.map(column);
        let columns = [x?, y?, z?];
        let position = |row: &Row<'_>| -> Option<Vector3<f64>> {
            let [x, y, z] = columns.map(|column| table.number(row, column).ok());
            Some(Vector3::new(x?, y?, z?))
        };
        let mut numbers: BTreeMap<[&str; 2], usize> = BTreeMap::new();
        let name = |heading: &str| sheet.headings.iter().position(|h| !h.ignored && stem(&h.name) == heading);
        let names = [name("posture")?, name("point")?];
        let groups = rows.iter().map(|row| {
            let [posture, point] = names.map(|at| row.fields.get(at).map_or("", |f| f.text.as_str()));
            let next = numbers.len();
            *numbers.entry([posture, point]).or_insert(next)
        });
        Some(Order {
            groups: groups.collect(),
            positions: readings.iter().map(position).collect::<Option<_>>()?,
            table,
            sheet,
            readings,
            rows,
        })
    }

    /// How many readings lie apart from others of their point, with `twice` left out of the
    /// readings and `missing` out of the rows.
    fn stray(&self, twice: Option<usize>, missing: Option<usize>) -> usize {
        let readings = (0..self.positions.len()).filter(|i| Some(*i) != twice);
        let rows = (0..self.groups.len()).filter(|j| Some(*j) != missing);
        // The first reading of each group is as good as any: one that strays makes all others stray.
        let mut first: BTreeMap<usize, &Vector3<f64>> = BTreeMap::new();
        let pairs = readings.zip(rows);
        let apart = pairs.filter(|(i, j)| {
            let position = &self.positions[*i];
            let first = first.entry(self.groups[*j]).or_insert(position);
            (*first - position).norm() > SAME_POINT_DISTANCE
        });
        apart.count()
    }

    /// Readings that may be those of the reading before, taken twice.
    fn repeated(&self) -> Vec<usize> {
        let near = |i: &usize| (self.positions[*i] - self.positions[i - 1]).norm() < SAME_POINT_DISTANCE;
        (1..self.positions.len()).filter(near).collect()
    }

    fn line(&self, reading: usize) -> usize {
        self.readings[reading].line
    }

    /// The rows of the sheet of which one has no reading: its names, where there is one alone.
    fn rows(&self, rows: &[usize]) -> String {
        let lines: Vec<usize> = rows.iter().map(|row| self.rows[*row].line).collect();
        let sheet = self.sheet.files[0];
        let [row] = rows else {
            return format!("one of lines {} of {sheet}", in_words(&lines));
        };
        let names = ["posture", "state", "point"].map(|name| {
            let mut headings = self.sheet.headings.iter();
            let at = headings.position(|heading| heading.name == name);
            let field = at.and_then(|at| self.rows[*row].fields.get(at));
            field.map_or("", |field| field.text.as_str())
        });
        format!("{} (line {} of {sheet})", names.join(" ").trim(), lines[0])
    }

    fn error(&self, reading: usize, message: String) -> Error {
        let file = self.table.files[self.readings[reading].source];
        Error::new(Code::Conflict, message).file(file).line(self.line(reading), None)
    }

    /// As many readings as rows: one twice and another missing.
    fn shifted(&self) -> Result<()> {
        if self.stray(None, None) <= MOST_STRAY {
            return Ok(());
        }
        let repeated = self.repeated();
        let (count, work) = (self.rows.len(), repeated.len() * self.rows.len());
        if work.saturating_mul(count) > MOST_WORK {
            return Ok(());
        }
        let pairs = repeated.iter().flat_map(|i| (0..count).map(move |j| (*i, j)));
        let fitting = pairs.filter(|(i, j)| i != j && self.stray(Some(*i), Some(*j)) == 0);
        let fitting: Vec<(usize, usize)> = fitting.collect();
        // The least that explains it; what fits as well is said.
        let Some((twice, missing)) = fitting.iter().min_by_key(|(i, j)| i.abs_diff(*j)) else {
            return Ok(());
        };
        let (late, first, last) =
            if twice <= missing { ("late", *twice, *missing) } else { ("early", *missing, *twice) };
        let others = fitting.iter().filter(|(i, _)| i == twice).map(|(_, j)| *j);
        let message = format!(
            "The readings of lines {} to {} stand one row {late}: line {} is that of line {} once more, and {} has no \
             reading.",
            self.line(first),
            self.line(last),
            self.line(*twice),
            self.line(twice - 1),
            self.rows(&others.collect::<Vec<_>>())
        );
        let hint = format!(
            "delete line {} here, and the line without a reading in {}",
            self.line(*twice),
            self.sheet.files[0]
        );
        Err(self.error(first, message).hint(hint))
    }

    /// Readings that are still being taken; `rows` has one more than there are.
    fn so_far(self, rows: &'o [Row<'o>]) -> Result<()> {
        // Of a shift that has just begun two readings lie elsewhere, of a bad reading one.
        if self.stray(None, None) < MOST_STRAY {
            return Ok(());
        }
        let Order { table, sheet, readings, rows: come, .. } = self;
        let with = |rows| {
            Order::new(table, sheet, readings, rows)
                .map_or(Ok(()), |order| if rows.len() < readings.len() { order.twice() } else { order.missing() })
        };
        with(&come[..come.len().saturating_sub(1)])?;
        with(rows)
    }

    /// One reading more than rows.
    fn twice(&self) -> Result<()> {
        let repeated = self.repeated();
        let mut fitting = repeated.iter().filter(|i| self.stray(Some(**i), None) == 0);
        let (Some(twice), None) = (fitting.next(), fitting.next()) else {
            return Ok(());
        };
        let message = format!(
            "There is one reading too many for the rows of {}: line {} is that of line {} once more.",
            self.sheet.files[0],
            self.line(*twice),
            self.line(twice - 1)
        );
        Err(self.error(*twice, message).hint("delete this line"))
    }

    /// One row more than readings.
    fn missing(&self) -> Result<()> {
        let fitting = (0..self.rows.len()).filter(|j| self.stray(None, Some(*j)) == 0);
        let fitting: Vec<usize> = fitting.collect();
        let Some(missing) = fitting.first().filter(|_| fitting.len() <= MOST_NAMED) else {
            return Ok(());
        };
        let message = format!(
            "There is one reading too few for the rows of {}: {} has none.",
            self.sheet.files[0],
            self.rows(&fitting)
        );
        let at = (*missing).min(self.readings.len() - 1);
        Err(self.error(at, message).hint("delete that line of the sheet, or add the reading here"))
    }
}
