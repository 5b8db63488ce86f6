//! The arm of an elastic simulation: joint axes as the prior says, and springs beyond
//! them that every run draws.

use crate::error::{Code, Error, Result};
use crate::estimate::compliance::Spread;
use crate::estimate::freedom::SpreadQuantiles;
use crate::estimate::mixed::Reproduced;
use crate::estimate::noise::normal;
use crate::model::cell::Cell;
use crate::model::elastic::{Effect, ElasticSizes, ElasticSizing, fitted, terms};
use crate::model::measurement::{Displacement, MeasuredPosture};
use crate::model::observation::PostureTerms;
use crate::model::posture::Posture;
use crate::numerics::control::Control;
use crate::numerics::information::stacked;
use crate::plan::index::prediction::work_of;
use nalgebra::{DMatrix, DVector, Vector3};
use rand_chacha::ChaCha8Rng;

/// What gives way, and how much.
pub(super) struct Truth {
    /// Prior stiffness of the axes \[N·m/rad\].
    pub(super) prior: Vec<f64>,
    /// What makes of all compliances those of joint axes that alone reproduce the arm.
    pub(super) reproduced: Reproduced,
    /// Its compliance.
    axes: DVector<f64>,
    /// Standard deviation of each entry of the springs.
    deviations: DVector<f64>,
}

impl Truth {
    /// # Errors
    /// No prior; as [`Reproduced::over_cell`].
    pub(super) fn new(cell: &Cell, sizes: &ElasticSizes) -> Result<Self> {
        let prior = cell.require_prior()?.to_vec();
        let effects = springs(cell);
        let deviation = effects.iter().map(|e| e.scale * sizes.of(e.class)).collect::<Vec<_>>();
        Ok(Truth {
            reproduced: Reproduced::over_cell(cell, &terms(&effects), Control::default())?,
            axes: DVector::from_iterator(prior.len(), prior.iter().map(|k| 1.0 / k)),
            deviations: DVector::from_iterator(effects.len(), deviation),
            prior,
        })
    }

    /// All compliances of one arm: those of the axes, then the entries of the springs.
    pub(super) fn draw(&self, rng: &mut ChaCha8Rng) -> DVector<f64> {
        let drawn = self.deviations.iter().map(|std| std * normal(rng));
        let all: Vec<f64> = self.axes.iter().copied().chain(drawn).collect();
        DVector::from_vec(all)
    }
}

/// What the mixed model may find, in its order.
fn springs(cell: &Cell) -> Vec<Effect> {
    fitted(&cell.setup.robot, &[], ElasticSizing::Alike, &cell.known_elements)
}

/// A group of postures on any such arm.
pub(super) struct Group {
    /// Postures without displacements.
    postures: Vec<Posture>,
    points: usize,
    /// From all compliances to the displacements.
    columns: DMatrix<f64>,
    /// What is known of the displacements beforehand \[m\].
    offset: DVector<f64>,
}

impl Group {
    /// # Errors
    /// As [`PostureTerms::new`].
    pub(super) fn new(cell: &Cell, postures: &[Posture]) -> Result<Self> {
        let points = cell.setup.tool.point_count();
        let rows = 3 * points;
        let springs = terms(&springs(cell));
        let mut blocks = Vec::with_capacity(postures.len());
        let mut offset = DVector::zeros(rows * postures.len());
        for (p, posture) in postures.iter().enumerate() {
            let terms = PostureTerms::new(&cell.setup, &posture.q, None)?;
            blocks.push(terms.block_with(&cell.setup.robot, &springs));
            offset.rows_mut(rows * p, rows).copy_from(&terms.known_displacement(&cell.setup.tool));
        }
        let named = postures.iter().enumerate().map(|(p, posture)| Posture {
            // Two postures of one name would count as one.
            name: (p + 1).to_string(),
            q: posture.q.clone(),
        });
        Ok(Group {
            postures: named.collect(),
            points,
            columns: stacked(&blocks, blocks.first().map_or(0, DMatrix::ncols)),
            offset,
        })
    }

