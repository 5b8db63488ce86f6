//! One shape of tool or surroundings: its kind and the keys that belong to it.

use super::mesh;
use crate::error::{Code, Result, did_you_mean};
use crate::files::cell::raw::{At, RawShape};
use crate::files::cell::source::Source;
use crate::model::scene::{Carrier, Part};
use crate::model::shape::{Capsule, Solid};
use crate::units::mm_to_m;
use nalgebra::{Isometry3, Translation3, Unit, UnitQuaternion, Vector3};
use std::ops::Range;

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

/// The parts of `table`, each with a name that none of `before` has; shapes of one name are one part.
pub(super) fn parts(
    source: &Source<'_>,
    shapes: &At<Vec<At<RawShape>>>,
    table: &str,
    carrier: Carrier,
    before: &[Part],
) -> Result<Vec<Part>> {
    let mut named: Vec<(String, Vec<Solid>)> = Vec::new();
    for (i, shape) in shapes.get().iter().enumerate() {
        let key = format!("{table}[{}]", i + 1);
        let name_key = format!("{key}.name");
        let hint = "give the shape a name for messages";
        let text = source.required(&shape.get().name, &name_key, Some(shape.span()), hint)?;
        let name = source.name(text, &name_key)?;
        if before.iter().any(|part| part.name == name) {
            let message = format!("The name \"{name}\" belongs to another shape.");
            let error = source.error(Code::Duplicate, &name_key, text.span(), message);
            return Err(error.hint("links are named \"base\", \"link 1\", \"link 2\" and so on"));
        }
        let solids = solids(source, shape, &key, carrier)?;
        match named.iter_mut().find(|(other, _)| *other == name) {
            Some((_, others)) => others.extend(solids),
            None => named.push((name, solids)),
        }
    }
    let part = |(name, solids)| Part::new(name, carrier, solids);
    Ok(named.into_iter().map(part).collect())
}

fn solids(
    source: &Source<'_>,
    shape: &At<RawShape>,
    table: &str,
    carrier: Carrier,
) -> Result<Vec<Solid>> {
    let raw = shape.get();
    let moves = carrier != Carrier::World;
    let kinds = || {
        KINDS
            .iter()
            .filter(move |kind| kind.2 || !moves)
            .map(|kind| kind.0)
    };
    let list = kinds()
        .map(|name| format!("\"{name}\""))
        .collect::<Vec<_>>()
        .join(", ");
    let hint = format!("kind is one of {list}");
    let key = format!("{table}.kind");
    let kind = source.required(&raw.kind, &key, Some(shape.span()), &hint)?;
    let name = kind.get().as_str();
    let Some((_, keys, _)) = KINDS.iter().find(|k| k.0 == name && (k.2 || !moves)) else {
        let message = format!("A shape of kind \"{name}\" is not known here.");
        let error = source.error(Code::InvalidValue, &key, kind.span(), message);
        return Err(error.hint(did_you_mean(name, kinds()).unwrap_or(hint)));
    };
    refuse_foreign_keys(source, raw, table, name, keys)?;
    let given = Given {
        source,
        shape,
        table,
        keys,
    };
    let made = match name {
        "mesh" => return mesh::solids(source, shape, table, carrier),
        "box" => {
            let turn = match &raw.rpy_deg {
                Some(list) => source.rotation(list, &format!("{table}.rpy_deg"))?,
                None => UnitQuaternion::identity(),
            };
            let pose = Isometry3::from_parts(Translation3::from(given.point("center_mm")?), turn);
            Solid::block(pose, given.point("size_mm")?)
        }
        "cylinder" => Solid::cylinder(
            given.point("from_mm")?,
            given.point("to_mm")?,
            given.radius()?,
        ),
        "capsule" => Capsule::new(
            given.point("from_mm")?,
            given.point("to_mm")?,
            given.radius()?,
        )
        .map(Solid::Capsule),
        "wall" => given.direction().map(|normal| {
            given
                .point("point_mm")
                .map(|point| Solid::HalfSpace { point, normal })
        })?,
        _ => {
            let key = format!("{table}.z_mm");
            let hint = "give the height in the base frame: z_mm";
            let z = source.number(
                source.required(&raw.z_mm, &key, Some(shape.span()), hint)?,
                &key,
            )?;
            let up = match name {
                "floor" => Vector3::z_axis(),
                _ => -Vector3::z_axis(),
            };
            Ok(Solid::HalfSpace {
                point: Vector3::z() * mm_to_m(z),
                normal: up,
            })
        }
    };
    made.map(|solid| vec![solid])
        .map_err(|error| match error.place().span {
            Some(_) => error,
            None => source.place(error, table, shape.span()),
        })
}

