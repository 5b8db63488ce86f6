//! Which pair is wrong: one that was read or typed wrongly, two whose labels
//! are swapped, or a mirrored frame.
//!
//! Whether something is wrong is a test: the pair left out against the fit of
//! the others (F with the residuals' variance, χ² with a known one, Bonferroni
//! over the pairs), or overwhelming evidence for an explanation. Which one it
//! is, is told by the evidence of each; an explanation is named alone where it
//! holds nearly all of it.
//!
//! One cause at a time: two wrong pairs can hide each other.
//!
//! A test finds an error, evidence names it. In this module an F test says that
//! a pair is wrong; which one, or which two are swapped, or whether a frame is
//! mirrored, is decided by the integrated likelihood of each explanation. The
//! largest left-out residual alone would name the wrong one of four pairs too
//! often; with 99 % of the evidence required it was wrong in 0.3 % of simulated
//! cases at most, and says "one of" where it cannot tell.

mod evidence;
mod messages;

use super::fit::{RigidFit, Sample, rigid};
use crate::findings::Severity;
use crate::numerics::order::order_by_number;
pub(super) use evidence::{chi_squared_tail, f_tail};
use evidence::{ln_evidence, ln_volume, tail};
pub(crate) use messages::axis_slips;
pub(super) use messages::mm;

/// Chance at which the largest of all left-out residuals counts as a likely
/// error and not as noise, and at which it counts as an error.
const LIKELY: f64 = 0.01;
const SIGNIFICANT: f64 = 0.001;
/// Odds against the pairs as they stand above which another explanation of
/// the residuals is believed. Noise alone gives odds of k less often than 1/k.
const ODDS: f64 = 1e4;
/// Share of the evidence that names an explanation.
const CERTAIN: f64 = 0.99;
/// A mirrored frame must bring the residuals down by this factor.
const MIRROR_GAIN: f64 = 3.0;
/// Pairs looked at one by one and two by two: those with the largest residuals.
const CANDIDATES: usize = 24;
/// Below this chance a known variance and the residuals contradict each other.
const CONTRADICTION: f64 = 1e-3;

/// What is wrong with the pairs, by their numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Cause {
    Swapped(usize, usize),
    Outlier(usize),
}

/// An explanation of the residuals: the fit that accounts for it.
#[derive(Debug, Clone)]
struct Explanation {
    fit: RigidFit,
    degrees_of_freedom: usize,
    /// ln of evidence times prior; a mirrored frame, two swapped points and one
    /// wrong point are equally likely beforehand.
    ln_weight: f64,
    /// Share in the weight of all explanations.
    share: f64,
}

impl Explanation {
    fn new(samples: &[Sample]) -> Option<Self> {
        let fit = rigid(samples)?;
        let degrees_of_freedom = (3 * samples.len()).checked_sub(fit.rank())?;
        (degrees_of_freedom > 0).then_some(Explanation { fit, degrees_of_freedom, ln_weight: 0.0, share: 0.0 })
    }

    /// RMS of the norms of its residuals, weighted \[m\].
    fn rms(&self) -> f64 {
        (self.fit.rss / self.fit.weight).sqrt()
    }
}

/// What the residuals say about the pairs.
#[derive(Debug, Clone)]
pub(super) struct Suspicion {
    /// The pairs as they stand.
    plain: Explanation,
    mirrored: Option<Explanation>,
    /// The most likely first.
    wrong: Vec<(Cause, Explanation)>,
    /// How sure it is that one of the latter is the case; `None` where noise
    /// explains the residuals.
    severity: Option<Severity>,
}

