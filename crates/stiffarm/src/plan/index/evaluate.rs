//! All indices and the expected errors of one group of postures.

use super::drop_one::{DropTerms, relative_errors, rms};
use super::kinds::Index;
use super::prediction::PredictionModel;
use crate::error::{Code, Error, Result};
use crate::model::cell::{Cell, task_rows};
use crate::model::dexterity;
use crate::model::elastic::ElasticSource;
use crate::model::observation::PostureTerms;
use crate::numerics::information::{Factor, Stack, whiten_posture};
use serde::{Deserialize, Serialize};

/// Rows that are kept as they are; of more postures what a decomposition leaves of them.
const MOST_ROWS: usize = 1 << 14;

/// How far what gives way beyond the axes may be from what is expected, as a factor.
const UNEXPECTED_ELASTIC_RATIO: f64 = 3.0;

/// Values of every index; `None` where an index does not exist: a joint is
/// undetermined, J_N is singular, or the cell has no prior or no tasks.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Indices {
    /// max k(J_N).
    pub classical: Option<f64>,
    /// cond(Ψ).
    pub condition: Option<f64>,
    /// max k(J_N) × cond(Ψ).
    pub novel: Option<f64>,
    /// cond(Ψ·diag(1/k)).
    pub scaled_condition: Option<f64>,
    /// max k(J_N) × cond(Ψ·diag(1/k)).
    pub scaled: Option<f64>,
    /// RMS over joints of the relative standard error of k_j (fraction).
    pub expected_error: Option<f64>,
    /// Largest relative standard error over the joints (fraction).
    pub worst_joint: Option<f64>,
    /// Largest expected error when any one posture is lost (fraction).
    pub drop_one: Option<f64>,
    /// Geometric mean of the semi-axes of the relative error ellipsoid,
    /// σ·det(K⁻¹ΨᵀΨK⁻¹)^(−1/(2n)) (fraction).
    pub d: Option<f64>,
    /// RMS over the cell's tasks of the error of the predicted tip deflection,
    /// σ·sqrt(tr(T (ΨᵀΨ)⁻¹)) with T of [`task_matrix`](crate::model::cell::task_matrix) \[m\].
    pub task: Option<f64>,
    /// RMS error of the predicted deflection of the tip under the mixed elastic model with the sizes that the cell
    /// declares, else expected ones, at random postures inside the cell's limits under forces as large as its load's in
    /// all directions, and where it has tasks half at these \[m\].
    pub prediction: Option<f64>,
    /// The same where what gives way beyond the axes is a third and three times as large.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub prediction_range: Option<[f64; 2]>,
    /// Which sizes `prediction` took: those that the cell declares, or typical ones.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub prediction_sizes: Option<ElasticSource>,
    /// (Π σ_i)^(1/n)/√m with m postures.
    pub o1: Option<f64>,
    /// σ_min/σ_max.
    pub o2: Option<f64>,
    /// σ_min.
    pub o3: Option<f64>,
    /// σ_min²/σ_max.
    pub o4: Option<f64>,
    /// 1/Σ(1/σ_i).
    pub o5: Option<f64>,
}

impl Indices {
    /// Value of one index.
    pub fn get(mut self, index: Index) -> Option<f64> {
        *self.place(index)
    }

    /// Where the value of one index stands.
    pub(super) fn place(&mut self, index: Index) -> &mut Option<f64> {
        use Index as I;
        match index {
            I::Classical => &mut self.classical,
            I::Condition => &mut self.condition,
            I::Novel => &mut self.novel,
            I::ScaledCondition => &mut self.scaled_condition,
            I::Scaled => &mut self.scaled,
            I::ExpectedError => &mut self.expected_error,
            I::WorstJoint => &mut self.worst_joint,
            I::DropOne => &mut self.drop_one,
            I::D => &mut self.d,
            I::Task => &mut self.task,
            I::Prediction => &mut self.prediction,
            I::O1 => &mut self.o1,
            I::O2 => &mut self.o2,
            I::O3 => &mut self.o3,
            I::O4 => &mut self.o4,
            I::O5 => &mut self.o5,
        }
    }
}

