//! The best value for each number of postures, and what one more gains.

use super::bounds::{FEWEST_PREDICTING, unless_failed};
use super::kinds::{Mode, Planned, SelectResultOptions, Stage};
use super::options::{SelectInputs, SelectOptions};
use crate::error::{Code, Result};
use crate::findings::Finding;
use crate::model::cell::Cell;
use crate::numerics::control::Control;
use crate::plan::certificate::{CertificateOptions, certify};
use crate::plan::check::prepared;
use crate::plan::index::Index;
use crate::plan::select::{ErrorAtCount, GlobalOptions, error_at_count, error_by_count};
use serde::{Deserialize, Serialize};

/// The curve.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Curve {
    /// The index.
    pub index: Index,
    /// Largest number of postures that was asked for.
    pub largest: usize,
    /// One entry for each number of postures; an interruption leaves out the rest.
    pub sizes: Vec<CurveSize>,
    /// Why there are no bounds, where the index has them; else `null`.
    pub certificate_missing: Option<String>,
    /// What to distrust about the robot of the catalogue.
    pub findings: Vec<Finding>,
}

/// The best group of one size, beside what is possible.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(rename = "Size"))]
pub struct CurveSize {
    /// What the search found.
    #[serde(flatten)]
    pub point: ErrorAtCount,
    /// How much better the index becomes with one more posture (fraction);
    /// `null` for the last size and where there is no value.
    pub gain: Option<f64>,
    /// No group of this size has an index below this; `null` where the index has no bound, or none was wanted or found.
    /// The index prediction has one for the last size, from 12 postures on.
    pub bound: Option<f64>,
    /// `bound`/`value`.
    pub efficiency: Option<f64>,
}

/// Selects groups of every size up to the largest, and bounds them all; `watch` is told what the work is at, and a
/// stop of `control` ends it with the sizes done so far.
///
/// # Errors
/// As [`select`](crate::plan::select::select), except where too few postures are the reason.
pub fn plan_curve(
    cell: &Cell,
    options: &SelectOptions,
    watch: &mut dyn FnMut(Stage),
    control: Control<'_>,
) -> Result<Planned<Curve>> {
    let nothing = SelectInputs::default();
    let options = &SelectOptions { curve: true, ..options.clone() };
    options.check(&nothing)?;
    let (cell, findings) = prepared(cell, true);
    let (index, largest) = (options.index(), options.postures(&nothing));
    let global = options.global(&nothing);
    let mut points = error_by_count(&cell, index, 1..largest, &global, control)?;
    let mut group = None;
    if points.len() + 1 == largest && !control.stopped() {
        watch(Stage::LastSize { postures: largest });
        group = last_size(&cell, index, largest, &global, &mut points, control)?;
    }
    let mut missing = None;
    let mut bound_of_one = None;
    let says_something = index != Index::Prediction || largest >= FEWEST_PREDICTING;
    if let (Some(group), true) = (&group, !options.no_certificate && says_something) {
        watch(Stage::BoundingSizes);
        let bound = one_posture_bound(&cell, index, group, control);
        bound_of_one = unless_failed(bound, control, &mut missing);
    }
    let result = Curve {
        index,
        largest,
        sizes: sizes(index, largest, points, bound_of_one),
        certificate_missing: missing,
        findings,
    };
    Ok(Planned {
        result,
        options: SelectResultOptions::new(Mode::Curve, options, &cell),
        seed: Some(options.seed()),
        cell,
        postures: Vec::new(),
    })
}

/// The largest group on its own: its postures are wanted for the bound. Its point joins `points`.
fn last_size(
    cell: &Cell,
    index: Index,
    largest: usize,
    options: &GlobalOptions,
    points: &mut Vec<ErrorAtCount>,
    control: Control<'_>,
) -> Result<Option<Vec<Vec<f64>>>> {
    match error_at_count(cell, index, largest, options, control.quiet()) {
        Ok((point, selection)) => {
            points.push(point);
            Ok(selection.map(|selection| selection.group))
        }
        Err(error) if error.code() == Code::Interrupted && !points.is_empty() => Ok(None),
        Err(error) => Err(error),
    }
}

/// The bound of the index for one posture, from which that for n follows: the
/// bound is σ·sqrt(φ(M₀)/n) with the same M₀ for every n. That of the index prediction, which knows something before
/// the first posture, is that of the group alone.
fn one_posture_bound(cell: &Cell, index: Index, group: &[Vec<f64>], control: Control<'_>) -> Result<f64> {
    let options = CertificateOptions::default();
    let certificate = certify(cell, index, group, &options, control.quiet())?;
    Ok(certificate.bound * (group.len() as f64).sqrt())
}

/// The points with what one more gains and what is possible.
fn sizes(index: Index, largest: usize, points: Vec<ErrorAtCount>, bound_of_one: Option<f64>) -> Vec<CurveSize> {
    let next: Vec<Option<f64>> = points.iter().skip(1).map(|p| p.value).collect();
    let next = next.into_iter().chain([None]);
    points
        .into_iter()
        .zip(next)
        .map(|(point, next)| {
            let better = if index.larger_is_better() { -1.0 } else { 1.0 };
            let gain = point.value.zip(next).map(|(now, next)| better * (now - next) / now);
            let holds = index != Index::Prediction || point.postures == largest;
            let bound = bound_of_one.filter(|_| holds);
            let bound = bound.map(|bound| bound / (point.postures as f64).sqrt());
            CurveSize { gain, bound, efficiency: bound.zip(point.value).map(|(bound, value)| bound / value), point }
        })
        .collect()
}
