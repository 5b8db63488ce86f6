//! One posture of a cell as a point of a design: its information, and where
//! within the bounds and limits tr(A·G(q)) is largest.

use super::climb::{Climb, FEASIBILITY, WATCH_DISTANCE};
use super::criterion::trace_of_product;
use super::design::{DesignSpace, Effort};
use super::readings::Readings;
use crate::error::{Code, Error, Result};
use crate::model::cell::Cell;
use crate::model::observation::{PostureTerms, check_angles};
use crate::numerics::control::Control;
use crate::numerics::jobs::in_order;
use crate::numerics::order::{order_by_number, sort_by_number};
use crate::numerics::streams::spread;
use crate::plan::active_limits::ActiveLimits;
use crate::plan::index::prediction::PredictionFunction;
use nalgebra::DMatrix;

/// Longest sequence of `sobol_burley`.
const MAX_DRAWS: u32 = 1 << 16;
/// Draws that one parallel job makes.
const DRAWS_PER_JOB: u32 = 512;
/// Draws per wanted sample before postures outside the limits fill up.
const DRAWS_PER_SAMPLE: usize = 32;
/// Searches start at least this far apart, as a share of the bounds' diagonal.
const START_DISTANCE: f64 = 0.12;

struct Sample {
    q: Vec<f64>,
    information: DMatrix<f64>,
}

/// The feasible postures of a cell as a [`DesignSpace`]: controller angles
/// \[rad\] within `cell.bounds` and `cell.limits`; n unknowns are the relative
/// joint stiffnesses, G = K⁻¹ΨᵀPΨK⁻¹ with the cell's prior K (1 without) and P the
/// precision of a posture with its common shift, in units of 1/σ².
///
/// [`maximise`](DesignSpace::maximise) climbs to local maxima from a fixed
/// low-discrepancy set of postures: from the best few that lie apart for
/// [`Effort::Improve`], from all of them for [`Effort::Verify`]. It is a
/// multi-start search: nothing proves that the largest of the local maxima is
/// the global one. Searches keep 5e-10 m off the limits.
pub struct PostureSpace<'a> {
    cell: &'a Cell,
    readings: Readings,
    searches: usize,
    samples: Vec<Sample>,
    /// Postures outside the limits to search from where too few lie inside.
    fill: Vec<Vec<f64>>,
    /// Ends every climb where it is.
    control: Control<'a>,
}

impl<'a> PostureSpace<'a> {
    /// Samples the postures of `cell`: `samples` of them for the widest search,
    /// feasible ones as far as there are any; a narrow one starts from
    /// `searches` of them.
    ///
    /// # Errors
    /// The prior does not fit the cell, its load is only known by measurement, or its
    /// bounds are reversed or not finite; no samples.
    pub fn new(cell: &'a Cell, samples: usize, searches: usize) -> Result<Self> {
        let robot = &cell.setup.robot;
        // Without a prior the unknowns are the compliances themselves.
        let plain = vec![1.0; robot.spring_count()];
        let prior = cell.prior.as_deref().unwrap_or(&plain);
        if samples == 0 || searches == 0 {
            return Err(Error::invalid("A bound needs at least one sample and one search."));
        }
        if prior.len() != robot.spring_count() || cell.bounds.len() != robot.joint_count() {
            return Err(Error::new(
                Code::Dimension,
                "The prior stiffness and the bounds must have one entry per joint.",
            ));
        }
        if prior.iter().any(|k| !(k.is_finite() && *k > 0.0)) {
            return Err(Error::invalid("A prior stiffness must be above zero."));
        }
        let bad = |b: &[f64; 2]| !(b[0].is_finite() && b[1].is_finite() && b[0] <= b[1]);
        if let Some(j) = cell.bounds.iter().position(bad) {
            return Err(Error::invalid(format!(
                "The bounds of {} are reversed or not finite.",
                robot.joints()[j].name
            )));
        }
        let compliance = prior.iter().map(|k| 1.0 / k).collect();
        PostureSpace::of(cell, Readings::of_joints(cell, compliance)?, samples, searches)
    }

    /// The same about the unknowns of the index prediction.
    ///
    /// # Errors
    /// As [`PredictionFunction::new`]; limits that cannot be evaluated.
    pub(super) fn predicting(
        cell: &'a Cell,
        function: PredictionFunction,
        samples: usize,
        searches: usize,
    ) -> Result<Self> {
        let readings = Readings::Prediction(Box::new(function));
        PostureSpace::of(cell, readings, samples, searches)
    }

    fn of(cell: &'a Cell, readings: Readings, samples: usize, searches: usize) -> Result<Self> {
        let mut space = PostureSpace {
            cell,
            readings,
            searches,
            samples: Vec::new(),
            fill: Vec::new(),
            control: Control::default(),
        };
        (space.samples, space.fill) = space.draw(samples)?;
        Ok(space)
    }

    /// The same, whose climbs a stop of `control` ends wherever they are: what they say then is no bound.
    pub(super) fn until(self, control: Control<'a>) -> Self {
        PostureSpace { control, ..self }
    }

