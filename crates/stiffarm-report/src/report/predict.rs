//! The page of `predict`: how far the loaded tool bends away, and how sure that is.

use super::context::Context;
use crate::page::{Block, DataTable, Part, Section, Text};
use crate::path::{PathCurvePoint, path_figure};
use stiffarm::Result;
use stiffarm::findings::visible;
use stiffarm::work::predict::Prediction;

/// The part of a page for a result of `predict`.
pub(super) fn part(context: &Context<'_>) -> Result<Part> {
    let prediction: Prediction = context.saved.result()?;
    let count = prediction.points.len();
    let number = |below: &str| context.number(below);
    let done = Text::new(format!(
        "The deflection of the loaded tool was predicted at {count} points, "
    ))
    .words("from the exact equilibrium of arm and load.");
    let mut came = Text::new("The tool bends away by ")
        .number(number("/deflection_rms_m").mm().decimals(3))
        .words(" (RMS), at most ")
        .number(number("/deflection_max_m").mm().decimals(3))
        .words(format!(
            ", at point {}",
            visible(&prediction.deflection_max_point)
        ));
    came = match prediction.error_rms_m {
        Some(_) => came
            .words("; the prediction is sure to ")
            .number(number("/error_rms_m").mm().decimals(3).plus_minus())
            .words(" (RMS)."),
        None => came.words("; the stiffness says nothing about how sure that is."),
    };
    let next = Text::new("Where that is too much, ")
        .code("stiffarm compensate")
        .words(" gives the path to command instead, and ")
        .code("stiffarm map --place")
        .words(" looks for a stiffer place for the workpiece.");
    let mut key = DataTable::new(
        "Deflection at the points where it is largest, with its total ±",
        [
            "point",
            "deflection [mm]",
            "± total [mm]",
            "x [mm]",
            "y [mm]",
            "z [mm]",
        ],
    );
    let mut order: Vec<usize> = (0..count).collect();
    let size = |i: &usize| prediction.points[*i].deflection_m;
    order.sort_by(|a, b| size(b).total_cmp(&size(a)));
    for i in order.into_iter().take(5) {
        let at = |below: &str| {
            number(&format!("/points/{i}{below}"))
                .mm()
                .bare()
                .decimals(3)
        };
        let band = at("/band/size_m/3");
        let cells = [
            at("/deflection_m").into(),
            band.into(),
            at("/shift_m/0").into(),
            at("/shift_m/1").into(),
            at("/shift_m/2").into(),
        ];
        key.row(visible(&prediction.points[i].point).into_owned(), cells);
    }
    let curve = curve(&prediction);
    let sections = vec![Section::new(
        "path",
        "Along the path",
        vec![Block::Figure(path_figure(&curve, prediction.confidence))],
    )];
    Ok(context.part(
        "Predicted deflection".to_string(),
        [done, came, next],
        Some(key),
        sections,
    ))
}

/// The deflection along the path of the unloaded tip.
fn curve(prediction: &Prediction) -> Vec<PathCurvePoint> {
    let mut along = 0.0;
    let mut last: Option<[f64; 3]> = None;
    let points = prediction.points.iter().map(|point| {
        along += last.map_or(0.0, |last| {
            let squares = (0..3).map(|i| (point.tip_m[i] - last[i]).powi(2));
            squares.sum::<f64>().sqrt()
        });
        last = Some(point.tip_m);
        PathCurvePoint {
            along_m: along,
            deflection_m: point.deflection_m,
            half_width_m: point.band.map(|band| band.size_m[3]),
            left_m: None,
        }
    });
    points.collect()
}
