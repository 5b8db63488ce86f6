//! The limits of a cell as constraints of a local search: only those that matter.
//!
//! A search has the limits near its start as constraints. Those that it crossed
//! all the same join them, and it goes on: an active set that only grows.
//!
//! Limits join when they matter. A six-posture group has 276 limits; a search
//! watches those within 0.5 m and adds the ones it crosses. This halves the
//! time of a selection.

use crate::error::{Code, Error, Result};
use crate::model::cell::{Cell, PostureMargins, Slopes};
use crate::model::observation::PostureTerms;
use crate::numerics::control::{Control, Termination};
use crate::numerics::optimise::{Evaluation, Minimum, Options, Problem, minimise};

/// Margin kept from hard limits so that rounding never crosses them \[m\].
pub(super) const LIMIT_GUARD: f64 = 5e-10;
/// The same of the scene's margins, which have kinks at which a search ends less exactly \[m, rad\].
const SCENE_GUARD: f64 = 1e-5;

/// Of the scene's margins, which are many, those nearer than this are watched from the start \[m\];
/// by how much others are farther is not asked.
const SCENE_DISTANCE: f64 = 0.1;

/// The limits that are constraints now, of one posture or of several.
pub(super) struct ActiveLimits<'a> {
    cell: &'a Cell,
    margins: PostureMargins<'a>,
    /// Limits nearer than this become constraints \[m\].
    distance: f64,
    per_posture: usize,
    /// Whether each limit is a constraint, posture by posture.
    active: Vec<bool>,
    values: Vec<f64>,
    gradients: Vec<f64>,
}

impl<'a> ActiveLimits<'a> {
    /// No limit is active yet; those nearer than `distance` \[m\] will be.
    ///
    /// # Errors
    /// Bounds that do not fit the robot or are not finite.
    pub(super) fn new(cell: &'a Cell, distance: f64) -> Result<Self> {
        let margins = cell.posture_margins()?.remembering();
        let per_posture = margins.count();
        Ok(ActiveLimits {
            cell,
            margins,
            distance,
            per_posture,
            active: Vec::new(),
            values: vec![0.0; per_posture],
            gradients: vec![0.0; per_posture * cell.bounds.len()],
        })
    }

    /// Makes all limits inactive.
    pub(super) fn forget(&mut self) {
        self.active.clear();
    }

    /// Number of active limits.
    pub(super) fn count(&self) -> usize {
        self.active.iter().filter(|active| **active).count()
    }

    /// The posture looked at last, load by load.
    pub(super) fn terms(&self) -> impl Iterator<Item = &PostureTerms> {
        self.margins.terms()
    }

    /// Whether the posture `q` meets every limit, those that are not active too.
    pub(super) fn meets_all(&mut self, q: &[f64]) -> bool {
        self.margins.least(q).is_ok_and(|least| least >= 0.0)
    }

    /// Largest violation of a limit by the posture `q` \[m\], 0 when all are met;
    /// infinite where there is no wrench.
    pub(super) fn violation_at(&mut self, q: &[f64]) -> f64 {
        let margins = &mut self.margins;
        if margins.evaluate(q, SCENE_DISTANCE, &mut self.values, Slopes::default()).is_err() {
            return f64::INFINITY;
        }
        self.values.iter().fold(0.0, |v, m| v.max(-m))
    }

    /// Adds the limits that the postures of `angles` \[rad\] come near to or cross.
    pub(super) fn watch(&mut self, angles: &[f64]) {
        if self.per_posture == 0 {
            return;
        }
        let n = self.cell.bounds.len();
        self.active.resize(angles.len() / n * self.per_posture, false);
        for (p, q) in angles.chunks_exact(n).enumerate() {
            self.violation_at(q);
            let active = &mut self.active[p * self.per_posture..];
            for (l, (active, margin)) in active.iter_mut().zip(&self.values).enumerate() {
                let within =
                    if self.margins.is_of_point(l) { self.distance } else { SCENE_DISTANCE.min(self.distance) };
                *active |= *margin < within;
            }
        }
    }

    /// Writes the margins of the active limits at the postures of `angles`
    /// \[rad\] behind the first `before` ones, and the violation of all limits.
    /// The angles are the first of the problem's `variables`.
    pub(super) fn add_to(&mut self, out: &mut Evaluation, angles: &[f64], before: usize, variables: usize) {
        if self.per_posture == 0 {
            return;
        }
        let robot = &self.cell.setup.robot;
        let n = self.cell.bounds.len();
        let mut at = before;
        for (p, q) in angles.chunks_exact(n).enumerate() {
            let range = p * self.per_posture..(p + 1) * self.per_posture;
            let wanted = self.active.get(range).unwrap_or_default();
            let slopes = Slopes { rows: &mut self.gradients[..wanted.len() * n], wanted };
            let margins = &mut self.margins;
            if margins.evaluate(q, SCENE_DISTANCE, &mut self.values, slopes).is_err() {
                out.violation = f64::INFINITY;
                return;
            }
            for margin in &self.values {
                out.violation = out.violation.max(-margin);
            }
            for (l, _) in wanted.iter().enumerate().filter(|(_, active)| **active) {
                let guard = if self.margins.is_of_point(l) { LIMIT_GUARD } else { SCENE_GUARD };
                out.margins[at] = self.values[l] - guard;
                let offset = at * variables + p * n;
                robot.gradient_to_controller(
                    &self.gradients[l * n..(l + 1) * n],
                    &mut out.margin_gradients[offset..offset + n],
                );
                at += 1;
            }
        }
    }
}

/// A problem whose last margins are those of active limits.
pub(super) trait LimitedProblem<'a>: Problem {
    /// Its limits, and how many of its variables are angles: the first ones.
    fn limits(&mut self) -> (&mut ActiveLimits<'a>, usize);
}

/// Minimises `problem` from the best of an earlier search, or from `start`, in
/// at most `rounds` rounds of searching and adding the limits that were crossed.
/// `budget` is what a round may use after the iterations done before it.
pub(super) fn minimise_within_limits<'a>(
    problem: &mut impl LimitedProblem<'a>,
    start: &[f64],
    earlier: Option<Minimum>,
    rounds: usize,
    budget: impl Fn(u64) -> Options,
    control: Control<'_>,
) -> Result<Minimum> {
    let mut solution = earlier;
    let mut from = solution.as_ref().map_or(start.to_vec(), |s| s.x.clone());
    let mut last = from.clone();
    problem.limits().0.forget();
    for _ in 0..rounds {
        let (limits, angles) = problem.limits();
        limits.watch(&from[..angles]);
        limits.watch(&last[..angles]);
        let options = budget(solution.as_ref().map_or(0, |s| s.iterations));
        let next = minimise(problem, &from, options, control);
        let outside = next.last_violation > options.feasibility;
        let done = !outside || next.termination == Termination::Interrupted || next.iterations == 0;
        last.clone_from(&next.last);
        // Go on from the best point inside all limits, if there is one: a
        // search from outside may never come back in.
        from = if next.merit.is_finite() { next.x.clone() } else { next.last.clone() };
        solution = Some(match solution {
            Some(previous) => next.after(previous),
            None => next,
        });
        if done {
            break;
        }
    }
    solution.ok_or_else(|| Error::new(Code::Internal, "A search without a round."))
}
