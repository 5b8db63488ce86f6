//! From the raw cell file to a checked [`Cell`] in SI units.

use super::columns::columns;
use super::elastic::elastic;
use super::instruments::{sensor, tracker, uncertainty};
use super::load::load;
use super::raw::{At, RawCell, RawLimits, RawNoise, RawStiffness, RawTool, RawValidation};
use super::robot;
use super::route::route;
use super::scene::{scene, with_link_shapes};
use super::source::Source;
use super::task::tasks;
use super::work::work;
use crate::error::{Code, Result};
use crate::model::cell::{Cell, Limits, Noise};
use crate::model::instruments::{Mount, Sensor};
use crate::model::load::Load;
use crate::model::measurement::ReadingTarget;
use crate::model::observation::Setup;
use crate::model::posture::Posture;
use crate::model::robot::{CatalogueEntry, Robot};
use crate::model::tool::{NamedPoint, SeriesCompliance, Tool};
use crate::units::{mm_to_m, mm2_to_m2, um_to_m};
use nalgebra::Vector3;

/// Variance of the tracker of Zhang et al. 2021, Section IV.A \[mm²\].
pub(super) const PAPER_VARIANCE_MM2: f64 = 9.23e-5;

/// Checks everything and turns it into a cell.
pub(super) fn cell(source: &Source<'_>, raw: &RawCell) -> Result<Cell> {
    let hint = "add a table [robot] with catalogue = \"…\" or dh_modified";
    let table = source.required(&raw.robot, "robot", None, hint)?;
    let (robot, entry) = robot::robot(source, table)?;
    let robot = with_link_shapes(source, robot, table.get().shape.as_ref())?;
    let bounds = robot::bounds(source, raw.bounds.as_ref(), &robot)?;
    let characteristic_length = robot::characteristic_length(source, table)?;
    let sensor = sensor(source, raw.sensor.as_ref())?;
    let tool = tool(source, &raw.tool, sensor.as_ref())?;
    let load = load(source, &raw.load, &robot)?;
    let limits = limits(source, raw.limits.as_ref(), &load)?;
    let noise = noise(source, raw.noise.as_ref())?;
    // Published values belong to the joint axes, not to other springs.
    let published = entry.filter(|_| robot.spring_mixing().is_none());
    let prior = prior(source, raw.stiffness.as_ref(), &robot, published)?;
    let elastic = elastic(source, raw.elastic.as_ref())?;
    let validation = validation(source, raw.validation.as_ref(), &robot)?;
    let tasks = tasks(source, raw.task.as_ref(), &robot, &tool)?;
    let work = work(source, raw.work.as_ref(), &tool)?;
    let route = route(source, raw.route.as_ref(), &robot, entry)?;
    let tracker = tracker(source, raw.tracker.as_ref())?;
    let uncertainty = uncertainty(source, raw.uncertainty.as_ref(), &load)?;
    let columns = columns(source, raw.columns.as_ref(), &robot)?;
    let name = match &raw.name {
        Some(name) => source.name(name, "name")?,
        None => robot.name().to_string(),
    };
    let setup = Setup { robot, tool, load };
    let scene = scene(source, raw, &setup, &bounds, prior.as_deref())?;
    Ok(Cell {
        name,
        setup,
        bounds,
        limits,
        scene,
        noise,
        prior,
        elastic,
        characteristic_length,
        validation,
        tasks,
        sensor,
        tracker,
        uncertainty,
        columns,
        work,
        route,
    })
}

