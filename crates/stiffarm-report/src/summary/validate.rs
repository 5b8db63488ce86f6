//! What `validate` says: does the stiffness predict what was measured?

use super::arrows::{Residuals, residual_section};
use super::identify::readings;
use crate::level::level;
use crate::order::in_order;
use crate::path::norm;
use crate::summary::{Block, Context, DataTable, Number, Outcome, Quantity, Section, Summarise, Summary, Text};
use crate::validated::validation_figure;
use stiffarm::Result;
use stiffarm::ask::validate::{Options, Validated};
use stiffarm::estimate::elastic::ElasticChoice;
use stiffarm::estimate::validate::{Model, PointDeviation, Validation};
use stiffarm::findings::{Finding, Severity, codes, list, visible};
use stiffarm::measure::is_of_table;

/// Deviations this many times what noise gives on average are the model's.
const MODEL: f64 = 3.0;
/// Postures of the table to read first.
const MOST_ROWS: usize = 8;

impl Summarise<Options> for Validated {
    fn summary(&self, options: &Options, context: &Context<'_>) -> Result<Summary> {
        let all = self;
        let validation = &all.validation;
        let findings = all.every_finding();
        let verdict =
            [what_was_done(options, context, validation), conclusion(validation), next_step(validation, &findings)];
        let mut sections = Vec::new();
        if context.pictures {
            sections.push(Section::new(
                "deviations",
                "Calculated against measured",
                vec![Block::Figure(validation_figure(validation))],
            ));
        }
        sections.push(points(validation));
        if context.pictures {
            sections.extend(cell(context, validation)?);
        }
        let readings = all.readings.as_ref();
        let screening = readings.map(|readings| &readings.screening);
        sections.extend(readings::section(screening, readings));
        let heading = match validation.folds {
            Some(_) => "Cross-validation of the joint stiffness",
            None => "Validation of the joint stiffness",
        };
        let mut summary = context.summary(findings, heading, verdict, Some(key(validation)), sections);
        // What the table does not hold yet belongs to what was done.
        let [what_was_done, ..] = &mut summary.verdict;
        for finding in summary.findings.iter().filter(|f| is_of_table(f)) {
            *what_was_done = std::mem::take(what_was_done).words(format!(" {}", finding.sentence));
        }
        summary.findings.retain(|f| !is_of_table(f));
        summary.outcome = match (validation.passed, validation.unpredicted.is_empty()) {
            (Some(false), _) => Outcome::Serious,
            (_, false) if summary.outcome == Outcome::Good => Outcome::Caution,
            _ => summary.outcome,
        };
        Ok(summary)
    }
}

fn what_was_done(options: &Options, context: &Context<'_>, validation: &Validation) -> Text {
    let postures = in_order(validation.points.iter().map(|p| p.posture.as_str())).len();
    let how = match (validation.folds, validation.model) {
        (Some(folds), _) => {
            format!(
                "each predicted by a fit without it, in {folds} folds of postures under the loads that were measured"
            )
        }
        (None, Model::Linear) => "calculated from the saved stiffness with the linear model".to_string(),
        (None, Model::Equilibrium) => "calculated from the saved stiffness with the exact equilibrium".to_string(),
    };
    Text::new(format!(
        "{} displacements at {postures} {} were {how}, and compared with what was measured there, Eq. (22).{}",
        validation.points.len(),
        if postures == 1 { "posture" } else { "postures" },
        fits(options, context)
    ))
}

/// How each fold was identified, as a sentence behind another one; empty for a saved stiffness.
fn fits(options: &Options, context: &Context<'_>) -> String {
    let Some(fit) = &options.fit else {
        return String::new();
    };
    let robot = context.cell.map(|cell| &cell.setup.robot);
    let names = robot.map(|robot| fit.extra.iter().map(|term| term.name(robot)).collect());
    let names: Vec<String> = names.unwrap_or_default();
    let terms = if names.is_empty() { String::new() } else { format!(", with {}", list(&names)) };
    let elastic = match fit.elastic {
        ElasticChoice::Mixed => "mixed, its sizes found anew in each fold",
        _ => "the joint axes alone",
    };
    let estimator = fit.estimator.as_str();
    format!(" Estimator of the fits: {estimator}{terms}; elastic model: {elastic}.")
}

