//! `stiffarm identify --clamped`: joint stiffness with the flange fixed.

use super::{messages, tables};
use crate::args::IdentifyArgs;
use crate::error::of_option;
use crate::files::only_target;
use crate::input::Line;
use crate::numbers::{optional, percent, significant};
use crate::output::Exit;
use crate::session::Session;
use crate::table::{Table, title, weight};
use stiffarm::estimate::clamped::{
    ClampedIdentification, ClampedPosture, Options, identify_clamped, without,
};
use stiffarm::estimate::elastic::ElasticChoice;
use stiffarm::estimate::identify::NoiseSource;
use stiffarm::files::source::{NamedCell, Source};
use stiffarm::files::table::read_clamped;
use stiffarm::findings::{Severity, list};
use stiffarm::units::{deg_to_rad, rad_to_deg};
use stiffarm::{Code, Error, Result};

/// Postures whose residuals the table shows.
const SHOWN_RESIDUALS: usize = 5;

/// Identifies the joint stiffness from clamped postures.
pub fn run(session: &Session, args: &IdentifyArgs) -> Result<Exit> {
    let target = only_target(session, args.output.as_deref(), args.force)?;
    let named = session.read_cell(&args.cell)?;
    let clamped = read(session, args, &named)?;
    let options = args.fit.options(&named.cell.setup.robot)?;
    if args.fit.elastic() != ElasticChoice::Axes {
        let message =
            "With the flange fixed only the joint axes can be told: angles show nothing else.";
        return Err(Error::new(Code::Unsupported, message)
            .key("--elastic")
            .hint("leave it out, or measure displacements with the flange free"));
    }
    let noise = args.angle_noise_deg.map(deg_to_rad);
    if options.noise == NoiseSource::Known && noise.is_none() {
        let message = "Known noise with --clamped needs the standard deviation of the angles.";
        return Err(Error::new(Code::Usage, message)
            .key("--noise")
            .hint("give it with --angle-noise-deg"));
    }
    let result = identify_clamped(&named.cell, &clamped, noise, &options)?;

    let complete = result.estimates.is_complete();
    let serious = |f: &stiffarm::findings::Finding| f.severity == Severity::Serious;
    let exit = Exit::finding(!complete || result.findings.iter().any(serious));
    let options = Options::new(&options, args.angle_noise_deg, &args.exclude);
    let envelope = session.envelope("identify", None, options, &result);
    let table = || table(&named, &clamped, &result, &args.exclude);
    session.deliver(target, &envelope, table)?;
    Ok(exit)
}

fn read(session: &Session, args: &IdentifyArgs, named: &NamedCell) -> Result<Vec<ClampedPosture>> {
    let robot = &named.cell.setup.robot;
    let postures = args
        .postures
        .as_deref()
        .map(|from| session.read_postures("postures", from, robot))
        .transpose()?;
    let [measurements] = args.measurements.as_slice() else {
        let error = Error::new(Code::Usage, "--clamped reads one table.").key("--clamped");
        return Err(error.hint("give all postures in one file"));
    };
    let (file, bytes) = session.read("measurements", measurements)?;
    let clamped = read_clamped(&bytes, &file, &named.cell, postures.as_deref())?;
    if clamped.is_empty() {
        let message = "The table has no measurements, only a heading.";
        return Err(Error::new(Code::TooFewData, message)
            .file(file)
            .hint("add one row per posture and load state"));
    }
    without(clamped, &args.exclude).map_err(|e| of_option(e, &["exclude"]))
}

fn table(
    named: &NamedCell,
    clamped: &[ClampedPosture],
    result: &ClampedIdentification,
    excluded: &[String],
) -> String {
    let found = &result.estimates;
    let mut out = named.line();
    out += &messages::undetermined(&found.undetermined_joints, !found.combinations.is_empty());
    out += &messages::collinear(&found.collinear);
    let mut names: Vec<&str> = clamped.iter().map(|c| c.posture.name.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    out += &format!(
        "data: flange fixed, {}, {} ({} combinations of angles), {}",
        messages::counted(names.len(), "posture"),
        messages::counted(clamped.len(), "state"),
        found.rows,
        match found.degrees_of_freedom {
            1 => "1 degree of freedom".to_string(),
            count => format!("{count} degrees of freedom"),
        }
    );
    if !excluded.is_empty() {
        out += &format!("; left out: {}", list(excluded));
    }
    out += "\n";
    out += &title("Joint stiffness");
    out += &tables::estimates(found, None, None).to_string();
    out += &tables::further(found);
    out += &format!("\n{}\n", residual(result));
    for sentence in messages::estimates(found) {
        out += &format!("{sentence}\n");
    }
    for finding in &result.findings {
        let severity = weight(finding.severity);
        out += &format!("{severity}: {}\n", finding.sentence);
    }
    if !result.friction.is_empty() {
        out += &title("Loads going up and down");
        out += &friction(result).to_string();
    }
    out += &title("States with the largest residuals");
    out + &residuals(result).to_string()
}

/// An angle in millidegrees.
fn mdeg(angle: f64) -> String {
    significant(rad_to_deg(angle) * 1e3, 3)
}

fn residual(result: &ClampedIdentification) -> String {
    let share = match result.motor_rms_rad {
        rms if rms > 0.0 => format!(" ({} %)", percent(result.residual_rms_rad / rms)),
        _ => String::new(),
    };
    format!(
        "Residual RMS {} mdeg, beside an RMS of {} mdeg of the angles that the flange holds{share}.",
        mdeg(result.residual_rms_rad),
        mdeg(result.motor_rms_rad)
    )
}

fn friction(result: &ClampedIdentification) -> Table {
    let mut table = Table::new([
        "joint",
        "half loop [mdeg]",
        "friction [N·m]",
        "torque RMS [N·m]",
        "pairs",
    ]);
    for joint in &result.friction {
        table.row([
            joint.joint.clone(),
            mdeg(joint.half_loop_rad),
            optional(joint.torque_nm, 3),
            significant(joint.load_rms_nm, 3),
            joint.pairs.to_string(),
        ]);
    }
    table
}

fn residuals(result: &ClampedIdentification) -> Table {
    let mut table = Table::new([
        "posture",
        "state",
        "residual RMS [mdeg]",
        "angle RMS [mdeg]",
        "residual / mean",
    ]);
    table.align(1, crate::table::Align::Left);
    let mut postures: Vec<_> = result.postures.iter().collect();
    postures.sort_by(|a, b| b.residual_rms_rad.total_cmp(&a.residual_rms_rad));
    for posture in postures.into_iter().take(SHOWN_RESIDUALS) {
        let mean = result.residual_rms_rad;
        let ratio = (mean > 0.0).then(|| posture.residual_rms_rad / mean);
        table.row([
            posture.posture.clone(),
            posture.state.clone(),
            mdeg(posture.residual_rms_rad),
            mdeg(posture.motor_rms_rad),
            optional(ratio, 3),
        ]);
    }
    table
}
