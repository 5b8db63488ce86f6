//! Meshes are read from STL, OBJ and DAE in every way they are written, and refused with a reason.

use crate::common::cases::{shown, slip};
use crate::common::meshes::{box_mesh, l_mesh};
use crate::common::prelude::*;
use std::fmt::Write;
use stiffarm_files::mesh::parse_mesh;

fn binary_stl(mesh: &TriangleMesh) -> Vec<u8> {
    let mut out = vec![b' '; 80];
    out.extend((mesh.triangles.len() as u32).to_le_bytes());
    for corners in mesh.corners() {
        out.extend([0; 12]);
        for v in corners.iter().flatten() {
            out.extend((*v as f32).to_le_bytes());
        }
        out.extend([0; 2]);
    }
    out
}

fn ascii_stl(mesh: &TriangleMesh) -> Vec<u8> {
    let mut out = "solid part\n".to_string();
    for corners in mesh.corners() {
        out += "facet normal 0 0 0\n  outer loop\n";
        for v in corners {
            writeln!(out, "    vertex {:e} {:e} {:e}", v.x, v.y, v.z).unwrap();
        }
        out += "  endloop\nendfacet\n";
    }
    (out + "endsolid part\n").into_bytes()
}

fn obj(mesh: &TriangleMesh) -> Vec<u8> {
    let mut out = "# a part\nmtllib none.mtl\no part\n".to_string();
    for v in &mesh.vertices {
        writeln!(out, "v {} {} {}", v.x, v.y, v.z).unwrap();
    }
    for [a, b, c] in &mesh.triangles {
        writeln!(out, "f {} {} {}", a + 1, b + 1, c + 1).unwrap();
    }
    out.into_bytes()
}

/// The mesh in a node that is moved by 10 along x, within one turned by 90° about z, in millimetres.
fn collada(mesh: &TriangleMesh, unit: &str) -> Vec<u8> {
    let numbers: Vec<String> = mesh.vertices.iter().flatten().map(f64::to_string).collect();
    let corners: Vec<String> = mesh.triangles.iter().flatten().map(usize::to_string).collect();
    format!(
        r##"<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset>{unit}<up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="part"><mesh>
<source id="p"><float_array id="pa" count="{}">{}</float_array>
<technique_common><accessor source="#pa" count="{}" stride="3">
<param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="{}"><input semantic="VERTEX" source="#v" offset="0"/><p>{}</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="scene"><node id="outer"><rotate>0 0 1 90</rotate>
<node id="inner"><translate>10 0 0</translate><instance_geometry url="#part"/></node></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#scene"/></scene></COLLADA>"##,
        numbers.len(),
        numbers.join(" "),
        mesh.vertices.len(),
        mesh.triangles.len(),
        corners.join(" "),
    )
    .into_bytes()
}

/// The same corners of the same triangles, to the digits of the file.
fn same(a: &TriangleMesh, b: &TriangleMesh, tolerance: f64) {
    assert_eq!(a.triangles.len(), b.triangles.len());
    for (corner, other) in a.corners().flatten().zip(b.corners().flatten()) {
        assert!((corner - other).norm() < tolerance, "{corner} {other}");
    }
}

#[test]
fn each_kind_is_read() {
    let mesh = l_mesh();
    for (name, bytes) in [("part.stl", binary_stl(&mesh)), ("part.STL", ascii_stl(&mesh)), ("part.obj", obj(&mesh))] {
        let read = parse_mesh(&bytes, name, 1.0).unwrap();
        same(&read, &mesh, 1e-7);
        // Two bars share two corners.
        assert_eq!(read.vertices.len(), 14, "{name}: corners are shared");
        let small = parse_mesh(&bytes, name, 1e-3).unwrap();
        assert!((small.extent() - mesh.extent() * 1e-3).norm() < 1e-10);
    }
    let square = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
    assert_eq!(parse_mesh(square, "a.obj", 1.0).unwrap().triangles.len(), 2);
}

#[test]
fn nodes_and_units_of_collada_count() {
    let mesh = box_mesh(Vector3::zeros(), Vector3::new(3.0, 2.0, 1.0));
    let read = |unit: &str| parse_mesh(&collada(&mesh, unit), "part.dae", 1.0).unwrap();
    let mut expected = mesh.clone();
    for v in &mut expected.vertices {
        // Moved first, then turned.
        *v = Vector3::new(-v.y, v.x + 10.0, v.z);
    }
    same(&read(""), &expected, 1e-5);
    expected.vertices.iter_mut().for_each(|v| *v *= 0.01);
    same(&read("<unit meter=\"0.01\" name=\"cm\"/>"), &expected, 1e-7);
}

