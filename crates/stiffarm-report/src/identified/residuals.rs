//! Residuals against noise, posture by posture and point by point.

use super::place;
use crate::figure::{Axis, Figure, Panel, Series, Style};
use crate::order::{in_order, places};
use stiffarm::estimate::clamped::ClampedIdentification;
use stiffarm::estimate::identify::Identification;
use stiffarm::units::rad_to_deg;

/// Half width of the band that holds 95 of 100 components of noise alone.
const BAND: f64 = 1.96;
/// More measuring points than this are one series.
const MOST_POINTS: usize = 6;

/// Components of every residual by posture, and their RMS by measuring point, against the cell's noise.
pub fn residual_figure(identification: &Identification) -> Figure {
    let postures = in_order(identification.postures.iter().map(|p| p.posture.as_str()));
    let points: Vec<&str> = identification.points.iter().map(|p| p.point.as_str()).collect();
    let several = points.len() <= MOST_POINTS;
    let labels = if several { points.len().max(1) } else { 1 };
    let mut shown = vec![(Vec::new(), Vec::new()); labels];
    for one in &identification.postures {
        let Some(at) = place(&postures, &one.posture) else { continue };
        for residual in &one.residuals {
            let Some(number) = place(&points, &residual.point) else { continue };
            let (x, y) = &mut shown[if several { number } else { 0 }];
            // Points of a posture stand side by side.
            let share = (number as f64 + 0.5) / points.len().max(1) as f64 - 0.5;
            for component in residual.residual_m {
                x.push(at as f64 + 0.7 * share);
                y.push(1e3 * component);
            }
        }
    }
    let named = |number: usize| {
        if several && !points.is_empty() { format!("point {}", points[number]) } else { "residual".to_string() }
    };
    let mut all: Vec<Series> =
        shown.into_iter().enumerate().map(|(number, (x, y))| Series::new(named(number), Style::Points, x, y)).collect();
    let last = postures.len() as f64 - 0.5;
    let band = 1e3 * BAND * identification.expected_std_m;
    if band > 0.0 {
        // Two lines under one name: one entry of the legend.
        let ends = || vec![-0.5, last];
        for line in [band, -band] {
            let label = "95 % of the noise";
            all.push(Series::new(label, Style::Dashed, ends(), vec![line; 2]));
        }
    }
    let rms = identification.points.iter().map(|p| 1e3 * p.residual_rms_m);
    let mut by_point = vec![Series::new("residual RMS", Style::Bars, places(points.len()), rms.collect())];
    if identification.expected_std_m > 0.0 {
        by_point.push(Series::new(
            "noise",
            Style::Dashed,
            vec![-0.5, points.len() as f64 - 0.5],
            vec![1e3 * identification.expected_std_m; 2],
        ));
    }
    let mut figure = Figure::one(
        "residuals",
        "Residuals against noise",
        "What the fit leaves of each displacement component, posture by posture, with the band that holds 95 of \
         100 where noise is all there is. A posture outside, or points of one posture that lie together away from \
         zero, show an error of that posture or of the model.",
        Panel::new("", Axis::categorical("posture", postures), Axis::linear("residual component", "mm"), all),
    );
    // One point has nothing to be compared with.
    if points.len() > 1 {
        figure.panels[0].title = "by posture".into();
        figure.panels.push(Panel::new(
            "by measuring point",
            Axis::categorical("measuring point", points),
            Axis::linear("residual RMS", "mm").from_zero(),
            by_point,
        ));
    }
    figure
}

/// RMS of the residual angles of each posture and load state with the flange fixed.
pub fn clamped_residual_figure(identification: &ClampedIdentification) -> Figure {
    let postures = in_order(identification.postures.iter().map(|p| p.posture.as_str()));
    let states = in_order(identification.postures.iter().map(|p| p.state.as_str()));
    let mdeg = |angle: f64| 1e3 * rad_to_deg(angle);
    let mut series: Vec<Series> = Vec::new();
    for state in states {
        let of_state = identification.postures.iter().filter(|p| p.state == state);
        let at = |posture: &str| Some(place(&postures, posture)? as f64);
        let (x, y) = of_state.filter_map(|p| Some((at(&p.posture)?, mdeg(p.residual_rms_rad)))).unzip();
        series.push(Series::new(state, Style::Points, x, y));
    }
    if let Some(expected) = identification.expected_std_rad {
        let ends = vec![-0.5, postures.len() as f64 - 0.5];
        let line = vec![mdeg(expected); 2];
        series.push(Series::new("noise as given", Style::Dashed, ends, line));
    }
    Figure::one(
        "residuals",
        "Residual angles, posture by posture",
        "RMS of what the fit leaves of the angles that the flange holds. A posture far above the others has an error \
         of its own.",
        Panel::new(
            "",
            Axis::categorical("posture", postures),
            Axis::linear("residual RMS", "mdeg").from_zero(),
            series,
        ),
    )
}
