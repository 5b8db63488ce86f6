//! What every way to work needs: the question, the cell, and where results go.

use crate::answer::Answer;
use crate::args;
use crate::args::SheetChoice;
use crate::files::{Contents, Files, check_targets};
use crate::numbers::to_usize;
use crate::output::Exit;
use crate::picture::check_picture_name;
use crate::progress::Progress;
use crate::session::Session;
use crate::target::Target;
use serde::Serialize;
use std::path::Path;
use stiffarm::ask::select::{Planned, SelectResultOptions, Stage};
use stiffarm::model::cell::Cell;
use stiffarm::model::measurement::Role;
use stiffarm::model::posture::Posture;
use stiffarm::plan::select::RoundReport;
use stiffarm::{Code, Error, Result};
use stiffarm_files::check_name;
use stiffarm_files::source::NamedCell;
use stiffarm_files::table::{SheetOptions, displacement_sheet, reading_sheet, write_postures, write_sheet_workbook};
use stiffarm_report::summary::{Number, Summarise, index_quantity};
use stiffarm_report::{Full, cell_drawing, plan_page, render_drawing};

/// What every way to work needs.
pub(super) struct Job<'a> {
    pub session: &'a Session,
    pub args: &'a args::Select,
    pub named: NamedCell,
    pub outputs: Outputs,
}

impl Job<'_> {
    pub fn cell(&self) -> &Cell {
        &self.named.cell
    }

    /// The result, with its postures as plan, sheet and pictures where these are wanted.
    pub fn answer<R: Serialize + Summarise<SelectResultOptions> + 'static>(
        &self,
        planned: Planned<R>,
        exit: Exit,
    ) -> Result<Answer> {
        let files = self.outputs.postures(&planned.cell, &planned.postures)?;
        Ok(self.summary(planned, exit).with(files))
    }

    /// The result alone.
    pub fn summary<R: Serialize + Summarise<SelectResultOptions> + 'static>(
        &self,
        planned: Planned<R>,
        exit: Exit,
    ) -> Answer {
        let (options, result) = (planned.options, planned.result);
        let session = self.session;
        let envelope = session.envelope("select", planned.seed, options, result);
        Answer::summary(exit, envelope, self.named.clone(), self.args.details)
    }

    /// Shows what the work is at.
    pub fn show(&self, progress: &Progress, stage: Stage) {
        match stage {
            Stage::Round(round) => self.report(progress, &round),
            stage => progress.show(&stage.to_string()),
        }
    }

    /// Shows how a search stands after a round.
    fn report(&self, progress: &Progress, round: &RoundReport) {
        let best = round.value.map_or_else(String::new, |value| {
            let index = self.args.options.index();
            let number = Number::computed(value).of(index_quantity(index));
            let number = number.text().replace('\u{a0}', " ");
            format!(", best {} {number}", index.as_str())
        });
        match self.args.options.rounds {
            Some(of) => progress.report(&format!("selecting{best}"), to_usize(round.rounds), to_usize(of)),
            None => progress.show(&format!("selecting: round {}{best}", round.rounds)),
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
    pub fn new(session: &Session, args: &args::Output) -> Result<Self> {
        let target = |path: &Option<String>| path.as_deref().map(|path| Target::new(path, args.force)).transpose();
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
            return Err(error.hint("leave out --drift and --base-reflector, or --sheet-of displacements"));
        }
        Ok(Outputs { main, sheet: sheet.zip(format), figure, print, sheet_of, options })
    }

    /// Refuses states of the sheet that no reading under the cell's load cases can have.
    pub fn check_states(&self, cell: &Cell) -> Result<()> {
        if !cell.setup.load.has_cases() {
            return Ok(());
        }
        for state in &self.options.states {
            let checked = match Role::of(state) {
                Role::Unloaded => Ok(()),
                Role::Loaded => cell.setup.load.case_of(state).map(|_| ()),
                Role::Preload => {
                    let message =
                        "With several load cases differences are taken against unloaded readings, not a preload.";
                    Err(Error::new(Code::Unsupported, message)
                        .hint("leave the preload out, or put one load alone into [load]"))
                }
            };
            checked.map_err(|error| error.key("--states"))?;
        }
        Ok(())
    }

    /// Postures as plan, as sheet and as picture of `cell`, where these are wanted.
    pub fn postures(&self, cell: &Cell, postures: &[Posture]) -> Result<Files> {
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
        Ok(Files::new(files))
    }

    /// Text as the main output, where one is wanted.
    pub fn text(&self, text: impl FnOnce() -> String) -> Option<Files> {
        let target = self.main.as_ref()?;
        Some(Files::one(target.clone(), text()))
    }
}
