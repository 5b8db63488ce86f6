//! `[[robot.shape]]`, `[[tool.shape]]`, `[[obstacle]]`, `[clearance]`, `[[tracker.station]]`: what a
//! posture must not touch and must not hide.

mod mesh;
mod rules;
mod shape;

use super::raw::{RawCell, RawLinkShape};
use super::source::Source;
use super::value::{HasSpan, Spanned};
use stiffarm::error::{Code, Result};
use stiffarm::model::observation::Setup;
use stiffarm::model::robot::{LinkCapsule, Robot};
use stiffarm::model::scene::{Carrier, Part, Scene, SceneParts};
use stiffarm::model::shape::Capsule;
use stiffarm::units::mm_to_m;

/// Distance kept between shapes where the cell says nothing \[mm\].
const CLEARANCE_MM: f64 = 20.0;

/// The scene of a cell whose robot, tool, load, bounds and prior stiffness are read.
pub(super) fn scene(
    source: &Source<'_>,
    raw: &RawCell,
    setup: &Setup,
    bounds: &[[f64; 2]],
    prior: Option<&[f64]>,
) -> Result<Scene> {
    let mut parts = Part::of_links(&setup.robot);
    let tool = raw.tool.as_ref().and_then(|tool| tool.get().shape.as_ref());
    if let Some(shapes) = tool {
        parts.extend(shape::parts(source, shapes, Carrier::Flange, &parts)?);
    }
    if let Some(shapes) = &raw.obstacle {
        parts.extend(shape::parts(source, shapes, Carrier::World, &parts)?);
    }
    let clearance = raw.clearance.as_ref().map(Spanned::get);
    let shapes = match clearance.and_then(|table| table.shapes_mm.as_ref()) {
        Some(value) => source.not_negative(value)?,
        None => mm_to_m(CLEARANCE_MM),
    };
    let has_parts = !parts.is_empty();
    let scene = SceneParts {
        parts,
        clearance: shapes,
        ignored: rules::ignored(source, clearance)?.into_iter().chain(Part::ignored_links(&setup.robot)).collect(),
        rope: rules::rope(source, clearance, setup, has_parts)?,
        sight: rules::sight(source, raw, setup)?,
        torque: rules::torque(source, raw, setup)?,
        displacement: rules::displacement(source, raw, setup, prior)?,
    };
    let scene = scene.build(&setup.robot, bounds).map_err(|error| {
        let list = clearance.and_then(|table| table.ignore.as_ref());
        match (list, error.code()) {
            (Some(list), Code::UnknownName) => source.place(error, list),
            _ => error,
        }
    })?;
    rules::check_places(source, raw, setup, &scene)?;
    Ok(scene)
}

/// The robot with the capsules of `[[robot.shape]]`, where there are any, instead of the catalogue's.
pub(super) fn with_link_shapes(
    source: &Source<'_>,
    robot: Robot,
    shapes: Option<&Spanned<Vec<Spanned<RawLinkShape>>>>,
) -> Result<Robot> {
    let Some(shapes) = shapes else {
        return Ok(robot);
    };
    let n = robot.joint_count();
    let mut capsules = Vec::new();
    for entry in shapes.get() {
        let raw = entry.get();
        let hint = "give the link: 0 for the base, i for what moves with joint i";
        let link = source.required(entry, &raw.link, "link", hint)?;
        let number = usize::try_from(*link.get()).ok().filter(|link| *link <= n);
        let number = number.ok_or_else(|| {
            let message = format!("There is no link {}: the robot has links 0 to {n}.", link.get());
            let error = source.error(Code::InvalidValue, link, message);
            error.hint(hint)
        })?;
        let hint = "give both ends and the radius: from_mm, to_mm, radius_mm";
        let from = source.vector(source.required(entry, &raw.from_mm, "from_mm", hint)?)?;
        let to = source.vector(source.required(entry, &raw.to_mm, "to_mm", hint)?)?;
        let radius = source.required(entry, &raw.radius_mm, "radius_mm", hint)?;
        let radius = source.positive(radius)?;
        let capsule = source.placed(entry, Capsule::new(from, to, radius))?;
        capsules.push(LinkCapsule { link: number, capsule: capsule.placed(&robot.row_frame(number)) });
    }
    robot.with_link_capsules(capsules, Vec::new()).map_err(|error| source.place_at(error, "robot.shape", shapes.span()))
}
