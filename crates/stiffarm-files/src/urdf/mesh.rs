//! Where a mesh that a URDF names lies: `package://`, `file://` and plain paths,
//! without any program of ROS.

use std::path::{Path, PathBuf};
use stiffarm::error::{Code, Error, Result};

/// Formats of meshes, by the end of the file's name.
const FORMATS: [&str; 3] = ["stl", "obj", "dae"];

/// Folders in which meshes are looked for.
#[derive(Debug, Clone, Default)]
pub struct MeshFolders {
    /// The folder of the URDF: relative paths begin here, and a folder above it
    /// that has the name of a package is that package.
    pub urdf: PathBuf,
    /// Packages, or folders that hold them.
    pub packages: Vec<PathBuf>,
}

impl MeshFolders {
    /// The file of a mesh that the URDF calls `path`. Of several the first of those in
    /// the given folders, in their order, else the one nearest to the URDF.
    ///
    /// # Errors
    /// No such file, a format other than STL, OBJ and DAE, an address on the network.
    pub fn find(&self, path: &str) -> Result<PathBuf> {
        let extension = Path::new(path).extension().map(|e| e.to_ascii_lowercase());
        if !extension.is_some_and(|e| FORMATS.iter().any(|format| e == *format)) {
            let message = format!("The mesh {path} is not of the formats STL, OBJ and DAE.");
            return Err(Error::new(Code::Unsupported, message));
        }
        let wanted = self.wanted(path)?;
        let found = wanted.iter().find(|file| file.is_file());
        found.cloned().ok_or_else(|| {
            let looked: Vec<String> = wanted.iter().map(|w| w.display().to_string()).collect();
            let message = format!(
                "The mesh {path} was not found. Looked for: {}.",
                looked.join(", ")
            );
            Error::new(Code::FileRead, message)
        })
    }

    /// Where the mesh may be, the best place first.
    fn wanted(&self, path: &str) -> Result<Vec<PathBuf>> {
        if let Some(rest) = path.strip_prefix("package://") {
            let (package, rest) = rest.split_once('/').unwrap_or((rest, ""));
            return Ok(self.in_packages(package, rest));
        }
        if let Some(file) = path.strip_prefix("file://") {
            return Ok(vec![self.urdf.join(file)]);
        }
        if let Some((scheme, _)) = path.split_once("://") {
            let message = format!("The mesh {path} is not a file: {scheme}:// is not supported.");
            return Err(Error::new(Code::Unsupported, message));
        }
        Ok(vec![self.urdf.join(path)])
    }

    fn in_packages(&self, package: &str, rest: &str) -> Vec<PathBuf> {
        let given = self.packages.iter();
        let mut wanted: Vec<PathBuf> = given
            .flat_map(|folder| [folder.join(package).join(rest), folder.join(rest)])
            .collect();
        // An empty path is the working folder.
        let urdf = std::path::absolute(self.urdf.join("."));
        let urdf = urdf.unwrap_or_else(|_| self.urdf.clone());
        let named = |folder: &&Path| folder.file_name().is_some_and(|name| name == package);
        let own = urdf
            .ancestors()
            .filter(named)
            .map(|folder| folder.join(rest));
        wanted.extend(own);
        // A package beside the URDF's own.
        let beside = urdf.ancestors().map(|folder| folder.join(package));
        wanted.extend(
            beside
                .filter(|f| f.is_dir())
                .map(|folder| folder.join(rest)),
        );
        if wanted.is_empty() {
            wanted.push(self.urdf.join(package).join(rest));
        }
        wanted.dedup();
        wanted
    }
}
