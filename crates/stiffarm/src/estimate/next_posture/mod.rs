//! What to measure next: the posture that would help an identification most.
//!
//! A fit knows its unknowns with information M = Ψᵀ V⁻¹ Ψ/σ², with everything
//! that went into it: load states, repeated readings, the ratio of the two
//! variances, weights. One more posture adds Ψ₊ᵀ V₊⁻¹ Ψ₊/σ², which takes
//! nothing away, so that no standard error grows.
//!
//! What is assumed of the new posture: it carries the cell's load (where that
//! is measured, the load that the measured forces look like), and it is
//! measured as the posture in the middle was, by the number of its
//! displacements: at the same points, in as many load states with the same
//! shares of the load, each as often read.

mod load;
mod planned;
mod search;

pub use load::AssumedLoad;
pub(in crate::estimate) use planned::measured_alike;
pub use planned::{PlannedErrors, planned_errors};

use crate::error::{Code, Error, Result};
use crate::estimate::identify::{Block, Estimator, Fit, Identification, JointEstimate, MeasuredSystem, Verdict, rms};
use crate::findings::list;
use crate::model::cell::Cell;
use crate::model::load::Load;
use crate::model::measurement::MeasuredPosture;
use crate::model::observation::{PostureTerms, Setup};
use crate::numerics::control::Control;
use crate::numerics::information::Factor;
use crate::plan::check::springs_left_out;
use crate::plan::select::GlobalOptions;
use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

/// The posture that would help most.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct NextPosture {
    /// Its controller angles \[rad\].
    #[serde(rename = "posture_deg", with = "crate::units::degrees")]
    #[cfg_attr(feature = "schema", schemars(with = "Vec<f64>"))]
    pub angles: Vec<f64>,
    /// Relative standard error of each joint's stiffness by the scatter of the readings (fraction), in the model that
    /// predicts; `None` where the joint is not determined.
    pub before: Vec<Option<f64>>,
    /// The same with the new posture: never above `before`.
    pub after: Vec<Option<f64>>,
    /// Relative standard error, RMS over the joints that the load turns, with the new posture.
    pub expected_error: f64,
    /// The load assumed at the new posture, where the cell's is measured.
    pub assumed_load: Option<AssumedLoad>,
    /// The posture as which the new one is assumed to be measured: points, load
    /// states and repeats.
    pub measured_as: String,
    /// Displacements of that posture, all load states together.
    pub displacements: usize,
}

impl NextPosture {
    /// The same for a model with these `joints`: the error of each falls as it does in the fit.
    pub(crate) fn scale_to(&mut self, joints: &[JointEstimate]) {
        let errors = joints.iter().map(JointEstimate::readings_error);
        for ((before, after), model_error) in self.before.iter_mut().zip(&mut self.after).zip(errors) {
            // What the fit cannot tell yet stays what the new posture makes of it.
            if let Some(fit) = *before {
                *after = model_error.zip(*after).map(|(model_error, after)| model_error * after / fit);
                *before = model_error;
            }
        }
        let determined: Vec<f64> = self.after.iter().copied().flatten().collect();
        self.expected_error = rms(&determined);
    }
}

