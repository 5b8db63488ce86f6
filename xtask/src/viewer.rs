//! three.js as the pages of `stiffarm-report` carry it: one file, made by npm and esbuild from the versions that
//! `xtask/viewer/package-lock.json` pins.

use std::path::Path;
use std::process::{Command, Stdio};

use serde_json::Value;

use crate::files;
use crate::run::{Failure, Workspace};

const ASSETS: &str = "crates/stiffarm-report/assets";
const BUNDLE: &str = "three.min.js";
const LICENCE: &str = "three-LICENSE";

/// `cargo xtask viewer`: writes the bundle and its licence, or with `check` compares them.
pub fn run(workspace: &Workspace, check: bool) -> Result<(), Failure> {
    let folder = workspace.root().join("xtask/viewer");
    if !npm(&folder, &["--version"]).is_ok_and(|done| done) {
        println!("SKIPPED bundle of three.js: npm is not installed; fix: install Node.js with npm");
        return if check { Ok(()) } else { Err(Failure::already_told()) };
    }
    let steps: [&[&str]; 2] = [&["ci", "--ignore-scripts", "--no-audit", "--no-fund"], &["run", "--silent", "bundle"]];
    for step in steps {
        println!("npm {}", step.join(" "));
        if !npm(&folder, step)? {
            return Err(Failure::internal(
                format!("`npm {}` failed in {}", step.join(" "), folder.display()),
                "read what it printed above",
            ));
        }
    }
    let licence = files::text(&folder.join("node_modules/three/LICENSE"))?;
    let bundle = files::text(&folder.join("node_modules/bundle.js"))?;
    let bundle = with_licence(&version(workspace)?, &licence, &bundle);
    for (name, text) in [(BUNDLE, bundle), (LICENCE, licence)] {
        let path = workspace.root().join(ASSETS).join(name);
        if !check {
            files::write(&path, text)?;
            println!("wrote {ASSETS}/{name}");
        } else if files::text(&path)? != text {
            return Err(Failure::finding(
                format!("{ASSETS}/{name} is not what xtask/viewer gives"),
                "run `cargo xtask viewer` and commit what it writes",
            ));
        }
    }
    Ok(())
}

/// The licence stands in the bundle, so that it travels with every page.
fn with_licence(version: &str, licence: &str, bundle: &str) -> String {
    let licence = licence.trim_end();
    format!("/*! three.js {version}, https://threejs.org\n\n{licence}\n*/\n{bundle}")
}

/// The version of three.js that `package.json` pins.
fn version(workspace: &Workspace) -> Result<String, Failure> {
    let path = "xtask/viewer/package.json";
    let text = files::text(&workspace.root().join(path))?;
    let manifest: Value = serde_json::from_str(&text).unwrap_or_default();
    let version = manifest["dependencies"]["three"].as_str();
    version
        .map(String::from)
        .ok_or_else(|| Failure::finding(format!("{path} names no version of three"), "name it among its dependencies"))
}

/// Runs npm in a folder; false where it fails.
fn npm(folder: &Path, arguments: &[&str]) -> Result<bool, Failure> {
    let program = if cfg!(windows) { "npm.cmd" } else { "npm" };
    let status =
        Command::new(program).args(arguments).current_dir(folder).stdin(Stdio::null()).stdout(Stdio::null()).status();
    status
        .map(|status| status.success())
        .map_err(|error| Failure::internal(format!("npm could not be started: {error}"), "install Node.js with npm"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_committed_bundle_carries_its_licence_and_cannot_end_a_script_element() {
        let workspace = Workspace::find().unwrap();
        let assets = workspace.root().join(ASSETS);
        let bundle = files::text(&assets.join(BUNDLE)).unwrap();
        let licence = files::text(&assets.join(LICENCE)).unwrap();
        let head = with_licence(&version(&workspace).unwrap(), &licence, "");
        assert!(bundle.starts_with(&head), "{}", &bundle[..200]);
        let bundle = bundle.to_lowercase();
        assert!(!bundle.contains("</script") && !bundle.contains("<!--"));
    }
}
