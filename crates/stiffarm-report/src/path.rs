//! Deflection along a path, before and after compensation, as a figure.

use crate::figure::{Axis, Figure, Panel, Series, Style};
use crate::level::level;
use crate::part::{PartPoint, part_panels};
use stiffarm::nalgebra::Isometry3;
use stiffarm::work::compensate::Compensation;
use stiffarm::work::predict::Prediction;

/// Most points that are drawn of a curve.
const DRAWN: usize = 400;

/// One point of a path, along its length.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct PathCurvePoint {
    /// Length of the path up to it \[m\].
    pub along_m: f64,
    /// Deflection without compensation \[m\].
    pub deflection_m: f64,
    /// Half width of the deflection's band \[m\].
    pub half_width_m: Option<f64>,
    /// What is left after compensation with its band: the error is below it at the
    /// confidence of the bands \[m\].
    pub left_m: Option<f64>,
}

/// Deflection along the points of a prediction, and where they are a path the bent path in the workpiece frame
/// (base frame \[m\]).
pub fn prediction_figure(prediction: &Prediction, workpiece: Option<&Isometry3<f64>>) -> Figure {
    let points = &prediction.points;
    let lengths = along(points.iter().map(|p| p.tip_m));
    let curve = points.iter().zip(lengths).map(|(point, along_m)| PathCurvePoint {
        along_m,
        deflection_m: point.deflection_m,
        half_width_m: point.band.map(|band| band.size_m[3]),
        left_m: None,
    });
    let part = points.iter().map(|point| PartPoint {
        tip_m: point.tip_m,
        load: [point.force_n, point.moment_nm],
        shift_m: point.shift_m,
        correction_m: None,
    });
    with_part(path_figure(&curve.collect::<Vec<_>>(), prediction.confidence), part, workpiece)
}

/// Deflection along a path before and after compensation, and the path as it should be, bent and commanded in the
/// workpiece frame (base frame \[m\]).
pub fn compensation_figure(compensation: &Compensation, workpiece: Option<&Isometry3<f64>>) -> Figure {
    let points = &compensation.points;
    let lengths = along(points.iter().map(|p| p.tip_m));
    let curve = points.iter().zip(lengths).map(|(point, along_m)| {
        let half = point.band.map(|band| band.size_m[3]);
        PathCurvePoint {
            along_m,
            deflection_m: point.uncompensated_m,
            half_width_m: half,
            // Without a band nothing says how much of the deflection is taken away.
            left_m: half.map(|half| point.residual_m + half),
        }
    });
    let part = points.iter().map(|point| PartPoint {
        tip_m: point.tip_m,
        load: [point.force_n, point.moment_nm],
        shift_m: point.uncompensated_shift_m,
        correction_m: Some(point.correction_m),
    });
    with_part(path_figure(&curve.collect::<Vec<_>>(), compensation.confidence), part, workpiece)
}

/// The figure with the part below, where the points are a path.
fn with_part(mut figure: Figure, part: impl Iterator<Item = PartPoint>, workpiece: Option<&Isometry3<f64>>) -> Figure {
    if let Some(workpiece) = workpiece {
        let panels = part_panels(&part.collect::<Vec<_>>(), workpiece);
        figure.panels.extend(panels);
    }
    figure
}

/// Lengths of a path up to each of its points \[m\].
pub(crate) fn along(tips: impl Iterator<Item = [f64; 3]>) -> Vec<f64> {
    let mut length = 0.0;
    let mut last: Option<[f64; 3]> = None;
    let lengths = tips.map(|tip| {
        length += last.map_or(0.0, |last| norm([0, 1, 2].map(|i| tip[i] - last[i])));
        last = Some(tip);
        length
    });
    lengths.collect()
}

/// The size of a vector.
pub(crate) fn norm(v: [f64; 3]) -> f64 {
    v.iter().map(|c| c * c).sum::<f64>().sqrt()
}

