//! A sheet as a workbook: headings with units, fields to fill in, drop-downs, and a page to print.

use super::Sheet;
use super::page::{self, PAPER_A4};
use rust_xlsxwriter::{
    Color, DataValidation, DataValidationErrorStyle, DataValidationRule, DocProperties, ExcelDateTime, Format,
    FormatAlign, FormatBorder, Formula, ProtectionOptions, Workbook, Worksheet, XlsxError,
};
use stiffarm::error::{Code, Error, Result};
use stiffarm::model::cell::Cell;
use stiffarm::units::rad_to_shortest_deg;

/// Rows below the last one that take readings, too: repeats, further postures.
const MORE_ROWS: u32 = 1000;

/// Columns of names: posture, state, point.
const NAMES: u16 = 3;

/// The heading of stations, which stands further right, and the column of their names among the choices.
const STATION: &str = "station";
const STATIONS: u16 = NAMES;

/// Rows of a worksheet, by the format.
const MOST_ROWS: usize = 1_048_576 - MORE_ROWS as usize - 1;

/// Fields to fill in.
const TO_FILL: Color = Color::RGB(0x00FF_F7D6);
const HEADING: Color = Color::RGB(0x00E3_E8EE);
const LINES: Color = Color::RGB(0x00BF_BFBF);

/// Name of the worksheet with the choices of the drop-downs.
const CHOICES: &str = "Names";

/// The sheet as the bytes of an .xlsx workbook.
///
/// Its first worksheet is the table that
/// [`read_measurements`](crate::table::read_measurements) reads: the heading stays in
/// view, fields to fill in are shaded and open, planned names are protected (without a
/// password), posture, state and point are chosen from lists in the rows below, and only
/// numbers go into columns of numbers. The second, `Print`, is a plan to tick off on A4 paper.
///
/// The same sheet gives the same bytes.
///
/// # Errors
/// More rows than a worksheet has.
pub fn write_sheet_workbook(sheet: &Sheet, cell: &Cell) -> Result<Vec<u8>> {
    if sheet.rows.len() > MOST_ROWS {
        let message = format!("The sheet has {} rows; .xlsx has {MOST_ROWS}.", sheet.rows.len());
        let error = Error::new(Code::Unsupported, message);
        return Err(error.hint("write it as .csv, or plan fewer postures"));
    }
    // What the format refuses beyond that, no sheet has: the writer's own words are the best there are.
    build(sheet, cell).map_err(|error| {
        let message = format!("The workbook cannot be written: {error}.");
        Error::new(Code::Unsupported, message).hint("write the sheet as .csv")
    })
}

fn build(sheet: &Sheet, cell: &Cell) -> std::result::Result<Vec<u8>, XlsxError> {
    let mut workbook = Workbook::new();
    // A fixed date: the format has no place for none.
    let date = ExcelDateTime::from_ymd(2000, 1, 1)?;
    workbook.set_properties(&DocProperties::new().set_creation_datetime(&date));
    table(workbook.add_worksheet().set_name("Readings")?, sheet)?;
    page::print(workbook.add_worksheet().set_name("Print")?, sheet, cell)?;
    choices(workbook.add_worksheet().set_name(CHOICES)?, sheet)?;
    workbook.save_to_buffer()
}

