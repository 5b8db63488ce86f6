//! What a workbook says beside its cells: whether its formulas wait to be calculated, and which
//! rows and columns of a sheet are hidden. The reader of cells tells neither.

use roxmltree::Document;
use std::collections::BTreeSet;
use std::io::{BufRead, BufReader, Cursor, Read};
use zip::ZipArchive;

/// Where the list of sheets stands, and what says in which parts they are.
const WORKBOOK: &str = "xl/workbook.xml";
const RELATIONS: &str = "xl/_rels/workbook.xml.rels";

/// Hidden rows and columns of a sheet, from 0.
#[derive(Debug, Default)]
pub(super) struct Hidden {
    pub(super) rows: BTreeSet<u32>,
    columns: Vec<(u32, u32)>,
}

impl Hidden {
    /// True for a hidden column, from 0.
    pub(super) fn has_column(&self, column: u32) -> bool {
        let mut columns = self.columns.iter();
        columns.any(|(first, last)| (*first..=*last).contains(&column))
    }
}

/// Texts of an archive; what is not there or no text says nothing.
fn text(bytes: &[u8], name: &str) -> Option<String> {
    let mut archive = ZipArchive::new(Cursor::new(bytes)).ok()?;
    let mut text = String::new();
    let mut part = archive.by_name(name).ok()?;
    part.read_to_string(&mut text).ok()?;
    Some(text)
}

/// True where the workbook asks to be calculated as soon as it is opened: a program wrote its
/// formulas that cannot calculate, with 0 for every value or with none.
pub(super) fn waits_to_be_calculated(bytes: &[u8]) -> bool {
    let Some(text) = text(bytes, WORKBOOK) else {
        return false;
    };
    let Ok(workbook) = Document::parse(&text) else {
        return false;
    };
    let mut nodes = workbook.descendants();
    let asks = nodes.find_map(|node| node.attribute("fullCalcOnLoad"));
    asks.is_some_and(is_true)
}

fn is_true(value: &str) -> bool {
    ["1", "true"].contains(&value)
}

/// The part that holds the sheet of this name.
fn part(bytes: &[u8], sheet: &str) -> Option<String> {
    let (workbook, relations) = (text(bytes, WORKBOOK)?, text(bytes, RELATIONS)?);
    let workbook = Document::parse(&workbook).ok()?;
    let mut sheets = workbook.descendants();
    let sheet_node = sheets.find(|node| node.attribute("name") == Some(sheet))?;
    // Its namespace is another one in strict files.
    let mut ids = sheet_node.attributes().filter(|attribute| attribute.name() == "id");
    let id = ids.next()?.value();
    let relations = Document::parse(&relations).ok()?;
    let mut all = relations.descendants();
    let target = all.find(|node| node.attribute("Id") == Some(id))?;
    let target = target.attribute("Target")?;
    Some(match target.strip_prefix('/') {
        Some(whole) => whole.to_string(),
        None => format!("xl/{target}"),
    })
}

/// What of a sheet is hidden: by a filter, by hand, by an outline that is folded.
pub(super) fn hidden(bytes: &[u8], sheet: &str) -> Hidden {
    let mut hidden = Hidden::default();
    let Ok(mut archive) = ZipArchive::new(Cursor::new(bytes)) else {
        return hidden;
    };
    let part = part(bytes, sheet).and_then(|name| archive.by_name(&name).ok());
    let Some(part) = part else {
        return hidden;
    };
    // Tag by tag: a sheet of a million rows is no document to hold at once.
    let mut reader = BufReader::new(part);
    let mut piece = Vec::new();
    let mut row = 0;
    while let Ok(1..) = reader.read_until(b'>', &mut piece) {
        let start = piece.iter().rposition(|byte| *byte == b'<');
        let tag = start.and_then(|start| std::str::from_utf8(&piece[start + 1..]).ok());
        if let Some(tag) = tag {
            let (name, rest) = tag.split_once(char::is_whitespace).unwrap_or((tag, ""));
            let name = name.rsplit(':').next().unwrap_or(name);
            let number = |key: &str| attribute(rest, key)?.parse::<u32>().ok();
            let is_hidden = || attribute(rest, "hidden").is_some_and(is_true);
            match name.trim_end_matches(['>', '/']) {
                "row" => {
                    row = number("r").unwrap_or(row + 1);
                    if is_hidden() {
                        hidden.rows.insert(row.saturating_sub(1));
                    }
                }
                "col" if is_hidden() => {
                    let span = (number("min").unwrap_or(1), number("max").unwrap_or(1));
                    hidden.columns.push((span.0.saturating_sub(1), span.1.saturating_sub(1)));
                }
                _ => {}
            }
        }
        piece.clear();
    }
    hidden
}

/// The value of an attribute in what stands behind a tag's name.
fn attribute<'t>(tag: &'t str, key: &str) -> Option<&'t str> {
    let mut rest = tag;
    loop {
        let (name, behind) = rest.split_once('=')?;
        let behind = behind.trim_start();
        let quote = behind.chars().next().filter(|c| ['"', '\''].contains(c))?;
        let (value, after) = behind[1..].split_once(quote)?;
        if name.trim() == key {
            return Some(value);
        }
        rest = after;
    }
}
