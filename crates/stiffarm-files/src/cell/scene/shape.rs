//! One shape of tool or surroundings: its kind and the keys that belong to it.

use super::mesh;
use crate::cell::raw::RawShape;
use crate::cell::source::Source;
use crate::cell::value::{Fixed, Mm, Spanned};
use nalgebra::{Isometry3, Translation3, Unit, Vector3};
use stiffarm::error::{Code, Result, did_you_mean};
use stiffarm::model::scene::{Carrier, Part};
use stiffarm::model::shape::{Capsule, Solid};

/// The kinds, the keys each has beside `name` and `kind`, and whether it moves: what has no end stands.
const KINDS: [(&str, &[&str], bool); 7] = [
    ("box", &["center_mm", "size_mm", "rpy_deg"], true),
    ("cylinder", &["from_mm", "to_mm", "radius_mm"], true),
    ("capsule", &["from_mm", "to_mm", "radius_mm"], true),
    ("mesh", &["file", "unit", "xyz_mm", "rpy_deg"], true),
    ("floor", &["z_mm"], false),
    ("ceiling", &["z_mm"], false),
    ("wall", &["point_mm", "normal"], false),
];

/// The parts of a list, each with a name that none of `before` has; shapes of one name are one part.
pub(super) fn parts(
    source: &Source<'_>,
    shapes: &Spanned<Vec<Spanned<RawShape>>>,
    carrier: Carrier,
    before: &[Part],
) -> Result<Vec<Part>> {
    let mut named: Vec<(String, Vec<Solid>)> = Vec::new();
    for shape in shapes.get() {
        let hint = "give the shape a name for messages";
        let text = source.required(shape, &shape.get().name, "name", hint)?;
        let name = source.name(text)?;
        if before.iter().any(|part| part.name == name) {
            let message = format!("The name \"{name}\" belongs to another shape.");
            let error = source.error(Code::Duplicate, text, message);
            return Err(error.hint("links are named \"base\", \"link 1\", \"link 2\" and so on"));
        }
        let solids = solids(source, shape, carrier)?;
        match named.iter_mut().find(|(other, _)| *other == name) {
            Some((_, others)) => others.extend(solids),
            None => named.push((name, solids)),
        }
    }
    let part = |(name, solids)| Part::new(name, carrier, solids);
    Ok(named.into_iter().map(part).collect())
}

fn solids(source: &Source<'_>, shape: &Spanned<RawShape>, carrier: Carrier) -> Result<Vec<Solid>> {
    let raw = shape.get();
    let moves = carrier != Carrier::World;
    let kinds = || KINDS.iter().filter(move |kind| kind.2 || !moves).map(|kind| kind.0);
    let list = kinds().map(|name| format!("\"{name}\"")).collect::<Vec<_>>().join(", ");
    let hint = format!("kind is one of {list}");
    let kind = source.required(shape, &raw.kind, "kind", &hint)?;
    let name = kind.get().as_str();
    let Some((_, keys, _)) = KINDS.iter().find(|k| k.0 == name && (k.2 || !moves)) else {
        let message = format!("A shape of kind \"{name}\" is not known here.");
        let error = source.error(Code::InvalidValue, kind, message);
        return Err(error.hint(did_you_mean(name, kinds()).unwrap_or(hint)));
    };
    // A key of another kind of shape would be ignored.
    let is_known = |key: &str| ["name", "kind"].contains(&key) || keys.contains(&key);
    source.refuse_others(shape, is_known, |key| {
        let message = format!("A shape of kind \"{name}\" has no {key}.");
        (message, format!("its keys are {}", keys.join(", ")))
    })?;
    let hint = format!("give {}", keys.join(", "));
    let point = |list: &Option<Fixed<3, Mm>>, name: &str| source.vector(source.required(shape, list, name, &hint)?);
    let ends = || -> Result<_> {
        let ends = [point(&raw.from_mm, "from_mm")?, point(&raw.to_mm, "to_mm")?];
        let radius = source.required(shape, &raw.radius_mm, "radius_mm", &hint)?;
        Ok((ends, source.positive(radius)?))
    };
    let made = match name {
        "mesh" => return mesh::solids(source, shape, carrier),
        "box" => {
            let turn = source.optional(&raw.rpy_deg, Source::rotation)?;
            let centre = Translation3::from(point(&raw.center_mm, "center_mm")?);
            let pose = Isometry3::from_parts(centre, turn.unwrap_or_default());
            Solid::block(pose, point(&raw.size_mm, "size_mm")?)
        }
        "cylinder" => ends().and_then(|([a, b], radius)| Solid::cylinder(a, b, radius)),
        "capsule" => {
            let capsule = ends().and_then(|([a, b], radius)| Capsule::new(a, b, radius));
            capsule.map(Solid::Capsule)
        }
        "wall" => {
            let normal = source.required(shape, &raw.normal, "normal", &hint)?;
            let normal = direction(source, normal)?;
            let point = point(&raw.point_mm, "point_mm")?;
            Ok(Solid::HalfSpace { point, normal })
        }
        _ => {
            let hint = "give the height in the base frame: z_mm";
            let z = source.number(source.required(shape, &raw.z_mm, "z_mm", hint)?)?;
            let up = match name {
                "floor" => Vector3::z_axis(),
                _ => -Vector3::z_axis(),
            };
            Ok(Solid::HalfSpace { point: Vector3::z() * z, normal: up })
        }
    };
    made.map(|solid| vec![solid]).map_err(|error| match error.place().span {
        Some(_) => error,
        None => source.place(error, shape),
    })
}

/// A direction of any length above zero.
pub(super) fn direction(source: &Source<'_>, list: &Fixed<3>) -> Result<Unit<Vector3<f64>>> {
    let vector = source.vector(list)?;
    Unit::try_new(vector, 1e-12).ok_or_else(|| {
        let message = "A direction must not have length zero.";
        source.error(Code::InvalidValue, list, message)
    })
}
