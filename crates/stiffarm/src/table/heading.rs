//! Checks of a table's heading: every column known, none twice, none missing.

use super::text::Table;
use crate::error::{Code, Error, Result, did_you_mean};

/// A column that a table may have.
pub(super) struct Known {
    /// Name with unit suffix.
    pub(super) name: String,
    /// What the suffix says, for hints; empty where there is none.
    unit: &'static str,
}

impl Known {
    pub(super) fn new(name: impl Into<String>, unit: &'static str) -> Self {
        Known {
            name: name.into(),
            unit,
        }
    }

    /// `q1_deg` to `qn_deg`.
    pub(super) fn angles(joints: usize) -> impl Iterator<Item = Known> {
        (1..=joints).map(|j| Known::new(format!("q{j}_deg"), "angles are in degrees"))
    }
}

impl Table<'_> {
    /// Checks that each column is known and stands once.
    pub(super) fn check_heading(&self, known: &[Known], joints: usize) -> Result<()> {
        let numeric = |text: &str| text.parse::<f64>().is_ok();
        let (first, rest) = (self.columns.first(), self.columns.get(1..).unwrap_or(&[]));
        if first.is_some() && !rest.is_empty() && rest.iter().all(|column| numeric(&column.text)) {
            let names: Vec<&str> = known.iter().map(|k| k.name.as_str()).collect();
            return Err(self
                .heading_error(
                    None,
                    Code::TableHeading,
                    "The first line holds numbers; it must name the columns.",
                )
                .hint(format!("columns: {}", names.join(","))));
        }
        for (c, column) in self.columns.iter().enumerate() {
            if column.text.is_empty() {
                let message = "A column has no name.";
                return Err(self.heading_error(Some(c), Code::TableHeading, message));
            }
            if !known.iter().any(|k| k.name == column.text) {
                return Err(self.unknown_column(c, known, joints));
            }
            if self.columns[..c]
                .iter()
                .any(|other| other.text == column.text)
            {
                let message = "The column stands twice.";
                return Err(self.heading_error(Some(c), Code::TableHeading, message));
            }
        }
        Ok(())
    }

    /// Position of a column that must be there.
    pub(super) fn require(&self, name: &str, hint: &str) -> Result<usize> {
        self.find(name).ok_or_else(|| {
            let message = format!("The column {name} is missing.");
            self.heading_error(None, Code::TableHeading, message)
                .hint(hint)
        })
    }

    /// Positions of columns that are there together or not at all.
    pub(super) fn all_or_none(&self, names: &[String], hint: &str) -> Result<Option<Vec<usize>>> {
        if names.iter().all(|name| self.find(name).is_none()) {
            return Ok(None);
        }
        let positions: Result<Vec<usize>> =
            names.iter().map(|name| self.require(name, hint)).collect();
        positions.map(Some)
    }

    fn unknown_column(&self, column: usize, known: &[Known], joints: usize) -> Error {
        let name = self.columns[column].text.as_str();
        let error = self.heading_error(
            Some(column),
            Code::TableHeading,
            "The table has no column of this name.",
        );
        if self.columns.len() == 1 {
            return error.hint("separate the columns with commas, semicolons or tabs");
        }
        if let Some((joint, unit)) = joint_number(name) {
            return error.hint(if (1..=joints).contains(&joint) {
                let rename = rename(unit, &format!("q{joint}_deg"));
                format!("angles are in degrees: {rename}")
            } else {
                format!("the robot has {joints} joints")
            });
        }
        if let Some(same) = known.iter().find(|k| stem(&k.name) == stem(name)) {
            let rename = rename(&name[stem(name).len()..], &same.name);
            return error.hint(if same.unit.is_empty() {
                rename
            } else {
                format!("{}: {rename}", same.unit)
            });
        }
        let names: Vec<&str> = known.iter().map(|k| k.name.as_str()).collect();
        let nearest = did_you_mean(name, names.iter().copied());
        error.hint(nearest.unwrap_or_else(|| format!("known columns: {}", names.join(", "))))
    }
}

/// The quantity of a column's name, without its unit.
pub(super) fn stem(name: &str) -> &str {
    name.split(|c: char| !c.is_alphanumeric())
        .next()
        .unwrap_or(name)
}

/// What to do with a column whose unit is written as `unit` and should be that
/// at the end of `wanted`.
fn rename(unit: &str, wanted: &str) -> String {
    let letters = |text: &str| {
        text.chars()
            .filter(|c| c.is_alphanumeric())
            .collect::<String>()
    };
    let unit = letters(unit);
    if unit.is_empty() || unit == letters(&wanted[stem(wanted).len()..]) {
        format!("name the column {wanted}")
    } else {
        format!("convert the values, and name the column {wanted}")
    }
}

/// k and the unit of `q3`, `q3_rad`, `joint 3`, `theta3`, `a3`, `axis_3`, …
fn joint_number(name: &str) -> Option<(usize, &str)> {
    let letters = name.split(|c: char| !c.is_alphabetic()).next()?;
    if !["q", "j", "a", "joint", "axis", "theta", "angle"].contains(&letters) {
        return None;
    }
    let rest = name[letters.len()..].trim_start_matches(|c: char| !c.is_alphanumeric());
    let end = rest
        .find(|c: char| !c.is_ascii_digit())
        .unwrap_or(rest.len());
    Some((rest[..end].parse().ok()?, &rest[end..]))
}
