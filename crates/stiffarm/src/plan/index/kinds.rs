//! The indices by name.

use super::facts::{FACTS, Facts, Kind};
pub use super::facts::{Index, Origin};
use crate::error::{Code, Error, Result, did_you_mean};
use crate::model::cell::Cell;

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
        Index::ALL.into_iter().find(|i| i.as_str() == wanted).ok_or_else(|| {
            let hint = did_you_mean(&wanted, Index::ALL.map(Index::as_str))
                .unwrap_or_else(|| format!("known indices: {}", Index::ALL.map(Index::as_str).join(", ")));
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
        if self.larger_is_better() { (-log).exp() } else { log.exp() }
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
