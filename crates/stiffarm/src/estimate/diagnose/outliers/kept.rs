//! The data at hand with their fit, and how each part of them agrees with the
//! rest.

use super::{Outlier, OutlierKind, PointFit, PostureFit};
use crate::error::Result;
use crate::estimate::diagnose::tails::{LEVEL, f_tail};
use crate::estimate::identify::{
    Assumptions, Estimator, Fit, Fold, IdentifyOptions, MeasuredSystem, Prepared, Whitened, fit,
    folds, measured_system, prediction_error, rms,
};
use crate::model::cell::Cell;
use crate::model::measurement::MeasuredPosture;
use crate::numerics::information::Factor;
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

/// Level of each of the three families: displacements, postures, points.
const FAMILY: f64 = LEVEL / 3.0;
/// Share of a point's other displacements that must look odd before the point
/// as a whole is named.
const SHARE: f64 = 1.0 / 3.0;
/// A displacement looks odd below this probability.
const ODD: f64 = 0.05;
/// Residuals below this share of the displacements are rounding.
const ROUNDING: f64 = 1e-11;
/// A displacement with less than this share of its information left over is
/// fitted exactly and cannot be judged.
const EXACT: f64 = 1e-9;

/// One displacement against all others.
struct Deleted {
    deviation: Vector3<f64>,
    error: Vector3<f64>,
    p_value: f64,
}

/// The data at hand with their fit.
pub(super) struct Kept<'a> {
    cell: &'a Cell,
    measured: Vec<MeasuredPosture>,
    options: &'a IdentifyOptions,
    fit: Fit,
    /// True where both variances were estimated.
    shifts: bool,
}

impl<'a> Kept<'a> {
    pub(super) fn new(
        cell: &'a Cell,
        measured: &[MeasuredPosture],
        options: &'a IdentifyOptions,
    ) -> Result<Self> {
        let fit = fit(cell, measured, options)?;
        let shifts = options.estimator == Estimator::TwoVariance && !fit.solution.independent_rows;
        Ok(Kept {
            cell,
            measured: measured.to_vec(),
            options,
            fit,
            shifts,
        })
    }

    /// True where the residuals are more than rounding.
    fn has_residuals(&self) -> bool {
        let s = self.fit.solution.residual_std.unwrap_or(0.0);
        s > ROUNDING * rms(self.fit.system.delta.as_slice())
    }

