//! Loads of single states: 50 typed for 500, one posture in kilograms. The other
//! states give the compliance; a factor that brings a state back among them is
//! named, with posture and state.

use super::super::motion::{Move, load_of};
use super::super::sheet::{Posture, Sheet};
use super::super::slip::{Rule, SettledSlip, Slip, StateIndex, Undo, settle};
use super::super::units::{DISPLACEMENTS, ENTRIES, Unit};
use super::super::{Cause, Evidence, Work};
use super::evidence::number_in;
use super::fit::{Fitted, misfit_of};
use crate::numerics::sample::median;
use nalgebra::Isometry3;

/// Misfit of a state, over the larger of read and expected, that is looked into:
/// at least, and in medians of all states.
const SUSPECT_MISFIT: [f64; 2] = [0.5, 2.5];
/// Misfit that a factor must leave: at most, in medians, and of what it was.
const SETTLED_MISFIT: [f64; 2] = [0.3, 2.5];
const REMAINING_SHARE: f64 = 0.4;
/// Misfits that are alike.
const ALIKE_MISFIT: f64 = 0.04;
/// Relative distance of two typed loads that are the same but for a factor.
const SAME_LOAD: f64 = 0.01;
/// Postures in which a state of the same name shows what its load is.
const PATTERN: usize = 3;
/// Share of the states beyond which it is not they that are wrong.
const WRONG_STATES_SHARE: f64 = 0.4;

/// What states of the same name say of a typed load.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Pattern {
    /// They have the same number: what is typed here is no slip of this entry.
    Same,
    /// They have this many times the number.
    Times(f64),
    /// Nothing.
    Open,
}

/// An entry, what it is multiplied by, and the misfit as typed.
#[derive(Debug, Clone)]
struct Entry {
    cause: Cause,
    unit: Unit,
    settled: SettledSlip,
    before: f64,
}

impl Entry {
    fn at(&self) -> impl Iterator<Item = StateIndex> {
        self.settled.slip.at.iter().flatten().copied()
    }
}

/// Names loads of single states that are off by a factor, and goes on with what they should be.
pub(super) fn check(work: &mut Work, base_from_tracker: &Isometry3<f64>, moves: &[Move], fitted: &Fitted) {
    let limit = SUSPECT_MISFIT[0].max(SUSPECT_MISFIT[1] * fitted.level);
    let mut entries: Vec<Entry> = Vec::new();
    for p in 0..work.sheet.postures.len() {
        let posture_moves: Vec<usize> = (0..moves.len()).filter(|i| moves[*i].posture == p).collect();
        let off: Vec<usize> = posture_moves
            .iter()
            .copied()
            .filter(|i| fitted.states[*i].misfit > limit)
            // A sensor's reading holds the tool's weight: another factor on it may turn
            // the difference round, and hide exchanged rows.
            .filter(|i| {
                let measured = work.sheet.at((p, moves[*i].state)).wrench.is_some();
                !measured || fitted.states[*i].ratio > 0.0
            })
            .collect();
        // All states of a posture alike, then its reference, then each alone.
        let mut groups: Vec<Vec<StateIndex>> = Vec::new();
        let by_wrench = posture_moves.iter().any(|i| {
            let one = &moves[*i];
            work.sheet.at((p, one.reference)).wrench.is_some()
        });
        if (posture_moves.len() > 1 || by_wrench) && !off.is_empty() && off.len() == posture_moves.len() {
            let states = 0..work.sheet.postures[p].states.len();
            groups.push(states.map(|s| (p, s)).collect());
        }
        let reference = moves.iter().find(|m| m.posture == p).map(|m| m.reference);
        groups.extend(reference.map(|s| vec![(p, s)]));
        groups.extend(posture_moves.iter().map(|i| vec![(p, moves[*i].state)]));
        let mut open = off;
        for group in groups {
            let is_touched = |i: &usize| group.iter().any(|at| moves[*i].is_of(*at));
            let touched: Vec<usize> = posture_moves.iter().copied().filter(is_touched).collect();
            let pattern = match group[..] {
                [at] => pattern(&work.sheet, at),
                _ => Pattern::Open,
            };
            let is_slip = matches!(pattern, Pattern::Times(_));
            if !is_slip && !touched.iter().any(|i| open.contains(i)) {
                continue;
            }
            let states: Vec<StateIndex> = touched.iter().map(|i| fitted.states[*i].at).collect();
            let entry = mended(work, base_from_tracker, &group, &states, fitted, pattern);
            if let Some(entry) = entry {
                open.retain(|i| !touched.contains(i));
                entries.push(entry);
            }
        }
    }
    if !entries.is_empty() {
        let entries = those_wrong(work, moves, fitted, entries);
        report(work, &entries);
        for entry in &entries {
            entry.settled.slip.undo(work);
        }
    }
}

