//! One table, for a CSV file and for the page.

use super::markdown::cell;

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

    /// Four significant digits, `–` for none.
    fn rounded(&self) -> String {
        match self {
            Cell::Text(text) => text.clone(),
            Cell::Number(value) => significant(*value),
        }
    }

    /// Every digit, empty for none.
    fn exact(&self) -> String {
        match self {
            Cell::Text(text) => text.clone(),
            Cell::Number(Some(value)) if value.is_finite() => value.to_string(),
            Cell::Number(_) => String::new(),
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
        Table {
            id: id.into(),
            caption: caption.into(),
            headings,
            rows: Vec::new(),
        }
    }

    /// The table as CSV, LF line ends, cells quoted where needed.
    pub fn csv(&self) -> String {
        let line = |cells: &[String]| {
            let quoted: Vec<String> = cells
                .iter()
                .map(|c| match c.contains([',', ';', '"', '\n', '\r', '\t']) {
                    true => format!("\"{}\"", c.replace('"', "\"\"")),
                    false => c.clone(),
                })
                .collect();
            quoted.join(",") + "\n"
        };
        let mut out = line(&self.headings);
        for row in &self.rows {
            out.push_str(&line(&row.iter().map(Cell::exact).collect::<Vec<_>>()));
        }
        out
    }

    /// The table as Markdown.
    pub fn markdown(&self) -> String {
        let line = |cells: &[String]| {
            let cells: Vec<String> = cells.iter().map(|text| cell(text)).collect();
            format!("| {} |\n", cells.join(" | "))
        };
        let mut out = line(&self.headings);
        out.push('|');
        for (i, _) in self.headings.iter().enumerate() {
            out.push_str(if i == 0 { ":--|" } else { "--:|" });
        }
        out.push('\n');
        for row in &self.rows {
            out.push_str(&line(&row.iter().map(Cell::rounded).collect::<Vec<_>>()));
        }
        out
    }
}

/// Number with four significant digits, `–` where there is none.
pub(super) fn significant(value: Option<f64>) -> String {
    let Some(v) = value.filter(|v| v.is_finite()) else {
        return "–".into();
    };
    if v == 0.0 {
        return "0".into();
    }
    let magnitude = v.abs().log10().floor() as i32;
    match magnitude {
        -4..4 => format!("{v:.decimals$}", decimals = (3 - magnitude) as usize),
        4..9 => {
            let unit = 10f64.powi(magnitude - 3);
            format!("{:.0}", (v / unit).round() * unit)
        }
        _ => format!("{v:.3e}"),
    }
}

pub(super) fn percent(value: Option<f64>) -> String {
    significant(value.map(|v| 100.0 * v))
}
