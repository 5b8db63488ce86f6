//! Workbooks are read like text, and those that would cost too much are refused before they are read.

use super::workbook::{Cell as Held, Entry, archive, cells, deflated_letters, workbook, workbook_of, workbook_with};
use super::*;
use crate::common::cases::slip;
use stiffarm::Code;

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
    assert_eq!(without_lines(read(&bytes, &cell)?), without_lines(readings(FULL, &cell)?));
    Ok(())
}

#[test]
fn a_cell_in_the_last_corner_costs_no_memory() {
    // Row 1048576, column XFD: as a rectangle these would be 1.7e10 cells.
    let cell = sensor_cell();
    let far = workbook_with(&[("Sheet1", cells(FULL))], "<row r=\"1048576\"><c r=\"XFD1048576\"><v>1</v></c></row>");
    let error = read(&far, &cell).unwrap_err();
    insta::assert_snapshot!(error, @r#"
    readings.xlsx:1048576:16384: "1" lies beyond the last column of the heading.
      hint: give its column a heading, or empty the cell
    "#);
}

#[test]
fn cells_far_away_are_refused_and_cost_no_memory() {
    let cell = sensor_cell();
    let with = |row: &str| {
        let rows = cells(FULL).split_off(1);
        read(&workbook_with(&[("Sheet1", vec![])], row), &cell).map(|_| rows.len())
    };
    // In the heading, where it makes the table as wide as the sheet; then letters and digits that no number holds.
    let mut report = String::new();
    for (first, place, code) in [
        ("<c r=\"A1\"><v>1</v></c>", "XFD1", Code::TableHeading),
        ("<c r=\"A1\"><v>1</v></c>", "ZZZZZZ1", Code::TableRow),
        ("", "ZZZZZZZZZZZZ1", Code::TableRow),
        ("", "A99999999999", Code::TableRow),
        ("", "A0", Code::FileRead),
        ("", "1A", Code::FileRead),
    ] {
        let error = with(&format!("<row r=\"1\">{first}<c r=\"{place}\"><v>1</v></c></row>")).expect_err(place);
        assert_eq!(error.code(), code, "{place}: {error}");
        // Of the others place and words are those of the library that unpacks them.
        if !first.is_empty() {
            report += &slip::<()>(place, Err(error));
        }
    }
    insta::assert_snapshot!(report, @r#"
    » XFD1
    [table-heading] readings.xlsx:1:16384: The heading is 16384 columns wide; a table has 512 at most.
      hint: a cell far to the right belongs to no table: empty it

    » ZZZZZZ1
    [table-row] readings.xlsx:1:321272406: A cell lies beyond the last row or column that a sheet can have.
      hint: save the sheet as .xlsx without a password, or as "CSV UTF-8"
    "#);
}

#[test]
fn what_unpacks_to_more_than_a_table_is_refused_before_it_is_read() {
    let cell = sensor_cell();
    let bomb = |size: u32| {
        archive(&[Entry {
            name: "xl/worksheets/sheet1.xml".to_string(),
            packed: deflated_letters((20 << 20) / 258),
            method: 8,
            size,
        }])
    };
    let mut report = String::new();
    for size in [20 << 20, u32::MAX - 1] {
        let bytes = bomb(size);
        assert!(bytes.len() < 30_000);
        report += &slip(&size.to_string(), read(&bytes, &cell));
    }
    insta::assert_snapshot!(report, @r#"
    » 20971520
    [unsupported] readings.xlsx: The file has 21 kB and unpacks to more than 17 MB, which no table does.
      hint: save the sheet as "CSV UTF-8"

    » 4294967294
    [unsupported] readings.xlsx: The file has 21 kB and unpacks to more than 17 MB, which no table does.
      hint: save the sheet as "CSV UTF-8"
    "#);
    // One that says less is read no further than it says.
    assert!(read(&bomb(1), &cell).is_err());
}

#[test]
fn shared_texts_are_not_believed_by_their_number() {
    let cell = sensor_cell();
    let text = "<sst uniqueCount = '99999999999'><si><t>x</t></si></sst>";
    let wide: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let mut report = String::new();
    for (packed, what) in [(text.as_bytes().to_vec(), "UTF-8"), (wide, "UTF-16")] {
        let bytes = archive(&[Entry {
            name: "xl/sharedStrings.xml".to_string(),
            size: packed.len() as u32,
            packed,
            method: 0,
        }]);
        report += &slip(what, read(&bytes, &cell));
    }
    insta::assert_snapshot!(report, @r#"
    » UTF-8
    [file-read] readings.xlsx: The workbook says that it holds more texts than it can.
      hint: save the sheet as .xlsx without a password, or as "CSV UTF-8"

    » UTF-16
    [file-read] readings.xlsx: The workbook says that it holds more texts than it can.
      hint: save the sheet as .xlsx without a password, or as "CSV UTF-8"
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
    note("a remark beside the table", &with(4, 16, Held::Text("door open")));
    note("an unknown column", &with(0, 12, Held::Text("Timestamp")));
    note("empty", &[("Sheet1", Vec::new())]);
    note("empty, and data in another", &[("Cover", Vec::new()), ("Data", cells(FULL))]);
    let cover = || vec![vec![Held::Text("Stiffness"), Held::Text("2026")]];
    note("a cover sheet", &[("Cover", cover()), ("Data", cells(FULL))]);
    note("a cover sheet alone", &[("Cover", cover())]);
    insta::assert_snapshot!("workbook_slips", report);
}

#[test]
fn dates_count_from_the_year_that_the_workbook_says() {
    let mut sheet = cells(FULL);
    sheet[4][0] = Held::Date;
    let from_1904 = "<workbookPr date1904=\"1\"/>";
    let mut report = String::new();
    for (what, properties) in [("from 1900", ""), ("from 1904", from_1904)] {
        let bytes = workbook_of(properties, &[("Sheet1", sheet.clone())], "");
        report += &slip(what, read(&bytes, &sensor_cell()));
    }
    insta::assert_snapshot!(report, @"
    » from 1900
    [table-row] readings.xlsx:5:1: posture: The cell holds the time 2025-12-09 00:00:00.000; it must be text.
      hint: format the column as text, and enter the value again

    » from 1904
    [table-row] readings.xlsx:5:1: posture: The cell holds the time 2029-12-10 00:00:00.000; it must be text.
      hint: format the column as text, and enter the value again
    ");
}

#[test]
fn merged_cells_hold_for_each_of_their_rows() -> Check {
    let cell = rope_cell();
    // As people fill in a sheet: posture, state, force and angles stand once.
    let merged = "Readings of Monday\nposture,state,point,x_mm,y_mm,z_mm,load_n,q1_deg,q2_deg\n\
        1,unloaded,left,1500.125,-200.5,900.25,,12.5,-30\n,,right,1350.0625,-50.25,900.5,,,\n\
        ,up-250,left,1500.25,-200.75,899.5,250,,\n,,right,1350.1875,-50.5,899.75,,,\n";
    let whole = "posture,state,point,x_mm,y_mm,z_mm,load_n,q1_deg,q2_deg\n\
        1,unloaded,left,1500.125,-200.5,900.25,,12.5,-30\n1,unloaded,right,1350.0625,-50.25,900.5,,12.5,-30\n\
        1,up-250,left,1500.25,-200.75,899.5,250,12.5,-30\n1,up-250,right,1350.1875,-50.5,899.75,250,12.5,-30\n";
    let regions = ["A1:I1", "A3:A6", "B3:B4", "B5:B6", "G5:G6", "H3:H6", "I3:I6", "A9:A1048576"];
    let regions: String = regions.iter().map(|r| format!("<mergeCell ref=\"{r}\"/>")).collect();
    let more = format!("</sheetData><mergeCells count=\"8\">{regions}</mergeCells><sheetData>");
    let mut table = read(&workbook_with(&[("Sheet1", cells(merged))], &more), &cell)?;
    let said = table.remarks.remove(0);
    assert_eq!(said.code, stiffarm::findings::codes::MERGED_CELLS);
    insta::assert_snapshot!(said.sentence, @"Cells are merged in posture, state, load_n, q1_deg and q2_deg: each of their rows has the value of the first.");
    assert_eq!(without_lines(table), without_lines(readings(whole, &cell)?));
    // Where they are not merged, what stands in the first rows alone is carried down; one that was
    // forgotten is not.
    let mut table = read(&workbook(&[("Sheet1", cells(merged))]), &cell)?;
    let said = table.remarks.remove(0);
    assert_eq!(said.code, stiffarm::findings::codes::CARRIED_DOWN);
    assert_eq!(without_lines(table), without_lines(readings(whole, &cell)?));
    let forgotten = merged.replace(",,right,1350.0625", ",unloaded,right,1350.0625");
    insta::assert_snapshot!(read(&workbook(&[("Sheet1", cells(&forgotten))]), &cell).unwrap_err(), @"readings.xlsx:6:2: state: The field is empty.");
    Ok(())
}

#[test]
fn a_formula_that_nobody_calculated_has_no_value() -> Check {
    let cell = rope_cell();
    let filled = "posture,state,point,x_mm,y_mm,z_mm,load_n,q1_deg,q2_deg\n\
        1,unloaded,left,1500.125,-200.5,900.25,0,12.5,-30\n1,up-500,left,1500.25,-200.75,899.5,250,12.5,-30\n";
    // Programs that do not calculate ask for it when the workbook is opened.
    let asks = "<calcPr calcId=\"124519\" fullCalcOnLoad=\"1\"/>";
    let with = |properties: &str, (row, column): (usize, usize), value: &'static str| {
        let mut sheet = cells(filled);
        sheet[row][column] = Held::Formula(value);
        read(&workbook_of(properties, &[("Monday", sheet)], ""), &cell)
    };
    let mut report = String::new();
    for (properties, place, value) in [
        // openpyxl, pandas: no value. The load of the state's name is not meant.
        (asks, (2, 6), ""),
        ("", (2, 6), ""),
        // XlsxWriter, libxlsxwriter: 0.
        (asks, (2, 6), "0"),
        (asks, (2, 4), "0"),
        ("", (2, 0), ""),
    ] {
        let error = with(properties, place, value).unwrap_err();
        report += &format!("[{}] {error}\n", error.code().as_str());
    }
    insta::assert_snapshot!("formulas_without_values", report);
    // What was calculated counts, a zero, too.
    let table = with(asks, (2, 6), "250")?;
    assert_eq!(table.postures[0].states[1].load, Some(250.0));
    let table = with("<calcPr calcId=\"191029\"/>", (1, 6), "0")?;
    assert_eq!(table.postures[0].states[0].load, Some(0.0));
    Ok(())
}

#[test]
fn hidden_rows_and_columns_are_said() -> Check {
    let cell = rope_cell();
    let mut sheet = cells(AS_TEXT);
    let rows = sheet.split_off(1);
    let row = |number: usize, hidden: &str| {
        let fields = rows[number].iter().enumerate().map(|(column, held)| {
            let place = super::workbook::place(number + 1, column);
            match held {
                Held::Text(text) => {
                    format!("<c r=\"{place}\" t=\"inlineStr\"><is><t>{text}</t></is></c>")
                }
                Held::Number(value) => format!("<c r=\"{place}\"><v>{value}</v></c>"),
                _ => String::new(),
            }
        });
        let fields: String = fields.collect();
        format!("<row r=\"{}\"{hidden}>{fields}</row>", number + 2)
    };
    let said = |hidden: &[usize], columns: &str| -> stiffarm::Result<Vec<(String, String)>> {
        let rows =
            (0..7).map(|number| row(number, if hidden.contains(&number) { " ht=\"15\" hidden=\"1\"" } else { "" }));
        let more: String = rows.collect();
        let more = more + "</sheetData>" + columns + "<sheetData>";
        let table = read(&workbook_with(&[("Monday", sheet.clone())], &more), &cell)?;
        let remarks = table.remarks.iter();
        Ok(remarks.map(|r| (format!("{:?}", r.severity), r.sentence.clone())).collect())
    };
    assert_eq!(said(&[], "")?, []);
    insta::assert_snapshot!(format!("{:#?}", said(&[2, 3, 5], "")?), @r#"
    [
        (
            "Caution",
            "The sheet \"Monday\" of readings.xlsx has 3 hidden rows (4, 5 and 7), which count like all others. Take the filter off and delete what is not to count.",
        ),
    ]
    "#);
    // Columns are mostly hidden for want of room.
    let columns = "<cols><col min=\"8\" max=\"12\" hidden=\"true\"/></cols>";
    insta::assert_snapshot!(format!("{:#?}", said(&[], columns)?), @r#"
    [
        (
            "Note",
            "The sheet \"Monday\" of readings.xlsx has 2 hidden columns (q1_deg and q2_deg), which count like all others. Take the filter off and delete what is not to count.",
        ),
    ]
    "#);
    Ok(())
}
