//! The page of `validate`: does the stiffness predict what was measured?

use super::arrows::{Residuals, residual_section};
use crate::identified::in_order;
use crate::tell::Given;
use crate::tell::{Block, DataTable, Number, Outcome, Section, Text, Told};
use crate::validated::validation_figure;
use stiffarm::Result;
use stiffarm::estimate::validate::{Model, PointDeviation, Validation};
use stiffarm::findings::{Severity, list, visible};

/// Deviations this many times what noise gives on average are the model's.
const MODEL: f64 = 3.0;
/// Postures of the table to read first.
const MOST_ROWS: usize = 8;

/// What a result says of `validate`.
pub(super) fn told(context: &Given<'_>) -> Result<Told> {
    let found: Validation = context.saved.result()?;
    let verdict = [done(&found), came(context, &found), next(context, &found)];
    let mut sections = vec![Section::new(
        "deviations",
        "Calculated against measured",
        vec![Block::Figure(validation_figure(&found))],
    )];
    sections.extend(cell(context, &found)?);
    sections.push(points(context, &found));
    let heading = match found.folds {
        Some(_) => "Cross-validation of the joint stiffness",
        None => "Validation of the joint stiffness",
    };
    let key = key(context, &found);
    let mut told = context.told(heading.to_string(), verdict, Some(key), sections);
    told.outcome = match (found.passed, found.unpredicted.is_empty()) {
        (Some(false), _) => Outcome::Serious,
        (_, false) if told.outcome == Outcome::Good => Outcome::Caution,
        _ => told.outcome,
    };
    Ok(told)
}

fn done(found: &Validation) -> Text {
    let postures = in_order(found.points.iter().map(|p| p.posture.as_str())).len();
    let how = match (found.folds, found.model) {
        (Some(folds), _) => format!(
            "each predicted by a fit without it, in {folds} folds of postures, and compared with what was measured there"
        ),
        (None, Model::Linear) => {
            "calculated from the saved stiffness with the linear model, and compared with what was measured there"
                .to_string()
        }
        (None, Model::Equilibrium) => {
            "calculated from the saved stiffness with the exact equilibrium, and compared with what was measured there"
                .to_string()
        }
    };
    Text::new(format!(
        "{} displacements at {postures} {} were {how}, Eq. (22).",
        found.points.len(),
        if postures == 1 { "posture" } else { "postures" },
    ))
}

fn came(context: &Given<'_>, found: &Validation) -> Text {
    let mm = |below: &str| context.number(below).mm().decimals(4);
    let mut text = Text::new("Calculated and measured differ by ")
        .number(mm("/deviation_rms_m"))
        .words(" (RMS), at most ")
        .number(mm("/deviation_max_m"));
    if found.displacement_rms_m > 0.0 {
        let share = Number::new("", Some(found.deviation_rms_m / found.displacement_rms_m));
        text = text
            .words(": ")
            .number(share.percent().significant(2))
            .words(" of the displacements");
    }
    text = text.words(".");
    if found.noise_expectation_m > 0.0 {
        text = text
            .words(" Noise alone gives ")
            .number(mm("/noise_expectation_m"))
            .words(" on average.");
    }
    if let Some(band) = &found.band {
        let level = (1000.0 * band.confidence).round() / 10.0;
        text = text.words(format!(
            " {} of {} components lie inside the {level} % band of calculation and noise.",
            band.inside, band.components
        ));
    }
    if let Some(factor) = found.compensation_factor {
        let text_of = text.words(" Compensated as calculated, the errors would have been ");
        text = match factor < 1.0 {
            false => text_of
                .number(context.number("/compensation_factor").significant(3))
                .words(" times smaller."),
            true => text_of
                .number(Number::new("", Some(1.0 / factor)).significant(3))
                .words(" times larger."),
        };
    }
    match found.passed {
        Some(true) => text
            .words(" The tolerance of ")
            .number(mm("/tolerance_m"))
            .words(" is ")
            .strong("kept")
            .words("."),
        Some(false) => text
            .words(" The tolerance of ")
            .number(mm("/tolerance_m"))
            .words(" is ")
            .strong("not kept")
            .words("."),
        None => text,
    }
}

