//! The data at hand with their fit, and how each part of them agrees with the
//! rest.

use super::deletions::Deletions;
use super::{Outlier, OutlierKind, PointFit, PostureFit};
use crate::error::Result;
use crate::estimate::compliance::IdentifiedCompliance;
use crate::estimate::diagnose::tails::{LEVEL, f_tail};
use crate::estimate::elastic::carried;
use crate::estimate::identify::{
    Estimator, Fit, Fold, MeasuredSystem, RESIDUAL_ROUNDING, RowLabel, Whitened, missed, prediction_error, rms,
    rounding,
};
use crate::estimate::mixed::{MixedFit, ResidualMaker};
use nalgebra::{DMatrix, DVector};
use std::borrow::Cow;
use std::cell::OnceCell;

/// Level of each of the three families: displacements, postures, points.
const FAMILY: f64 = LEVEL / 3.0;
/// Share of a point's other displacements that must look odd before the point
/// as a whole is named.
const ODD_SHARE: f64 = 1.0 / 3.0;
/// A displacement looks odd below this probability.
const ODD_PROBABILITY: f64 = 0.05;

/// The data at hand with their fit.
pub(super) struct FittedData<'a> {
    fit: Fit,
    /// The mixed model, where it predicts.
    mixed: Option<Cow<'a, MixedFit>>,
    /// True where both variances were estimated.
    shifts: bool,
    postures: OnceCell<Vec<PostureFit>>,
    deletions: OnceCell<Deletions>,
}

impl<'a> FittedData<'a> {
    pub(super) fn new(fit: Fit, mixed: Option<Cow<'a, MixedFit>>) -> Self {
        let two = fit.options().estimator == Estimator::TwoVariance;
        FittedData {
            shifts: two && !fit.solution().independent_rows,
            fit,
            mixed,
            postures: OnceCell::new(),
            deletions: OnceCell::new(),
        }
    }

    pub(super) fn fit(&self) -> &Fit {
        &self.fit
    }

