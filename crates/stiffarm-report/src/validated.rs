//! Calculated against measured displacements, Eq. (22) and Fig. 10.

use crate::figure::{Axis, Figure, Panel, Series, Style};
use crate::identified::place;
use crate::level::level;
use crate::order::{in_order, places};
use stiffarm::estimate::validate::{PointDeviation, Validation};
use stiffarm::findings::visible;

/// More points than this are shown posture by posture.
const MOST_BARS: usize = 40;

/// What rows are told apart by.
type Kind = (&'static str, fn(&PointDeviation) -> &str);
const KINDS: [Kind; 3] = [("posture", |p| &p.posture), ("load state", |p| &p.state), ("measuring point", |p| &p.point)];

/// What tells one row from another: posture, load state and point, as far as there are several of each.
fn row_names(points: &[PointDeviation]) -> (Vec<String>, String) {
    let several = |of: &fn(&PointDeviation) -> &str| in_order(points.iter().map(of)).len() > 1;
    let mut shown: Vec<_> = KINDS.iter().filter(|(_, of)| several(of)).collect();
    if shown.is_empty() {
        shown.push(&KINDS[2]);
    }
    let name = |p: &PointDeviation| {
        let parts: Vec<String> = shown.iter().map(|(_, of)| visible(of(p)).into_owned()).collect();
        parts.join(" · ")
    };
    let axis: Vec<&str> = shown.iter().map(|(word, _)| *word).collect();
    (points.iter().map(name).collect(), axis.join(" · "))
}

/// The posture and load state of all rows, where there is only one.
fn only(points: &[PointDeviation]) -> String {
    let one = |word: &str, names: Vec<&str>| match names.as_slice() {
        [name] => format!(", {word} {}", visible(name)),
        _ => String::new(),
    };
    one("posture", in_order(points.iter().map(|p| p.posture.as_str())))
        + &one("load state", in_order(points.iter().map(|p| p.state.as_str())))
}

/// Deviations of Eq. (22) with noise and tolerance, and calculated against measured displacement.
pub fn validation_figure(validation: &Validation) -> Figure {
    let points = &validation.points;
    let (labels, x, series) = if points.len() <= MOST_BARS {
        let y = points.iter().map(|p| 1e3 * p.deviation_m).collect();
        let bars = Series::new("deviation δb", Style::Bars, places(points.len()), y);
        let (labels, axis) = row_names(points);
        (labels, axis, bars)
    } else {
        // The first that tells many rows apart.
        let several = KINDS.iter().find(|(_, of)| in_order(points.iter().map(of)).len() > 1);
        let (axis, of) = *several.unwrap_or(&KINDS[0]);
        let names = in_order(points.iter().map(of));
        let (x, y) = points.iter().filter_map(|p| Some((place(&names, of(p))? as f64, 1e3 * p.deviation_m))).unzip();
        let dots = Series::new("deviation δb", Style::Points, x, y);
        let labels = names.into_iter().map(String::from).collect();
        (labels, axis.to_string(), dots)
    };
    let ends = vec![-0.5, labels.len() as f64 - 0.5];
    let line = |label: &str, style, value: f64| Series::new(label, style, ends.clone(), vec![1e3 * value; 2]);
    let mut deviations = vec![series];
    if validation.noise_expectation_m > 0.0 {
        let label = "mean by noise alone";
        deviations.push(line(label, Style::Dashed, validation.noise_expectation_m));
    }
    if let Some(tolerance) = validation.tolerance_m {
        deviations.push(line("tolerance", Style::Curve, tolerance));
    }
    let norm = |v: &[f64; 3]| 1e3 * v.iter().map(|c| c * c).sum::<f64>().sqrt();
    let measured: Vec<f64> = points.iter().map(|p| norm(&p.measured_m)).collect();
    let calculated: Vec<f64> = points.iter().map(|p| norm(&p.calculated_m)).collect();
    let half = points.iter().map(|p| {
        let band = p.band.as_ref();
        band.map_or(0.0, |band| 1e3 * band.norm_half_width_m)
    });
    let all = measured.iter().chain(&calculated).copied();
    let largest = all.fold(0.0, f64::max);
    let label = match &validation.band {
        Some(band) => format!("calculated, ± {} %", level(band.confidence)),
        None => "calculated".to_string(),
    };
    let against = vec![
        Series::new(label, Style::Points, measured, calculated).with_error(half.collect()),
        Series::new("calculated = measured", Style::Dashed, vec![0.0, largest], vec![0.0, largest]),
    ];
    Figure {
        id: "validation".into(),
        title: "Calculated against measured displacement".into(),
        caption: format!(
            "Deviation of calculated from measured displacement, Eq. (22), at each measuring point{}, with what noise \
             alone gives on average; and size of the displacement, calculated over measured: on the line the two \
             agree.",
            only(points)
        ),
        columns: 2,
        panels: vec![
            Panel::new(
                "deviation",
                Axis::categorical(x, labels),
                Axis::linear("deviation δb", "mm").from_zero(),
                deviations,
            ),
            Panel::new(
                "displacement",
                Axis::linear("measured", "mm").from_zero(),
                Axis::linear("calculated", "mm").from_zero(),
                against,
            ),
        ],
    }
}
