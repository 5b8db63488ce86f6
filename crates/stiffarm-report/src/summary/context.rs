//! What the tellings of all results share.

use super::{Block, Context, DataTable, Outcome, Section, Summary, Text};
use crate::cell::Full;
use crate::scene::{Scene, SceneGroup, SceneOptions, scene};
use std::cmp::Reverse;
use stiffarm::Result;
use stiffarm::findings::{Finding, Severity, codes, list, visible};
use stiffarm::model::cell::Cell;
use stiffarm::model::posture::PostureGroup;

/// Commands whose numbers come after what forbids to use them.
const AT_WORK: [&str; 4] = ["validate", "predict", "compensate", "map"];

/// Codes of findings that are the result, and not about its numbers.
const NOWHERE: [&str; 2] = [codes::NOTHING_REACHABLE, codes::NOWHERE];

/// Codes of findings that a command was stopped.
const STOPPED: [&str; 2] = ["interrupted", "stopped"];

/// Cell and robot in words.
pub(crate) fn cell_line(cell: &Cell) -> String {
    format!("{} · robot {}", visible(&cell.name), visible(cell.setup.robot.name()))
}

impl Context<'_> {
    /// What all results say, around what is their own; `findings` in the order in which they were found.
    pub(super) fn summary(
        &self,
        mut findings: Vec<Finding>,
        heading: impl Into<String>,
        verdict: [Text; 3],
        key: Option<DataTable>,
        sections: Vec<Section>,
    ) -> Summary {
        let serious = |f: &&Finding| f.severity == Severity::Serious;
        let doubtful = |f: &Finding| f.code == codes::STIFFNESS_DOUBTFUL;
        let [what_was_done, conclusion, next_step] = verdict;
        // Whatever else could be done next would rest on it.
        let next_step = if findings.iter().filter(serious).any(doubtful) {
            Text::default()
                .strong("Do not use these numbers")
                .words(": correct the readings behind the stiffness, identify again, and then this again.")
        } else {
            next_step
        };
        let serious = findings.iter().find(serious);
        let conclusion = match serious.filter(|_| AT_WORK.contains(&self.command)) {
            Some(serious) => {
                let text = Text::default().strong(serious.sentence.clone());
                if NOWHERE.contains(&serious.code.as_str()) { text } else { text.words(" As it is: ").then(conclusion) }
            }
            None => conclusion,
        };
        findings.sort_by_key(|finding| Reverse(finding.severity));
        let outcome = Outcome::of(&findings);
        // What rules the ± belongs to what came out.
        let (ruling, findings) = findings.into_iter().partition(|f| f.code == codes::NEVER_LOADED);
        let said = |conclusion: Text, f: &Finding| conclusion.words(format!(" {}", f.sentence));
        let ruling: Vec<Finding> = ruling;
        let conclusion = ruling.iter().fold(conclusion, said);
        Summary {
            heading: heading.into(),
            outcome,
            verdict: [what_was_done, conclusion, next_step],
            findings,
            key,
            sections,
        }
    }

    /// The cell in 3D at groups of postures; `None` where the cell is not at hand or cannot take them.
    ///
    /// # Errors
    /// As [`scene`].
    pub(super) fn scene(&self, groups: &[SceneGroup<'_>], options: &SceneOptions<'_>) -> Result<Option<Scene>> {
        let cell = self.cell.filter(|_| self.pictures);
        let made = cell.map(|cell| scene(cell, groups, options));
        made.transpose()
    }

    /// The same as a section, with a drawing of the first group for print; without the cell a sentence says how to
    /// have it.
    ///
    /// # Errors
    /// As [`scene`].
    pub(super) fn cell_section(&self, groups: &[PostureGroup], explained: &str) -> Result<Section> {
        let shown: Vec<SceneGroup<'_>> =
            groups.iter().map(|group| SceneGroup::new(&group.name, &group.postures)).collect();
        let scene = self.scene(&shown, &SceneOptions::default())?;
        Ok(self.scene_section(scene, explained))
    }

    /// A section with a scene that was made, and a drawing of its first group for print.
    pub(super) fn scene_section(&self, scene: Option<Scene>, explained: &str) -> Section {
        let blocks = match scene {
            _ if !self.pictures => Vec::new(),
            Some(scene) => {
                let drawing = scene.drawing(Some(0), Full::Tightest);
                vec![Block::Text(explained.into()), Block::Scene(Box::new(scene), Some(drawing))]
            }
            None => vec![Block::Text(
                Text::new("The cell of this result is not at hand, so it is not shown. ")
                    .code(format!("stiffarm report {} --cell cell.toml", self.file()))
                    .words(" shows it, with the cell file as it was when the result was made."),
            )],
        };
        Section::new("cell", "The cell in 3D", blocks)
    }

    /// The name of the result's file as one types it.
    fn file(&self) -> String {
        quoted(self.name)
    }
}

/// Findings of a result whose command may have been stopped, with what says so where nothing else does; `left_out` is
/// what was asked for and is not there.
pub(super) fn with_stopped(
    context: &Context<'_>,
    mut findings: Vec<Finding>,
    is_stopped: bool,
    left_out: &[&str],
) -> Vec<Finding> {
    let is_known = |f: &Finding| STOPPED.contains(&f.code.as_str());
    if (is_stopped || !left_out.is_empty()) && !findings.iter().any(is_known) {
        let left_out = match left_out {
            [] => String::new(),
            names => format!(" Not computed: {}.", list(names)),
        };
        let sentence = format!("The command was stopped before it was done; this is what it had by then.{left_out}");
        findings.push(Finding::caution(STOPPED[0], context.command, sentence));
    }
    findings
}

/// A word as a shell takes it; an input in braces stays as it is, so that it is seen to stand for a file.
pub(crate) fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "_./:=,@%+-{}".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        word.to_string()
    } else {
        format!("'{}'", visible(word).replace('\'', r"'\''"))
    }
}