impl Suspicion {
    /// Weighs the explanations of the residuals of `fit`.
    pub(super) fn of(samples: &[Sample], fit: &RigidFit, noise_std: Option<f64>) -> Self {
        let count = samples.len();
        let mut plain = Explanation { fit: fit.clone(), degrees_of_freedom: 3 * count - 6, ln_weight: 0.0, share: 0.0 };
        // Three points lie in a plane: their mirror image is the same triangle.
        let mut mirrored =
            Some(mirrored(samples)).filter(|_| count > 3).and_then(|mirrored| Explanation::new(&mirrored));
        let mut wrong = wrong_pairs(samples, fit);

        // A known σ that contradicts every explanation is not used to choose one.
        let agrees = |e: &Explanation| {
            noise_std.is_some_and(|std| chi_squared_tail(e.fit.rss / std.powi(2), e.degrees_of_freedom) > CONTRADICTION)
        };
        let all = wrong.iter().map(|(_, e)| e).chain(&mirrored);
        let std = noise_std.filter(|_| all.chain([&plain]).any(agrees));

        plain.ln_weight = ln_evidence(&plain, samples, None, std);
        if let Some(mirrored) = &mut mirrored {
            mirrored.ln_weight = ln_evidence(mirrored, samples, None, std);
        }
        let volume = ln_volume(samples);
        for (cause, e) in &mut wrong {
            e.ln_weight = match *cause {
                Cause::Swapped(..) => {
                    let swaps = (count * (count - 1) / 2) as f64;
                    ln_evidence(e, samples, None, std) - swaps.ln()
                }
                Cause::Outlier(i) => ln_evidence(e, samples, Some(i), std) - volume - (count as f64).ln(),
            };
        }
        wrong.sort_by(|(_, a), (_, b)| b.ln_weight.total_cmp(&a.ln_weight));
        share_out(wrong.iter_mut().map(|(_, e)| e).chain(&mut mirrored));

        let overwhelming = wrong.iter().any(|(_, e)| e.ln_weight - plain.ln_weight > ODDS.ln());
        let outliers = wrong.iter().filter(|(cause, _)| matches!(cause, Cause::Outlier(_)));
        let chance = outliers.map(|(_, e)| count as f64 * tail(&plain, e, std)).fold(1.0, f64::min);
        let severity = if overwhelming || chance < SIGNIFICANT {
            Some(Severity::Serious)
        } else {
            (chance < LIKELY).then_some(Severity::Caution)
        };
        Suspicion { plain, mirrored, wrong, severity }
    }

    /// True where the residuals would have told a mirrored frame: never for
    /// three pairs, nor for points in a plane.
    pub(super) fn hand_is_known(&self) -> bool {
        self.mirrored.as_ref().is_some_and(|mirrored| self.plain.ln_weight - mirrored.ln_weight > ODDS.ln())
    }

    /// A mirrored frame, where that is among the likely explanations.
    fn mirrored(&self) -> Option<&Explanation> {
        self.mirrored.as_ref().filter(|mirrored| {
            mirrored.ln_weight - self.plain.ln_weight > ODDS.ln()
                && self.plain.rms() > MIRROR_GAIN * mirrored.rms()
                && mirrored.share > 1.0 - CERTAIN
        })
    }

    /// The wrong pairs that, with a mirrored frame, hold nearly all evidence.
    fn likely(&self) -> Vec<&(Cause, Explanation)> {
        let mut missing = CERTAIN - self.mirrored().map_or(0.0, |mirrored| mirrored.share);
        let mut likely = Vec::new();
        for wrong in &self.wrong {
            if missing <= 0.0 {
                break;
            }
            missing -= wrong.1.share;
            likely.push(wrong);
        }
        likely
    }
}

/// Each pair left out, and each two exchanged.
fn wrong_pairs(samples: &[Sample], fit: &RigidFit) -> Vec<(Cause, Explanation)> {
    let size = |i: usize| samples[i].weight * fit.residual(&samples[i]).norm_squared();
    let mut order = order_by_number(samples.len(), |i| -size(i));
    order.truncate(CANDIDATES);
    order.sort_unstable();
    let mut wrong = Vec::new();
    for (k, &i) in order.iter().enumerate() {
        // Of three pairs each two fit, but for their distance.
        if samples.len() > 3 {
            let rest: Vec<Sample> = [&samples[..i], &samples[i + 1..]].concat();
            wrong.extend(Explanation::new(&rest).map(|e| (Cause::Outlier(i), e)));
        }
        for &j in &order[k + 1..] {
            let mut swapped = samples.to_vec();
            swapped[i].tracker = samples[j].tracker;
            swapped[j].tracker = samples[i].tracker;
            wrong.extend(Explanation::new(&swapped).map(|e| (Cause::Swapped(i, j), e)));
        }
    }
    wrong
}

/// The samples with tracker axes of the other hand.
fn mirrored(samples: &[Sample]) -> Vec<Sample> {
    let reverse = |s: &Sample| Sample { tracker: -s.tracker, ..*s };
    samples.iter().map(reverse).collect()
}

/// Shares of the explanations in the sum of their weights.
fn share_out<'e>(explanations: impl Iterator<Item = &'e mut Explanation>) {
    let mut explanations: Vec<&mut Explanation> = explanations.collect();
    let best = explanations.iter().map(|e| e.ln_weight).fold(f64::NEG_INFINITY, f64::max);
    let weight = |e: &Explanation| (e.ln_weight - best).exp();
    let total: f64 = explanations.iter().map(|e| weight(e)).sum();
    for e in &mut explanations {
        e.share = weight(e) / total;
    }
}
