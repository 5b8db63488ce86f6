//! How good a plan can be at all: a bound that no group of N postures of a
//! cell goes below, and with it the efficiency of a plan.
//!
//! The best *continuous* design, with weights instead of whole postures,
//! bounds every exact design (Kiefer & Wolfowitz 1960,
//! doi:10.4153/CJM-1960-030-4). With φ(M) = tr(Q M⁻¹) or det(M)^(−1/n), M₀ the
//! information per posture of any design, A the derivative of φ at it and
//! s = max tr(A G(q)) over the feasible postures, N postures have
//!
//! ```text
//! tr(Q M⁻¹)   ≥ t²/(s N),              A = M₀⁻¹ Q M₀⁻¹,  t = tr(Q M₀⁻¹)
//! det(M)^(1/n) ≤ N det(M₀)^(1/n) s/n,  A = M₀⁻¹
//! ```
//!
//! by the Cauchy–Schwarz inequality and that of the means. At the optimum
//! s = t (s = n for the determinant), and the bound is φ(M₀)/N itself; the
//! *residual* s/t − 1 says how far the design found is from it. Information
//! M_g of postures that are measured already adds tr(A M_g)/N to s.
//!
//! What is certain and what is not: *given s*, the bound is a theorem, whatever
//! M₀ is. That s is the maximum over all feasible postures rests on a
//! multi-start search and is not proved: a maximum that every
//! search misses makes the bound too high. A result therefore says how many
//! searches looked, how many of them ended at the largest value, and how often
//! the rarest posture of the design itself was met ([`Verification`]). The
//! postures of the plan are among the points looked at, so that no plan is
//! ever reported as better than its bound.
//!
//! A bound is a theorem plus a search. Given s = max tr(A·G(q)) the bound of
//! `certificate` holds for any M₀; only s is searched for, from 1024 starts,
//! because the value at a start says little about the local maximum it leads
//! to. Interior-point weights, not the multiplicative algorithm, so that the
//! residual of the equivalence condition is that of the searches alone.

mod climb;
pub(crate) mod continuous;
pub(crate) mod criterion;
pub(crate) mod design;
mod generation;
mod plan;
mod readings;
pub(crate) mod space;
pub(crate) mod weights;

pub use design::Verification;

use criterion::Criterion;
use plan::Plan;
use space::PostureSpace;

use crate::error::{Code, Error, Result};
use crate::model::cell::{Cell, task_matrix};
use crate::numerics::control::{Control, Termination};
use crate::plan::index::prediction::PredictionFunction;
use crate::plan::index::{Index, evaluate_for};
use nalgebra::DMatrix;
use serde::{Deserialize, Serialize};

/// Tolerance, rounds and searches for the index prediction.
const PREDICTION_TOLERANCE: f64 = 0.01;
const PREDICTION_ROUNDS: usize = 6;
const PREDICTION_SAMPLES: usize = 64;
const PREDICTION_SEARCHES: usize = 12;

/// Budget and tolerance of a certificate.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default)]
#[non_exhaustive]
pub struct CertificateOptions {
    /// Residual of the equivalence condition to reach (fraction). The bound of
    /// an index, a square root, is loose by half of it at most.
    pub tolerance: f64,
    /// Rounds of weights and searches.
    pub max_rounds: usize,
    /// Local searches, each from its own posture, that the bound rests on.
    pub samples: usize,
    /// Local searches in a round on the way, besides one from each posture of
    /// the design.
    pub searches: usize,
}

impl CertificateOptions {
    /// The same for an index with a hundred unknowns, whose bound is loose by more than this for few postures.
    fn narrower(&self) -> Self {
        CertificateOptions {
            tolerance: self.tolerance.max(PREDICTION_TOLERANCE),
            max_rounds: self.max_rounds.min(PREDICTION_ROUNDS),
            samples: self.samples.min(PREDICTION_SAMPLES),
            searches: self.searches.min(PREDICTION_SEARCHES),
        }
    }
}

impl Default for CertificateOptions {
    fn default() -> Self {
        CertificateOptions { tolerance: 1e-4, max_rounds: 40, samples: 1024, searches: 16 }
    }
}

/// A posture of the continuous design.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SupportPosture {
    /// Controller angles \[rad\].
    #[serde(rename = "angles_deg", with = "crate::units::degrees")]
    #[cfg_attr(feature = "schema", schemars(with = "Vec<f64>"))]
    pub angles: Vec<f64>,
    /// Its share of the measurements; the shares sum to 1.
    pub weight: f64,
}

