//! Margins of the scene in the kernel: distances of shapes, beams and torques, posture by posture.
//!
//! They take their turns one after the other where the rest takes four postures at a time: which
//! shapes are near differs from posture to posture. Only those near enough to matter to the
//! augmented Lagrangian are told exactly, most by one comparison.

use super::batch::Batch;
use crate::error::Result;
use crate::model::cell::Cell;
use crate::model::load::Load;
use crate::model::observation::{PostureTerms, Setup};
use crate::model::scene::{Scene, Work};
use nalgebra::Vector3;

/// The scene with room for one posture.
#[derive(Debug, Clone)]
pub(super) struct SceneKernel {
    setup: Setup,
    scene: Scene,
    terms: PostureTerms,
    /// Room for each posture.
    work: Vec<Work>,
    q: Vec<f64>,
    gradient: Vec<f64>,
}

impl SceneKernel {
    /// `None` where the cell's scene is empty.
    pub fn new(cell: &Cell, postures: usize) -> Result<Option<Self>> {
        if cell.scene.is_empty() {
            return Ok(None);
        }
        let q: Vec<f64> = cell.bounds.iter().map(|b| 0.5 * (b[0] + b[1])).collect();
        Ok(Some(SceneKernel {
            setup: cell.setup.clone(),
            scene: cell.scene.clone(),
            terms: PostureTerms::new(&cell.setup, &q, None)?,
            work: vec![Work::remembering(&cell.scene, &cell.setup); postures],
            gradient: vec![0.0; q.len()],
            q,
        }))
    }

    /// Number of margins per posture.
    pub fn count(&self) -> usize {
        self.scene.count(&self.setup)
    }

    pub fn set_anchor(&mut self, to: [f64; 3]) {
        if let Load::Rope { anchor, .. } = &mut self.setup.load {
            *anchor = to.into();
        }
        self.work.iter_mut().for_each(Work::forget);
    }

    pub fn set_loading_point(&mut self, to: [f64; 3]) {
        self.setup.tool.loading_point = to.into();
        self.work.iter_mut().for_each(Work::forget);
    }

    /// The margins of one lane, which holds that posture, behind the `before` ones on points, their penalty and its
    /// derivatives.
    pub fn forward(&mut self, batch: &mut Batch, lane: usize, posture: usize, before: usize) {
        for (q, lanes) in self.q.iter_mut().zip(&batch.q) {
            *q = lanes.0[lane];
        }
        self.gradient.fill(0.0);
        let (mut anchor, mut loading) = (Vector3::zeros(), Vector3::zeros());
        if self.terms.update(&self.setup, &self.q).is_err() {
            // A rope without a direction; the index does not exist there either.
            batch.violation.0[lane] = f64::INFINITY;
        } else {
            let (weight, guard) = (batch.penalty_weight, batch.penalty_guard);
            let Batch { multipliers, margins, penalty, violation, .. } = batch;
            let (multipliers, margins) = (&multipliers[before..], &mut margins[before..]);
            let frames = self.terms.frames();
            let gradient = &mut self.gradient;
            self.scene.visit(
                &self.setup,
                &self.terms,
                &mut self.work[posture],
                |at| guard + multipliers[at].0[lane] / weight,
                |at, margin, slope| {
                    margins[at].0[lane] = margin;
                    violation.0[lane] = violation.0[lane].max(-margin);
                    let multiplier = multipliers[at].0[lane];
                    let active = (multiplier - (margin - guard) * weight).max(0.0);
                    penalty.0[lane] += (active * active - multiplier * multiplier) * (0.5 / weight);
                    if active > 0.0 {
                        slope.add_to(frames, -active, gradient);
                        let by_load = slope.by_load();
                        anchor -= by_load.0 * active;
                        loading -= by_load.1 * active;
                    }
                },
            );
        }
        for (lanes, g) in batch.scene_gradient.iter_mut().zip(&self.gradient) {
            lanes.0[lane] = *g;
        }
        for axis in 0..3 {
            batch.scene_anchor[axis].0[lane] = anchor[axis];
            batch.scene_loading[axis].0[lane] = loading[axis];
        }
    }
}
