//! Waits for readings and says what each change of the files brings. The files are the only memory: what is begun again
//! reads them from the start, so nothing is lost when it is stopped.

use super::{check_goal, look};
use crate::args;
use crate::input::Line;
use crate::interrupt;
use crate::output::{Exit, summary};
use crate::progress::Progress;
use crate::session::Session;
use crate::table::green;
use crate::text;
use std::path::Path;
use std::time::{Duration, SystemTime};
use stiffarm::ask::measure::Judgement;
use stiffarm::findings::{Finding, Severity, list};
use stiffarm::model::cell::Cell;
use stiffarm::model::posture::Posture;
use stiffarm::{Code, Control, Error, Result};
use stiffarm_files::source::read_postures;

/// Longest time without a look at whether the user stopped.
const NAP: Duration = Duration::from_millis(50);

/// Waits, judges and tells until the goal is reached, the plan is measured, or the user stops.
pub(super) fn watch(session: &Session, args: &args::Measure) -> Result<Exit> {
    if args.readings.iter().any(|from| from == "-") {
        let message = "Standard input cannot be waited for.";
        return Err(Error::new(Code::Usage, message).hint("give a file, or add --once"));
    }
    interrupt::look_out();
    let named = session.read_cell(&args.cell)?;
    let plan = read_postures(session, "plan", &args.plan, &named.cell.setup.robot)?;
    check_goal(&named.cell, args)?;
    session.print(&format!(
        "{}waiting for readings of {} postures; Ctrl-C ends, and starting again goes on\n",
        named.line(),
        plan.len()
    ))?;
    let mut day = Day::default();
    loop {
        if session.stopped() {
            return Ok(Exit::Interrupted);
        }
        let stamp = stamp(&args.readings);
        if stamp.is_some() && stamp != day.stamp {
            day.stamp = stamp;
            if let Some(exit) = day.look(session, &named.cell, &plan, args)? {
                return Ok(exit);
            }
        }
        let mut slept = Duration::ZERO;
        while slept < args.every && !session.stopped() {
            let nap = NAP.min(args.every - slept);
            std::thread::sleep(nap);
            slept += nap;
        }
    }
}

/// Size and time of each file that is there; `None` where none is.
fn stamp(files: &[String]) -> Option<Vec<Option<(u64, SystemTime)>>> {
    let of = |file: &String| {
        let meta = std::fs::metadata(Path::new(file)).ok()?;
        Some((meta.len(), meta.modified().ok()?))
    };
    let all: Vec<_> = files.iter().map(of).collect();
    all.iter().any(Option::is_some).then_some(all)
}

/// What has been said so far.
#[derive(Default)]
struct Day {
    stamp: Option<Vec<Option<(u64, SystemTime)>>>,
    measured: Vec<String>,
    findings: Vec<Finding>,
    failure: Option<String>,
}

impl Day {
    /// Looks at the files again; an exit where there is nothing left to wait for.
    fn look(&mut self, session: &Session, cell: &Cell, plan: &[Posture], args: &args::Measure) -> Result<Option<Exit>> {
        // A look of its own: what is quoted in messages is what is there now.
        let fresh_session = session.afresh();
        let judgement = Progress::new(session, "judging the readings")
            .watch(|control: Control<'_>| look(&fresh_session, (cell, plan), args, control));
        let judgement = match judgement {
            Ok(judgement) => judgement,
            Err(error) if error.code() == Code::Interrupted => return Ok(Some(Exit::Interrupted)),
            // An export in the middle of being written, or a slip: said once, and waited for.
            Err(error) => {
                let text = crate::error::to_text(&fresh_session, &error);
                if self.failure.as_deref() != Some(text.as_str()) {
                    session.print(&format!("\n{text}"))?;
                    self.failure = Some(text);
                }
                return Ok(None);
            }
        };
        if self.failure.take().is_some() {
            session.print("the readings can be read again\n")?;
        }
        session.print(&self.news(session, cell, &judgement, args)?)?;
        let reached = judgement.reached() == Some(true);
        let (serious, missed) = (judgement.is_serious(), judgement.is_missed());
        self.measured = judgement.measured;
        self.findings = judgement.readings;
        // A first posture alone may still be at work.
        let enough = reached && (self.measured.len() > 1 || plan.len() == 1);
        Ok(match (serious, enough || judgement.left.is_empty()) {
            (false, true) => Some(Exit::finding(missed)),
            // Something is still to be settled.
            _ => None,
        })
    }

    /// What is new since the last look; nothing where only parts of a posture have come.
    fn news(&self, session: &Session, cell: &Cell, judgement: &Judgement, args: &args::Measure) -> Result<String> {
        let is_new = |name: &&String| !self.measured.contains(name);
        let postures: Vec<String> = judgement.measured.iter().filter(is_new).cloned().collect();
        let contains = |list: &[Finding], f: &Finding| {
            let same = |other: &Finding| other.code == f.code && other.subject == f.subject;
            list.iter().any(same)
        };
        let is_new = judgement.readings.iter().any(|f| !contains(&self.findings, f));
        let settled =
            self.findings.iter().filter(|f| f.severity == Severity::Serious && !contains(&judgement.readings, f));
        let settled: Vec<&Finding> = settled.collect();
        if postures.is_empty() && !is_new && settled.is_empty() {
            return Ok(String::new());
        }
        let mut out = "\n".to_string();
        for finding in &settled {
            out += &format!("{}: {}\n", green("settled"), finding.subject);
        }
        if !postures.is_empty() && !judgement.is_serious() {
            let sound = green("sound");
            out += &format!("posture {}: readings {sound}\n", list(&postures));
        }
        let envelope = session.envelope("measure", Some(args.options.seed), args.options.clone(), judgement);
        let mut summary = summary(&envelope, Some(cell))?;
        // What is still to settle is said again.
        summary.findings.retain(|f| f.severity == Severity::Serious || !contains(&self.findings, f));
        summary.sections.clear();
        Ok(out + &text::summary(&summary, true))
    }
}
