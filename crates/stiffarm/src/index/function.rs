//! Every index as a function of the postures with its closed-form gradient.
//!
//! A group index is `exp(smooth + max of components)`: a smooth part from the
//! information matrix and, for the minimax indices, components whose maximum
//! counts (k(J_N) per posture, one joint, one lost posture). Both parts are
//! logarithms, so that products become sums; O1 to O5 enter as reciprocals,
//! so that every index is minimised. The maximum is left to the optimiser,
//! which treats it as an epigraph and never differentiates a max().

use super::{Index, dexterity};
use crate::cell::Cell;
use crate::error::Result;
use crate::information::{GRAM_ROUNDING, point_sums, posture_information, symmetric_eigen};
use crate::observation::PostureTerms;
use nalgebra::{DMatrix, DVector};

/// ln of an index at one group, split into a smooth part and components.
#[derive(Debug, Clone, PartialEq)]
pub struct Minimax {
    /// Smooth part; infinite where the index does not exist.
    pub smooth: f64,
    /// The same without the smoothing of coalescing singular values
    /// ([`IndexFunction::set_sharpness`]); equal to `smooth` without smoothing.
    pub exact: f64,
    /// Its gradient with respect to all q, posture by posture \[1/rad\].
    pub smooth_gradient: Vec<f64>,
    /// Components; the index is `exp(smooth + max(components))`, and
    /// `exp(smooth)` without components.
    pub components: Vec<f64>,
    /// Gradients of the components, row by row \[1/rad\].
    pub component_gradients: Vec<f64>,
}

impl Minimax {
    /// ln of the index (of its reciprocal for O1 to O5).
    pub fn value(&self) -> f64 {
        let largest = self.components.iter().copied().reduce(f64::max);
        self.exact + largest.unwrap_or(0.0)
    }
}

/// An index of groups of a fixed number of postures, ready to be evaluated
/// many times at the flat vector of all controller angles \[rad\].
#[derive(Debug, Clone)]
pub struct IndexFunction<'a> {
    cell: &'a Cell,
    index: Index,
    length: f64,
    /// 1/k per spring, ones where the index has no prior.
    prior_compliance: Vec<f64>,
    common_weight: f64,
    sharpness: Option<f64>,
    terms: Vec<PostureTerms>,
    blocks: Vec<DMatrix<f64>>,
    theta_gradient: Vec<f64>,
}

impl<'a> IndexFunction<'a> {
    /// Prepares `index` for groups of `posture_count` postures.
    ///
    /// # Errors
    /// The cell lacks what the index needs: a prior stiffness, the
    /// characteristic length, or a load that is known without a measurement.
    pub fn new(cell: &'a Cell, index: Index, posture_count: usize) -> Result<Self> {
        let n = cell.setup.robot.joint_count();
        let length = if index.uses_dexterity() {
            dexterity::require_six_joints(&cell.setup.robot).map_err(|error| {
                error.hint("choose an index without dexterity: expected_error, scaled_condition, d")
            })?;
            cell.require_characteristic_length()?
        } else {
            1.0
        };
        let prior_compliance = if index.needs_prior() {
            cell.require_prior()?.iter().map(|k| 1.0 / k).collect()
        } else {
            vec![1.0; cell.setup.robot.spring_count()]
        };
        let weighted = matches!(
            index,
            Index::ExpectedError | Index::WorstJoint | Index::DropOne | Index::D
        );
        let common_weight = if weighted {
            cell.noise.common_weight(cell.setup.tool.point_count())
        } else {
            0.0
        };
        let middle: Vec<f64> = cell.bounds.iter().map(|b| 0.5 * (b[0] + b[1])).collect();
        let terms = vec![PostureTerms::new(&cell.setup, &middle, None)?; posture_count];
        Ok(IndexFunction {
            cell,
            index,
            length,
            prior_compliance,
            common_weight,
            sharpness: None,
            terms,
            blocks: Vec::with_capacity(posture_count),
            theta_gradient: vec![0.0; n],
        })
    }

