//! Shapes of kind "mesh": read from a file of their own and put into solids that contain them.

use crate::cell::raw::RawShape;
use crate::cell::source::Source;
use crate::cell::value::Spanned;
use crate::mesh::parse_mesh;
use nalgebra::{Isometry3, Translation3};
use stiffarm::error::{Code, Error, Result};
use stiffarm::model::scene::Carrier;
use stiffarm::model::shape::{Solid, capsules_of_mesh, solids_around};
use stiffarm::units::MM;

/// Most boxes around a mesh that stands, and their least thickness \[m\].
const BOXES: (usize, f64) = (24, 0.010);
/// Most capsules around a mesh of the tool.
const CAPSULES: usize = 4;
/// Nothing that is worth a shape is smaller \[m\].
const SMALLEST: f64 = 0.001;

/// Capsules around a mesh of the tool, boxes around one that stands.
pub(super) fn solids(source: &Source<'_>, shape: &Spanned<RawShape>, carrier: Carrier) -> Result<Vec<Solid>> {
    let raw = shape.get();
    let hint = "give the mesh: file = \"name.stl\", counted from the folder of the cell file";
    let text = source.required(shape, &raw.file, "file", hint)?;
    let file = source.name(text)?;
    let unit = unit(source, raw, &file)?;
    let shift = source.optional(&raw.xyz_mm, Source::vector)?;
    let turn = source.optional(&raw.rpy_deg, Source::rotation)?;
    let shift = Translation3::from(shift.unwrap_or_default());
    let pose = Isometry3::from_parts(shift, turn.unwrap_or_default());
    let solids = source.read(&file).and_then(|bytes| around(&bytes, &file, unit, carrier));
    let solids = solids.map_err(|error| {
        let message = format!("{file}: {}", error.message());
        let wrong = Error::new(error.code(), message);
        let wrong = match (error.code(), error.hint_text()) {
            (Code::FileRead, None) => wrong.hint("file counts from the folder of the cell file"),
            (_, Some(hint)) => wrong.hint(hint),
            _ => wrong,
        };
        source.place(wrong, text)
    })?;
    Ok(solids.into_iter().map(|solid| solid.placed(&pose)).collect())
}

/// Length of the mesh's unit \[m\].
fn unit(source: &Source<'_>, raw: &RawShape, file: &str) -> Result<f64> {
    let Some(unit) = &raw.unit else {
        return Ok(1.0);
    };
    if file.to_ascii_lowercase().ends_with(".dae") {
        let message = "A COLLADA file says its own unit.";
        let error = source.error(Code::Conflict, unit, message);
        return Err(error.hint("remove unit"));
    }
    match unit.get().as_str() {
        "m" => Ok(1.0),
        "mm" => Ok(MM),
        other => {
            let message = format!("The unit \"{other}\" of a mesh is not known.");
            let error = source.error(Code::InvalidValue, unit, message);
            Err(error.hint("unit is \"m\", the default, or \"mm\""))
        }
    }
}

fn around(bytes: &[u8], file: &str, unit: f64, carrier: Carrier) -> Result<Vec<Solid>> {
    let mesh = parse_mesh(bytes, file, unit)?;
    let across = mesh.extent().amax();
    if across < SMALLEST {
        let message = format!("The mesh is {:.2} mm across: probably its unit is m.", across * 1e3);
        return Err(Error::invalid(message).hint("give `unit = \"m\"`"));
    }
    Ok(match carrier {
        Carrier::World => solids_around(&mesh.vertices, &mesh.triangles, BOXES.0, BOXES.1),
        _ => {
            let capsules = capsules_of_mesh(&mesh, CAPSULES);
            capsules.into_iter().map(Solid::Capsule).collect()
        }
    })
}
