//! Postures as they are driven.

use crate::error::{Code, Result};
use crate::model::cell::Cell;
use crate::numerics::control::Control;
use crate::plan::route::{Route, RouteOptions, rounded, route};
use crate::plan::select::Accept;

/// The postures (controller angles, rad) with angles that one can type, each in the equivalent nearest to the
/// one before, in the shortest order unless `options` keep it or `control` stops the search for it; and the moves
/// between them. `accept` is the caller's own constraint.
pub(super) fn driven<Q: AsRef<[f64]>>(
    cell: &Cell,
    postures: &[Q],
    options: &RouteOptions,
    accept: Option<&Accept>,
    control: Control<'_>,
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
    let mut route = match route(cell, &group, options, control.quiet()) {
        Err(error) if error.code() == Code::Interrupted => {
            let as_it_is = RouteOptions { keep_order: true, keep_angles: true, ..*options };
            route(cell, &group, &as_it_is, Control::default())?
        }
        route => route?,
    };
    // The plan is written in this order.
    route.order = (0..group.len()).collect();
    Ok((route.postures.clone(), route))
}
