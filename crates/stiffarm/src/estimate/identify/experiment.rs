//! What was measured with the model's terms at every posture and load: made
//! once, read by every fit to it.

use super::labels::RowLabel;
use super::system::{MeasuredSystem, assemble, no_displacements, states_by_posture};
use super::{Assumptions, IdentifyOptions, Weights, assumptions};
use crate::error::Result;
use crate::measure::Measured;
use crate::model::cell::Cell;
use crate::model::measurement::{MeasuredPosture, row_count};
use crate::model::observation::{ExtraTerm, PostureTerms};
use crate::numerics::control::{Control, Watch};
use nalgebra::{DMatrix, DVector};
use std::sync::Mutex;

/// One experiment: nothing of it depends on how the unknowns are estimated.
#[derive(Debug)]
pub(crate) struct Experiment {
    /// The cell, its noise with as many readings per displacement as were taken.
    pub(crate) cell: Cell,
    /// What was measured.
    pub(crate) measured: Measured,
    /// The model's terms of each measured posture; `None` where its posture has
    /// no displacement at all.
    terms: Vec<Option<PostureTerms>>,
    /// Indices of the measured postures, posture by posture.
    states: Vec<Vec<usize>>,
    /// What was computed, in order: tests read it to see that nothing is done twice.
    journal: Mutex<Vec<String>>,
    /// How the caller stops what is asked of a fit to it.
    watch: Watch,
}

/// Ψ x = Δ of an experiment by itself.
///
/// # Errors
/// No displacements, or as [`identify`](super::identify()).
pub fn measured_system(
    cell: &Cell,
    measured: impl Into<Measured>,
    extra: &[ExtraTerm],
    weights: Weights,
) -> Result<MeasuredSystem> {
    Experiment::new(cell, measured.into())?.system(extra, weights)
}

impl Experiment {
    /// Size of the largest force that was measured under \[N\], for what is saved.
    pub(crate) fn largest_force(&self) -> Option<f64> {
        let terms = self.terms.iter().flatten();
        let forces = terms.map(|terms| terms.wrench().force.norm());
        forces.reduce(f64::max)
    }

    /// Columns of Ψ of extra terms, rows as in `system`.
    pub(super) fn columns(&self, system: &MeasuredSystem, terms: &[ExtraTerm]) -> DMatrix<f64> {
        let mut out = DMatrix::zeros(system.delta.len(), terms.len());
        let mut of_posture: Option<(usize, Vec<DVector<f64>>)> = None;
        for label in &system.labels {
            if of_posture.as_ref().is_none_or(|(m, _)| *m != label.measured) {
                let posture_terms = self.terms(label.measured).into_iter();
                let columns =
                    posture_terms.flat_map(|posture_terms| terms.iter().map(|term| term.column(posture_terms)));
                of_posture = Some((label.measured, columns.collect()));
            }
            let (_, point) = self.behind(label);
            let columns = of_posture.iter().flat_map(|(_, columns)| columns);
            for (i, column) in columns.enumerate() {
                out.fixed_view_mut::<3, 1>(label.rows.start, i).copy_from(&column.fixed_rows::<3>(3 * point));
            }
        }
        out
    }

    /// Computes the terms of every posture and load.
    ///
    /// # Errors
    /// No displacements, or as [`PostureTerms::new`].
    pub(crate) fn new(cell: &Cell, measured: Measured) -> Result<Self> {
        if row_count(&measured.postures) == 0 {
            return Err(no_displacements());
        }
        let mut cell = cell.clone();
        cell.noise = measured.noise(&cell);
        Experiment::of(cell, measured)
    }

    /// The same where the noise of `cell` is that of the readings already.
    ///
    /// # Errors
    /// As [`PostureTerms::new`].
    pub(crate) fn of(cell: Cell, measured: Measured) -> Result<Self> {
        let states = states_by_posture(&measured.postures);
        let mut terms = vec![None; measured.postures.len()];
        for &m in states.iter().flatten() {
            let posture = &measured.postures[m];
            let wrench = posture.wrench.as_ref();
            let setup = cell.setup.of_state(&posture.state)?;
            terms[m] = Some(posture.terms(&setup, wrench)?);
        }
        let experiment =
            Experiment { cell, measured, terms, states, journal: Mutex::default(), watch: Watch::default() };
        experiment.note(|| "terms".to_string());
        Ok(experiment)
    }

    /// The experiment with the displacements that show these extra terms, where it does not have them
    /// ([`Measured::showing`]).
    ///
    /// # Errors
    /// As [`PostureTerms::new`].
    pub(crate) fn showing(&self, extra: &[ExtraTerm]) -> Result<Option<Self>> {
        let other = self.measured.showing(extra);
        let made = other.map(|measured| Experiment::of(self.cell.clone(), measured));
        Ok(made.transpose()?.map(|made| made.watched(self.watch.clone())))
    }

    /// The same, stopped as `watch` says.
    pub(crate) fn watched(mut self, watch: Watch) -> Self {
        self.watch = watch;
        self
    }

    /// The caller's watch.
    pub(crate) fn watch(&self) -> Watch {
        self.watch.clone()
    }

    /// How the caller watches and stops long work.
    pub(crate) fn control(&self) -> Control<'_> {
        self.watch.control()
    }

    /// The measured postures.
    pub(crate) fn postures(&self) -> &[MeasuredPosture] {
        &self.measured.postures
    }

    /// The terms of measured posture `m`.
    pub(crate) fn terms(&self, m: usize) -> Option<&PostureTerms> {
        self.terms[m].as_ref()
    }

    /// The measured postures that have terms.
    pub(crate) fn with_terms(&self) -> impl Iterator<Item = (&MeasuredPosture, &PostureTerms)> {
        let all = self.postures().iter().zip(&self.terms);
        all.filter_map(|(m, terms)| Some((m, terms.as_ref()?)))
    }

    /// Ψ x = Δ with the extra terms `extra`.
    ///
    /// # Errors
    /// A term that stands twice or that the robot cannot have, a point the tool
    /// does not have, a number that is not finite, or tracker weights without
    /// the tracker's model.
    pub(crate) fn system(&self, extra: &[ExtraTerm], weights: Weights) -> Result<MeasuredSystem> {
        self.note(|| format!("system {extra:?} {weights:?}"));
        let all = self.states.iter().map(|states| {
            let of_posture = states.iter().map(|&m| Some((m, self.terms(m)?)));
            of_posture.flatten().collect()
        });
        assemble(&self.cell, self.postures(), all, extra, weights)
    }

    /// What `options` make an estimator assume of this experiment.
    ///
    /// # Errors
    /// As [`assumptions`].
    pub(crate) fn assumptions(&self, options: &IdentifyOptions) -> Result<Assumptions> {
        let scatter = options.scatter.or(self.measured.scatter);
        assumptions(&self.cell, &IdentifyOptions { scatter, ..options.clone() })
    }

    /// The measured posture and the measuring point behind `label`.
    pub(crate) fn behind(&self, label: &RowLabel) -> (&MeasuredPosture, usize) {
        let posture = &self.postures()[label.measured];
        (posture, posture.displacements[label.displacement].point)
    }

    pub(crate) fn note(&self, entry: impl FnOnce() -> String) {
        // A journal that a panic elsewhere poisoned is of no use to anybody.
        if let Ok(mut journal) = self.journal.lock() {
            journal.push(entry());
        }
    }

    /// What was computed so far.
    pub(crate) fn journal(&self) -> Vec<String> {
        self.journal.lock().map(|j| j.clone()).unwrap_or_default()
    }
}