/// The axis of what lies along a path: its length, or the points' numbers where it has none.
pub(crate) fn way_axis(moves: bool) -> Axis {
    if moves { Axis::linear("distance along the path", "mm") } else { Axis::linear("point of the path", "") }
}

/// What a band is called in a legend.
pub(crate) fn band_name(confidence: Option<f64>) -> String {
    confidence.map_or_else(|| "band".to_string(), |c| format!("{} % band", level(c)))
}

/// Deflection along a path with its band (`confidence` as a fraction) and, where
/// the points have it, what compensation leaves on a logarithmic scale below.
///
/// Of a long path the smallest and the largest value of each piece are drawn, so
/// that no extreme is lost. Where the path has no length, points are numbered.
pub fn path_figure(points: &[PathCurvePoint], confidence: Option<f64>) -> Figure {
    let moves = points.iter().any(|p| p.along_m > 0.0);
    let along: Vec<f64> = if moves {
        points.iter().map(|p| 1e3 * p.along_m).collect()
    } else {
        (1..=points.len()).map(|i| i as f64).collect()
    };
    let curve = |value: &dyn Fn(&PathCurvePoint) -> Option<f64>| {
        let values: Vec<Option<f64>> = points.iter().map(|p| value(p).map(|v| 1e3 * v)).collect();
        thinned(&values).into_iter().filter_map(|i| Some((i, along[i], values[i]?))).collect::<Vec<(usize, f64, f64)>>()
    };
    let series = |label: &str, style, curve: &[(usize, f64, f64)]| {
        let (x, y) = curve.iter().map(|(_, x, y)| (*x, *y)).unzip();
        Series::new(label, style, x, y)
    };
    let deflection = curve(&|p| Some(p.deflection_m));
    let mut first = Vec::new();
    let widths: Option<Vec<f64>> = deflection.iter().map(|(i, ..)| points[*i].half_width_m.map(|w| 1e3 * w)).collect();
    let band = band_name(confidence);
    if let Some(widths) = widths {
        let label = format!("without compensation, its {band}");
        first.push(series(&label, Style::Band, &deflection).with_error(widths));
    }
    first.push(series("without compensation", Style::Curve, &deflection));
    let mut panels = vec![Panel::new("", way_axis(moves), Axis::linear("deflection", "mm").from_zero(), first)];
    let left = curve(&|p| p.left_m);
    if !left.is_empty() {
        panels.push(Panel::new(
            "",
            way_axis(moves),
            Axis::log("error of the path", "mm"),
            vec![
                series("without compensation", Style::Curve, &deflection),
                series(&format!("left after compensation, upper end of its {band}"), Style::Curve, &left),
            ],
        ));
    }
    Figure {
        id: "path".into(),
        title: match panels.len() {
            1 => "Deflection along the path".into(),
            _ => "Deflection along the path, and what compensation leaves".into(),
        },
        caption: format!(
            "Deflection of the tool tip along the path of {} points{}.",
            points.len(),
            match panels.len() {
                1 => "",
                _ => ", and the error that is left after compensation",
            }
        ),
        columns: 1,
        panels,
    }
}

/// Indices of a curve to draw: of each piece its first, smallest and largest value.
pub(crate) fn thinned(values: &[Option<f64>]) -> Vec<usize> {
    let count = values.len();
    if count <= DRAWN {
        return (0..count).collect();
    }
    let pieces = DRAWN / 3;
    let mut drawn = Vec::with_capacity(DRAWN + 1);
    for piece in 0..pieces {
        let range = piece * count / pieces..(piece + 1) * count / pieces;
        let size = |i: &usize| values[*i].unwrap_or(f64::NAN);
        let defined = || range.clone().filter(|i| values[*i].is_some());
        drawn.extend(range.clone().next());
        drawn.extend(defined().min_by(|a, b| size(a).total_cmp(&size(b))));
        drawn.extend(defined().max_by(|a, b| size(a).total_cmp(&size(b))));
    }
    drawn.push(count - 1);
    drawn.sort_unstable();
    drawn.dedup();
    drawn
}
