//! `[clearance]`, stations, reflectors, torques and displacements: what is asked of rope, beams and joints.

use super::shape::direction;
use crate::cell::raw::{RawCell, RawClearance};
use crate::cell::source::Source;
use crate::cell::value::{HasSpan, Spanned};
use nalgebra::Vector3;
use stiffarm::error::{Code, Result};
use stiffarm::model::implausible::tool_in_metres;
use stiffarm::model::load::Load;
use stiffarm::model::observation::Setup;
use stiffarm::model::scene::{DisplacementLimits, Facing, RopeRules, Scene, Sight, Station, TorqueLimits};
use stiffarm::model::stiffness::joint_compliance;
use stiffarm::units::{STANDARD_GRAVITY, deg_to_rad, mm_to_m};

/// Distance kept between rope and shapes where the cell says nothing \[mm\].
const ROPE_MM: f64 = 20.0;
/// Length at each end of the rope that may touch what it is fixed to \[mm\].
const FREE_MM: [f64; 2] = [100.0, 100.0];
/// Distance kept between beams and shapes \[mm\].
const SIGHT_MM: f64 = 5.0;
/// Acceptance angle of a corner-cube reflector to either side of its axis \[deg\].
const ACCEPTANCE_DEG: f64 = 30.0;

/// Pairs that may come as near as they like.
pub(super) fn ignored(source: &Source<'_>, table: Option<&RawClearance>) -> Result<Vec<(String, String)>> {
    let Some(list) = table.and_then(|table| table.ignore.as_ref()) else {
        return Ok(Vec::new());
    };
    source.each(list, |source, pair| {
        source.count(pair, 2, "names", "of two shapes")?;
        let names = source.each(pair, Source::name)?;
        Ok((names[0].clone(), names[1].clone()))
    })
}

/// What is asked of the rope, where the load is one.
pub(super) fn rope(
    source: &Source<'_>,
    table: Option<&RawClearance>,
    setup: &Setup,
    has_parts: bool,
) -> Result<Option<RopeRules>> {
    let is_rope = setup.load.has_rope();
    if let (Some(table), false) = (table, is_rope) {
        let rope_keys = [
            ("rope_mm", table.rope_mm.as_ref().map(HasSpan::span)),
            ("rope_free_mm", table.rope_free_mm.as_ref().map(HasSpan::span)),
            ("rope_axis", table.rope_axis.as_ref().map(HasSpan::span)),
            ("rope_cone_deg", table.rope_cone_deg.as_ref().map(HasSpan::span)),
        ];
        let mut rope_keys = rope_keys.into_iter();
        if let Some((key, Some(span))) = rope_keys.find(|(_, span)| span.is_some()) {
            let message = format!("{key} needs a load of kind \"rope\", or \"cylinder\" with anchor_mm.");
            let key = format!("clearance.{key}");
            let error = source.error_at(Code::Conflict, &key, span, message);
            return Err(error.hint("remove it, or set load.kind = \"rope\" or \"cylinder\""));
        }
    }
    if !is_rope {
        return Ok(None);
    }
    let clearance = match table.and_then(|table| table.rope_mm.as_ref()) {
        Some(value) => source.not_negative(value)?,
        None => mm_to_m(ROPE_MM),
    };
    let free = match table.and_then(|table| table.rope_free_mm.as_ref()) {
        Some(list) => {
            let what = "at the loading point, at the anchor";
            source.count(&list.0, 2, "numbers", what)?;
            let values = source.each(&list.0, Source::not_negative)?;
            [values[0], values[1]]
        }
        None => FREE_MM.map(mm_to_m),
    };
    let hint = "the cone needs both rope_axis (from the anchor outwards) and rope_cone_deg";
    let cone = match table.map(|table| (&table.rope_axis, &table.rope_cone_deg)) {
        None | Some((None, None)) => None,
        Some((Some(axis), Some(angle))) => Some((direction(source, axis)?, source.positive(angle)?)),
        Some((Some(axis), None)) => {
            return Err(source.missing(axis, "clearance.rope_cone_deg", hint));
        }
        Some((None, Some(angle))) => {
            return Err(source.missing(angle, "clearance.rope_axis", hint));
        }
    };
    Ok((has_parts || cone.is_some()).then_some(RopeRules { clearance: has_parts.then_some(clearance), free, cone }))
}

