//! `[robot]` and `[bounds]`: from raw keys to a chain with limits.

use super::raw::{RawBounds, RawRobot};
use super::source::Source;
use super::value::{Deg, Fixed, HasSpan, List, Mm, Number, Spanned, Unit};
use crate::table::other_convention;
use nalgebra::{Isometry3, Translation3};
use stiffarm::error::{Code, Result};
use stiffarm::model::robot::{CatalogueEntry, Controller, DhConvention, DhRow, Robot, find_in_catalogue};
use stiffarm::units::rad_to_shortest_deg;

/// The robot, and its catalogue entry where it comes from there.
pub(super) fn robot(
    source: &Source<'_>,
    table: &Spanned<RawRobot>,
) -> Result<(Robot, Option<&'static CatalogueEntry>)> {
    let raw = table.get();
    let (mut robot, entry) = chain(source, table)?;
    let n = robot.joint_count();
    if let Some(tilts) = &raw.tilts_deg {
        if raw.dh_modified.is_none() {
            let message = "Tilts go with rows of dh_modified, which are not given.";
            return Err(source.error(Code::Conflict, tilts, message));
        }
        let values = source.numbers(tilts, n, "one per joint")?;
        robot = source.placed(tilts, robot.with_tilts(&values))?;
    }
    if let Some(pose) = pose(source, &raw.flange_xyz_mm, &raw.flange_rpy_deg)? {
        robot = robot.with_flange(&pose);
    }
    if let Some(name) = &raw.name {
        robot = robot.with_name(source.name(name)?);
    }
    if let Some(names) = &raw.joint_names {
        source.count(names, n, "names", "one per joint")?;
        let values = source.each(names, Source::name)?;
        robot = source.placed(names, robot.with_joint_names(&values))?;
    }
    if let Some(name) = &raw.controller {
        let controller = source.placed(name, Controller::from_name(name.get()))?;
        robot = robot.with_controller(controller);
    }
    if let Some(rows) = &raw.theta_from_q {
        let coupling = source.matrix(rows, n)?;
        robot = source.placed(rows, robot.with_coupling(coupling))?;
    }
    if let Some(rows) = &raw.elastic_from_theta {
        let elastic = source.matrix(rows, n)?;
        robot = source.placed(rows, robot.with_elastic_coordinates(elastic))?;
    }
    if let Some(pose) = base(source, raw)? {
        robot = robot.with_base(&pose);
    }
    if let Some(rows) = &raw.limits_deg {
        let limits = source.ranges(rows, n, Source::range)?;
        robot = source.placed(rows, robot.with_limits(&limits))?;
    }
    if let Some(down) = &raw.down {
        let direction = source.vector(down)?;
        robot = source.placed(down, robot.with_gravity_direction(direction))?;
    }
    Ok((robot, entry))
}

/// The chain from exactly one of catalogue, modified and standard rows.
fn chain(source: &Source<'_>, table: &Spanned<RawRobot>) -> Result<(Robot, Option<&'static CatalogueEntry>)> {
    let raw = table.get();
    let mut present_keys: Vec<_> = [
        ("catalogue", raw.catalogue.as_ref().map(Spanned::span)),
        ("dh_modified", raw.dh_modified.as_ref().map(Spanned::span)),
        ("dh_standard", raw.dh_standard.as_ref().map(Spanned::span)),
    ]
    .into_iter()
    .filter_map(|(name, span)| Some((name, span?)))
    .collect();
    present_keys.sort_by_key(|(_, span)| span.start);
    if let [(first, _), (second, span), ..] = present_keys.as_slice() {
        let message = format!("The robot is given twice: robot.{first} is there already.");
        let key = source.path_in(table, second);
        let error = source.error_at(Code::Conflict, &key, span.clone(), message);
        return Err(error.hint("keep one of catalogue, dh_modified, dh_standard"));
    }
    if let Some(name) = &raw.catalogue {
        let entry = source.placed(name, find_in_catalogue(name.get()))?;
        return Ok((source.placed(name, entry.robot())?, Some(entry)));
    }
    let (convention, rows) = match (&raw.dh_modified, &raw.dh_standard) {
        (Some(rows), _) => (DhConvention::Modified, rows),
        (None, Some(rows)) => (DhConvention::Standard, rows),
        (None, None) => {
            let message = "The robot is not given.";
            let key = source.path_in(table, "catalogue");
            let error = source.error_at(Code::MissingKey, &key, table.span(), message);
            return Err(
                error.hint("give catalogue = \"…\" (stiffarm robots lists the names), or dh_modified, or dh_standard")
            );
        }
    };
    let values = source.each(rows, dh_row)?;
    if let Some(error) = other_convention(convention, &values) {
        return source.placed(rows, Err(error));
    }
    let robot = Robot::from_dh("robot", convention, &values, Isometry3::identity());
    Ok((source.placed(rows, robot)?, None))
}

