//! Shapes of the links of a URDF: its meshes are looked for, read, and put into capsules.

use crate::args::InitArgs;
use crate::session::Session;
use std::path::Path;
use stiffarm::model::robot::LinkCapsule;
use stiffarm::{Code, Error, Result};
use stiffarm_files::mesh::parse_mesh;
use stiffarm_files::urdf::{MeshFolders, UrdfRobot};

/// Capsules around the links; `from` is the URDF, `name` its name in messages.
///
/// # Errors
/// A mesh that is not there, cannot be read, or is probably in mm.
pub fn link_capsules(
    session: &Session,
    args: &InitArgs,
    read: &UrdfRobot,
    from: &str,
    name: &str,
) -> Result<Vec<LinkCapsule>> {
    let folder = Path::new(from).parent().map(Path::to_path_buf);
    let folders = MeshFolders {
        urdf: folder.filter(|_| from != "-").unwrap_or_default(),
        packages: args.package_dir.clone(),
    };
    if let Some(missing) = folders.packages.iter().find(|folder| !folder.is_dir()) {
        let message = format!("There is no folder {}.", missing.display());
        return Err(Error::new(Code::FileRead, message).key("--package-dir"));
    }
    let capsules = read.link_capsules(|path, unit| {
        let file = folders.find(path).map_err(|error| {
            error.file(name).hint(
                "name the package, or the folder that holds it, with --package-dir DIR; or go without \
                 shapes: --no-shapes",
            )
        })?;
        // Inputs are told apart by what the URDF calls them.
        let (mesh, bytes) = session.read_file(&format!("mesh {path}"), &file)?;
        parse_mesh(&bytes, &mesh, unit).map_err(|error| {
            if !error.message().contains("unit is mm") {
                return error;
            }
            let scale = r#"<mesh … scale="0.001 0.001 0.001"/>"#;
            error.hint(format!("say so in {name}: {scale}; or go without shapes: --no-shapes"))
        })
    });
    capsules.map_err(|error| match error.place().file {
        Some(_) => error,
        None => error.file(name),
    })
}
