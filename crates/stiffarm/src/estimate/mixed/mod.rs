//! The mixed elastic model: the joint axes give way as ever, and every joint and the
//! base give way a little in all other directions, too.
//!
//! y = Ψ h + Σ_c B_c u_c + ε, with the axis compliances h as fixed effects and as random effects u_c ~ N(0, ω_c²) the
//! other entries of a symmetric 6 × 6 compliance at each joint and at the base (c being shifts, turns and their
//! coupling) and what an arm is made of: bearings that tilt in proportion to their joint, links that bend and twist as
//! even beams. Compliances that cannot be negative scatter about a common mean of the same size. The sizes ω_c come
//! from the data by restricted likelihood together with σ and τ, h and u from the mixed-model equations.
//!
//! That real arms give way beyond their axes is known (Pashkevich, Klimchik and Chablat,
//! Enhanced stiffness modeling of manipulators with passive joints, Mechanism and Machine
//! Theory 46, 2011, 662–679, doi:10.1016/j.mechmachtheory.2010.12.008); that the deviations
//! count as draws from a few distributions, the same for all joints, is a choice of ours.
//! So is their symmetry: no direction across an axis is preferred, and with the coupling
//! the place of the origin hardly matters.

mod directions;
mod doubt;
mod likelihood;
mod means;
mod model;
mod never_loaded;
mod reproduced;
mod residual_maker;
mod result;
mod search;
mod sized_model;
mod sums;
mod unlike;

/// What tests hold against dense matrices.
pub(crate) mod internals {
    pub use super::model::MixedModel;
}

pub(crate) use likelihood::Sizes;
pub(crate) use never_loaded::never_loaded;
pub(crate) use reproduced::Reproduced;
pub(crate) use residual_maker::ResidualMaker;
pub use result::{ElasticElement, ElasticSize, GeneralSpring, MixedResult};
pub(crate) use unlike::WorkRows;

use crate::error::{Code, Error, Result};
use crate::estimate::compliance::IdentifiedCompliance;
use crate::estimate::identify::{
    Estimator, Fit, Fold, IdentifyOptions, MeasuredSystem, NoiseSource, Response, rounding,
};
use crate::model::elastic::{Effect, ElasticClass, ElasticSizing, fitted, terms};
use crate::model::load::Load;
use crate::model::observation::{ExtraTerm, PostureTerms};
use crate::numerics::information::scale_columns;
use crate::numerics::jobs::in_order_watched;
use means::scattered;
use nalgebra::{DMatrix, DVector};
use sized_model::{Choice, SizedModel, fit_choice, likeliest, means, white};
use std::sync::{Arc, OnceLock};
use sums::{PriorRows, Rows};

/// The mixed model fitted to the displacements of a [`Fit`].
#[derive(Clone)]
pub struct MixedFit {
    fit: Fit,
    sizing: ElasticSizing,
    effects: Vec<Effect>,
    /// The columns of all effects in their own units.
    white: Rows,
    rows: Rows,
    /// Ψ of all unknowns, fixed effects first, in the effects' own units.
    system: MeasuredSystem,
    sizes: Sizes,
    /// −2 ln L_R with the sizes found, and without random effects.
    values: [f64; 2],
    compliance: IdentifiedCompliance,
    reproduced: OnceLock<Reproduced>,
    response: OnceLock<Arc<Response>>,
}

/// What some postures alone give.
pub(crate) struct SubsetFit {
    /// Compliance of the joint axes; `None` where the postures do not determine all.
    pub(crate) axes: Option<DVector<f64>>,
    /// The mixed model; `None` where the postures do not carry it.
    pub(crate) mixed: Option<IdentifiedCompliance>,
}

impl MixedFit {
    /// Why a fit with these options has no mixed model.
    pub(crate) fn excluded_by(options: &IdentifyOptions) -> Option<Error> {
        let conflict = |message: &str, hint: &str| Some(Error::new(Code::Conflict, message).hint(hint));
        if options.estimator != Estimator::TwoVariance || options.noise != NoiseSource::Estimated {
            return conflict(
                "The mixed model estimates the size of the noise and of what a posture's points share itself.",
                "use it with the estimator two-variance and noise from the residuals",
            );
        }
        if !options.extra.is_empty() {
            return conflict(
                "The mixed model holds every tilt already, and lost motion cannot be one of its terms.",
                "leave the extra terms out",
            );
        }
        None
    }

    /// Fits the mixed model to the displacements of `fit`, which must take the noise
    /// from the residuals.
    ///
    /// # Errors
    /// Another estimator than that of two variances, noise that is given, extra terms;
    /// a joint that the data do not determine though it carries load; no degree of freedom.
    pub fn new(fit: &Fit) -> Result<Self> {
        MixedFit::near(fit, None)
    }

