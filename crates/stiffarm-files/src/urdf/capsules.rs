//! Capsules around the collision geometry of the links.

use super::{CollisionGeometry, CollisionShape, UrdfRobot};
use crate::mesh::LARGEST_EXTENT;
use nalgebra::{Isometry3, Vector3};
use stiffarm::error::{Error, Result};
use stiffarm::model::robot::LinkCapsule;
use stiffarm::model::shape::{Capsule, Solid, TriangleMesh, capsules_around, capsules_of_mesh};

/// Most capsules around the meshes of a link.
const MOST_CAPSULES: usize = 2;

impl UrdfRobot {
    /// Capsules that contain the collision geometry of each link: at most two around all
    /// meshes of a link together, and those of [`capsules_around`] around each box, cylinder
    /// and ball. `mesh` reads the mesh of a path of the URDF and a length of its
    /// unit \[m\], as [`parse_mesh`](crate::mesh::parse_mesh) does.
    ///
    /// # Errors
    /// What `mesh` returns, and a shape of more than 20 m.
    pub fn link_capsules(&self, mut mesh: impl FnMut(&str, f64) -> Result<TriangleMesh>) -> Result<Vec<LinkCapsule>> {
        let robot = self.robot.robot()?;
        let mut capsules = Vec::new();
        for link in 0..=robot.joint_count() {
            // Fitted in the frame that cell.toml gives them in, where their numbers are short.
            let frame = robot.row_frame(link);
            let mut meshes = TriangleMesh::default();
            let mut link_capsules = Vec::new();
            for shape in self.shapes.iter().filter(|shape| shape.link == link) {
                let pose = frame.inv_mul(&shape.pose);
                let (solid, size) = match shape.geometry {
                    CollisionGeometry::Mesh { ref path, scale } => {
                        let read = scaled(scale, |unit| mesh(path, unit))?;
                        check_size(shape, read.extent().amax())?;
                        append(&mut meshes, &read.placed(&pose));
                        continue;
                    }
                    CollisionGeometry::Box { size } => {
                        let size = Vector3::from(size);
                        (Solid::block(Isometry3::identity(), size)?, size.amax())
                    }
                    CollisionGeometry::Cylinder { radius, length } => {
                        let end = Vector3::z() * (0.5 * length);
                        let solid = Solid::cylinder(-end, end, radius)?;
                        (solid, length.max(2.0 * radius))
                    }
                    CollisionGeometry::Capsule { radius, length } => {
                        let end = Vector3::z() * (0.5 * length);
                        let capsule = Capsule::new(-end, end, radius)?;
                        (Solid::Capsule(capsule), length + 2.0 * radius)
                    }
                    CollisionGeometry::Sphere { radius } => {
                        let middle = Vector3::zeros();
                        let capsule = Capsule::new(middle, middle, radius)?;
                        (Solid::Capsule(capsule), 2.0 * radius)
                    }
                };
                check_size(shape, size)?;
                link_capsules.extend(capsules_around(&solid.placed(&pose)));
            }
            link_capsules.splice(0..0, capsules_of_mesh(&meshes, MOST_CAPSULES));
            capsules
                .extend(link_capsules.into_iter().map(|capsule| LinkCapsule { link, capsule: capsule.placed(&frame) }));
        }
        Ok(capsules)
    }
}

fn append(all: &mut TriangleMesh, more: &TriangleMesh) {
    let before = all.vertices.len();
    all.vertices.extend(&more.vertices);
    let moved = more.triangles.iter().map(|t| t.map(|v| v + before));
    all.triangles.extend(moved);
}

/// A mesh with factors, which may mirror and differ from axis to axis.
fn scaled(factors: [f64; 3], mesh: impl FnOnce(f64) -> Result<TriangleMesh>) -> Result<TriangleMesh> {
    let unit = factors.iter().fold(0.0, |most: f64, s| most.max(s.abs()));
    let factors = Vector3::from(factors.map(|s| s / unit));
    let mut mesh = mesh(unit)?;
    for vertex in &mut mesh.vertices {
        vertex.component_mul_assign(&factors);
    }
    Ok(mesh)
}

fn check_size(shape: &CollisionShape, size: f64) -> Result<()> {
    if size <= LARGEST_EXTENT {
        return Ok(());
    }
    let message =
        format!("A shape of the link \"{}\" is {size:.0} m across: probably its unit is mm.", shape.urdf_link);
    Err(Error::invalid(message).hint("a URDF gives all lengths in m"))
}