fn conclusion(validation: &Validation) -> Text {
    let mm = |length: f64| Number::new(length).of(Quantity::LENGTH);
    let unpredicted = if validation.unpredicted.is_empty() {
        Text::default()
    } else {
        let sentence = format!("{} cannot be predicted.", names(&validation.unpredicted));
        Text::default().strong(sentence).words(" At the others: ")
    };
    let mut text = unpredicted
        .words("Calculated and measured differ by ")
        .number(mm(validation.deviation_rms_m))
        .words(" (RMS), at most ")
        .number(mm(validation.deviation_max_m));
    if validation.displacement_rms_m > 0.0 {
        let share = Number::computed(validation.deviation_rms_m / validation.displacement_rms_m);
        text = text.words(": ").number(share.of(Quantity::PERCENT)).words(" of the displacements");
    }
    text = text.words(".");
    if validation.noise_expectation_m > 0.0 {
        text = text.words(" Noise alone gives ").number(mm(validation.noise_expectation_m)).words(" on average.");
    }
    if let Some(band) = &validation.band {
        let level = level(band.confidence);
        text = text.words(format!(
            " {} of {} components lie inside the {level} % band of calculation and noise.",
            band.inside, band.components
        ));
    }
    if let Some(factor) = validation.compensation_factor {
        let at_least = if validation.compensation_factor_is_bound { "at least " } else { "" };
        let text_of = text.words(" Compensated as calculated, the errors would have been ");
        text = if factor < 1.0 {
            text_of.number(Number::computed(1.0 / factor).significant(3)).words(" times larger.")
        } else {
            text_of
                .words(at_least)
                .number(Number::new(factor).significant(3))
                .words(" times smaller, the noise of these readings aside.")
        };
    }
    if validation.folds.is_some() {
        text = text
            .words(" The RMS of the components, to be held beside the residual RMS of the identification, is ")
            .number(mm(validation.component_rms_m))
            .words(".");
    }
    match validation.passed {
        Some(passed) => text
            .words(" The tolerance of ")
            .number(Number::new(validation.tolerance_m).of(Quantity::LENGTH))
            .words(" is ")
            .strong(if passed { "kept" } else { "not kept" })
            .words("."),
        None => text,
    }
}

/// Names from files as they are shown.
fn names(names: &[String]) -> String {
    let shown = names.iter().map(|name| visible(name).into_owned());
    list(&shown.collect::<Vec<_>>())
}

fn next_step(validation: &Validation, findings: &[Finding]) -> Text {
    if findings.iter().any(|f| f.severity == Severity::Serious) {
        return Text::default()
            .strong("Correct the readings first")
            .words(", then validate again; until then the numbers here are not to be used.");
    }
    if !validation.unpredicted.is_empty() {
        let others = match validation.folds {
            Some(_) => "without them the others do not",
            None => "the identification did not",
        };
        return Text::new("Measure more postures like ")
            .strong(names(&validation.unpredicted))
            .words(format!(": {others} determine every joint that moves there."));
    }
    let outside = findings.iter().any(|f| f.code == codes::OUTSIDE_BANDS);
    if let (Some(tolerance), Some(false), false) = (validation.tolerance_m, validation.passed, outside) {
        // The scatter of readings may be all that is beyond the tolerance.
        let noise = Number::new(validation.noise_expectation_m).of(Quantity::LENGTH);
        return if tolerance < validation.noise_expectation_m {
            Text::new("No stiffness can keep this tolerance in such readings: by noise alone they deviate by ")
                .number(noise)
                .words(" on average. Ask for a larger one, or read each point more often.")
        } else {
            Text::new("By noise alone these readings deviate by ").number(noise).words(
                " on average. Read each point more often and validate again: that tells whether the stiffness or the \
                     readings are not good enough.",
            )
        };
    }
    if outside || validation.passed == Some(false) {
        return Text::new(
            "More is wrong there than estimate and noise explain: look at the postures at the top of the table.",
        );
    }
    if findings.iter().any(|f| f.code == codes::SEEN_POSTURES) {
        return Text::new("Validate on postures that took no part: ")
            .code("stiffarm identify --exclude")
            .words(" leaves out some that were measured, or ")
            .code("--folds")
            .words(" predicts each posture by a fit without it.");
    }
    if validation.noise_expectation_m > 0.0 && validation.deviation_rms_m > MODEL * validation.noise_expectation_m {
        return Text::new("At postures like these count on errors of ")
            .number(Number::new(validation.deviation_max_m).of(Quantity::LENGTH))
            .words(": what is left is the model's, not the tracker's.");
    }
    Text::new("The stiffness can be worked with: ")
        .code("stiffarm predict")
        .words(" says how far the loaded tool bends away, ")
        .code("stiffarm compensate")
        .words(" gives the path to command instead.")
}

