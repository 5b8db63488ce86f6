//! From the raw cell file to a checked [`Cell`] in SI units.

use super::columns::columns;
use super::elastic::{elastic, known_elements};
use super::instruments::{sensor, tracker, uncertainty};
use super::load::load;
use super::raw::{RawCell, RawLimits, RawNoise, RawPoint, RawSeries, RawStiffness, RawTool, RawValidation};
use super::robot;
use super::route::{route, time};
use super::scene::{scene, with_link_shapes};
use super::source::Source;
use super::task::tasks;
use super::value::{Fixed, Mm, Spanned};
use super::work::work;
use nalgebra::Vector3;
use stiffarm::error::{Code, Result};
use stiffarm::model::cell::{Cell, Limits, Noise};
use stiffarm::model::instruments::{Mount, Sensor};
use stiffarm::model::load::Load;
use stiffarm::model::measurement::ReadingTarget;
use stiffarm::model::observation::Setup;
use stiffarm::model::posture::Posture;
use stiffarm::model::robot::{CatalogueEntry, Robot};
use stiffarm::model::tool::{NamedPoint, SeriesCompliance, Tool};
use stiffarm::units::mm2_to_m2;

/// Variance of the tracker of Zhang et al. 2021, Section IV.A \[mm²\].
pub(super) const PAPER_VARIANCE_MM2: f64 = 9.23e-5;

/// Checks everything and turns it into a cell.
pub(super) fn cell(source: &Source<'_>, raw: &RawCell) -> Result<Cell> {
    let hint = "add a table [robot] with catalogue = \"…\" or dh_modified";
    let table = source.required_table(&raw.robot, "robot", hint)?;
    let (robot, entry) = robot::robot(source, table)?;
    let robot = with_link_shapes(source, robot, table.get().shape.as_ref())?;
    let bounds = robot::bounds(source, raw.bounds.as_ref(), &robot)?;
    let characteristic_length = source.optional(&table.get().characteristic_length_mm, Source::positive)?;
    let sensor = source.optional(&raw.sensor, sensor)?;
    let tool = tool(source, &raw.tool, sensor.as_ref())?;
    let load = load(source, &raw.load, &robot)?;
    let limits = source.optional(&raw.limits, |source, table| limits(source, table, &load))?;
    let noise = noise(source, raw.noise.as_ref())?;
    // Published values belong to the joint axes, not to other springs.
    let published = entry.filter(|_| robot.spring_mixing().is_none());
    let prior = prior(source, raw.stiffness.as_ref(), &robot, published)?;
    let known_elements = source.optional(&raw.elastic, |source, table| known_elements(source, table, &robot))?;
    let elastic = source.optional(&raw.elastic, elastic)?.flatten();
    let validation = validation(source, raw.validation.as_ref(), &robot)?;
    let tasks = tasks(source, raw.task.as_ref(), &robot, &tool)?;
    let work = work(source, raw.work.as_ref(), &tool)?;
    let route = route(source, raw.route.as_ref(), &robot, entry)?;
    let time = source.optional(&raw.time, time)?;
    let tracker = source.optional(&raw.tracker, tracker)?;
    let uncertainty = source.optional(&raw.uncertainty, |source, table| uncertainty(source, table, &load))?;
    let columns = columns(source, raw.columns.as_ref(), &robot)?;
    let name = source.optional(&raw.name, Source::name)?;
    let name = name.unwrap_or_else(|| robot.name().to_string());
    let setup = Setup { robot, tool, load };
    let scene = scene(source, raw, &setup, &bounds, prior.as_deref())?;
    Ok(Cell {
        name,
        setup,
        bounds,
        limits: limits.unwrap_or_default(),
        scene,
        noise,
        prior,
        elastic,
        known_elements: known_elements.unwrap_or_default(),
        characteristic_length,
        validation,
        tasks,
        sensor,
        tracker: tracker.unwrap_or_default(),
        uncertainty: uncertainty.unwrap_or_default(),
        columns,
        work,
        route,
        time: time.unwrap_or_default(),
    })
}

