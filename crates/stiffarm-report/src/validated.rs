//! Calculated against measured displacements, Eq. (22) and Fig. 10.

use crate::figure::{Axis, Figure, Panel, Series, Style};
use crate::identified::{in_order, place, places};
use stiffarm::estimate::validate::Validation;

/// More points than this are shown posture by posture.
const MOST_BARS: usize = 40;

/// Deviations of Eq. (22) with noise and tolerance, and calculated against measured displacement.
pub fn validation_figure(found: &Validation) -> Figure {
    let points = &found.points;
    let (labels, x, series) = match points.len() <= MOST_BARS {
        true => {
            let y = points.iter().map(|p| 1e3 * p.deviation_m).collect();
            let bars = Series::new("deviation δb", Style::Bars, places(points.len()), y);
            let labels: Vec<String> = points.iter().map(|p| p.label.clone()).collect();
            (labels, "posture – measuring point", bars)
        }
        false => {
            let names = in_order(points.iter().map(|p| p.posture.as_str()));
            let at = |posture: &str| place(&names, posture) as f64;
            let x = points.iter().map(|p| at(&p.posture)).collect();
            let y = points.iter().map(|p| 1e3 * p.deviation_m).collect();
            let dots = Series::new("deviation δb", Style::Points, x, y);
            let labels = names.into_iter().map(String::from).collect();
            (labels, "posture", dots)
        }
    };
    let ends = vec![-0.5, labels.len() as f64 - 0.5];
    let line = |label: &str, style, value: f64| {
        Series::new(label, style, ends.clone(), vec![1e3 * value; 2])
    };
    let mut deviations = vec![series];
    if found.noise_expectation_m > 0.0 {
        let label = "mean by noise alone";
        deviations.push(line(label, Style::Dashed, found.noise_expectation_m));
    }
    if let Some(tolerance) = found.tolerance_m {
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
    let label = match &found.band {
        Some(band) => format!(
            "calculated, ± {} %",
            (1000.0 * band.confidence).round() / 10.0
        ),
        None => "calculated".to_string(),
    };
    let against = vec![
        Series::new(label, Style::Points, measured, calculated).with_error(half.collect()),
        Series::new(
            "calculated = measured",
            Style::Dashed,
            vec![0.0, largest],
            vec![0.0, largest],
        ),
    ];
    Figure {
        id: "validation".into(),
        title: "Calculated against measured displacement".into(),
        caption: "Deviation of calculated from measured displacement, Eq. (22), at each measuring point, with what noise alone \
                  gives on average; and size of the displacement, calculated over measured: on the line the two agree."
            .into(),
        columns: 2,
        panels: vec![
            Panel {
                title: "deviation".into(),
                x: Axis::categorical(x, labels),
                y: Axis::linear("deviation δb", "mm").from_zero(),
                series: deviations,
                equal_aspect: false,
            },
            Panel {
                title: "displacement".into(),
                x: Axis::linear("measured", "mm").from_zero(),
                y: Axis::linear("calculated", "mm").from_zero(),
                series: against,
                equal_aspect: false,
            },
        ],
    }
}
