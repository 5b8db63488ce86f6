//! Which limits leave no posture, or few.

use crate::error::{Error, Result};
use crate::findings::list;
use crate::model::cell::{Cell, LimitKind};
use crate::numerics::streams::spread;
use std::collections::BTreeMap;

/// Postures spread over the bounds.
const SAMPLES: u32 = 4096;

/// Kinds of limits of which it helps to know whose they are.
const NAMED: [LimitKind; 3] = [LimitKind::Shapes, LimitKind::RopeClearance, LimitKind::Torque];

/// What stands in the way of postures spread over the bounds.
#[derive(Debug, Clone, PartialEq)]
pub struct Obstruction {
    /// Postures looked at.
    pub sampled: usize,
    /// How many meet every limit.
    pub feasible: usize,
    /// The kinds of limits that the cell has, the one that most postures violate first.
    pub violated: Vec<ViolatedKind>,
    /// The fewest kinds whose absence would leave postures, one or two of them, and how many.
    pub relief: Option<(Vec<LimitKind>, usize)>,
}

/// How often limits of one kind are violated.
#[derive(Debug, Clone, PartialEq)]
pub struct ViolatedKind {
    /// The kind.
    pub kind: LimitKind,
    /// How many postures violate it.
    pub postures: usize,
    /// What violates it most often, where that helps: two shapes, rope and shape, a joint.
    pub subject: Option<String>,
}

/// Looks at postures spread evenly over the bounds; the same cell always gives the same result.
///
/// # Errors
/// Bounds whose number differs from the joints', or that are not finite.
pub fn obstruction(cell: &Cell) -> Result<Obstruction> {
    obstruction_among(cell, SAMPLES)
}

/// [`obstruction`] among the first `samples` of these postures.
pub(crate) fn obstruction_among(cell: &Cell, samples: u32) -> Result<Obstruction> {
    let mut margins = cell.posture_margins()?;
    let mut masks = Vec::with_capacity(samples as usize);
    let mut seen = BTreeMap::<(LimitKind, String), usize>::new();
    for i in 0..samples {
        let q = spread(&cell.bounds, i);
        let mut mask = 0_u32;
        for margin in margins.named(&q)? {
            if margin.is_violated() {
                mask |= bit(margin.kind);
                if NAMED.contains(&margin.kind) {
                    *seen.entry((margin.kind, margin.point)).or_default() += 1;
                }
            }
        }
        masks.push(mask);
    }
    let kinds = cell.limit_kinds();
    let count = |allowed: u32| masks.iter().filter(|mask| **mask & !allowed == 0).count();
    let mut violated: Vec<ViolatedKind> = kinds
        .iter()
        .map(|kind| {
            let subjects = seen.iter().filter(|((of, _), _)| of == kind);
            let most = subjects.max_by_key(|(_, count)| **count);
            ViolatedKind {
                kind: *kind,
                postures: masks.iter().filter(|mask| **mask & bit(*kind) != 0).count(),
                subject: most.map(|((_, subject), _)| subject.clone()),
            }
        })
        .collect();
    violated.sort_by_key(|one| std::cmp::Reverse(one.postures));
    let best = |sets: Vec<Vec<LimitKind>>| {
        let counted = sets.into_iter().map(|set| {
            let allowed = set.iter().fold(0, |mask, kind| mask | bit(*kind));
            let left = count(allowed);
            (set, left)
        });
        counted.filter(|(_, left)| *left > 0).max_by_key(|(_, left)| *left)
    };
    let feasible = count(0);
    let relief = match feasible {
        0 => best(kinds.iter().map(|kind| vec![*kind]).collect()).or_else(|| {
            let pairs = kinds.iter().enumerate();
            best(pairs.flat_map(|(i, a)| kinds[i + 1..].iter().map(|b| vec![*a, *b])).collect())
        }),
        _ => None,
    };
    Ok(Obstruction { sampled: masks.len(), feasible, violated, relief })
}

fn bit(kind: LimitKind) -> u32 {
    let at = LimitKind::ALL.iter().position(|k| *k == kind).unwrap_or(0);
    1 << at
}

impl Obstruction {
    /// What stands in the way, in a sentence or two.
    pub fn words(&self) -> String {
        let share = |count: usize| format!("{:.0} %", 100.0 * count as f64 / self.sampled as f64);
        let most: Vec<String> = self
            .violated
            .iter()
            .take(3)
            .filter(|one| one.postures > 0)
            .map(|one| {
                let most = one.subject.iter().map(|name| format!(", most often {name}"));
                let most: String = most.collect();
                format!("{} ({}{most})", one.kind.describe(), share(one.postures))
            })
            .collect();
        if most.is_empty() {
            return format!("All of {} postures spread over the bounds meet the limits.", self.sampled);
        }
        let mut out = format!(
            "Of {} postures spread over the bounds {} meet every limit; violated most often: {}.",
            self.sampled,
            match self.feasible {
                0 => "none".to_string(),
                count => count.to_string(),
            },
            most.join(", ")
        );
        match &self.relief {
            Some((kinds, left)) => {
                let names: Vec<&str> = kinds.iter().map(|kind| kind.describe()).collect();
                let verb = match left {
                    1 => "posture would do",
                    _ => "postures would do",
                };
                out += &format!(" Without {} {left} {verb}.", list(&names));
                if kinds.contains(&LimitKind::Shapes) {
                    out += " Shapes drawn too large may be left out: `ignore` in [clearance] names their pairs."
                }
            }
            None if self.feasible == 0 => out += " Leaving out any two kinds of limits would not help.",
            None => {}
        }
        out
    }
}

/// The error where no posture meets the limits after `tried` attempts.
pub(crate) fn nothing_meets(cell: &Cell, tried: usize) -> Error {
    let tried = format!("None of {tried} random postures within the bounds meets the cell's limits.");
    let message = match obstruction(cell) {
        Ok(obstruction) => format!("{tried} {}", obstruction.words()),
        Err(_) => tried,
    };
    let hint = if cell.scene.is_empty() {
        "check the limits' frame (robot base) and unit (mm)"
    } else {
        "relax what stands in the way: check frames (base, flange) and units (mm) of limits, shapes and stations, \
                  or move anchor, station or obstacle"
    };
    Error::invalid(message).key("limits").hint(hint)
}
