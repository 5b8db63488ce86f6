//! `stiffarm measure`: beside the robot. Each posture is judged as its readings arrive.

mod judgement;
mod watch;
mod words;

use crate::args::MeasureArgs;
use crate::interrupt;
use crate::output::Exit;
use crate::progress::Progress;
use crate::session::Session;
pub use judgement::Judgement;
use judgement::judge;
use schemars::JsonSchema;
use serde::Serialize;
use stiffarm::findings::Severity;
use stiffarm::{Code, Error, Result};

/// Options of the result.
#[derive(Serialize, JsonSchema)]
pub struct Options {
    /// Largest half width that is good enough (fraction of k).
    pub until: Option<f64>,
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
    let progress = Progress::new(session, "judging the readings");
    let found = progress
        .watch(|control| judge(session, &named.cell, &plan, args, !args.no_search, control))?;
    drop(progress);
    let options = Options {
        until: args.until,
        search: !args.no_search,
    };
    let envelope = session.envelope("measure", Some(args.seed), options, &found);
    session.show(&envelope, || {
        named.line() + &words::whole(&named.cell, &plan, &found, args.until)
    })?;
    Ok(match interrupt::stopped() {
        true => Exit::Interrupted,
        false => Exit::finding(is_serious(&found)),
    })
}

/// Whether something about the readings must be settled.
fn is_serious(found: &Judgement) -> bool {
    found
        .readings
        .iter()
        .any(|f| f.severity == Severity::Serious)
}