    /// Smooths the largest and smallest singular value, whose gradients jump
    /// where singular values coalesce: λ_max → (Σ λᵖ)^(1/p) and λ_min →
    /// (Σ λ⁻ᵖ)^(−1/p) with p = `sharpness`, off by at most ln(n)/p in the
    /// logarithm. A gradient of the smoothed index is an element of the
    /// ε-subdifferential of the exact one. `None` differentiates one singular
    /// vector as if the singular value were simple.
    pub fn set_sharpness(&mut self, sharpness: Option<f64>) {
        self.sharpness = sharpness;
    }

    /// True when the index rests on the largest or smallest singular value.
    pub fn has_extreme_singular_values(&self) -> bool {
        matches!(
            self.index,
            Index::Condition
                | Index::Novel
                | Index::ScaledCondition
                | Index::Scaled
                | Index::O2
                | Index::O3
                | Index::O4
        )
    }

    /// The index.
    pub fn index(&self) -> Index {
        self.index
    }

    /// Number of components of the minimax part.
    pub fn component_count(&self) -> usize {
        match self.index {
            Index::Classical | Index::Novel | Index::Scaled | Index::DropOne => self.terms.len(),
            Index::WorstJoint => self.cell.setup.robot.spring_count(),
            _ => 0,
        }
    }

    /// Value and gradients at all controller angles `q`, posture by posture \[rad\].
    ///
    /// # Panics
    /// If `q` does not have postures × joints entries.
    pub fn evaluate(&mut self, q: &[f64]) -> Minimax {
        let n = self.cell.setup.robot.joint_count();
        assert_eq!(q.len(), n * self.terms.len(), "postures × joints angles");
        let components = self.component_count();
        let mut out = Minimax {
            smooth: 0.0,
            exact: 0.0,
            smooth_gradient: vec![0.0; q.len()],
            components: vec![0.0; components],
            component_gradients: vec![0.0; components * q.len()],
        };
        for (terms, q) in self.terms.iter_mut().zip(q.chunks_exact(n)) {
            // The load was checked when the function was made.
            if terms.update(&self.cell.setup, q).is_err() {
                out.smooth = f64::INFINITY;
                out.exact = f64::INFINITY;
                return out;
            }
        }
        if self.index.uses_dexterity() {
            self.add_dexterity(&mut out);
        }
        if self.index.uses_observation() {
            self.add_information(&mut out);
        }
        out
    }

    fn add_dexterity(&mut self, out: &mut Minimax) {
        let robot = &self.cell.setup.robot;
        let n = robot.joint_count();
        let width = out.smooth_gradient.len();
        for (i, terms) in self.terms.iter().enumerate() {
            self.theta_gradient.fill(0.0);
            // J_N at the TCP, measuring point 1 (Section IV.B).
            let tcp = terms.measuring_points[0];
            let (value, _) = dexterity::log_condition_gradient(
                &terms.frames,
                &tcp,
                self.length,
                &mut self.theta_gradient,
            );
            out.components[i] = value;
            let start = i * width + i * n;
            robot.gradient_to_controller(
                &self.theta_gradient,
                &mut out.component_gradients[start..start + n],
            );
        }
    }

