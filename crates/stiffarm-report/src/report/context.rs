//! What the pages of all results share.

use crate::cell::{Full, cell_drawing};
use crate::page::{Block, DataTable, Number, Outcome, Part, Provenance, Section, Text};
use crate::scene::{Scene, SceneGroup, SceneOptions, scene};
use crate::tell::{Given, Told};
use serde_json::Value;
use stiffarm::Result;
use stiffarm::files::result::SavedResult;
use stiffarm::findings::{Finding, Severity, list, visible};
use stiffarm::model::cell::Cell;
use stiffarm::model::posture::{Posture, PostureGroup};

/// Commands whose numbers come after what forbids to use them.
const AT_WORK: [&str; 4] = ["validate", "predict", "compensate", "map"];

/// Codes of findings that a command was stopped.
const STOPPED: [&str; 2] = ["interrupted", "stopped"];

impl Given<'_> {
    /// Cell and robot in words.
    pub(super) fn cell_line(&self) -> Option<String> {
        let cell = self.cell?;
        Some(format!(
            "{} · robot {}",
            visible(&cell.name),
            visible(cell.setup.robot.name())
        ))
    }
}

/// A result while its page is made.
pub(super) struct Context<'a> {
    pub saved: &'a SavedResult,
    pub cell: Option<&'a Cell>,
}

impl<'a> Context<'a> {
    pub fn new(given: &Given<'a>) -> Self {
        Context {
            saved: given.saved,
            cell: given.cell,
        }
    }

    /// The number at a JSON Pointer below `/result`.
    pub fn number(&self, below: &str) -> Number {
        self.given().number(below)
    }

