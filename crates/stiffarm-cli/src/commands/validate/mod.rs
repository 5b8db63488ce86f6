//! `stiffarm validate`: calculated against measured displacements, Eq. (22), at
//! postures kept out of the identification, or fold by fold without any.

mod remarks;

pub use remarks::Validated;

use super::identify::readings::{done, marked};
use super::identify::{check_names, confidence};
use crate::args::{Folds, ValidateArgs};
use crate::files::ends_in;
use crate::input::Line;
use crate::numbers::{NONE, mm, percent, significant};
use crate::output::Exit;
use crate::progress::Progress;
use crate::screen::{columns, wrapped};
use crate::session::Session;
use crate::table::{Align, Table, green, red, serious, title, weight};
use remarks::{notes, said};
use schemars::JsonSchema;
use serde::Serialize;
use stiffarm::estimate::elastic::{ElasticChoice, elastic};
use stiffarm::estimate::identify::{Estimator, Fit, NoiseSource};
use stiffarm::estimate::mixed::MixedFit;
use stiffarm::estimate::validate::{
    Model, PointBand, Validation, cross_validate, cross_validate_mixed, validate_with,
};
use stiffarm::files::source::Source;
use stiffarm::findings::{Finding, Severity, list};
use stiffarm::measure::{Measured, prepare};
use stiffarm::model::cell::Cell;
use stiffarm::model::observation::ExtraTerm;
use stiffarm::units::mm_to_m;
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
    /// How each fold was identified, with --folds.
    pub fit: Option<FitOptions>,
}

/// Options of the identifications of a cross-validation.
#[derive(Serialize, JsonSchema)]
pub struct FitOptions {
    /// Folds of postures.
    pub folds: usize,
    /// How the unknowns are estimated.
    pub estimator: Estimator,
    /// The further terms.
    pub extra: Vec<ExtraTerm>,
    /// What gives way, where that is not the joint axes alone.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub elastic: Option<ElasticChoice>,
    /// Where the size of the noise comes from.
    pub noise: NoiseSource,
    /// Confidence of the bands.
    pub confidence: f64,
}

/// Validates.
pub fn run(session: &Session, args: &ValidateArgs) -> Result<Exit> {
    if let Some(tolerance) = args.tolerance_mm
        && !(tolerance.is_finite() && tolerance >= 0.0)
    {
        return Err(Error::new(
            Code::Usage,
            format!("The tolerance must be 0 mm or more, got {tolerance}."),
        )
        .key("--tolerance-mm"));
    }
    match (&args.stiffness, args.folds) {
        (Some(stiffness), None) => held_out(session, args, stiffness),
        (None, Some(folds)) => cross(session, args, &args.measurements, folds),
        (None, None) => Err(Error::new(
            Code::Usage,
            "There is no joint stiffness to validate.",
        )
        .hint("give the file that `stiffarm identify --output` wrote before the measurements, or --folds")),
        // A table of measurements before others is no stiffness.
        (Some(first), Some(folds)) if !ends_in(first, "json") => {
            let first = std::slice::from_ref(first);
            cross(session, args, &[first, &args.measurements].concat(), folds)
        }
        (Some(_), Some(_)) => Err(Error::new(
            Code::Usage,
            "With --folds the stiffness is identified anew in each fold, so no file of stiffness can be given.",
        )
        .key("--folds")
        .hint("give the cell and the measurements alone")),
    }
}

/// Validates a saved stiffness.
fn held_out(session: &Session, args: &ValidateArgs, stiffness: &str) -> Result<Exit> {
    if let Some(option) = args.fit.given() {
        return Err(Error::new(
            Code::Usage,
            format!("{option} can be used only with --folds."),
        )
        .key(option)
        .hint("a saved stiffness brings its own estimator, terms and confidence"));
    }
    let named = session.read_cell(&args.cell)?;
    let saved = session.read_stiffness(stiffness, &named.cell)?;
    let measured = measured(session, args, &args.measurements, &named.cell)?;
    let cell = &named.cell;
    let model = args.model.into();
    let tolerance = args.tolerance_mm.map(mm_to_m);
    let unsettled = unsettled(&measured);
    let mut remarks: Vec<Finding> = measured.findings().cloned().collect();
    let result = validate_with(cell, &saved.predictor, measured, model, tolerance)?;
    let same_cell = !saved.is_of_another_cell(session.hashes().get("cell").map(String::as_str));
    remarks.extend(notes(&saved, same_cell, &result));
    let result = Validated {
        validation: result,
        remarks,
    };
    let envelope = session.envelope("validate", None, options(args, None), &result);
    let result = &result.validation;
    session.show(&envelope, || {
        unsettled.clone()
            + &named.line()
            + &said(&notes(&saved, same_cell, result))
            + &table(result)
    })?;
    Ok(Exit::finding(
        result.passed == Some(false) || !unsettled.is_empty(),
    ))
}

