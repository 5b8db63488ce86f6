//! `stiffarm validate`: calculated against measured displacements, Eq. (22).

use super::identify::check_names;
use crate::args::ValidateArgs;
use crate::input::NamedCell;
use crate::numbers::{mm, percent, significant};
use crate::output::Exit;
use crate::session::Session;
use crate::table::{Align, Table, green, red, title, yellow};
use schemars::JsonSchema;
use serde::Serialize;
use serde_json::Value;
use stiffarm::cell::Cell;
use stiffarm::findings::list;
use stiffarm::units::mm_to_m;
use stiffarm::validate::{Model, Validation, validate};
use stiffarm::{Code, Error, Result};

/// Options of the result.
#[derive(Serialize, JsonSchema)]
pub struct Options {
    /// How displacements are calculated.
    pub model: Model,
    /// Largest deviation allowed \[mm\].
    pub tolerance_mm: Option<f64>,
    /// Only these postures; all if empty.
    pub only: Vec<String>,
}

/// A stiffness as `identify` saved it.
struct Saved {
    stiffness: Vec<f64>,
    /// Postures it was identified from.
    postures: Vec<String>,
    /// SHA-256 of the cell it was identified in.
    cell: Option<String>,
}

/// Validates.
pub fn run(session: &Session, args: &ValidateArgs) -> Result<Exit> {
    if let Some(tolerance) = args.tolerance_mm
        && !(tolerance.is_finite() && tolerance >= 0.0)
    {
        return Err(Error::new(
            Code::Usage,
            format!("{tolerance} is no tolerance: a length of 0 mm or above is needed."),
        )
        .key("--tolerance-mm"));
    }
    let named = session.read_cell(&args.cell)?;
    let cell = &named.cell;
    let (file, bytes) = session.read("stiffness", &args.stiffness)?;
    let saved = saved(&bytes, cell).map_err(|e| e.file(&file))?;
    let mut measured =
        session.read_measurements(&args.measurements, args.postures.as_deref(), cell)?;
    check_names("--only", &args.only, &measured)?;
    if !args.only.is_empty() {
        measured.retain(|m| args.only.contains(&m.posture.name));
    }
    let model = args.model.into();
    let result = validate(
        cell,
        &saved.stiffness,
        &measured,
        model,
        args.tolerance_mm.map(mm_to_m),
    )?;
    let options = Options {
        model,
        tolerance_mm: args.tolerance_mm,
        only: args.only.clone(),
    };
    let envelope = session.envelope("validate", None, options, &result);
    let same_cell = saved.cell.is_none() || saved.cell.as_ref() == envelope.inputs.get("cell");
    session.show(&envelope, || table(&named, &saved, same_cell, &result))?;
    Ok(Exit::finding(result.passed == Some(false)))
}

fn table(named: &NamedCell, saved: &Saved, same_cell: bool, result: &Validation) -> String {
    let mut out = named.line();
    let note = yellow("note");
    if !same_cell {
        out += &format!("{note}: the stiffness was identified with another version of this cell\n");
    }
    let mut seen: Vec<&str> = result
        .points
        .iter()
        .map(|p| p.posture.as_str())
        .filter(|p| saved.postures.iter().any(|s| s == p))
        .collect();
    seen.dedup();
    if !seen.is_empty() {
        let (verb, them) = if seen.len() == 1 {
            ("posture", "its deviations")
        } else {
            ("postures", "their deviations")
        };
        out += &format!(
            "{note}: {verb} {} took part in the identification: {them} say little\n",
            list(&seen)
        );
    }
    out += &title("Deviation of calculated from measured displacement, Eq. (22)");
    let mut table = Table::new([
        "m-n",
        "posture",
        "point",
        "measured [mm]",
        "calculated [mm]",
        "deviation [mm]",
    ]);
    table.align(1, Align::Left);
    table.align(2, Align::Left);
    let norm = |v: &[f64; 3]| mm(v.iter().map(|c| c * c).sum::<f64>().sqrt());
    for point in &result.points {
        table.row([
            point.label.clone(),
            point.posture.clone(),
            point.point.clone(),
            norm(&point.measured_m),
            norm(&point.calculated_m),
            mm(point.deviation_m),
        ]);
    }
    out += &table.to_string();
    let share = match result.displacement_rms_m {
        rms if rms > 0.0 => format!(
            ", {} % of the displacements",
            percent(result.deviation_rms_m / rms)
        ),
        _ => String::new(),
    };
    out += &format!(
        "\nDeviation RMS {} mm{share}, largest {} mm.\n",
        mm(result.deviation_rms_m),
        mm(result.deviation_max_m)
    );
    if result.noise_expectation_m > 0.0 {
        let mean =
            result.points.iter().map(|p| p.deviation_m).sum::<f64>() / result.points.len() as f64;
        out += &format!(
            "Its mean is {} times what the cell's noise alone gives ({} mm).\n",
            significant(mean / result.noise_expectation_m, 2),
            mm(result.noise_expectation_m)
        );
    }
    if let (Some(tolerance), Some(passed)) = (result.tolerance_m, result.passed) {
        let said = if passed {
            green("passed")
        } else {
            red("failed")
        };
        out += &format!("Tolerance {} mm: {said}.\n", mm(tolerance));
    }
    out
}

