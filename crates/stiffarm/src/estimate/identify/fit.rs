//! One estimator applied to one experiment, with everything that a profile, a
//! diagnosis or the systematic errors go on from.

use super::assumptions::{Assumptions, Estimator};
use super::experiment::Experiment;
use super::labels::RowLabel;
use super::leave_out::{Fold, LeaveOneOut, fold_without, folds, influence};
use super::restricted::Restricted;
use super::solve::{Prepared, Solution};
use super::system::MeasuredSystem;
use super::{Estimates, Identification, IdentifyOptions, check, describe};
use crate::error::{Code, Error, Result};
use crate::measure::Measured;
use crate::model::cell::Cell;
use crate::model::measurement::MeasuredPosture;
use crate::model::observation::ExtraTerm;
use crate::numerics::control::{Control, Watch};
use crate::numerics::jobs::in_order_watched;
use nalgebra::{DMatrix, DVector};
use std::borrow::Cow;
use std::collections::BTreeSet;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// An experiment with the estimate of its unknowns.
///
/// What is asked of a fit twice is computed once: the system Ψ x = Δ, its
/// factors, the fits without single postures, the identification. A copy
/// shares all of it.
#[derive(Debug, Clone)]
pub struct Fit {
    inner: Arc<Inner>,
}

#[derive(Debug)]
struct Inner {
    experiment: Arc<Experiment>,
    options: IdentifyOptions,
    /// Displacements set aside: measured posture and number in it.
    left_out: BTreeSet<(usize, usize)>,
    system: Arc<MeasuredSystem>,
    prepared: Arc<Prepared>,
    assumed: Assumptions,
    /// Whitened displacements.
    white: DVector<f64>,
    solution: Solution,
    folds: OnceLock<Vec<Fold>>,
    identification: OnceLock<Identification>,
    /// Other options and parts of these displacements, as they were asked for.
    others: Mutex<Vec<Fit>>,
}

impl Fit {
    /// Fits the unknowns to measured displacements.
    ///
    /// ```
    /// # fn main() -> stiffarm::Result<()> {
    /// use stiffarm::{Fit, prepare, simulated_readings};
    /// use stiffarm_files::builtin;
    ///
    /// let cell = builtin::cell("comau")?;
    /// let postures = builtin::postures("comau-group1", &cell.setup.robot)?;
    /// let readings = simulated_readings(&cell, &postures, 1)?;
    /// let measured = prepare(&cell, readings, &Default::default())?;
    /// let fit = Fit::new(&cell, &measured, &Default::default())?;
    /// for joint in &fit.identification()?.estimates.joints {
    ///     println!("{joint}");
    /// }
    /// let left_out = fit.leave_one_out()?;
    /// assert_eq!(left_out.postures.len(), postures.len());
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// As [`identify`](super::identify()).
    pub fn new(cell: &Cell, measured: impl Into<Measured>, options: &IdentifyOptions) -> Result<Self> {
        Fit::watched(cell, measured, options, Watch::default())
    }

    /// [`Fit::new`], with everything that is asked of the fit later: once `watch`
    /// says so, it ends with [`Code::Interrupted`](crate::Code::Interrupted). What
    /// was computed before stays.
    ///
    /// # Errors
    /// As [`identify`](super::identify()); stopped.
    pub fn watched(
        cell: &Cell,
        measured: impl Into<Measured>,
        options: &IdentifyOptions,
        watch: Watch,
    ) -> Result<Self> {
        check(options)?;
        let is_lost = |term: &ExtraTerm| !term.is_spring();
        if cell.route.approach.is_some() && options.extra.iter().any(is_lost) {
            let message =
                "The cell says that postures are reached from the side of their load: no reading shows lost motion.";
            return Err(Error::new(Code::Conflict, message.to_string())
                .hint("leave the term out; or take [route] approach_deg out, if they were not"));
        }
        let experiment = Experiment::new(cell, measured.into())?.watched(watch);
        let other = experiment.showing(&options.extra)?;
        let experiment = Arc::new(other.unwrap_or(experiment));
        if experiment.measured.is_against_preload() && options.extra.iter().any(is_lost) {
            let message = "Every displacement is against a preload, and nothing was read unloaded before it: no \
                reading shows lost motion.";
            return Err(Error::new(Code::Conflict, message.to_string())
                .hint("leave the term out; or give the readings of the state unloaded too"));
        }
        let system = Arc::new(experiment.system(&options.extra, options.weights)?);
        let prepared = Arc::new(Prepared::new(&system, options.estimator)?);
        Fit::of(experiment, options, BTreeSet::new(), system, prepared)
    }