/// The first worksheet.
fn table(worksheet: &mut Worksheet, sheet: &Sheet) -> std::result::Result<(), XlsxError> {
    let boxed = || {
        let format = Format::new().set_border(FormatBorder::Thin);
        format.set_border_color(LINES)
    };
    let heading = boxed().set_bold().set_background_color(HEADING);
    let heading = heading.set_align(FormatAlign::Center);
    let (name, open) = (boxed(), Format::new().set_unlocked());
    let last = sheet.rows.len() as u32 + MORE_ROWS;
    for (at, text) in (0..).zip(&sheet.headings) {
        worksheet.set_column_format(at, &number_format(open.clone(), text))?;
        worksheet.set_column_width(at, width(sheet, at, text))?;
        worksheet.write_string_with_format(0, at, text, &heading)?;
        let validation = if at < NAMES {
            choice(sheet, at)
        } else if text == STATION {
            choice(sheet, STATIONS)
        } else {
            numbers(text)
        };
        worksheet.add_data_validation(1, at, last, at, &validation?)?;
    }
    for (line, row) in (1..).zip(&sheet.rows) {
        let fields = [&row.posture.name, &row.state, &row.point];
        for (at, text) in (0..).zip(fields) {
            worksheet.write_string_with_format(line, at, text, &name)?;
        }
        let angles = sheet.headings.len() - row.posture.q.len();
        for (at, text) in sheet.headings.iter().enumerate().skip(usize::from(NAMES)) {
            let format = boxed().set_unlocked().set_background_color(TO_FILL);
            let format = number_format(format, text);
            if let Some(station) = row.station.as_ref().filter(|_| text == STATION) {
                worksheet.write_string_with_format(line, at as u16, station, &format)?;
                continue;
            }
            let planned = match at.checked_sub(angles) {
                Some(joint) => Some(rad_to_shortest_deg(row.posture.q[joint])),
                None if text == "load_n" => row.load,
                None => None,
            };
            match planned {
                Some(value) => worksheet.write_number_with_format(line, at as u16, value, &format)?,
                None => worksheet.write_blank(line, at as u16, &format)?,
            };
        }
    }
    worksheet.set_freeze_panes(1, NAMES)?;
    worksheet.protect_with_options(&ProtectionOptions {
        format_cells: true,
        format_columns: true,
        format_rows: true,
        insert_rows: true,
        ..ProtectionOptions::default()
    });
    worksheet.set_paper_size(PAPER_A4).set_landscape();
    worksheet.set_print_fit_to_pages(1, 0);
    worksheet.set_repeat_rows(0, 0)?;
    worksheet.set_footer("&L&F&RPage &P of &N");
    Ok(())
}

/// Digits on the screen; the value keeps all.
fn number_format(format: Format, heading: &str) -> Format {
    let (_, unit) = heading.rsplit_once('_').unwrap_or_default();
    match unit {
        "mm" => format.set_num_format("0.0000"),
        "deg" => format.set_num_format("0.00##"),
        _ => format,
    }
}

/// Width of a column in characters.
fn width(sheet: &Sheet, column: u16, heading: &str) -> f64 {
    let names = if column < NAMES { sheet.names(column) } else { Vec::new() };
    let longest = names.iter().map(|name| name.chars().count()).max();
    let wanted = longest.unwrap_or(8).max(heading.chars().count()) + 2;
    wanted.clamp(9, 40) as f64
}

/// One of the names of the plan; another is possible, with a warning.
fn choice(sheet: &Sheet, column: u16) -> std::result::Result<DataValidation, XlsxError> {
    let letter = ["A", "B", "C", "D"][usize::from(column)];
    let count = sheet.names(column).len().max(1);
    let list = format!("={CHOICES}!${letter}$1:${letter}${count}");
    DataValidation::new()
        .allow_list_formula(Formula::new(list))
        .set_error_style(DataValidationErrorStyle::Warning)
        .set_error_title("Not in the plan")?
        .set_error_message("The plan has no such name. Keep it only if it was really measured.")
}

fn numbers(heading: &str) -> std::result::Result<DataValidation, XlsxError> {
    let rule = match heading {
        "load_n" => DataValidationRule::GreaterThanOrEqualTo(0.0),
        _ => DataValidationRule::Between(-1e9, 1e9),
    };
    DataValidation::new()
        .allow_decimal_number(rule)
        .set_error_title("A number is needed")?
        .set_error_message(format!("{heading} is a number alone; its unit stands in the heading."))
}

/// What the drop-downs offer.
fn choices(worksheet: &mut Worksheet, sheet: &Sheet) -> std::result::Result<(), XlsxError> {
    for column in 0..=STATIONS {
        for (line, name) in (0..).zip(sheet.names(column)) {
            worksheet.write_string(line, column, name)?;
        }
    }
    worksheet.set_hidden(true);
    worksheet.protect();
    Ok(())
}