fn tool(source: &Source<'_>, table: &Option<At<RawTool>>, sensor: Option<&Sensor>) -> Result<Tool> {
    let hint = "add a table [tool] with loading_point_mm and [[tool.measuring_point]]";
    let table = source.required(table, "tool", None, hint)?;
    let (raw, at) = (table.get(), Some(table.span()));
    let key = "tool.loading_point_mm";
    let hint = "give the point where the load acts: loading_point_mm = [x, y, z] in flange axes";
    let loading_point = source.required(&raw.loading_point_mm, key, at.clone(), hint)?;
    let loading_point = source.vector(loading_point, key)?.map(mm_to_m);
    let key = "tool.measuring_point";
    let hint = "add [[tool.measuring_point]] with name and position_mm, once per reflector";
    let points = source.required(&raw.measuring_point, key, at, hint)?;
    if points.get().is_empty() {
        let message = "At least one measuring point is needed.";
        let error = source.error(Code::InvalidValue, key, points.span(), message);
        return Err(error.hint(hint));
    }
    let mut measuring_points: Vec<NamedPoint> = Vec::new();
    for (i, point) in points.get().iter().enumerate() {
        let key = format!("{key}[{}]", i + 1);
        let (raw, at) = (point.get(), Some(point.span()));
        let name_key = format!("{key}.name");
        let hint = "give the name that the measurement table uses for this point";
        let name = source.required(&raw.name, &name_key, at.clone(), hint)?;
        let others = measuring_points.iter().map(|p| p.name.as_str());
        let unique = source.unique_name(name, &name_key, others)?;
        if ReadingTarget::is_base_name(&unique) {
            let message =
                format!("The name \"{unique}\" is reserved for a reflector on the robot's base.");
            let error = source.error(Code::InvalidValue, &name_key, name.span(), message);
            return Err(error.hint("choose another name for this measuring point"));
        }
        let position_key = format!("{key}.position_mm");
        let hint = "give position_mm = [x, y, z] in flange axes";
        let position = source.required(&raw.position_mm, &position_key, at, hint)?;
        let position = source.vector(position, &position_key)?.map(mm_to_m);
        measuring_points.push(NamedPoint {
            name: unique,
            position,
        });
    }
    let series_compliance = series(source, raw)?;
    let has_sensor = raw.has_sensor.as_ref().map(|flag| *flag.get());
    let on_flange = sensor.is_some_and(|sensor| sensor.mount == Mount::Flange);
    Ok(Tool {
        loading_point,
        measuring_points,
        has_sensor: has_sensor.unwrap_or(series_compliance.is_some() || on_flange),
        series_compliance,
    })
}

fn series(source: &Source<'_>, tool: &RawTool) -> Result<Option<SeriesCompliance>> {
    let Some(table) = &tool.series_compliance else {
        return Ok(None);
    };
    let raw = table.get();
    let origin = match &raw.origin_mm {
        Some(origin) => source
            .vector(origin, "tool.series_compliance.origin_mm")?
            .map(mm_to_m),
        None => Vector3::zeros(),
    };
    let stiffness = |list: &Option<_>, key: &str, hint: &str| -> Result<[f64; 3]> {
        let list = source.required(list, key, Some(table.span()), hint)?;
        let values = source.positives(list, key, 3, "x, y, z")?;
        Ok([values[0], values[1], values[2]])
    };
    let key = "tool.series_compliance.translational_n_per_m";
    let translational = stiffness(
        &raw.translational_n_per_m,
        key,
        "give three values in N/m, along the flange's x, y, z",
    )?;
    let key = "tool.series_compliance.rotational_nm_per_rad";
    let rotational = stiffness(
        &raw.rotational_nm_per_rad,
        key,
        "give three values in N·m/rad, about the flange's x, y, z",
    )?;
    SeriesCompliance::from_stiffness(origin, translational, rotational)
        .map(Some)
        .map_err(|e| source.place(e, "tool.series_compliance", table.span()))
}

fn limits(source: &Source<'_>, table: Option<&At<RawLimits>>, load: &Load) -> Result<Limits> {
    let Some(table) = table else {
        return Ok(Limits::default());
    };
    let raw = table.get();
    let tool_box = match (&raw.box_min_mm, &raw.box_max_mm) {
        (None, None) => None,
        (Some(low), Some(high)) => {
            let low = source.vector(low, "limits.box_min_mm")?;
            let top = source.vector(high, "limits.box_max_mm")?;
            for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
                if low[axis] >= top[axis] {
                    let message = format!(
                        "The box is empty: along {name} its lower corner {} is not below its upper corner {}.",
                        low[axis], top[axis]
                    );
                    let key = format!("limits.box_max_mm[{}]", axis + 1);
                    let span = high.get()[axis].span();
                    return Err(source.error(Code::InvalidValue, &key, span, message));
                }
            }
            Some([low.map(mm_to_m), top.map(mm_to_m)])
        }
        (low, high) => {
            let hint = "give both corners of the box, or none";
            let at = low.as_ref().or(high.as_ref()).map(At::span);
            source.required(low, "limits.box_min_mm", at.clone(), hint)?;
            source.required(high, "limits.box_max_mm", at, hint)?;
            None
        }
    };
    let number = |value: &Option<At<f64>>, key: &str| -> Result<Option<f64>> {
        value
            .as_ref()
            .map(|value| source.number(value, key).map(mm_to_m))
            .transpose()
    };
    let keep_out_radius = raw.keep_out_radius_mm.as_ref();
    let keep_out_radius = keep_out_radius
        .map(|radius| {
            source
                .positive(radius, "limits.keep_out_radius_mm")
                .map(mm_to_m)
        })
        .transpose()?;
    let mut rope_length = None;
    if let Some(list) = &raw.rope_length_mm {
        let key = "limits.rope_length_mm";
        let range = source.range(list, key)?;
        source.not_negative(&list.get()[0], "limits.rope_length_mm[1]")?;
        if !load.has_rope() {
            let message = "A limit of the length needs a load of kind \"rope\", or \"cylinder\" with anchor_mm.";
            let error = source.error(Code::Conflict, key, list.span(), message);
            return Err(
                error.hint("remove rope_length_mm, or set load.kind = \"rope\" or \"cylinder\"")
            );
        }
        rope_length = Some(range.map(mm_to_m));
    }
    Ok(Limits {
        tool_box,
        floor: number(&raw.floor_mm, "limits.floor_mm")?,
        keep_out_radius,
        wrist_height: number(&raw.wrist_height_mm, "limits.wrist_height_mm")?,
        rope_length,
    })
}

