//! Deflection at single postures, which no path joins.

use crate::figure::{Axis, Figure, Panel, Series, Style};
use crate::order::places;

/// The deflection at one posture.
#[derive(Debug, Clone, PartialEq)]
pub struct PointDeflection {
    /// Name of the posture or task.
    pub name: String,
    /// Displacement, base axes \[m\].
    pub shift_m: [f64; 3],
    /// Its size \[m\].
    pub size_m: f64,
    /// Half widths of the bands along x, y and z and of the size \[m\].
    pub half_width_m: Option<[f64; 4]>,
}

/// Bars of the deflection at each posture with its ± (`confidence` as a fraction): its size, and its components in
/// base axes.
pub fn point_deflection_figure(points: &[PointDeflection], confidence: Option<f64>) -> Figure {
    let names: Vec<&str> = points.iter().map(|point| point.name.as_str()).collect();
    let series = |label: &str, axis: usize, value: &dyn Fn(&PointDeflection) -> f64| {
        let x = places(points.len());
        let y = points.iter().map(|point| 1e3 * value(point)).collect();
        let widths = points.iter().map(|p| p.half_width_m.map(|w| 1e3 * w[axis]));
        let series = Series::new(label, Style::Bars, x, y);
        match widths.collect::<Option<Vec<f64>>>() {
            Some(widths) => series.with_error(widths),
            None => series,
        }
    };
    let panel = |title: &str, label: &str, series| {
        Panel::new(title, Axis::categorical("", names.clone()), Axis::linear(label, "mm").from_zero(), series)
    };
    let band = match confidence {
        Some(confidence) => format!(", with its ± at {} %", crate::level::level(confidence)),
        None => String::new(),
    };
    Figure {
        id: "deflection".into(),
        title: "Deflection at each posture".into(),
        caption: format!(
            "Deflection of the tool tip at each posture{band}: its size, and its components in base axes. A part comes \
             out wrong where its surface lies across them."
        ),
        columns: 2,
        panels: vec![
            panel("size", "deflection", vec![series("size", 3, &|p| p.size_m)]),
            panel(
                "components",
                "deflection",
                vec![
                    series("along x", 0, &|p| p.shift_m[0]),
                    series("along y", 1, &|p| p.shift_m[1]),
                    series("along z", 2, &|p| p.shift_m[2]),
                ],
            ),
        ],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_posture_has_its_name_and_its_bars() {
        let point = |name: &str, size_m: f64| PointDeflection {
            name: name.into(),
            shift_m: [size_m, 0.0, 0.0],
            size_m,
            half_width_m: Some([1e-5, 1e-5, 1e-5, 2e-5]),
        };
        let figure = point_deflection_figure(&[point("roughing", 1e-3), point("b", 2e-3)], Some(0.95));
        assert_eq!(figure.panels[0].x.categories, ["roughing", "b"]);
        assert_eq!(figure.panels[0].series[0].y, [1.0, 2.0]);
        assert_eq!(figure.panels[0].series[0].error, [0.02, 0.02]);
        assert_eq!(figure.panels[1].series.len(), 3);
        assert!(figure.caption.contains("± at 95 %"));
    }
}