fn tool(source: &Source<'_>, table: &Option<Spanned<RawTool>>, sensor: Option<&Sensor>) -> Result<Tool> {
    let hint = "add a table [tool] with loading_point_mm and [[tool.measuring_point]]";
    let table = source.required_table(table, "tool", hint)?;
    let raw = table.get();
    let hint = "give the point where the load acts: loading_point_mm = [x, y, z] in flange axes";
    let point = source.required(table, &raw.loading_point_mm, "loading_point_mm", hint)?;
    let loading_point = source.vector(point)?;
    let hint = "add [[tool.measuring_point]] with name and position_mm, once per reflector";
    let points = source.required(table, &raw.measuring_point, "measuring_point", hint)?;
    if points.get().is_empty() {
        let message = "At least one measuring point is needed.";
        let error = source.error(Code::InvalidValue, points, message);
        return Err(error.hint(hint));
    }
    let mut measuring_points = Vec::new();
    for point in points.get() {
        let point = measuring_point(source, point, &measuring_points)?;
        measuring_points.push(point);
    }
    let series_compliance = source.optional(&raw.series_compliance, series)?;
    let has_sensor = raw.has_sensor.as_ref().map(|flag| *flag.get());
    let on_flange = sensor.is_some_and(|sensor| sensor.mount == Mount::Flange);
    Ok(Tool {
        loading_point,
        measuring_points,
        has_sensor: has_sensor.unwrap_or(series_compliance.is_some() || on_flange),
        series_compliance,
    })
}

fn measuring_point(source: &Source<'_>, table: &Spanned<RawPoint>, others: &[NamedPoint]) -> Result<NamedPoint> {
    let raw = table.get();
    let hint = "give the name that the measurement table uses for this point";
    let raw_name = source.required(table, &raw.name, "name", hint)?;
    let name = source.unique_name(raw_name, others.iter().map(|p| p.name.as_str()))?;
    if ReadingTarget::is_base_name(&name) {
        let message = format!("The name \"{name}\" is reserved for a reflector on the robot's base.");
        let error = source.error(Code::InvalidValue, raw_name, message);
        return Err(error.hint("choose another name for this measuring point"));
    }
    let hint = "give position_mm = [x, y, z] in flange axes";
    let position = source.required(table, &raw.position_mm, "position_mm", hint)?;
    let position = source.vector(position)?;
    Ok(NamedPoint { name, position })
}

fn series(source: &Source<'_>, table: &Spanned<RawSeries>) -> Result<SeriesCompliance> {
    let raw = table.get();
    let origin = source.optional(&raw.origin_mm, Source::vector)?;
    let stiffness = |list: &Option<Fixed<3>>, name: &str, hint: &str| -> Result<[f64; 3]> {
        let list = source.required(table, list, name, hint)?;
        let values = source.positives(&list.0, 3, "x, y, z")?;
        Ok([values[0], values[1], values[2]])
    };
    let hint = "give three values in N/m, along the flange's x, y, z";
    let translational = stiffness(&raw.translational_n_per_m, "translational_n_per_m", hint)?;
    let hint = "give three values in N·m/rad, about the flange's x, y, z";
    let rotational = stiffness(&raw.rotational_nm_per_rad, "rotational_nm_per_rad", hint)?;
    SeriesCompliance::from_stiffness(origin.unwrap_or_default(), translational, rotational)
        .map_err(|e| source.place(e, table))
}

fn limits(source: &Source<'_>, table: &Spanned<RawLimits>, load: &Load) -> Result<Limits> {
    let raw = table.get();
    let hint = "give both corners of the box, or none";
    let tool_box = match (&raw.box_min_mm, &raw.box_max_mm) {
        (None, None) => None,
        (Some(low), Some(high)) => Some(tool_box(source, low, high)?),
        (Some(low), None) => return Err(source.missing(low, "limits.box_max_mm", hint)),
        (None, Some(high)) => return Err(source.missing(high, "limits.box_min_mm", hint)),
    };
    let rope_length = source.optional(&raw.rope_length_mm, |source, list| {
        let range = source.range(list)?;
        source.not_negative(&list.0.get()[0])?;
        if load.has_rope() {
            return Ok(range);
        }
        let message = "A limit of the length needs a load of kind \"rope\", or \"cylinder\" with anchor_mm.";
        let error = source.error(Code::Conflict, list, message);
        Err(error.hint("remove rope_length_mm, or set load.kind = \"rope\" or \"cylinder\""))
    });
    Ok(Limits {
        tool_box,
        keep_out_radius: source.optional(&raw.keep_out_radius_mm, Source::positive)?,
        rope_length: rope_length?,
        floor: source.optional(&raw.floor_mm, Source::number)?,
        wrist_height: source.optional(&raw.wrist_height_mm, Source::number)?,
    })
}