    /// The same, its sizes looked for near `near`.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub(crate) fn near(fit: &Fit, near: Option<&Sizes>) -> Result<Self> {
        if let Some(conflict) = MixedFit::excluded_by(fit.options()) {
            return Err(conflict);
        }
        let solution = fit.solution();
        let idle = solution.undetermined.as_slice();
        if let Some(j) = idle.iter().find(|j| !is_idle(fit.system(), **j)) {
            return Err(Error::new(
                Code::NotIdentifiable,
                format!(
                    "The data do not determine {}, so nothing tells it from what gives way beyond the axes.",
                    fit.system().unknowns[*j]
                ),
            ));
        }
        let robot = &fit.cell().setup.robot;
        // Which terms they are does not depend on their sizes.
        let effects = fitted(robot, &[], ElasticSizing::Alike, &fit.cell().known_elements);
        let terms = terms(&effects);
        let columns = fit.columns(&terms);
        let system = extended(fit.system(), &terms, &columns);
        let white = white(fit, &effects, &columns);
        let (axes, gamma) = (&solution.values, solution.gamma);
        let (sizing, model) = likeliest(fit, &white, axes, gamma, &[], near)?;
        let compliance = model.compliance(fit).ok_or_else(|| too_few("the equations are singular"))?;
        let SizedModel { effects, likelihood, sizes, values } = model;
        Ok(MixedFit {
            reproduced: OnceLock::new(),
            response: OnceLock::new(),
            sizing,
            fit: fit.clone(),
            effects,
            white,
            rows: likelihood.rows().clone(),
            system,
            sizes,
            values,
            compliance,
        })
    }

    /// The fit of the joint axes alone that this one goes on from.
    pub fn fit(&self) -> &Fit {
        &self.fit
    }

    /// All unknowns with their covariance: the joint axes, then the entries of the
    /// general springs.
    pub fn compliance(&self) -> &IdentifiedCompliance {
        &self.compliance
    }

    /// Sizes of the random parts.
    pub(crate) fn sizes(&self) -> &Sizes {
        &self.sizes
    }

    /// Standard deviation ω of the entries of a class \[its unit\].
    pub fn size(&self, class: ElasticClass) -> f64 {
        let sigma = self.compliance.spread.as_ref().map_or(0.0, |s| s.sigma);
        self.sizes.std(class, sigma)
    }

    /// How much likelier the data are with the random effects: twice the difference of
    /// the logarithms of the restricted likelihoods.
    pub fn likelihood_ratio(&self) -> f64 {
        (self.values[1] - self.values[0]).max(0.0)
    }

    /// How the solution answers to a change of the displacements, the sizes held.
    ///
    /// # Errors
    /// A decomposition that fails.
    pub(crate) fn response(&self) -> Result<Arc<Response>> {
        if let Some(response) = self.response.get() {
            return Ok(response.clone());
        }
        let means = means(&self.effects);
        let mut random = self.rows.random_columns();
        // Rows of u that have variance σ²: diag(1/√λ) L⁻¹ diag(1/scale).
        let mut roots = DMatrix::zeros(random.ncols(), random.ncols());
        for (class, size) in self.rows.classes.iter().zip(&self.sizes.classes) {
            let root = if *size > 0.0 { 1.0 / size.sqrt() } else { 0.0 };
            class.clone().for_each(|i| roots[(i, i)] = root);
        }
        let PriorRows { rows: prior_rows, read, .. } = self.rows.prior();
        let count = roots.nrows();
        roots = roots.resize_vertically(count + prior_rows.nrows(), 0.0);
        roots.rows_mut(count, prior_rows.nrows()).copy_from(prior_rows);
        let mut below = DVector::zeros(roots.nrows());
        below.rows_mut(count, read.len()).copy_from(read);
        let scales = self.effects.iter().map(|effect| 1.0 / effect.scale);
        for columns in [&mut random, &mut roots] {
            scattered(columns, &means);
            scale_columns(columns, scales.clone());
        }
        let gamma = self.sizes.gamma;
        let response = Response::with_random(&self.fit, &random, (&roots, &below), gamma)?;
        Ok(self.response.get_or_init(|| Arc::new(response)).clone())
    }

    /// The likelier model of springs alone, without bearings and beams, less this one: change of all unknowns. What an
    /// arm is made of is an assumption, and where it matters both differ.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub(crate) fn springs_alone(&self) -> Result<DVector<f64>> {
        let solution = self.fit.solution();
        let sigma = self.compliance.spread.as_ref().map(|spread| spread.sigma);
        let of = |sizing| {
            self.fit.control().check()?;
            let choice = Choice { sizing, structure: false, sigma };
            let (axes, gamma) = (&solution.values, solution.gamma);
            fit_choice(&self.fit, &self.white, axes, gamma, &[], choice, None)
        };
        let [alike, by_joint] = [of(ElasticSizing::Alike)?, of(ElasticSizing::ByJoint)?];
        let likelier = match by_joint.values[0] < alike.values[0] {
            true => by_joint,
            false => alike,
        };
        let springs = likelier.solution();
        let springs = springs.ok_or_else(|| too_few("the equations are singular"))?;
        Ok(springs - &self.compliance.values)
    }

    /// What turns the unknowns into the compliance with which the joint axes alone best reproduce the arm over its
    /// cell.
    ///
    /// # Errors
    /// As [`Reproduced::over_cell`].
    pub(crate) fn reproduced(&self) -> Result<&Reproduced> {
        if let Some(reproduced) = self.reproduced.get() {
            return Ok(reproduced);
        }
        let (cell, terms, control) = (self.fit.cell(), &self.compliance.extra, self.fit.control());
        let reproduced = match cell.setup.load {
            Load::Measured => {
                let measured = self.fit.experiment().with_terms();
                let measured: Vec<&PostureTerms> = measured.map(|(_, posture_terms)| posture_terms).collect();
                Reproduced::over(&cell.setup.robot, &measured, terms, control)?
            }
            _ => Reproduced::over_cell(cell, terms, control)?,
        };
        Ok(self.reproduced.get_or_init(|| reproduced))
    }

    /// Ψ of all unknowns.
    pub(crate) fn system(&self) -> &MeasuredSystem {
        &self.system
    }

    /// Both models from the postures `chosen` (indices of blocks, ascending) alone.
    ///
    /// # Errors
    /// A fit that fails.
    pub(crate) fn alone(&self, chosen: &[usize]) -> Result<SubsetFit> {
        let all = self.rows.posture_count();
        let left_out: Vec<usize> = (0..all).filter(|b| chosen.binary_search(b).is_err()).collect();
        let plain = self.fit.fold_without(left_out)?;
        let mut out = SubsetFit { axes: None, mixed: None };
        if plain.solution.undetermined != self.rows.idle {
            return Ok(out);
        }
        // All is searched for afresh: what was found of all postures knows the others.
        let (axes, gamma) = (&plain.solution.values, plain.solution.gamma);
        let model = likeliest(&self.fit, &self.white, axes, gamma, &plain.left_out, None).ok();
        out.mixed = model.and_then(|(_, model)| model.compliance(&self.fit));
        out.axes = Some(plain.solution.values);
        Ok(out)
    }

    /// What `take` makes of each of the folds `plain` of [`fit`](Self::fit) and of the model without its postures, the
    /// sizes found anew; `None` where the others do not determine every joint. One fold is forgotten before the next: its
    /// covariance is as large as that of all.
    ///
    /// # Errors
    /// The first of `take`, by order; interrupted.
    pub(crate) fn each_fold<T: Send>(
        &self,
        plain: &[Fold],
        take: impl Fn(&Fold, Option<&IdentifiedCompliance>) -> Result<T> + Sync + Send,
    ) -> Result<Vec<T>> {
        let control = self.fit.control();
        in_order_watched(plain, "leaving postures out", control, |(_, fold)| {
            let (solution, left_out) = (&fold.solution, fold.left_out.as_slice());
            let (axes, gamma, near) = (&solution.values, solution.gamma, Some(&self.sizes));
            let sigma = self.compliance.spread.as_ref().map(|spread| spread.sigma);
            let compliance = || {
                let choice = Choice { sizing: self.sizing, structure: true, sigma };
                let model = fit_choice(&self.fit, &self.white, axes, gamma, left_out, choice, near);
                model.ok()?.compliance(&self.fit)
            };
            let determined = solution.undetermined == self.rows.idle;
            take(fold, determined.then(compliance).flatten().as_ref())
        })
    }
}

fn too_few(why: &str) -> Error {
    Error::new(Code::TooFewData, format!("Nothing can be said of what gives way beyond the joint axes: {why}."))
}

/// True where no displacement depends on unknown `j`: a joint that never carries load.
fn is_idle(system: &MeasuredSystem, j: usize) -> bool {
    system.psi.column(j).norm() <= rounding(system)
}

/// The system with the columns of extra terms.
fn extended(system: &MeasuredSystem, terms: &[ExtraTerm], columns: &DMatrix<f64>) -> MeasuredSystem {
    let fixed = system.psi.ncols();
    let mut psi = system.psi.clone().resize_horizontally(fixed + terms.len(), 0.0);
    psi.columns_mut(fixed, terms.len()).copy_from(columns);
    MeasuredSystem { psi, extra: terms.to_vec(), ..system.clone() }
}
