//! `--drop`: which given postures are least worth their measuring time.

use super::job::{Job, Mode, number, shown, to_usize, with_unit};
use crate::commands::degrees;
use crate::numbers::{counted, percent};
use crate::progress::{Progress, announce};
use crate::table::{Align, Table, title, yellow};
use schemars::JsonSchema;
use serde::Serialize;
use stiffarm::files::source::Source;
use stiffarm::findings::Finding;
use stiffarm::model::posture::Posture;
use stiffarm::plan::select::{Dropped, drop_evaluations, drop_postures};
use stiffarm::{Code, Result};

/// From so many groups on, their number is said before they are evaluated.
const EVALUATIONS: usize = 10_000;

/// Options of the result.
#[derive(Serialize, JsonSchema)]
pub struct Options {
    /// `drop`.
    pub mode: Mode,
    /// Number of postures to leave out.
    pub drop: usize,
    /// L of Eq. (20) \[m\].
    pub characteristic_length_m: Option<f64>,
}

/// What each posture is worth, and which ones stay.
#[derive(Serialize, JsonSchema)]
pub struct DropResult {
    /// Names of the given postures: positions elsewhere count them from 0.
    pub posture_names: Vec<String>,
    /// The given postures, controller angles \[deg\].
    pub postures_deg: Vec<Vec<f64>>,
    /// Worth of each posture, and the choice.
    #[serde(flatten)]
    pub dropped: Dropped,
    /// What to distrust about the robot of the catalogue, and given postures outside bounds or limits.
    pub findings: Vec<Finding>,
}

/// Compares the ways to leave postures out and writes those that stay.
pub(super) fn run(job: &Job<'_>, given: &str, count: u64) -> Result<()> {
    let cell = job.cell();
    let postures = job
        .session
        .read_postures("given", given, &cell.setup.robot)?;
    let count = to_usize(count);
    if count < postures.len() {
        let groups = drop_evaluations(postures.len(), count);
        announce(job.session, groups, EVALUATIONS, "groups to evaluate");
    }
    let progress = Progress::new(job.session, "leaving postures out");
    let dropped =
        progress.watch(|control| drop_postures(cell, job.index, &postures, count, control));
    drop(progress);
    let dropped = dropped.map_err(|error| match (error.code(), postures.len()) {
        (Code::TooFewData, 2..) => error.hint(format!("leave out {} at most", postures.len() - 1)),
        _ => error,
    })?;
    let kept: Vec<Posture> = dropped.kept.iter().map(|p| postures[*p].clone()).collect();
    job.outputs.write_postures(job.session, cell, &kept)?;
    let options = Options {
        mode: Mode::Drop,
        drop: count,
        characteristic_length_m: cell.characteristic_length,
    };
    let result = DropResult {
        posture_names: postures.iter().map(|p| p.name.clone()).collect(),
        postures_deg: degrees(&postures),
        dropped,
        findings: {
            let mut findings = job.findings();
            findings.extend(cell.posture_findings(&postures));
            findings
        },
    };
    let envelope = job.session.envelope("select", None, options, &result);
    job.show(&envelope, || table(job, &postures, &result.dropped))
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
