//! Loads at work that the identification never applied.

use crate::error::Result;
use crate::estimate::mixed::{WorkRows, never_loaded};
use crate::estimate::saved::Saved;
use crate::findings::Finding;
use crate::model::cell::Cell;
use crate::model::load::Wrench;
use crate::model::path::LoadedPosture;
use crate::work::predict::{LoadedArm, TipBand};
use nalgebra::Vector3;

/// Points of a path that are looked at, evenly along it.
const POINTS: usize = 100;

/// Says where the error of the shifts (m) of `points` under their loads comes mostly from directions in which no
/// reading has loaded the arm.
///
/// # Errors
/// As [`never_loaded`].
pub(crate) fn never_loaded_at_work<'a>(
    (cell, arm): (&Cell, &LoadedArm),
    saved: &Saved,
    points: impl Iterator<Item = (&'a LoadedPosture, [f64; 3], Option<TipBand>)>,
) -> Result<Option<Finding>> {
    let Some(spread) = saved.predictor.spread.as_ref().filter(|spread| spread.doubt.is_some()) else {
        return Ok(None);
    };
    let loaded = points.filter(|(posture, ..)| posture.wrench != Wrench::force(Vector3::zeros()));
    let all: Vec<_> = loaded.filter_map(|(posture, shift, band)| Some((posture, shift, band?))).collect();
    let work = all.iter().step_by(all.len().div_ceil(POINTS).max(1));
    let work = work.map(|(posture, shift, band)| {
        let terms = arm.terms(&posture.q, &posture.wrench)?;
        let rows = arm.sensitivity(&terms);
        let variance = (&rows * &spread.covariance).dot(&rows);
        Ok(WorkRows {
            rows,
            terms,
            squares: Vector3::from(*shift).norm_squared(),
            other: (band.rms_m.powi(2) - variance).max(0.0),
        })
    });
    never_loaded(cell, saved, &work.collect::<Result<Vec<_>>>()?)
}
