//! Choices of postures on measured readings: a figure and a table.

use super::markdown::{fenced, text};
use super::table::{Cell, Table};
use crate::figure::{Axis, Figure, Panel, Series, Style};
use std::fmt::Write;
use stiffarm::estimate::elastic::ElasticChoice;
use stiffarm::study::{Choice, MeasuredChoice, MeasuredStudy};

/// Error at the postures outside the pool, a panel per number of postures, a series per
/// model.
pub fn measured_figure(study: &MeasuredStudy) -> Figure {
    let mut ways = vec![Choice::Random];
    ways.extend(
        study
            .options
            .indices
            .iter()
            .map(|index| Choice::Index(*index)),
    );
    let names: Vec<String> = ways
        .iter()
        .map(|way| way.as_str().replace('_', " "))
        .chain([format!("all {}", study.pool_count)])
        .collect();
    let panels = study.options.counts.iter().map(|count| {
        let series = [ElasticChoice::Axes, ElasticChoice::Mixed].map(|model| {
            let of = |way: &Choice| study.get(*count, *way, model);
            let whole = study.get(study.pool_count, Choice::Pool, model);
            let all: Vec<Option<&MeasuredChoice>> = ways.iter().map(of).chain([whole]).collect();
            let number = |value: &dyn Fn(&MeasuredChoice) -> f64| -> Vec<f64> {
                all.iter().map(|c| c.map_or(f64::NAN, value)).collect()
            };
            let x = (0..all.len()).map(|i| i as f64).collect();
            Series::new(
                model_name(model),
                Style::Bars,
                x,
                number(&|c| 1e3 * c.mean_m),
            )
            .with_error(number(&|c| 1e3 * c.standard_error_m))
        });
        Panel {
            title: format!("{count} postures"),
            x: Axis::categorical("chosen by", names.clone()),
            y: {
                let mut axis = Axis::linear("error at the other postures", "mm");
                axis.from_zero = true;
                axis
            },
            series: series.to_vec(),
            equal_aspect: false,
        }
    });
    Figure {
        id: "measured-choices".into(),
        title: "What chosen postures predict on a measured robot".into(),
        caption: format!(
            "{}: RMS error of a displacement component at the {} postures outside a pool of {}, mean over {} random splits \
             with its standard error; the postures to identify from are chosen from the pool.",
            study.robot,
            study.posture_count - study.pool_count,
            study.pool_count,
            study.split_count
        ),
        columns: 1,
        panels: panels.collect(),
    }
}

/// Every way to choose with every model.
pub fn measured_table(study: &MeasuredStudy) -> Table {
    let mut table = Table::new(
        "measured-choices",
        "Error at the postures outside the pool: mean over the splits, its standard error, and the share of splits in which \
         the choice predicts better than chance.",
        [
            "postures",
            "chosen by",
            "model",
            "error [mm]",
            "standard error [mm]",
            "better than random [%]",
            "fallbacks to the axes",
            "missing",
        ]
        .map(String::from)
        .to_vec(),
    );
    for choice in &study.choices {
        table.rows.push(vec![
            choice.postures.to_string().into(),
            choice.choice.as_str().to_string().into(),
            model_name(choice.model).to_string().into(),
            Some(1e3 * choice.mean_m).into(),
            Some(1e3 * choice.standard_error_m).into(),
            Cell::percent(choice.better_than_random),
            choice.fallbacks.to_string().into(),
            choice.missing.to_string().into(),
        ]);
    }
    table
}

/// The model as figure and table name it.
fn model_name(model: ElasticChoice) -> &'static str {
    match model {
        ElasticChoice::Mixed => "mixed model",
        _ => "joint axes",
    }
}

/// The page, in Markdown. `command` is the command line that repeats the study; the
/// figure is referred to as `measured-choices.svg` beside the page.
pub fn measured_page(study: &MeasuredStudy, version: &str, command: &str) -> String {
    let (figure, table) = (measured_figure(study), measured_table(study));
    let mut out = format!(
        "# Choosing postures on measured readings: {}\n\n",
        text(&study.cell)
    );
    for finding in &study.findings {
        let _ = writeln!(out, "- {}", text(&finding.sentence));
    }
    let _ = write!(
        out,
        "\n![{}]({}.svg)\n\n*{}*\n",
        text(&figure.title),
        figure.id,
        text(&figure.caption)
    );
    let _ = write!(
        out,
        "\nOf {} measured postures (RMS displacement {:.3} mm) a pool of {} is drawn {} times. From the pool, postures are \
         chosen by chance or by an index, which knows angles and wrenches but no reading. Joint stiffness, or the mixed \
         model with its sizes, is identified from the chosen postures alone and predicts the other {}. The index prediction \
         takes the pool's own postures for the work to be done. Splits share postures: standard errors are those of the \
         mean over splits, not over robots.\n",
        study.posture_count,
        1e3 * study.displacement_rms_m,
        study.pool_count,
        study.split_count,
        study.posture_count - study.pool_count,
    );
    let _ = write!(
        out,
        "\n{}\n\n*{}*\n",
        table.markdown(),
        text(&table.caption)
    );
    let _ = write!(out, "\nMade by stiffarm {version}:\n\n{}", fenced(command));
    out
}
