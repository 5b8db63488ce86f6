//! What is said and asked of each index, beside its mathematics.

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
pub(super) enum Kind {
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
pub(super) struct Facts {
    pub index: Index,
    pub name: &'static str,
    pub meaning: &'static str,
    pub says: &'static str,
    pub origin: Origin,
    pub kind: Kind,
    /// Whether it has kinks.
    pub has_kinks: bool,
    pub has_extreme_singular_values: bool,
    pub uses_dexterity: bool,
    pub needs_prior: bool,
}

const fn facts(index: Index, name: &'static str, meaning: &'static str, says: &'static str) -> Facts {
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
pub(super) const FACTS: [Facts; 16] = [
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
            "With any one posture lost, the joint stiffness can still be expected with a relative standard error (RMS \
             over the joints) of ",
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
        ..facts(Index::O2, "o2", "smallest over largest singular value; larger is better", OBSERVABILITY)
    },
    Facts {
        origin: Origin::Literature,
        kind: Kind::Observability,
        has_extreme_singular_values: true,
        ..facts(Index::O3, "o3", "smallest singular value; larger is better", OBSERVABILITY)
    },
    Facts {
        origin: Origin::Literature,
        kind: Kind::Observability,
        has_extreme_singular_values: true,
        ..facts(Index::O4, "o4", "its square over the largest one; larger is better", OBSERVABILITY)
    },
    Facts {
        origin: Origin::Literature,
        kind: Kind::Observability,
        has_kinks: false,
        ..facts(Index::O5, "o5", "one over the sum of their inverses; larger is better", OBSERVABILITY)
    },
];
