//! Shapes of the links of a URDF: its meshes are looked for, read, and put into capsules.

use crate::args;
use crate::progress::Progress;
use crate::session::Session;
use std::path::Path;
use stiffarm::model::robot::LinkCapsule;
use stiffarm::{Code, Error, Result};
use stiffarm_files::mesh::parse_mesh;
use stiffarm_files::urdf::{CollisionGeometry, CollisionShape, MeshFolders, UrdfRobot};

/// What progress calls the work.
const MESHES: &str = "meshes into capsules";

/// Capsules around the links; `from` is the URDF, `name` its name in messages.
///
/// # Errors
/// A mesh that is not there, cannot be read, or is probably in mm.
pub fn link_capsules(
    session: &Session,
    args: &args::Init,
    read: &UrdfRobot,
    from: &str,
    name: &str,
) -> Result<Vec<LinkCapsule>> {
    let folder = Path::new(from).parent().map(Path::to_path_buf);
    let folders =
        MeshFolders { urdf: folder.filter(|_| from != "-").unwrap_or_default(), packages: args.package_dir.clone() };
    // Meshes of a link go into its capsules together, for seconds where they are many.
    let is_mesh = |shape: &&CollisionShape| matches!(shape.geometry, CollisionGeometry::Mesh { .. });
    let count = read.shapes.iter().filter(is_mesh).count();
    let progress = Progress::new(session, MESHES);
    let mut done = 0;
    let capsules = read.link_capsules(|path, unit| {
        progress.report(MESHES, done, count);
        if session.stopped() {
            return Err(Error::new(Code::Interrupted, "Interrupted: there is no result."));
        }
        done += 1;
        let file = folders.find(path).map_err(|error| error.file(name))?;
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