/// A part placed twice is there twice; polygons with several inputs are cut into triangles.
#[test]
fn parts_of_collada_are_placed_as_often_as_it_says() {
    let mesh = box_mesh(Vector3::zeros(), Vector3::new(3.0, 2.0, 1.0));
    let dae = String::from_utf8(collada(&mesh, "")).unwrap();
    let placed = r##"<instance_geometry url="#part"/>"##;
    let twice = format!("{placed}<node><scale>2 1 1</scale>{placed}</node>");
    let read = parse_mesh(dae.replace(placed, &twice).as_bytes(), "a.dae", 1.0).unwrap();
    assert_eq!(read.triangles.len(), 24);
    assert!((read.extent() - Vector3::new(2.0, 6.0, 1.0)).norm() < 1e-12);
    let (head, rest) = dae.split_once("<triangles").unwrap();
    let (_, tail) = rest.split_once("</triangles>").unwrap();
    let list = r##"<polylist count="2"><input semantic="NORMAL" source="#n" offset="0"/>
        <input semantic="VERTEX" source="#v" offset="1"/><vcount>4 3</vcount>
        <p>0 0 0 1 0 3 0 2 7 4 7 5 7 6</p></polylist>"##;
    let read = parse_mesh(format!("{head}{list}{tail}").as_bytes(), "a.dae", 1.0).unwrap();
    assert_eq!(read.triangles.len(), 3);
}

