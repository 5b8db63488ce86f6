//! Load parameters that are chosen together with the postures: the anchor of rope
//! or cylinder within a box and the loading point within a box on the tool.

use crate::error::{Code, Error, Result};
use crate::model::cell::Cell;
use crate::model::load::Load;
use crate::model::observation::Setup;
use crate::plan::index::IndexFunction;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// What may be moved, and how far. The default moves nothing.
///
/// The magnitude needs no search: every error-like index falls as 1/G and every
/// condition number does not depend on G, so the largest that is allowed is
/// the best.
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
pub struct LoadDesign {
    /// Lower and upper corner of the box for the anchor of rope or cylinder, base frame \[m\].
    pub anchor: Option<[Vector3<f64>; 2]>,
    /// Lower and upper corner of the box for the loading point, flange axes \[m\].
    pub loading_point: Option<[Vector3<f64>; 2]>,
    /// Largest size of the force allowed, above zero \[N\]: what pushes still pushes.
    pub magnitude: Option<f64>,
}

/// The load that was chosen.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DesignedLoad {
    /// Anchor of the rope or cylinder, base frame \[m\]; `null` without one.
    pub anchor_m: Option<[f64; 3]>,
    /// Loading point, flange axes \[m\].
    pub loading_point_m: [f64; 3],
    /// Size of the force of rope, cylinder or weight \[N\]; `null` for another load.
    pub magnitude_n: Option<f64>,
}

impl From<Setup> for DesignedLoad {
    fn from(setup: Setup) -> Self {
        DesignedLoad {
            anchor_m: match setup.load {
                Load::Rope { anchor, .. } => Some(anchor.into()),
                _ => None,
            },
            loading_point_m: setup.tool.loading_point.into(),
            magnitude_n: setup.load.size(),
        }
    }
}

impl DesignedLoad {
    /// The cell with this load.
    pub fn applied(&self, cell: &Cell) -> Cell {
        let mut cell = cell.clone();
        cell.setup.tool.loading_point = self.loading_point_m.into();
        let sized = self.magnitude_n.and_then(|size| cell.setup.load.with_size(size));
        cell.setup.load = sized.unwrap_or(cell.setup.load);
        if let (Load::Rope { anchor, .. }, Some(to)) = (&mut cell.setup.load, self.anchor_m) {
            *anchor = to.into();
        }
        cell
    }
}

impl IndexFunction {
    /// Moves the anchor of the cell's rope or cylinder \[m, base frame\].
    pub fn set_anchor(&mut self, to: [f64; 3]) {
        self.kernel_mut().set_anchor(to);
    }

    /// Moves the loading point \[m, flange axes\].
    pub fn set_loading_point(&mut self, to: [f64; 3]) {
        self.kernel_mut().set_loading_point(to);
    }

    /// Gradient of the last [`smoothed`](Self::smoothed) by the anchor (base frame) and by the
    /// loading point (flange axes) \[1/m\], where the cell has a single load.
    pub fn load_gradient(&self) -> ([f64; 3], [f64; 3]) {
        self.kernel().load_gradient()
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
    /// An anchor where there is neither rope nor cylinder; a magnitude where the load has none, a
    /// reversed box, or a number that is not finite.
    pub fn prepare(&self, cell: &Cell) -> Result<Cell> {
        let mut cell = cell.clone();
        if !self.is_empty() && cell.setup.load.has_cases() {
            let message = "A cell with several load cases has no single load that could be chosen.";
            return Err(Error::new(Code::Unsupported, message)
                .key("load.case")
                .hint("put one of the loads alone into [load] and choose that"));
        }
        for (what, corners) in [("anchor", &self.anchor), ("loading point", &self.loading_point)] {
            let Some([low, high]) = corners else { continue };
            let sound = (0..3).all(|i| low[i].is_finite() && high[i].is_finite() && low[i] <= high[i]);
            if !sound {
                return Err(Error::invalid(format!("The box for the {what} is reversed or not finite."))
                    .hint("give the lowest corner first: x, y, z, then the highest: x, y, z"));
            }
        }
        if self.anchor.is_some() && !matches!(cell.setup.load, Load::Rope { .. }) {
            return Err(Error::invalid("Only a rope or a cylinder has an anchor that could be moved.")
                .hint("set load.kind to \"rope\" or \"cylinder\" with anchor_mm, or leave the anchor out"));
        }
        if let Some(wanted) = self.magnitude {
            if !(wanted.is_finite() && wanted > 0.0) {
                return Err(Error::invalid("The largest load must be above zero."));
            }
            cell.setup.load = cell.setup.load.with_size(wanted).ok_or_else(|| {
                let message =
                    "Only a rope, a cylinder with an anchor or a weight has a magnitude that could be chosen.";
                Error::invalid(message)
            })?;
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
            (0..3).map(|i| p[i].clamp(low[i], high[i])).collect::<Vec<f64>>()
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
            function.set_anchor(anchor);
        }
        if let Some(point) = point {
            function.set_loading_point(point);
        }
    }

    /// Gradient of the last evaluation by the variables.
    pub(super) fn gradient(&self, function: &IndexFunction, out: &mut [f64]) {
        if out.is_empty() {
            return;
        }
        let (by_anchor, by_point) = function.load_gradient();
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
