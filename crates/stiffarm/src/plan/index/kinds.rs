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

/// What the value of an index is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// A pure number, smaller is better.
    Number,
    /// A pure number or a length of singular values, larger is better.
    Observability,
    /// A relative error of the stiffness (fraction).
    RelativeError,
    /// An RMS error of a deflection \[m\].
    Deflection,
}

/// Where an index comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Origin {
    /// This library.
    Here,
    /// The paper that it begins with.
    Paper,
    /// The literature on observability.
    Literature,
}

/// All that is said and asked of an index, beside its mathematics.
struct Facts {
    index: Index,
    name: &'static str,
    meaning: &'static str,
    says: &'static str,
    origin: Origin,
    kind: Kind,
    /// Whether it has kinks.
    has_kinks: bool,
    has_extreme_singular_values: bool,
    uses_dexterity: bool,
    needs_prior: bool,
}

const fn facts(
    index: Index,
    name: &'static str,
    meaning: &'static str,
    says: &'static str,
) -> Facts {
    Facts {
        index,
        name,
        meaning,
        says,
        origin: Origin::Here,
        kind: Kind::Number,
        has_kinks: true,
        has_extreme_singular_values: false,
        uses_dexterity: false,
        needs_prior: false,
    }
}

const OBSERVABILITY: &str = "The observability index (larger is better) is ";

/// One row of each, in the order of the enum.
const FACTS: [Facts; 16] = [
    Facts {
        origin: Origin::Paper,
        uses_dexterity: true,
        ..facts(
            Index::Classical,
            "classical",
            "largest k(J_N), the Jacobian's condition number, of a posture",
            "The classical index, max k(J_N), is ",
        )
    },
    Facts {
        origin: Origin::Paper,
        has_extreme_singular_values: true,
        ..facts(
            Index::Condition,
            "condition",
            "condition number of the observation matrix",
            "The condition number of the observation matrix is ",
        )
    },
    Facts {
        origin: Origin::Paper,
        has_extreme_singular_values: true,
        uses_dexterity: true,
        ..facts(
            Index::Novel,
            "novel",
            "classical times condition, the paper's index",
            "The paper's novel index, max k(J_N) × cond(Ψ), is ",
        )
    },
    Facts {
        has_extreme_singular_values: true,
        needs_prior: true,
        ..facts(
            Index::ScaledCondition,
            "scaled_condition",
            "condition number for relative accuracy",
            "The condition number scaled by the prior stiffness is ",
        )
    },
    Facts {
        has_extreme_singular_values: true,
        uses_dexterity: true,
        needs_prior: true,
        ..facts(
            Index::Scaled,
            "scaled",
            "classical times scaled condition",
            "The scaled index, max k(J_N) × cond(Ψ·diag(1/k)), is ",
        )
    },
    Facts {
        kind: Kind::RelativeError,
        has_kinks: false,
        needs_prior: true,
        ..facts(
            Index::ExpectedError,
            "expected_error",
            "relative standard error of the stiffness, RMS over the joints",
            "The joint stiffness can be expected with a relative standard error (RMS over the joints) of ",
        )
    },
    Facts {
        kind: Kind::RelativeError,
        needs_prior: true,
        ..facts(
            Index::WorstJoint,
            "worst_joint",
            "relative standard error of the worst joint",
            "The joint that comes out worst can be expected with a relative standard error of ",
        )
    },
    Facts {
        kind: Kind::RelativeError,
        needs_prior: true,
        ..facts(
            Index::DropOne,
            "drop_one",
            "expected error once the most needed posture is lost",
            "With any one posture lost, the joint stiffness can still be expected with a relative standard error (RMS over the joints) of ",
        )
    },
    Facts {
        kind: Kind::RelativeError,
        has_kinks: false,
        needs_prior: true,
        ..facts(
            Index::D,
            "d",
            "size of the relative error ellipsoid",
            "The relative errors of all joints together (geometric mean of their ellipsoid) can be expected as ",
        )
    },
    Facts {
        kind: Kind::Deflection,
        has_kinks: false,
        ..facts(
            Index::Task,
            "task",
            "error of the deflection predicted at the tasks",
            "The deflection at the cell's tasks can be expected to be predicted with an RMS error of ",
        )
    },
    Facts {
        kind: Kind::Deflection,
        has_kinks: false,
        needs_prior: true,
        ..facts(
            Index::Prediction,
            "prediction",
            "error of the deflection predicted at work, under the mixed elastic model",
            "The deflection of the tip at work can be expected to be predicted with an RMS error of ",
        )
    },
    Facts {
        origin: Origin::Literature,
        kind: Kind::Observability,
        has_kinks: false,
        ..facts(
            Index::O1,
            "o1",
            "geometric mean of the singular values, over √postures; larger is better",
            OBSERVABILITY,
        )
    },
    Facts {
        origin: Origin::Literature,
        kind: Kind::Observability,
        has_extreme_singular_values: true,
        ..facts(
            Index::O2,
            "o2",
            "smallest over largest singular value; larger is better",
            OBSERVABILITY,
        )
    },
    Facts {
        origin: Origin::Literature,
        kind: Kind::Observability,
        has_extreme_singular_values: true,
        ..facts(
            Index::O3,
            "o3",
            "smallest singular value; larger is better",
            OBSERVABILITY,
        )
    },
    Facts {
        origin: Origin::Literature,
        kind: Kind::Observability,
        has_extreme_singular_values: true,
        ..facts(
            Index::O4,
            "o4",
            "its square over the largest one; larger is better",
            OBSERVABILITY,
        )
    },
    Facts {
        origin: Origin::Literature,
        kind: Kind::Observability,
        has_kinks: false,
        ..facts(
            Index::O5,
            "o5",
            "one over the sum of their inverses; larger is better",
            OBSERVABILITY,
        )
    },
];

