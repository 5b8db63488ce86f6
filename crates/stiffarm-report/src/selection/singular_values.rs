//! What the observation matrix tells apart.

use crate::figure::{Axis, Figure, Panel, Series, Style};
use crate::order::places;
use stiffarm::plan::index::GroupEvaluation;

/// Singular values of each group, the largest first: those of Ψ·diag(1/k) where every group has them, else those of
/// Ψ. `noise_std_m` is the standard deviation of a displacement \[m\], where it is known.
pub fn singular_values_figure(groups: &[&GroupEvaluation], noise_std_m: Option<f64>) -> Figure {
    let scaled = groups.iter().all(|g| !g.scaled_singular_values.is_empty());
    let values = |group: &GroupEvaluation| -> Vec<f64> {
        if scaled {
            group.scaled_singular_values.iter().map(|v| 1e3 * v).collect()
        } else {
            group.singular_values.clone()
        }
    };
    let mut series: Vec<Series> = groups
        .iter()
        .map(|group| {
            let y = values(group);
            Series::new(&group.name, Style::Line, places(y.len()), y)
        })
        .collect();
    let count = groups.first().map_or(0, |g| g.singular_values.len());
    let noise = noise_std_m.filter(|std| scaled && *std > 0.0 && count > 1);
    if let Some(std) = noise {
        series.push(Series::new(
            "noise of one displacement",
            Style::Outline,
            vec![0.0, count as f64 - 1.0],
            vec![1e3 * std; 2],
        ));
    }
    let numbers = (1..=count).map(|i| i.to_string());
    let (y, caption) = if scaled {
        (
            Axis::log("singular value of Ψ·diag(1/k)", "mm"),
            "How far all readings together move where a combination of joints gives way by its whole compliance. The \
             last value belongs to the combination that is measured worst: the farther it lies above the noise, the \
             surer the stiffness.",
        )
    } else {
        (
            Axis::log("singular value of Ψ", "N·m²/rad"),
            "The last value belongs to the combination of joint compliances that is measured worst. The flatter the \
             line, the smaller cond(Ψ).",
        )
    };
    Figure::one(
        "singular-values",
        "Singular values of the observation matrix",
        caption,
        Panel::new("", Axis::categorical("number", numbers), y, series),
    )
}