/// The worst point of each posture, the worst posture first.
fn key(validation: &Validation) -> DataTable {
    let names = in_order(validation.points.iter().map(|p| p.posture.as_str()));
    let size = |i: &usize| validation.points[*i].deviation_m;
    let worst = names.iter().filter_map(|name| {
        let rows = (0..validation.points.len()).filter(|i| validation.points[*i].posture == *name);
        rows.max_by(|a, b| size(a).total_cmp(&size(b)))
    });
    let mut worst: Vec<usize> = worst.collect();
    worst.sort_by(|a, b| size(b).total_cmp(&size(a)));
    let which = if worst.len() > MOST_ROWS {
        format!("the {MOST_ROWS} worst of {} postures", worst.len())
    } else {
        "the worst posture first".to_string()
    };
    let caption = format!("Largest deviation at each posture, Eq. (22), {which}");
    worst.truncate(MOST_ROWS);
    table(validation, &caption, &worst)
}

/// Rows of Eq. (22).
fn table(validation: &Validation, caption: &str, rows: &[usize]) -> DataTable {
    let point = |row: usize| &validation.points[rows[row]];
    let states = validation.points.iter().map(|p| &p.state);
    let has_states = states.clone().zip(states.skip(1)).any(|(a, b)| a != b);
    let size = |v: &[f64; 3]| Some(Number::computed(norm(*v)));
    let names = (0..rows.len()).map(|row| visible(&point(row).posture).into_owned());
    DataTable::of(caption, "posture", names)
        .words(
            "load state",
            |row| {
                if has_states { visible(&point(row).state).into_owned().into() } else { Text::default() }
            },
        )
        .words("point", |row| visible(&point(row).point).into_owned().into())
        .numbers("measured", Quantity::LENGTH, |row| size(&point(row).measured_m))
        .numbers("calculated", Quantity::LENGTH, |row| size(&point(row).calculated_m))
        .numbers("± calculated", Quantity::LENGTH, |row| {
            Some(Number::new(point(row).band.as_ref()?.norm_half_width_m))
        })
        .numbers("deviation", Quantity::LENGTH, |row| Some(Number::new(point(row).deviation_m)))
        .words("outside its band along", |row| outside(point(row)))
}

/// The axes along which a displacement lies outside its band.
fn outside(point: &PointDeviation) -> Text {
    let inside = point.band.as_ref().map_or([true; 3], |band| band.inside);
    let axes = ["x", "y", "z"].into_iter().zip(inside);
    let axes = axes.filter_map(|(axis, inside)| (!inside).then_some(axis));
    let axes: Vec<&str> = axes.collect();
    if axes.is_empty() { Text::default() } else { Text::default().strong(axes.join(" ")) }
}

/// Every point, folded away.
fn points(validation: &Validation) -> Section {
    let rows: Vec<usize> = (0..validation.points.len()).collect();
    let caption = "Every displacement: measured against calculated";
    let all = table(validation, caption, &rows);
    let summary = format!("All {} displacements", rows.len());
    let details = Block::Details(summary, vec![Block::Table(all)]);
    Section::new("points", "Point by point", vec![details])
}

/// The postures with the deviations as arrows.
fn cell(context: &Context<'_>, validation: &Validation) -> Result<Option<Section>> {
    let all = validation.postures.iter().map(|posture| {
        let points = validation.points.iter();
        let points = points.filter(|p| p.posture == posture.posture && p.state == posture.state);
        let at = points.clone().map(|p| {
            let left = std::array::from_fn(|i| p.measured_m[i] - p.calculated_m[i]);
            (p.point.as_str(), left)
        });
        Residuals {
            posture: &posture.posture,
            angles: &posture.angles,
            wrench: posture.wrench,
            size: points.map(|p| p.deviation_m).fold(0.0, f64::max),
            at: at.collect(),
        }
    });
    residual_section(
        context,
        "validation",
        &all.collect::<Vec<_>>(),
        None,
        ("Deviations", "measured minus calculated displacement", "with the largest deviation"),
    )
}
