//! `stiffarm validate`: calculated against measured displacements, Eq. (22), at
//! postures kept out of the identification, or fold by fold without any.

mod readings;
mod remarks;

use super::serious_first;
use crate::args::ValidateArgs;
use crate::error::{of_option, of_usage};
use crate::files::ends_in;
use crate::input::Line;
use crate::numbers::{NONE, confidence, mm, percent, significant, times};
use crate::output::Exit;
use crate::progress::Progress;
use crate::session::Session;
use crate::table::{Align, Table, green, red, serious, title, weight};
use readings::{done, marked};
use remarks::said;
use stiffarm::estimate::elastic::ElasticChoice;
use stiffarm::estimate::identify::Fit;
use stiffarm::estimate::validate::{Model, PointBand, Validation};
use stiffarm::estimate::validated::{Folds, Request, notes};
use stiffarm::files::source::Source;
use stiffarm::findings::{Severity, list};
use stiffarm::measure::{Measured, prepare};
use stiffarm::model::cell::Cell;
use stiffarm::{Code, Error, Result};

/// Validates.
pub fn run(session: &Session, args: &ValidateArgs) -> Result<Exit> {
    let request = Request {
        model: args.model.into(),
        tolerance_mm: args.tolerance_mm,
        only: args.only.clone(),
    };
    request
        .check()
        .map_err(|e| of_usage(e, &["tolerance_mm"]))?;
    match (&args.stiffness, args.folds) {
        (Some(stiffness), None) => held_out(session, args, &request, stiffness),
        (None, Some(folds)) => cross(session, args, &request, &args.measurements, folds),
        (None, None) => Err(Error::new(
            Code::Usage,
            "There is no joint stiffness to validate.",
        )
        .hint("give the file that `stiffarm identify --output` wrote before the measurements, or --folds")),
        // A table of measurements before others is no stiffness.
        (Some(first), Some(folds)) if !ends_in(first, "json") => {
            let first = std::slice::from_ref(first);
            let from = [first, &args.measurements].concat();
            cross(session, args, &request, &from, folds)
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
fn held_out(
    session: &Session,
    args: &ValidateArgs,
    request: &Request,
    stiffness: &str,
) -> Result<Exit> {
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
    let measured = measured(session, args, request, &args.measurements, &named.cell)?;
    let cell = &named.cell;
    let serious = saved.predictor.serious();
    let unsettled = serious_first(serious.chain(measured.findings()), marked);
    let hashes = session.hashes();
    let hash = hashes.get("cell").map(String::as_str);
    let result = request.held_out(cell, hash, &saved, measured)?;
    let envelope = session.envelope("validate", None, request.options(None), &result);
    let result = &result.validation;
    let same_cell = !saved.is_of_another_cell(hash);
    let mut known = saved.predictor.doubts.clone();
    known.retain(|doubt| doubt.severity != Severity::Serious);
    known.extend(notes(&saved, same_cell, result));
    session.show(&envelope, || {
        unsettled.clone() + &named.line() + &said(&known) + &table(result)
    })?;
    Ok(Exit::finding(
        result.passed == Some(false) || !result.unpredicted.is_empty() || !unsettled.is_empty(),
    ))
}

/// Predicts each posture from fits without it.
fn cross(
    session: &Session,
    args: &ValidateArgs,
    request: &Request,
    from: &[String],
    folds: Folds,
) -> Result<Exit> {
    if request.model != Model::Linear {
        return Err(Error::new(
            Code::Unsupported,
            "With --folds only the linear model can be used.",
        )
        .key("--model"));
    }
    let named = session.read_cell(&args.cell)?;
    let fit = args.fit.options(&named.cell.setup.robot)?;
    let measured = measured(session, args, request, from, &named.cell)?;
    let cell = &named.cell;
    let unsettled = serious_first(measured.findings(), marked);
    let progress = Progress::new(session, "predicting each posture");
    let asked = args.fit.elastic.map(Into::into);
    let (result, described) = Fit::watched(cell, measured, &fit, progress.shared())
        .and_then(|fit| request.by_folds(&fit, asked, folds))
        .map_err(|e| match e.code() {
            Code::InvalidValue => e.key("--folds"),
            _ => of_option(e, &["elastic"]),
        })?;
    drop(progress);
    let said = match folds {
        Folds::All => "each posture is predicted by a fit without it".to_string(),
        Folds::Count(count) => {
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
    if asked.is_some_and(|asked| asked != ElasticChoice::Axes) {
        said += match described.elastic {
            Some(ElasticChoice::Mixed) => {
                "elastic model: mixed, its sizes found anew in each fold\n"
            }
            _ => "elastic model: the joint axes alone\n",
        };
    }
    let options = request.options(Some(described));
    let envelope = session.envelope("validate", None, options, &result);
    let result = &result.validation;
    session.show(&envelope, || {
        unsettled.clone() + &named.line() + &said + &table(result)
    })?;
    Ok(Exit::finding(
        result.passed == Some(false) || !result.unpredicted.is_empty() || !unsettled.is_empty(),
    ))
}

/// The measurements, or those of `--only`.
fn measured(
    session: &Session,
    args: &ValidateArgs,
    request: &Request,
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
    request
        .keep_only(&mut measured)
        .map_err(|e| of_option(e, &["only"]))?;
    Ok(measured)
}

fn table(result: &Validation) -> String {
    let mut out = String::new();
    if !result.unpredicted.is_empty() {
        let said = format!(
            "{} cannot be predicted: {} determine every joint that moves there.",
            list(&result.unpredicted),
            match result.folds {
                Some(_) => "the others do not",
                None => "the identification did not",
            }
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
            "Had these displacements been compensated as calculated, the errors would have been {}.\n",
            times(factor, 3, ["smaller", "larger"])
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