/// The posture within the cell's bounds and limits which, measured besides the
/// others, makes the relative standard errors (RMS over the joints that the load turns) smallest. Errors
/// are relative to the identified stiffness, or to the prior where that is not
/// positive. The noise is that of the fit, or the cell's where the fit cannot tell.
///
/// # Errors
/// No stiffness to weigh joints by, measured forces from which no load can be
/// assumed, no posture within the limits, or none with which all joints
/// that the load turns are determined.
pub fn next_posture(fit: &Fit, options: &GlobalOptions, control: Control<'_>) -> Result<NextPosture> {
    let (result, measured) = (fit.identification()?, fit.postures());
    let mut cell = fit.cell().clone();
    let stiffness = stiffness(&cell, result)?;
    let mut assumed = None;
    if cell.setup.load == Load::Measured {
        let (load, description) = load::assumed_load(&cell, measured)?;
        cell.setup.load = load;
        assumed = Some(description);
    }
    let information = FitInformation::new(fit, &cell)?;
    let relative = |factor: &Factor| -> Vec<Option<f64>> {
        let errors = factor.standard_errors();
        let of_springs = errors.iter().zip(&stiffness);
        of_springs.map(|(error, k)| error.map(|e| e * k * information.sigma)).collect()
    };
    let before = relative(&Factor::new(&information.seen)?);
    let left_out = springs_left_out(&cell);
    let is_turned = |j: &usize| before[*j].is_some() || !left_out.contains(j);
    let turned: Vec<usize> = (0..before.len()).filter(is_turned).collect();
    // RMS over the joints that the load turns, infinite where one of them is not determined.
    let error = |errors: &[Option<f64>]| {
        let all: Option<Vec<f64>> = turned.iter().map(|j| errors[*j]).collect();
        all.map_or(f64::INFINITY, |all| rms(&all))
    };
    let value = |q: &[f64]| Ok(error(&relative(&information.with(&cell, q)?)));
    let q = search::best_posture(&cell, options, control, &value)?.ok_or_else(|| {
        let names = cell.setup.robot.spring_names();
        let mut open = result.estimates.undetermined_joints.clone();
        open.retain(|name| turned.iter().any(|j| names[*j] == *name));
        Error::new(
            Code::NotIdentifiable,
            format!("One more posture with this load does not determine {}.", list(&open)),
        )
    })?;
    let after = relative(&information.with(&cell, &q)?);
    Ok(NextPosture {
        angles: q,
        before,
        expected_error: error(&after),
        after,
        assumed_load: assumed,
        measured_as: information.posture,
        displacements: information.displacements,
    })
}

/// What a fit knows, and what one more posture measured like the others adds.
struct FitInformation {
    /// Rows with the information of the fit, in units of 1/σ².
    seen: DMatrix<f64>,
    /// σ: a standard error per unit of information \[m\].
    sigma: f64,
    /// Takes Ψ of one posture under the whole load (3m rows, point by point; of several
    /// loads one below the other) to white rows of all its load states.
    root: DMatrix<f64>,
    /// The posture that the new one is measured like.
    posture: String,
    displacements: usize,
    extra: Vec<crate::model::observation::ExtraTerm>,
}

impl FitInformation {
    /// `cell` has the load that is assumed at the new posture.
    fn new(fit: &Fit, cell: &Cell) -> Result<Self> {
        let (system, solution) = (fit.system(), fit.solution());
        let factor = &solution.factor;
        // What the covariance has per unit of information: σ², for Huber's
        // estimator with what its weights cost.
        let inverse = factor.inverse_information();
        let determined = (0..inverse.nrows()).find(|j| !solution.undetermined.contains(j) && inverse[(*j, *j)] > 0.0);
        let scale = solution
            .covariance
            .as_ref()
            .zip(determined)
            .map(|(covariance, j)| covariance[(j, j)] / inverse[(j, j)])
            .filter(|scale| *scale > 0.0);
        let block = typical(system)?;
        let plain = fit.options().estimator == Estimator::Ordinary;
        Ok(FitInformation {
            seen: factor.seen(),
            sigma: scale.map_or_else(|| fit.cell().noise.displacement_std(), f64::sqrt),
            root: root(fit, cell, block, solution.gamma, plain)?,
            posture: block.posture.clone(),
            displacements: system.labels_of(block).len(),
            extra: system.extra.clone(),
        })
    }

    /// Factor of the information with a posture at these controller angles \[rad\].
    fn with(&self, cell: &Cell, q: &[f64]) -> Result<Factor> {
        let (rows, unknowns) = self.seen.shape();
        let setups = cell.setup.cases();
        let each = 3 * cell.setup.tool.point_count();
        let mut psi = DMatrix::zeros(each * setups.len(), unknowns);
        for (number, setup) in setups.iter().enumerate() {
            let terms = PostureTerms::new(setup, q, None)?;
            psi.rows_mut(each * number, each).copy_from(&terms.block_with(&cell.setup.robot, &self.extra));
        }
        let new = &self.root * psi;
        let mut all = DMatrix::zeros(rows + new.nrows(), unknowns);
        all.rows_mut(0, rows).copy_from(&self.seen);
        all.rows_mut(rows, new.nrows()).copy_from(&new);
        Factor::new(&all)
    }
}

