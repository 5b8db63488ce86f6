//! Where a mesh that a URDF names lies: `package://`, `model://`, `file://` and plain paths,
//! without any program of ROS.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use stiffarm::error::{Code, Error, Result};
use stiffarm::findings::each_once;

/// Formats of meshes, by the end of the file's name.
const FORMATS: [&str; 3] = ["stl", "obj", "dae"];
/// Begin of a path whose first part is the name of a package or of a model.
const NAMED: [&str; 2] = ["package://", "model://"];
/// Files in which a package or a model says its name.
const SAYS_NAME: [&str; 2] = ["package.xml", "model.config"];
/// Folders within a given one that may be the package: workspaces hold repositories, and these packages.
const DEEPEST: usize = 3;

/// Folders in which meshes are looked for.
#[derive(Debug, Clone, Default)]
pub struct MeshFolders {
    /// The folder of the URDF: relative paths begin here, and a folder above it
    /// that has the name of a package is that package.
    pub urdf: PathBuf,
    /// Packages, or folders that hold them; relative paths that are not beside the URDF begin here, too.
    pub packages: Vec<PathBuf>,
}

impl MeshFolders {
    /// The file of a mesh that the URDF calls `path`. A relative path is looked for beside the URDF first. Of several
    /// packages of one name it is the first of those in the given folders, in their order, else the one nearest to
    /// the URDF.
    ///
    /// # Errors
    /// No such file, a format other than STL, OBJ and DAE, an address on the network; with what helps.
    pub fn find(&self, path: &str) -> Result<PathBuf> {
        let extension = Path::new(path).extension().map(|e| e.to_ascii_lowercase());
        if !extension.is_some_and(|e| FORMATS.iter().any(|format| e == *format)) {
            let message = format!("The mesh {path} is not of the formats STL, OBJ and DAE.");
            let hint = "convert it, and name the new file in the URDF; or go without shapes: --no-shapes";
            return Err(Error::new(Code::Unsupported, message).hint(hint));
        }
        let (wanted, hint) = self.wanted(path)?;
        let mesh_file = wanted.iter().find(|file| file.is_file());
        mesh_file.cloned().ok_or_else(|| {
            let looked: Vec<String> = wanted.iter().map(|w| w.display().to_string()).collect();
            let message = format!("The mesh {path} was not found. Looked for: {}.", looked.join(", "));
            Error::new(Code::FileRead, message).hint(hint + "; or go without shapes: --no-shapes")
        })
    }

    /// Where the mesh may be, the best place first, and what helps where it is not.
    fn wanted(&self, path: &str) -> Result<(Vec<PathBuf>, String)> {
        let named = NAMED.iter().find_map(|scheme| path.strip_prefix(scheme));
        let in_package = named.and_then(|named| named.split_once('/'));
        if let Some((package, rest)) = in_package.or_else(|| found_by_ros(path)) {
            let hint = format!("name the folder of {package}, or one that holds it, with --package-dir DIR");
            return Ok((self.in_packages(package, rest), hint));
        }
        if let Some(file) = path.strip_prefix("file:") {
            let file = file.strip_prefix("//").unwrap_or(file);
            let file = file.strip_prefix("localhost/").map_or(file.into(), |file| format!("/{file}"));
            let hint = "the URDF names this file by its whole path: correct it there".to_string();
            return Ok((vec![self.urdf.join(file)], hint));
        }
        let relative = named.unwrap_or(path);
        if let Some((scheme, _)) = relative.split_once("://") {
            let message = format!("The mesh {path} is not a file: {scheme}:// is not supported.");
            let hint = "get the file, and name it in the URDF; or go without shapes: --no-shapes";
            return Err(Error::new(Code::Unsupported, message).hint(hint));
        }
        let folders = std::iter::once(&self.urdf).chain(&self.packages);
        let wanted: Vec<PathBuf> = folders.map(|folder| folder.join(relative)).collect();
        let hint = if Path::new(relative).is_absolute() {
            "the URDF names this file by its whole path: correct it there".to_string()
        } else {
            "name the folder in which this path begins with --package-dir DIR".to_string()
        };
        Ok((each_once(&wanted), hint))
    }

