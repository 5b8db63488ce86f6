//! Components of a shift along a path, each with its band, as a figure.

use crate::figure::{Axis, Figure, Panel, Series, Style};
use crate::path::{band_name, thinned, way_axis};

/// A shift along a path.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct PathShift {
    /// Length of the path up to its point \[m\].
    pub along_m: f64,
    /// The shift, base axes \[m\].
    pub shift_m: [f64; 3],
    /// Half widths of its band, base axes \[m\].
    pub half_width_m: Option<[f64; 3]>,
}

/// Components x, y, z of a shift along a path (`what`, as `deflection`) with their bands, `confidence` as a fraction.
///
/// Of a long path the smallest and the largest value of each piece are drawn. Where the path has no length, points
/// are numbered.
pub fn path_components_figure(points: &[PathShift], what: &str, confidence: Option<f64>, caption: String) -> Figure {
    let moves = points.iter().any(|p| p.along_m > 0.0);
    let band = band_name(confidence);
    let panels = ["x", "y", "z"].iter().enumerate().map(|(axis, name)| {
        let values: Vec<Option<f64>> = points.iter().map(|p| Some(1e3 * p.shift_m[axis])).collect();
        let drawn = thinned(&values);
        let at = drawn.iter().map(|i| if moves { 1e3 * points[*i].along_m } else { (i + 1) as f64 });
        let at: Vec<f64> = at.collect();
        let shift: Vec<f64> = drawn.iter().map(|i| 1e3 * points[*i].shift_m[axis]).collect();
        let widths = drawn.iter().map(|i| points[*i].half_width_m.map(|w| 1e3 * w[axis]));
        let widths: Option<Vec<f64>> = widths.collect();
        let mut series = Vec::new();
        if let Some(widths) = widths.filter(|_| !points.is_empty()) {
            let label = format!("{what}, its {band}");
            let one = Series::new(label, Style::Band, at.clone(), shift.clone());
            series.push(one.with_error(widths));
        }
        series.push(Series::new(what, Style::Curve, at, shift));
        Panel::new(format!("along {name} of the base"), way_axis(moves), Axis::linear(what, "mm").from_zero(), series)
    });
    Figure {
        id: "path-components".into(),
        title: format!("Components of the {what} along the path"),
        caption,
        columns: 3,
        panels: panels.collect(),
    }
}
