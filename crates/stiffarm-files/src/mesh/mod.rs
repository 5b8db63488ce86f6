//! Meshes: STL, OBJ and COLLADA.

mod collada;
mod stl;

use nalgebra::Vector3;
use std::collections::HashMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use stiffarm::error::{Code, Error, Result};
use stiffarm::model::shape::TriangleMesh;

/// No shape of a robot or a tool is larger \[m\].
pub(crate) const LARGEST_EXTENT: f64 = 20.0;

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
    kind.check_content(bytes)?;
    let mut merged = IndexedTriangles::default();
    match kind {
        Kind::Stl => {
            let triangles = stl::triangles(bytes).map_err(|why| kind.broken(&why))?;
            for corners in triangles {
                merged.add(corners.map(|p| Vector3::from(p) * scale));
            }
        }
        Kind::Collada => {
            let triangles = collada::triangles(bytes).map_err(|why| kind.broken(&why))?;
            for corners in triangles {
                merged.add(corners.map(|p| p * scale));
            }
        }
        Kind::Obj => {
            for corners in loaded(bytes)? {
                merged.add(corners.map(|p| Vector3::from(p.map(f64::from)) * scale));
            }
        }
    }
    let mesh = TriangleMesh::new(merged.vertices, merged.triangles).map_err(|e| match e.code() {
        Code::TooFewData => e.hint(KINDS),
        _ => e.hint("export the mesh again"),
    })?;
    let across = mesh.extent().amax();
    if scale == 1.0 && across > LARGEST_EXTENT {
        return Err(Error::invalid(format!("The mesh is {} m across: probably its unit is mm.", grouped(across)))
            .hint("give `unit = \"mm\"`"));
    }
    Ok(mesh)
}

/// Corners of the triangles of an OBJ file, in its unit.
fn loaded(bytes: &[u8]) -> Result<Vec<[[f32; 3]; 3]>> {
    let kind = Kind::Obj;
    // The reader of the format may stop the program where it meets what it did not foresee.
    let scene = catch_unwind(AssertUnwindSafe(|| {
        mesh_loader::obj::from_slice(bytes, None, |_| {
            // Colours are in other files, and nobody needs them.
            Err::<Vec<u8>, _>(std::io::ErrorKind::NotFound.into())
        })
    }));
    let scene = scene.map_err(|_| kind.broken("it makes no sense"))?.map_err(|e| kind.broken(&e.to_string()))?;
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
    fn name(self) -> &'static str {
        match self {
            Kind::Stl => "STL",
            Kind::Obj => "OBJ",
            Kind::Collada => "COLLADA",
        }
    }

    fn ending(self) -> &'static str {
        match self {
            Kind::Stl => ".stl",
            Kind::Obj => ".obj",
            Kind::Collada => ".dae",
        }
    }

    /// The kind that the bytes themselves tell.
    fn seen(bytes: &[u8]) -> Option<Self> {
        let start = &bytes[..bytes.len().min(1000)];
        let has = |word: &[u8]| start.windows(word.len()).any(|w| w == word);
        let starts = |word: &[u8]| start.starts_with(word) || has(&[b"\n", word].concat());
        if stl::is_one(bytes) {
            Some(Kind::Stl)
        } else if has(b"<COLLADA") {
            Some(Kind::Collada)
        } else {
            (starts(b"v ") && !start.contains(&0)).then_some(Kind::Obj)
        }
    }

    /// A file of another kind than its name says is not guessed at: only COLLADA says its unit.
    fn check_content(self, bytes: &[u8]) -> Result<()> {
        match Kind::seen(bytes) {
            Some(seen) if seen != self => {
                let message = format!("The name ends in {}, and the file is a mesh in {}.", self.ending(), seen.name());
                let error = Error::new(Code::FileRead, message);
                Err(error.hint(format!("name it …{}, here and there", seen.ending())))
            }
            _ => Ok(()),
        }
    }

    fn broken(self, why: &str) -> Error {
        let kind = self.name();
        let why = why.trim_end_matches('.');
        Error::new(Code::FileRead, format!("The file cannot be read as a mesh in {kind}: {why}."))
            .hint("export it again, as binary STL where nothing else works")
    }
}

/// Triangles with the corners that they share.
#[derive(Default)]
struct IndexedTriangles {
    vertices: Vec<Vector3<f64>>,
    triangles: Vec<[usize; 3]>,
    vertex_indices: HashMap<[u64; 3], usize>,
}

impl IndexedTriangles {
    fn add(&mut self, corners: [Vector3<f64>; 3]) {
        let triangle = corners.map(|p| {
            // Adding zero turns −0 into 0.
            let bits = [p.x, p.y, p.z].map(|v| (v + 0.0).to_bits());
            *self.vertex_indices.entry(bits).or_insert_with(|| {
                self.vertices.push(p);
                self.vertices.len() - 1
            })
        });
        self.triangles.push(triangle);
    }
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
