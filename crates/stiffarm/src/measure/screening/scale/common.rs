//! One factor on everything: loads, displacements or the prior of a whole table
//! in another unit. The readings alone cannot tell: the stiffness takes it up.
//! What speaks are the prior, robots of the class, and what the file says twice.

use super::super::motion::Move;
use super::super::{Cause, Evidence, Suspicion, Work};
use super::class::{CLASS_SPREAD, expected_stiffness};
use super::evidence::Sizes;
use super::fit::Fitted;
use super::units::{DISPLACEMENTS, FORCES, PRIORS, Unit};
use crate::numerics::order::sort_by_number;

/// How much likelier than the commonest slip it is that nothing is wrong (logarithm).
const SOUND: f64 = 4.5;
/// What numbers in the names of states count where they agree with a factor.
const NAMED: f64 = 5.0;
/// How much rarer it is that cell and table have the same slip (logarithm).
const BOTH: f64 = 1.0;
/// Explanations this much below the best are not named (logarithm of a likelihood).
const ALIKE: f64 = 7.5;
/// What the file itself must add to make a finding serious.
const CONFIRMED: f64 = 3.0;
/// Ratio to prior or class that no robot explains (logarithm of 20).
const BEYOND: f64 = 3.0;
/// What gives way beyond the axes makes an arm softer than its joints: mean and spread (logarithm).
const SOFTER: [f64; 2] = [0.15, 0.1];
/// Misfit of the states beyond which their sizes say nothing.
const POOR: f64 = 0.5;

/// What a factor may be on.
#[derive(Debug, Clone, Copy, PartialEq)]
enum On {
    Nothing,
    Loads,
    Displacements,
    Prior,
}

struct Explanation {
    on: On,
    unit: Unit,
    /// Logarithm of the likelihood: of all, and of what the file itself says.
    all: f64,
    file: f64,
}

/// A table whose scale as a whole is not the one stated.
pub(super) fn check(work: &Work, moves: &[Move], fitted: &Fitted) -> Option<Suspicion> {
    if fitted.level > POOR {
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
    let stated = |load: f64| sizes.stated(load).max(sizes.stated(1.0) - BOTH);
    let judge = |on: On, unit: Unit| {
        let log = unit.factor.ln();
        let [mut load, mut displacement] = [1.0, 1.0];
        let (expected, of_class) = match on {
            On::Nothing => (0.0, 0.0),
            On::Loads => {
                load = unit.factor;
                (log, log)
            }
            On::Displacements => {
                displacement = unit.factor;
                (-log, -log)
            }
            On::Prior => (-log, 0.0),
        };
        let mut all = normal(beside_class - of_class, CLASS_SPREAD);
        if let Some(ratio) = beside_prior {
            all += normal(ratio - SOFTER[0] - expected, spread);
        }
        let named = if sizes.is_named(load) { NAMED } else { 0.0 };
        let file = stated(load) + sizes.plausible(load, displacement) + named;
        let rare = match on {
            On::Nothing => -SOUND,
            _ => unit.rare,
        };
        Explanation {
            on,
            unit,
            all: all + file - rare,
            file,
        }
    };
    let nothing = Unit {
        factor: 1.0,
        typed: "",
        rare: 0.0,
    };
    let sound = judge(On::Nothing, nothing);
    let mut all: Vec<Explanation> = FORCES.map(|u| judge(On::Loads, u)).into_iter().collect();
    if work.is_displacements {
        all.extend(DISPLACEMENTS.map(|u| judge(On::Displacements, u)));
    }
    if beside_prior.is_some() {
        all.extend(PRIORS.map(|u| judge(On::Prior, u)));
    }
    all.retain(|e| e.all > sound.all);
    sort_by_number(&mut all, |a| -a.all);
    let best = all.first()?;
    let limit = best.all - ALIKE;
    all.retain(|e| e.all >= limit);
    let best = all.remove(0);
    let cause = match best.on {
        On::Loads | On::Nothing => Cause::LoadUnits,
        On::Displacements => Cause::DisplacementUnits,
        On::Prior => Cause::PriorUnits,
    };
    let mut out = Suspicion::new(cause);
    out.factor = Some(best.unit.factor);
    // How many times the stiffness is off, for the sentence.
    out.ratio = Some((-beside_prior.unwrap_or(beside_class)).exp());
    out.evidence = Some(if best.file - sound.file > CONFIRMED {
        Evidence::File
    } else {
        Evidence::Prior
    });
    if out.evidence == Some(Evidence::File) {
        let [load, displacement] = match best.on {
            On::Loads => [best.unit.factor, 1.0],
            On::Displacements => [1.0, best.unit.factor],
            On::Nothing | On::Prior => [1.0; 2],
        };
        out.confirmed_by = sizes.reasons(load, displacement);
    }
    let off = beside_prior.unwrap_or(beside_class).abs();
    out.certain = out.evidence == Some(Evidence::File) || off > BEYOND;
    out.alternatives = all.iter().map(phrase).collect();
    Some(out)
}

/// An explanation beside others.
fn phrase(e: &Explanation) -> String {
    let factor = super::messages::number(e.unit.factor);
    let typed = e.unit.typed;
    match e.on {
        On::Loads | On::Nothing => format!("loads typed in {typed}, factor {factor}"),
        On::Displacements => format!("displacements in {typed}, factor {factor}"),
        On::Prior => format!("a prior stiffness {typed}, factor {factor}"),
    }
}