/// How good a plan is against the best any group of as many postures can be.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Certificate {
    /// The index.
    pub index: Index,
    /// Number of postures of the plan, N.
    pub posture_count: usize,
    /// Number of postures measured before, counted in `bound` and `value`.
    pub measured_count: usize,
    /// No N postures within the cell's bounds and limits have an index below
    /// this: a theorem, provided the searches found the largest tr(A·G(q)).
    pub bound: f64,
    /// The index of the plan; `None` where the plan leaves a joint undetermined.
    pub value: Option<f64>,
    /// `bound`/`value`, 1 for a plan that nothing can beat; `None` where the
    /// plan has no value or uses postures outside the bounds or limits.
    pub efficiency: Option<f64>,
    /// Postures of the plan outside the cell's bounds or limits, counted from
    /// 1: the bound says nothing about such a plan.
    pub outside: Vec<usize>,
    /// Residual of the equivalence condition: the bound could be larger by
    /// half this share at most.
    pub residual: f64,
    /// The continuous design, largest weight first.
    pub support: Vec<SupportPosture>,
    /// Local searches for the largest tr(A·G(q)) in all rounds.
    pub searches: usize,
    /// What the searches found that the bound rests on.
    pub verification: Verification,
    /// Rounds of weights and searches.
    pub rounds: usize,
    /// [`Termination::Converged`] where the residual met the tolerance; else
    /// the bound holds as well but is looser.
    pub termination: Termination,
}

/// One joint: its relative standard error against the smallest that any group
/// of as many postures can give this joint, whatever it does for the others.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct JointEfficiency {
    /// Name of the joint.
    pub joint: String,
    /// No N postures give a smaller relative standard error (fraction).
    pub bound: f64,
    /// Relative standard error of the plan (fraction).
    pub value: Option<f64>,
    /// `bound`/`value`, as in [`Certificate`].
    pub efficiency: Option<f64>,
    /// Residual of the equivalence condition.
    pub residual: f64,
    /// Why the search for the bound ended.
    pub termination: Termination,
}

/// Bounds `index` from below over all groups of as many postures as `postures`
/// (controller angles, rad) within the cell's bounds and limits, and compares
/// the plan with the bound. For [`Index::ExpectedError`],
/// [`Index::D`] and [`Index::Task`].
///
/// ```
/// # fn main() -> stiffarm::Result<()> {
/// use stiffarm::Control;
/// use stiffarm_files::builtin;
/// use stiffarm::plan::certificate::{CertificateOptions, certify};
/// use stiffarm::plan::index::Index;
///
/// let cell = builtin::cell("comau")?;
/// let plan = builtin::postures("comau-group1", &cell.setup.robot)?;
/// let mut options = CertificateOptions::default();
/// options.samples = 64; // few searches: a quick look, not a bound to rely on
/// let found = certify(&cell, Index::D, &plan, &options, Control::default())?;
/// assert!(found.value > Some(found.bound));
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// Another index; a cell without a prior stiffness or with a load that only a
/// measurement gives; no postures, angles of the wrong length or not finite;
/// limits that no sampled posture meets; joints that no posture determines
/// (they are named); options that make no sense; a stop before the first bound.
pub fn certify<Q: AsRef<[f64]>>(
    cell: &Cell,
    index: Index,
    postures: &[Q],
    options: &CertificateOptions,
    control: Control<'_>,
) -> Result<Certificate> {
    certify_further::<Q>(cell, index, &[], postures, options, control)
}

/// As [`certify`], for postures that come on top of `measured` ones: both the
/// bound and the value count the information of all. Measured postures may lie
/// outside the bounds and limits.
///
/// ```
/// # fn main() -> stiffarm::Result<()> {
/// use stiffarm::Control;
/// use stiffarm_files::builtin;
/// use stiffarm::plan::certificate::{CertificateOptions, certify_further};
/// use stiffarm::plan::index::Index;
///
/// let cell = builtin::cell("comau")?;
/// let all = builtin::postures("comau-group1", &cell.setup.robot)?;
/// let (measured, new) = all.split_at(4);
/// let mut options = CertificateOptions::default();
/// options.samples = 64;
/// let control = Control::default();
/// let found = certify_further(&cell, Index::D, measured, new, &options, control)?;
/// assert_eq!(found.measured_count, 4);
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// As [`certify`].
pub fn certify_further<Q: AsRef<[f64]>>(
    cell: &Cell,
    index: Index,
    measured: &[Q],
    postures: &[Q],
    options: &CertificateOptions,
    control: Control<'_>,
) -> Result<Certificate> {
    certify_until(cell, index, measured, postures, options, control, Control::default())
}

