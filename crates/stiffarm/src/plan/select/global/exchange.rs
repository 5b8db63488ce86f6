//! Candidates of the pool judged by information matrices alone.

use super::pool::Pool;
use crate::plan::index::Index;
use crate::plan::index::criterion::Criterion;
use crate::plan::index::inputs::FixedPostures;
use crate::plan::select::exchange::Judge;

/// What the postures of a group are chosen beside.
#[derive(Debug, Clone)]
pub(super) struct Base {
    /// Information of the given postures, packed; empty where the index has none.
    pub information: Vec<f64>,
    /// Largest ln k(J_N) of the given postures, −∞ without.
    pub log_dexterity: f64,
    /// True when the index counts the largest k(J_N).
    pub uses_dexterity: bool,
}

impl Base {
    /// What `fixed_postures` bring to an index; `triangle` entries of information.
    pub fn new(index: Index, fixed_postures: &FixedPostures, triangle: usize) -> Self {
        let size = if index.uses_observation() { triangle } else { 0 };
        let mut information = vec![0.0; size];
        fixed_postures.add_information(&mut information);
        Base { information, log_dexterity: fixed_postures.log_dexterity, uses_dexterity: index.uses_dexterity() }
    }
}

/// Candidates of a pool beside what is given.
pub(super) struct PoolJudge<'a> {
    pub criterion: &'a mut Criterion,
    pub base: &'a Base,
    pub pool: &'a Pool,
    rest: Vec<f64>,
    total: Vec<f64>,
    dexterity: f64,
}

impl<'a> PoolJudge<'a> {
    pub fn new(criterion: &'a mut Criterion, base: &'a Base, pool: &'a Pool) -> Self {
        PoolJudge {
            criterion,
            rest: base.information.clone(),
            total: base.information.clone(),
            dexterity: base.log_dexterity,
            base,
            pool,
        }
    }
}

impl Judge for PoolJudge<'_> {
    fn hold(&mut self, rest: &[usize]) {
        self.rest.copy_from_slice(&self.base.information);
        self.dexterity = self.base.log_dexterity;
        for at in rest {
            for (sum, v) in self.rest.iter_mut().zip(self.pool.information(*at)) {
                *sum += v;
            }
            self.dexterity = self.dexterity.max(self.pool.log_dexterity(*at));
        }
    }

    fn with(&mut self, candidate: usize) -> f64 {
        let mut value = 0.0;
        if !self.total.is_empty() {
            let information = self.pool.information(candidate);
            for ((total, rest), v) in self.total.iter_mut().zip(&self.rest).zip(information) {
                *total = rest + v;
            }
            value = self.criterion.value(&self.total);
        }
        if self.base.uses_dexterity {
            value += self.dexterity.max(self.pool.log_dexterity(candidate));
        }
        value
    }
}
