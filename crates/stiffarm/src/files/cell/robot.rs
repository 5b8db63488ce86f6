//! `[robot]` and `[bounds]`: from raw keys to a chain with limits.

use super::raw::{At, Numbers, RawBounds, RawRobot};
use super::source::Source;
use crate::error::{Code, Result};
use crate::model::robot::{
    CatalogueEntry, Controller, DhConvention, DhRow, Robot, find_in_catalogue,
};
use crate::units::{deg_to_rad, mm_to_m, rad_to_shortest_deg};
use nalgebra::{Isometry3, Translation3};

/// The robot, and its catalogue entry where it comes from there.
pub(super) fn robot(
    source: &Source<'_>,
    table: &At<RawRobot>,
) -> Result<(Robot, Option<&'static CatalogueEntry>)> {
    let raw = table.get();
    let (mut robot, entry) = chain(source, table)?;
    let n = robot.joint_count();
    if let Some(tilts) = &raw.tilts_deg {
        let key = "robot.tilts_deg";
        if raw.dh_modified.is_none() {
            let message = "Tilts go with rows of dh_modified, which are not given.";
            return Err(source.error(Code::Conflict, key, tilts.span(), message));
        }
        let tilts_read = source.numbers(tilts, key, n, "one per joint")?;
        let tilts_read: Vec<f64> = tilts_read.into_iter().map(deg_to_rad).collect();
        robot = robot
            .with_tilts(&tilts_read)
            .map_err(|e| source.place(e, key, tilts.span()))?;
    }
    let flange = ["robot.flange_xyz_mm", "robot.flange_rpy_deg"];
    if let Some(pose) = pose(source, [&raw.flange_xyz_mm, &raw.flange_rpy_deg], flange)? {
        robot = robot.with_flange(&pose);
    }
    if let Some(name) = &raw.name {
        robot = robot.with_name(source.name(name, "robot.name")?);
    }
    if let Some(names) = &raw.joint_names {
        let key = "robot.joint_names";
        source.rows(names, key, n, "names", "one per joint")?;
        let names_read = source.each(names, key, |name, key| source.name(name, key))?;
        robot = robot
            .with_joint_names(&names_read)
            .map_err(|e| source.place(e, key, names.span()))?;
    }
    if let Some(name) = &raw.controller {
        let controller = Controller::from_name(name.get())
            .map_err(|e| source.place(e, "robot.controller", name.span()))?;
        robot = robot.with_controller(controller);
    }
    if let Some(rows) = &raw.theta_from_q {
        let key = "robot.theta_from_q";
        robot = robot
            .with_coupling(source.matrix(rows, key, n)?)
            .map_err(|e| source.place(e, key, rows.span()))?;
    }
    if let Some(rows) = &raw.elastic_from_theta {
        let key = "robot.elastic_from_theta";
        robot = robot
            .with_elastic_coordinates(source.matrix(rows, key, n)?)
            .map_err(|e| source.place(e, key, rows.span()))?;
    }
    if let Some(pose) = base(source, raw)? {
        robot = robot.with_base(&pose);
    }
    if let Some(rows) = &raw.limits_deg {
        let key = "robot.limits_deg";
        let limits = source.ranges(rows, key, n, Source::range)?;
        robot = robot
            .with_limits(&radians(&limits))
            .map_err(|e| source.place(e, key, rows.span()))?;
    }
    if let Some(down) = &raw.down {
        let key = "robot.down";
        robot = robot
            .with_gravity_direction(source.vector(down, key)?)
            .map_err(|e| source.place(e, key, down.span()))?;
    }
    Ok((robot, entry))
}

/// The chain from exactly one of catalogue, modified and standard rows.
fn chain(
    source: &Source<'_>,
    table: &At<RawRobot>,
) -> Result<(Robot, Option<&'static CatalogueEntry>)> {
    let raw = table.get();
    let spans = [
        raw.catalogue
            .as_ref()
            .map(|v| ("robot.catalogue", v.span())),
        raw.dh_modified
            .as_ref()
            .map(|v| ("robot.dh_modified", v.span())),
        raw.dh_standard
            .as_ref()
            .map(|v| ("robot.dh_standard", v.span())),
    ];
    let mut given: Vec<_> = spans.into_iter().flatten().collect();
    given.sort_by_key(|(_, span)| span.start);
    if let [(first, _), (second, span), ..] = given.as_slice() {
        let message = format!("The robot is given twice: {first} is there already.");
        return Err(source
            .error(Code::Conflict, second, span.clone(), message)
            .hint("keep one of catalogue, dh_modified, dh_standard"));
    }
    if let Some(name) = &raw.catalogue {
        let key = "robot.catalogue";
        let entry = find_in_catalogue(name.get()).map_err(|e| source.place(e, key, name.span()))?;
        let robot = entry
            .robot()
            .map_err(|e| source.place(e, key, name.span()))?;
        return Ok((robot, Some(entry)));
    }
    let (convention, rows, key) = match (&raw.dh_modified, &raw.dh_standard) {
        (Some(rows), _) => (DhConvention::Modified, rows, "robot.dh_modified"),
        (None, Some(rows)) => (DhConvention::Standard, rows, "robot.dh_standard"),
        (None, None) => {
            let message = "The robot is not given.";
            let error = source.error(Code::MissingKey, "robot.catalogue", table.span(), message);
            return Err(error.hint(
                "give catalogue = \"…\" (stiffarm robots lists the names), or dh_modified, or dh_standard",
            ));
        }
    };
    let rows_read = source.each(rows, key, |row, key| dh_row(source, row, key))?;
    let robot = Robot::from_dh("robot", convention, &rows_read, Isometry3::identity())
        .map_err(|e| source.place(e, key, rows.span()))?;
    Ok((robot, None))
}