    fn of(
        experiment: Arc<Experiment>,
        options: &IdentifyOptions,
        left_out: BTreeSet<(usize, usize)>,
        system: Arc<MeasuredSystem>,
        prepared: Arc<Prepared>,
    ) -> Result<Self> {
        experiment.control().check()?;
        experiment.note(|| format!("fit {options:?} without {left_out:?}"));
        let assumed = experiment.assumptions(options)?;
        let white = prepared.whitened().whiten(&system.delta);
        let solution = prepared.solve_white(&white, &assumed)?;
        Ok(Fit {
            inner: Arc::new(Inner {
                experiment,
                options: options.clone(),
                left_out,
                system,
                prepared,
                assumed,
                white,
                solution,
                folds: OnceLock::new(),
                identification: OnceLock::new(),
                others: Mutex::default(),
            }),
        })
    }

    /// The same options for what another cell makes of the measurements.
    ///
    /// # Errors
    /// As [`identify`](super::identify()).
    pub(crate) fn at(&self, cell: &Cell, measured: Measured) -> Result<Self> {
        let watch = self.experiment().watch();
        Fit::watched(cell, measured, self.options(), watch)
    }

    /// The same displacements under other options; the posture terms, and where
    /// they do not depend on what changed the system and its factors, are used again.
    ///
    /// # Errors
    /// As [`identify`](super::identify()).
    pub fn with(&self, options: &IdentifyOptions) -> Result<Self> {
        let inner = &*self.inner;
        if *options == inner.options {
            return Ok(self.clone());
        }
        self.reused(options, &inner.left_out, || self.refitted(options))
    }

    /// The fit that was made before with `options` and `left_out`, else a new one.
    fn reused(
        &self,
        options: &IdentifyOptions,
        left_out: &BTreeSet<(usize, usize)>,
        make: impl FnOnce() -> Result<Fit>,
    ) -> Result<Fit> {
        let others = || {
            let others = self.inner.others.lock();
            others.unwrap_or_else(PoisonError::into_inner)
        };
        let same = |fit: &&Fit| fit.options() == options && fit.inner.left_out == *left_out;
        let fit = others().iter().find(same).cloned();
        if let Some(fit) = fit {
            return Ok(fit);
        }
        let made = make()?;
        others().push(made.clone());
        Ok(made)
    }

    fn refitted(&self, options: &IdentifyOptions) -> Result<Self> {
        let inner = &*self.inner;
        check(options)?;
        let left_out = inner.left_out.clone();
        // What is left out is known by its number among the displacements.
        let other = match left_out.is_empty() {
            true => inner.experiment.showing(&options.extra)?,
            false => None,
        };
        let experiment = other.map_or_else(|| inner.experiment.clone(), Arc::new);
        let before = &inner.options;
        if options.extra == before.extra && options.weights == before.weights {
            let plain = |o: &IdentifyOptions| o.estimator == Estimator::Ordinary;
            let prepared = if plain(options) == plain(before) {
                inner.prepared.clone()
            } else {
                Arc::new(Prepared::new(&inner.system, options.estimator)?)
            };
            return Fit::of(experiment, options, left_out, inner.system.clone(), prepared);
        }
        let whole = experiment.system(&options.extra, options.weights)?;
        let system = if left_out.is_empty() {
            whole
        } else {
            whole
                .filtered(|l| !left_out.contains(&(l.measured, l.displacement)))
                .ok_or_else(super::system::no_displacements)?
        };
        let prepared = Arc::new(Prepared::new(&system, options.estimator)?);
        Fit::of(experiment, options, left_out, Arc::new(system), prepared)
    }

    /// The same with one extra term, whose column of Ψ (rows as in the system)
    /// is given.
    pub(crate) fn with_term(&self, term: ExtraTerm, column: &DVector<f64>) -> Result<Self> {
        let inner = &*self.inner;
        let mut options = inner.options.clone();
        options.extra.push(term);
        let name = term.name(&self.cell().setup.robot);
        let system = inner.system.extended(term, name, column);
        let prepared = inner.prepared.extended(column)?;
        Fit::of(inner.experiment.clone(), &options, inner.left_out.clone(), Arc::new(system), Arc::new(prepared))
    }

    /// The same without the displacements for which `keep` fails; `None` where
    /// none is left.
    pub(crate) fn filtered(&self, keep: impl Fn(&RowLabel) -> bool) -> Result<Option<Self>> {
        let inner = &*self.inner;
        let Some(system) = inner.system.filtered(&keep) else {
            return Ok(None);
        };
        let mut left_out = inner.left_out.clone();
        let gone = inner.system.labels.iter().filter(|l| !keep(l));
        left_out.extend(gone.map(|l| (l.measured, l.displacement)));
        let make = || {
            let prepared = Arc::new(Prepared::new(&system, inner.options.estimator)?);
            let (experiment, left_out) = (inner.experiment.clone(), left_out.clone());
            Fit::of(experiment, &inner.options, left_out, Arc::new(system), prepared)
        };
        self.reused(&inner.options, &left_out, make).map(Some)
    }

