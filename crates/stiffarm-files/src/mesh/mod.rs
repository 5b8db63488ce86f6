//! Meshes: STL, OBJ and COLLADA.

mod collada;

use nalgebra::Vector3;
use std::collections::HashMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use stiffarm::error::{Code, Error, Result};
use stiffarm::model::shape::TriangleMesh;

/// A mesh of a robot or a tool is not larger than this \[m\].
const LARGEST: f64 = 20.0;

const KINDS: &str = "give a triangle mesh as .stl, .obj or .dae";

/// Reads a mesh from the bytes of a file; the ending of its `name` says which kind it is.
/// Corners at the same place become one. `scale` is the length of the file's unit \[m\]: 1 for metres, as in robot
/// descriptions, 0.001 for millimetres, as from most CAD systems. COLLADA files say their own unit; `scale`
/// multiplies it.
///
/// # Errors
/// No known ending, bytes that are no such mesh, no triangles, a coordinate that is not
/// finite, a scale that is not above zero, or more than 20 m across read as metres.
pub fn parse_mesh(bytes: &[u8], name: &str, scale: f64) -> Result<TriangleMesh> {
    parse(bytes, name, scale).map_err(|e| e.file(name))
}

fn parse(bytes: &[u8], name: &str, scale: f64) -> Result<TriangleMesh> {
    if !(scale.is_finite() && scale > 0.0) {
        return Err(Error::invalid("The unit of a mesh must be above zero."));
    }
    let ending = Path::new(name).extension().and_then(|e| e.to_str());
    let kind = match ending.map(str::to_ascii_lowercase).as_deref() {
        Some("stl") => Kind::Stl,
        Some("obj") => Kind::Obj,
        Some("dae") => Kind::Collada,
        _ => {
            let message = "The name does not end in .stl, .obj or .dae.";
            return Err(Error::new(Code::Unsupported, message).hint(KINDS));
        }
    };
    let mut merged = Merged::default();
    match kind {
        Kind::Collada => {
            let triangles = collada::triangles(bytes).map_err(|why| kind.broken(&why))?;
            for corners in triangles {
                merged.add(corners.map(|p| p * scale));
            }
        }
        Kind::Stl | Kind::Obj => {
            for corners in loaded(kind, bytes)? {
                merged.add(corners.map(|p| Vector3::from(p.map(f64::from)) * scale));
            }
        }
    }
    let mesh =
        TriangleMesh::new(merged.vertices, merged.triangles).map_err(|e| match e.code() {
            Code::TooFewData => e.hint(KINDS),
            _ => e.hint("export the mesh again"),
        })?;
    let across = mesh.extent().amax();
    if scale == 1.0 && across > LARGEST {
        return Err(Error::invalid(format!(
            "The mesh is {} m across: probably its unit is mm.",
            grouped(across)
        ))
        .hint("give `unit = \"mm\"`"));
    }
    Ok(mesh)
}

/// Corners of the triangles of an STL or OBJ file, in its unit.
fn loaded(kind: Kind, bytes: &[u8]) -> Result<Vec<[[f32; 3]; 3]>> {
    let is_stl = kind == Kind::Stl;
    if is_stl {
        check_stl(bytes)?;
    }
    // The reader of the formats may stop the program where it meets what it did not foresee.
    let scene = catch_unwind(AssertUnwindSafe(|| {
        if is_stl {
            mesh_loader::stl::from_slice(bytes)
        } else {
            mesh_loader::obj::from_slice(bytes, None, |_| {
                // Colours are in other files, and nobody needs them.
                Err::<Vec<u8>, _>(std::io::ErrorKind::NotFound.into())
            })
        }
    }));
    let scene = scene
        .map_err(|_| kind.broken("it makes no sense"))?
        .map_err(|e| kind.broken(&e.to_string()))?;
    let mut triangles = Vec::new();
    for mesh in &scene.meshes {
        for face in &mesh.faces {
            let corner = |v: u32| mesh.vertices.get(v as usize).copied();
            let [Some(a), Some(b), Some(c)] = face.map(corner) else {
                return Err(kind.broken("a triangle has a corner that is not there"));
            };
            triangles.push([a, b, c]);
        }
    }
    Ok(triangles)
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Stl,
    Obj,
    Collada,
}

impl Kind {
    fn broken(self, why: &str) -> Error {
        let kind = match self {
            Kind::Stl => "STL",
            Kind::Obj => "OBJ",
            Kind::Collada => "COLLADA",
        };
        let why = why.trim_end_matches('.');
        Error::new(
            Code::FileRead,
            format!("The file cannot be read as a mesh in {kind}: {why}."),
        )
        .hint("export it again, as binary STL where nothing else works")
    }
}

/// Triangles with the corners that they share.
#[derive(Default)]
struct Merged {
    vertices: Vec<Vector3<f64>>,
    triangles: Vec<[usize; 3]>,
    known: HashMap<[u64; 3], usize>,
}

impl Merged {
    fn add(&mut self, corners: [Vector3<f64>; 3]) {
        let triangle = corners.map(|p| {
            // Adding zero turns −0 into 0.
            let bits = [p.x, p.y, p.z].map(|v| (v + 0.0).to_bits());
            *self.known.entry(bits).or_insert_with(|| {
                self.vertices.push(p);
                self.vertices.len() - 1
            })
        });
        self.triangles.push(triangle);
    }
}

/// A binary file holds as many triangles as it says; one that is cut off would lose a part of what
/// it shows.
fn check_stl(bytes: &[u8]) -> Result<()> {
    let start = bytes.trim_ascii_start();
    let is_text = start.starts_with(b"solid");
    let counted = bytes.get(80..84).and_then(|c| c.try_into().ok());
    let Some(count) = counted.map(|c: [u8; 4]| u64::from(u32::from_le_bytes(c))) else {
        return Err(Kind::Stl.broken("it is too short"));
    };
    let own = bytes.len() as u64 - 84;
    // Some programs end the file with a line end.
    if (50 * count..=50 * count + 2).contains(&own) {
        return Ok(());
    }
    if !is_text {
        return Err(Kind::Stl.broken(&format!(
            "it says {count} triangles and has bytes for {}",
            own / 50
        )));
    }
    if has_word(bytes, b"endsolid") {
        Ok(())
    } else {
        Err(Kind::Stl.broken("its end is missing (no endsolid)"))
    }
}

fn has_word(bytes: &[u8], word: &[u8]) -> bool {
    bytes.windows(word.len()).any(|w| w == word)
}

/// A number without decimals, its thousands apart: `2,345`.
fn grouped(value: f64) -> String {
    let digits = format!("{value:.0}");
    let mut out = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i) % 3 == 0 {
            out.push(',');
        }
        out.push(digit);
    }
    out
}
