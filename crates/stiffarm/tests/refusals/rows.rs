//! The rows of `refusals.toml` for the tests of every floor: each with its inputs as bytes.
#![allow(dead_code, reason = "each floor uses its own part")]

use serde::Deserialize;
use std::collections::BTreeMap;
use stiffarm_files::builtin;

/// A wrong line with its inputs, and what is known of its error.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Row {
    /// What is wrong.
    pub what: String,
    /// Words of the command.
    pub line: String,
    #[serde(default)]
    files: BTreeMap<String, String>,
    #[serde(default)]
    bytes: BTreeMap<String, Vec<u8>>,
    #[serde(default)]
    cell: Vec<[String; 2]>,
    #[serde(default)]
    mark: bool,
    #[serde(default)]
    workbook: bool,
    /// The error's code.
    pub code: String,
    /// The error's place.
    pub at: String,
    /// What the library reads by itself.
    pub reader: Option<String>,
    /// Why Python has no such call.
    #[serde(rename = "not_python")]
    _not_python: Option<String>,
    /// Code and key where Python refuses it before the command is asked.
    #[serde(rename = "python")]
    _python: Option<BTreeMap<String, String>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Table {
    files: BTreeMap<String, String>,
    refusal: Vec<Row>,
}

/// All rows, each with the files that its line names.
pub fn rows() -> Vec<Row> {
    let Table { files, mut refusal } = toml::from_str(include_str!("refusals.toml")).unwrap();
    for row in &mut refusal {
        let named = files.iter().filter(|(name, _)| row.line.split(' ').any(|word| word == *name));
        let named: BTreeMap<String, String> = named.map(|(name, text)| (name.clone(), text.clone())).collect();
        row.files.extend(named);
    }
    refusal
}

impl Row {
    /// Its inputs by name.
    pub fn inputs(&self) -> BTreeMap<String, Vec<u8>> {
        let texts = self.files.iter().map(|(name, text)| (name.clone(), text.clone().into_bytes()));
        let mut inputs: BTreeMap<String, Vec<u8>> = texts.chain(self.bytes.clone()).collect();
        if !self.cell.is_empty() {
            let mut text = builtin::cell_text("comau").unwrap().to_string();
            for [from, to] in &self.cell {
                assert!(text.contains(from), "{}: {from}", self.what);
                text = text.replace(from, to);
            }
            let mark = if self.mark { "\u{feff}" } else { "" };
            inputs.insert("cell.toml".to_string(), format!("{mark}{text}").into_bytes());
        }
        if self.workbook {
            inputs.insert("readings.xlsx".to_string(), include_bytes!("../golden/xlsx/readings.xlsx").to_vec());
        }
        inputs
    }
}
