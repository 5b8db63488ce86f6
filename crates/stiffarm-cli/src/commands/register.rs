//! `stiffarm register`: the transform from tracker to base axes.

use super::finding_line;
use crate::args::RegisterArgs;
use crate::files::only_target;
use crate::numbers::{mm, significant};
use crate::output::Exit;
use crate::session::Session;
use crate::table::{Table, title};
use schemars::JsonSchema;
use serde::Serialize;
use stiffarm::files::source::Source;
use stiffarm::files::table::read_pairs;
use stiffarm::measure::registration::{
    PointPair, RegisterOptions, Registration, RegistrationRecord, register_with,
};
use stiffarm::units::{m_to_mm, mm_to_m, rad_to_deg};
use stiffarm::{Code, Error, Result};

/// Options of the result.
#[derive(Serialize, JsonSchema)]
pub struct Options {
    /// Standard deviation of each coordinate of a pair \[mm\]; `null` estimates it from the residuals.
    pub std_mm: Option<f64>,
    /// Pairs left out.
    pub exclude: Vec<String>,
}

/// Registers tracker to base.
pub fn run(session: &Session, args: &RegisterArgs) -> Result<Exit> {
    let target = only_target(session, args.output.as_deref(), args.force)?;
    let (file, bytes) = session.read("pairs", &args.pairs)?;
    let pairs = without(read_pairs(&bytes, &file)?, &args.exclude)?;
    let options = {
        let mut options = RegisterOptions::default();
        options.std = args.std_mm.map(mm_to_m);
        options.weights = Vec::new();
        options
    };
    let registration = register_with(&pairs, &options).map_err(|e| e.file(&file))?;

    let exit = Exit::finding(registration.is_serious());
    let options = Options {
        std_mm: args.std_mm,
        exclude: args.exclude.clone(),
    };
    let record = RegistrationRecord::from(&registration);
    let envelope = session.envelope("register", None, options, &record);
    let table = || table(&file, &registration, &record);
    session.deliver(target, &envelope, table)?;
    Ok(exit)
}

/// The pairs but those that are excluded.
fn without(pairs: Vec<PointPair>, exclude: &[String]) -> Result<Vec<PointPair>> {
    let is = |pair: &PointPair, name: &String| pair.name == *name;
    if let Some(name) = exclude
        .iter()
        .find(|name| !pairs.iter().any(|pair| is(pair, name)))
    {
        let known: Vec<&str> = pairs.iter().map(|pair| pair.name.as_str()).collect();
        let message = format!("The table has no point \"{name}\".");
        return Err(Error::new(Code::UnknownName, message)
            .key("--exclude")
            .hint(format!("points: {}", known.join(", "))));
    }
    let kept = pairs
        .into_iter()
        .filter(|pair| !exclude.iter().any(|name| is(pair, name)));
    Ok(kept.collect())
}

fn table(file: &str, registration: &Registration, record: &RegistrationRecord) -> String {
    let mut out = format!("pairs: {file} ({} points)\n", registration.names.len());
    for finding in &registration.findings {
        out += &finding_line(finding);
    }
    out += &title("Residuals: base position minus transformed tracker position");
    out += &residuals(registration).to_string();
    out += &format!(
        "\nResidual RMS {} mm; standard deviation of a coordinate {} mm from {} degrees of freedom{}.\n",
        mm(registration.rms),
        mm(registration.residual_std),
        registration.degrees_of_freedom,
        registration
            .known_std
            .map_or_else(String::new, |std| format!(", {} mm as given", mm(std))),
    );
    out += &title("Uncertainty (standard errors), base axes");
    out += &uncertainty(registration).to_string();
    let centroid = registration.centroid.map(m_to_mm);
    out += &format!(
        "\nThe turn acts about the centroid of the points, ({:.0}, {:.0}, {:.0}) mm.\n",
        centroid.x, centroid.y, centroid.z
    );
    out += &title(match registration.is_serious() {
        true => {
            "Base frame from tracker frame; not to be used before the serious finding is settled"
        }
        false => "Base frame from tracker frame, for the cell file",
    });
    // A tenth of a micrometre, and as much at the end of ten metres.
    out += &format!(
        "[tracker]\nxyz_mm = {}\nrpy_deg = {}\n",
        list(record.translation_m.map(m_to_mm), 4),
        list(record.roll_pitch_yaw.map(rad_to_deg), 7)
    );
    out
}

fn residuals(registration: &Registration) -> Table {
    let mut table = Table::new(["point", "x [mm]", "y [mm]", "z [mm]", "norm [mm]"]);
    for (name, residual) in registration.names.iter().zip(&registration.residuals) {
        let components = residual.iter().map(|r| signed_mm(*r));
        let fields = std::iter::once(name.clone()).chain(components);
        table.row(fields.chain([mm(residual.norm())]));
    }
    table
}

fn uncertainty(registration: &Registration) -> Table {
    let [shift, turn] = registration.standard_errors();
    let mut table = Table::new(["", "x", "y", "z"]);
    let mut row = |name: &str, values: [f64; 3]| {
        let values = values.iter().map(|v| significant(*v, 2));
        table.row(std::iter::once(name.to_string()).chain(values));
    };
    row("shift of the centroid [mm]", shift.map(m_to_mm).into());
    row("turn [mrad]", (turn * 1e3).into());
    table
}

/// As [`mm`], without a sign where all digits are zero.
fn signed_mm(m: f64) -> String {
    let text = mm(m);
    match text.strip_prefix('-') {
        Some(digits) if digits.bytes().all(|b| matches!(b, b'0' | b'.')) => digits.to_string(),
        _ => text,
    }
}

fn list(values: [f64; 3], decimals: usize) -> String {
    let values = values.map(|v| {
        let text = format!("{v:.decimals$}");
        // −0.0000 is zero.
        match text.parse::<f64>() {
            Ok(0.0) => format!("{:.decimals$}", 0.0),
            _ => text,
        }
    });
    format!("[{}]", values.join(", "))
}