    /// What fits worst, if anything does not fit.
    pub(super) fn worst(&self) -> Result<Option<Outlier>> {
        if !self.has_residuals() {
            return Ok(None);
        }
        let labels = &self.fit.system.labels;
        let deleted = self.deleted()?;
        let count = deleted.iter().flatten().count() as f64;
        let worst = deleted
            .iter()
            .enumerate()
            .filter_map(|(i, d)| Some((i, d.as_ref()?)))
            .min_by(|a, b| a.1.p_value.total_cmp(&b.1.p_value))
            .filter(|(_, d)| d.p_value * count < FAMILY);
        if let Some((i, found)) = worst {
            let label = &labels[i];
            let m = &self.measured[label.measured];
            let point = m.displacements[label.displacement].point;
            let mut rest = self.measured.clone();
            rest[label.measured]
                .displacements
                .remove(label.displacement);
            let whole = match rest.iter().all(|m| m.displacements.is_empty()) {
                true => None,
                false => self.whole(&rest, &m.posture.name, point)?,
            };
            return Ok(Some(whole.unwrap_or_else(|| {
                let axis = found.deviation.abs().imax();
                Outlier {
                    state: Some(m.state.clone()),
                    point: Some(self.point_name(point)),
                    posture: Some(m.posture.name.clone()),
                    deviation_m: Some(found.deviation.into()),
                    standard_error_m: Some(found.error.into()),
                    axis: Some(["x", "y", "z"][axis].to_string()),
                    ..named(OutlierKind::Displacement, found.p_value * count)
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
            (Some((i, p)), other) if other.is_none_or(|(_, q)| p <= q) => Some(Outlier {
                posture: Some(postures[i].posture.clone()),
                ..named(OutlierKind::Posture, p)
            }),
            (_, Some((i, p))) => Some(Outlier {
                point: Some(points[i].point.clone()),
                ..named(OutlierKind::Point, p)
            }),
            _ => None,
        })
    }

    /// The posture or the point as a whole, where `rest`, the data without one
    /// displacement of them, still contradict it.
    fn whole(
        &self,
        rest: &[MeasuredPosture],
        posture: &str,
        point: usize,
    ) -> Result<Option<Outlier>> {
        let view = Kept::new(self.cell, rest, self.options)?;
        if !view.has_residuals() {
            return Ok(None);
        }
        let blocks = &view.fit.system.blocks;
        let of_posture = match blocks.iter().position(|b| b.posture == posture) {
            Some(block) if blocks.len() > 1 => {
                let without = view.fit.system.without(&[block])?;
                let fold = Fold {
                    left_out: vec![block],
                    solution: Prepared::new(&without, view.fit.assumed.estimator)?
                        .solve(&without.delta, &view.fit.assumed)?,
                };
                view.posture_p(block, &fold)?
            }
            _ => None,
        };
        let labels = &view.fit.system.labels;
        let deleted = view.deleted()?;
        let own: Vec<bool> = labels
            .iter()
            .zip(&deleted)
            .filter(|(l, _)| rest[l.measured].displacements[l.displacement].point == point)
            .map(|(_, d)| d.as_ref().is_some_and(|d| d.p_value < ODD))
            .collect();
        let odd = own.iter().filter(|odd| **odd).count();
        let of_point = match odd as f64 >= SHARE * own.len() as f64 && odd > 1 {
            true => view.point_p(point)?,
            false => None,
        };
        let posture_p = of_posture.filter(|p| *p < FAMILY);
        let point_p = of_point.filter(|p| *p < FAMILY);
        Ok(match (posture_p, point_p) {
            (Some(p), q) if q.is_none_or(|q| p <= q) => Some(Outlier {
                posture: Some(posture.to_string()),
                ..named(OutlierKind::Posture, p)
            }),
            (_, Some(p)) => Some(Outlier {
                point: Some(self.point_name(point)),
                ..named(OutlierKind::Point, p)
            }),
            _ => None,
        })
    }

    fn point_name(&self, point: usize) -> String {
        self.cell.setup.tool.measuring_points[point].name.clone()
    }

    /// Every displacement against its prediction from all other data; `None`
    /// for one that the fit meets exactly whatever it is.
    fn deleted(&self) -> Result<Vec<Option<Deleted>>> {
        let (system, solution) = (&self.fit.system, &self.fit.solution);
        let free = solution.degrees_of_freedom;
        let rows = system.delta.len();
        if free <= 3 {
            return Ok((0..rows / 3).map(|_| None).collect());
        }
        let whitened = self.fit.prepared.whitened();
        let gamma = solution.gamma;
        let both = independent(whitened, &system.delta, gamma);
        let basis = solution.factor.basis(rows);
        let residual = &both - &basis * basis.tr_mul(&both);
        let size = residual.norm_squared();
        let mut out = Vec::with_capacity(rows / 3);
        for (b, block) in system.blocks.iter().enumerate() {
            let (from, count) = (block.rows.start, block.rows.len());
            // Rows of V^(−1/2) for this block: P = Wᵀ(I − BBᵀ)W, q = P Δ.
            let w = root_inverse(whitened, b, from, count, rows, gamma);
            let seen = w.tr_mul(&basis.rows(from, count));
            let q = w.tr_mul(&residual.rows(from, count));
            let information = w.tr_mul(&w);
            for i in 0..count / 3 {
                let seen = seen.fixed_rows::<3>(3 * i);
                let full: Matrix3<f64> = information.fixed_view::<3, 3>(3 * i, 3 * i).into_owned();
                let own = full - seen * seen.transpose();
                let q: Vector3<f64> = q.fixed_rows::<3>(3 * i).into_owned();
                let judged = own.symmetric_eigenvalues().min() > EXACT * full.trace();
                out.push(own.try_inverse().filter(|_| judged).and_then(|inverse| {
                    let deviation = inverse * q;
                    let explained = q.dot(&deviation);
                    let left = (size - explained).max(f64::EPSILON * size);
                    let variance = left / (free - 3) as f64;
                    Some(Deleted {
                        deviation,
                        error: inverse.diagonal().map(|v| (v * variance).max(0.0).sqrt()),
                        p_value: f_tail(explained / 3.0 / variance, 3, free - 3)?,
                    })
                }));
            }
        }
        Ok(out)
    }

    pub(super) fn posture_fits(&self) -> Result<Vec<PostureFit>> {
        let system = &self.fit.system;
        let count = system.blocks.len();
        if count < 2 {
            let names = system.blocks.iter().map(|b| PostureFit {
                posture: b.posture.clone(),
                prediction_rms_m: None,
                p_value: None,
            });
            return Ok(names.collect());
        }
        let judged = self.has_residuals();
        let mut out = Vec::with_capacity(count);
        for (b, fold) in folds(system, &self.fit.assumed, count)?.iter().enumerate() {
            let error = prediction_error(system, b, &fold.solution);
            out.push(PostureFit {
                posture: system.blocks[b].posture.clone(),
                prediction_rms_m: error.map(|e| rms(e.as_slice())),
                p_value: if judged {
                    self.posture_p(b, fold)?
                } else {
                    None
                },
            });
        }
        Ok(out)
    }

    /// Probability of a deviation of block `b` from the fit without it.
    fn posture_p(&self, b: usize, fold: &Fold) -> Result<Option<f64>> {
        let system = &self.fit.system;
        let solution = &fold.solution;
        let (Some(error), Some(sigma)) = (
            prediction_error(system, b, solution),
            solution.residual_std.filter(|s| *s > 0.0),
        ) else {
            return Ok(None);
        };
        let own = system.with(&[b])?;
        let prepared = Prepared::new(&own, self.fit.assumed.estimator)?;
        let whitened = prepared.whitened();
        let psi = whitened.with_shifts(whitened.psi(), solution.gamma);
        let error = independent(whitened, &error, solution.gamma) / sigma;
        let covariance = solution.factor.inverse_information();
        let free = solution.degrees_of_freedom;
        let tail = |along: &DMatrix<f64>, free: usize| -> Option<f64> {
            let count = along.ncols();
            let (error, psi) = (along.tr_mul(&error), along.tr_mul(&psi));
            let spread = DMatrix::identity(count, count) + &psi * &covariance * psi.transpose();
            let size = error.dot(&spread.cholesky()?.solve(&error));
            f_tail(size / count as f64, count, free)
        };
        let rows = own.delta.len();
        if !self.shifts || solution.independent_rows {
            return Ok(tail(&DMatrix::identity(rows, rows), free));
        }
        // What the posture's points share has a variance of its own.
        let (shared, _) = whitened.directions(0);
        let count = shared.ncols();
        let shared_free = solution.t_degrees_of_freedom.unwrap_or(free);
        let between = tail(shared, shared_free);
        let within = match rows > count {
            true => {
                let mut wide = shared.clone().resize_horizontally(count + rows, 0.0);
                wide.view_mut((0, count), (rows, rows)).fill_with_identity();
                let basis = wide.qr().q();
                tail(&basis.columns(count, rows - count).into_owned(), free)
            }
            false => None,
        };
        Ok(match (between, within) {
            (Some(a), Some(b)) => Some((2.0 * a.min(b)).min(1.0)),
            (one, other) => one.or(other),
        })
    }

    pub(super) fn point_fits(&self) -> Result<Vec<PointFit>> {
        let judged = self.has_residuals();
        (0..self.cell.setup.tool.point_count())
            .map(|point| {
                Ok(PointFit {
                    point: self.point_name(point),
                    p_value: if judged { self.point_p(point)? } else { None },
                })
            })
            .collect()
    }

    /// Probability of the residuals of `point` by the fit to the other points.
    fn point_p(&self, point: usize) -> Result<Option<f64>> {
        let mut others = self.measured.clone();
        for m in &mut others {
            m.displacements.retain(|d| d.point != point);
        }
        if others.iter().all(|m| m.displacements.is_empty()) {
            return Ok(None);
        }
        let system = measured_system(
            self.cell,
            &others,
            &self.fit.system.extra,
            self.options.weights,
        )?;
        let solution = &self.fit.solution;
        let all = size_and_rank(&self.fit.system, &self.fit.assumed, solution.gamma)?;
        let rest = size_and_rank(&system, &self.fit.assumed, solution.gamma)?;
        let own = self.fit.system.delta.len() - system.delta.len();
        let free = system.delta.len() - rest.1.min(system.delta.len());
        if own == 0 || rest.1 < all.1 || free == 0 {
            return Ok(None);
        }
        let left = rest.0.max(f64::EPSILON * all.0);
        let f = (all.0 - rest.0).max(0.0) / own as f64 / (left / free as f64);
        Ok(f_tail(f, own, free))
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

/// Displacements made independent, shifts of ratio `gamma` included.
fn independent(whitened: &Whitened, delta: &DVector<f64>, gamma: f64) -> DVector<f64> {
    let white = DMatrix::from_columns(&[whitened.whiten(delta)]);
    whitened.with_shifts(&white, gamma).column(0).into_owned()
}

/// What makes the rows of one block independent, as a matrix.
fn root_inverse(
    whitened: &Whitened,
    block: usize,
    from: usize,
    count: usize,
    rows: usize,
    gamma: f64,
) -> DMatrix<f64> {
    let mut out = DMatrix::zeros(count, count);
    let mut unit = DVector::zeros(rows);
    let (directions, sizes) = whitened.directions(block);
    for i in 0..count {
        unit[from + i] = 1.0;
        let column = whitened.whiten(&unit).rows(from, count).into_owned();
        unit[from + i] = 0.0;
        let shared = directions.tr_mul(&column);
        let shrunk = shared.zip_map(sizes, |part, size| {
            part * (1.0 - 1.0 / (1.0 + gamma * size).sqrt())
        });
        out.set_column(i, &(column - directions * shrunk));
    }
    out
}

/// Weighted sum of squared residuals at the ratio `gamma`, and the rank.
fn size_and_rank(
    system: &MeasuredSystem,
    assumed: &Assumptions,
    gamma: f64,
) -> Result<(f64, usize)> {
    let prepared = Prepared::new(system, assumed.estimator)?;
    let whitened = prepared.whitened();
    let psi = whitened.with_shifts(whitened.psi(), gamma);
    let delta = independent(whitened, &system.delta, gamma);
    let factor = Factor::new(&psi)?;
    let residual = &delta - psi * factor.solve(&delta);
    Ok((residual.norm_squared(), factor.rank()))
}