/// Indices and expected errors of one group.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct GroupEvaluation {
    /// Name of the group.
    pub name: String,
    /// Number of postures.
    pub posture_count: usize,
    /// All indices.
    pub indices: Indices,
    /// k(J_N) per posture, Eq. (21); `None` at a singularity or for n < 6.
    pub k_jn: Vec<Option<f64>>,
    /// Singular values of Ψ, descending \[m·N·m/rad\].
    pub singular_values: Vec<f64>,
    /// Singular values of Ψ·diag(1/k), its rows weighted as the noise says, descending \[m\]: n times the square of
    /// `expected_error` is σ² times the sum of their inverse squares. Empty without a prior.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub scaled_singular_values: Vec<f64>,
    /// Correlation of the errors of the joints' estimated compliances, row by row, to first order also of their
    /// stiffness; empty where a joint is undetermined.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub correlation: Vec<Vec<f64>>,
    /// Relative standard error of k_j per joint at the cell's noise (fraction).
    pub relative_standard_error: Vec<Option<f64>>,
    /// Expected |k̂ − k|/k per joint, sqrt(2/π) times the standard error (fraction).
    pub expected_deviation: Vec<Option<f64>>,
    /// Names of joints the group cannot determine.
    pub undetermined_joints: Vec<String>,
    /// How sure `identify` is expected to be once the group is measured; absent where nobody asked, without a
    /// prior, and where the load is measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub forecast: Option<Forecast>,
}

/// The ± of each joint's stiffness that `identify` is expected to print once a group is measured: every measuring
/// point once under the cell's load.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Forecast {
    /// Confidence of the half widths.
    pub confidence: f64,
    /// Half width by readings and systematic errors together, joint by joint (fraction of k).
    pub total: Vec<Option<f64>>,
    /// Half width by the scatter of the readings alone.
    pub readings: Vec<Option<f64>>,
    /// Half width by systematic errors alone, as far as the readings will leave them.
    pub systematic: Vec<Option<f64>>,
    /// The source of systematic error that will contribute most.
    pub largest_source: Vec<Option<String>>,
}

/// Relative standard error above which the closed form, first order in Ĥ, is
/// flagged and the median printed instead of the mean.
///
/// E|1/Ĥ − k| is infinite at every noise level, because a normal Ĥ has a density
/// at zero. Below the limit a run near zero is so rare (ten standard deviations
/// away) that the mean of the runs made is a mean truncated there, and the closed
/// form meets it; above, single runs can dominate it.
pub const FIRST_ORDER_LIMIT: f64 = 0.1;

impl GroupEvaluation {
    /// True when the expected deviation of a joint, counted from 0, is beyond
    /// what the first order says: its relative standard error passes
    /// [`FIRST_ORDER_LIMIT`].
    pub fn is_beyond_first_order(&self, joint: usize) -> bool {
        let error = self.relative_standard_error.get(joint).copied().flatten();
        error.is_some_and(|error| error > FIRST_ORDER_LIMIT)
    }

    /// Mean over the joints of the expected deviation (fraction), `None` when a
    /// joint has none.
    pub fn mean_expected_deviation(&self) -> Option<f64> {
        let sum: Option<f64> = self.expected_deviation.iter().copied().sum();
        sum.map(|s| s / self.expected_deviation.len() as f64)
    }
}

/// Evaluates every index of a group of postures (controller angles, rad).
///
/// Indices that need a prior stiffness, tasks or the characteristic length are
/// `None` when the cell has none.
///
/// ```
/// # fn main() -> stiffarm::Result<()> {
/// use stiffarm_files::builtin;
/// use stiffarm::plan::index::{Index, evaluate};
///
/// let cell = builtin::cell("comau")?;
/// let group = builtin::postures("comau-group1", &cell.setup.robot)?;
/// let found = evaluate(&cell, "Group 1", &group)?;
/// for index in [Index::Condition, Index::ExpectedError] {
///     println!("{}: {:?}", index.as_str(), found.indices.get(index));
/// }
/// assert!(found.undetermined_joints.is_empty());
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// An empty group, angles (of postures or tasks) of the wrong length or not
/// finite, or a load that only a measurement gives.
pub fn evaluate<Q: AsRef<[f64]>>(cell: &Cell, name: &str, postures: &[Q]) -> Result<GroupEvaluation> {
    // The cell may lack what the index prediction needs.
    let model = PredictionModel::of_cell(cell).ok();
    let terms = terms_of_each(cell, postures);
    evaluate_each(cell, name, postures.len(), terms, model.as_ref())
}