/// Predicts each posture from fits without it.
fn cross(session: &Session, args: &ValidateArgs, from: &[String], folds: Folds) -> Result<Exit> {
    if Model::from(args.model) != Model::Linear {
        return Err(Error::new(
            Code::Unsupported,
            "With --folds only the linear model can be used.",
        )
        .key("--model"));
    }
    let named = session.read_cell(&args.cell)?;
    let fit = args.fit.options(&named.cell.setup.robot)?;
    let measured = measured(session, args, from, &named.cell)?;
    let cell = &named.cell;
    let count = match folds {
        Folds::Count(count) => count,
        Folds::All => {
            let mut names: Vec<&str> = measured
                .postures
                .iter()
                .map(|m| m.posture.name.as_str())
                .collect();
            names.sort_unstable();
            names.dedup();
            names.len()
        }
    };
    let unsettled = unsettled(&measured);
    let remarks = measured.findings().cloned().collect();
    let tolerance = args.tolerance_mm.map(mm_to_m);
    let progress = Progress::new(session, "predicting each posture");
    let asked = args.fit.elastic();
    let (result, model) = Fit::watched(cell, measured, &fit, progress.shared())
        .and_then(|fit| crossed(&fit, asked, count, tolerance))
        .map_err(|e| match e.code() {
            Code::InvalidValue => e.key("--folds"),
            _ => e,
        })?;
    drop(progress);
    let said = match folds {
        Folds::All => "each posture is predicted by a fit without it".to_string(),
        Folds::Count(_) => {
            format!("each of {count} folds of postures is predicted by a fit without it")
        }
    };
    let terms: Vec<String> = fit
        .extra
        .iter()
        .map(|t| t.name(&cell.setup.robot))
        .collect();
    let terms = match terms.is_empty() {
        true => String::new(),
        false => format!(", with {}", list(&terms)),
    };
    let mut said = format!("{said}; estimator {}{terms}\n", fit.estimator.as_str());
    if asked != ElasticChoice::Axes {
        said += match model {
            ElasticChoice::Mixed => "elastic model: mixed, its sizes found anew in each fold\n",
            _ => "elastic model: the joint axes alone\n",
        };
    }
    let fit = FitOptions {
        folds: count,
        estimator: fit.estimator,
        extra: fit.extra,
        elastic: args.fit.elastic.map(|_| model),
        noise: fit.noise,
        confidence: fit.confidence,
    };
    let result = Validated {
        validation: result,
        remarks,
    };
    let envelope = session.envelope("validate", None, options(args, Some(fit)), &result);
    let result = &result.validation;
    session.show(&envelope, || {
        unsettled.clone() + &named.line() + &said + &table(result)
    })?;
    Ok(Exit::finding(
        result.passed == Some(false) || !result.unpredicted.is_empty() || !unsettled.is_empty(),
    ))
}

/// Predicts fold by fold with the elastic model asked for; which one it was.
fn crossed(
    fit: &Fit,
    asked: ElasticChoice,
    count: usize,
    tolerance: Option<f64>,
) -> Result<(Validation, ElasticChoice)> {
    let mixed = match asked {
        ElasticChoice::Axes => None,
        ElasticChoice::Mixed => Some(MixedFit::new(fit).map_err(|e| e.key("--elastic"))?),
        ElasticChoice::Auto => {
            let (found, mixed) = elastic(fit, asked).map_err(|e| e.key("--elastic"))?;
            mixed.filter(|_| found.model == ElasticChoice::Mixed)
        }
    };
    Ok(match &mixed {
        Some(mixed) => (
            cross_validate_mixed(mixed, count, tolerance)?,
            ElasticChoice::Mixed,
        ),
        None => (cross_validate(fit, count, tolerance)?, ElasticChoice::Axes),
    })
}

fn options(args: &ValidateArgs, fit: Option<FitOptions>) -> Options {
    Options {
        model: args.model.into(),
        tolerance_mm: args.tolerance_mm,
        only: args.only.clone(),
        fit,
    }
}