    /// Relative information K⁻¹ Ψᵀ P Ψ K⁻¹ of each posture and their sum.
    fn add_information(&mut self, out: &mut Minimax) {
        let n = self.prior_compliance.len();
        self.blocks.clear();
        let mut total = DMatrix::zeros(n, n);
        let mut each = Vec::with_capacity(self.terms.len());
        for terms in &self.terms {
            let mut block = terms.block(&self.cell.setup.robot);
            for j in 0..n {
                block.column_mut(j).scale_mut(self.prior_compliance[j]);
            }
            let information = posture_information(&block, self.common_weight);
            total += &information;
            each.push(information);
            self.blocks.push(block);
        }
        let log_sigma = self
            .cell
            .noise
            .displacement_std()
            .max(f64::MIN_POSITIVE)
            .ln();
        let size = out.smooth_gradient.len();
        let infinite = |out: &mut Minimax| {
            out.smooth = f64::INFINITY;
            out.exact = f64::INFINITY;
        };
        match self.index {
            Index::WorstJoint => {
                let Some(inverse) = positive_inverse(&total) else {
                    return infinite(out);
                };
                out.smooth = log_sigma;
                out.exact = log_sigma;
                for j in 0..n {
                    // ½ ln [M⁻¹]_jj, derivative −½ w wᵀ/[M⁻¹]_jj with w = M⁻¹ e_j.
                    let w = inverse.column(j).into_owned();
                    out.components[j] = 0.5 * w[j].ln();
                    let adjoint = &w * w.transpose() * (-0.5 / w[j]);
                    let row = &mut out.component_gradients[j * size..(j + 1) * size];
                    add_gradient(self, &adjoint, None, row);
                }
            }
            Index::DropOne => {
                out.smooth = log_sigma;
                out.exact = log_sigma;
                for p in 0..each.len() {
                    let Some(inverse) = positive_inverse(&(&total - &each[p])) else {
                        return infinite(out);
                    };
                    let (value, adjoint) = rms_error(&inverse);
                    out.components[p] = value;
                    let row = &mut out.component_gradients[p * size..(p + 1) * size];
                    add_gradient(self, &adjoint, Some(p), row);
                }
            }
            _ => {
                let Some((smooth, exact, adjoint)) = self.spectral(&total) else {
                    return infinite(out);
                };
                let constant = match self.index {
                    Index::ExpectedError | Index::D => log_sigma,
                    // O1 has 1/√m with m postures.
                    Index::O1 => 0.5 * (each.len() as f64).ln(),
                    _ => 0.0,
                };
                out.smooth = smooth + constant;
                out.exact = exact + constant;
                let mut gradient = std::mem::take(&mut out.smooth_gradient);
                add_gradient(self, &adjoint, None, &mut gradient);
                out.smooth_gradient = gradient;
            }
        }
    }

    /// ln of a spectral index of the information M: smoothed, exact, and the
    /// derivative of the smoothed one with respect to M (symmetric).
    fn spectral(&self, information: &DMatrix<f64>) -> Option<(f64, f64, DMatrix<f64>)> {
        let (values, vectors) = symmetric_eigen(information.clone())?;
        let n = values.len();
        if values[0] <= n as f64 * GRAM_ROUNDING * values[n - 1] {
            return None;
        }
        let count = n as f64;
        // ln of the extreme eigenvalues with their derivatives.
        let most = Extreme::new(&values, 1.0, self.sharpness);
        let least = Extreme::new(&values, -1.0, self.sharpness);
        let combine = |a: f64, b: f64| {
            let smooth = a * most.smooth + b * least.smooth;
            let exact = a * most.exact + b * least.exact;
            (smooth, exact, &most.slope * a + &least.slope * b)
        };
        // Value, and derivative with respect to each eigenvalue λ = σ².
        let (smooth, exact, slope): (f64, f64, DVector<f64>) = match self.index {
            Index::Condition
            | Index::Novel
            | Index::ScaledCondition
            | Index::Scaled
            | Index::O2 => combine(0.5, -0.5),
            Index::O3 => combine(0.0, -0.5),
            Index::O4 => combine(0.5, -1.0),
            Index::ExpectedError => {
                let trace: f64 = values.iter().map(|v| 1.0 / v).sum();
                let value = 0.5 * (trace / count).ln();
                (value, value, values.map(|v| -0.5 / (v * v * trace)))
            }
            Index::D | Index::O1 => {
                let log_det: f64 = values.iter().map(|v| v.ln()).sum();
                let value = -0.5 * log_det / count;
                (value, value, values.map(|v| -0.5 / (count * v)))
            }
            Index::O5 => {
                let sum: f64 = values.iter().map(|v| v.powf(-0.5)).sum();
                (
                    sum.ln(),
                    sum.ln(),
                    values.map(|v| -0.5 * v.powf(-1.5) / sum),
                )
            }
            Index::Classical | Index::WorstJoint | Index::DropOne => return None,
        };
        let adjoint = &vectors * DMatrix::from_diagonal(&slope) * vectors.transpose();
        Some((smooth, exact, adjoint))
    }
}

