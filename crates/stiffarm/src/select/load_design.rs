//! Load parameters that are chosen together with the postures: the rope's
//! anchor within a box and the loading point within a box on the tool.

use crate::cell::Cell;
use crate::error::{Code, Error, Result};
use crate::index::IndexFunction;
use crate::load::Load;
use crate::observation::Setup;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// What may be moved, and how far. The default moves nothing.
///
/// The magnitude needs no search: every error-like index falls as 1/G and every
/// condition number does not depend on G, so the largest that is allowed is
/// the best.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LoadDesign {
    /// Lower and upper corner of the box for the rope's anchor, base frame \[m\].
    pub anchor: Option<[Vector3<f64>; 2]>,
    /// Lower and upper corner of the box for the loading point, flange axes \[m\].
    pub loading_point: Option<[Vector3<f64>; 2]>,
    /// Largest magnitude allowed \[N\].
    pub magnitude: Option<f64>,
}

/// The load that was chosen.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DesignedLoad {
    /// The rope's anchor, base frame \[m\]; `null` without a rope.
    pub anchor_m: Option<[f64; 3]>,
    /// Loading point, flange axes \[m\].
    pub loading_point_m: [f64; 3],
    /// Force of rope or weight \[N\]; `null` for another load.
    pub magnitude_n: Option<f64>,
}

impl From<Setup> for DesignedLoad {
    fn from(setup: Setup) -> Self {
        let (anchor, magnitude) = match setup.load {
            Load::Rope { anchor, magnitude } => (Some(anchor.into()), Some(magnitude)),
            Load::Weight { magnitude, .. } => (None, Some(magnitude)),
            Load::Constant { .. } | Load::Measured => (None, None),
        };
        DesignedLoad {
            anchor_m: anchor,
            loading_point_m: setup.tool.loading_point.into(),
            magnitude_n: magnitude,
        }
    }
}

impl LoadDesign {
    /// True when nothing may move.
    pub fn is_empty(&self) -> bool {
        *self == LoadDesign::default()
    }

    /// Checks the design against the cell and sets the magnitude.
    ///
    /// # Errors
    /// An anchor where there is no rope; a magnitude where the load has none, a
    /// reversed box, or a number that is not finite.
    pub fn prepare(&self, cell: &Cell) -> Result<Cell> {
        let mut cell = cell.clone();
        for (what, corners) in [
            ("anchor", &self.anchor),
            ("loading point", &self.loading_point),
        ] {
            let Some([low, high]) = corners else { continue };
            let sound =
                (0..3).all(|i| low[i].is_finite() && high[i].is_finite() && low[i] <= high[i]);
            if !sound {
                return Err(Error::new(
                    Code::InvalidValue,
                    format!("The box for the {what} is reversed or not finite."),
                )
                .hint("give the lowest corner first: x, y, z, then the highest: x, y, z"));
            }
        }
        if self.anchor.is_some() && !matches!(cell.setup.load, Load::Rope { .. }) {
            return Err(Error::new(
                Code::InvalidValue,
                "Only a rope has an anchor that could be moved.",
            )
            .hint("set load.kind to \"rope\", or leave the anchor out"));
        }
        if let Some(wanted) = self.magnitude {
            if !(wanted.is_finite() && wanted > 0.0) {
                return Err(Error::new(
                    Code::InvalidValue,
                    "The largest load must be above zero.",
                ));
            }
            match &mut cell.setup.load {
                Load::Rope { magnitude, .. } | Load::Weight { magnitude, .. } => {
                    *magnitude = wanted
                }
                Load::Constant { .. } | Load::Measured => {
                    return Err(Error::new(
                        Code::InvalidValue,
                        "Only a rope or a weight has a magnitude that could be chosen.",
                    ));
                }
            }
        }
        let start = self.start(&cell);
        Ok(self.applied(&cell, &start))
    }

    /// Bounds of the variables: anchor, then loading point \[m\].
    pub(super) fn bounds(&self) -> Vec<[f64; 2]> {
        [&self.anchor, &self.loading_point]
            .into_iter()
            .flatten()
            .flat_map(|[low, high]| (0..3).map(|i| [low[i], high[i]]))
            .collect()
    }

    /// The variables as the cell has them, moved into their boxes.
    pub(super) fn start(&self, cell: &Cell) -> Vec<f64> {
        let anchor = match &cell.setup.load {
            Load::Rope { anchor, .. } => *anchor,
            _ => Vector3::zeros(),
        };
        let inside = |p: Vector3<f64>, [low, high]: &[Vector3<f64>; 2]| {
            (0..3)
                .map(|i| p[i].clamp(low[i], high[i]))
                .collect::<Vec<f64>>()
        };
        let mut out = Vec::new();
        if let Some(corners) = &self.anchor {
            out.extend(inside(anchor, corners));
        }
        if let Some(corners) = &self.loading_point {
            out.extend(inside(cell.setup.tool.loading_point, corners));
        }
        out
    }

    /// The cell with the load as the variables say.
    pub(super) fn applied(&self, cell: &Cell, variables: &[f64]) -> Cell {
        let mut cell = cell.clone();
        let (to_anchor, to_point) = self.split(variables);
        if let (Some(to), Load::Rope { anchor, .. }) = (to_anchor, &mut cell.setup.load) {
            *anchor = to.into();
        }
        if let Some(to) = to_point {
            cell.setup.tool.loading_point = to.into();
        }
        cell
    }

    /// Moves the load of `function`.
    pub(super) fn apply(&self, variables: &[f64], function: &mut IndexFunction) {
        let (anchor, point) = self.split(variables);
        if let Some(anchor) = anchor {
            function.kernel_mut().set_anchor(anchor);
        }
        if let Some(point) = point {
            function.kernel_mut().set_loading_point(point);
        }
    }

    /// Gradient of the last evaluation by the variables.
    pub(super) fn gradient(&self, function: &IndexFunction, out: &mut [f64]) {
        if out.is_empty() {
            return;
        }
        let (by_anchor, by_point) = function.kernel().load_gradient();
        let mut parts = out.chunks_exact_mut(3);
        if self.anchor.is_some()
            && let Some(part) = parts.next()
        {
            part.copy_from_slice(&by_anchor);
        }
        if self.loading_point.is_some()
            && let Some(part) = parts.next()
        {
            part.copy_from_slice(&by_point);
        }
    }

    fn split(&self, variables: &[f64]) -> (Option<[f64; 3]>, Option<[f64; 3]>) {
        let mut parts = variables.chunks_exact(3).map(|c| [c[0], c[1], c[2]]);
        let anchor = self.anchor.and_then(|_| parts.next());
        (anchor, self.loading_point.and_then(|_| parts.next()))
    }
}