/// What is asked of the tracker's beams, where its stations are given.
pub(super) fn sight(source: &Source<'_>, raw: &RawCell, setup: &Setup) -> Result<Option<Sight>> {
    let clearance = raw.clearance.as_ref().map(Spanned::get);
    let tracker = raw.tracker.as_ref().map(Spanned::get);
    let Some(list) = tracker.and_then(|tracker| tracker.station.as_ref()) else {
        let alone = clearance.and_then(|table| {
            let points = table.visible_points.as_ref().map(HasSpan::span);
            let distance = table.sight_mm.as_ref().map(HasSpan::span);
            let points = points.map(|span| ("visible_points", span));
            points.or(distance.map(|span| ("sight_mm", span)))
        });
        return match alone {
            None => Ok(None),
            Some((key, span)) => {
                let message = "Lines of sight need a station of the tracker.";
                let key = format!("clearance.{key}");
                let error = source.error_at(Code::MissingKey, &key, span, message);
                Err(error.hint("add [[tracker.station]] with name and position_mm"))
            }
        };
    };
    let mut stations: Vec<Station> = Vec::new();
    for station in list.get() {
        let raw = station.get();
        let name = source.required(station, &raw.name, "name", "give the station a name")?;
        let name = source.unique_name(name, stations.iter().map(|s| s.name.as_str()))?;
        let hint = "give where the beam goes out: position_mm = [x, y, z] in the base frame";
        let position = source.required(station, &raw.position_mm, "position_mm", hint)?;
        let position = source.vector(position)?;
        stations.push(Station { name, position });
    }
    if stations.is_empty() {
        return Ok(None);
    }
    let points = raw.tool.as_ref().and_then(|tool| tool.get().measuring_point.as_ref());
    let mut facings = Vec::new();
    for point in points.into_iter().flat_map(Spanned::get) {
        let raw = point.get();
        facings.push(source.optional(&raw.axis, |source, axis| {
            let acceptance = source.optional(&raw.acceptance_deg, Source::positive)?;
            Ok(Facing { axis: direction(source, axis)?, acceptance: acceptance.unwrap_or(deg_to_rad(ACCEPTANCE_DEG)) })
        })?);
    }
    let all = setup.tool.point_count();
    let visible_points = match clearance.and_then(|table| table.visible_points.as_ref()) {
        None => all,
        Some(value) => {
            let number = usize::try_from(*value.get()).ok().filter(|v| (1..=all).contains(v));
            number.ok_or_else(|| {
                let message =
                    format!("visible_points must be 1 to {all}, the number of measuring points, got {}.", value.get());
                source.error(Code::InvalidValue, value, message)
            })?
        }
    };
    let distance = match clearance.and_then(|table| table.sight_mm.as_ref()) {
        Some(value) => source.not_negative(value)?,
        None => mm_to_m(SIGHT_MM),
    };
    Ok(Some(Sight { stations, facings, clearance: distance, visible_points }))
}

/// What the joints may carry, with the tool's weight.
pub(super) fn torque(source: &Source<'_>, raw: &RawCell, setup: &Setup) -> Result<Option<TorqueLimits>> {
    let robot = raw.robot.as_ref().map(Spanned::get);
    let tool = raw.tool.as_ref().map(Spanned::get);
    let mass = tool.and_then(|tool| tool.mass_kg.as_ref());
    let Some(list) = robot.and_then(|robot| robot.torque_limits_nm.as_ref()) else {
        if let Some(mass) = mass {
            let message = "The tool's mass counts against the joints' largest torques, which are not given.";
            let error = source.error(Code::MissingKey, mass, message);
            return Err(error.hint("add robot.torque_limits_nm, or remove mass_kg"));
        }
        return Ok(None);
    };
    let largest = source.positives(list, setup.robot.joint_count(), "one per joint")?;
    let mass = mass.map_or(Ok(0.0), |mass| source.not_negative(mass))?;
    let centre = tool.and_then(|tool| tool.centre_of_mass_mm.as_ref());
    let centre = centre.map_or(Ok(Vector3::zeros()), |centre| source.vector(centre))?;
    Ok(Some(TorqueLimits { largest, tool_weight: mass * STANDARD_GRAVITY, centre_of_mass: centre }))
}

