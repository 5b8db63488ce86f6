//! `stiffarm measure`: beside the robot. Each posture is judged as its readings arrive.

mod judgement;
mod watch;
mod words;

use crate::args::{Goal, MeasureArgs};
use crate::input::Line;
use crate::output::Exit;
use crate::progress::Progress;
use crate::session::Session;
pub use judgement::Judgement;
use judgement::judge;
use serde::Serialize;
use stiffarm::files::source::Source;
use stiffarm::findings::Severity;
use stiffarm::model::cell::Cell;
use stiffarm::work::predicted::tasks;
use stiffarm::{Code, Error, Result};

/// Options of the result.
#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Options {
    /// Half width of every joint's stiffness that is good enough (fraction of k); `null` unless it is the goal.
    pub until_stiffness: Option<f64>,
    /// Half width of the deflection at each task that is good enough \[m\]; `null` unless it is the goal.
    pub until_deflection_m: Option<f64>,
    /// Whether a better posture was looked for.
    pub search: bool,
}

/// Judges what is there, once or again and again.
pub fn run(session: &Session, args: &MeasureArgs) -> Result<Exit> {
    if !args.once {
        if session.json {
            let message = "One JSON object cannot tell a whole day.";
            return Err(Error::new(Code::Usage, message)
                .key("--json")
                .hint("add --once for the judgement of what is there"));
        }
        return watch::watch(session, args);
    }
    let named = session.read_cell(&args.cell)?;
    let plan = session.read_postures("plan", &args.plan, &named.cell.setup.robot)?;
    check_goal(&named.cell, args)?;
    let progress = Progress::new(session, "judging the readings");
    let found = progress.watch(|control| judge(session, &named.cell, &plan, args, control))?;
    drop(progress);
    let options = Options {
        until_stiffness: args.until.and_then(Goal::stiffness),
        until_deflection_m: args.until.and_then(Goal::deflection),
        search: !args.no_search,
    };
    let envelope = session.envelope("measure", Some(args.seed), options, &found);
    session.show(&envelope, || {
        named.line() + &words::whole(&named.cell, &plan, &found, args.until)
    })?;
    Ok(match session.stopped() {
        true => Exit::Interrupted,
        false => Exit::finding(is_serious(&found) || is_missed(&found)),
    })
}

/// Refuses a goal at tasks that the cell does not have.
fn check_goal(cell: &Cell, args: &MeasureArgs) -> Result<()> {
    match args.until {
        Some(Goal::Deflection(_)) => tasks(cell).map(|_| ()).map_err(|error| {
            let hint =
                "add [[task]] to the cell, or give a percentage of the stiffness, such as 2%";
            Error::new(
                error.code(),
                "A goal in mm is for the deflection at the cell's tasks, of one tip.",
            )
            .key("--until")
            .hint(hint)
        }),
        _ => Ok(()),
    }
}

/// Whether the plan is measured and the goal is not reached.
fn is_missed(found: &Judgement) -> bool {
    found.left.is_empty() && found.reached() == Some(false)
}

/// Whether something about the readings must be settled.
fn is_serious(found: &Judgement) -> bool {
    found
        .readings
        .iter()
        .any(|f| f.severity == Severity::Serious)
}
