//! A plan and the bounds on it.

use super::continuous::optimal_design;
use super::criterion::Criterion;
use super::design::{ContinuousDesign, DesignOptions, DesignSpace};
use super::space::PostureSpace;
use super::{Certificate, CertificateOptions, SupportPosture};
use crate::error::{Code, Error, Result};
use crate::model::cell::Cell;
use crate::model::observation::check_angles;
use crate::numerics::control::Control;
use crate::plan::index::{Index, evaluate_for};
use nalgebra::DMatrix;

/// Sampled postures a continuous design starts from.
const STARTS: usize = 64;
/// A plan with all that its bounds share.
pub(super) struct Plan<'a> {
    space: PostureSpace<'a>,
    options: DesignOptions,
    postures: usize,
    /// Postures outside bounds or limits, counted from 1.
    outside: Vec<usize>,
    /// Points that every design starts from: the plan's own and some samples.
    starts: Vec<Vec<f64>>,
    /// Information of the measured postures per posture of the plan, n × n.
    prior_information: DMatrix<f64>,
}

impl<'a> Plan<'a> {
    pub(super) fn new<Q: AsRef<[f64]>>(
        cell: &'a Cell,
        measured: &[Q],
        postures: &[Q],
        options: &CertificateOptions,
        until: Control<'a>,
    ) -> Result<Self> {
        let space = PostureSpace::new(cell, options.samples, options.searches)?.until(until);
        Plan::of(space, measured, postures, options)
    }

    pub(super) fn of<Q: AsRef<[f64]>>(
        space: PostureSpace<'a>,
        measured: &[Q],
        postures: &[Q],
        options: &CertificateOptions,
    ) -> Result<Self> {
        if postures.is_empty() {
            return Err(Error::new(Code::TooFewData, "The plan has no postures, so there is nothing to bound."));
        }
        for q in measured {
            check_angles(&space.cell().setup.robot, q.as_ref())?;
        }
        let mut outside = Vec::new();
        let mut starts = Vec::new();
        for (i, q) in postures.iter().enumerate() {
            if space.contains(q.as_ref())? { starts.push(q.as_ref().to_vec()) } else { outside.push(i + 1) }
        }
        starts.extend(space.samples(STARTS));
        if starts.is_empty() {
            let message = "No sampled posture within the bounds meets the cell's limits, so there is no bound.";
            return Err(Error::invalid(message)
                .key("limits")
                .hint("check the limits' frame (robot base) and unit (mm)"));
        }
        let n = space.unknowns();
        // What is known without a reading of what gives way beyond the axes.
        let fixed = space.cell().setup.robot.spring_count();
        let prior = |i: usize, j: usize| f64::from(u8::from(i == j && i >= fixed));
        let mut prior_information = DMatrix::from_fn(n, n, prior);
        for q in measured {
            prior_information += space.information(q.as_ref());
        }
        Ok(Plan {
            prior_information: prior_information / postures.len() as f64,
            postures: postures.len(),
            options: DesignOptions { tolerance: options.tolerance, max_rounds: options.max_rounds },
            space,
            outside,
            starts,
        })
    }

    pub(super) fn design(
        &self,
        criterion: &Criterion,
        more: &[Vec<f64>],
        control: Control<'_>,
    ) -> Result<ContinuousDesign> {
        let starts = [self.starts.as_slice(), more].concat();
        optimal_design(&self.space, criterion, Some(&self.prior_information), &starts, self.options, control)
    }

    pub(super) fn certificate<Q: AsRef<[f64]>>(
        self,
        index: Index,
        criterion: &Criterion,
        measured: &[Q],
        postures: &[Q],
        control: Control<'_>,
    ) -> Result<Certificate> {
        let design = self.design(criterion, &[], control)?;
        let all: Vec<&[f64]> = measured.iter().chain(postures).map(AsRef::as_ref).collect();
        let evaluation = evaluate_for(self.space.cell(), index.as_str(), &all, Some(index))?;
        let value = evaluation.indices.get(index);
        let bound = self.bound(&design);
        Ok(Certificate {
            index,
            posture_count: postures.len(),
            measured_count: measured.len(),
            bound,
            value,
            efficiency: self.efficiency(bound, value),
            outside: self.outside,
            residual: design.residual,
            support: design
                .points
                .iter()
                .zip(&design.weights)
                .map(|(q, weight)| SupportPosture { angles: q.clone(), weight: *weight })
                .collect(),
            searches: design.searches,
            verification: design.verification,
            rounds: design.rounds,
            termination: design.termination,
        })
    }

    /// Smallest index of N postures: σ·sqrt(φ), with φ(M) = φ(M/N)/N; readings that know their σ have it in M.
    pub(super) fn bound(&self, design: &ContinuousDesign) -> f64 {
        let sigma = if self.space.knows_noise() { 1.0 } else { self.space.cell().noise.displacement_std() };
        sigma * (design.bound / self.postures as f64).sqrt()
    }

    pub(super) fn efficiency(&self, bound: f64, value: Option<f64>) -> Option<f64> {
        value.filter(|v| *v > 0.0 && self.outside.is_empty()).map(|v| bound / v)
    }
}
