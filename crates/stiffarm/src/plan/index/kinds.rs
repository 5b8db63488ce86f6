//! The indices by name.

use crate::error::{Code, Error, Result, did_you_mean};
use crate::model::cell::Cell;
use serde::{Deserialize, Serialize};

/// An index of a group of postures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Index {
    /// max k(J_N) over the postures (Section III.B, classical index).
    Classical,
    /// cond₂(Ψ) = σ_max/σ_min (Section III.A).
    Condition,
    /// max k(J_N) × cond(Ψ) (Section III.B, novel index).
    Novel,
    /// cond(Ψ·diag(1/k)): balance of *relative* accuracy.
    ScaledCondition,
    /// max k(J_N) × cond(Ψ·diag(1/k)).
    Scaled,
    /// RMS over joints of the relative standard error of k_j (A-optimality).
    ExpectedError,
    /// Largest relative standard error over the joints.
    WorstJoint,
    /// Largest expected error when any one posture is lost.
    DropOne,
    /// Geometric mean of the semi-axes of the relative error ellipsoid (D-optimality).
    D,
    /// RMS error of the predicted tip deflection over the cell's tasks \[m\] (I-optimality).
    Task,
    /// RMS error of the predicted tip deflection over the cell's tasks, or over random
    /// postures inside its limits, under the mixed elastic model \[m\] (Bayesian
    /// I-optimality).
    Prediction,
    /// (Π σ_i)^(1/n)/√m with m postures; larger is better (Borm & Menq).
    O1,
    /// σ_min/σ_max; larger is better (Driels & Pathre).
    O2,
    /// σ_min; larger is better (Nahvi & Hollerbach).
    O3,
    /// σ_min²/σ_max, the noise amplification index; larger is better (Nahvi & Hollerbach).
    O4,
    /// 1/Σ(1/σ_i); larger is better (Sun & Hollerbach).
    O5,
}

impl Index {
    /// Every index.
    pub const ALL: [Index; 16] = [
        Index::Classical,
        Index::Condition,
        Index::Novel,
        Index::ScaledCondition,
        Index::Scaled,
        Index::ExpectedError,
        Index::WorstJoint,
        Index::DropOne,
        Index::D,
        Index::Task,
        Index::Prediction,
        Index::O1,
        Index::O2,
        Index::O3,
        Index::O4,
        Index::O5,
    ];

