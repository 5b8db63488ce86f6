//! The page to print: the plan's postures, and a box to tick for each reading.

use super::Sheet;
use rust_xlsxwriter::{Format, FormatAlign, FormatBorder, Worksheet, XlsxError};
use stiffarm::model::cell::Cell;
use stiffarm::model::load::Load;
use stiffarm::model::measurement::ReadingTarget;
use stiffarm::units::rad_to_deg;

/// A4 in the format's list of papers (ECMA-376 Part 1, 18.3.1.63, paperSize 9).
pub(super) const PAPER_A4: u8 = 9;

/// Stands for the box of a point that the tracker does not see.
const UNSEEN: &str = "–";

type WorksheetResult = std::result::Result<(), XlsxError>;

/// Fills the worksheet to print, A4 upright.
pub(super) fn print(worksheet: &mut Worksheet, sheet: &Sheet, cell: &Cell) -> WorksheetResult {
    let mut page = Page {
        worksheet,
        line: 0,
        plain: Format::new(),
        bold: Format::new().set_bold(),
        boxed: Format::new().set_border(FormatBorder::Thin),
    };
    page.title(cell)?;
    page.postures(sheet, cell)?;
    page.readings(sheet)?;
    page.worksheet.set_paper_size(PAPER_A4);
    page.worksheet.set_print_fit_to_pages(1, 0);
    page.worksheet.set_footer("&L&F&RPage &P of &N");
    page.worksheet.protect();
    Ok(())
}

struct Page<'w> {
    worksheet: &'w mut Worksheet,
    line: u32,
    plain: Format,
    bold: Format,
    boxed: Format,
}

impl Page<'_> {
    fn title(&mut self, cell: &Cell) -> WorksheetResult {
        let large = Format::new().set_bold().set_font_size(14);
        self.worksheet.write_string_with_format(self.line, 0, &cell.name, &large)?;
        self.line += 1;
        let setup = &cell.setup;
        let points = setup.tool.measuring_points.iter();
        let points: Vec<&str> = points.map(|point| point.name.as_str()).collect();
        for (what, text) in [
            ("Robot", setup.robot.name().to_string()),
            ("Points", points.join(", ")),
            ("Load", described(&setup.load)),
            ("Date, operator", "_".repeat(40)),
        ] {
            self.worksheet.write_string_with_format(self.line, 0, what, &self.bold)?;
            self.worksheet.write_string_with_format(self.line, 1, &text, &self.plain)?;
            self.line += 1;
        }
        self.line += 1;
        Ok(())
    }

    /// Each posture with its angles, once.
    fn postures(&mut self, sheet: &Sheet, cell: &Cell) -> WorksheetResult {
        let joints = cell.setup.robot.joint_count();
        let mut headings = vec!["posture".to_string()];
        let has_stations = sheet.rows.iter().any(|row| row.station.is_some());
        headings.extend(has_stations.then(|| "station".to_string()));
        headings.extend((1..=joints).map(|joint| format!("q{joint}_deg")));
        self.headings(&headings)?;
        let angle = self.boxed.clone().set_num_format("0.00");
        let mut last = None;
        for row in &sheet.rows {
            if last == Some(&row.posture.name) {
                continue;
            }
            last = Some(&row.posture.name);
            self.worksheet.write_string_with_format(self.line, 0, &row.posture.name, &self.boxed)?;
            if has_stations {
                let station = row.station.as_deref().unwrap_or_default();
                self.worksheet.write_string_with_format(self.line, 1, station, &self.boxed)?;
            }
            let first = 1 + u16::from(has_stations);
            for (at, q) in (first..).zip(&row.posture.q) {
                self.worksheet.write_number_with_format(self.line, at, rad_to_deg(*q), &angle)?;
            }
            self.line += 1;
        }
        self.line += 1;
        Ok(())
    }

    /// A line for each posture and state in measuring order, with a box per point that is seen.
    fn readings(&mut self, sheet: &Sheet) -> WorksheetResult {
        let points = sheet.names(2);
        let loads = sheet.headings.iter().any(|heading| heading == "load_n");
        let mut headings: Vec<String> = ["posture", "state"].map(String::from).to_vec();
        if loads {
            headings.push("load_n".to_string());
        }
        let first = headings.len() as u16;
        headings.extend(points.iter().map(|point| {
            if ReadingTarget::is_base_name(point) { (*point).to_string() } else { format!("point {point}") }
        }));
        self.headings(&headings)?;
        let tick = self.boxed.clone().set_align(FormatAlign::Center);
        for rows in sheet.states() {
            let row = &rows[0];
            for (at, text) in (0..).zip([&row.posture.name, &row.state]) {
                self.worksheet.write_string_with_format(self.line, at, text, &self.boxed)?;
            }
            if loads {
                match row.load {
                    Some(load) => self.worksheet.write_number_with_format(self.line, first - 1, load, &self.boxed)?,
                    None => self.worksheet.write_blank(self.line, first - 1, &self.boxed)?,
                };
            }
            for (at, point) in (first..).zip(&points) {
                let sign = rows.iter().find(|row| row.point == **point).map_or(UNSEEN, |_| "☐");
                self.worksheet.write_string_with_format(self.line, at, sign, &tick)?;
            }
            self.line += 1;
        }
        Ok(())
    }

    fn headings(&mut self, headings: &[String]) -> WorksheetResult {
        let bold = self.boxed.clone().set_bold();
        for (at, text) in (0..).zip(headings) {
            self.worksheet.write_string_with_format(self.line, at, text, &bold)?;
            self.worksheet.set_column_width(at, 13)?;
        }
        self.line += 1;
        Ok(())
    }
}

/// The cell's load in words.
fn described(load: &Load) -> String {
    match load {
        Load::Rope { .. } => format!("{} of {} N", load.line(), load.size().unwrap_or_default()),
        Load::Weight { magnitude, .. } => format!("weight of {magnitude} N"),
        Load::Constant { .. } => "constant force and moment".to_string(),
        Load::Measured => "measured with each reading".to_string(),
        Load::Cases(cases) => {
            let each = cases.iter().map(|case| format!("{}: {}", case.name, described(&case.load)));
            each.collect::<Vec<_>>().join("; ")
        }
    }
}
