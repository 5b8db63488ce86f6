//! A path as it should be, as the loaded tool leaves it, and as it is commanded, in planes of the workpiece frame.

use crate::figure::{Axis, Panel, Series, Style};
use stiffarm::nalgebra::{Isometry3, Vector3};

/// Most points that are drawn of a curve.
const DRAWN: usize = 4000;
/// Share of the part's size at which the largest shift is drawn at most.
const LARGEST: f64 = 0.1;
/// Share of the drawing's size below which nothing is seen in a plane.
const FLAT: f64 = 0.03;

/// A point of the path, base frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PartPoint {
    /// Position of the tip \[m\].
    pub tip_m: [f64; 3],
    /// Force \[N\] and moment \[N·m\] on it.
    pub load: [[f64; 3]; 2],
    /// Shift of the tip under its load \[m\].
    pub shift_m: [f64; 3],
    /// What the command adds to the path \[m\], where it was compensated.
    pub correction_m: Option<[f64; 3]>,
}

impl PartPoint {
    /// Whether the tool works there: other points interrupt the curves.
    fn works(&self) -> bool {
        self.load != [[0.0; 3]; 2]
    }
}

/// Panels for the first two planes of the workpiece frame in which the part is seen; shifts are exaggerated, as the
/// titles say. None where nothing is bent, or the path has no length.
pub(crate) fn part_panels(points: &[PartPoint], workpiece: &Isometry3<f64>) -> Vec<Panel> {
    let back = workpiece.inverse();
    let working = || points.iter().filter(|point| point.works());
    let tips: Vec<Vector3<f64>> = points
        .iter()
        .map(|point| back * stiffarm::nalgebra::Point3::from(Vector3::from(point.tip_m)))
        .map(|tip| tip.coords)
        .collect();
    let of_working = points.iter().zip(&tips).filter(|(point, _)| point.works());
    let size = spans(of_working.map(|(_, tip)| *tip)).max();
    let largest = working().map(|point| Vector3::from(point.shift_m).norm()).fold(0.0, f64::max);
    if !(size > 0.0 && largest > 0.0) {
        return Vec::new();
    }
    let times = rounded_down(LARGEST * size / largest).max(1.0);
    let shifted = |shift: fn(&PartPoint) -> Option<[f64; 3]>| -> Option<Vec<Vector3<f64>>> {
        let all = points.iter().zip(&tips).map(|(point, tip)| {
            let shift = back.rotation * Vector3::from(shift(point)?);
            Some(tip + shift * times)
        });
        all.collect()
    };
    let curves = [
        ("as it should be", Style::Dashed, Some(tips.clone())),
        ("as the tool bends away", Style::Curve, shifted(|point| Some(point.shift_m))),
        ("as it is commanded", Style::Curve, shifted(|point| point.correction_m)),
    ];
    let drawn = curves.iter().filter_map(|(.., curve)| curve.as_ref());
    let all = drawn.flat_map(|curve| curve.iter().zip(points));
    let spans = spans(all.filter(|(_, point)| point.works()).map(|(at, _)| *at));
    let axes = ["x", "y", "z"];
    let planes = [(0, 1), (0, 2), (1, 2)];
    let seen = planes.into_iter().filter(|(a, b)| spans[*a].min(spans[*b]) >= FLAT * spans.max());
    let runs = runs(points);
    seen.take(2)
        .map(|(a, b)| {
            let series = curves.iter().flat_map(|(label, style, curve)| {
                runs.iter().filter_map(move |run| {
                    let curve = curve.as_ref()?;
                    let along = |axis: usize| run.iter().map(|i| 1e3 * curve[*i][axis]).collect();
                    Some(Series::new(*label, *style, along(a), along(b)))
                })
            });
            Panel {
                title: format!("In the workpiece frame, deflections {times} times as large"),
                x: Axis::linear(axes[a], "mm"),
                y: Axis::linear(axes[b], "mm"),
                series: series.collect(),
                equal_aspect: true,
            }
        })
        .collect()
}

/// The points to draw of each part of the path on which the tool works.
fn runs(points: &[PartPoint]) -> Vec<Vec<usize>> {
    let step = points.len().div_ceil(DRAWN);
    let mut runs: Vec<Vec<usize>> = Vec::new();
    let numbered: Vec<usize> = (0..points.len()).collect();
    for run in numbered.chunk_by(|a, b| points[*a].works() == points[*b].works()) {
        if let ([first, .., last], true) = (run, points[run[0]].works()) {
            let inner = (*first..*last).step_by(step);
            runs.push(inner.chain([*last]).collect());
        }
    }
    runs
}

/// How far points reach along each axis.
fn spans(points: impl Iterator<Item = Vector3<f64>>) -> Vector3<f64> {
    let none = (Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY));
    let (low, high) = points.fold(none, |(low, high), at| (low.inf(&at), high.sup(&at)));
    (high - low).map(|span| span.max(0.0))
}

/// The next of 1, 2, 5, 10, … below.
fn rounded_down(value: f64) -> f64 {
    let power = 10f64.powf(value.log10().floor());
    let digit = [5.0, 2.0, 1.0].into_iter().find(|digit| digit * power <= value);
    digit.unwrap_or(1.0) * power
}
