//! One factor on everything: loads, displacements or the prior of a whole table
//! in another unit. The readings alone cannot tell: the stiffness takes it up.
//! What speaks are the prior, robots of the class, and what the file says twice.

use super::super::motion::Move;
use super::super::slip::{Slip, Undo};
use super::super::units::{DISPLACEMENTS, FORCES, PRIORS, Unit};
use super::super::words::phrase;
use super::super::{Cause, Evidence, Suspicion, Work};
use super::class::{CLASS_SPREAD, expected_stiffness};
use super::evidence::Sizes;
use super::fit::Fitted;
use crate::numerics::order::sort_by_number;

/// How much likelier than the commonest slip it is that nothing is wrong (logarithm).
const SOUND_LOG_PRIOR: f64 = 4.5;
/// What numbers in the names of states count where they agree with a factor.
const NAMED_STATES_EVIDENCE: f64 = 5.0;
/// How much rarer it is that cell and table have the same slip (logarithm).
const BOTH_SLIPS: f64 = 1.0;
/// Explanations this much below the best are not named (logarithm of a likelihood).
const ALIKE_LOG_LIKELIHOOD: f64 = 7.5;
/// What the file itself must add to make a finding serious.
const CONFIRMING_EVIDENCE: f64 = 3.0;
/// Ratio to prior or class that no robot explains (logarithm of 20).
const BEYOND_ROBOTS: f64 = 3.0;
/// What gives way beyond the axes makes an arm softer than its joints: mean and spread (logarithm).
const SOFTER: [f64; 2] = [0.15, 0.1];
/// Misfit of the states beyond which their sizes say nothing.
const POOR_MISFIT: f64 = 0.5;

/// A factor on everything, or none.
struct Explanation {
    slip: Option<(Cause, Unit)>,
    /// Logarithm of the likelihood: of all, and of what the file itself says.
    all: f64,
    file: f64,
}

impl Explanation {
    /// Factors of loads and of displacements.
    fn factors(&self) -> [f64; 2] {
        match self.slip {
            Some((Cause::LoadUnits, unit)) => [unit.factor, 1.0],
            Some((Cause::DisplacementUnits, unit)) => [1.0, unit.factor],
            _ => [1.0; 2],
        }
    }

    fn suspicion(&self, work: &Work) -> Option<Suspicion> {
        let (cause, unit) = self.slip?;
        Some(Slip::new(Undo::Times(cause, unit)).suspicion(work))
    }
}

/// A table whose scale as a whole is not the one stated.
pub(super) fn check(work: &Work, moves: &[Move], fitted: &Fitted) -> Option<Suspicion> {
    if fitted.level > POOR_MISFIT {
        return None;
    }
    let sizes = Sizes::of(work, moves);
    let class = expected_stiffness(&work.setup().robot);
    // Logarithm of what compliance, fitted over expected, is beside prior and class.
    let beside_prior = work.cell.prior.as_ref().map(|_| fitted.common);
    let prior_over_class = work.cell.prior.as_ref().map_or(0.0, |prior| {
        let logs = prior.iter().zip(&class).map(|(p, c)| (p / c).ln());
        logs.sum::<f64>() / class.len() as f64
    });
    // h over that of the class: h/h_prior less what the prior has over the class.
    let beside_class = fitted.common - prior_over_class;
    let spread = fitted.common_std.hypot(SOFTER[1]);
    let normal = |value: f64, spread: f64| -(value / spread).powi(2) / 2.0;
    // The cell's own load may be typed in the same unit as the table's.
    let stated = |load: f64| sizes.stated(load).max(sizes.stated(1.0) - BOTH_SLIPS);
    let judge = |slip: Option<(Cause, Unit)>| {
        let mut out = Explanation { slip, all: 0.0, file: 0.0 };
        let [load, displacement] = out.factors();
        let of_class = load.ln() - displacement.ln();
        let expected = match slip {
            Some((Cause::PriorUnits, unit)) => -unit.factor.ln(),
            _ => of_class,
        };
        out.all = normal(beside_class - of_class, CLASS_SPREAD);
        if let Some(ratio) = beside_prior {
            out.all += normal(ratio - SOFTER[0] - expected, spread);
        }
        let named = if sizes.is_named(load) { NAMED_STATES_EVIDENCE } else { 0.0 };
        out.file = stated(load) + sizes.plausible(load, displacement) + named;
        out.all += out.file - slip.map_or(-SOUND_LOG_PRIOR, |(_, unit)| unit.rare);
        out
    };
    let sound = judge(None);
    let mut all: Vec<(Cause, Unit)> = FORCES.map(|unit| (Cause::LoadUnits, unit)).to_vec();
    if work.is_displacements {
        all.extend(DISPLACEMENTS.map(|unit| (Cause::DisplacementUnits, unit)));
    }
    if beside_prior.is_some() {
        all.extend(PRIORS.map(|unit| (Cause::PriorUnits, unit)));
    }
    let mut all: Vec<Explanation> = all.into_iter().map(|slip| judge(Some(slip))).collect();
    all.retain(|e| e.all > sound.all);
    sort_by_number(&mut all, |a| -a.all);
    let limit = all.first()?.all - ALIKE_LOG_LIKELIHOOD;
    all.retain(|e| e.all >= limit);
    let best = all.remove(0);
    let mut out = best.suspicion(work)?;
    // How many times the stiffness is off, for the sentence.
    let off = beside_prior.unwrap_or(beside_class);
    out.ratio = Some((-off).exp());
    out.evidence = Some(Evidence::Prior);
    out.certain = off.abs() > BEYOND_ROBOTS;
    if best.file - sound.file > CONFIRMING_EVIDENCE {
        let [load, displacement] = best.factors();
        out.evidence = Some(Evidence::File);
        out.certain = true;
        out.confirmed_by = sizes.reasons(load, displacement);
    }
    let others = all.iter().filter_map(|e| e.suspicion(work));
    out.alternatives = others.map(|s| phrase(&s)).collect();
    Some(out)
}
