//! Files of an earlier study in the same folder: none stays beside a new page.

use serde_json::Value;
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use stiffarm_report::study::slug;

/// Figures and tables that every study has had since there are studies.
const ALWAYS: [&str; 13] = [
    "classical-q1.svg",
    "deviation-by-noise.svg",
    "expected-deviation.csv",
    "expected-deviation.svg",
    "illustration-case.csv",
    "indices.csv",
    "other-starts.csv",
    "other-starts.svg",
    "postures.csv",
    "simulation.csv",
    "stiffness.csv",
    "validation.csv",
    "validation.svg",
];

/// Names of the files that an earlier study wrote, by its own list.
pub struct Earlier(BTreeSet<String>);

impl Earlier {
    /// The study in `folder`; nothing where there is none.
    pub fn of(folder: &Path) -> Self {
        let text = fs::read_to_string(folder.join("study.json")).unwrap_or_default();
        let value: Value = serde_json::from_str(&text).unwrap_or_default();
        if value["command"] != "study" {
            return Earlier(BTreeSet::new());
        }
        let text = |value: &Value| value.as_str().map(String::from);
        let names: BTreeSet<String> = match value["result"]["files"].as_array() {
            Some(files) => files.iter().filter_map(text).collect(),
            // Before the list existed.
            None => {
                let groups = value["result"]["groups"].as_array();
                let groups = groups.into_iter().flatten();
                let pictures = groups.filter_map(|group| text(&group["name"]));
                let pictures = pictures.map(|name| format!("postures-{}.svg", slug(&name)));
                ALWAYS.map(String::from).into_iter().chain(pictures).collect()
            }
        };
        Earlier(names.into_iter().filter(|name| is_ours(name)).collect())
    }

    /// Removes those that the new study has not replaced, and says so. A file that
    /// cannot be removed is named: it belongs to no page any more.
    pub fn remove_all_but(&self, folder: &Path, new: &[String]) -> String {
        let (mut removed, mut left) = (0, Vec::new());
        for name in self.0.iter().filter(|name| !new.contains(name)) {
            let path = folder.join(name);
            // Links and folders under that name are not what was written.
            if !fs::symlink_metadata(&path).is_ok_and(|meta| meta.is_file()) {
                continue;
            }
            match fs::remove_file(&path) {
                Ok(()) => removed += 1,
                Err(_) => left.push(name.as_str()),
            }
        }
        let mut out = String::new();
        if removed > 0 {
            out += &format!("removed {removed} files of the earlier study that this one has not\n");
        }
        if !left.is_empty() {
            out += &format!("these files of an earlier study could not be removed: {}\n", left.join(", "));
        }
        out
    }
}

/// A plain file name with one of the endings that a study writes, or the page of a study before it was one to look at
/// in a browser.
fn is_ours(name: &str) -> bool {
    let plain = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '.';
    let endings = [".svg", ".csv"];
    let is_known = name == "study.md" || endings.iter().any(|ending| name.ends_with(ending));
    name.chars().all(plain) && !name.starts_with('.') && is_known
}