/// ln of the largest (`sign` = 1) or smallest (−1) eigenvalue.
struct Extreme {
    smooth: f64,
    exact: f64,
    slope: DVector<f64>,
}

impl Extreme {
    fn new(values: &DVector<f64>, sign: f64, sharpness: Option<f64>) -> Self {
        let n = values.len();
        let at = if sign > 0.0 { n - 1 } else { 0 };
        let exact = values[at].ln();
        let Some(p) = sharpness else {
            let mut slope = DVector::zeros(n);
            slope[at] = 1.0 / values[at];
            return Extreme {
                smooth: exact,
                exact,
                slope,
            };
        };
        // sign/p · ln Σ exp(sign·p·(ln λ − ln λ_extreme)), no overflow.
        let weights = values.map(|v| (sign * p * (v.ln() - exact)).exp());
        let sum = weights.sum();
        let slope = DVector::from_fn(n, |i, _| weights[i] / (sum * values[i]));
        Extreme {
            smooth: exact + sign * sum.ln() / p,
            exact,
            slope,
        }
    }
}

/// Adds to `gradient` (all q) the derivative of a function of the summed
/// relative information whose derivative with respect to it is `adjoint`,
/// leaving out the posture `without`.
fn add_gradient(
    function: &mut IndexFunction<'_>,
    adjoint: &DMatrix<f64>,
    without: Option<usize>,
    gradient: &mut [f64],
) {
    let robot = &function.cell.setup.robot;
    let n = robot.joint_count();
    let mut theta_gradient = std::mem::take(&mut function.theta_gradient);
    let mut controller = vec![0.0; n];
    for (p, terms) in function.terms.iter().enumerate() {
        if Some(p) == without {
            continue;
        }
        let block = &function.blocks[p];
        // d⟨F, BᵀPB⟩ = 2⟨P B F, dB⟩, and the prior scales the columns of B.
        let mut r = block * adjoint * 2.0;
        if function.common_weight > 0.0 {
            let shift = point_sums(&r) * function.common_weight;
            for a in 0..r.nrows() / 3 {
                let mut rows = r.rows_mut(3 * a, 3);
                rows -= &shift;
            }
        }
        for (j, compliance) in function.prior_compliance.iter().enumerate() {
            r.column_mut(j).scale_mut(*compliance);
        }
        theta_gradient.fill(0.0);
        terms.add_block_gradient(&function.cell.setup, &r, &mut theta_gradient);
        robot.gradient_to_controller(&theta_gradient, &mut controller);
        for (g, c) in gradient[p * n..(p + 1) * n].iter_mut().zip(&controller) {
            *g += c;
        }
    }
    function.theta_gradient = theta_gradient;
}

/// Inverse of a positive definite matrix, `None` where it is not (numerically).
fn positive_inverse(matrix: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let (values, vectors) = symmetric_eigen(matrix.clone())?;
    let n = values.len();
    if values[0] <= n as f64 * GRAM_ROUNDING * values[n - 1] {
        return None;
    }
    Some(&vectors * DMatrix::from_diagonal(&values.map(|v| 1.0 / v)) * vectors.transpose())
}

/// ln of the RMS of sqrt([M⁻¹]_jj), with its derivative with respect to M.
fn rms_error(inverse: &DMatrix<f64>) -> (f64, DMatrix<f64>) {
    let trace = inverse.trace();
    let adjoint = inverse * inverse * (-0.5 / trace);
    (0.5 * (trace / inverse.nrows() as f64).ln(), adjoint)
}
