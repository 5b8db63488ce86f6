//! Cross-validation: each posture predicted by a fit without it.

use super::{Model, Point, PointBands, Validation, band, check_tolerance, summarise};
use crate::error::{Code, Error, Result};
use crate::estimate::compliance::IdentifiedCompliance;
use crate::estimate::identify::{Fit, Fold, MeasuredSystem, missed, prediction_error, rounding};
use crate::estimate::mixed::MixedFit;
use crate::numerics::jobs::in_order;
use nalgebra::Vector3;
use std::borrow::Cow;

/// Validates without postures kept out: the postures are left out fold by fold,
/// and each is predicted by the fit from the others. Posture i of the file
/// belongs to fold i modulo `count`; as many folds as postures leave out one at
/// a time. The model is linear, with the extra terms of the options.
///
/// Postures of which the others do not determine an unknown are named in
/// [`Validation::unpredicted`]. Postures within 5° of each other in every joint are left out together, with fewer folds
/// where these are too few: one of them would show what the other does, which no new posture has.
///
/// # Errors
/// Fewer than two folds or more than postures; no
/// posture that the others predict.
pub fn cross_validate(fit: &Fit, count: usize, tolerance_m: Option<f64>) -> Result<Validation> {
    let confidence = fit.options().confidence;
    let system = fit.system();
    let folds = folds(fit, count)?;
    let rounding = rounding(system);
    let predicted = in_order(&folds, |(_, fold)| {
        let predictor = IdentifiedCompliance::from_solution(system, &fold.solution, confidence);
        let sees = |b| prediction_error(system, b, &fold.solution, rounding).is_some();
        predicted((fit, system), &fold.left_out, Some(&predictor), sees)
    })?;
    gathered(fit, system, predicted, tolerance_m)
}

/// [`cross_validate`] with the mixed model, whose sizes are found anew in each fold.
///
/// # Errors
/// As [`cross_validate`].
pub fn cross_validate_mixed(mixed: &MixedFit, count: usize, tolerance_m: Option<f64>) -> Result<Validation> {
    let (fit, system) = (mixed.fit(), mixed.system());
    let predicted = mixed.each_fold(&folds(fit, count)?, |fold, predictor| {
        predicted((fit, system), &fold.left_out, predictor, |_| true)
    })?;
    gathered(fit, system, predicted, tolerance_m)
}

/// The fits without each of `count` folds of postures.
///
/// # Errors
/// As [`cross_validate`].
fn folds(fit: &Fit, count: usize) -> Result<Cow<'_, [Fold]>> {
    match together(fit, count)? {
        Some(lists) => fit.folds_without(&lists).map(Cow::Owned),
        None => fit.folds_of(count),
    }
}

/// Postures nearer than this in every joint are one and the same to a validation \[rad\].
const SAME_POSTURE_ANGLE: f64 = 5.0 * std::f64::consts::PI / 180.0;

/// The postures of each of `count` folds (indices of blocks), where some of them are so near each other that they have
/// to be left out together.
///
/// # Errors
/// Postures that are all near each other, or a wrong number of folds.
fn together(fit: &Fit, count: usize) -> Result<Option<Vec<Vec<usize>>>> {
    let system = fit.system();
    let angles = |b: usize| {
        let label = system.labels_of(&system.blocks[b]).first();
        label.map(|label| fit.postures()[label.measured].posture.q.as_slice())
    };
    let is_near = |a: usize, b: usize| {
        let both = angles(a).zip(angles(b));
        both.is_some_and(|(a, b)| a.iter().zip(b).all(|(a, b)| (a - b).abs() < SAME_POSTURE_ANGLE))
    };
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for b in 0..system.blocks.len() {
        let group = groups.iter_mut().find(|group| group.iter().any(|a| is_near(*a, b)));
        match group {
            Some(group) => group.push(b),
            None => groups.push(vec![b]),
        }
    }
    if groups.len() == system.blocks.len() || !(2..=system.blocks.len()).contains(&count) {
        return Ok(None);
    }
    if groups.len() < 2 {
        return Err(Error::new(
            Code::NotIdentifiable,
            "No posture can be predicted from the others: all of them are within 5° of each other in every joint.",
        )
        .hint("validate on postures that differ"));
    }
    let count = count.min(groups.len());
    let mut out = vec![Vec::new(); count];
    for (g, group) in groups.into_iter().enumerate() {
        out[g % count].extend(group);
    }
    out.iter_mut().for_each(|fold| fold.sort_unstable());
    Ok(Some(out))
}

/// What a fold gives.
struct FoldPrediction {
    /// Points with the numbers of their labels.
    points: Vec<(usize, Point)>,
    /// Postures (indices of blocks) of which the others do not determine an unknown.
    unpredicted: Vec<usize>,
}

/// The postures `out` by `predictor`, where it `sees` all that they show.
fn predicted(
    (fit, system): (&Fit, &MeasuredSystem),
    out: &[usize],
    predictor: Option<&IdentifiedCompliance>,
    sees: impl Fn(usize) -> bool,
) -> Result<FoldPrediction> {
    let measured = fit.postures();
    let bands = predictor.map(|predictor| PointBands::new(predictor, system)).transpose()?;
    let mut fold = FoldPrediction { points: Vec::new(), unpredicted: Vec::new() };
    for &b in out {
        let block = &system.blocks[b];
        let Some(predictor) = predictor.filter(|_| sees(b)) else {
            fold.unpredicted.push(b);
            continue;
        };
        let errors = missed(system, b, &predictor.values);
        for label in system.labels_of(block) {
            let displacement = &measured[label.measured].displacements[label.displacement];
            let at = label.rows.start - block.rows.start;
            let calculated: Vector3<f64> = displacement.value - errors.fixed_rows::<3>(at);
            let value = &displacement.value;
            let band = bands.as_ref().and_then(|bands| bands.of(block, label, value, &calculated));
            let place = system.labels.partition_point(|l| l.rows.start < label.rows.start);
            let point = Point { measured: label.measured, displacement: label.displacement, calculated, band };
            fold.points.push((place, point));
        }
    }
    Ok(fold)
}

fn gathered(
    fit: &Fit,
    system: &MeasuredSystem,
    folds: Vec<FoldPrediction>,
    tolerance_m: Option<f64>,
) -> Result<Validation> {
    check_tolerance(tolerance_m)?;
    let (measured, count) = (fit.postures(), folds.len());
    let mut by_label: Vec<Option<Point>> = vec![None; system.labels.len()];
    let mut unpredicted = Vec::new();
    for fold in folds {
        unpredicted.extend(fold.unpredicted);
        for (place, point) in fold.points {
            by_label[place] = Some(point);
        }
    }
    unpredicted.sort_unstable();
    let unpredicted: Vec<String> = unpredicted.iter().map(|b| system.blocks[*b].posture.clone()).collect();
    let mut points: Vec<Point> = by_label.into_iter().flatten().collect();
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