/// The posture in the middle by the number of its displacements: as it was, new ones are measured.
fn typical(system: &MeasuredSystem) -> Result<&Block> {
    let mut order: Vec<&Block> = system.blocks.iter().collect();
    // A stable sort: of postures alike the first.
    order.sort_by_key(|b| b.rows.len());
    let middle = order.get(order.len() / 2);
    middle.copied().ok_or_else(|| Error::new(Code::Internal, "A fit without postures."))
}

/// Share of the whole load, that of `setup`, in a measured load state with these terms.
fn share(setup: &Setup, posture: &MeasuredPosture, terms: Option<&PostureTerms>) -> Result<f64> {
    let whole = PostureTerms::new(setup, &posture.posture.q, None)?;
    let whole = DVector::from_column_slice(whole.torque());
    let size = whole.norm_squared();
    Ok(match terms {
        Some(terms) if size > 0.0 => whole.dot(&DVector::from_column_slice(terms.torque())) / size,
        _ => 1.0,
    })
}

/// White rows of a posture measured like `block` from its Ψ under the whole
/// load of `cell` (under each of several): R with RᵀR = FᵀV⁻¹F, where F lays the points'
/// rows into the load states in proportion to their share of the load.
fn root(fit: &Fit, cell: &Cell, block: &Block, gamma: f64, plain: bool) -> Result<DMatrix<f64>> {
    let labels = fit.system().labels_of(block);
    let count = 3 * labels.len();
    let setups = cell.setup.cases();
    let each = 3 * cell.setup.tool.point_count();
    let mut lay = DMatrix::zeros(count, each * setups.len());
    let mut shares = DVector::zeros(labels.len());
    for (d, label) in labels.iter().enumerate() {
        let (posture, point) = fit.experiment().behind(label);
        let case = cell.setup.load.case_of(&posture.state)?;
        shares[d] = share(&setups[case], posture, fit.experiment().terms(label.measured))?;
        for axis in 0..3 {
            lay[(3 * d + axis, each * case + 3 * point + axis)] = shares[d];
        }
    }
    let largest = shares.amax();
    let mut variance = if plain { DMatrix::identity(count, count) } else { block.covariance.to_matrix(count) };
    if largest > 0.0 {
        // The shift common to a posture's points grows with the load.
        let part = gamma / (largest * largest);
        for i in 0..count {
            for j in (i % 3..count).step_by(3) {
                variance[(i, j)] += part * shares[i / 3] * shares[j / 3];
            }
        }
    }
    let root = variance.cholesky().ok_or_else(|| {
        let message = "The covariance of a posture's readings is not positive definite.";
        Error::invalid(message)
    })?;
    let mut white = lay;
    root.l_dirty().solve_lower_triangular_mut(&mut white);
    Ok(white.qr().r())
}

/// Stiffness of each joint: identified, else the prior, else the middle of the
/// identified ones.
fn stiffness(cell: &Cell, result: &Identification) -> Result<Vec<f64>> {
    let identified: Vec<Option<f64>> = result
        .estimates
        .joints
        .iter()
        .map(|joint| {
            let usable = joint.verdict != Verdict::SignOrModelFault;
            joint.stiffness.filter(|k| usable && *k > 0.0)
        })
        .collect();
    let mut sorted: Vec<f64> = identified.iter().flatten().copied().collect();
    sorted.sort_by(f64::total_cmp);
    let middle = sorted.get(sorted.len() / 2).copied();
    identified
        .iter()
        .enumerate()
        .map(|(j, k)| {
            let prior = cell.prior.as_ref().map(|prior| prior[j]);
            k.or(prior).or(middle).ok_or_else(|| {
                Error::new(
                    Code::NotIdentifiable,
                    "No joint has a positive stiffness by which to weigh the next posture.",
                )
            })
        })
        .collect()
}
