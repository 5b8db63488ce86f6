//! Workbooks: tables in archives, with what a spreadsheet or an enemy may put into them.

// The builder of workbooks is the library's tests' own; a third copy would drift.
#[path = "../../../crates/stiffarm/tests/it/common/workbook.rs"]
#[allow(dead_code, missing_docs, reason = "each user uses its own part")]
mod workbook;

use super::Verdict;
use super::readers::{bytes, cell_of_tables};
use crate::input::Input;
use crate::mutate::{Grammar, edge_number, mutate, mutate_bytes};
use crate::oracle::{error_is_sound, is_finite};
use crate::random::Random;
use crate::seeds::{self, Kind};
use stiffarm_files::table::{read_measurements, read_pairs, read_path, read_postures};
use workbook::{Cell, Entry, archive, cells, workbook_with};

/// Places of a cell in its sheet, within and beyond what a sheet may have.
const PLACES: [&str; 12] =
    ["A1", "B2", "XFD1", "XFE1", "ZZZZZZ1", "A1048576", "A1048577", "A99999999999", "A0", "1A", "", "AA:3"];

/// A workbook of mutated cells, with odd cells, sheets and rows.
pub fn make(random: &mut Random) -> Input {
    let kinds = [Kind::Postures, Kind::Displacements, Kind::Readings, Kind::Pairs, Kind::Path];
    let texts = seeds::of(*random.pick(&kinds));
    let seed = random.pick(&texts).as_bytes();
    let changed = mutate(seed, Grammar::Table, random);
    let text = String::from_utf8_lossy(&changed);
    let mut rows = cells(&text);
    for _ in 0..random.below(4) {
        let Some(row) = random.place(&rows) else {
            break;
        };
        let Some(column) = random.place(&rows[row]) else {
            continue;
        };
        let number = edge_number(None, random).parse().unwrap_or(f64::MAX);
        rows[row][column] =
            [Cell::Empty, Cell::Date, Cell::Duration, Cell::True, Cell::Fault, Cell::Number(number), Cell::Text("x")]
                [random.below(7)];
    }
    let mut more = String::new();
    if random.one_in(3) {
        let place = random.pick(&PLACES);
        let value = edge_number(None, random);
        more = format!("<row r=\"{}\"><c r=\"{place}\"><v>{value}</v></c></row>", edge_number(None, random));
    }
    let mut sheets = vec![("Sheet1", rows)];
    if random.one_in(6) {
        sheets.push(("Notes", cells("a,b\n1,2")));
        if random.one_in(2) {
            sheets.swap(0, 1);
        }
    }
    Input::File(workbook_with(&sheets, &more))
}

/// A workbook as a spreadsheet packs it.
const PACKED: &[u8] = include_bytes!("../../../crates/stiffarm/tests/golden/xlsx/readings.xlsx");

/// A workbook with other bytes: in its archive, or in the parts with their sums right.
pub fn make_bytes(random: &mut Random) -> Input {
    if random.one_in(4) {
        return Input::File(mutate_bytes(PACKED, random));
    }
    let texts = seeds::of(*random.pick(&[Kind::Postures, Kind::Pairs]));
    let sound = workbook_with(&[("Sheet1", cells(texts[random.below(texts.len())]))], "");
    if random.one_in(2) {
        return Input::File(mutate_bytes(&sound, random));
    }
    let mut parts = parts(&sound);
    let at = random.below(parts.len());
    let (_, content) = &mut parts[at];
    *content = if random.one_in(2) { mutate_bytes(content, random) } else { mutate(content, Grammar::Table, random) };
    let size = |content: &[u8], random: &mut Random| {
        if random.one_in(8) { random.next() as u32 } else { content.len() as u32 }
    };
    let entries: Vec<Entry> = parts
        .into_iter()
        .map(|(name, content)| Entry {
            name,
            size: size(&content, random),
            packed: content,
            method: if random.one_in(40) { 8 } else { 0 },
        })
        .collect();
    Input::File(archive(&entries))
}

/// Names and contents of an archive of stored files.
fn parts(archive: &[u8]) -> Vec<(String, Vec<u8>)> {
    let word = |at: usize, length: usize| {
        let bytes = archive.get(at..at + length).unwrap_or_default();
        bytes.iter().rev().fold(0usize, |n, b| n << 8 | usize::from(*b))
    };
    let mut files = Vec::new();
    let mut at = 0;
    while archive.get(at..at + 4) == Some(b"PK\x03\x04") {
        let (packed, name) = (word(at + 18, 4), word(at + 26, 2));
        let start = at + 30 + name + word(at + 28, 2);
        let text = String::from_utf8_lossy(&archive[at + 30..at + 30 + name]);
        files.push((text.into_owned(), archive[start..start + packed].to_vec()));
        at = start + packed;
    }
    files
}

/// Every reader of tables takes it or says why not.
pub fn check(input: &Input) -> Verdict {
    let (bytes, cell) = (bytes(input), cell_of_tables());
    let mut accepted = false;
    let mut judge = |read: Result<(), (stiffarm::Error, ())>| match read {
        Ok(()) => {
            accepted = true;
            Ok(())
        }
        Err((error, ())) => error_is_sound(&error),
    };
    let postures = read_postures(bytes, "input.xlsx", &cell.setup.robot);
    let measurements = read_measurements(bytes, "input.xlsx", cell, None);
    let pairs = read_pairs(bytes, "input.xlsx");
    let path = read_path(bytes, "input.xlsx", cell, None);
    is_finite(&(postures.as_ref().ok(), measurements.as_ref().ok(), pairs.as_ref().ok(), path.as_ref().ok()))?;
    judge(postures.map(drop).map_err(|e| (e, ())))?;
    judge(measurements.map(drop).map_err(|e| (e, ())))?;
    judge(pairs.map(drop).map_err(|e| (e, ())))?;
    judge(path.map(drop).map_err(|e| (e, ())))?;
    Ok(accepted)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_of_an_archive_are_found() {
        let sound = workbook_with(&[("a", cells("x,1"))], "");
        let parts = parts(&sound);
        assert_eq!(parts.len(), 6);
        assert!(parts[0].1.starts_with(b"<worksheet"));
    }
}
