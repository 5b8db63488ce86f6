//! Collision geometry moves with its links, and meshes are found where they lie.

use super::*;
use std::fs;
use std::path::PathBuf;
use stiffarm::Code;
use stiffarm_files::urdf::{CollisionGeometry, MeshFolders};

pub const ARM: &str = r#"<robot name="arm">
  <link name="pedestal"><collision><geometry><box size="1 1 0.5"/></geometry></collision></link>
  <link name="base"/>
  <link name="arm"><collision><origin xyz="0.1 0 0" rpy="0 0.3 0"/><geometry><cylinder radius="0.1" length="0.8"/></geometry></collision></link>
  <link name="cover"><collision><geometry><mesh filename="package://covers/meshes/cover.STL" scale="0.001 0.001 0.001"/></geometry></collision></link>
  <link name="hand"><collision><geometry><sphere radius="0.2"/></geometry></collision></link>
  <link name="lever"><collision><geometry><sphere radius="0.05"/></geometry></collision></link>
  <link name="tool"><collision><geometry><mesh filename="tool.obj"/></geometry></collision></link>
  <joint name="feet" type="fixed"><origin xyz="0 0 0.5"/><parent link="pedestal"/><child link="base"/></joint>
  <joint name="swivel" type="revolute"><origin xyz="0 0 0.3" rpy="0.1 0.2 0.3"/><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/><limit lower="-2" upper="2" effort="1" velocity="1"/></joint>
  <joint name="screws" type="fixed"><origin xyz="0.2 0 0" rpy="1 0 0"/><parent link="arm"/><child link="cover"/></joint>
  <joint name="elbow" type="revolute"><origin xyz="0.7 0.1 0" rpy="0.5 0 0"/><parent link="arm"/><child link="hand"/><axis xyz="1 2 3"/><limit lower="-2" upper="2" effort="1" velocity="1"/></joint>
  <joint name="rod" type="continuous"><parent link="arm"/><child link="lever"/><mimic joint="elbow"/></joint>
  <joint name="mount" type="fixed"><origin xyz="0 0 0.2"/><parent link="hand"/><child link="tool"/></joint>
</robot>"#;

#[test]
fn shapes_move_with_their_links() {
    let read = read_urdf(ARM, "arm.urdf", &options("base", "hand")).unwrap();
    assert_eq!(read.left_out, ["lever"]);
    let links: Vec<(usize, &str)> = read.shapes.iter().map(|shape| (shape.link, shape.urdf_link.as_str())).collect();
    let expected = [(0, "pedestal"), (1, "arm"), (1, "cover"), (2, "hand"), (2, "tool")];
    assert_eq!(links, expected);
    let robot = read.robot.robot().unwrap();
    let plain = joints(ARM);
    let mut dice = Dice::new(4);
    for _ in 0..10 {
        let q = [dice.between(-2.0, 2.0), dice.between(-2.0, 2.0)];
        let names = &read.robot.joint_names;
        let named: BTreeMap<String, f64> = names.iter().cloned().zip(q).collect();
        let frames = Frames::new(&robot, &q);
        for shape in &read.shapes {
            let (link, origin) = super::capsules::origin(&shape.urdf_link);
            let (pose, _) = pose_and_jacobian(&plain, "base", link, &named, names);
            let placed = match shape.link {
                0 => shape.pose,
                i => frames.links()[i - 1] * shape.pose,
            };
            let difference = (to_matrix(&placed) - pose * origin).amax();
            assert!(difference < 1e-12, "{}: {difference:e}", shape.urdf_link);
        }
    }
}

#[test]
fn geometry_is_as_it_is_written() {
    let read = read_urdf(ARM, "arm.urdf", &options("base", "hand")).unwrap();
    let geometry: Vec<&CollisionGeometry> = read.shapes.iter().map(|s| &s.geometry).collect();
    let mesh = |path: &str, scale: f64| CollisionGeometry::Mesh { path: path.to_string(), scale: [scale; 3] };
    assert_eq!(
        geometry,
        [
            &CollisionGeometry::Box { size: [1.0, 1.0, 0.5] },
            &CollisionGeometry::Cylinder { radius: 0.1, length: 0.8 },
            &mesh("package://covers/meshes/cover.STL", 0.001),
            &CollisionGeometry::Sphere { radius: 0.2 },
            &mesh("tool.obj", 1.0),
        ]
    );
    let wrong = ARM.replace("radius=\"0.2\"", "radius=\"-0.2\"");
    let error = read_urdf(&wrong, "arm.urdf", &options("base", "hand")).unwrap_err();
    assert_eq!((error.code(), error.place().line), (Code::InvalidValue, Some(6)));
}

/// A folder of its own that goes when the test is over.
struct Folder(PathBuf);

