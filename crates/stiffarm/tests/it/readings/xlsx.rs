//! Workbooks.
#![cfg(feature = "xlsx")]

use super::workbook::{Cell as Held, cells, workbook, workbook_with};
use super::*;

const GOLDEN: &[u8] = include_bytes!("../../golden/xlsx/readings.xlsx");

/// The rows of the golden workbook as text.
const AS_TEXT: &str = "posture,state,point,x_mm,y_mm,z_mm,load_n,q1_deg,q2_deg\n\
    1,unloaded,left,1500.125,-200.5,900.25,,12.5,-30\n1,unloaded,right,1350.0625,-50.25,900.5,,12.5,-30\n\
    1,up-250,left,1500.25,-200.75,899.5,250,12.5,-30\n1,up-250,right,1350.1875,-50.5,899.75,250,12.5,-30\n\
    1,up-500,left,1500.375,-201,898.75,500,12.5,-30\n1,up-500,left,1500.3750001,-201,898.75,500,12.5,-30\n\
    1,up-500,base,0.5,0.25,0.125,500,12.5,-30\n";

const MAPPING: &str = "[columns]\npoint = 'Name'\nx_mm = 'Center X'\ny_mm = 'Center Y'\nz_mm = 'Center Z'\n\
                       ignore = ['Timestamp']\n";

fn read(bytes: &[u8], cell: &Cell) -> stiffarm::Result<ReadingTable> {
    read_readings(bytes, "readings.xlsx", cell, None)
}

#[test]
fn a_workbook_holds_what_its_text_holds() -> Check {
    let cell = cell_with(ROPE, MAPPING);
    let table = read(GOLDEN, &cell)?;
    let wanted = readings(AS_TEXT, &cell)?;
    // The heading is in row 3 below a comment: the rows begin in row 4.
    assert_eq!(table.postures[0].states[0].readings[0].line, 4);
    assert_eq!(without_lines(table), without_lines(wanted));
    Ok(())
}

#[test]
fn every_table_of_text_can_be_a_workbook() -> Check {
    let cell = sensor_cell();
    let bytes = workbook(&[("Sheet1", cells(FULL))]);
    assert_eq!(read(&bytes, &cell)?, readings(FULL, &cell)?);
    let robot = &cell.setup.robot;
    let bytes = workbook(&[("Sheet1", cells(POSTURES))]);
    assert_eq!(read_postures(&bytes, "p.xlsx", robot)?, postures());
    // The table may begin anywhere; gaps between rows do not matter.
    let moved: String = FULL.lines().map(|line| format!(",,{line}\n,\n")).collect();
    let bytes = workbook(&[("Sheet1", cells(&format!(",\n,\n{moved}")))]);
    assert_eq!(
        without_lines(read(&bytes, &cell)?),
        without_lines(readings(FULL, &cell)?)
    );
    Ok(())
}

#[test]
fn a_cell_in_the_last_corner_costs_no_memory() {
    // Row 1048576, column XFD: as a rectangle these would be 1.7e10 cells.
    let cell = sensor_cell();
    let far = workbook_with(
        &[("Sheet1", cells(FULL))],
        "<row r=\"1048576\"><c r=\"XFD1048576\"><v>1</v></c></row>",
    );
    let error = read(&far, &cell).unwrap_err();
    insta::assert_snapshot!(error, @r#"
    readings.xlsx:1048576:16384: "1" lies beyond the last column of the heading.
      hint: give its column a heading, or empty the cell
    "#);
}

#[test]
fn slips_in_a_workbook() {
    let cell = sensor_cell();
    let mut report = String::new();
    let mut note = |what: &str, sheets: &[(&str, Vec<Vec<Held<'_>>>)]| {
        let error = read(&workbook(sheets), &cell).unwrap_err();
        report += &format!("» {what}\n[{}] {error}\n\n", error.code().as_str());
    };
    let with = |row: usize, column: usize, held: Held<'static>| {
        let mut sheet = cells(FULL);
        let width = sheet[row].len().max(column + 1);
        sheet[row].resize(width, Held::Empty);
        sheet[row][column] = held;
        vec![("Sheet1", sheet)]
    };
    note("a date for a time", &with(4, 12, Held::Date));
    note("a duration for a time", &with(4, 12, Held::Duration));
    note("a date for a posture", &with(4, 0, Held::Date));
    note("true or false", &with(4, 3, Held::True));
    note("an error of a formula", &with(4, 4, Held::Fault));
    note("a heading that is a date", &with(0, 4, Held::Date));
    note("a number as text", &with(4, 3, Held::Text("1500,25")));
    note("a text", &with(4, 3, Held::Text("1500 mm")));
    note("an empty cell", &with(4, 3, Held::Empty));
    note(
        "a remark beside the table",
        &with(4, 16, Held::Text("door open")),
    );
    note("an unknown column", &with(0, 12, Held::Text("Timestamp")));
    note("empty", &[("Sheet1", Vec::new())]);
    note(
        "empty, and data in another",
        &[("Cover", Vec::new()), ("Data", cells(FULL))],
    );
    let cover = || vec![vec![Held::Text("Stiffness"), Held::Text("2026")]];
    note(
        "a cover sheet",
        &[("Cover", cover()), ("Data", cells(FULL))],
    );
    note("a cover sheet alone", &[("Cover", cover())]);
    insta::assert_snapshot!("workbook_slips", report);
}
