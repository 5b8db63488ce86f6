//! The executable whose outputs are kept.

use std::path::{Path, PathBuf};

use super::absolute;
use crate::run::{Failure, Workspace};

/// An executable that is there.
pub fn given(path: &Path) -> Result<PathBuf, Failure> {
    let path = absolute(path)?;
    if path.is_file() {
        return Ok(path);
    }
    Err(Failure::usage(
        format!("`--binary {}`: there is no such file", path.display()),
        "name the executable, for example target/release/stiffarm",
    ))
}

/// Builds `stiffarm` and says where cargo has put it.
pub fn built(workspace: &Workspace) -> Result<PathBuf, Failure> {
    let build = workspace.cargo(&[
        "build",
        "--release",
        "--locked",
        "--package",
        "stiffarm-cli",
        "--message-format=json-render-diagnostics",
    ]);
    let messages = build.output()?;
    executable(&String::from_utf8_lossy(&messages)).ok_or_else(|| {
        Failure::internal(
            format!("`{build}` does not say where the executable is"),
            "build it yourself and name it with --binary",
        )
    })
}

/// The path of the executable in cargo's messages, one JSON object a line.
fn executable(messages: &str) -> Option<PathBuf> {
    let lines = messages.lines();
    let mut programs = lines.filter(|line| line.contains(r#""kind":["bin"]"#));
    let path = programs.find_map(|line| {
        let (_, rest) = line.split_once(r#""executable":""#)?;
        Some(rest.split_once('"')?.0)
    })?;
    Some(PathBuf::from(path.replace(r"\\", r"\")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_executable_is_found_in_the_messages_of_cargo() {
        let library = r#"{"target":{"kind":["lib"],"name":"stiffarm"},"executable":null}"#;
        let script = r#"{"target":{"kind":["custom-build"]},"executable":null}"#;
        let program =
            r#"{"target":{"kind":["bin"]},"executable":"C:\\out\\stiffarm.exe","fresh":true}"#;
        let finished = r#"{"reason":"build-finished","success":true}"#;
        let messages = [library, script, program, finished].join("\n");
        let expected = PathBuf::from(r"C:\out\stiffarm.exe");
        assert_eq!(executable(&messages), Some(expected));
        assert_eq!(executable(finished), None);
    }

    #[test]
    fn a_binary_that_is_not_there_is_wrong_usage() {
        let failure = given(Path::new("no-such-binary")).unwrap_err();
        assert_eq!(failure.code, 2);
        assert!(failure.message.ends_with("there is no such file"));
    }
}