fn next(context: &Given<'_>, found: &Validation) -> Text {
    let findings = context.saved.findings();
    if findings.iter().any(|f| f.severity == Severity::Serious) {
        return Text::default()
            .strong("Correct the readings first")
            .words(", then validate again; until then the numbers here are not to be used.");
    }
    if !found.unpredicted.is_empty() {
        let names = found.unpredicted.iter().map(|name| visible(name));
        let names: Vec<String> = names.map(String::from).collect();
        return Text::new("Measure more postures like ")
            .strong(list(&names))
            .words(": without them the others do not determine every joint that moves there.");
    }
    let outside = findings.iter().any(|f| f.code == "outside-bands");
    if let (Some(tolerance), Some(false), false) = (found.tolerance_m, found.passed, outside) {
        // The scatter of readings may be all that is beyond the tolerance.
        let noise = context.number("/noise_expectation_m").mm().decimals(4);
        return match tolerance < found.noise_expectation_m {
            true => Text::new("No stiffness can keep this tolerance in such readings: by noise alone they deviate by ")
                .number(noise)
                .words(" on average. Ask for a larger one, or read each point more often."),
            false => Text::new("By noise alone these readings deviate by ")
                .number(noise)
                .words(
                    " on average. Read each point more often and validate again: that tells whether the stiffness or the \
                     readings are not good enough.",
                ),
        };
    }
    if outside || found.passed == Some(false) {
        return Text::new("More is wrong there than estimate and noise explain: look at the postures at the top of the table, \
                          then identify again with ")
            .code("--elastic auto")
            .words(", which tells whether more than the joint axes gives way.");
    }
    if findings.iter().any(|f| f.code == "seen-postures") {
        return Text::new("Validate on postures that took no part: ")
            .code("stiffarm identify --exclude")
            .words(" keeps some of those measured out, or ")
            .code("--folds")
            .words(" predicts each by a fit without it.");
    }
    if found.noise_expectation_m > 0.0 && found.deviation_rms_m > MODEL * found.noise_expectation_m
    {
        let text = Text::new("At postures like these count on errors of ")
            .number(context.number("/deviation_max_m").mm().decimals(2))
            .words(": what is left is the model's, not the tracker's.");
        let elastic = &context.saved.json["options"]["fit"]["elastic"];
        return match elastic == "mixed" {
            true => text,
            false => text
                .words(" ")
                .code("stiffarm identify --elastic auto")
                .words(" tells whether more than the joint axes gives way."),
        };
    }
    Text::new("The stiffness can be worked with: ")
        .code("stiffarm predict")
        .words(" says how far the loaded tool bends away, ")
        .code("stiffarm compensate")
        .words(" gives the path to command instead.")
}

/// Whether a displacement lies inside its band, in words.
fn inside(point: &PointDeviation) -> &'static str {
    match &point.band {
        None => "–",
        Some(band) if band.inside.iter().all(|inside| *inside) => "inside",
        Some(_) => "outside",
    }
}

/// The worst point of each posture, the worst posture first.
fn key(context: &Given<'_>, found: &Validation) -> DataTable {
    let names = in_order(found.points.iter().map(|p| p.posture.as_str()));
    let size = |i: &usize| found.points[*i].deviation_m;
    let worst = names.iter().filter_map(|name| {
        let own = (0..found.points.len()).filter(|i| found.points[*i].posture == *name);
        own.max_by(|a, b| size(a).total_cmp(&size(b)))
    });
    let mut worst: Vec<usize> = worst.collect();
    worst.sort_by(|a, b| size(b).total_cmp(&size(a)));
    let which = match worst.len() > MOST_ROWS {
        true => format!("the {MOST_ROWS} worst of {} postures", worst.len()),
        false => "the worst posture first".to_string(),
    };
    let caption = format!("Largest deviation at each posture, Eq. (22), {which}");
    worst.truncate(MOST_ROWS);
    table(context, found, &caption, &worst)
}

/// Rows of Eq. (22).
fn table(context: &Given<'_>, found: &Validation, caption: &str, rows: &[usize]) -> DataTable {
    let mut table = DataTable::new(
        caption,
        [
            "posture",
            "load state",
            "point",
            "measured [mm]",
            "calculated [mm]",
            "± calculated [mm]",
            "deviation [mm]",
            "band",
        ],
    );
    let norm = |v: &[f64; 3]| {
        let number = Number::new("", Some(v.iter().map(|c| c * c).sum::<f64>().sqrt()));
        Text::from(number.mm().bare().decimals(4))
    };
    for &i in rows {
        let point = &found.points[i];
        let at = |key: &str| {
            let number = context.number(&format!("/points/{i}/{key}"));
            Text::from(number.mm().bare().decimals(4))
        };
        let cells = [
            visible(&point.state).into_owned().into(),
            visible(&point.point).into_owned().into(),
            norm(&point.measured_m),
            norm(&point.calculated_m),
            at("band/norm_half_width_m"),
            at("deviation_m"),
            match inside(point) {
                "outside" => Text::default().strong("outside"),
                word => word.into(),
            },
        ];
        table.row(visible(&point.posture).into_owned(), cells);
    }
    table
}

/// Every point, folded away.
fn points(context: &Given<'_>, found: &Validation) -> Section {
    let rows: Vec<usize> = (0..found.points.len()).collect();
    let caption = "Every displacement: measured against calculated";
    let all = table(context, found, caption, &rows);
    let summary = format!("All {} displacements", rows.len());
    let details = Block::Details(summary, vec![Block::Table(all)]);
    Section::new("points", "Point by point", vec![details])
}

/// The postures with the deviations as arrows.
fn cell(context: &Given<'_>, found: &Validation) -> Result<Option<Section>> {
    let all = found.postures.iter().map(|posture| {
        let own = found.points.iter();
        let own = own.filter(|p| p.posture == posture.posture && p.state == posture.state);
        let at: Vec<(&str, [f64; 3])> = own
            .map(|p| {
                let left = std::array::from_fn(|i| p.measured_m[i] - p.calculated_m[i]);
                (p.point.as_str(), left)
            })
            .collect();
        Residuals {
            posture: &posture.posture,
            angles: &posture.angles,
            wrench: posture.wrench,
            size: at
                .iter()
                .map(|(_, v)| v.iter().map(|c| c * c).sum::<f64>())
                .fold(0.0, f64::max),
            at,
        }
    });
    residual_section(
        context,
        "validation",
        &all.collect::<Vec<_>>(),
        None,
        ("Deviations", "measured minus calculated displacement"),
    )
}
