//! `--candidates`: the best postures out of a list.

use super::certificate::efficient;
use super::job::{Job, Mode, POSTURES, shown, to_usize};
use crate::commands::{degrees, evaluate, posture_table};
use crate::numbers::counted;
use crate::progress::Progress;
use crate::screen::{columns, wrapped};
use crate::table::{title, yellow};
use schemars::JsonSchema;
use serde::Serialize;
use stiffarm::files::source::Source;
use stiffarm::findings::Finding;
use stiffarm::model::measurement::Candidate;
use stiffarm::model::posture::Posture;
use stiffarm::plan::select::{CandidateOptions, CandidateSelection, select_candidates};
use stiffarm::{Result, Termination};

/// Options of the result.
#[derive(Serialize, JsonSchema)]
pub struct Options {
    /// `candidates`.
    pub mode: Mode,
    /// Number of postures chosen.
    pub postures: usize,
    /// Random groups from which the exchange started.
    pub starts: usize,
    /// Whether a bound was wanted.
    pub certificate: bool,
    /// L of Eq. (20) \[m\].
    pub characteristic_length_m: Option<f64>,
}

/// The chosen postures and what is known about them.
#[derive(Serialize, JsonSchema)]
pub struct Chosen {
    /// The choice.
    #[serde(flatten)]
    pub selection: CandidateSelection,
    /// Names of the joints, as in `evaluation`.
    pub joints: Vec<String>,
    /// Names of all candidates: positions elsewhere count them from 0.
    pub candidate_names: Vec<String>,
    /// True where some candidates count under measured wrenches.
    pub measured_wrenches: bool,
    /// Chosen postures, controller angles \[deg\].
    pub postures_deg: Vec<Vec<f64>>,
    /// Their names.
    pub posture_names: Vec<String>,
    /// What to distrust about the robot of the catalogue.
    pub findings: Vec<Finding>,
}

/// Forbidden candidates that are named.
const FORBIDDEN: usize = 5;

/// Chooses, and writes plan and sheet.
pub(super) fn run(job: &Job<'_>, list: &str) -> Result<()> {
    let cell = job.cell();
    let (candidates, measured) = job.session.read_candidates(list, cell)?;
    let count = to_usize(job.args.postures.unwrap_or(POSTURES));
    let mut options = CandidateOptions::default();
    options.seed = job.seed();
    // The limits of a measured posture are the machine's, which held it.
    options.limits = !measured;
    if job.args.no_certificate {
        options.bound = false;
    }
    let progress = Progress::new(job.session, "choosing postures");
    let found = progress.watch(|control| {
        select_candidates(cell, job.index, count, &candidates, &options, control)
    })?;
    drop(progress);
    let chosen: Vec<Posture> = found
        .chosen
        .iter()
        .map(|p| Posture {
            name: candidates[*p].name.clone(),
            q: candidates[*p].q.clone(),
        })
        .collect();
    job.outputs.write_postures(job.session, cell, &chosen)?;
    let result = Chosen {
        findings: job.findings(),
        joints: cell.setup.robot.spring_names(),
        candidate_names: candidates.iter().map(|c| c.name.clone()).collect(),
        measured_wrenches: candidates.iter().any(|c| c.wrench.is_some()),
        postures_deg: degrees(&chosen),
        posture_names: chosen.iter().map(|p| p.name.clone()).collect(),
        selection: found,
    };
    let described = Options {
        mode: Mode::Candidates,
        postures: count,
        starts: options.starts,
        certificate: !job.args.no_certificate,
        characteristic_length_m: cell.characteristic_length,
    };
    let envelope = job
        .session
        .envelope("select", Some(job.seed()), described, &result);
    job.show(&envelope, || table(job, &candidates, &chosen, &result))
}

fn table(job: &Job<'_>, candidates: &[Candidate], chosen: &[Posture], result: &Chosen) -> String {
    let (cell, found) = (job.cell(), &result.selection);
    let mut out = job.heading();
    out += &evaluate::undetermined(std::slice::from_ref(&found.evaluation));
    out += &format!(
        "{} of {}{}: {}\n",
        counted(chosen.len(), "posture"),
        match candidates.len() {
            1 => "1 candidate".to_string(),
            count => format!("{count} candidates"),
        },
        match result.measured_wrenches {
            true => " under their measured wrenches",
            false => "",
        },
        result.posture_names.join(", ")
    );
    out += &format!(
        "index: {} = {}\n",
        found.index.as_str(),
        shown(found.index, found.value)
    );
    out += &certificate(found);
    if found.termination == Termination::Interrupted {
        out += "interrupted: the best so far\n";
    }
    let left_out = &found.forbidden;
    for own in left_out.iter().take(FORBIDDEN) {
        let name = &candidates[own.candidate].name;
        let sentence = format!(
            "{}: left out: candidate {name} {}",
            yellow("note"),
            own.because
        );
        out += &(wrapped(&sentence, columns()) + "\n");
    }
    if left_out.len() > FORBIDDEN {
        out += &format!(
            "{}: left out: {} further candidates outside bounds or limits\n",
            yellow("note"),
            left_out.len() - FORBIDDEN
        );
    }
    out += &title("Postures");
    out += &posture_table(cell, chosen).to_string();
    let names = vec![result.posture_names.iter().map(String::as_str).collect()];
    out + &evaluate::tables(cell, std::slice::from_ref(&found.evaluation), &names)
}

/// How good any other group of the list could be.
fn certificate(found: &CandidateSelection) -> String {
    let (Some(bound), Some(efficiency)) = (found.bound, found.efficiency) else {
        return String::new();
    };
    if found.exact {
        return "certificate: no other group of this list is better\n".to_string();
    }
    let side = match found.index.larger_is_better() {
        true => "above",
        false => "below",
    };
    format!(
        "certificate: no group of this list can have {} {side} {}; this one is {} efficient\n",
        found.index.as_str(),
        shown(found.index, bound),
        efficient(efficiency)
    )
}
