//! Postures as they are driven.

use crate::error::Result;
use crate::model::cell::Cell;
use crate::numerics::control::Control;
use crate::plan::route::{Route, RouteOptions, rounded, route};
use crate::plan::select::Accept;

/// The postures (controller angles, rad) with angles that one can type, each in the equivalent nearest to the
/// one before, in the shortest order unless `options` keep it; and the moves between them. `accept` is the caller's
/// own constraint.
pub(super) fn driven<Q: AsRef<[f64]>>(
    cell: &Cell,
    postures: &[Q],
    options: &RouteOptions,
    accept: Option<&Accept>,
) -> Result<(Vec<Vec<f64>>, Route)> {
    let group: Vec<Vec<f64>> = match options.step_deg {
        Some(step) => {
            let each = rounded(cell, postures, step)?.into_iter().zip(postures);
            // A posture at the edge of what is accepted stays as it was found.
            let accepted = |q: &[f64]| accept.is_none_or(|accept| accept.accepts(q));
            each.map(|(rounded, posture)| if accepted(&rounded) { rounded } else { posture.as_ref().to_vec() })
                .collect()
        }
        None => postures.iter().map(|q| q.as_ref().to_vec()).collect(),
    };
    let mut route = route(cell, &group, options, Control::default())?;
    // The plan is written in this order.
    route.order = (0..group.len()).collect();
    Ok((route.postures.clone(), route))
}