/// [`evaluate`] for those who look at `index` alone, or at none: the index `prediction`,
/// which takes longer than all others together, is left out where it is another.
///
/// # Errors
/// As [`evaluate`].
pub fn evaluate_for<Q: AsRef<[f64]>>(
    cell: &Cell,
    name: &str,
    postures: &[Q],
    index: Option<Index>,
) -> Result<GroupEvaluation> {
    let model = PredictionModel::for_index(cell, index);
    let terms = terms_of_each(cell, postures);
    evaluate_each(cell, name, postures.len(), terms, model.as_ref())
}

/// Terms of postures (controller angles, rad), of each under every load of the cell.
///
/// # Errors
/// As [`PostureTerms::new`].
pub(crate) fn posture_terms<Q: AsRef<[f64]>>(cell: &Cell, postures: &[Q]) -> Result<Vec<Vec<PostureTerms>>> {
    terms_of_each(cell, postures).collect()
}

/// The same one after the other: they are large.
fn terms_of_each<Q: AsRef<[f64]>>(cell: &Cell, postures: &[Q]) -> impl Iterator<Item = Result<Vec<PostureTerms>>> {
    let setups = cell.setup.cases();
    postures.iter().map(move |q| {
        let under = |setup| PostureTerms::new(setup, q.as_ref(), None);
        setups.iter().map(under).collect()
    })
}

/// [`evaluate`] of postures whose terms are known, under each of as many loads, which may be
/// wrenches of their own; without `prediction` that index is left out.
///
/// # Errors
/// As [`evaluate`].
pub(crate) fn evaluate_terms<T: AsRef<[PostureTerms]>>(
    cell: &Cell,
    name: &str,
    postures: &[T],
    prediction: Option<&PredictionModel>,
) -> Result<GroupEvaluation> {
    evaluate_each(cell, name, postures.len(), postures.iter().map(Ok), prediction)
}

