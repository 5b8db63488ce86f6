//! `stiffarm measure`: beside the robot. Each posture is judged as its readings arrive.

mod watch;

use crate::answer::Answer;
use crate::args;
use crate::output::Exit;
use crate::progress::Progress;
use crate::session::Session;
use stiffarm::ask::measure::{Goal, Judgement, judge};
use stiffarm::model::cell::Cell;
use stiffarm::model::posture::Posture;
use stiffarm::work::tasks::tasks;
use stiffarm::{Code, Control, Error, Result};
use stiffarm_files::source::{read_growing_measurements, read_postures, read_registration};

/// Judges what is there, once or again and again.
pub fn run(session: &Session, args: &args::Measure) -> Result<Answer> {
    if !args.once {
        if session.json {
            let message = "One JSON object cannot tell a whole day.";
            return Err(Error::new(Code::Usage, message)
                .key("--json")
                .hint("add --once for the judgement of what is there"));
        }
        return watch::watch(session, args).map(Answer::ended);
    }
    let named = session.read_cell(&args.cell)?;
    let plan = read_postures(session, "plan", &args.plan, &named.cell.setup.robot)?;
    check_goal(&named.cell, args)?;
    let judgement = Progress::new(session, "judging the readings")
        .watch(|control| look(session, (&named.cell, &plan), args, control))?;
    let exit = if session.stopped() {
        Exit::Interrupted
    } else {
        Exit::finding(judgement.is_serious() || judgement.is_missed())
    };
    let envelope = session.envelope("measure", Some(args.options.seed), args.options.clone(), judgement);
    Ok(Answer::summary(exit, envelope, named, true))
}

/// Looks at the files once.
fn look(
    session: &Session,
    (cell, plan): (&Cell, &[Posture]),
    args: &args::Measure,
    control: Control<'_>,
) -> Result<Judgement> {
    let reduce = read_registration(session, args.registration.as_deref())?;
    let read = read_growing_measurements(session, &args.readings, Some(&args.plan), cell);
    judge((cell, plan), read, &reduce, &args.options, control)
}

/// Refuses a goal at tasks that the cell does not have.
fn check_goal(cell: &Cell, args: &args::Measure) -> Result<()> {
    match args.options.until {
        Some(Goal::Deflection(_)) => tasks(cell).map(|_| ()).map_err(|error| {
            let hint = "add [[task]] to the cell, or give a percentage of the stiffness, such as 2%";
            Error::new(error.code(), "A goal in mm is for the deflection at the cell's tasks, of one tip.")
                .key("--until")
                .hint(hint)
        }),
        _ => Ok(()),
    }
}