/// The box between its corners.
fn tool_box(source: &Source<'_>, low: &Fixed<3, Mm>, high: &Fixed<3, Mm>) -> Result<[Vector3<f64>; 2]> {
    let corners = [source.vector(low)?, source.vector(high)?];
    let pairs = low.0.get().iter().zip(high.0.get());
    for ((low, high), axis) in pairs.zip(["x", "y", "z"]) {
        if low.get() >= high.get() {
            let message = format!(
                "The box is empty: along {axis} its lower corner {} is not below its upper corner {}.",
                low.get(),
                high.get()
            );
            return Err(source.error(Code::InvalidValue, high, message));
        }
    }
    Ok(corners)
}

fn noise(source: &Source<'_>, table: Option<&Spanned<RawNoise>>) -> Result<Noise> {
    let mut noise = Noise {
        reading_variance: mm2_to_m2(PAPER_VARIANCE_MM2),
        readings_per_displacement: 1,
        posture_common_std: 0.0,
    };
    let Some(raw) = table.map(Spanned::get) else {
        return Ok(noise);
    };
    if let Some(variance) = &raw.variance_mm2 {
        noise.reading_variance = source.positive(variance)?;
    }
    if let Some(std) = &raw.std_um {
        if raw.variance_mm2.is_some() {
            let message = "The noise is given twice: variance_mm2 is there already.";
            let error = source.error(Code::Conflict, std, message);
            return Err(error.hint("keep one of variance_mm2 and std_um"));
        }
        noise.reading_variance = source.positive(std)?.powi(2);
    }
    if let Some(readings) = &raw.readings_per_displacement {
        noise.readings_per_displacement = match readings.get() {
            1 => 1,
            2 => 2,
            other => {
                let message = format!("The number of readings per displacement must be 1 or 2, got {other}.");
                let error = source.error(Code::InvalidValue, readings, message);
                return Err(error.hint("2 for a loaded and an unloaded reading, 1 as the paper counts"));
            }
        };
    }
    let common = source.optional(&raw.posture_common_mm, Source::not_negative)?;
    noise.posture_common_std = common.unwrap_or(0.0);
    Ok(noise)
}

fn prior(
    source: &Source<'_>,
    table: Option<&Spanned<RawStiffness>>,
    robot: &Robot,
    published: Option<&CatalogueEntry>,
) -> Result<Option<Vec<f64>>> {
    let Some(list) = table.and_then(|table| table.get().prior_nm_per_rad.as_ref()) else {
        let first = published.and_then(|entry| entry.stiffness.first());
        return Ok(first.map(|set| set.values.to_vec()));
    };
    let values = source.positives(list, robot.spring_count(), "one per joint")?;
    Ok(Some(values))
}

fn validation(source: &Source<'_>, table: Option<&Spanned<RawValidation>>, robot: &Robot) -> Result<Vec<Posture>> {
    let mut postures: Vec<Posture> = Vec::new();
    let list = table.and_then(|table| table.get().posture.as_ref());
    for table in list.into_iter().flat_map(Spanned::get) {
        let raw = table.get();
        let name = source.required(table, &raw.name, "name", "give the posture a name")?;
        let name = source.unique_name(name, postures.iter().map(|p| p.name.as_str()))?;
        let hint = "give the controller angles: q_deg = [q1, q2, …] in degrees";
        let angles = source.required(table, &raw.q_deg, "q_deg", hint)?;
        let q = robot::angles(source, angles, robot)?;
        postures.push(Posture { name, q });
    }
    Ok(postures)
}
