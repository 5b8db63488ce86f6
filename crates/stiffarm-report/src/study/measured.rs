//! Choices of postures on measured readings: a figure and a table.

use super::table::{Cell, Table};
use crate::figure::{Axis, Figure, Panel, Series, Style};
use stiffarm::estimate::elastic::ElasticChoice;
use stiffarm::study::{Choice, MeasuredChoice, MeasuredStudy};

/// Error at the postures outside the pool against the number of postures, a panel per
/// model, bars by choice; dashed, the whole pool.
pub fn measured_figure(study: &MeasuredStudy) -> Figure {
    let indices = study.options.indices.iter().copied().map(Choice::Index);
    let ways: Vec<Choice> = std::iter::once(Choice::Random).chain(indices).collect();
    let counts = &study.options.counts;
    let millimetres = |c: &MeasuredChoice| [1e3 * c.mean_m, 1e3 * c.standard_error_m];
    let all = study.choices.iter().map(|c| millimetres(c).iter().sum());
    let highest = all.filter(|v: &f64| v.is_finite()).fold(0.0, f64::max);
    let panels = [ElasticChoice::Axes, ElasticChoice::Mixed].map(|model| {
        let mut series: Vec<Series> = ways
            .iter()
            .map(|way| {
                let of = |count: &usize| study.get(*count, *way, model).map(millimetres);
                let shown: Vec<[f64; 2]> = counts.iter().map(|c| of(c).unwrap_or([f64::NAN; 2])).collect();
                let x = (0..counts.len()).map(|i| i as f64).collect();
                let label = way.as_str().replace('_', " ");
                Series::new(label, Style::Bars, x, shown.iter().map(|v| v[0]).collect())
                    .with_error(shown.iter().map(|v| v[1]).collect())
            })
            .collect();
        if let Some(whole) = study.get(study.pool_count, Choice::Pool, model) {
            let ends = vec![-0.5, counts.len() as f64 - 0.5];
            let label = format!("all {} of the pool", study.pool_count);
            series.push(Series::new(label, Style::Dashed, ends, vec![1e3 * whole.mean_m; 2]));
        }
        let names: Vec<String> = counts.iter().map(usize::to_string).collect();
        Panel::new(
            model.in_words(),
            Axis::categorical("postures chosen", names),
            {
                let mut axis = Axis::linear("error at the other postures", "mm");
                // Both models on one scale.
                axis.range = (highest > 0.0).then_some([0.0, 1.05 * highest]);
                axis
            },
            series,
        )
    });
    Figure {
        id: "measured-choices".into(),
        title: "What chosen postures predict on a measured robot".into(),
        caption: format!(
            "{}: RMS error of a displacement component at the {} postures outside a pool of {}, mean over {} random \
             splits with its standard error, against the number of postures chosen from the pool and the way of \
             choosing.",
            study.robot,
            study.posture_count - study.pool_count,
            study.pool_count,
            study.split_count
        ),
        columns: 2,
        panels: panels.to_vec(),
    }
}

/// Every way to choose with every model.
pub fn measured_table(study: &MeasuredStudy) -> Table {
    let mut table = Table::new(
        "measured-choices",
        "Error at the postures outside the pool: mean over the splits, its standard error, and the share of splits in \
         which the choice predicts better than chance.",
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
            choice.choice.as_str().into(),
            choice.model.in_words().into(),
            Some(1e3 * choice.mean_m).into(),
            Some(1e3 * choice.standard_error_m).into(),
            Cell::percent(choice.better_than_random),
            choice.fallbacks.to_string().into(),
            choice.missing.to_string().into(),
        ]);
    }
    table
}
