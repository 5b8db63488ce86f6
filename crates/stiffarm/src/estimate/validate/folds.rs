//! Cross-validation: each posture predicted by a fit without it.

use super::{Model, Point, Validation, band, check_tolerance, summarise};
use crate::error::{Code, Error, Result};
use crate::estimate::compliance::IdentifiedCompliance;
use crate::estimate::identify::{Fit, prediction_error, rounding};
use nalgebra::Vector3;

/// Validates without postures kept out: the postures are left out fold by fold,
/// and each is predicted by the fit from the others. Posture i of the file
/// belongs to fold i modulo `count`; as many folds as postures leave out one at
/// a time. The model is linear, with the further terms of the options.
///
/// Postures of which the others do not determine an unknown are named in
/// [`Validation::unpredicted`].
///
/// # Errors
/// Fewer than two folds or more than postures; no
/// posture that the others predict.
pub fn cross_validate(fit: &Fit, count: usize, tolerance_m: Option<f64>) -> Result<Validation> {
    check_tolerance(tolerance_m)?;
    let (system, measured) = (fit.system(), fit.postures());
    let confidence = fit.options().confidence;
    let own;
    let folds = match count == system.blocks.len() {
        true => fit.folds()?,
        false => {
            own = fit.folds_of(count)?;
            &own
        }
    };
    let mut found: Vec<Option<Point>> = vec![None; system.labels.len()];
    let mut unpredicted = Vec::new();
    let rounding = rounding(system);
    for fold in folds {
        let predictor = IdentifiedCompliance::from_solution(system, &fold.solution, confidence);
        for &b in &fold.left_out {
            let block = &system.blocks[b];
            let Some(errors) = prediction_error(system, b, &fold.solution, rounding) else {
                unpredicted.push(b);
                continue;
            };
            for label in system.labels_of(block) {
                let displacement = &measured[label.measured].displacements[label.displacement];
                let at = label.rows.start - block.rows.start;
                let calculated: Vector3<f64> = displacement.value - errors.fixed_rows::<3>(at);
                let value = &displacement.value;
                let band = band::point_band(&predictor, system, block, label, value, &calculated)?;
                let place = system
                    .labels
                    .partition_point(|l| l.rows.start < label.rows.start);
                found[place] = Some(Point {
                    measured: label.measured,
                    displacement: label.displacement,
                    calculated,
                    band,
                });
            }
        }
    }
    unpredicted.sort_unstable();
    let unpredicted: Vec<String> = unpredicted
        .iter()
        .map(|b| system.blocks[*b].posture.clone())
        .collect();
    let mut points: Vec<Point> = found.into_iter().flatten().collect();
    if points.is_empty() {
        return Err(Error::new(
            Code::NotIdentifiable,
            "No posture can be predicted from the others: they do not determine every joint.",
        )
        .hint("measure more postures, or use more folds"));
    }
    points.sort_by_key(|p| (p.measured, p.displacement));
    let mut result = summarise(fit.cell(), measured, points, Model::Linear, tolerance_m);
    result.folds = Some(count);
    result.passed = result.passed.map(|passed| passed && unpredicted.is_empty());
    result.unpredicted = unpredicted;
    result.band = band::share(&result.points, confidence);
    result.findings = band::findings(&result);
    Ok(result)
}
