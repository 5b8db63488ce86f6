//! `--drop`: which given postures are least worth their measuring time.

use super::job::{Job, number, shown, to_usize, with_unit};
use crate::numbers::{counted, percent};
use crate::progress::{Progress, announce};
use crate::table::{Align, Table, title, yellow};
use stiffarm::Result;
use stiffarm::files::source::Source;
use stiffarm::model::posture::Posture;
use stiffarm::plan::planned::{DropRequest, plan_drop};
use stiffarm::plan::select::{Dropped, drop_evaluations};

/// From so many groups on, their number is said before they are evaluated.
const EVALUATIONS: usize = 10_000;

/// Compares the ways to leave postures out and writes those that stay.
pub(super) fn run(job: &Job<'_>, given: &str, count: u64) -> Result<()> {
    let robot = &job.cell().setup.robot;
    let given = job.session.read_postures("given", given, robot)?;
    let mut request = DropRequest::default();
    request.index = job.index;
    request.drop = to_usize(count);
    if request.drop < given.len() {
        let groups = drop_evaluations(given.len(), request.drop);
        announce(job.session, groups, EVALUATIONS, "groups to evaluate");
    }
    let progress = Progress::new(job.session, "leaving postures out");
    let planned = progress.watch(|control| plan_drop(job.cell(), &given, &request, control))?;
    drop(progress);
    job.deliver(&planned, || table(job, &given, &planned.result.dropped))
}

fn table(job: &Job<'_>, postures: &[Posture], dropped: &Dropped) -> String {
    let index = job.index;
    let names = |positions: &[usize]| {
        let names: Vec<&str> = positions
            .iter()
            .map(|p| postures[*p].name.as_str())
            .collect();
        names.join(", ")
    };
    let mut out = job.heading();
    for remark in job.cell().posture_remarks(postures) {
        out += &format!("{}: {remark}\n", yellow("note"));
    }
    let count = dropped.dropped.len();
    out += &format!(
        "index: {} = {} with all {}\nleave out: {}; the other {} give {}{}\n",
        index.as_str(),
        shown(index, dropped.before),
        counted(postures.len(), "posture"),
        names(&dropped.dropped),
        dropped.kept.len(),
        shown(index, dropped.value),
        match (count, dropped.exhaustive) {
            (1, _) => String::new(),
            (_, true) => format!(", the best of all ways to leave out {count}"),
            (_, false) => ", left out one after the other: other choices may be better".to_string(),
        }
    );
    out += &title("What is lost without one posture, least first");
    let without = with_unit(index, &format!("{} without it", index.as_str()));
    let mut losses = Table::new([
        "posture".to_string(),
        without,
        "loss [%]".to_string(),
        String::new(),
    ]);
    losses.align(3, Align::Left);
    for posture in &dropped.values {
        let value = number(index, posture.value);
        let (loss, remark) = match posture.loss {
            Some(loss) => (percent(loss), ""),
            None => (
                "-".to_string(),
                "needed: a joint is undetermined without it",
            ),
        };
        let mark = if dropped.dropped.contains(&posture.posture) {
            "leave out"
        } else {
            remark
        };
        let name = postures[posture.posture].name.clone();
        losses.row([name, value, loss, mark.to_string()]);
    }
    out + &losses.to_string()
}