/// How far the load may move the measuring points, by the prior stiffness.
pub(super) fn displacement(
    source: &Source<'_>,
    raw: &RawCell,
    setup: &Setup,
    prior: Option<&[f64]>,
) -> Result<Option<DisplacementLimits>> {
    let limits = raw.limits.as_ref().map(Spanned::get);
    let Some(list) = limits.and_then(|limits| limits.displacement_mm.as_ref()) else {
        return Ok(None);
    };
    let [least, most] = source.range(list)?;
    source.not_negative(&list.0.get()[0])?;
    if setup.load == Load::Measured {
        let message = "A limit of the displacement needs a load that is known before it is measured.";
        let error = source.error(Code::Conflict, list, message);
        return Err(error.hint(
            "remove displacement_mm, or set load.kind to \"rope\", \"cylinder\", \"weight\" or \"wrench\" as the load \
             will be",
        ));
    }
    let Some(prior) = prior else {
        let message = "A limit of the displacement needs a prior joint stiffness, and the cell has none.";
        let error = source.error(Code::MissingKey, list, message);
        return Err(error.hint("add [stiffness] with prior_nm_per_rad, or remove displacement_mm"));
    };
    Ok(Some(DisplacementLimits {
        smallest: (least > 0.0).then_some(least),
        largest: Some(most),
        compliance: joint_compliance(&setup.robot, prior)?,
    }))
}

/// Stations inside obstacles and measuring points inside the tool: no posture could mend those.
pub(super) fn check_places(source: &Source<'_>, raw: &RawCell, setup: &Setup, scene: &Scene) -> Result<()> {
    let Some(sight) = scene.sight() else {
        return Ok(());
    };
    let stations = raw.tracker.as_ref().and_then(|t| t.get().station.as_ref());
    let stations = stations.into_iter().flat_map(Spanned::get);
    for (raw, station) in stations.zip(&sight.stations) {
        let Some((depth, name)) = scene.depth_in_surroundings(&station.position) else {
            continue;
        };
        if depth < sight.clearance {
            let message = if depth < 0.0 {
                format!("Station \"{}\" is {:.0} mm inside \"{name}\".", station.name, -depth * 1e3)
            } else {
                format!(
                    "Station \"{}\" is {:.0} mm from \"{name}\", nearer than its beam may come.",
                    station.name,
                    depth * 1e3
                )
            };
            let key = source.path_in(raw, "position_mm");
            let error = source.error_at(Code::InvalidValue, &key, raw.span(), message);
            return Err(error.hint("give the station in the base frame, in mm, outside of every shape"));
        }
    }
    let points = raw.tool.as_ref().and_then(|tool| tool.get().measuring_point.as_ref());
    let points = points.into_iter().flat_map(Spanned::get).zip(&setup.tool.measuring_points);
    for (raw, point) in points {
        let Some((depth, name)) = scene.depth_in_tool(&point.position) else {
            continue;
        };
        if depth < sight.clearance {
            let message = if depth < 0.0 {
                format!(
                    "Measuring point {} is {:.0} mm inside \"{name}\": no beam reaches it.",
                    point.name,
                    -depth * 1e3
                )
            } else {
                format!(
                    "Measuring point {} is {:.1} mm from \"{name}\", and beams keep {:.1} mm from every shape: none \
                     reaches it.",
                    point.name,
                    depth * 1e3,
                    sight.clearance * 1e3
                )
            };
            let key = source.path_in(raw, "position_mm");
            let error = source.error_at(Code::InvalidValue, &key, raw.span(), message);
            let metres = tool_in_metres(&point.position).filter(|_| point.position.norm() > 0.0);
            return Err(match metres {
                Some(said) => error.hint(format!("the point {said}")),
                None => error.hint("correct the point or the shape, or set clearance.sight_mm lower"),
            });
        }
    }
    Ok(())
}