    /// The data without what `outlier` names; `None` where nothing is left.
    pub(super) fn without(&self, outlier: &Outlier) -> Result<Option<FittedData<'a>>> {
        let is = |name: &Option<String>, label_name: &str| name.as_deref().is_none_or(|n| n == label_name);
        let named = |label: &RowLabel| {
            let (m, point) = self.fit.experiment().behind(label);
            is(&outlier.posture, &m.posture.name)
                && is(&outlier.state, &m.state)
                && is(&outlier.point, &self.point_name(point))
        };
        let left = self.fit.filtered(|label| !named(label))?;
        left.map(|fit| self.of(fit)).transpose()
    }

    /// The rest of the data, in the same model if they carry it.
    fn of(&self, fit: Fit) -> Result<FittedData<'a>> {
        let mixed = match self.mixed {
            Some(_) => carried(&fit)?.ok().map(Cow::Owned),
            None => None,
        };
        Ok(FittedData::new(fit, mixed))
    }

    /// True where the residuals are more than rounding.
    fn has_residuals(&self) -> bool {
        let s = self.fit.solution().residual_std.unwrap_or(0.0);
        s > RESIDUAL_ROUNDING * rms(self.fit.system().delta.as_slice())
    }

    /// What fits worst, if anything does not fit.
    pub(super) fn worst(&self) -> Result<Option<Outlier>> {
        if !self.has_residuals() {
            return Ok(None);
        }
        let labels = &self.fit.system().labels;
        let deleted = &self.deletions()?.displacements;
        let count = deleted.iter().flatten().count() as f64;
        let worst = deleted
            .iter()
            .enumerate()
            .filter_map(|(i, d)| Some((i, d.as_ref()?)))
            .min_by(|a, b| a.1.p_value.total_cmp(&b.1.p_value))
            .filter(|(_, d)| d.p_value * count < FAMILY);
        if let Some((i, deletion)) = worst {
            let label = &labels[i];
            let (m, point) = self.fit.experiment().behind(label);
            let whole = match self.fit.filtered(|l| l != label)? {
                None => None,
                Some(rest) => self.whole(self.of(rest)?, &m.posture.name, point)?,
            };
            return Ok(Some(whole.unwrap_or_else(|| {
                let axis = deletion.deviation.abs().imax();
                Outlier {
                    state: Some(m.state.clone()),
                    point: Some(self.point_name(point)),
                    posture: Some(m.posture.name.clone()),
                    deviation_m: Some(deletion.deviation.into()),
                    standard_error_m: Some(deletion.error.into()),
                    axis: Some(["x", "y", "z"][axis].to_string()),
                    ..named(OutlierKind::Displacement, deletion.p_value * count)
                }
            })));
        }
        let postures = self.posture_fits()?;
        let points = self.point_fits()?;
        let least = |values: Vec<Option<f64>>| {
            let count = values.iter().flatten().count() as f64;
            let indexed = values.into_iter().enumerate();
            indexed
                .filter_map(|(i, p)| Some((i, p? * count)))
                .min_by(|a, b| a.1.total_cmp(&b.1))
                .filter(|(_, p)| *p < FAMILY)
        };
        let posture = least(postures.iter().map(|p| p.p_value).collect());
        let point = least(points.iter().map(|p| p.p_value).collect());
        Ok(match (posture, point) {
            (Some((i, p)), other) if other.is_none_or(|(_, q)| p <= q) => {
                Some(Outlier { posture: Some(postures[i].posture.clone()), ..named(OutlierKind::Posture, p) })
            }
            (_, Some((i, p))) => Some(Outlier { point: Some(points[i].point.clone()), ..named(OutlierKind::Point, p) }),
            _ => None,
        })
    }

    /// The posture or the point as a whole, where `rest`, the data without one
    /// displacement of them, still contradict it.
    fn whole(&self, rest: FittedData<'a>, posture: &str, point: usize) -> Result<Option<Outlier>> {
        if !rest.has_residuals() {
            return Ok(None);
        }
        let blocks = &rest.fit.system().blocks;
        let of_posture = match blocks.iter().position(|b| b.posture == posture) {
            Some(block) if rest.mixed.is_some() => rest.posture_fits()?[block].p_value,
            Some(block) if blocks.len() > 1 => {
                let fold = rest.fit.fold_without(vec![block])?;
                rest.posture_p(block, &fold, rounding(rest.fit.system()))?
            }
            _ => None,
        };
        let labels = &rest.fit.system().labels;
        let deletions = rest.deletions()?;
        let flags: Vec<bool> = labels
            .iter()
            .zip(&deletions.displacements)
            .filter(|(l, _)| rest.fit.experiment().behind(l).1 == point)
            .map(|(_, d)| d.as_ref().is_some_and(|d| d.p_value < ODD_PROBABILITY))
            .collect();
        let odd = flags.iter().filter(|odd| **odd).count();
        let of_point =
            if odd as f64 >= ODD_SHARE * flags.len() as f64 && odd > 1 { deletions.points[point] } else { None };
        let posture_p = of_posture.filter(|p| *p < FAMILY);
        let point_p = of_point.filter(|p| *p < FAMILY);
        Ok(match (posture_p, point_p) {
            (Some(p), q) if q.is_none_or(|q| p <= q) => {
                Some(Outlier { posture: Some(posture.to_string()), ..named(OutlierKind::Posture, p) })
            }
            (_, Some(p)) => Some(Outlier { point: Some(self.point_name(point)), ..named(OutlierKind::Point, p) }),
            _ => None,
        })
    }

    fn point_name(&self, point: usize) -> String {
        self.fit.cell().setup.tool.measuring_points[point].name.clone()
    }

    fn deletions(&self) -> Result<&Deletions> {
        if let Some(deletions) = self.deletions.get() {
            return Ok(deletions);
        }
        let deletions = match self.mixed.as_deref() {
            Some(mixed) => Deletions::of(&self.fit, &mixed.seen()?)?,
            None => Deletions::of(&self.fit, &ResidualMaker::of(&self.fit))?,
        };
        Ok(self.deletions.get_or_init(|| deletions))
    }

    pub(super) fn posture_fits(&self) -> Result<&[PostureFit]> {
        if let Some(fits) = self.postures.get() {
            return Ok(fits);
        }
        if let Some(mixed) = self.mixed.as_deref() {
            let fits = self.mixed_fits(mixed)?;
            return Ok(self.postures.get_or_init(|| fits));
        }
        let system = self.fit.system();
        let mut out = Vec::with_capacity(system.blocks.len());
        if system.blocks.len() < 2 {
            out.extend(system.blocks.iter().map(|b| PostureFit {
                posture: b.posture.clone(),
                prediction_rms_m: None,
                p_value: None,
            }));
        } else {
            let judged = self.has_residuals();
            let rounding = rounding(system);
            for (b, fold) in self.fit.folds()?.iter().enumerate() {
                self.fit.control().check()?;
                let error = prediction_error(system, b, &fold.solution, rounding);
                out.push(PostureFit {
                    posture: system.blocks[b].posture.clone(),
                    prediction_rms_m: error.map(|e| rms(e.as_slice())),
                    p_value: if judged { self.posture_p(b, fold, rounding)? } else { None },
                });
            }
        }
        Ok(self.postures.get_or_init(|| out))
    }

    /// Each posture against the mixed model of the others, its sizes found without it, whose prediction is as sure as
    /// its band says.
    fn mixed_fits(&self, mixed: &MixedFit) -> Result<Vec<PostureFit>> {
        let system = mixed.system();
        let whitened = self.fit.prepared().whitened();
        let judged = self.has_residuals();
        let folds = self.fit.folds()?;
        mixed.each_fold(folds, |fold, compliance| {
            let b = fold.left_out[0];
            let error = compliance.map(|compliance| missed(system, b, &compliance.values));
            let p_value = match (compliance, &error) {
                (Some(compliance), Some(error)) if judged => mixed_p((whitened, system), b, compliance, error)?,
                _ => None,
            };
            Ok(PostureFit {
                posture: system.blocks[b].posture.clone(),
                prediction_rms_m: error.map(|e| rms(e.as_slice())),
                p_value,
            })
        })
    }

    /// Probability of a deviation of block `b` from the fit without it.
    fn posture_p(&self, b: usize, fold: &Fold, rounding: f64) -> Result<Option<f64>> {
        let system = self.fit.system();
        let solution = &fold.solution;
        let (Some(error), Some(sigma)) =
            (prediction_error(system, b, solution, rounding), solution.residual_std.filter(|s| *s > 0.0))
        else {
            return Ok(None);
        };
        let (whitened, _) = self.fit.prepared().whitened().select(&[b], &system.delta)?;
        let whitened = &whitened;
        let psi = whitened.with_shifts(whitened.psi(), solution.gamma);
        let error = independent(whitened, &error, solution.gamma) / sigma;
        let covariance = solution.factor.inverse_information();
        let free = solution.degrees_of_freedom;
        // (I + ΨCΨᵀ)⁻¹ = I − ΨC(I + ΨᵀΨC)⁻¹Ψᵀ: as many equations as unknowns.
        let tail = |error: &DVector<f64>, psi: &DMatrix<f64>, count: usize, free: usize| {
            let seen = psi.tr_mul(error);
            let unknowns = psi.ncols();
            let whole = DMatrix::identity(unknowns, unknowns) + psi.tr_mul(psi) * &covariance;
            let explained = (&covariance * whole.lu().solve(&seen)?).dot(&seen);
            let size = (error.norm_squared() - explained).max(0.0);
            f_tail(size / count as f64, count, free)
        };
        let rows = whitened.rows();
        if !self.shifts || solution.independent_rows {
            return Ok(tail(&error, &psi, rows, free));
        }
        // What the posture's points share has a variance of its own.
        let (shared, _) = whitened.directions(0);
        let count = shared.ncols();
        let shared_free = solution.t_degrees_of_freedom.unwrap_or(free);
        let (of_error, of_psi) = (shared.tr_mul(&error), shared.tr_mul(&psi));
        let between = tail(&of_error, &of_psi, count, shared_free);
        let within = if rows > count {
            let rest = &error - shared * of_error;
            let psi = &psi - shared * of_psi;
            tail(&rest, &psi, rows - count, free)
        } else {
            None
        };
        Ok(match (between, within) {
            (Some(a), Some(b)) => Some((2.0 * a.min(b)).min(1.0)),
            (one, other) => one.or(other),
        })
    }

    pub(super) fn point_fits(&self) -> Result<Vec<PointFit>> {
        let p_values = if self.has_residuals() { &self.deletions()?.points[..] } else { &[] };
        let all = 0..self.fit.cell().setup.tool.point_count();
        Ok(all
            .map(|point| PointFit { point: self.point_name(point), p_value: p_values.get(point).copied().flatten() })
            .collect())
    }
}