impl Index {
    /// Every index.
    pub const ALL: [Index; FACTS.len()] = {
        let mut all = [Index::Classical; FACTS.len()];
        let mut i = 0;
        while i < FACTS.len() {
            all[i] = FACTS[i].index;
            // Its row is found by its place.
            assert!(all[i] as usize == i);
            i += 1;
        }
        all
    };

    fn facts(self) -> &'static Facts {
        &FACTS[self as usize]
    }

    /// What it is, in few words for tables; lower is better unless they say otherwise.
    pub fn meaning(self) -> &'static str {
        self.facts().meaning
    }

    /// What it says of a plan, as the beginning of a sentence that its value ends.
    pub fn says(self) -> &'static str {
        self.facts().says
    }

    /// Name in words: `expected error`.
    pub fn in_words(self) -> String {
        self.facts().name.replace('_', " ")
    }

    /// The unit that people read it in, empty for a pure number, and the factor to that.
    pub fn shown_in(self) -> (&'static str, f64) {
        match self.facts().kind {
            Kind::RelativeError => ("%", 100.0),
            Kind::Deflection => ("mm", 1e3),
            Kind::Number | Kind::Observability => ("", 1.0),
        }
    }

    /// Where it comes from.
    pub fn origin(self) -> Origin {
        self.facts().origin
    }

    /// Name in JSON.
    pub fn as_str(self) -> &'static str {
        self.facts().name
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
        self.facts().kind == Kind::Observability
    }

    /// True when it rests on the largest or smallest singular value.
    pub(crate) fn has_extreme_singular_values(self) -> bool {
        self.facts().has_extreme_singular_values
    }

    /// True when it uses k(J_N) and with it the characteristic length.
    pub fn uses_dexterity(self) -> bool {
        self.facts().uses_dexterity
    }

    /// True when it needs a prior joint stiffness.
    pub fn needs_prior(self) -> bool {
        self.facts().needs_prior
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
        self.facts().kind == Kind::Deflection
    }

    /// True when it is a relative error (fraction).
    pub fn is_relative_error(self) -> bool {
        self.facts().kind == Kind::RelativeError
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
        self.facts().has_kinks
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
