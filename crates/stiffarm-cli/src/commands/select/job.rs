//! What every way to work needs: the question, the cell, and where results go.

use crate::args::{OutputArgs, SelectArgs, SheetChoice};
use crate::commands::wrapped_line;
use crate::files::picture::check_picture_name;
use crate::files::{Contents, Target, check_targets, write_all};
use crate::input::Line;
use crate::numbers::optional;
use crate::progress::Progress;
use crate::session::Session;
use serde::Serialize;
use std::path::Path;
use stiffarm::files::check_name;
use stiffarm::files::source::NamedCell;
use stiffarm::files::table::{
    SheetOptions, displacement_sheet, reading_sheet, write_postures, write_sheet_workbook,
};
use stiffarm::findings::Finding;
use stiffarm::model::cell::Cell;
use stiffarm::model::measurement::Role;
use stiffarm::model::posture::Posture;
use stiffarm::plan::check::robot_doubts;
use stiffarm::plan::index::Index;
use stiffarm::plan::planned::{Planned, Stage};
use stiffarm::plan::select::RoundReport;
use stiffarm::units::m_to_mm;
use stiffarm::{Code, Error, Result};
use stiffarm_report::{Full, cell_drawing, plan_page, render_drawing};

/// What every way to work needs.
pub(super) struct Job<'a> {
    pub session: &'a Session,
    pub args: &'a SelectArgs,
    pub index: Index,
    pub named: NamedCell,
    /// Says where the characteristic length had to be computed.
    pub length_line: String,
    pub outputs: Outputs,
}

impl Job<'_> {
    pub fn cell(&self) -> &Cell {
        &self.named.cell
    }

    /// Steps that angles are rounded to \[deg\], where they are.
    pub fn angle_step(&self) -> Option<f64> {
        let step = self.args.output.angle_step_deg;
        (step > 0.0).then_some(step)
    }

    /// First lines of every table.
    pub fn heading(&self) -> String {
        let findings = self.findings();
        let lines = findings.iter().map(|f| wrapped_line(f) + "\n");
        self.named.line() + &self.length_line + &lines.collect::<String>()
    }

    /// What to distrust about the robot.
    pub fn findings(&self) -> Vec<Finding> {
        robot_doubts(&self.cell().setup.robot)
    }

    /// Writes the postures as plan, sheet and pictures where these are wanted, and prints the result.
    pub fn deliver<R: Serialize, O: Serialize>(
        &self,
        planned: &Planned<R, O>,
        table: impl FnOnce() -> String,
    ) -> Result<()> {
        self.outputs
            .write_postures(self.session, &planned.cell, &planned.postures)?;
        self.show(planned, table)
    }

    /// Prints the result; where a file goes to standard output, the table for
    /// people goes to standard error.
    pub fn show<R: Serialize, O: Serialize>(
        &self,
        planned: &Planned<R, O>,
        table: impl FnOnce() -> String,
    ) -> Result<()> {
        let Planned {
            seed,
            options,
            result,
            ..
        } = planned;
        let envelope = self.session.envelope("select", *seed, options, result);
        if self.outputs.use_stdout() {
            self.session.write_page(&envelope)?;
            self.session.remark(&table());
            return Ok(());
        }
        self.session.show(&envelope, table)
    }

    /// Shows what the work is at.
    pub fn tell(&self, progress: &Progress, stage: Stage) {
        match stage {
            Stage::Round(round) => self.report(progress, &round),
            stage => progress.tell(&stage.to_string()),
        }
    }

    /// Shows how a search stands after a round.
    fn report(&self, progress: &Progress, round: &RoundReport) {
        let best = round.value.map_or_else(String::new, |value| {
            format!(
                ", best {} {}",
                self.index.as_str(),
                shown(self.index, value)
            )
        });
        match self.args.budget.rounds {
            Some(of) => progress.report(
                &format!("selecting{best}"),
                to_usize(round.rounds),
                to_usize(of),
            ),
            None => progress.tell(&format!("selecting: round {}{best}", round.rounds)),
        }
    }
}

/// What a sheet is written as.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum SheetFormat {
    /// CSV text.
    Text,
    /// An .xlsx workbook.
    Workbook,
}

impl SheetFormat {
    /// The format that the name of a file says.
    fn of(path: &str) -> Result<Self> {
        let ending = Path::new(path).extension();
        let ending = ending.map_or_else(String::new, |e| e.to_string_lossy().to_lowercase());
        match ending.as_str() {
            "xlsx" => Ok(SheetFormat::Workbook),
            "xls" | "xlsm" | "xlsb" | "xltx" | "ods" | "fods" | "numbers" => {
                let message = format!("A sheet is not written as .{ending}.");
                let error = Error::new(Code::Unsupported, message).key("--sheet");
                Err(error.hint("name it .xlsx, which spreadsheet programs open, or .csv"))
            }
            _ => Ok(SheetFormat::Text),
        }
    }
}

/// Where plan and sheet go, checked before any work is done for them.
pub(super) struct Outputs {
    main: Option<Target>,
    sheet: Option<(Target, SheetFormat)>,
    figure: Option<Target>,
    print: Option<Target>,
    sheet_of: SheetChoice,
    options: SheetOptions,
}