fn named(kind: OutlierKind, p_value: f64) -> Outlier {
    Outlier {
        kind,
        posture: None,
        state: None,
        point: None,
        deviation_m: None,
        standard_error_m: None,
        axis: None,
        p_value: p_value.min(1.0),
    }
}

/// Probability of the error with which `compliance` predicts block `b`: its square in the covariance of the
/// prediction and of the readings, with the degrees of freedom of the combination that it is.
fn mixed_p(
    (whitened, system): (&Whitened, &MeasuredSystem),
    b: usize,
    compliance: &IdentifiedCompliance,
    error: &DVector<f64>,
) -> Result<Option<f64>> {
    let Some(spread) = compliance.spread.as_ref().filter(|spread| spread.sigma > 0.0) else {
        return Ok(None);
    };
    let gamma = (spread.shift / spread.sigma).powi(2);
    let (whitened, _) = whitened.select(&[b], &system.delta)?;
    let rows = &system.blocks[b].rows;
    let mut psi = system.psi.rows(rows.start, rows.len()).into_owned();
    whitened.whiten_block(0, &mut psi);
    let psi = whitened.with_shifts(&psi, gamma);
    let error = independent(&whitened, error, gamma);
    let with = &spread.covariance * psi.transpose();
    let mut covariance = &psi * &with;
    for i in 0..rows.len() {
        covariance[(i, i)] += spread.sigma.powi(2);
    }
    let Some(factor) = covariance.cholesky() else {
        return Ok(None);
    };
    let along = factor.solve(&error);
    let with = with * &along;
    let variance = along.dot(&(&psi * &with)).max(0.0);
    let noise = spread.sigma.powi(2) * along.norm_squared();
    let most = spread.degrees_of_freedom.map_or(f64::INFINITY, |n| n as f64);
    let free = match &spread.doubt {
        Some(doubt) => doubt.bounded(most, &with, variance, noise),
        None => most,
    };
    let count = rows.len();
    Ok(f_tail(error.dot(&along) / count as f64, count, free.max(1.0) as usize))
}

/// Displacements made independent, shifts of ratio `gamma` included.
fn independent(whitened: &Whitened, delta: &DVector<f64>, gamma: f64) -> DVector<f64> {
    whitened.delta_with_shifts(&whitened.whiten(delta), gamma)
}
