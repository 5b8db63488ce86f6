//! Robots that ship with the program, with sources and doubts.
//!
//! Both files are read at first use: `data/published.toml` holds those with published stiffness,
//! `data/robots.toml` the geometry of the others, made by `cargo xtask robots` from public robot
//! descriptions.

use super::Robot;
use super::entry::{CatalogueEntry, JointStiffness};
use crate::error::{Code, Error, Result, did_you_mean};
use serde::Deserialize;
use std::collections::HashMap;
use std::sync::LazyLock;

const PUBLISHED: &str = include_str!("../../../data/published.toml");
const DESCRIBED: &str = include_str!("../../../data/robots.toml");

/// One of the two files.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, bound(deserialize = "'de: 'static"))]
struct File {
    robot: Vec<CatalogueEntry>,
    /// Of robots of the other file, by their keys.
    #[serde(default)]
    stiffness: HashMap<String, Vec<JointStiffness>>,
}

static CATALOGUE: LazyLock<Vec<CatalogueEntry>> = LazyLock::new(|| {
    // Part of the program: where its tests have passed both are read.
    let [mut published, described]: [File; 2] =
        [PUBLISHED, DESCRIBED].map(|text| toml::from_str(text).expect("the embedded catalogue of robots is read"));
    published.robot.extend(described.robot);
    for entry in &mut published.robot {
        if let Some(sets) = published.stiffness.remove(entry.key) {
            entry.stiffness = sets.leak();
        }
    }
    published.robot
});

/// The embedded catalogue; the first entry is the default robot.
pub fn catalogue() -> &'static [CatalogueEntry] {
    &CATALOGUE
}

/// Finds an entry by its key, ignoring case.
///
/// # Errors
/// Unknown name; the hint has the nearest key.
pub fn find(key: &str) -> Result<&'static CatalogueEntry> {
    let entry = catalogue().iter().find(|e| e.key.eq_ignore_ascii_case(key));
    entry.ok_or_else(|| {
        let keys = catalogue().iter().map(|e| e.key);
        let hint = did_you_mean(key, keys).unwrap_or_else(|| "`stiffarm robots` lists the robots".to_string());
        Error::new(Code::UnknownName, format!("The catalogue has no robot \"{key}\".")).hint(hint)
    })
}

impl Robot {
    /// A robot of the catalogue by its key, for example `comau-nj165-3.0`.
    ///
    /// # Errors
    /// There is no robot of this key.
    pub fn from_catalogue(key: &str) -> Result<Robot> {
        find(key)?.robot()
    }
}