/// The factor on `group` that brings the states `touched` back among the others.
fn mended(
    work: &Work,
    base_from_tracker: &Isometry3<f64>,
    group: &[StateIndex],
    touched: &[StateIndex],
    fitted: &Fitted,
    pattern: Pattern,
) -> Option<Entry> {
    let has_load = |at: &StateIndex| {
        let state = work.sheet.at(*at);
        state.load.is_some_and(|l| l != 0.0) || state.wrench.is_some()
    };
    let left = |work: &Work| misfit_of(work, base_from_tracker, touched, fitted);
    let before = left(work)?;
    let mut units: Vec<(Cause, Unit)> = Vec::new();
    if group.iter().any(has_load) && pattern != Pattern::Same {
        units.extend(ENTRIES.map(|unit| (Cause::LoadEntry, unit)));
    }
    if work.is_displacements && group.len() == 1 {
        units.extend(DISPLACEMENTS.map(|unit| (Cause::DisplacementUnits, unit)));
    }
    let settled = SETTLED_MISFIT[0].max(SETTLED_MISFIT[1] * fitted.level);
    let mut rule = Rule { most: settled.min(REMAINING_SHARE * before), alike: [1.0, ALIKE_MISFIT], beside: f64::MAX };
    // What states of this name have elsewhere, or the name itself says, decides.
    if let Pattern::Times(factor) = pattern {
        units.retain(|(cause, u)| *cause == Cause::LoadEntry && (u.factor / factor - 1.0).abs() < SAME_LOAD);
        rule.most = 0.9 * before;
    }
    // Numbers of a sensor, and all of a posture, are not typed one by one.
    let typed = group.len() == 1 && work.sheet.at(group[0]).wrench.is_none();
    let tried = units.into_iter().map(|(cause, unit)| {
        let mut slip = Slip::new(Undo::Times(cause, unit)).at(group);
        if unit.is_decimal() && !typed {
            slip.cost += 2.0;
        }
        let after = left(&work.without(&slip));
        (slip, after)
    });
    let settled = settle(tried, &rule)?;
    let Undo::Times(cause, unit) = settled.slip.undo else {
        return None;
    };
    Some(Entry { cause, unit, settled, before })
}

/// What states of this name have in other postures, or else the name itself, says
/// of the load typed for this state.
fn pattern(sheet: &Sheet, at: StateIndex) -> Pattern {
    let state = sheet.at(at);
    let Some(load) = state.load.filter(|l| *l > 0.0) else {
        return Pattern::Open;
    };
    let of_name = |p: &Posture| {
        let mut namesakes = p.states.iter().filter(|s| s.name == state.name);
        namesakes.find_map(|s| s.load)
    };
    let others = (0..sheet.postures.len()).filter(|p| *p != at.0);
    let others: Vec<f64> = others.filter_map(|p| of_name(&sheet.postures[p])).collect();
    let usual = if others.len() >= PATTERN {
        let middle = median(&others);
        let alike = others.iter().filter(|l| (*l / middle - 1.0).abs() < SAME_LOAD);
        (alike.count() * 4 > others.len() * 3).then_some(middle)
    } else {
        number_in(&state.name)
    };
    let Some(factor) = usual.map(|usual| usual / load) else {
        return Pattern::Open;
    };
    let near = |f: f64| (f / factor - 1.0).abs() < SAME_LOAD;
    if near(1.0) {
        Pattern::Same
    } else if ENTRIES.iter().any(|u| near(u.factor)) {
        Pattern::Times(factor)
    } else {
        Pattern::Open
    }
}

/// Where as many states are off as not, prior and names tell which.
fn those_wrong(work: &Work, moves: &[Move], fitted: &Fitted, entries: Vec<Entry>) -> Vec<Entry> {
    let flagged: Vec<StateIndex> = entries.iter().flat_map(Entry::at).collect();
    let unit = entries[0].unit;
    let alike = |e: &Entry| e.unit == unit && e.cause == Cause::LoadEntry;
    let all = moves.iter().map(|m| (m.posture, m.state));
    let others: Vec<StateIndex> = all.filter(|at| !flagged.contains(at)).collect();
    let is_most = flagged.len() as f64 >= WRONG_STATES_SHARE * moves.len() as f64;
    if !entries.iter().all(alike) || others.is_empty() || !is_most {
        return entries;
    }
    // Names first: loads of these states agree with their names.
    let agreeing = |at: &[StateIndex]| {
        let matching = at.iter().filter(|at| {
            let state = work.sheet.at(**at);
            let number = number_in(&state.name);
            let load = load_of(work, state);
            number.zip(load).is_some_and(|(n, l)| (l / n - 1.0).abs() < SAME_LOAD)
        });
        matching.count() as f64 / at.len().max(1) as f64
    };
    let (named, unnamed) = (agreeing(&flagged), agreeing(&others));
    let flip = if named != unnamed {
        named > unnamed
    } else {
        let other = fitted.common + unit.factor.ln();
        other.abs() < fitted.common.abs()
    };
    let inverse = ENTRIES.iter().find(|u| (u.factor * unit.factor - 1.0).abs() < 1e-9);
    let Some(inverse) = inverse.filter(|_| flip) else {
        return entries;
    };
    let turned = |at: StateIndex| {
        let mut out = entries[0].clone();
        out.unit = *inverse;
        out.settled.slip = Slip::new(Undo::Times(Cause::LoadEntry, *inverse)).at(&[at]);
        out
    };
    others.into_iter().map(turned).collect()
}

/// One finding for each factor.
fn report(work: &mut Work, entries: &[Entry]) {
    let postures = work.sheet.postures.len();
    let mut done: Vec<(Cause, f64)> = Vec::new();
    for entry in entries {
        let key = (entry.cause, entry.unit.factor);
        if done.contains(&key) {
            continue;
        }
        done.push(key);
        let alike = entries.iter().filter(|e| (e.cause, e.unit.factor) == key);
        let at: Vec<StateIndex> = alike.clone().flat_map(Entry::at).collect();
        let after = alike.map(|e| e.settled.after).fold(0.0, f64::max);
        let mut all = entry.settled.clone();
        all.slip = all.slip.at(&at);
        let mut out = all.suspicion(work);
        if out.postures.len() == postures && postures > 1 && !out.states.is_empty() {
            out.postures.clear();
        }
        out.misfits = Some([entry.before, after]);
        out.evidence = Some(Evidence::Readings);
        work.suspicions.push(out);
    }
}