/// One shape's keys.
struct Given<'a, 's> {
    source: &'a Source<'s>,
    shape: &'a At<RawShape>,
    table: &'a str,
    keys: &'a [&'a str],
}

impl Given<'_, '_> {
    fn hint(&self) -> String {
        format!("give {}", self.keys.join(", "))
    }

    fn point(&self, name: &str) -> Result<Vector3<f64>> {
        let raw = self.shape.get();
        let list = match name {
            "center_mm" => &raw.center_mm,
            "size_mm" => &raw.size_mm,
            "from_mm" => &raw.from_mm,
            "to_mm" => &raw.to_mm,
            _ => &raw.point_mm,
        };
        let key = format!("{}.{name}", self.table);
        let list = self
            .source
            .required(list, &key, Some(self.shape.span()), &self.hint())?;
        Ok(self.source.vector(list, &key)?.map(mm_to_m))
    }

    fn radius(&self) -> Result<f64> {
        let key = format!("{}.radius_mm", self.table);
        let value = &self.shape.get().radius_mm;
        let value = self
            .source
            .required(value, &key, Some(self.shape.span()), &self.hint())?;
        Ok(mm_to_m(self.source.positive(value, &key)?))
    }

    fn direction(&self) -> Result<Unit<Vector3<f64>>> {
        let key = format!("{}.normal", self.table);
        let value = &self.shape.get().normal;
        let value = self
            .source
            .required(value, &key, Some(self.shape.span()), &self.hint())?;
        direction(self.source, value, &key)
    }
}

/// A direction of any length above zero.
pub(super) fn direction(
    source: &Source<'_>,
    list: &crate::files::cell::raw::Numbers,
    key: &str,
) -> Result<Unit<Vector3<f64>>> {
    let vector = source.vector(list, key)?;
    Unit::try_new(vector, 1e-12).ok_or_else(|| {
        let message = "A direction must not have length zero.";
        source.error(Code::InvalidValue, key, list.span(), message)
    })
}

/// A key of another kind of shape would be ignored; that is refused.
fn refuse_foreign_keys(
    source: &Source<'_>,
    raw: &RawShape,
    table: &str,
    kind: &str,
    keys: &[&str],
) -> Result<()> {
    let given: [(&str, Option<Range<usize>>); 12] = [
        ("center_mm", raw.center_mm.as_ref().map(At::span)),
        ("size_mm", raw.size_mm.as_ref().map(At::span)),
        ("rpy_deg", raw.rpy_deg.as_ref().map(At::span)),
        ("from_mm", raw.from_mm.as_ref().map(At::span)),
        ("to_mm", raw.to_mm.as_ref().map(At::span)),
        ("radius_mm", raw.radius_mm.as_ref().map(At::span)),
        ("z_mm", raw.z_mm.as_ref().map(At::span)),
        ("point_mm", raw.point_mm.as_ref().map(At::span)),
        ("normal", raw.normal.as_ref().map(At::span)),
        ("file", raw.file.as_ref().map(At::span)),
        ("unit", raw.unit.as_ref().map(At::span)),
        ("xyz_mm", raw.xyz_mm.as_ref().map(At::span)),
    ];
    for (key, span) in given {
        let Some(span) = span.filter(|_| !keys.contains(&key)) else {
            continue;
        };
        let message = format!("A shape of kind \"{kind}\" has no {key}.");
        let hint = format!("its keys are {}", keys.join(", "));
        let key = format!("{table}.{key}");
        return Err(source.error(Code::Conflict, &key, span, message).hint(hint));
    }
    Ok(())
}
