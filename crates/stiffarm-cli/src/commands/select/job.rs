//! What every way to work needs: the question, the cell, and where results go.

use crate::args::{OutputArgs, SelectArgs, SheetChoice};
use crate::files::{Contents, check_targets, write_all};
use crate::numbers::to_usize;
use crate::output::Exit;
use crate::picture::check_picture_name;
use crate::progress::Progress;
use crate::session::Session;
use crate::target::Target;
use serde::Serialize;
use std::path::Path;
use stiffarm::findings::Finding;
use stiffarm::model::cell::Cell;
use stiffarm::model::measurement::Role;
use stiffarm::model::posture::Posture;
use stiffarm::plan::index::Index;
use stiffarm::plan::planned::{Planned, Stage};
use stiffarm::plan::select::RoundReport;
use stiffarm::{Code, Error, Result};
use stiffarm_files::check_name;
use stiffarm_files::source::NamedCell;
use stiffarm_files::table::{
    SheetOptions, displacement_sheet, reading_sheet, write_postures, write_sheet_workbook,
};
use stiffarm_report::tell::{Number, Telling, index_quantity};
use stiffarm_report::{Full, cell_drawing, plan_page, render_drawing};

/// What every way to work needs.
pub(super) struct Job<'a> {
    pub session: &'a Session,
    pub args: &'a SelectArgs,
    pub index: Index,
    pub named: NamedCell,
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

    /// Writes the postures as plan, sheet and pictures where these are wanted, and tells the result.
    pub fn deliver<R: Serialize + Telling<O>, O: Serialize + Clone>(
        &self,
        planned: &Planned<R, O>,
        findings: &[Finding],
    ) -> Result<Exit> {
        self.outputs
            .write_postures(self.session, &planned.cell, &planned.postures)?;
        self.show(planned, findings)
    }

    /// Tells the result, and how the command ends by its findings.
    pub fn show<R: Serialize + Telling<O>, O: Serialize + Clone>(
        &self,
        planned: &Planned<R, O>,
        findings: &[Finding],
    ) -> Result<Exit> {
        let (session, seed) = (self.session, planned.seed);
        let envelope = session.envelope("select", seed, planned.options.clone(), &planned.result);
        session.deliver_told(None, &envelope, &self.named, self.args.details)?;
        Ok(Exit::of_findings(findings))
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
            let number = Number::computed(value).of(index_quantity(self.index));
            let number = number.text().replace('\u{a0}', " ");
            format!(", best {} {number}", self.index.as_str())
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