impl Outputs {
    pub fn new(session: &Session, args: &OutputArgs) -> Result<Self> {
        let target = |path: &Option<String>| {
            path.as_deref()
                .map(|path| Target::new(path, args.force))
                .transpose()
        };
        let format = args.sheet.as_deref().map(SheetFormat::of).transpose()?;
        let (main, sheet) = (target(&args.output)?, target(&args.sheet)?);
        args.figure.as_deref().map(check_picture_name).transpose()?;
        let (figure, print) = (target(&args.figure)?, target(&args.print)?);
        let all = [&main, &sheet, &figure, &print].map(Option::as_ref);
        check_targets(session, &all)?;
        for state in &args.states {
            check_name(state).map_err(|e| e.key("--states"))?;
        }
        let options = {
            let mut options = SheetOptions::default();
            options.states = args.states.clone();
            options.drift = args.drift;
            options.base_reflector = args.base_reflector;
            options
        };
        let sheet_of = args.sheet_of.unwrap_or(SheetChoice::Readings);
        if sheet_of == SheetChoice::Displacements && (args.drift || args.base_reflector) {
            let message = "A displacement has neither drift nor a base reflector: both are subtracted already.";
            let error = Error::new(Code::Usage, message).key("--sheet-of");
            return Err(
                error.hint("leave out --drift and --base-reflector, or --sheet-of displacements")
            );
        }
        Ok(Outputs {
            main,
            sheet: sheet.zip(format),
            figure,
            print,
            sheet_of,
            options,
        })
    }

    fn use_stdout(&self) -> bool {
        let sheet = self.sheet.as_ref().map(|(target, _)| target);
        let own = [&self.main, &self.figure, &self.print].map(Option::as_ref);
        let mut all = own.into_iter().chain([sheet]).flatten();
        all.any(Target::is_stdout)
    }

    /// Refuses states of the sheet that no reading under the cell's load cases can have.
    pub fn check_states(&self, cell: &Cell) -> Result<()> {
        if !cell.setup.load.has_cases() {
            return Ok(());
        }
        for state in &self.options.states {
            let known = match Role::of(state) {
                Role::Unloaded => Ok(()),
                Role::Loaded => cell.setup.load.case_of(state).map(|_| ()),
                Role::Preload => {
                    let message = "With several load cases differences are taken against unloaded readings, not a preload.";
                    Err(Error::new(Code::Unsupported, message)
                        .hint("leave the preload out, or put one load alone into [load]"))
                }
            };
            known.map_err(|error| error.key("--states"))?;
        }
        Ok(())
    }

    /// Writes postures as plan, as sheet and as picture of `cell`, where these are wanted.
    pub fn write_postures(
        &self,
        session: &Session,
        cell: &Cell,
        postures: &[Posture],
    ) -> Result<()> {
        let mut files: Vec<(Target, Box<dyn Contents>)> = Vec::new();
        if let Some(figure) = &self.figure {
            let drawing = cell_drawing(cell, postures, Full::Tightest)?;
            files.push((figure.clone(), Box::new(render_drawing(&drawing))));
        }
        if let Some(plan) = &self.main {
            files.push((plan.clone(), Box::new(write_postures(postures))));
        }
        let sheet = || match self.sheet_of {
            SheetChoice::Readings => reading_sheet(postures, &self.options, cell),
            SheetChoice::Displacements => {
                let states = self.options.states.iter();
                let states: Vec<&str> = states.map(String::as_str).collect();
                displacement_sheet(postures, &states, cell)
            }
        };
        if let Some(page) = &self.print {
            files.push((page.clone(), Box::new(plan_page(cell, &sheet())?)));
        }
        if let Some((target, format)) = &self.sheet {
            let sheet = sheet();
            let contents: Box<dyn Contents> = match format {
                SheetFormat::Text => Box::new(sheet.to_csv()),
                SheetFormat::Workbook => Box::new(write_sheet_workbook(&sheet, cell)?),
            };
            files.push((target.clone(), contents));
        }
        write_all(session, &files)
    }

    /// Writes text as the main output, where one is wanted.
    pub fn write_text(&self, session: &Session, text: impl FnOnce() -> String) -> Result<()> {
        match &self.main {
            Some(target) => write_all(session, &[(target.clone(), text())]),
            None => Ok(()),
        }
    }
}

/// Unit of an index in tables.
fn unit(index: Index) -> &'static str {
    if index.is_relative_error() {
        "%"
    } else if index.is_length() {
        "mm"
    } else {
        ""
    }
}

/// A value in the unit of tables, with digits enough to tell it from its bound.
pub(super) fn number(index: Index, value: Option<f64>) -> String {
    let in_unit = |value: f64| match unit(index) {
        "%" => 100.0 * value,
        "mm" => m_to_mm(value),
        _ => value,
    };
    optional(value.map(in_unit), 4)
}

/// A value with its unit.
pub(super) fn shown(index: Index, value: f64) -> String {
    format!("{} {}", number(index, Some(value)), unit(index))
        .trim_end()
        .to_string()
}

/// Which statistic an index is, behind its value.
pub(super) fn statistic(index: Index) -> &'static str {
    match index {
        Index::ExpectedError => " (RMS over the joints of the standard error by noise alone)",
        Index::WorstJoint => " (largest standard error of a joint, by noise alone)",
        Index::DropOne => " (RMS over the joints with the worst posture lost, by noise alone)",
        _ => "",
    }
}

/// A heading with the unit of an index behind it.
pub(super) fn with_unit(index: Index, heading: &str) -> String {
    match unit(index) {
        "" => heading.to_string(),
        unit => format!("{heading} [{unit}]"),
    }
}

/// A count from the command line as a number of things in memory.
pub(super) fn to_usize(count: u64) -> usize {
    usize::try_from(count).unwrap_or(usize::MAX)
}
