//! `[work]`: tool tip, workpiece, and the load of the process.

use super::raw::{RawFeature, RawForce, RawMilling, RawWork};
use super::source::Source;
use super::value::{Deg, Fixed, HasSpan, Mm, Number, Spanned, Text, Unit};
use nalgebra::{Isometry3, Translation3, Vector3};
use stiffarm::error::{Code, Result};
use stiffarm::model::implausible::FEEDS_PER_TOOTH_MM;
use stiffarm::model::process::{
    CuttingCoefficients, ForceAxes, Milling, MillingDirection, Process, SpindlePower, TipLoad,
};
use stiffarm::model::tool::Tool;
use stiffarm::model::work::{FeatureWork, RotaryAxis, Work};

const DIRECTIONS: [(&str, MillingDirection); 2] = [("up", MillingDirection::Up), ("down", MillingDirection::Down)];

/// What the robot works with, as far as the cell says.
pub(super) fn work(source: &Source<'_>, table: Option<&Spanned<RawWork>>, tool: &Tool) -> Result<Work> {
    let Some(table) = table else {
        return Ok(Work::default());
    };
    let raw = table.get();
    let tip = frame(source, &raw.tip_mm, &raw.tip_rpy_deg, tool.tcp())?;
    let zero = Vector3::zeros();
    let workpiece = frame(source, &raw.workpiece_mm, &raw.workpiece_rpy_deg, zero)?;
    let mut features: Vec<FeatureWork> = Vec::new();
    for entry in raw.feature.iter().flat_map(Spanned::get) {
        let feature = feature(source, entry, &features)?;
        features.push(feature);
    }
    let rotary = raw.rotary_axes.as_ref();
    let rotary = rotary.map(|names| source.each(names, rotary_axis)).transpose()?;
    Ok(Work {
        tip,
        workpiece: workpiece.unwrap_or_default(),
        process: process(source, table, &raw.force, &raw.milling)?,
        features,
        rotary: rotary.unwrap_or_default(),
    })
}

/// The load of `table`.
fn process(
    source: &Source<'_>,
    table: &Spanned<impl Sized>,
    force: &Option<Spanned<RawForce>>,
    cut: &Option<Spanned<RawMilling>>,
) -> Result<Option<Process>> {
    Ok(match (force, cut) {
        (Some(force), Some(cut)) => {
            let mut present_keys = [("force", force.span()), ("milling", cut.span())];
            present_keys.sort_by_key(|(_, span)| span.start);
            let [(first, _), (second, span)] = present_keys;
            let [first, second] = [first, second].map(|name| source.path_in(table, name));
            let message = format!("The load of the process is given twice: {first} is there already.");
            let error = source.error_at(Code::Conflict, &second, span, message);
            return Err(error.hint(format!("keep one of {first}, {second}")));
        }
        (Some(force), None) => Some(Process::Constant(constant(source, force)?, power(source, force.get())?)),
        (None, Some(cut)) => Some(milling(source, cut)?),
        (None, None) => None,
    })
}

/// A feature with a load or a tolerance of its own; `before` are those above it.
fn feature(source: &Source<'_>, table: &Spanned<RawFeature>, before: &[FeatureWork]) -> Result<FeatureWork> {
    let raw = table.get();
    let hint = "give the name that the path has: that of its operation, layer or tool path";
    let name = source.required(table, &raw.name, "name", hint)?;
    let others = before.iter().map(|feature| feature.name.as_str());
    let name = source.unique_name(name, others)?;
    let tolerance = source.optional(&raw.tolerance_mm, Source::positive)?;
    let process = process(source, table, &raw.force, &raw.milling)?;
    if tolerance.is_none() && process.is_none() {
        let message = "This feature has neither a load nor a tolerance of its own.";
        let error = source.error(Code::InvalidValue, table, message);
        return Err(error.hint("give tolerance_mm, [work.feature.force] or [work.feature.milling]"));
    }
    Ok(FeatureWork { name, process, tolerance })
}

