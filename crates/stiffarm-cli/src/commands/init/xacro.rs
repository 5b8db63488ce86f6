//! xacro files, by the program that is there for them.

use crate::files::ends_in;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::atomic::{AtomicUsize, Ordering};
use stiffarm::{Code, Error, Result};
use stiffarm_files::urdf::MeshFolders;

/// Lines of xacro's own complaint that are passed on.
const LINES: usize = 6;

/// True for a file that xacro must expand.
pub fn is_one(path: &str) -> bool {
    ends_in(path, "xacro")
}

/// Module of Python by which xacro looks packages up; that of ROS, where there is one.
const LOOK_UP: &str = "ament_index_python";

/// The URDF that a xacro file stands for; `name` is the file's for messages. Packages that xacro does not know are
/// looked for in `packages`.
///
/// # Errors
/// There is no program xacro, or it refuses the file.
pub fn expanded(path: &str, name: &str, packages: &[PathBuf]) -> Result<String> {
    let mut output = run(path, name, None)?;
    if !output.status.success() && !packages.is_empty() {
        let folders = MeshFolders { packages: packages.to_vec(), ..MeshFolders::default() };
        let look_up = OwnLookUp::new(&folders).map_err(|error| {
            let message = format!("Where packages are could not be told to xacro: {error}.");
            Error::new(Code::FileWrite, message).file(name)
        })?;
        output = run(path, name, Some(&look_up.0))?;
    }
    if !output.status.success() {
        return Err(refused(name, &String::from_utf8_lossy(&output.stderr), packages));
    }
    String::from_utf8(output.stdout).map_err(|_| {
        let message = "What xacro made of the file is not UTF-8.";
        Error::new(Code::Encoding, message).file(name)
    })
}

/// Number of the next folder with a look-up.
static NEXT: AtomicUsize = AtomicUsize::new(0);

/// A folder with a look-up of packages of our own, which goes with this value.
struct OwnLookUp(PathBuf);

impl OwnLookUp {
    fn new(folders: &MeshFolders) -> std::io::Result<Self> {
        // Runs in one process have folders of their own.
        let number = NEXT.fetch_add(1, Ordering::Relaxed);
        let name = format!("stiffarm-xacro-{}-{number}", std::process::id());
        let folder = std::env::temp_dir().join(name);
        std::fs::create_dir(&folder)?;
        let look_up = OwnLookUp(folder);
        let module = look_up.0.join(LOOK_UP);
        std::fs::create_dir(&module)?;
        // An object of JSON with strings is one of Python.
        let packages = serde_json::to_string(&folders.known())?;
        let text = format!(
            "known = {packages}\n\n\ndef get_package_share_directory(name):\n    if name not in known:\n        \
             raise LookupError(f\"no package {{name}} in --package-dir\")\n    return known[name]\n"
        );
        std::fs::write(module.join("__init__.py"), "")?;
        std::fs::write(module.join("packages.py"), text)?;
        Ok(look_up)
    }
}

impl Drop for OwnLookUp {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// What xacro did not accept, and what helps.
fn refused(name: &str, said: &str, packages: &[PathBuf]) -> Error {
    let lines: Vec<&str> = said.lines().map(str::trim_end).collect();
    let last = lines[lines.len().saturating_sub(LINES)..].join("\n  ");
    let message = format!("xacro could not expand the file. It says:\n  {last}");
    let is_lookup = [LOOK_UP, "rospkg", "ackage"].iter().any(|word| said.contains(word));
    let hint = match (is_lookup, packages.is_empty()) {
        (true, true) => {
            "$(find NAME) asks for a package: without ROS say where it is with --package-dir DIR, its folder or one \
             that holds it"
        }
        (true, false) => {
            "$(find NAME) asks for a package that is in no --package-dir: give the folder that holds it, too"
        }
        (false, _) => "mend the file, or expand it yourself: xacro FILE > robot.urdf",
    };
    Error::new(Code::FileRead, message).file(name).hint(hint)
}

/// Runs xacro, with a folder of modules of Python where one is given.
fn run(path: &str, name: &str, modules: Option<&Path>) -> Result<Output> {
    // A name that begins with a sign is no option.
    let path = if path.starts_with('-') { Path::new(".").join(path) } else { path.into() };
    let mut command = Command::new("xacro");
    command.arg(path).stdin(Stdio::null());
    if let Some(modules) = modules {
        let before = std::env::var_os("PYTHONPATH");
        let all = std::iter::once(modules.to_path_buf());
        let all = all.chain(before.iter().flat_map(std::env::split_paths));
        if let Ok(all) = std::env::join_paths(all) {
            command.env("PYTHONPATH", all);
        }
    }
    command.output().map_err(|error| match error.kind() {
        ErrorKind::NotFound => {
            let message = "This is a xacro file, and the program xacro was not found.";
            Error::new(Code::Unsupported, message)
                .file(name)
                .hint("install it with `pip install xacro`, or expand the file yourself: xacro FILE > robot.urdf")
        }
        _ => Error::new(Code::FileRead, format!("The program xacro could not be started: {error}.")).file(name),
    })
}
