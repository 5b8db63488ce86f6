//! Capsules of a written cell hold the shapes of the URDF, moved by the plain chain.

use super::shapes::ARM;
use super::*;
use nalgebra::{Vector3, Vector4};
use stiffarm::model::robot::LinkCapsule;
use stiffarm::model::shape::TriangleMesh;
use stiffarm_files::cell::template_with_shapes;
use stiffarm_files::urdf::CollisionGeometry;

/// Corners of a mesh in its own unit: a ragged body of some 400 by 300 by 200.
fn corners(path: &str) -> Vec<Vector3<f64>> {
    let mut dice = Dice::new(path.len() as u64);
    let corner = |_| {
        let mut within = |half: f64| dice.between(-half, half);
        Vector3::new(100.0 + within(200.0), within(150.0), within(100.0))
    };
    (0..60).map(corner).collect()
}

fn mesh(path: &str, unit: f64) -> TriangleMesh {
    let corners: Vec<Vector3<f64>> = corners(path).iter().map(|p| p * unit).collect();
    let triangles = (0..corners.len() - 2).map(|i| [i, i + 1, i + 2]);
    TriangleMesh::new(corners.clone(), triangles.collect()).unwrap()
}

/// Points of a geometry in its own frame: corners, or points of the surface \[m\].
fn points(geometry: &CollisionGeometry) -> Vec<Vector3<f64>> {
    let turns = (0..24).map(|i| f64::from(i) * std::f64::consts::TAU / 24.0);
    match *geometry {
        CollisionGeometry::Mesh { ref path, scale } => {
            let scale = Vector3::from(scale);
            let corners = corners(path).into_iter();
            corners.map(|p| p.component_mul(&scale)).collect()
        }
        CollisionGeometry::Box { size } => (0..8)
            .map(|corner| {
                let side = |axis: usize| match corner >> axis & 1 {
                    0 => -0.5 * size[axis],
                    _ => 0.5 * size[axis],
                };
                Vector3::new(side(0), side(1), side(2))
            })
            .collect(),
        CollisionGeometry::Cylinder { radius, length } => turns
            .flat_map(|t| {
                let end = |z| Vector3::new(radius * t.cos(), radius * t.sin(), z);
                [end(0.5 * length), end(-0.5 * length)]
            })
            .collect(),
        CollisionGeometry::Capsule { radius, length } => {
            vec![Vector3::z() * (0.5 * length + radius), Vector3::z() * (-0.5 * length - radius)]
        }
        CollisionGeometry::Sphere { radius } => {
            turns.map(|t| Vector3::new(radius * t.cos(), 0.0, radius * t.sin())).collect()
        }
    }
}

/// Name of the URDF's link, its `<origin>` and the link of the chain that the plain reading knows.
pub fn origin(urdf_link: &str) -> (&str, Matrix4<f64>) {
    match urdf_link {
        // The pedestal stands above the base in the tree.
        "pedestal" => ("base", plain::pose([0.0, 0.0, -0.5], [0.0; 3])),
        "arm" => ("arm", plain::pose([0.1, 0.0, 0.0], [0.0, 0.3, 0.0])),
        other => (other, Matrix4::identity()),
    }
}

#[test]
fn capsules_of_a_written_cell_hold_every_point_of_the_urdf() {
    let cover = "scale=\"0.001 0.001 0.001\"";
    assert!(ARM.contains(cover));
    let text = ARM
        // Mirrored, and not the same along all axes.
        .replace(cover, "scale=\"0.001 -0.002 0.0015\"")
        .replace("\"tool.obj\"", "\"tool.obj\" scale=\"0.0005 0.0005 0.0005\"");
    let read = read_urdf(&text, "arm.urdf", &options("base", "hand")).unwrap();
    let capsules = read.link_capsules(|path, unit| Ok(mesh(path, unit))).unwrap();
    let written = template_with_shapes(&read.robot, "A robot.", &capsules).unwrap();
    assert!(written.contains(&format!("# Shapes of the links: {} capsules around 3 links", capsules.len())));
    let robot = parse_cell(&written, "cell.toml").unwrap().setup.robot;
    let written_capsules: &[LinkCapsule] = robot.link_capsules();
    assert_eq!(written_capsules.len(), capsules.len());
    let plain = joints(&text);
    let names = &read.robot.joint_names;
    let mut dice = Dice::new(7);
    let mut fullest = f64::NEG_INFINITY;
    for _ in 0..20 {
        let q = [dice.between(-2.0, 2.0), dice.between(-2.0, 2.0)];
        let named: BTreeMap<String, f64> = names.iter().cloned().zip(q).collect();
        let frames = Frames::new(&robot, &q);
        for shape in &read.shapes {
            let (link, origin) = origin(&shape.urdf_link);
            let (pose, _) = pose_and_jacobian(&plain, "base", link, &named, names);
            for point in points(&shape.geometry) {
                let at: Vector4<f64> = pose * origin * point.push(1.0);
                let outside = written_capsules
                    .iter()
                    .filter(|part| part.link == shape.link)
                    .map(|part| {
                        let capsule = match part.link {
                            0 => part.capsule,
                            i => part.capsule.placed(&frames.links()[i - 1]),
                        };
                        capsule.distance_to(&at.xyz())
                    })
                    .fold(f64::INFINITY, f64::min);
                assert!(outside < 1e-9, "{}: {outside:e}", shape.urdf_link);
                fullest = fullest.max(outside);
            }
        }
    }
    // They are no larger than they must be: some point is on a surface, to the rounding.
    assert!(fullest > -5e-5, "{fullest:e}");
}

#[test]
fn capsules_that_were_written_are_written_the_same_again() {
    let read = read_urdf(ARM, "arm.urdf", &options("base", "hand")).unwrap();
    let capsules = read.link_capsules(|path, unit| Ok(mesh(path, unit * 1e-3))).unwrap();
    let written = template_with_shapes(&read.robot, "A robot.", &capsules).unwrap();
    let cell = parse_cell(&written, "cell.toml").unwrap();
    let again = cell.setup.robot.link_capsules();
    assert_eq!(template_with_shapes(&read.robot, "A robot.", again).unwrap(), written);
}

#[test]
fn a_size_in_millimetres_is_refused() {
    let text = ARM.replace("<box size=\"1 1 0.5\"/>", "<box size=\"900 900 500\"/>");
    let read = read_urdf(&text, "arm.urdf", &options("base", "hand")).unwrap();
    let error = read.link_capsules(|path, unit| Ok(mesh(path, unit))).unwrap_err();
    insta::assert_snapshot!(error, @r#"
    A shape of the link "pedestal" is 900 m across: probably its unit is mm.
      hint: a URDF gives all lengths in m
    "#);
}