/// The measurements, or those of `--only`.
fn measured(
    session: &Session,
    args: &ValidateArgs,
    from: &[String],
    cell: &Cell,
) -> Result<Measured> {
    let measurements = session.read_measurements(from, args.postures.as_deref(), cell)?;
    let reduce = session.read_registration(args.registration.as_deref())?;
    let mut measured = prepare(cell, measurements, &reduce)?;
    let usual = measured
        .findings()
        .filter(|f| f.severity != Severity::Serious);
    let remarks = done(&measured) + &usual.map(marked).collect::<String>();
    if !remarks.is_empty() {
        session.remark(&remarks);
    }
    check_names("--only", &args.only, &measured.postures)?;
    if !args.only.is_empty() {
        measured.retain(|name| args.only.iter().any(|only| only == name));
    }
    Ok(measured)
}

/// Serious findings about the readings, which stand before any number; empty without one.
fn unsettled(measured: &Measured) -> String {
    let serious = measured
        .findings()
        .filter(|f| f.severity == Severity::Serious);
    let said: Vec<String> = serious
        .map(|f| wrapped(marked(f).trim_end(), columns()))
        .collect();
    match said.is_empty() {
        true => String::new(),
        false => format!(
            "{}\nNot to be used before this is settled; from the readings as they are:\n",
            said.join("\n")
        ),
    }
}

fn table(result: &Validation) -> String {
    let mut out = String::new();
    if !result.unpredicted.is_empty() {
        let said = format!(
            "{} cannot be predicted: the others do not determine every joint that moves there.",
            list(&result.unpredicted)
        );
        out += &format!("{}\n", serious(&said));
    }
    out += &title("Deviation of calculated from measured displacement, Eq. (22)");
    let mut headings: Vec<String> = [
        "m-n",
        "posture",
        "point",
        "measured [mm]",
        "calculated [mm]",
        "deviation [mm]",
    ]
    .map(String::from)
    .to_vec();
    if let Some(band) = &result.band {
        let level = confidence(band.confidence);
        headings.push(format!("calculated ± {level} % [mm]"));
        headings.push(format!("outside {level} %"));
    }
    let states = result.points.iter().map(|p| &p.state);
    let has_states = states.clone().zip(states.skip(1)).any(|(a, b)| a != b);
    if has_states {
        headings.insert(2, "state".to_string());
    }
    let mut table = Table::new(headings);
    table.align(1, Align::Left);
    table.align(2, Align::Left);
    if has_states {
        table.align(3, Align::Left);
    }
    let norm = |v: &[f64; 3]| mm(v.iter().map(|c| c * c).sum::<f64>().sqrt());
    for point in &result.points {
        let mut row = vec![
            point.label.clone(),
            point.posture.clone(),
            point.point.clone(),
            norm(&point.measured_m),
            norm(&point.calculated_m),
            mm(point.deviation_m),
        ];
        if result.band.is_some() {
            row.extend(band(point.band.as_ref()));
        }
        if has_states {
            row.insert(2, point.state.clone());
        }
        table.row(row);
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
    if let Some(factor) = result.compensation_factor {
        out += &format!(
            "Had these displacements been compensated as calculated, the errors would have been {} times smaller.\n",
            significant(factor, 3)
        );
    }
    if result.folds.is_some() {
        out += &format!(
            "RMS of its components {} mm, to be held beside the residual RMS of the identification.\n",
            mm(result.component_rms_m)
        );
    }
    if result.noise_expectation_m > 0.0 {
        let mean =
            result.points.iter().map(|p| p.deviation_m).sum::<f64>() / result.points.len() as f64;
        out += &format!(
            "Its mean is {} times what the cell's noise alone gives ({} mm).\n",
            significant(mean / result.noise_expectation_m, 2),
            mm(result.noise_expectation_m)
        );
    }
    if let Some(band) = &result.band {
        out += &format!(
            "{} of {} components lie inside the {} % band of calculation and noise.\n",
            band.inside,
            band.components,
            confidence(band.confidence)
        );
    }
    for finding in &result.findings {
        let severity = weight(finding.severity);
        out += &format!("{severity}: {}\n", finding.sentence);
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

/// Half width of the calculated norm, and the axes on which the measured
/// displacement lies outside.
fn band(band: Option<&PointBand>) -> [String; 2] {
    let Some(band) = band else {
        return [NONE.to_string(), NONE.to_string()];
    };
    let axes = ["x", "y", "z"].into_iter().zip(band.inside);
    let outside: Vec<&str> = axes
        .filter_map(|(axis, inside)| (!inside).then_some(axis))
        .collect();
    let outside = match outside.is_empty() {
        true => NONE.to_string(),
        false => outside.join(" "),
    };
    [mm(band.norm_half_width_m), outside]
}
