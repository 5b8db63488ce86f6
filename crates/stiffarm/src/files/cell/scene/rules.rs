//! `[clearance]`, stations, reflectors, torques and displacements: what is asked of rope, beams and joints.

use super::shape::direction;
use crate::error::{Code, Result};
use crate::files::cell::raw::{At, RawCell, RawClearance};
use crate::files::cell::source::Source;
use crate::model::implausible::tool_in_metres;
use crate::model::load::Load;
use crate::model::observation::Setup;
use crate::model::scene::{
    DisplacementLimits, Facing, RopeRules, Scene, Sight, Station, TorqueLimits,
};
use crate::model::stiffness::joint_compliance;
use crate::units::{STANDARD_GRAVITY, deg_to_rad, mm_to_m};
use nalgebra::Vector3;

/// Distance kept between rope and shapes where the cell says nothing \[mm\].
const ROPE_MM: f64 = 20.0;
/// Length at each end of the rope that may touch what it is fixed to \[mm\].
const FREE_MM: [f64; 2] = [100.0, 100.0];
/// Distance kept between beams and shapes \[mm\].
const SIGHT_MM: f64 = 5.0;
/// Acceptance angle of a corner-cube reflector to either side of its axis \[deg\].
const ACCEPTANCE_DEG: f64 = 30.0;