    /// The cell.
    pub fn cell(&self) -> &'a Cell {
        self.cell
    }

    /// True where the information is over σ² already.
    pub(super) fn knows_noise(&self) -> bool {
        matches!(self.readings, Readings::Prediction(_))
    }

    /// The first `count` sampled feasible postures, controller angles \[rad\].
    pub fn samples(&self, count: usize) -> Vec<Vec<f64>> {
        let first = self.samples.iter().take(count);
        first.map(|s| s.q.clone()).collect()
    }

    /// True when a posture lies within the bounds and the limits, to 1e-9 rad and m.
    ///
    /// # Errors
    /// Angles of the wrong length or not finite.
    pub fn contains(&self, q: &[f64]) -> Result<bool> {
        check_angles(&self.cell.setup.robot, q)?;
        let inside =
            q.iter().zip(&self.cell.bounds).all(|(q, b)| (b[0] - FEASIBILITY..=b[1] + FEASIBILITY).contains(q));
        let mut limits = ActiveLimits::new(self.cell, WATCH_DISTANCE)?;
        Ok(inside && limits.violation_at(q) <= FEASIBILITY)
    }

    /// A low-discrepancy set of feasible postures and, where they are fewer
    /// than wanted, postures outside the limits; drawn job by job so that the
    /// number of threads changes nothing.
    fn draw(&self, wanted: usize) -> Result<(Vec<Sample>, Vec<Vec<f64>>)> {
        let draws = wanted.saturating_mul(DRAWS_PER_SAMPLE).min(MAX_DRAWS as usize) as u32;
        let jobs: Vec<u32> = (0..draws.div_ceil(DRAWS_PER_JOB)).collect();
        let (mut inside, mut outside) = (Vec::new(), Vec::new());
        // A few jobs at a time: without limits the first ones are enough.
        for some in jobs.chunks(wanted.div_ceil(DRAWS_PER_JOB as usize)) {
            let drawn = in_order(some, |(_, job): (usize, &u32)| {
                let mut limits = ActiveLimits::new(self.cell, WATCH_DISTANCE)?;
                let range = job * DRAWS_PER_JOB..((job + 1) * DRAWS_PER_JOB).min(draws);
                Ok(range.map(|i| self.sample(i, &mut limits)).collect::<Vec<_>>())
            })?;
            for (q, information) in drawn.into_iter().flatten() {
                match information {
                    Some(information) if inside.len() < wanted => {
                        inside.push(Sample { q, information });
                    }
                    None if outside.len() < wanted => outside.push(q),
                    _ => {}
                }
            }
            if inside.len() == wanted {
                break;
            }
        }
        outside.truncate(wanted - inside.len());
        Ok((inside, outside))
    }

    /// Posture `index` of the sequence, with its information if it is feasible.
    fn sample(&self, index: u32, limits: &mut ActiveLimits<'_>) -> (Vec<f64>, Option<DMatrix<f64>>) {
        let q = spread(&self.cell.bounds, index);
        if !limits.meets_all(&q) {
            return (q, None);
        }
        let information = self.readings.information(&self.cell.setup.robot, limits.terms());
        let finite = information.iter().all(|v| v.is_finite());
        (q, finite.then_some(information))
    }

    /// The best samples that lie apart, best first.
    fn best_samples(&self, adjoint: &DMatrix<f64>) -> Vec<Vec<f64>> {
        let values: Vec<f64> = self.samples.iter().map(|s| trace_of_product(adjoint, &s.information)).collect();
        let order = order_by_number(values.len(), |i| -values[i]);
        let diagonal = (self.cell.bounds.len() as f64).sqrt();
        let apart = |a: &[f64], b: &[f64]| {
            let square: f64 = a
                .iter()
                .zip(b)
                .zip(&self.cell.bounds)
                .map(|((a, b), w)| ((a - b) / (w[1] - w[0]).max(f64::MIN_POSITIVE)).powi(2))
                .sum();
            square.sqrt() > START_DISTANCE * diagonal
        };
        let mut chosen: Vec<Vec<f64>> = Vec::new();
        for i in order {
            if chosen.len() == self.searches {
                break;
            }
            let q = &self.samples[i].q;
            if chosen.iter().all(|c| apart(c, q)) {
                chosen.push(q.clone());
            }
        }
        chosen
    }
}

impl DesignSpace for PostureSpace<'_> {
    fn unknowns(&self) -> usize {
        self.readings.unknowns()
    }

    fn information(&self, point: &[f64]) -> DMatrix<f64> {
        let under = |setup| PostureTerms::new(setup, point, None);
        match self.cell.setup.cases().iter().map(under).collect::<Result<Vec<_>>>() {
            Ok(terms) => self.readings.information(&self.cell.setup.robot, terms.iter()),
            // Whoever takes postures from outside refuses these.
            Err(_) => DMatrix::from_element(self.unknowns(), self.unknowns(), f64::NAN),
        }
    }

    fn maximise(&self, adjoint: &DMatrix<f64>, starts: &[Vec<f64>], effort: Effort) -> Vec<(Vec<f64>, f64)> {
        let mut from = match effort {
            Effort::Improve => self.best_samples(adjoint),
            // A high value at the start says little about the value at the end.
            Effort::Verify => [self.samples(self.samples.len()), self.fill.clone()].concat(),
        };
        from.extend(starts.iter().cloned());
        let scale = self.samples.iter().map(|s| trace_of_product(adjoint, &s.information)).fold(0.0, f64::max);
        let maxima = in_order(&from, |(_, start): (usize, &Vec<f64>)| {
            let scale = if scale > 0.0 { scale } else { 1.0 };
            Climb::new(self.cell, &self.readings, adjoint, scale)?.run(start, self.control)
        });
        // The load was checked when the space was made.
        let mut maxima = maxima.unwrap_or_default();
        maxima.retain(|(_, value)| value.is_finite());
        sort_by_number(&mut maxima, |a| -a.1);
        maxima
    }

    fn unknown_name(&self, unknown: usize) -> String {
        let mut names = self.cell.setup.robot.spring_names();
        // Of what gives way besides something is known without a reading.
        if unknown < names.len() { names.swap_remove(unknown) } else { "what gives way beyond the axes".to_string() }
    }
}
