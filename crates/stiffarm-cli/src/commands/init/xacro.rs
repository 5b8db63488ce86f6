//! xacro files, by the program that is there for them.

use crate::files::ends_in;
use std::io::ErrorKind;
use std::path::Path;
use std::process::{Command, Stdio};
use stiffarm::{Code, Error, Result};

/// Lines of xacro's own complaint that are passed on.
const LINES: usize = 6;

/// True for a file that xacro must expand.
pub fn is_one(path: &str) -> bool {
    ends_in(path, "xacro")
}

/// The URDF that a xacro file stands for; `name` is the file's for messages.
///
/// # Errors
/// There is no program xacro, or it refuses the file.
pub fn expanded(path: &str, name: &str) -> Result<String> {
    // A name that begins with a sign is no option.
    let path = if path.starts_with('-') {
        Path::new(".").join(path)
    } else {
        path.into()
    };
    let ran = Command::new("xacro")
        .arg(path)
        .stdin(Stdio::null())
        .output();
    let output = ran.map_err(|error| match error.kind() {
        ErrorKind::NotFound => {
            let message = "This is a xacro file, and the program xacro was not found.";
            Error::new(Code::Unsupported, message).file(name).hint(
                "install it with `pip install xacro`, or expand the file yourself: xacro FILE > robot.urdf",
            )
        }
        _ => Error::new(
            Code::FileRead,
            format!("The program xacro could not be started: {error}."),
        )
        .file(name),
    })?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        let lines: Vec<&str> = said.lines().map(str::trim_end).collect();
        let last = lines[lines.len().saturating_sub(LINES)..].join("\n  ");
        let message = format!("xacro could not expand the file. It says:\n  {last}");
        return Err(Error::new(Code::FileRead, message)
            .file(name)
            .hint("packages that it looks up must be known to it; or expand the file yourself: xacro FILE > robot.urdf"));
    }
    String::from_utf8(output.stdout).map_err(|_| {
        let message = "What xacro made of the file is not UTF-8.";
        Error::new(Code::Encoding, message).file(name)
    })
}