    /// Where the packages of the given folders are, by their names.
    pub fn known(&self) -> BTreeMap<String, PathBuf> {
        let mut by_folder = BTreeMap::new();
        let mut by_name = BTreeMap::new();
        for folder in &self.packages {
            let folder = std::path::absolute(folder).unwrap_or_else(|_| folder.clone());
            for inner in std::iter::once(folder.clone()).chain(folders_in(&folder, DEEPEST)) {
                if let Some(name) = inner.file_name() {
                    let name = name.to_string_lossy().into_owned();
                    by_folder.entry(name).or_insert(inner.clone());
                }
                if let Some(name) = said_name(&inner) {
                    by_name.entry(name).or_insert(inner);
                }
            }
        }
        by_folder.extend(by_name);
        by_folder
    }

    fn in_packages(&self, package: &str, rest: &str) -> Vec<PathBuf> {
        let mut wanted: Vec<PathBuf> = Vec::new();
        for folder in &self.packages {
            wanted.push(folder.join(package).join(rest));
            // One that is another package has other meshes, perhaps of the same name.
            let name = said_name(folder);
            if name.as_deref().is_none_or(|name| name == package) {
                wanted.push(folder.join(rest));
            }
            if !wanted.iter().any(|file| file.is_file()) {
                let deeper = folders_in(folder, DEEPEST).into_iter();
                let deeper = deeper.filter(|folder| is_package(folder, package));
                wanted.extend(deeper.map(|folder| folder.join(rest)));
            }
        }
        // An empty path is the working folder.
        let urdf = std::path::absolute(self.urdf.join("."));
        let urdf = urdf.unwrap_or_else(|_| self.urdf.clone());
        let named = |folder: &&Path| is_package(folder, package);
        let enclosing = urdf.ancestors().filter(named).map(|folder| folder.join(rest));
        wanted.extend(enclosing);
        // A package beside the URDF's own.
        let beside = urdf.ancestors().map(|folder| folder.join(package));
        wanted.extend(beside.filter(|f| f.is_dir()).map(|folder| folder.join(rest)));
        if wanted.is_empty() {
            wanted.push(self.urdf.join(package).join(rest));
        }
        each_once(&wanted)
    }
}

/// Package and rest of `$(find NAME)/…`, which ROS would have replaced.
fn found_by_ros(path: &str) -> Option<(&str, &str)> {
    let command = path.strip_prefix("file://").unwrap_or(path);
    let (command, rest) = command.strip_prefix("$(find")?.split_once(")/")?;
    let package = command.strip_prefix("-pkg-share").unwrap_or(command);
    Some((package.trim(), rest))
}

/// Whether a folder is the package of a name: by what it says, or by its own name.
fn is_package(folder: &Path, package: &str) -> bool {
    folder.file_name().is_some_and(|name| name == package) || said_name(folder).as_deref() == Some(package)
}

/// The name that a package or model gives itself.
fn said_name(folder: &Path) -> Option<String> {
    let text = SAYS_NAME.iter().find_map(|file| std::fs::read_to_string(folder.join(file)).ok())?;
    let document = roxmltree::Document::parse(&text).ok()?;
    let root = document.root_element();
    let name = root.children().find(|child| child.has_tag_name("name"))?;
    name.text().map(|name| name.trim().to_string())
}

/// The folders within a folder, and those within them.
fn folders_in(folder: &Path, deep: usize) -> Vec<PathBuf> {
    let inner = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let inner = inner.filter(|entry| {
        let is_hidden = entry.file_name().to_string_lossy().starts_with('.');
        !is_hidden && entry.file_type().is_ok_and(|kind| kind.is_dir())
    });
    let mut inner: Vec<PathBuf> = inner.map(|entry| entry.path()).collect();
    inner.sort();
    if deep > 1 {
        let deeper: Vec<PathBuf> = inner.iter().flat_map(|f| folders_in(f, deep - 1)).collect();
        inner.extend(deeper);
    }
    inner
}