/// Pairs that may come as near as they like.
pub(super) fn ignored(
    source: &Source<'_>,
    table: Option<&RawClearance>,
) -> Result<Vec<(String, String)>> {
    let Some(list) = table.and_then(|table| table.ignore.as_ref()) else {
        return Ok(Vec::new());
    };
    source.each(list, "clearance.ignore", |pair, key| {
        source.rows(pair, key, 2, "names", "of two shapes")?;
        let names = source.each(pair, key, |name, key| source.name(name, key))?;
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
        let given = [
            ("rope_mm", table.rope_mm.as_ref().map(At::span)),
            ("rope_free_mm", table.rope_free_mm.as_ref().map(At::span)),
            ("rope_axis", table.rope_axis.as_ref().map(At::span)),
            ("rope_cone_deg", table.rope_cone_deg.as_ref().map(At::span)),
        ];
        for (key, span) in given {
            let Some(span) = span else { continue };
            let message =
                format!("{key} needs a load of kind \"rope\", or \"cylinder\" with anchor_mm.");
            let key = format!("clearance.{key}");
            let error = source.error(Code::Conflict, &key, span, message);
            return Err(error.hint("remove it, or set load.kind = \"rope\" or \"cylinder\""));
        }
    }
    if !is_rope {
        return Ok(None);
    }
    let clearance_mm = match table.and_then(|table| table.rope_mm.as_ref()) {
        Some(value) => source.not_negative(value, "clearance.rope_mm")?,
        None => ROPE_MM,
    };
    let free_mm = match table.and_then(|table| table.rope_free_mm.as_ref()) {
        Some(list) => {
            let key = "clearance.rope_free_mm";
            source.rows(
                list,
                key,
                2,
                "numbers",
                "at the loading point, at the anchor",
            )?;
            let values = source.each(list, key, |value, key| source.not_negative(value, key))?;
            [values[0], values[1]]
        }
        None => FREE_MM,
    };
    let cone = match table.map(|table| (&table.rope_axis, &table.rope_cone_deg)) {
        None | Some((None, None)) => None,
        Some((axis, angle)) => {
            let hint = "the cone needs both rope_axis (from the anchor outwards) and rope_cone_deg";
            let at = axis.as_ref().map(At::span).or(angle.as_ref().map(At::span));
            let axis = source.required(axis, "clearance.rope_axis", at.clone(), hint)?;
            let angle = source.required(angle, "clearance.rope_cone_deg", at, hint)?;
            let axis = direction(source, axis, "clearance.rope_axis")?;
            Some((
                axis,
                deg_to_rad(source.positive(angle, "clearance.rope_cone_deg")?),
            ))
        }
    };
    Ok((has_parts || cone.is_some()).then_some(RopeRules {
        clearance: has_parts.then_some(mm_to_m(clearance_mm)),
        free: free_mm.map(mm_to_m),
        cone,
    }))
}

/// What is asked of the tracker's beams, where its stations are given.
pub(super) fn sight(source: &Source<'_>, raw: &RawCell, setup: &Setup) -> Result<Option<Sight>> {
    let clearance = raw.clearance.as_ref().map(At::get);
    let tracker = raw.tracker.as_ref().map(At::get);
    let Some(list) = tracker.and_then(|tracker| tracker.station.as_ref()) else {
        let alone = clearance.and_then(|table| {
            let points = table
                .visible_points
                .as_ref()
                .map(|p| ("visible_points", p.span()));
            points.or(table.sight_mm.as_ref().map(|v| ("sight_mm", v.span())))
        });
        return match alone {
            None => Ok(None),
            Some((key, span)) => {
                let message = "Lines of sight need a station of the tracker.";
                let key = format!("clearance.{key}");
                let error = source.error(Code::MissingKey, &key, span, message);
                Err(error.hint("add [[tracker.station]] with name and position_mm"))
            }
        };
    };
    let mut stations: Vec<Station> = Vec::new();
    for (i, station) in list.get().iter().enumerate() {
        let key = format!("tracker.station[{}]", i + 1);
        let (raw, at) = (station.get(), Some(station.span()));
        let name_key = format!("{key}.name");
        let name = source.required(&raw.name, &name_key, at.clone(), "give the station a name")?;
        let others = stations.iter().map(|s| s.name.as_str());
        let name = source.unique_name(name, &name_key, others)?;
        let key = format!("{key}.position_mm");
        let hint = "give where the beam goes out: position_mm = [x, y, z] in the base frame";
        let position = source.vector(source.required(&raw.position_mm, &key, at, hint)?, &key)?;
        stations.push(Station {
            name,
            position: position.map(mm_to_m),
        });
    }
    if stations.is_empty() {
        return Ok(None);
    }
    let points = raw
        .tool
        .as_ref()
        .and_then(|tool| tool.get().measuring_point.as_ref());
    let mut facings = Vec::new();
    for (i, point) in points.into_iter().flat_map(At::get).enumerate() {
        let key = format!("tool.measuring_point[{}]", i + 1);
        let raw = point.get();
        facings.push(match &raw.axis {
            None => None,
            Some(axis) => {
                let acceptance = match &raw.acceptance_deg {
                    Some(angle) => source.positive(angle, &format!("{key}.acceptance_deg"))?,
                    None => ACCEPTANCE_DEG,
                };
                Some(Facing {
                    axis: direction(source, axis, &format!("{key}.axis"))?,
                    acceptance: deg_to_rad(acceptance),
                })
            }
        });
    }
    let all = setup.tool.point_count();
    let visible_points = match clearance.and_then(|table| table.visible_points.as_ref()) {
        None => all,
        Some(value) => {
            let number = usize::try_from(*value.get())
                .ok()
                .filter(|v| (1..=all).contains(v));
            number.ok_or_else(|| {
                let message = format!(
                    "visible_points must be 1 to {all}, the number of measuring points, got {}.",
                    value.get()
                );
                source.error(
                    Code::InvalidValue,
                    "clearance.visible_points",
                    value.span(),
                    message,
                )
            })?
        }
    };
    let clearance_mm = match clearance.and_then(|table| table.sight_mm.as_ref()) {
        Some(value) => source.not_negative(value, "clearance.sight_mm")?,
        None => SIGHT_MM,
    };
    Ok(Some(Sight {
        stations,
        facings,
        clearance: mm_to_m(clearance_mm),
        visible_points,
    }))
}

/// What the joints may carry, with the tool's weight.
pub(super) fn torque(
    source: &Source<'_>,
    raw: &RawCell,
    setup: &Setup,
) -> Result<Option<TorqueLimits>> {
    let robot = raw.robot.as_ref().map(At::get);
    let tool = raw.tool.as_ref().map(At::get);
    let mass = tool.and_then(|tool| tool.mass_kg.as_ref());
    let Some(list) = robot.and_then(|robot| robot.torque_limits_nm.as_ref()) else {
        if let Some(mass) = mass {
            let message =
                "The tool's mass counts against the joints' largest torques, which are not given.";
            let error = source.error(Code::MissingKey, "tool.mass_kg", mass.span(), message);
            return Err(error.hint("add robot.torque_limits_nm, or remove mass_kg"));
        }
        return Ok(None);
    };
    let key = "robot.torque_limits_nm";
    let largest = source.positives(list, key, setup.robot.joint_count(), "one per joint")?;
    let mass = match mass {
        Some(mass) => source.not_negative(mass, "tool.mass_kg")?,
        None => 0.0,
    };
    let centre = match tool.and_then(|tool| tool.centre_of_mass_mm.as_ref()) {
        Some(list) => source.vector(list, "tool.centre_of_mass_mm")?.map(mm_to_m),
        None => Vector3::zeros(),
    };
    Ok(Some(TorqueLimits {
        largest,
        tool_weight: mass * STANDARD_GRAVITY,
        centre_of_mass: centre,
    }))
}

/// How far the load may move the measuring points, by the prior stiffness.
pub(super) fn displacement(
    source: &Source<'_>,
    raw: &RawCell,
    setup: &Setup,
    prior: Option<&[f64]>,
) -> Result<Option<DisplacementLimits>> {
    let limits = raw.limits.as_ref().map(At::get);
    let Some(list) = limits.and_then(|limits| limits.displacement_mm.as_ref()) else {
        return Ok(None);
    };
    let key = "limits.displacement_mm";
    let [least, most] = source.range(list, key)?.map(mm_to_m);
    source.not_negative(&list.get()[0], "limits.displacement_mm[1]")?;
    if setup.load == Load::Measured {
        let message =
            "A limit of the displacement needs a load that is known before it is measured.";
        let error = source.error(Code::Conflict, key, list.span(), message);
        return Err(error.hint(
            "remove displacement_mm, or set load.kind to \"rope\", \"cylinder\", \"weight\" or \"wrench\" as the load will be",
        ));
    }
    let Some(prior) = prior else {
        let message =
            "A limit of the displacement needs a prior joint stiffness, and the cell has none.";
        let error = source.error(Code::MissingKey, key, list.span(), message);
        return Err(error.hint("add [stiffness] with prior_nm_per_rad, or remove displacement_mm"));
    };
    Ok(Some(DisplacementLimits {
        smallest: (least > 0.0).then_some(least),
        largest: Some(most),
        compliance: joint_compliance(&setup.robot, prior)?,
    }))
}

/// Stations inside obstacles and measuring points inside the tool: no posture could mend those.
pub(super) fn check_places(
    source: &Source<'_>,
    raw: &RawCell,
    setup: &Setup,
    scene: &Scene,
) -> Result<()> {
    let Some(sight) = scene.sight() else {
        return Ok(());
    };
    let stations = raw.tracker.as_ref().and_then(|t| t.get().station.as_ref());
    for (i, (raw, station)) in stations
        .into_iter()
        .flat_map(At::get)
        .zip(&sight.stations)
        .enumerate()
    {
        let Some((depth, name)) = scene.depth_in_surroundings(&station.position) else {
            continue;
        };
        if depth < sight.clearance {
            let message = match depth < 0.0 {
                true => format!(
                    "Station \"{}\" is {:.0} mm inside \"{name}\".",
                    station.name,
                    -depth * 1e3
                ),
                false => format!(
                    "Station \"{}\" is {:.0} mm from \"{name}\", nearer than its beam may come.",
                    station.name,
                    depth * 1e3
                ),
            };
            let key = format!("tracker.station[{}].position_mm", i + 1);
            let error = source.error(Code::InvalidValue, &key, raw.span(), message);
            return Err(
                error.hint("give the station in the base frame, in mm, outside of every shape")
            );
        }
    }
    let points = raw
        .tool
        .as_ref()
        .and_then(|tool| tool.get().measuring_point.as_ref());
    let points = points
        .into_iter()
        .flat_map(At::get)
        .zip(&setup.tool.measuring_points);
    for (i, (raw, point)) in points.enumerate() {
        let Some((depth, name)) = scene.depth_in_tool(&point.position) else {
            continue;
        };
        if depth < sight.clearance {
            let message = match depth < 0.0 {
                true => format!(
                    "Measuring point {} is {:.0} mm inside \"{name}\": no beam reaches it.",
                    point.name,
                    -depth * 1e3
                ),
                false => format!(
                    "Measuring point {} is {:.1} mm from \"{name}\", and beams keep {:.1} mm from every shape: none reaches it.",
                    point.name,
                    depth * 1e3,
                    sight.clearance * 1e3
                ),
            };
            let key = format!("tool.measuring_point[{}].position_mm", i + 1);
            let error = source.error(Code::InvalidValue, &key, raw.span(), message);
            let metres = tool_in_metres(&point.position).filter(|_| point.position.norm() > 0.0);
            return Err(match metres {
                Some(said) => error.hint(format!("the point {said}")),
                None => {
                    error.hint("correct the point or the shape, or set clearance.sight_mm lower")
                }
            });
        }
    }
    Ok(())
}
