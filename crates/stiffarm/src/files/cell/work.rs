//! `[work]`: tool tip, workpiece, and the load of the process.

use super::instruments::choice;
use super::raw::{At, Number, Numbers, RawForce, RawMilling, RawWork};
use super::source::Source;
use crate::error::{Code, Result};
use crate::model::process::{
    CuttingCoefficients, ForceAxes, Milling, MillingDirection, Process, TipLoad,
};
use crate::model::tool::Tool;
use crate::model::work::Work;
use crate::units::{mm_to_m, n_per_mm_to_n_per_m, n_per_mm2_to_pa};
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

/// Feeds per tooth that cutters have \[mm\]; beyond are slips of unit.
const FEEDS_PER_TOOTH_MM: [f64; 2] = [5e-4, 5.0];

const DIRECTIONS: [(&str, MillingDirection); 2] = [
    ("up", MillingDirection::Up),
    ("down", MillingDirection::Down),
];

/// What the robot works with, as far as the cell says.
pub(super) fn work(source: &Source<'_>, table: Option<&At<RawWork>>, tool: &Tool) -> Result<Work> {
    let Some(raw) = table.map(At::get) else {
        return Ok(Work::default());
    };
    let tip = frame(source, &raw.tip_mm, &raw.tip_rpy_deg, "tip", tool.tcp())?;
    let workpiece = frame(
        source,
        &raw.workpiece_mm,
        &raw.workpiece_rpy_deg,
        "workpiece",
        Vector3::zeros(),
    )?;
    let process = match (&raw.force, &raw.milling) {
        (Some(force), Some(milling)) => {
            let [(first, _), (second, span)] = {
                let mut given = [("force", force.span()), ("milling", milling.span())];
                given.sort_by_key(|(_, span)| span.start);
                given
            };
            let message =
                format!("The load of the process is given twice: work.{first} is there already.");
            let key = format!("work.{second}");
            let error = source.error(Code::Conflict, &key, span, message);
            return Err(error.hint("keep one of [work.force], [work.milling]"));
        }
        (Some(force), None) => Some(Process::Constant(constant(source, force)?)),
        (None, Some(cut)) => Some(Process::Milling(milling(source, cut)?)),
        (None, None) => None,
    };
    Ok(Work {
        tip,
        workpiece: workpiece.unwrap_or_default(),
        process,
    })
}

/// A frame from the keys `…_mm` and `…_rpy_deg`, where one of them is given.
fn frame(
    source: &Source<'_>,
    origin: &Option<Numbers>,
    rpy: &Option<Numbers>,
    name: &str,
    default: Vector3<f64>,
) -> Result<Option<Isometry3<f64>>> {
    if origin.is_none() && rpy.is_none() {
        return Ok(None);
    }
    let origin = match origin {
        Some(origin) => source
            .vector(origin, &format!("work.{name}_mm"))?
            .map(mm_to_m),
        None => default,
    };
    let rotation = match rpy {
        Some(rpy) => source.rotation(rpy, &format!("work.{name}_rpy_deg"))?,
        None => UnitQuaternion::identity(),
    };
    let origin = Translation3::from(origin);
    Ok(Some(Isometry3::from_parts(origin, rotation)))
}

fn constant(source: &Source<'_>, table: &At<RawForce>) -> Result<TipLoad> {
    let (raw, at) = (table.get(), Some(table.span()));
    let key = "work.force.force_n";
    let hint = "give the force on the robot at the tip: force_n = [x, y, z] in newtons";
    let given = source.required(&raw.force_n, key, at, hint)?;
    let force = source.vector(given, key)?;
    let moment = match &raw.moment_nm {
        Some(moment) => source.vector(moment, "work.force.moment_nm")?,
        None => Vector3::zeros(),
    };
    if force == Vector3::zeros() && moment == Vector3::zeros() {
        let message = "Force and moment are zero: the process bends nothing.";
        let error = source.error(Code::InvalidValue, key, given.span(), message);
        return Err(error.hint("give the process force, or remove [work.force]"));
    }
    let key = "work.force.axes";
    let hint = "axes = \"base\", \"tool\" (the tip frame), \"workpiece\" or \"path\" (x the feed, z the tool axis)";
    // The frame is never guessed: a wrong one bends the robot another way.
    let Some(axes) = &raw.axes else {
        let message = "The axes of the force are not given.";
        let error = source.error(Code::MissingKey, key, given.span(), message);
        return Err(error.hint(hint));
    };
    Ok(TipLoad {
        force,
        moment,
        axes: choice(source, axes, key, &ForceAxes::NAMES, hint)?,
    })
}