/// The same, where a stop of `until` ends each climb as well: what is bounded then holds nothing.
///
/// # Errors
/// As [`certify_further`].
pub(crate) fn certify_until<Q: AsRef<[f64]>>(
    cell: &Cell,
    index: Index,
    measured: &[Q],
    postures: &[Q],
    options: &CertificateOptions,
    control: Control<'_>,
    until: Control<'_>,
) -> Result<Certificate> {
    let n = cell.setup.robot.spring_count();
    if index.needs_prior() {
        index.prior_of(cell)?;
    }
    let criterion = match index {
        // RMS over joints: tr(M⁻¹)/n under the root.
        Index::ExpectedError => Criterion::Trace(DMatrix::identity(n, n) / n as f64),
        Index::D => Criterion::Determinant,
        Index::Task => Criterion::Trace(relative_task_matrix(cell)?),
        Index::Prediction => {
            let function = PredictionFunction::new::<Q>(cell, 1, &[])?;
            let targets = &function.model().targets().all;
            let criterion = Criterion::Trace(targets.tr_mul(targets));
            let options = options.narrower();
            let (samples, searches) = (options.samples, options.searches);
            let space = PostureSpace::predicting(cell, function, samples, searches)?.until(until);
            let plan = Plan::of(space, measured, postures, &options)?;
            return plan.certificate(index, &criterion, measured, postures, control);
        }
        _ => {
            return Err(Error::new(
                Code::Unsupported,
                format!("There is no bound for the index \"{}\".", index.as_str()),
            )
            .hint("expected_error, d, task and prediction have one"));
        }
    };
    let plan = Plan::new(cell, measured, postures, options, until)?;
    plan.certificate(index, &criterion, measured, postures, control)
}

/// For each joint, the smallest relative standard error that any group of as
/// many postures as `postures` (controller angles, rad) can give it, and what
/// the plan gives. One group cannot reach the bounds of all joints at once.
///
/// The best design for a single joint may leave others undetermined; the bound
/// then comes from a design with a small share of others and is loose by an
/// eighth of the tolerance at most.
///
/// ```
/// # fn main() -> stiffarm::Result<()> {
/// use stiffarm::Control;
/// use stiffarm_files::builtin;
/// use stiffarm::plan::certificate::{CertificateOptions, joint_efficiencies};
///
/// let cell = builtin::cell("comau")?;
/// let plan = builtin::postures("comau-group1", &cell.setup.robot)?;
/// let mut options = CertificateOptions::default();
/// options.samples = 16;
/// options.max_rounds = 5;
/// for joint in joint_efficiencies(&cell, &plan, &options, Control::default())? {
///     assert!(joint.efficiency.is_none_or(|share| share <= 1.0));
/// }
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// As [`certify`].
pub fn joint_efficiencies<Q: AsRef<[f64]>>(
    cell: &Cell,
    postures: &[Q],
    options: &CertificateOptions,
    control: Control<'_>,
) -> Result<Vec<JointEfficiency>> {
    joint_efficiencies_until(cell, postures, options, control, Control::default())
}

/// The same, where a stop of `until` ends each climb as well: what is bounded then holds nothing.
///
/// # Errors
/// As [`certify`].
pub(crate) fn joint_efficiencies_until<Q: AsRef<[f64]>>(
    cell: &Cell,
    postures: &[Q],
    options: &CertificateOptions,
    control: Control<'_>,
    until: Control<'_>,
) -> Result<Vec<JointEfficiency>> {
    cell.require_prior()?;
    let plan = Plan::new(cell, &[], postures, options, until)?;
    let values = evaluate_for(cell, "", postures, None)?.relative_standard_error;
    let names = cell.setup.robot.spring_names();
    let n = names.len();
    // What helped one joint is a good start for the next.
    let mut helpful: Vec<Vec<f64>> = Vec::new();
    let mut out = Vec::with_capacity(n);
    for (j, joint) in names.into_iter().enumerate() {
        let mut q = DMatrix::zeros(n, n);
        q[(j, j)] = 1.0;
        let design = plan.design(&Criterion::Trace(q), &helpful, control)?;
        let bound = plan.bound(&design);
        out.push(JointEfficiency {
            joint,
            bound,
            value: values[j],
            efficiency: plan.efficiency(bound, values[j]),
            residual: design.residual,
            termination: design.termination,
        });
        helpful.extend(design.points);
    }
    Ok(out)
}

/// The task matrix T for relative parameters, K⁻¹TK⁻¹, or T itself without a prior.
fn relative_task_matrix(cell: &Cell) -> Result<DMatrix<f64>> {
    let mut matrix = task_matrix(cell)?;
    if let Some(prior) = &cell.prior {
        for (j, k) in prior.iter().enumerate() {
            matrix.row_mut(j).scale_mut(1.0 / k);
            matrix.column_mut(j).scale_mut(1.0 / k);
        }
    }
    Ok(matrix)
}
