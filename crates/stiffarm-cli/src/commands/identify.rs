//! `stiffarm identify`: joint stiffness from measured displacements.

mod words;

use crate::args::IdentifyArgs;
use crate::files::{Target, check_one_stdout, write_all};
use crate::input::NamedCell;
use crate::numbers::{NONE, mm, optional, percent, stiffness};
use crate::output::{Exit, to_json};
use crate::session::Session;
use crate::table::{Table, red, title, yellow};
use schemars::JsonSchema;
use serde::Serialize;
use stiffarm::identify::{
    Identification, IdentifyOptions, JointEstimate, NoiseSource, Verdict, identify,
    implausible_scale,
};
use stiffarm::measurement::{MeasuredPosture, split_by_name};
use stiffarm::{Code, Error, Result};

/// Postures whose residuals the table shows.
const SHOWN_RESIDUALS: usize = 5;

/// Options of the result.
#[derive(Serialize, JsonSchema)]
pub struct Options {
    /// Where the size of the noise comes from.
    pub noise: NoiseSource,
    /// Confidence of the intervals.
    pub confidence: f64,
    /// Postures left out.
    pub exclude: Vec<String>,
}

/// Identifies the joint stiffness.
pub fn run(session: &Session, args: &IdentifyArgs) -> Result<Exit> {
    if !(args.confidence > 0.0 && args.confidence < 1.0) {
        return Err(Error::new(
            Code::Usage,
            format!(
                "The confidence {} does not lie between 0 and 1.",
                args.confidence
            ),
        )
        .key("--confidence")
        .hint("give 0.95 for 95 %"));
    }
    let target = args
        .output
        .as_deref()
        .map(|path| Target::new(path, args.force))
        .transpose()?;
    check_one_stdout(session, &[target.as_ref()])?;
    let named = session.read_cell(&args.cell)?;
    let cell = &named.cell;
    let measured = session.read_measurements(&args.measurements, args.postures.as_deref(), cell)?;
    check_names("--exclude", &args.exclude, &measured)?;
    let (measured, _) = split_by_name(measured, &args.exclude);
    if measured.is_empty() {
        return Err(Error::new(Code::TooFewData, "All postures are excluded.").key("--exclude"));
    }
    let options = IdentifyOptions {
        noise: args.noise.into(),
        confidence: args.confidence,
        ..IdentifyOptions::default()
    };
    let result = identify(cell, &measured, &options)?;

    let implausible = implausible_scale(cell, &result);
    let exit = Exit::finding(!result.is_complete() || implausible.is_some());
    let options = Options {
        noise: options.noise,
        confidence: options.confidence,
        exclude: args.exclude.clone(),
    };
    let envelope = session.envelope("identify", None, options, &result);
    let table = || table(&named, &measured, &result, &args.exclude);
    match target {
        Some(Target::Stdout) => {
            session.print(&to_json(&envelope)?)?;
            session.remark(&table());
        }
        Some(target) => {
            write_all(session, &[(target, to_json(&envelope)?)])?;
            session.show(&envelope, table)?;
        }
        None => session.show(&envelope, table)?,
    }
    Ok(exit)
}

/// Refuses names that no measured posture has.
///
/// # Errors
/// An unknown name.
pub fn check_names(option: &str, names: &[String], measured: &[MeasuredPosture]) -> Result<()> {
    let Some(name) = names
        .iter()
        .find(|name| measured.iter().all(|m| m.posture.name != **name))
    else {
        return Ok(());
    };
    let mut known: Vec<&str> = measured.iter().map(|m| m.posture.name.as_str()).collect();
    known.dedup();
    Err(Error::new(
        Code::UnknownName,
        format!("The measurements have no posture \"{name}\"."),
    )
    .key(option)
    .hint(format!("measured postures: {}", known.join(", "))))
}

fn table(
    named: &NamedCell,
    measured: &[MeasuredPosture],
    result: &Identification,
    excluded: &[String],
) -> String {
    let mut out = named.line();
    out += &words::undetermined(result);
    out += &words::data(measured, result, excluded);
    out += &title("Joint stiffness");
    out += &estimates(result).to_string();
    out.push('\n');
    if let Some(finding) = implausible_scale(&named.cell, result) {
        out += &format!("{}\n", red(&finding.sentence));
    }
    for sentence in words::verdicts(result) {
        out += &format!("{sentence}\n");
    }
    for remark in words::remarks(&named.cell, measured, result) {
        out += &format!("{}: {remark}\n", yellow("note"));
    }
    out += &title("Postures with the largest residuals");
    out + &residuals(result).to_string()
}

fn estimates(result: &Identification) -> Table {
    let confidence = format!(
        "{} % interval [N·m/rad]",
        words::confidence(result.confidence)
    );
    let mut table = Table::new(
        [
            "joint",
            "k [N·m/rad]",
            "± standard error",
            &confidence,
            "relative error [%]",
        ]
        .map(String::from),
    );
    for joint in &result.joints {
        let relative = joint
            .standard_error
            .zip(joint.stiffness)
            .map(|(e, k)| percent(e / k.abs()));
        let none = || NONE.to_string();
        table.row([
            joint.name.clone(),
            joint.stiffness.map_or_else(none, stiffness),
            joint.standard_error.map_or_else(none, stiffness),
            interval(joint),
            relative.unwrap_or_else(none),
        ]);
    }
    table
}

fn interval(joint: &JointEstimate) -> String {
    match (joint.verdict, joint.interval) {
        (_, [Some(low), Some(high)]) => format!("{} to {}", stiffness(low), stiffness(high)),
        (_, [Some(low), None]) => format!("above {}", stiffness(low)),
        (Verdict::Undetermined, _) => "undetermined".to_string(),
        (Verdict::SignOrModelFault, _) => "sign or model fault".to_string(),
        _ => NONE.to_string(),
    }
}

fn residuals(result: &Identification) -> Table {
    let has_states = result
        .postures
        .iter()
        .any(|p| p.state != result.postures[0].state);
    let mut headings = vec![
        "posture",
        "residual RMS [mm]",
        "displacement RMS [mm]",
        "residual / mean",
    ];
    if has_states {
        headings.push("state");
    }
    let mut table = Table::new(headings);
    let mut postures: Vec<_> = result.postures.iter().collect();
    postures.sort_by(|a, b| b.residual_rms_m.total_cmp(&a.residual_rms_m));
    for posture in postures.into_iter().take(SHOWN_RESIDUALS) {
        let ratio =
            (result.residual_rms_m > 0.0).then(|| posture.residual_rms_m / result.residual_rms_m);
        let mut row = vec![
            posture.posture.clone(),
            mm(posture.residual_rms_m),
            mm(posture.displacement_rms_m),
            optional(ratio, 3),
        ];
        if has_states {
            row.push(posture.state.clone());
        }
        table.row(row);
    }
    table
}
