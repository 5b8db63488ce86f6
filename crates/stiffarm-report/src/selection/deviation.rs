//! What each group can be expected to give, joint by joint.

use crate::figure::{Axis, Figure, Panel, Series, Style};
use crate::order::places;

/// Expected deviations of a group.
#[derive(Debug, Clone, Copy)]
pub struct Deviations<'a> {
    /// Name of the group.
    pub name: &'a str,
    /// Expected |k̂ − k|/k of each joint (fraction); `None` where a joint is not determined.
    pub each: &'a [Option<f64>],
}

/// Bars per joint and group of the expected deviation; `bounds` are what no group of as many postures goes below,
/// joint by joint (fraction), `noise_std_m` the standard deviation of a displacement \[m\], where they are known.
pub fn expected_deviation_figure(
    joints: &[String],
    groups: &[Deviations<'_>],
    bounds: &[f64],
    noise_std_m: Option<f64>,
) -> Figure {
    let percent = |v: f64| 100.0 * v;
    let mut series: Vec<Series> = groups
        .iter()
        .map(|group| {
            let y = group.each.iter().map(|d| d.map_or(f64::NAN, percent));
            Series::new(group.name, Style::Bars, places(joints.len()), y.collect())
        })
        .collect();
    let mut caption = match noise_std_m {
        Some(std) => format!(
            "Expected |k̂ − k|/k per joint at variance factor 1 (σ = {:.1} µm per axis), closed form: 0.80 of \
             the relative standard error.",
            1e6 * std
        ),
        None => {
            "Expected |k̂ − k|/k per joint at the cell's noise, closed form: 0.80 of the relative standard error. The \
             lower, the better."
                .to_string()
        }
    };
    if !bounds.is_empty() {
        let y = bounds.iter().copied().map(percent).collect();
        series.push(Series::new("no plan of as many postures goes below", Style::Hollow, places(bounds.len()), y));
        caption += " Stars: what a plan for this joint alone could reach.";
    }
    Figure::one(
        "expected-deviation",
        "Expected deviation of the joint stiffness",
        caption,
        Panel::new("", Axis::categorical("", joints.to_vec()), Axis::log("expected deviation", "%"), series),
    )
}
