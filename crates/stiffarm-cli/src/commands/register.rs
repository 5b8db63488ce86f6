//! `stiffarm register`: the transform from tracker to base axes.

use super::finding_line;
use crate::args::RegisterArgs;
use crate::error::of_option;
use crate::files::only_target;
use crate::numbers::{mm, significant};
use crate::output::Exit;
use crate::session::Session;
use crate::table::{Table, title};
use stiffarm::Result;
use stiffarm::files::source::Source;
use stiffarm::files::table::read_pairs;
use stiffarm::measure::registered::Options;
use stiffarm::measure::registration::{Registration, RegistrationRecord};
use stiffarm::units::{m_to_mm, rad_to_deg};

/// Registers tracker to base.
pub fn run(session: &Session, args: &RegisterArgs) -> Result<Exit> {
    let target = only_target(session, args.output.as_deref(), args.force)?;
    let (file, bytes) = session.read("pairs", &args.pairs)?;
    let options = Options {
        std_mm: args.std_mm,
        exclude: args.exclude.clone(),
    };
    let pairs = options
        .kept(read_pairs(&bytes, &file)?)
        .map_err(|e| of_option(e, &["exclude"]))?;
    let registration = options.register(&pairs).map_err(|e| e.file(&file))?;

    let exit = Exit::finding(registration.is_serious());
    let record = RegistrationRecord::from(&registration);
    let envelope = session.envelope("register", None, options, &record);
    let table = || table(&file, &registration, &record);
    session.deliver(target, &envelope, table)?;
    Ok(exit)
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
