//! Postures as they are driven.

use crate::error::Result;
use crate::model::cell::Cell;
use crate::numerics::control::Control;
use crate::plan::route::{Route, RouteOptions, rounded, route};
use crate::plan::select::Accept;

/// How postures are brought into the form in which they are driven.
pub(super) struct Driving<'a> {
    /// Steps that angles are rounded to \[deg\], where they are.
    pub step_deg: Option<f64>,
    /// Seed of the route.
    pub seed: u64,
    /// Keeps order and equivalents.
    pub keep: bool,
    /// Keeps the wrist as it is.
    pub keep_wrist: bool,
    /// The caller's own constraint.
    pub accept: Option<&'a Accept>,
}

impl Driving<'_> {
    /// The postures (controller angles, rad) with angles that one can type, each in the equivalent nearest to the
    /// one before, in the shortest order unless that is to be kept; and the moves between them.
    pub fn driven<Q: AsRef<[f64]>>(
        &self,
        cell: &Cell,
        postures: &[Q],
    ) -> Result<(Vec<Vec<f64>>, Route)> {
        let group: Vec<Vec<f64>> = match self.step_deg {
            Some(step) => {
                let each = rounded(cell, postures, step)?.into_iter().zip(postures);
                // A posture at the edge of what is accepted stays as it was found.
                let accepted = |q: &[f64]| self.accept.is_none_or(|own| own.accepts(q));
                each.map(|(rounded, found)| {
                    if accepted(&rounded) {
                        rounded
                    } else {
                        found.as_ref().to_vec()
                    }
                })
                .collect()
            }
            None => postures.iter().map(|q| q.as_ref().to_vec()).collect(),
        };
        let options = RouteOptions {
            keep_order: self.keep,
            keep_angles: self.keep || self.accept.is_some(),
            keep_wrist: self.keep_wrist,
            step_deg: self.step_deg,
            seed: self.seed,
        };
        let mut route = route(cell, &group, &options, Control::default())?;
        // The plan is written in this order.
        route.order = (0..group.len()).collect();
        Ok((route.postures.clone(), route))
    }
}
