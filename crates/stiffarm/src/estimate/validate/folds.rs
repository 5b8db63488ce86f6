//! Cross-validation: each posture predicted by a fit without it.

use super::{Model, Point, PointBands, Validation, band, check_tolerance, summarise};
use crate::error::{Code, Error, Result};
use crate::estimate::compliance::IdentifiedCompliance;
use crate::estimate::identify::{Fit, MeasuredSystem, missed, prediction_error, rounding};
use crate::estimate::mixed::MixedFit;
use nalgebra::Vector3;

/// Validates without postures kept out: the postures are left out fold by fold,
/// and each is predicted by the fit from the others. Posture i of the file
/// belongs to fold i modulo `count`; as many folds as postures leave out one at
/// a time. The model is linear, with the extra terms of the options.
///
/// Postures of which the others do not determine an unknown are named in
/// [`Validation::unpredicted`].
///
/// # Errors
/// Fewer than two folds or more than postures; no
/// posture that the others predict.
pub fn cross_validate(fit: &Fit, count: usize, tolerance_m: Option<f64>) -> Result<Validation> {
    let confidence = fit.options().confidence;
    let system = fit.system();
    let folds = fit.folds_of(count)?;
    let rounding = rounding(system);
    let folds = folds.iter().map(|fold| Left {
        out: &fold.left_out,
        predictor: Some(IdentifiedCompliance::from_solution(
            system,
            &fold.solution,
            confidence,
        )),
        sees: Box::new(move |b| prediction_error(system, b, &fold.solution, rounding).is_some()),
    });
    gathered(fit, system, count, folds, tolerance_m)
}

/// [`cross_validate`] with the mixed model, whose sizes are found anew in each fold.
///
/// # Errors
/// As [`cross_validate`].
pub fn cross_validate_mixed(
    mixed: &MixedFit,
    count: usize,
    tolerance_m: Option<f64>,
) -> Result<Validation> {
    let system = mixed.system();
    let folds = mixed.folds_of(count)?;
    let folds = folds.iter().map(|fold| Left {
        out: &fold.left_out,
        predictor: fold.compliance.clone(),
        sees: Box::new(|_| true),
    });
    gathered(mixed.fit(), system, count, folds, tolerance_m)
}

/// A fold with what predicts it.
struct Left<'a> {
    /// The postures left out (indices of blocks).
    out: &'a [usize],
    predictor: Option<IdentifiedCompliance>,
    /// Whether the others determine all that a posture shows.
    sees: Box<dyn Fn(usize) -> bool + 'a>,
}

fn gathered<'a>(
    fit: &Fit,
    system: &MeasuredSystem,
    count: usize,
    folds: impl Iterator<Item = Left<'a>>,
    tolerance_m: Option<f64>,
) -> Result<Validation> {
    check_tolerance(tolerance_m)?;
    let measured = fit.postures();
    let mut found: Vec<Option<Point>> = vec![None; system.labels.len()];
    let mut unpredicted = Vec::new();
    for fold in folds {
        let bands = match &fold.predictor {
            Some(predictor) => Some(PointBands::new(predictor, system)?),
            None => None,
        };
        for &b in fold.out {
            let block = &system.blocks[b];
            let Some(predictor) = fold.predictor.as_ref().filter(|_| (fold.sees)(b)) else {
                unpredicted.push(b);
                continue;
            };
            let errors = missed(system, b, &predictor.values);
            for label in system.labels_of(block) {
                let displacement = &measured[label.measured].displacements[label.displacement];
                let at = label.rows.start - block.rows.start;
                let calculated: Vector3<f64> = displacement.value - errors.fixed_rows::<3>(at);
                let value = &displacement.value;
                let band = bands
                    .as_ref()
                    .and_then(|bands| bands.of(block, label, value, &calculated));
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
    result.band = band::share(&result.points, fit.options().confidence);
    result.findings = band::findings(&result);
    Ok(result)
}