    /// Number of postures and of points of each.
    pub(super) fn size(&self) -> (usize, usize) {
        (self.postures.len(), self.points)
    }

    /// What these compliances do to each point of each posture \[m\].
    pub(super) fn bent(&self, compliance: &DVector<f64>) -> Vec<Vector3<f64>> {
        let all = &self.columns * compliance;
        let each = (0..all.len() / 3).map(|i| all.fixed_rows::<3>(3 * i).into_owned());
        each.collect()
    }

    /// What is measured on an arm with these compliances, with this noise \[m\].
    pub(super) fn measured(&self, compliance: &DVector<f64>, noise: &DVector<f64>) -> Vec<MeasuredPosture> {
        let all = &self.columns * compliance + &self.offset + noise;
        let postures = self.postures.iter().enumerate();
        postures
            .map(|(p, posture)| {
                let displacements = (0..self.points).map(|a| {
                    let at = 3 * (self.points * p + a);
                    let value: Vector3<f64> = all.fixed_rows::<3>(at).into_owned();
                    Displacement::new(a, value)
                });
                MeasuredPosture::new(posture.clone(), displacements.collect())
            })
            .collect()
    }
}

/// Where deflections are predicted.
pub(super) struct Work {
    /// From all compliances to the deflections, 3 rows for each.
    columns: DMatrix<f64>,
}

/// How well one predictor did at the work.
pub(super) struct Predicted {
    /// Mean square of the error of a deflection \[m²\].
    pub(super) square: f64,
    /// Share of the components inside their bands; `None` without bands.
    pub(super) inside: Option<f64>,
}

impl Work {
    /// # Errors
    /// As [`work_of`].
    pub(super) fn new(cell: &Cell) -> Result<Self> {
        let (work, springs) = (work_of(cell)?.swap_remove(0), terms(&springs(cell)));
        let robot = &cell.setup.robot;
        let tip = |terms: &PostureTerms| {
            let columns = terms.block_with(robot, &springs);
            columns.rows(0, 3).into_owned()
        };
        let blocks: Vec<DMatrix<f64>> = work.iter().map(|(_, terms)| tip(terms)).collect();
        Ok(Work { columns: stacked(&blocks, blocks.first().map_or(0, DMatrix::ncols)) })
    }

    /// Number of deflections.
    pub(super) fn count(&self) -> usize {
        self.columns.nrows() / 3
    }

    /// Mean square of a deflection of an arm with these compliances \[m²\].
    pub(super) fn square(&self, compliance: &DVector<f64>) -> f64 {
        (&self.columns * compliance).norm_squared() / self.count() as f64
    }

    /// What these values, as sure as `scatter` says, make of the deflections of an arm with
    /// these compliances.
    ///
    /// # Errors
    /// A number that is not finite.
    pub(super) fn predicted(
        &self,
        values: &DVector<f64>,
        scatter: Option<&(&Spread, SpreadQuantiles)>,
        compliance: &DVector<f64>,
    ) -> Result<Predicted> {
        let columns = self.columns.columns(0, values.len());
        let errors = columns * values - &self.columns * compliance;
        let square = errors.norm_squared() / self.count() as f64;
        if !square.is_finite() {
            return Err(Error::new(Code::Numerical, "A predicted deflection is not a finite number."));
        }
        let inside = scatter.map(|(spread, quantiles)| {
            let with = &spread.covariance * columns.transpose();
            let held = (0..errors.len()).filter(|i| {
                let with = with.column(*i).into_owned();
                let variance = columns.row(*i).transpose().dot(&with).max(0.0);
                errors[*i].abs() <= quantiles.of(&with, variance, 0.0) * variance.sqrt()
            });
            held.count() as f64 / errors.len() as f64
        });
        Ok(Predicted { square, inside })
    }
}