fn noise(source: &Source<'_>, table: Option<&At<RawNoise>>) -> Result<Noise> {
    let mut noise = Noise {
        reading_variance: mm2_to_m2(PAPER_VARIANCE_MM2),
        readings_per_displacement: 1,
        posture_common_std: 0.0,
    };
    let Some(raw) = table.map(At::get) else {
        return Ok(noise);
    };
    if let Some(variance) = &raw.variance_mm2 {
        noise.reading_variance = mm2_to_m2(source.positive(variance, "noise.variance_mm2")?);
    }
    if let Some(std) = &raw.std_um {
        if raw.variance_mm2.is_some() {
            let message = "The noise is given twice: variance_mm2 is there already.";
            let error = source.error(Code::Conflict, "noise.std_um", std.span(), message);
            return Err(error.hint("keep one of variance_mm2 and std_um"));
        }
        noise.reading_variance = um_to_m(source.positive(std, "noise.std_um")?).powi(2);
    }
    if let Some(readings) = &raw.readings_per_displacement {
        noise.readings_per_displacement = match readings.get() {
            1 => 1,
            2 => 2,
            other => {
                let message =
                    format!("The number of readings per displacement must be 1 or 2, got {other}.");
                let key = "noise.readings_per_displacement";
                let error = source.error(Code::InvalidValue, key, readings.span(), message);
                return Err(
                    error.hint("2 for a loaded and an unloaded reading, 1 as the paper counts")
                );
            }
        };
    }
    if let Some(common) = &raw.posture_common_mm {
        noise.posture_common_std = mm_to_m(source.not_negative(common, "noise.posture_common_mm")?);
    }
    Ok(noise)
}

fn prior(
    source: &Source<'_>,
    table: Option<&At<RawStiffness>>,
    robot: &Robot,
    published: Option<&CatalogueEntry>,
) -> Result<Option<Vec<f64>>> {
    let given = table.and_then(|table| table.get().prior_nm_per_rad.as_ref());
    let Some(list) = given else {
        let first = published.and_then(|entry| entry.stiffness.first());
        return Ok(first.map(|set| set.values.to_vec()));
    };
    let key = "stiffness.prior_nm_per_rad";
    source
        .positives(list, key, robot.spring_count(), "one per joint")
        .map(Some)
}

fn validation(
    source: &Source<'_>,
    table: Option<&At<RawValidation>>,
    robot: &Robot,
) -> Result<Vec<Posture>> {
    let mut postures: Vec<Posture> = Vec::new();
    let raw = table.and_then(|table| table.get().posture.as_ref());
    for (i, posture) in raw.into_iter().flat_map(At::get).enumerate() {
        let key = format!("validation.posture[{}]", i + 1);
        let (raw, at) = (posture.get(), Some(posture.span()));
        let name_key = format!("{key}.name");
        let name = source.required(&raw.name, &name_key, at.clone(), "give the posture a name")?;
        let others = postures.iter().map(|p| p.name.as_str());
        let name = source.unique_name(name, &name_key, others)?;
        let angles_key = format!("{key}.q_deg");
        let hint = "give the controller angles: q_deg = [q1, q2, …] in degrees";
        let angles = source.required(&raw.q_deg, &angles_key, at, hint)?;
        let q = robot::angles(source, angles, &angles_key, robot)?;
        postures.push(Posture { name, q });
    }
    Ok(postures)
}