    /// What it is, in few words for tables; lower is better unless they say otherwise.
    pub fn meaning(self) -> &'static str {
        match self {
            Index::Classical => "largest k(J_N), the Jacobian's condition number, of a posture",
            Index::Condition => "condition number of the observation matrix",
            Index::Novel => "classical times condition, the paper's index",
            Index::ScaledCondition => "condition number for relative accuracy",
            Index::Scaled => "classical times scaled condition",
            Index::ExpectedError => "relative standard error of the stiffness, RMS over the joints",
            Index::WorstJoint => "relative standard error of the worst joint",
            Index::DropOne => "expected error once the most needed posture is lost",
            Index::D => "size of the relative error ellipsoid",
            Index::Task => "error of the deflection predicted at the tasks",
            Index::Prediction => {
                "error of the deflection predicted at work, under the mixed elastic model"
            }
            Index::O1 => "geometric mean of the singular values, over √postures; larger is better",
            Index::O2 => "smallest over largest singular value; larger is better",
            Index::O3 => "smallest singular value; larger is better",
            Index::O4 => "its square over the largest one; larger is better",
            Index::O5 => "one over the sum of their inverses; larger is better",
        }
    }

    /// Name in JSON.
    pub fn as_str(self) -> &'static str {
        match self {
            Index::Classical => "classical",
            Index::Condition => "condition",
            Index::Novel => "novel",
            Index::ScaledCondition => "scaled_condition",
            Index::Scaled => "scaled",
            Index::ExpectedError => "expected_error",
            Index::WorstJoint => "worst_joint",
            Index::DropOne => "drop_one",
            Index::D => "d",
            Index::Task => "task",
            Index::Prediction => "prediction",
            Index::O1 => "o1",
            Index::O2 => "o2",
            Index::O3 => "o3",
            Index::O4 => "o4",
            Index::O5 => "o5",
        }
    }

    /// Finds an index by name; `-` and `_` are the same.
    ///
    /// # Errors
    /// Unknown name; the hint has the nearest.
    pub fn from_name(name: &str) -> Result<Self> {
        let wanted = name.trim().to_lowercase().replace('-', "_");
        Index::ALL
            .into_iter()
            .find(|i| i.as_str() == wanted)
            .ok_or_else(|| {
                let hint =
                    did_you_mean(&wanted, Index::ALL.map(Index::as_str)).unwrap_or_else(|| {
                        format!(
                            "known indices: {}",
                            Index::ALL.map(Index::as_str).join(", ")
                        )
                    });
                Error::new(Code::UnknownName, format!("There is no index \"{name}\".")).hint(hint)
            })
    }

    /// True when a larger value is better (O1 to O5).
    pub fn larger_is_better(self) -> bool {
        matches!(
            self,
            Index::O1 | Index::O2 | Index::O3 | Index::O4 | Index::O5
        )
    }

    /// True when it rests on the largest or smallest singular value.
    pub(crate) fn has_extreme_singular_values(self) -> bool {
        matches!(
            self,
            Index::Condition
                | Index::Novel
                | Index::ScaledCondition
                | Index::Scaled
                | Index::O2
                | Index::O3
                | Index::O4
        )
    }

    /// True when it uses k(J_N) and with it the characteristic length.
    pub fn uses_dexterity(self) -> bool {
        matches!(self, Index::Classical | Index::Novel | Index::Scaled)
    }

    /// True when it needs a prior joint stiffness.
    pub fn needs_prior(self) -> bool {
        matches!(
            self,
            Index::ScaledCondition
                | Index::Scaled
                | Index::ExpectedError
                | Index::WorstJoint
                | Index::DropOne
                | Index::D
                | Index::Prediction
        )
    }

    /// The prior stiffness of a cell for an index that needs one.
    ///
    /// # Errors
    /// The cell has none; an index that chooses the same postures without is named.
    pub(crate) fn prior_of(self, cell: &Cell) -> Result<&[f64]> {
        cell.require_prior().map_err(|error| match self {
            // det(K Ψᵀ Ψ K) = det(K)² det(Ψᵀ Ψ): the prior is a factor.
            Index::D => Error::new(
                error.code(),
                "The index d is a percentage of the stiffness, for which the cell has no prior.",
            )
            .key("stiffness.prior_nm_per_rad")
            .hint("choose by o1, which has the same best postures and needs none, or give a prior"),
            _ => error,
        })
    }

    /// True when it is a multiple of the noise, whose posture-common part it
    /// weighs.
    pub(crate) fn is_error(self) -> bool {
        self.is_relative_error() || self == Index::Task
    }

    /// True when it is a length \[m\]: the RMS error of a predicted deflection.
    pub fn is_length(self) -> bool {
        matches!(self, Index::Task | Index::Prediction)
    }

    /// True when it is a relative error (fraction).
    pub fn is_relative_error(self) -> bool {
        matches!(
            self,
            Index::ExpectedError | Index::WorstJoint | Index::DropOne | Index::D
        )
    }

    /// The index from the logarithm that searches minimise (of its reciprocal
    /// for O1 to O5).
    pub fn of_log(self, log: f64) -> f64 {
        if self.larger_is_better() {
            (-log).exp()
        } else {
            log.exp()
        }
    }

    /// True when it has kinks and with them many local minima: a search for the
    /// best one may end elsewhere with another seed.
    pub fn has_many_local_minima(self) -> bool {
        !matches!(
            self,
            Index::ExpectedError
                | Index::D
                | Index::O1
                | Index::Task
                | Index::Prediction
                | Index::O5
        )
    }

    /// True when it needs the cell's tasks.
    pub fn needs_tasks(self) -> bool {
        self == Index::Task
    }

    /// True when it uses the observation matrix (all but the classical one).
    pub fn uses_observation(self) -> bool {
        self != Index::Classical
    }
}
