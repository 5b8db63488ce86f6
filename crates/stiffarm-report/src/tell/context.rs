//! What the tellings of all results share.

use super::{Block, DataTable, Given, Outcome, Section, Text, Told};
use crate::cell::{Full, cell_drawing};
use crate::scene::{Scene, SceneGroup, SceneOptions, scene};
use serde_json::Value;
use std::cmp::Reverse;
use stiffarm::Result;
use stiffarm::findings::{Finding, Severity, codes, list, visible};
use stiffarm::model::posture::{Posture, PostureGroup};
use stiffarm_files::result::SavedResult;

/// Commands whose numbers come after what forbids to use them.
const AT_WORK: [&str; 4] = ["validate", "predict", "compensate", "map"];

/// Codes of findings that are the result, and not about its numbers.
const NOWHERE: [&str; 2] = [codes::NOTHING_REACHABLE, codes::NOWHERE];

/// Codes of findings that a command was stopped.
const STOPPED: [&str; 2] = ["interrupted", "stopped"];

impl<'a> Given<'a> {
    /// Cell and robot in words.
    pub(crate) fn cell_line(&self) -> Option<String> {
        let cell = self.cell?;
        Some(format!(
            "{} · robot {}",
            visible(&cell.name),
            visible(cell.setup.robot.name())
        ))
    }

    /// What all results say, around what is their own.
    pub(super) fn told(
        &self,
        heading: impl Into<String>,
        verdict: [Text; 3],
        key: Option<DataTable>,
        sections: Vec<Section>,
    ) -> Told {
        let mut findings = self.saved.findings();
        let serious = |f: &&Finding| f.severity == Severity::Serious;
        let doubtful = |f: &Finding| f.code == codes::STIFFNESS_DOUBTFUL;
        let [done, came, next] = verdict;
        // Whatever else could be done next would rest on it.
        let next = if findings.iter().filter(serious).any(doubtful) {
            Text::default().strong("Do not use these numbers").words(
                ": correct the readings behind the stiffness, identify again, and then this again.",
            )
        } else {
            next
        };
        let serious = findings.iter().find(serious);
        let came = match serious.filter(|_| AT_WORK.contains(&self.saved.command.as_str())) {
            Some(serious) => {
                let text = Text::default().strong(serious.sentence.clone());
                if NOWHERE.contains(&serious.code.as_str()) {
                    text
                } else {
                    text.words(" As it is: ").then(came)
                }
            }
            None => came,
        };
        findings.extend(stopped(self.saved));
        findings.sort_by_key(|finding| Reverse(finding.severity));
        let outcome = Outcome::of(&findings);
        // What rules the ± belongs to what came out.
        let (ruling, findings) = findings
            .into_iter()
            .partition(|f| f.code == codes::NEVER_LOADED);
        let said = |came: Text, f: &Finding| came.words(format!(" {}", f.sentence));
        let ruling: Vec<Finding> = ruling;
        let came = ruling.iter().fold(came, said);
        Told {
            heading: heading.into(),
            outcome,
            verdict: [done, came, next],
            findings,
            key,
            sections,
        }
    }

    /// The cell in 3D at groups of postures; `None` where the cell is not at hand or cannot take them.
    ///
    /// # Errors
    /// As [`scene`].
    pub(super) fn scene(
        &self,
        groups: &[SceneGroup<'_>],
        options: &SceneOptions<'_>,
    ) -> Result<Option<Scene>> {
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
        let shown: Vec<SceneGroup<'_>> = groups
            .iter()
            .map(|group| SceneGroup::new(&group.name, &group.postures))
            .collect();
        let scene = self.scene(&shown, &SceneOptions::default())?;
        let first = groups.first().map_or(&[][..], |group| &group.postures);
        self.scene_section(scene, first, explained)
    }

    /// A section with a scene that was made; `drawn` are the postures of the drawing for print.
    ///
    /// # Errors
    /// As [`cell_drawing`].
    pub(super) fn scene_section(
        &self,
        scene: Option<Scene>,
        drawn: &[Posture],
        explained: &str,
    ) -> Result<Section> {
        let blocks = match (scene, self.cell) {
            _ if !self.pictures => Vec::new(),
            (Some(scene), Some(cell)) => {
                let drawing = cell_drawing(cell, drawn, Full::Tightest)?;
                vec![
                    Block::Text(explained.into()),
                    Block::Scene(Box::new(scene), Some(drawing)),
                ]
            }
            _ => vec![Block::Text(
                Text::new("The cell of this result is not at hand, so it is not shown. ")
                    .code(format!("stiffarm report {} --cell cell.toml", self.file()))
                    .words(" shows it, with the cell file as it was when the result was made."),
            )],
        };
        Ok(Section::new("cell", "The cell in 3D", blocks))
    }

    /// The name of the result's file as one types it.
    fn file(&self) -> String {
        quoted(&self.saved.name)
    }
}

/// Says of a result whose command was stopped that a part of it is missing, where nothing else says so.
fn stopped(saved: &SavedResult) -> Option<Finding> {
    let (result, options) = (&saved.json["result"], &saved.json["options"]);
    let left_out = result["not_computed"].as_array();
    let mut left_out: Vec<String> = left_out.into_iter().flatten().map(plain).collect();
    // What was asked for and is not there, with nothing that says why.
    let asked = ["sensitivity", "prices"].into_iter();
    left_out.extend(
        asked
            .filter(|key| options[*key] == true && result[*key].is_null())
            .map(String::from),
    );
    let sizes = result["sizes"].as_array().map(|sizes| sizes.len() as u64);
    let counts = [
        (sizes, &result["largest"]),
        (result["split_count"].as_u64(), &result["options"]["splits"]),
    ];
    let shorter = counts
        .iter()
        .any(|(done, asked)| done.is_some_and(|done| asked.as_u64() > Some(done)));
    if left_out.is_empty() && !shorter && !is_interrupted(result) {
        return None;
    }
    let left_out = if left_out.is_empty() {
        String::new()
    } else {
        format!(" Not computed: {}.", list(&left_out).replace('_', " "))
    };
    let sentence = format!(
        "The command was stopped before it was done; this is what it had by then.{left_out}"
    );
    let is_known = |f: &Finding| STOPPED.contains(&f.code.as_str());
    let known = saved.findings().iter().any(is_known);
    (!known).then(|| Finding::caution(STOPPED[0], &saved.command, sentence))
}

/// Whether some part of a result says that it ended early because the user wanted so.
fn is_interrupted(value: &Value) -> bool {
    match value {
        Value::Object(map) => {
            map.get("interrupted") == Some(&Value::Bool(true))
                || map
                    .get("termination")
                    .is_some_and(|end| end == "interrupted")
                || map.values().any(is_interrupted)
        }
        Value::Array(items) => items.iter().any(is_interrupted),
        _ => false,
    }
}

pub(crate) fn plain(value: &Value) -> String {
    match value {
        Value::String(text) => visible(text).into_owned(),
        other => other.to_string(),
    }
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