impl Folder {
    fn new(files: &[&str]) -> Self {
        let name = format!("stiffarm-urdf-{}", std::process::id());
        let folder = std::env::temp_dir().join(name);
        for file in files {
            let path = folder.join(file);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, "solid\n").unwrap();
        }
        Folder(folder)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

#[test]
fn meshes_are_found_by_package_and_by_path() {
    let folder = Folder::new(&[
        "src/robots/urdf/meshes/own.dae",
        "src/robots/meshes/link.stl",
        "src/covers/meshes/cover.STL",
        "extra/meshes/extra.stl",
        "extra/renamed/b.stl",
        "extra/parts/relative.stl",
        "src/other-main/meshes/deep.stl",
        "src/other-main/meshes/link.stl",
        "models/arm_v2/meshes/model.dae",
    ]);
    let name = |at: &str, file: &str, name: &str| {
        let text = format!("<?xml version=\"1.0\"?>\n<p><name> {name} </name></p>");
        fs::write(folder.0.join(at).join(file), text).unwrap();
    };
    name("src/other-main", "package.xml", "other_pkg");
    name("models/arm_v2", "model.config", "arm");
    let at = |path: &str| folder.0.join(path);
    let folders = |packages: &[&str]| MeshFolders {
        urdf: at("src/robots/urdf"),
        packages: packages.iter().map(|p| at(p)).collect(),
    };
    let find = |packages: &[&str], path: &str| folders(packages).find(path);
    for (packages, path, expected) in [
        (&[][..], "meshes/own.dae", "src/robots/urdf/meshes/own.dae"),
        (&[], "package://robots/meshes/link.stl", "src/robots/meshes/link.stl"),
        (&[], "package://covers/meshes/cover.STL", "src/covers/meshes/cover.STL"),
        // The package itself under another name, and a folder that holds it.
        (&["extra"], "package://other/meshes/extra.stl", "extra/meshes/extra.stl"),
        (&["extra"], "package://renamed/b.stl", "extra/renamed/b.stl"),
        // Relative paths beside the URDF first, then in the folders given; models as packages.
        (&["extra"], "meshes/own.dae", "src/robots/urdf/meshes/own.dae"),
        (&["extra"], "parts/relative.stl", "extra/parts/relative.stl"),
        (&["extra/parts"], "model://relative.stl", "extra/parts/relative.stl"),
        (&["extra"], "model://renamed/b.stl", "extra/renamed/b.stl"),
        (&["models"], "model://arm/meshes/model.dae", "models/arm_v2/meshes/model.dae"),
        // A package by the name that it gives itself, as deep as workspaces have them.
        (&["src"], "package://other_pkg/meshes/deep.stl", "src/other-main/meshes/deep.stl"),
        (&["src/other-main"], "package://other_pkg/meshes/deep.stl", "src/other-main/meshes/deep.stl"),
        (&["src/other-main"], "$(find other_pkg)/meshes/deep.stl", "src/other-main/meshes/deep.stl"),
        (&["."], "file://$(find other_pkg)/meshes/deep.stl", "./src/other-main/meshes/deep.stl"),
        // Another package has other meshes of the same name.
        (&["src/other-main"], "package://robots/meshes/link.stl", "src/robots/meshes/link.stl"),
    ] {
        assert_eq!(find(packages, path).unwrap(), at(expected), "{path}");
    }
    // What helps, and nothing else.
    let mut hints = String::new();
    for path in [
        "meshes/none.stl",
        "package://none/a.stl",
        "model://none/a.stl",
        "model://none.stl",
        "$(find none)/a.stl",
        "file:///none/a.stl",
        "/none/a.stl",
        "http://none/a.stl",
        "package://covers/meshes/cover.step",
    ] {
        let error = find(&["extra"], path).unwrap_err();
        hints += &format!("[{}] {path}: {}\n", error.code().as_str(), error.hint_text().unwrap());
    }
    insta::assert_snapshot!("meshes_that_are_not_there", hints);
    let local = format!("file://localhost{}", at("extra/renamed/b.stl").display());
    if cfg!(unix) {
        assert_eq!(find(&[], &local).unwrap(), at("extra/renamed/b.stl"));
    }
    let address = format!("file://{}", at("extra/renamed/b.stl").display());
    assert!(find(&[], &address).unwrap().ends_with("extra/renamed/b.stl"));
    let error = find(&["extra"], "package://robots/meshes/none.stl").unwrap_err();
    assert_eq!(error.code(), Code::FileRead);
    assert!(error.message().contains("extra"), "{error}");
    for path in ["http://a/b.stl", "meshes/own.step", "package://robots", ""] {
        assert_eq!(find(&[], path).unwrap_err().code(), Code::Unsupported, "{path}");
    }
}