fn milling(source: &Source<'_>, table: &At<RawMilling>) -> Result<Milling> {
    let raw = table.get();
    let positive = |value: &Option<Number>, key: &str, hint: &str| -> Result<f64> {
        let key = format!("work.milling.{key}");
        let value = source.required(value, &key, Some(table.span()), hint)?;
        source.positive(value, &key)
    };
    let refuse = |value: &Option<Number>, key: &str, message: String, hint: &str| {
        let span = value.as_ref().map_or(table.span(), At::span);
        let key = format!("work.milling.{key}");
        let error = source.error(Code::InvalidValue, &key, span, message);
        Err(error.hint(hint))
    };

    let key = "work.milling.teeth";
    let hint = "give the number of teeth of the cutter";
    let given = source.required(&raw.teeth, key, Some(table.span()), hint)?;
    let teeth = match u32::try_from(*given.get()) {
        Ok(teeth @ 1..=1000) => teeth,
        _ => {
            let message = format!(
                "The number of teeth must be from 1 to 1000, got {}.",
                given.get()
            );
            return Err(source.error(Code::InvalidValue, key, given.span(), message));
        }
    };
    let diameter = positive(
        &raw.diameter_mm,
        "diameter_mm",
        "give the diameter of the cutter",
    )?;
    let axial_depth = positive(
        &raw.axial_depth_mm,
        "axial_depth_mm",
        "give the depth of cut along the tool axis",
    )?;
    let radial_depth = positive(
        &raw.radial_depth_mm,
        "radial_depth_mm",
        "give the width of cut across feed and tool axis; the diameter for a full slot",
    )?;
    if radial_depth > diameter {
        let message =
            format!("The width of cut {radial_depth} is above the cutter's diameter {diameter}.");
        let hint = "a full slot has radial_depth_mm = diameter_mm";
        return refuse(&raw.radial_depth_mm, "radial_depth_mm", message, hint);
    }
    let hint = "feed per tooth = feed rate / (spindle speed · teeth), in mm";
    let feed_per_tooth = positive(&raw.feed_per_tooth_mm, "feed_per_tooth_mm", hint)?;
    let [low, high] = FEEDS_PER_TOOTH_MM;
    let doubt = if feed_per_tooth < low {
        Some("below any chip; is it given in metres?")
    } else if feed_per_tooth > high {
        Some("above any chip; is it given in micrometres, or is it the feed rate?")
    } else if feed_per_tooth > diameter / 2.0 {
        Some("above the cutter's radius.")
    } else {
        None
    };
    if let Some(doubt) = doubt {
        let message = format!("A feed per tooth of {feed_per_tooth} mm is {doubt}");
        return refuse(&raw.feed_per_tooth_mm, "feed_per_tooth_mm", message, hint);
    }
    let key = "work.milling.direction";
    let hint = "direction = \"up\" (conventional) or direction = \"down\" (climb)";
    let given = source.required(&raw.direction, key, Some(table.span()), hint)?;
    let direction = choice(source, given, key, &DIRECTIONS, hint)?;
    Ok(Milling {
        teeth,
        diameter: mm_to_m(diameter),
        axial_depth: mm_to_m(axial_depth),
        radial_depth: mm_to_m(radial_depth),
        feed_per_tooth: mm_to_m(feed_per_tooth),
        direction,
        coefficients: coefficients(source, table)?,
    })
}

fn coefficients(source: &Source<'_>, table: &At<RawMilling>) -> Result<CuttingCoefficients> {
    let raw = table.get();
    let number = |value: &Option<Number>, key: &str, to_si: fn(f64) -> f64| -> Result<f64> {
        let key = format!("work.milling.{key}");
        match value {
            Some(value) => source.number(value, &key).map(to_si),
            None => Ok(0.0),
        }
    };
    let hint =
        "give the tangential and the radial cutting coefficient of cutter and material in N/mm²";
    for (value, key) in [
        (&raw.k_tc_n_per_mm2, "work.milling.k_tc_n_per_mm2"),
        (&raw.k_rc_n_per_mm2, "work.milling.k_rc_n_per_mm2"),
    ] {
        source.required(value, key, Some(table.span()), hint)?;
    }
    // The tangential ones take power, so they have a sign.
    if let Some(value) = &raw.k_tc_n_per_mm2 {
        source.positive(value, "work.milling.k_tc_n_per_mm2")?;
    }
    if let Some(value) = &raw.k_te_n_per_mm {
        source.not_negative(value, "work.milling.k_te_n_per_mm")?;
    }
    let chip = |value: &Option<Number>, key: &str| number(value, key, n_per_mm2_to_pa);
    let edge = |value: &Option<Number>, key: &str| number(value, key, n_per_mm_to_n_per_m);
    Ok(CuttingCoefficients {
        k_tc: chip(&raw.k_tc_n_per_mm2, "k_tc_n_per_mm2")?,
        k_rc: chip(&raw.k_rc_n_per_mm2, "k_rc_n_per_mm2")?,
        k_ac: chip(&raw.k_ac_n_per_mm2, "k_ac_n_per_mm2")?,
        k_te: edge(&raw.k_te_n_per_mm, "k_te_n_per_mm")?,
        k_re: edge(&raw.k_re_n_per_mm, "k_re_n_per_mm")?,
        k_ae: edge(&raw.k_ae_n_per_mm, "k_ae_n_per_mm")?,
    })
}