fn rotary_axis(source: &Source<'_>, name: &Text) -> Result<RotaryAxis> {
    RotaryAxis::of(name.get()).ok_or_else(|| {
        let message = format!("\"{}\" is not a rotary axis.", name.get());
        let error = source.error(Code::InvalidValue, name, message);
        error.hint("name them \"A\", \"B\" or \"C\", with a minus where they carry the workpiece")
    })
}

/// A frame from its origin and its roll, pitch, yaw, where one of them is given.
fn frame(
    source: &Source<'_>,
    origin: &Option<Fixed<3, Mm>>,
    rpy: &Option<Fixed<3, Deg>>,
    default: Vector3<f64>,
) -> Result<Option<Isometry3<f64>>> {
    if origin.is_none() && rpy.is_none() {
        return Ok(None);
    }
    let origin = source.optional(origin, Source::vector)?.unwrap_or(default);
    let rotation = source.optional(rpy, Source::rotation)?.unwrap_or_default();
    let origin = Translation3::from(origin);
    Ok(Some(Isometry3::from_parts(origin, rotation)))
}

/// Powers of the spindle with the force and without it.
fn power(source: &Source<'_>, raw: &RawForce) -> Result<Option<SpindlePower>> {
    let idle = source.optional(&raw.idle_power_w, Source::not_negative)?;
    let loaded = source.optional(&raw.power_w, Source::positive)?;
    if let (Some(raw_idle_power), true) = (&raw.idle_power_w, idle >= loaded) {
        let message = "The idling spindle must take less than power_w, which is that under the force.";
        return Err(source.error(Code::InvalidValue, raw_idle_power, message));
    }
    Ok(loaded.map(|loaded| SpindlePower { loaded, idle: idle.unwrap_or_default() }))
}

fn constant(source: &Source<'_>, table: &Spanned<RawForce>) -> Result<TipLoad> {
    let raw = table.get();
    let hint = "give the force on the robot at the tip: force_n = [x, y, z] in newtons";
    let raw_force = source.required(table, &raw.force_n, "force_n", hint)?;
    let force = source.vector(raw_force)?;
    let moment = source.optional(&raw.moment_nm, Source::vector)?;
    let moment = moment.unwrap_or_default();
    if force == Vector3::zeros() && moment == Vector3::zeros() {
        let message = "Force and moment are zero: the process bends nothing.";
        let error = source.error(Code::InvalidValue, raw_force, message);
        return Err(error.hint("give the process force, or remove this table"));
    }
    let hint = "axes = \"base\", \"tool\" (the tip frame), \"workpiece\" or \"path\" (x the feed, z the tool axis)";
    // The frame is never guessed: a wrong one bends the robot another way.
    let Some(axes) = &raw.axes else {
        let message = "The axes of the force are not given.";
        let key = source.path_in(table, "axes");
        let error = source.error_at(Code::MissingKey, &key, raw_force.span(), message);
        return Err(error.hint(hint));
    };
    Ok(TipLoad { force, moment, axes: source.choice(axes, &ForceAxes::NAMES, hint)? })
}

