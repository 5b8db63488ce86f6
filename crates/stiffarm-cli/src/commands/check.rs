//! `stiffarm check`: what to know about a cell before anybody measures.

use crate::answer::Answer;
use crate::args;
use crate::files::{Files, only_target};
use crate::output::Exit;
use crate::picture::check_picture_name;
use crate::session::Session;
use crate::table::title;
use stiffarm::model::cell::Cell;
use stiffarm::model::posture::Posture;
use stiffarm::plan::check::check;
use stiffarm::{Code, Error, Result};
use stiffarm_files::source::read_postures;
use stiffarm_files::urdf::doubted_axes;
use stiffarm_report::{Full, cell_drawing, render_drawing, usual_posture};

/// Value of `--posture` that draws none in full.
const ALL: &str = "all";

/// A check has no options.
#[derive(serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Options {}

/// Checks the cell, and draws it where that is asked for.
pub fn run(session: &Session, args: &args::Check) -> Result<Answer> {
    args.figure.as_deref().map(check_picture_name).transpose()?;
    let target = only_target(session, args.figure.as_deref(), args.force)?;
    let named = session.read_cell(&args.cell)?;
    let (postures, full) = match &target {
        Some(_) => pictured(session, args, &named.cell)?,
        None => (Vec::new(), Full::None),
    };
    let mut result = check(&named.cell)?;
    let joints = named.cell.setup.robot.joints().iter();
    let names: Vec<&str> = joints.map(|joint| joint.name.as_str()).collect();
    result.findings.extend(doubted_axes(&names));
    let exit = Exit::of_findings(&result.findings);
    let (mut notes, mut picture) = (String::new(), None);
    if let Some(target) = target {
        let drawing = cell_drawing(&named.cell, &postures, full)?;
        // A picture shows its notes itself.
        if !target.is_stdout() && !drawing.notes.is_empty() {
            let lines = drawing.notes.iter().map(|note| format!("{}\n", note.text));
            notes = title("Picture") + &lines.collect::<String>();
        }
        picture = Some(Files::one(target, render_drawing(&drawing)));
    }
    let envelope = session.envelope("check", None, Options {}, result);
    let answer = Answer::summary(exit, envelope, named, args.details).with(picture);
    Ok(Answer { notes, ..answer })
}

/// The postures of the picture, and which of them is drawn in full.
fn pictured(session: &Session, args: &args::Check, cell: &Cell) -> Result<(Vec<Posture>, Full)> {
    let postures = match &args.postures {
        Some(from) => read_postures(session, "postures", from, &cell.setup.robot)?,
        None if args.posture.is_none() => return Ok((vec![usual_posture(cell)?], Full::Number(0))),
        None => cell.validation.clone(),
    };
    let Some(wanted) = args.posture.as_deref() else {
        return Ok((postures, Full::Tightest));
    };
    if postures.is_empty() {
        let message = "The cell has no validation postures to draw.";
        let error = Error::new(Code::MissingKey, message).key("--posture");
        return Err(error.hint("name a file of postures with --postures"));
    }
    if wanted == ALL {
        return Ok((postures, Full::None));
    }
    let number = postures.iter().position(|posture| posture.name == wanted);
    match number {
        Some(number) => Ok((postures, Full::Number(number))),
        None => {
            let names: Vec<&str> = postures.iter().map(|p| p.name.as_str()).collect();
            let message = format!("There is no posture {wanted}.");
            let error = Error::new(Code::UnknownName, message).key("--posture");
            Err(error.hint(format!("the postures are {}, or all", names.join(", "))))
        }
    }
}