#[test]
fn what_is_no_mesh_is_refused() {
    let mesh = l_mesh();
    let (stl, ascii) = (binary_stl(&mesh), ascii_stl(&mesh));
    let mut nan = mesh.clone();
    nan.vertices[3].y = f64::NAN;
    let dae = String::from_utf8(collada(&mesh, "")).unwrap();
    let edited = |from: &str, to: &str| dae.replace(from, to).into_bytes();
    let lookat = dae.replace("</rotate>", "</lookat>").replace("<rotate>", "<lookat>");
    let mut report = String::new();
    for (what, bytes, name) in [
        ("another ending", stl.clone(), "part.step"),
        ("no ending", stl.clone(), "part"),
        ("nothing", Vec::new(), "a.stl"),
        ("a triangle less", stl[..stl.len() - 50].to_vec(), "a.stl"),
        ("half a text", ascii[..ascii.len() / 2].to_vec(), "a.stl"),
        ("a solid of nothing", b"solid a\nendsolid a\n".to_vec(), "a.stl"),
        ("a corner that is no number", binary_stl(&nan), "a.stl"),
        ("corners alone", b"v 0 0 0\nv 1 0 0\nv 1 1 0\n".to_vec(), "a.obj"),
        ("one corner of three", b"v 0 0 0\nf 1 2 3\n".to_vec(), "a.obj"),
        ("no COLLADA", b"<a>".to_vec(), "a.dae"),
        ("no text", vec![0xff, 0xfe, b'<'], "a.dae"),
        ("another part", edited("#part", "#other"), "a.dae"),
        ("corner 99", edited("<p>0", "<p>99"), "a.dae"),
        ("corner 0.5", edited("<p>0", "<p>0.5"), "a.dae"),
        ("a corner less", edited("<p>0 ", "<p>"), "a.dae"),
        ("a lookat", lookat.into_bytes(), "a.dae"),
        ("a node in itself", edited("<translate>", r##"<instance_node url="#outer"/><translate>"##), "a.dae"),
    ] {
        let error = parse_mesh(&bytes, name, 1.0).expect_err(what);
        assert_eq!(error.place().file.as_deref(), Some(name), "{what}");
        assert!(error.hint_text().is_some(), "{what}: {error}");
        report += &slip::<()>(what, Err(error));
    }
    for unit in [0.0, f64::NAN] {
        report += &slip(&format!("a unit of {unit} m"), parse_mesh(&stl, "a.stl", unit));
    }
    insta::assert_snapshot!("no_meshes", report);
}

#[test]
fn millimetres_read_as_metres_are_noticed() {
    let mesh = box_mesh(Vector3::zeros(), Vector3::new(2345.0, 300.0, 200.0));
    let error = parse_mesh(&binary_stl(&mesh), "link.stl", 1.0).unwrap_err();
    assert_eq!(error.message(), "The mesh is 2,345 m across: probably its unit is mm.");
    assert_eq!(error.hint_text(), Some("give `unit = \"mm\"`"));
    assert!(parse_mesh(&binary_stl(&mesh), "link.stl", 1e-3).is_ok());
}

/// Binary or text is told by the length: programs begin binary files with "solid", and line ends may stand in the head.
#[test]
fn the_length_says_whether_an_stl_is_binary() {
    let mesh = l_mesh();
    let stl = binary_stl(&mesh);
    let headed = |head: &[u8]| {
        let mut out = stl.clone();
        out[..head.len()].copy_from_slice(head);
        out
    };
    let behind = |more: &[u8]| [stl.as_slice(), more].concat();
    // Ten triangles: the count itself is a line end.
    let few = box_mesh(Vector3::zeros(), Vector3::new(3.0, 2.0, 1.0));
    let mut ten = binary_stl(&few);
    ten[..6].copy_from_slice(b"solid ");
    ten[80] = 10;
    ten.truncate(84 + 500);
    assert_eq!(parse_mesh(&ten, "a.stl", 1.0).unwrap().triangles.len(), 10);
    for (bytes, what) in [
        (headed(b"solid "), "solid"),
        (headed(b"solid part\n"), "solid with a line end"),
        (headed(b"solid part\r\nfacet normal"), "solid and facet"),
        (headed(b"solid\n\0\0\n"), "solid and zeros"),
        (headed(&[0; 80]), "zeros"),
        (headed(b"\n\n\n"), "line ends"),
        (headed(&[0xff; 80]), "no text"),
        (behind(b"\r\n"), "a line end behind"),
        (behind(&[7; 49]), "less than a triangle behind"),
        (behind(&[0; 512]), "zeros behind"),
    ] {
        let read = parse_mesh(&bytes, "part.STL", 1.0).unwrap_or_else(|e| panic!("{what}: {e}"));
        same(&read, &mesh, 1e-6);
    }
    // Behind them there may be a triangle.
    insta::assert_snapshot!(parse_mesh(&behind(&[7; 50]), "a.stl", 1.0).unwrap_err(), @"
    a.stl: The file cannot be read as a mesh in STL: it says 24 triangles and has bytes for 25.
      hint: export it again, as binary STL where nothing else works
    ");
    let none = [&[b' '; 80][..], &[0; 4]].concat();
    insta::assert_snapshot!(parse_mesh(&none, "a.stl", 1.0).unwrap_err(), @"
    a.stl: The mesh has no triangles.
      hint: give a triangle mesh as .stl, .obj or .dae
    ");
}

#[test]
fn texts_of_stl_may_be_written_in_many_ways() {
    let mesh = l_mesh();
    let text = String::from_utf8(ascii_stl(&mesh)).unwrap();
    for (from, to) in [
        ("\n", "\r\n"),
        ("\n", "\r"),
        ("\n", " \n\n"),
        ("\n    ", " "),
        ("normal 0 0 0", "normal nan -nan(ind) -1.#IND"),
        ("solid part\n", "solid Grüße ä.stl  by a program\n"),
        ("solid part\nfacet", "\u{feff}solid\nfacet"),
        ("endsolid part", "endsolid"),
        ("solid part\nfacet", "solid a\n  made by a program\nfacet"),
    ] {
        assert!(text.contains(from), "{from}");
        let other = text.replace(from, to);
        let read = parse_mesh(other.as_bytes(), "a.stl", 1.0);
        same(&read.unwrap_or_else(|e| panic!("{to}: {e}")), &mesh, 1e-7);
    }
    let loud = text.to_uppercase();
    same(&parse_mesh(loud.as_bytes(), "a.stl", 1.0).unwrap(), &mesh, 1e-7);
    let mut report = String::new();
    for (from, to) in [
        ("endfacet", "facet"),
        ("outer loop", "outer loop\nvertex 1 2 3"),
        ("vertex", "vertex 1,5"),
        ("outer loop", "inner loop"),
    ] {
        // Behind the first facet, where what is unknown is no head.
        let (head, tail) = text.split_once("endfacet").unwrap();
        let other = format!("{head}endfacet{}", tail.replacen(from, to, 1));
        report += &slip(&shown(from, to), parse_mesh(other.as_bytes(), "a.stl", 1.0));
    }
    insta::assert_snapshot!("slips_in_texts_of_stl", report);
}

#[test]
fn a_mesh_under_the_ending_of_another_kind_is_named() {
    let mesh = l_mesh();
    let kinds = [
        ("binary STL", "stl", binary_stl(&mesh)),
        ("text of STL", "stl", ascii_stl(&mesh)),
        ("OBJ", "obj", obj(&mesh)),
        ("COLLADA", "dae", collada(&mesh, "")),
    ];
    let mut report = String::new();
    for (kind, right, bytes) in &kinds {
        for ending in ["stl", "obj", "dae"].iter().filter(|ending| *ending != right) {
            report += &slip(kind, parse_mesh(bytes, &format!("a.{ending}"), 1.0));
        }
    }
    insta::assert_snapshot!("meshes_under_other_endings", report);
}