fn dh_row(source: &Source<'_>, row: &Fixed<4>) -> Result<DhRow> {
    let values = source.numbers(&row.0, 4, "[alpha_deg, a_mm, d_mm, offset_deg]")?;
    Ok(DhRow { alpha: Deg::si(values[0]), a: Mm::si(values[1]), d: Mm::si(values[2]), offset: Deg::si(values[3]) })
}

/// Pose of the robot's own base frame in the cell's base frame, where given.
fn base(source: &Source<'_>, raw: &RawRobot) -> Result<Option<Isometry3<f64>>> {
    let base_pose = pose(source, &raw.base_xyz_mm, &raw.base_rpy_deg)?;
    let Some(height) = &raw.base_z_mm else {
        return Ok(base_pose);
    };
    if let Some(xyz) = &raw.base_xyz_mm {
        let message = "The height of the base is given twice: robot.base_z_mm is there already.";
        let error = source.error(Code::Conflict, xyz, message);
        return Err(error.hint("keep base_xyz_mm alone; its third number is the height"));
    }
    let mut pose = base_pose.unwrap_or_default();
    pose.translation.z = source.number(height)?;
    Ok((pose != Isometry3::identity()).then_some(pose))
}

/// A pose as origin and roll, pitch, yaw; none where it changes nothing.
fn pose(
    source: &Source<'_>,
    xyz: &Option<Fixed<3, Mm>>,
    rpy: &Option<Fixed<3, Deg>>,
) -> Result<Option<Isometry3<f64>>> {
    let origin = source.optional(xyz, Source::vector)?.unwrap_or_default();
    let rotation = source.optional(rpy, Source::rotation)?.unwrap_or_default();
    let pose = Isometry3::from_parts(Translation3::from(origin), rotation);
    Ok((pose != Isometry3::identity()).then_some(pose))
}

/// Bounds for choosing postures: given and inside the machine's limits, or
/// those limits.
pub(super) fn bounds(source: &Source<'_>, table: Option<&Spanned<RawBounds>>, robot: &Robot) -> Result<Vec<[f64; 2]>> {
    let Some(rows) = table.and_then(|table| table.get().q_deg.as_ref()) else {
        return Ok(robot.joints().iter().map(|joint| joint.limits).collect());
    };
    let bounds = source.ranges(rows, robot.joint_count(), Source::range_or_place)?;
    for (j, (row, bounds)) in rows.get().iter().zip(&bounds).enumerate() {
        for (entry, angle) in row.0.get().iter().zip(bounds) {
            // The row of a joint is named, not one end of it.
            inside_limits(source, entry, robot, j, *angle).map_err(|e| e.key(format!("bounds.q_deg[{}]", j + 1)))?;
        }
    }
    Ok(bounds)
}

/// Checks one controller angle \[rad\] against the machine's limits.
fn inside_limits(source: &Source<'_>, entry: &Number<Deg>, robot: &Robot, joint: usize, angle: f64) -> Result<()> {
    let name = &robot.joints()[joint].name;
    let limits = robot.joints()[joint].limits;
    if (limits[0] - 1e-9..=limits[1] + 1e-9).contains(&angle) {
        return Ok(());
    }
    let [low, high] = limits.map(rad_to_shortest_deg);
    let message = format!("{name} at {}° is outside the machine's limits, {low}° to {high}°.", entry.get());
    let error = source.error(Code::OutsideLimits, entry, message);
    Err(error.hint("correct the angle, or set robot.limits_deg if the machine can go there"))
}

/// Angles of one posture \[rad\], inside the machine's limits.
pub(super) fn angles(source: &Source<'_>, list: &List<Deg>, robot: &Robot) -> Result<Vec<f64>> {
    let q = source.numbers(list, robot.joint_count(), "one angle per joint")?;
    for (j, (entry, angle)) in list.get().iter().zip(&q).enumerate() {
        inside_limits(source, entry, robot, j, *angle)?;
    }
    Ok(q)
}