    /// How the caller watches and stops what is asked of this fit.
    pub(crate) fn control(&self) -> Control<'_> {
        self.inner.experiment.control()
    }

    /// The cell, its noise with as many readings per displacement as were taken.
    pub fn cell(&self) -> &Cell {
        &self.inner.experiment.cell
    }

    /// What was measured.
    pub fn measured(&self) -> &Measured {
        &self.inner.experiment.measured
    }

    /// The options behind the fit.
    pub fn options(&self) -> &IdentifyOptions {
        &self.inner.options
    }

    /// The result in words and numbers.
    ///
    /// # Errors
    /// A decomposition that fails.
    pub fn identification(&self) -> Result<&Identification> {
        if let Some(identification) = self.inner.identification.get() {
            return Ok(identification);
        }
        let made = describe(self)?;
        Ok(self.inner.identification.get_or_init(|| made))
    }

    /// Leaves each posture out in turn.
    ///
    /// # Errors
    /// Fewer than two postures, or a decomposition that fails.
    pub fn leave_one_out(&self) -> Result<LeaveOneOut> {
        Ok(influence(self.system(), self.solution(), self.folds()?))
    }

    /// The fits without each posture in turn.
    ///
    /// # Errors
    /// As [`Fit::leave_one_out`].
    pub(crate) fn folds(&self) -> Result<&[Fold]> {
        if let Some(folds) = self.inner.folds.get() {
            return Ok(folds);
        }
        let made = self.new_folds(self.system().blocks.len())?;
        Ok(self.inner.folds.get_or_init(|| made))
    }

    /// Columns of Ψ of extra terms, rows as in the system.
    pub(crate) fn columns(&self, terms: &[ExtraTerm]) -> DMatrix<f64> {
        self.experiment().columns(self.system(), terms)
    }

    /// Values of the unknowns with what is known about them, without residuals.
    pub(crate) fn estimates(&self) -> Result<Estimates> {
        Estimates::new(self.cell(), self.system(), self.solution(), self.options())
    }

    /// The fits without each of `count` folds of postures.
    pub(crate) fn folds_of(&self, count: usize) -> Result<Cow<'_, [Fold]>> {
        if count == self.system().blocks.len() {
            self.folds().map(Cow::Borrowed)
        } else {
            self.new_folds(count).map(Cow::Owned)
        }
    }

    /// The fit without the postures of `left_out` (indices of blocks, ascending).
    pub(crate) fn fold_without(&self, left_out: Vec<usize>) -> Result<Fold> {
        let inner = &*self.inner;
        let count = inner.system.blocks.len();
        fold_without(left_out, count, &inner.prepared, &inner.white, &inner.assumed)
    }

    /// The fits without each of `lists` of postures (indices of blocks, ascending).
    pub(crate) fn folds_without(&self, lists: &[Vec<usize>]) -> Result<Vec<Fold>> {
        in_order_watched(lists, "leaving postures out", self.control(), |(_, list)| self.fold_without(list.clone()))
    }

    fn new_folds(&self, count: usize) -> Result<Vec<Fold>> {
        let inner = &*self.inner;
        inner.experiment.note(|| {
            let (options, left_out) = (&inner.options, &inner.left_out);
            format!("{count} folds {options:?} without {left_out:?}")
        });
        folds(&inner.prepared, &inner.white, &inner.assumed, count, self.control())
    }

    pub(crate) fn experiment(&self) -> &Experiment {
        &self.inner.experiment
    }

    pub(crate) fn postures(&self) -> &[MeasuredPosture] {
        self.inner.experiment.postures()
    }

    /// Ψ x = Δ.
    pub(crate) fn system(&self) -> &MeasuredSystem {
        &self.inner.system
    }

    /// What depends on Ψ only.
    pub(crate) fn prepared(&self) -> &Prepared {
        &self.inner.prepared
    }

    /// What was assumed.
    pub(crate) fn assumed(&self) -> &Assumptions {
        &self.inner.assumed
    }

    /// Whitened displacements.
    pub(crate) fn white(&self) -> &DVector<f64> {
        &self.inner.white
    }

    /// The restricted likelihood of the displacements.
    pub(super) fn likelihood(&self) -> Restricted<'_> {
        Restricted::new(self.prepared().whitened(), self.white())
    }

    /// −2 ln of the restricted likelihood at the estimate, up to a constant that all fits to as many displacements
    /// share.
    pub(crate) fn restricted_value(&self) -> f64 {
        self.likelihood().value(self.solution().gamma)
    }

    /// The estimate.
    pub(crate) fn solution(&self) -> &Solution {
        &self.inner.solution
    }

    /// What the fit leaves of the displacements, rows as in the system.
    pub(crate) fn residual(&self) -> DVector<f64> {
        &self.system().delta - &self.system().psi * &self.solution().values
    }

    /// What was computed for the experiment so far: tests see in it that nothing
    /// is done twice.
    #[doc(hidden)]
    pub fn journal(&self) -> Vec<String> {
        self.inner.experiment.journal()
    }
}
