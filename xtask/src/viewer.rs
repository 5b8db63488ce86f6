//! three.js as the pages of `stiffarm-report` carry it: one file, made by npm and esbuild from the versions that
//! `xtask/viewer/package-lock.json` pins.

use std::path::Path;
use std::process::{Command, Stdio};

use crate::run::{Failure, Workspace};

const ASSETS: &str = "crates/stiffarm-report/assets";
const BUNDLE: &str = "three.min.js";
const LICENCE: &str = "three-LICENSE";

/// `cargo xtask viewer`: writes the bundle and its licence, or with `check` compares them.
pub fn run(workspace: &Workspace, check: bool) -> Result<(), Failure> {
    let folder = workspace.root().join("xtask/viewer");
    if !npm(&folder, &["--version"]).is_ok_and(|done| done) {
        println!("SKIPPED bundle of three.js: npm is not installed; fix: install Node.js with npm");
        return match check {
            true => Ok(()),
            false => Err(Failure::already_told()),
        };
    }
    let steps: [&[&str]; 2] = [
        &["ci", "--ignore-scripts", "--no-audit", "--no-fund"],
        &["run", "--silent", "bundle"],
    ];
    for step in steps {
        println!("npm {}", step.join(" "));
        if !npm(&folder, step)? {
            return Err(Failure::internal(
                format!("`npm {}` failed in {}", step.join(" "), folder.display()),
                "read what it printed above",
            ));
        }
    }
    let licence = read(&folder.join("node_modules/three/LICENSE"))?;
    let bundle = read(&folder.join("node_modules/bundle.js"))?;
    let version = version(&read(&folder.join("package.json"))?)?;
    let files = [
        (BUNDLE, with_licence(&version, &licence, &bundle)),
        (LICENCE, licence),
    ];
    for (name, text) in files {
        let path = workspace.root().join(ASSETS).join(name);
        if !check {
            std::fs::write(&path, text).map_err(|error| {
                Failure::internal(
                    format!("{} could not be written: {error}", path.display()),
                    "check the rights on the checkout",
                )
            })?;
            println!("wrote {ASSETS}/{name}");
        } else if read(&path)? != text {
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
fn version(manifest: &str) -> Result<String, Failure> {
    let line = manifest.lines().find_map(|line| {
        let line = line.trim().strip_prefix("\"three\": \"")?;
        line.split('"').next()
    });
    line.map(String::from).ok_or_else(|| {
        Failure::finding(
            "xtask/viewer/package.json names no version of three",
            "write \"three\": \"VERSION\" on a line of its own",
        )
    })
}

/// Runs npm in a folder; false where it fails.
fn npm(folder: &Path, arguments: &[&str]) -> Result<bool, Failure> {
    let program = if cfg!(windows) { "npm.cmd" } else { "npm" };
    let status = Command::new(program)
        .args(arguments)
        .current_dir(folder)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .status();
    status.map(|status| status.success()).map_err(|error| {
        Failure::internal(
            format!("npm could not be started: {error}"),
            "install Node.js with npm",
        )
    })
}

fn read(path: &Path) -> Result<String, Failure> {
    std::fs::read_to_string(path).map_err(|error| {
        Failure::internal(
            format!("{} could not be read: {error}", path.display()),
            "check that the checkout is complete",
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_committed_bundle_says_version_and_licence_of_the_manifest() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let manifest = read(&root.join("xtask/viewer/package.json")).unwrap();
        let bundle = read(&root.join(ASSETS).join(BUNDLE)).unwrap();
        let licence = read(&root.join(ASSETS).join(LICENCE)).unwrap();
        let head = with_licence(&version(&manifest).unwrap(), &licence, "");
        assert!(bundle.starts_with(&head), "{}", &bundle[..200]);
    }

    #[test]
    fn the_committed_bundle_cannot_end_a_script_element() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let bundle = read(&root.join(ASSETS).join(BUNDLE)).unwrap();
        let bundle = bundle.to_lowercase();
        assert!(!bundle.contains("</script") && !bundle.contains("<!--"));
    }
}
