//! Errors of the model in a simulation: what the force reading, the pendant and
//! the drawing of the tool get wrong perturbs Ψ itself, not only Δ.

use crate::error::Result;
use crate::model::cell::Cell;
use crate::model::load::Load;
use crate::model::observation::{PostureTerms, Setup};
use crate::model::posture::Posture;
use nalgebra::{DVector, Vector3};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use serde::{Deserialize, Serialize};

/// Standard deviations of model errors, all zero in the paper. The true arm has
/// them; the identification uses the nominal model.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ModelErrors {
    /// Scale of the force reading, one error for the whole experiment (fraction).
    pub force_scale: f64,
    /// Force reading, a fresh error for each posture and load (fraction).
    pub force_per_posture: f64,
    /// Each joint angle of each posture \[rad\].
    pub joint_angle_rad: f64,
    /// Each coordinate of the loading point, one error for the experiment \[m\].
    pub loading_point_m: f64,
    /// Each coordinate of the anchor of rope or cylinder, one error for the experiment \[m\].
    pub anchor_m: f64,
}

impl ModelErrors {
    /// True when the model is exact, as in the paper.
    pub fn is_exact(&self) -> bool {
        *self == ModelErrors::default()
    }

    /// Error of the displacements when the true arm differs from the nominal
    /// one by one draw of these errors, rows as in Ψ \[m\].
    ///
    /// # Errors
    /// As [`PostureTerms::new`].
    pub(crate) fn draw(
        &self,
        cell: &Cell,
        postures: &[Posture],
        compliance: &DVector<f64>,
        rng: &mut ChaCha8Rng,
    ) -> Result<DVector<f64>> {
        let mut normal = |std: f64| -> f64 {
            let z: f64 = StandardNormal.sample(rng);
            std * z
        };
        let force_scale = 1.0 + normal(self.force_scale);
        let loading_shift = Vector3::from_fn(|_, _| normal(self.loading_point_m));
        let anchor_shift = Vector3::from_fn(|_, _| normal(self.anchor_m));
        let stated = cell.setup.cases();
        let mut truths: Vec<Setup> = stated.clone();
        for (number, truth) in truths.iter_mut().enumerate() {
            // Loads at points and anchors of their own have errors of their own.
            let (at_point, at_anchor) = match number {
                0 => (loading_shift, anchor_shift),
                _ => (
                    Vector3::from_fn(|_, _| normal(self.loading_point_m)),
                    Vector3::from_fn(|_, _| normal(self.anchor_m)),
                ),
            };
            truth.tool.loading_point += at_point;
            if let Load::Rope { anchor, .. } = &mut truth.load {
                *anchor += at_anchor;
            }
        }
        let rows = 3 * cell.setup.tool.point_count();
        let mut out = DVector::zeros(rows * postures.len() * stated.len());
        let mut at = 0;
        for posture in postures {
            let q: Vec<f64> = posture.q.iter().map(|a| a + normal(self.joint_angle_rad)).collect();
            for (stated, truth) in stated.iter().zip(&truths) {
                let factor = force_scale * (1.0 + normal(self.force_per_posture));
                let nominal = PostureTerms::new(stated, &posture.q, None)?;
                let pull = PostureTerms::new(truth, &q, None)?;
                // The true force is the read one times `factor`.
                let wrench = pull.wrench().map(|v| v * factor);
                let actual = PostureTerms::new(truth, &q, Some(&wrench))?;
                let offset = actual.known_displacement(&truth.tool) - nominal.known_displacement(&stated.tool);
                let difference = (actual.block(&truth.robot) - nominal.block(&stated.robot)) * compliance + offset;
                out.rows_mut(at, rows).copy_from(&difference);
                at += rows;
            }
        }
        Ok(out)
    }
}
