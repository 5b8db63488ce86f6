//! `stiffarm capsules`: capsules around meshes.

use crate::answer::Answer;
use crate::args;
use crate::args::MeshUnit;
use crate::numbers::{NONE, significant};
use crate::output::Exit;
use crate::progress::Progress;
use crate::screen::{columns, wrapped};
use crate::session::Session;
use crate::table::Table;
use serde::Serialize;
use std::fmt::Write;
use std::path::Path;
use stiffarm::model::shape::{Capsule, capsules_of_mesh, hull_volume};
use stiffarm::units::{m_to_mm, rounded};
use stiffarm::{Code, Error, Result};
use stiffarm_files::mesh::parse_mesh;
use stiffarm_files::source::Source;

/// Options of the result.
#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Options {
    /// Unit of the meshes.
    unit: &'static str,
    /// Most capsules around each.
    most: usize,
    /// The link that the meshes are of.
    link: Option<usize>,
    /// Whether they are of the tool.
    tool: bool,
}

/// The capsules of each mesh.
#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Fitted {
    meshes: Vec<Mesh>,
}

#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Mesh {
    /// Name of the file.
    mesh: String,
    /// Corners, those at one place counted once.
    vertices: usize,
    triangles: usize,
    /// Size along the axes of its frame.
    extent_mm: [f64; 3],
    /// Volume of its convex hull; `null` where it is flat.
    hull_volume_m3: Option<f64>,
    /// Sum over the capsules.
    capsules_volume_m3: f64,
    /// Together they contain the whole mesh.
    capsules: Vec<InMillimetres>,
}

#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct InMillimetres {
    from_mm: [f64; 3],
    to_mm: [f64; 3],
    radius_mm: f64,
}

/// Fits capsules around meshes.
pub fn run(session: &Session, args: &args::Capsules) -> Result<Answer> {
    let progress = Progress::new(session, "meshes into capsules");
    let meshes = args.meshes.iter().enumerate();
    let meshes: Vec<Mesh> = meshes
        .map(|(i, from)| {
            progress.report("meshes into capsules", i, args.meshes.len());
            if session.stopped() {
                return Err(Error::new(Code::Interrupted, "Interrupted: there is no result."));
            }
            fitted(session, &format!("mesh_{}", i + 1), from, args)
        })
        .collect::<Result<_>>()?;
    drop(progress);
    let text = match (args.link, args.tool) {
        (None, false) => table(&meshes),
        (link, _) => tables(&meshes, link),
    };
    let options = Options { unit: args.unit.name(), most: args.most, link: args.link, tool: args.tool };
    let envelope = session.envelope("capsules", None, options, Fitted { meshes });
    Ok(Answer::table(Exit::Done, envelope, text))
}

fn fitted(session: &Session, role: &str, from: &str, args: &args::Capsules) -> Result<Mesh> {
    let (name, bytes) = session.read(role, from)?;
    let mesh = parse_mesh(&bytes, &name, args.unit.length()).map_err(|e| {
        if args.unit == MeshUnit::M && e.message().contains("unit is mm") { e.hint("give --unit mm") } else { e }
    })?;
    let capsules = capsules_of_mesh(&mesh, args.most);
    let extent = mesh.extent();
    Ok(Mesh {
        mesh: name,
        vertices: mesh.vertices.len(),
        triangles: mesh.triangles.len(),
        extent_mm: [extent.x, extent.y, extent.z].map(hundredths),
        hull_volume_m3: hull_volume(&mesh),
        capsules_volume_m3: capsules.iter().map(Capsule::volume).sum(),
        capsules: capsules.iter().map(in_millimetres).collect(),
    })
}

/// In whole hundredths of a millimetre, which ends and radii are.
fn hundredths(m: f64) -> f64 {
    rounded(m_to_mm(m), 2)
}

fn in_millimetres(capsule: &Capsule) -> InMillimetres {
    let point = |p: &nalgebra::Vector3<f64>| [p.x, p.y, p.z].map(hundredths);
    InMillimetres { from_mm: point(&capsule.a), to_mm: point(&capsule.b), radius_mm: hundredths(capsule.radius) }
}

impl Mesh {
    /// `2 capsules, together 1.31 times the volume of the mesh's convex hull`
    fn said(&self) -> String {
        let count = match self.capsules.len() {
            1 => "1 capsule".to_string(),
            count => format!("{count} capsules, together"),
        };
        match self.hull_volume_m3 {
            Some(hull) => format!(
                "{count} {} times the volume of the mesh's convex hull",
                significant(self.capsules_volume_m3 / hull, 3)
            ),
            None => format!("{count}; the mesh is flat"),
        }
        .replace("capsule ", "capsule, ")
        .replace("together;", "together:")
    }
}

fn point(p: &[f64; 3]) -> String {
    format!("{}, {}, {}", p[0], p[1], p[2])
}

fn table(meshes: &[Mesh]) -> String {
    let mut out = String::new();
    for mesh in meshes {
        let _ = writeln!(
            out,
            "{}: {} triangles, {} mm\n{}",
            mesh.mesh,
            mesh.triangles,
            mesh.extent_mm.map(|mm| format!("{mm:.0}")).join(" × "),
            wrapped(&mesh.said(), columns())
        );
        let mut table = Table::new(["capsule", "from [mm]", "to [mm]", "radius [mm]"]);
        for (i, capsule) in mesh.capsules.iter().enumerate() {
            table.row([
                (i + 1).to_string(),
                point(&capsule.from_mm),
                point(&capsule.to_mm),
                capsule.radius_mm.to_string(),
            ]);
        }
        if mesh.capsules.is_empty() {
            table.row([NONE; 4].map(String::from));
        }
        out += &format!("{table}\n");
    }
    out + "--tool and --link I print them as tables of cell.toml.\n"
}

/// Tables of cell.toml: shapes of a link, or of the tool.
fn tables(meshes: &[Mesh], link: Option<usize>) -> String {
    let mut out = String::new();
    for mesh in meshes {
        let said = wrapped(&format!("# {}: {}", mesh.mesh, mesh.said()), columns());
        let _ = writeln!(out, "{}", said.replace("\n", "\n#"));
        for capsule in &mesh.capsules {
            out += &match link {
                Some(link) => format!("[[robot.shape]]\nlink = {link}\n"),
                None => format!("[[tool.shape]]\nname = {}\nkind = \"capsule\"\n", quoted(&name(mesh))),
            };
            let _ = writeln!(
                out,
                "from_mm = [{}]\nto_mm = [{}]\nradius_mm = {}\n",
                decimals(&capsule.from_mm),
                decimals(&capsule.to_mm),
                decimal(capsule.radius_mm)
            );
        }
    }
    out.truncate(out.trim_end().len());
    out + "\n"
}

/// Name of the mesh's file without its ending; shapes of one name are one part of the cell.
fn name(mesh: &Mesh) -> String {
    let bare = mesh.mesh.rsplit(':').next().unwrap_or_default();
    let stem = Path::new(bare).file_stem().unwrap_or_default();
    stem.to_string_lossy().into_owned()
}

/// A basic string of TOML, which has the escapes of JSON.
fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

/// A float of TOML has a point.
fn decimal(value: f64) -> String {
    format!("{value:?}")
}

fn decimals(values: &[f64; 3]) -> String {
    values.map(decimal).join(", ")
}