/// The same of `count` postures whose terms are looked at once, one after the other.
fn evaluate_each<T: AsRef<[PostureTerms]>>(
    cell: &Cell,
    name: &str,
    count: usize,
    postures: impl Iterator<Item = Result<T>>,
    prediction: Option<&PredictionModel>,
) -> Result<GroupEvaluation> {
    if count == 0 {
        return Err(Error::new(Code::TooFewData, format!("The group \"{name}\" has no postures.")));
    }
    let setup = &cell.setup;
    let robot = &setup.robot;
    let n = robot.spring_count();
    let m = setup.tool.point_count();
    let rho = cell.noise.common_weight(m);
    let (mut psi, mut whitened) = (Stack::new(n, MOST_ROWS), Stack::new(n, MOST_ROWS));
    let mut predicting = prediction.map(|model| (model, model.stack()));
    let mut each = DropTerms::new(cell, count * setup.cases().len() * 3 * m > MOST_ROWS);
    let mut k_jn = Vec::with_capacity(count);
    for states in postures {
        let states = states?;
        // Rows of a posture: load by load.
        let mut rows = Stack::new(n, usize::MAX);
        for terms in states.as_ref() {
            let mut block = terms.block(robot);
            psi.push(block.clone());
            whiten_posture(&mut block, rho);
            rows.push(block);
        }
        if let Some((model, stack)) = &mut predicting {
            stack.push(model.readings(states.as_ref()));
        }
        let rows = rows.into_matrix();
        each.add(&rows);
        whitened.push(rows);
        let terms = &states.as_ref()[0];
        k_jn.push(
            cell.characteristic_length
                .and_then(|length| dexterity::condition_number(terms.frames(), &terms.measuring_points()[0], length)),
        );
    }
    let (psi, whitened) = (psi.into_matrix(), whitened.into_matrix());
    let factor = Factor::new(&psi)?;
    let full = factor.undetermined().is_empty();
    let sigma = factor.singular_values(|_| 1.0)?;
    let ratio = |s: &nalgebra::DVector<f64>| full.then(|| s[0] / s[n - 1]).filter(|c| c.is_finite());
    let condition = ratio(&sigma);
    // k(J_N)_max exists only where every posture has one.
    let classical = k_jn.iter().copied().try_fold(0.0_f64, |max, k| k.map(|k| max.max(k)));

    let std = cell.noise.displacement_std();
    let mut relative = vec![None; n];
    let (mut scaled_condition, mut d, mut drop_one) = (None, None, None);
    let mut scaled_sigma = Vec::new();
    // Without a posture-common part the whitened Ψ is Ψ.
    let weighted = if rho > 0.0 { Factor::new(&whitened)? } else { factor.clone() };
    if let Some(prior) = &cell.prior {
        scaled_condition = ratio(&factor.singular_values(|j| 1.0 / prior[j])?);
        relative = relative_errors(&weighted, prior, std);
        let s = weighted.singular_values(|j| 1.0 / prior[j])?;
        if weighted.undetermined().is_empty() {
            d = Some(std * (-s.iter().map(|v| v.ln()).sum::<f64>() / n as f64).exp());
        }
        scaled_sigma = s.iter().copied().collect();
        drop_one = each.drop_one_error(&whitened, prior, std)?;
    }
    let task = if cell.tasks.is_empty() {
        None
    } else {
        match task_rows(cell) {
            Ok(rows) => weighted.mapped_error(&rows).map(|e| std * e),
            // A task that turns what is left out.
            Err(error) if error.code() == Code::NotIdentifiable => None,
            Err(error) => return Err(error),
        }
    };
    let rms = rms(&relative);
    let worst = relative.iter().copied().try_fold(0.0_f64, |max, e| e.map(|e| max.max(e)));
    let times = |a: Option<f64>, b: Option<f64>| Some(a? * b?);
    let observability = |f: &dyn Fn() -> f64| full.then(f).filter(|v| v.is_finite());
    let log_sum = || sigma.iter().map(|s| s.ln()).sum::<f64>();
    let predicting = predicting.filter(|_| full);
    let predicting = predicting.map(|(model, stack)| (model, model.rows(stack)));
    let predicted = |factor: f64| {
        let (model, rows) = predicting.as_ref()?;
        model.value_where(rows, factor)
    };
    let expected = predicted(1.0);
    Ok(GroupEvaluation {
        name: name.to_string(),
        posture_count: count,
        indices: Indices {
            classical,
            condition,
            novel: times(classical, condition),
            scaled_condition,
            scaled: times(classical, scaled_condition),
            expected_error: rms,
            worst_joint: worst,
            drop_one,
            d,
            task,
            prediction: expected,
            prediction_range: predicted(1.0 / UNEXPECTED_ELASTIC_RATIO)
                .zip(predicted(UNEXPECTED_ELASTIC_RATIO))
                .map(Into::into),
            prediction_sizes: expected.and_then(|_| prediction?.source()),
            o1: observability(&|| (log_sum() / n as f64).exp() / (count as f64).sqrt()),
            o2: observability(&|| sigma[n - 1] / sigma[0]),
            o3: observability(&|| sigma[n - 1]),
            o4: observability(&|| sigma[n - 1].powi(2) / sigma[0]),
            o5: observability(&|| 1.0 / sigma.iter().map(|s| 1.0 / s).sum::<f64>()),
        },
        k_jn,
        singular_values: sigma.iter().copied().collect(),
        scaled_singular_values: scaled_sigma,
        correlation: correlation(&weighted),
        expected_deviation: relative.iter().map(|e| e.map(expected_deviation)).collect(),
        relative_standard_error: relative,
        undetermined_joints: factor.undetermined().iter().map(|&j| robot.spring_names()[j].clone()).collect(),
        forecast: None,
    })
}

/// Mean of |x| for a normal x of standard deviation `std`: sqrt(2/π)·std.
pub fn expected_deviation(std: f64) -> f64 {
    std * std::f64::consts::FRAC_2_PI.sqrt()
}

/// Correlation of the errors of the estimated unknowns; empty where one is undetermined.
fn correlation(factor: &Factor) -> Vec<Vec<f64>> {
    if !factor.undetermined().is_empty() {
        return Vec::new();
    }
    let covariance = factor.inverse_information();
    let n = covariance.nrows();
    let one = |i: usize, j: usize| {
        let size = (covariance[(i, i)] * covariance[(j, j)]).sqrt();
        if i == j { 1.0 } else { (covariance[(i, j)] / size).clamp(-1.0, 1.0) }
    };
    (0..n).map(|i| (0..n).map(|j| one(i, j)).collect()).collect()
}