/// The stiffness in a result of `identify`, or in a bare list.
fn saved(bytes: &[u8], cell: &Cell) -> Result<Saved> {
    let hint = "give the file that `stiffarm identify --output` wrote, or {\"stiffness_nm_per_rad\": [k1, …]}";
    let fault = |message: String| Error::new(Code::ResultFile, message).hint(hint);
    let json: Value = serde_json::from_slice(bytes).map_err(|e| {
        let error = fault("This is not JSON.".to_string());
        if e.line() > 0 {
            error.line(e.line(), Some(e.column().max(1)))
        } else {
            error
        }
    })?;
    let (values, key): (Vec<(String, Option<f64>)>, &str) =
        match (json.get("stiffness_nm_per_rad"), result_of(&json)) {
            (Some(list), _) => {
                let list = list
                    .as_array()
                    .ok_or_else(|| fault("stiffness_nm_per_rad is not a list.".to_string()))?;
                (
                    list.iter().map(|k| (String::new(), k.as_f64())).collect(),
                    "stiffness_nm_per_rad",
                )
            }
            (None, Some(result)) => {
                let joints = result["joints"].as_array().cloned().unwrap_or_default();
                let name = |j: &Value| j["name"].as_str().unwrap_or_default().to_string();
                (
                    joints
                        .iter()
                        .map(|j| (name(j), j["stiffness"].as_f64()))
                        .collect(),
                    "result.joints",
                )
            }
            (None, None) => return Err(fault("The file holds no joint stiffness.".to_string())),
        };
    let names = cell.setup.robot.spring_names();
    if values.len() != names.len() {
        let message = format!(
            "{} stiffness values for the {} joints of the cell.",
            values.len(),
            names.len()
        );
        return Err(fault(message).key(key));
    }
    let mut stiffness = Vec::with_capacity(values.len());
    for ((own, k), name) in values.into_iter().zip(&names) {
        if !own.is_empty() && own != *name {
            let message = format!(
                "The file has \"{own}\" where the cell has \"{name}\": it belongs to another robot."
            );
            return Err(fault(message).key(key));
        }
        match k {
            Some(k) if k.is_finite() && k > 0.0 => stiffness.push(k),
            Some(k) => {
                return Err(fault(format!(
                    "The stiffness of {name} is {k}; it must be above zero."
                ))
                .key(key));
            }
            None => return Err(fault(format!("The file has no stiffness of {name}.")).key(key)),
        }
    }
    let result = result_of(&json);
    let postures = result
        .and_then(|r| r["postures"].as_array().cloned())
        .unwrap_or_default();
    Ok(Saved {
        stiffness,
        postures: postures
            .iter()
            .filter_map(|p| p["posture"].as_str().map(String::from))
            .collect(),
        cell: json["inputs"]["cell"].as_str().map(String::from),
    })
}

/// The result of `identify`, inside its envelope or bare.
fn result_of(json: &Value) -> Option<&Value> {
    [&json["result"], json]
        .into_iter()
        .find(|v| v["joints"].is_array())
}