fn dh_row(source: &Source<'_>, row: &Numbers, key: &str) -> Result<DhRow> {
    let values = source.numbers(row, key, 4, "[alpha_deg, a_mm, d_mm, offset_deg]")?;
    Ok(DhRow {
        alpha: deg_to_rad(values[0]),
        a: mm_to_m(values[1]),
        d: mm_to_m(values[2]),
        offset: deg_to_rad(values[3]),
    })
}

/// Pose of the robot's own base frame in the cell's base frame, where given.
fn base(source: &Source<'_>, raw: &RawRobot) -> Result<Option<Isometry3<f64>>> {
    let keys = ["robot.base_xyz_mm", "robot.base_rpy_deg"];
    let given = pose(source, [&raw.base_xyz_mm, &raw.base_rpy_deg], keys)?;
    let Some(height) = &raw.base_z_mm else {
        return Ok(given);
    };
    if let Some(xyz) = &raw.base_xyz_mm {
        let message = "The height of the base is given twice: robot.base_z_mm is there already.";
        return Err(source
            .error(Code::Conflict, keys[0], xyz.span(), message)
            .hint("keep base_xyz_mm alone; its third number is the height"));
    }
    let mut pose = given.unwrap_or_default();
    pose.translation.z = mm_to_m(source.number(height, "robot.base_z_mm")?);
    Ok((pose != Isometry3::identity()).then_some(pose))
}

/// A pose as origin [mm] and roll, pitch, yaw [deg] under `keys`; none where it changes
/// nothing.
fn pose(
    source: &Source<'_>,
    [xyz, rpy]: [&Option<Numbers>; 2],
    keys: [&str; 2],
) -> Result<Option<Isometry3<f64>>> {
    let xyz = xyz.as_ref().map(|xyz| source.vector(xyz, keys[0]));
    let origin = xyz.transpose()?.unwrap_or_default().map(mm_to_m);
    let rpy = rpy.as_ref().map(|rpy| source.rotation(rpy, keys[1]));
    let rotation = rpy.transpose()?.unwrap_or_default();
    let pose = Isometry3::from_parts(Translation3::from(origin), rotation);
    Ok((pose != Isometry3::identity()).then_some(pose))
}

/// Bounds for choosing postures: given and inside the machine's limits, or
/// those limits.
pub(super) fn bounds(
    source: &Source<'_>,
    table: Option<&At<RawBounds>>,
    robot: &Robot,
) -> Result<Vec<[f64; 2]>> {
    let Some(rows) = table.and_then(|table| table.get().q_deg.as_ref()) else {
        return Ok(robot.joints().iter().map(|joint| joint.limits).collect());
    };
    let bounds = source.ranges(
        rows,
        "bounds.q_deg",
        robot.joint_count(),
        Source::range_or_place,
    )?;
    let bounds = radians(&bounds);
    for (j, row) in rows.get().iter().enumerate() {
        for (entry, end) in row.get().iter().zip([0, 1]) {
            inside_limits(source, entry, robot, j, bounds[j][end], "bounds.q_deg")?;
        }
    }
    Ok(bounds)
}

/// Checks one controller angle \[rad\] against the machine's limits.
pub(super) fn inside_limits(
    source: &Source<'_>,
    entry: &At<f64>,
    robot: &Robot,
    joint: usize,
    angle: f64,
    key: &str,
) -> Result<()> {
    let name = &robot.joints()[joint].name;
    let limits = robot.joints()[joint].limits;
    if (limits[0] - 1e-9..=limits[1] + 1e-9).contains(&angle) {
        return Ok(());
    }
    let [low, high] = limits.map(rad_to_shortest_deg);
    let message = format!(
        "{name} at {}° is outside the machine's limits, {low}° to {high}°.",
        entry.get()
    );
    let key = format!("{key}[{}]", joint + 1);
    Err(source
        .error(Code::OutsideLimits, &key, entry.span(), message)
        .hint("correct the angle, or set robot.limits_deg if the machine can go there"))
}

/// Degrees to radians, pair by pair.
fn radians(ranges: &[[f64; 2]]) -> Vec<[f64; 2]> {
    ranges.iter().map(|range| range.map(deg_to_rad)).collect()
}

/// Angles of one posture \[rad\], inside the machine's limits.
pub(super) fn angles(
    source: &Source<'_>,
    list: &Numbers,
    key: &str,
    robot: &Robot,
) -> Result<Vec<f64>> {
    let degrees = source.numbers(list, key, robot.joint_count(), "one angle per joint")?;
    let q: Vec<f64> = degrees.into_iter().map(deg_to_rad).collect();
    for (j, entry) in list.get().iter().enumerate() {
        inside_limits(source, entry, robot, j, q[j], key)?;
    }
    Ok(q)
}

/// The characteristic length \[m\], where given.
pub(super) fn characteristic_length(
    source: &Source<'_>,
    table: &At<RawRobot>,
) -> Result<Option<f64>> {
    let raw = table.get().characteristic_length_mm.as_ref();
    raw.map(|length| {
        source
            .positive(length, "robot.characteristic_length_mm")
            .map(mm_to_m)
    })
    .transpose()
}