fn milling(source: &Source<'_>, table: &Spanned<RawMilling>) -> Result<Process> {
    let raw = table.get();
    let hint = "give the number of teeth of the cutter";
    let raw_teeth = source.required(table, &raw.teeth, "teeth", hint)?;
    let number = u32::try_from(*raw_teeth.get()).unwrap_or(0);
    if !(1..=1000).contains(&number) {
        let message = format!("The number of teeth must be from 1 to 1000, got {}.", raw_teeth.get());
        return Err(source.error(Code::InvalidValue, raw_teeth, message));
    }
    let hint = "give the diameter of the cutter";
    let diameter = source.required(table, &raw.diameter_mm, "diameter_mm", hint)?;
    let diameter_m = source.positive(diameter)?;
    let hint = "give the depth of cut along the tool axis";
    let depth = source.required(table, &raw.axial_depth_mm, "axial_depth_mm", hint)?;
    let depth_m = source.positive(depth)?;
    let hint = "give the width of cut across feed and tool axis; the diameter for a full slot";
    let width = source.required(table, &raw.radial_depth_mm, "radial_depth_mm", hint)?;
    let width_m = source.positive(width)?;
    let diameter_mm = diameter.get();
    if width.get() > diameter_mm {
        let message = format!("The width of cut {} is above the cutter's diameter {diameter_mm}.", width.get());
        let error = source.error(Code::InvalidValue, width, message);
        return Err(error.hint("a full slot has radial_depth_mm = diameter_mm"));
    }
    let (feed_per_tooth, kind): (f64, fn(Milling) -> Process) = match (&raw.feed_per_tooth_mm, &raw.spindle_rpm) {
        (None, Some(speed)) => {
            let teeth_per_second = source.positive(speed)? * f64::from(number);
            (1.0 / teeth_per_second, Process::MillingAtFeed)
        }
        (Some(_), Some(speed)) => {
            let message = "feed_per_tooth_mm is there already, and the feed per tooth follows from spindle_rpm.";
            let error = source.error(Code::Conflict, speed, message);
            return Err(error.hint("keep spindle_rpm where the path gives its feed"));
        }
        (feed, None) => (chip(source, table, feed, diameter_mm)?, Process::Milling),
    };
    let hint = "direction = \"up\" (conventional) or direction = \"down\" (climb)";
    let raw_direction = source.required(table, &raw.direction, "direction", hint)?;
    Ok(kind(Milling {
        teeth: number,
        diameter: diameter_m,
        axial_depth: depth_m,
        radial_depth: width_m,
        feed_per_tooth,
        direction: source.choice(raw_direction, &DIRECTIONS, hint)?,
        coefficients: coefficients(source, table)?,
    }))
}

/// The feed per tooth \[m\].
fn chip(
    source: &Source<'_>,
    table: &Spanned<RawMilling>,
    raw_feed: &Option<Number<Mm>>,
    diameter_mm: f64,
) -> Result<f64> {
    let hint = "feed per tooth = feed rate / (spindle speed · teeth), in mm; or give spindle_rpm where the path gives \
        its feed";
    let feed = source.required(table, raw_feed, "feed_per_tooth_mm", hint)?;
    let feed_m = source.positive(feed)?;
    let feed_mm = feed.get();
    let [low, high] = FEEDS_PER_TOOTH_MM;
    let doubt = if feed_mm < low {
        Some("below any chip; is it given in metres?")
    } else if feed_mm > high {
        Some("above any chip; is it given in micrometres, or is it the feed rate?")
    } else if feed_mm > diameter_mm / 2.0 {
        Some("above the cutter's radius.")
    } else {
        None
    };
    if let Some(doubt) = doubt {
        let message = format!("A feed per tooth of {feed_mm} mm is {doubt}");
        let error = source.error(Code::InvalidValue, feed, message);
        return Err(error.hint(hint));
    }
    Ok(feed_m)
}

fn coefficients(source: &Source<'_>, table: &Spanned<RawMilling>) -> Result<CuttingCoefficients> {
    let raw = table.get();
    let hint = "give the tangential and the radial cutting coefficient of cutter and material in N/mm²";
    let tangential = source.required(table, &raw.k_tc_n_per_mm2, "k_tc_n_per_mm2", hint)?;
    let radial = source.required(table, &raw.k_rc_n_per_mm2, "k_rc_n_per_mm2", hint)?;
    // The tangential ones take power, so they have a sign.
    source.positive(tangential)?;
    source.optional(&raw.k_te_n_per_mm, Source::not_negative)?;
    Ok(CuttingCoefficients {
        k_tc: source.number(tangential)?,
        k_rc: source.number(radial)?,
        k_ac: or_zero(source, &raw.k_ac_n_per_mm2)?,
        k_te: or_zero(source, &raw.k_te_n_per_mm)?,
        k_re: or_zero(source, &raw.k_re_n_per_mm)?,
        k_ae: or_zero(source, &raw.k_ae_n_per_mm)?,
    })
}

fn or_zero<U: Unit>(source: &Source<'_>, value: &Option<Number<U>>) -> Result<f64> {
    Ok(source.optional(value, Source::number)?.unwrap_or(0.0))
}