    /// The result with its cell.
    pub fn given(&self) -> Given<'a> {
        Given {
            saved: self.saved,
            cell: self.cell,
        }
    }

    /// The part of a page for what a result says.
    pub fn told(&self, told: Told) -> Part {
        let is_note = |finding: &Finding| finding.severity == Severity::Note;
        let (notes, warnings): (Vec<Finding>, Vec<Finding>) =
            told.findings.into_iter().partition(is_note);
        let mut sections = told.sections;
        if !notes.is_empty() {
            let block = Block::Findings(notes);
            sections.push(Section::new("notes", "Notes", vec![block]));
        }
        Part {
            command: self.saved.command.clone(),
            heading: told.heading,
            name: visible(&self.saved.name).into_owned(),
            outcome: told.outcome,
            verdict: told.verdict,
            warnings,
            key: Some(told.key),
            sections,
            provenance: provenance(self.saved),
        }
    }

    /// The parts that all results have, around what is their own.
    pub fn part(
        &self,
        heading: String,
        verdict: [Text; 3],
        key: Option<DataTable>,
        sections: Vec<Section>,
    ) -> Part {
        let findings = self.saved.findings();
        let doubtful = findings
            .iter()
            .any(|f| f.code == "stiffness-doubtful" && f.severity == Severity::Serious);
        let [done, came, next] = verdict;
        // Whatever else could be done next would rest on it.
        let next = match doubtful {
            true => Text::default().strong("Do not use these numbers").words(
                ": correct the readings behind the stiffness, identify again, and then this again.",
            ),
            false => next,
        };
        let serious = findings.iter().find(|f| f.severity == Severity::Serious);
        let came = match serious.filter(|_| AT_WORK.contains(&self.saved.command.as_str())) {
            Some(serious) => Text::default()
                .strong(serious.sentence.clone())
                .words(" As it is: ")
                .then(came),
            None => came,
        };
        let verdict = [done, came, next];
        let (mut warnings, notes): (Vec<Finding>, Vec<Finding>) = findings
            .into_iter()
            .partition(|finding| finding.severity > Severity::Note);
        warnings.extend(stopped(self.saved));
        let outcome = Outcome::of(&warnings);
        warnings.sort_by_key(|finding| std::cmp::Reverse(finding.severity));
        let mut sections = sections;
        if !notes.is_empty() {
            let block = Block::Findings(notes);
            sections.push(Section::new("notes", "Notes", vec![block]));
        }
        Part {
            command: self.saved.command.clone(),
            heading,
            name: visible(&self.saved.name).into_owned(),
            outcome,
            verdict,
            warnings,
            key,
            sections,
            provenance: provenance(self.saved),
        }
    }

    /// The same with one more thing to look at, where there is one.
    pub fn caution(mut part: Part, sentence: Option<&str>) -> Part {
        let subject = part.command.clone();
        part.add_warnings(
            sentence.map(|sentence| Finding::new("page", Severity::Caution, subject, sentence)),
        );
        part
    }

    /// The cell in 3D at groups of postures; `None` where the cell is not at hand or cannot take them.
    ///
    /// # Errors
    /// As [`scene`].
    pub fn scene(
        &self,
        groups: &[SceneGroup<'_>],
        options: &SceneOptions<'_>,
    ) -> Result<Option<Scene>> {
        let made = self.cell.map(|cell| scene(cell, groups, options));
        made.transpose()
    }

    /// The same as a section, with a drawing of the first group for print; without the cell a sentence says how to
    /// have it.
    ///
    /// # Errors
    /// As [`scene`].
    pub fn cell_section(&self, groups: &[PostureGroup], explained: &str) -> Result<Section> {
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
    pub fn scene_section(
        &self,
        scene: Option<Scene>,
        drawn: &[Posture],
        explained: &str,
    ) -> Result<Section> {
        let blocks = match (scene, self.cell) {
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
        (sizes, &options["postures"]),
        (result["split_count"].as_u64(), &result["options"]["splits"]),
    ];
    let shorter = counts
        .iter()
        .any(|(done, asked)| done.is_some_and(|done| asked.as_u64() > Some(done)));
    if left_out.is_empty() && !shorter && !is_interrupted(result) {
        return None;
    }
    let left_out = match left_out.is_empty() {
        true => String::new(),
        false => format!(" Not computed: {}.", list(&left_out).replace('_', " ")),
    };
    let sentence = format!(
        "The command was stopped before it was done; the page shows what it had by then.{left_out}"
    );
    let is_known = |f: &Finding| STOPPED.contains(&f.code.as_str());
    let known = saved.findings().iter().any(is_known);
    (!known).then(|| Finding::new(STOPPED[0], Severity::Caution, &saved.command, sentence))
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

/// How a result was made.
fn provenance(saved: &SavedResult) -> Provenance {
    let mut options = Vec::new();
    flatten("", &saved.json["options"], &mut options);
    let words = saved.arguments.iter().map(|word| quoted(word));
    let words: Vec<String> = words.collect();
    let command_line = match saved.arguments.as_slice() {
        [] => String::new(),
        [call] if call.starts_with("stiffarm.") => visible(call).into_owned(),
        _ => format!("stiffarm {}", words.join(" ")),
    };
    Provenance {
        version: visible(&saved.version).into_owned(),
        seed: saved.seed,
        command_line,
        inputs: saved.inputs.clone(),
        options,
    }
}

/// Options by their key path.
fn flatten(path: &str, value: &Value, out: &mut Vec<(String, String)>) {
    match value {
        Value::Object(map) => {
            for (key, value) in map {
                let path = match path.is_empty() {
                    true => key.clone(),
                    false => format!("{path}.{key}"),
                };
                flatten(&path, value, out);
            }
        }
        Value::Null => out.push((path.to_string(), "–".to_string())),
        Value::String(text) => out.push((path.to_string(), visible(text).into_owned())),
        Value::Array(items) if items.is_empty() => out.push((path.to_string(), "none".to_string())),
        Value::Array(items) => {
            let items: Vec<String> = items.iter().map(plain).collect();
            out.push((path.to_string(), items.join(", ")));
        }
        other => out.push((path.to_string(), other.to_string())),
    }
}

fn plain(value: &Value) -> String {
    match value {
        Value::String(text) => visible(text).into_owned(),
        other => other.to_string(),
    }
}

/// A word as a shell takes it; an input in braces stays as it is, so that it is seen to stand for a file.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "_./:=,@%+-{}".contains(c);
    match !word.is_empty() && word.chars().all(is_plain) {
        true => word.to_string(),
        false => format!("'{}'", visible(word).replace('\'', r"'\''")),
    }
}
