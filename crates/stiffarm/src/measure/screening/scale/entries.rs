//! Loads of single states: 50 typed for 500, one posture in kilograms. The other
//! states give the compliance; a factor that brings a state back among them is
//! named, with posture and state.

use super::super::motion::Move;
use super::super::motion::{displacement, load_of};
use super::super::sheet::{Posture, Sheet, State};
use super::super::{Cause, Evidence, Suspicion, Work};
use super::evidence::number_in;
use super::fit::{Fitted, scaled};
use super::units::{DISPLACEMENTS, ENTRIES, Unit};
use crate::numerics::order::sort_by_number;
use crate::numerics::sample::median;
use nalgebra::Isometry3;

/// Misfit of a state, over the larger of read and expected, that is looked into:
/// at least, and in medians of all states.
const OFF: [f64; 2] = [0.5, 2.5];
/// Misfit that a factor must leave: at most, in medians, and of what it was.
const SETTLED: [f64; 2] = [0.3, 2.5];
const FALLEN: f64 = 0.4;
/// Misfits that are alike.
const ALIKE: f64 = 0.04;
/// Relative distance of two typed loads that are the same but for a factor.
const SAME: f64 = 0.01;
/// Postures in which a state of the same name shows what its load is.
const PATTERN: usize = 3;
/// Share of the states beyond which it is not they that are wrong.
const MANY: f64 = 0.4;

/// What is multiplied.
#[derive(Debug, Clone, Copy, PartialEq)]
enum On {
    /// Load or wrench of these states of a posture.
    Load,
    /// The displacement, in a table of displacements.
    Displacement,
}

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

/// One entry with the factor that mends it.
#[derive(Debug, Clone)]
struct Entry {
    at: Vec<(usize, usize)>,
    unit: Unit,
    on: On,
    alternatives: Vec<Unit>,
    before: f64,
    after: f64,
}

/// Names loads of single states that are off by a factor, and goes on with what they should be.
pub(super) fn check(
    work: &mut Work,
    base_from_tracker: &Isometry3<f64>,
    moves: &[Move],
    fitted: &Fitted,
) -> bool {
    let limit = OFF[0].max(OFF[1] * fitted.level);
    let mut entries: Vec<Entry> = Vec::new();
    for p in 0..work.sheet.postures.len() {
        let own: Vec<usize> = (0..moves.len())
            .filter(|i| moves[*i].posture == p)
            .collect();
        let off: Vec<usize> = own
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
        let mut groups: Vec<Vec<(usize, usize)>> = Vec::new();
        let by_wrench = own.iter().any(|i| {
            let one = &moves[*i];
            work.sheet.at((p, one.reference)).wrench.is_some()
        });
        if (own.len() > 1 || by_wrench) && !off.is_empty() && off.len() == own.len() {
            let states = 0..work.sheet.postures[p].states.len();
            groups.push(states.map(|s| (p, s)).collect());
        }
        let reference = moves.iter().find(|m| m.posture == p).map(|m| m.reference);
        groups.extend(reference.map(|s| vec![(p, s)]));
        groups.extend(own.iter().map(|i| vec![(p, moves[*i].state)]));
        let mut open = off;
        for group in groups {
            let touched: Vec<usize> = own
                .iter()
                .copied()
                .filter(|i| {
                    let sides = [moves[*i].state, moves[*i].reference];
                    group.iter().any(|at| sides.contains(&at.1))
                })
                .collect();
            let pattern = match group[..] {
                [at] => pattern(&work.sheet, at),
                _ => Pattern::Open,
            };
            let is_slip = matches!(pattern, Pattern::Times(_));
            if !is_slip && !touched.iter().any(|i| open.contains(i)) {
                continue;
            }
            let found = mended(work, base_from_tracker, &group, &touched, fitted, pattern);
            if let Some(entry) = found {
                open.retain(|i| !touched.contains(i));
                entries.push(entry);
            }
        }
    }
    if entries.is_empty() {
        return false;
    }
    let entries = those_wrong(work, moves, fitted, entries);
    for entry in &entries {
        for at in &entry.at {
            multiply(work.sheet.at_mut(*at), entry.on, entry.unit.factor);
        }
    }
    report(work, &entries);
    true
}

/// Mean misfit of the moves `touched` with what `group` says multiplied by `factor`.
fn misfit_with(
    work: &Work,
    base_from_tracker: &Isometry3<f64>,
    group: &[(usize, usize)],
    touched: &[usize],
    fitted: &Fitted,
    on: On,
    factor: f64,
) -> Option<f64> {
    let mut copy = work.to_try();
    for at in group {
        multiply(copy.sheet.at_mut(*at), on, factor);
    }
    let mut sum = 0.0;
    for i in touched {
        let at = fitted.states[*i].at;
        let reference = *copy.sheet.postures[at.0].references().first()?;
        let one = displacement(&copy, base_from_tracker, at.0, at.1, reference)?;
        sum += scaled(&one, &fitted.compliance).misfit;
    }
    Some(sum / touched.len() as f64)
}

fn multiply(state: &mut State, on: On, factor: f64) {
    match on {
        On::Load => {
            state.load = state.load.map(|l| l * factor);
            if let Some(wrench) = &mut state.wrench {
                wrench.force *= factor;
                wrench.moment *= factor;
            }
        }
        // Displacements are positions from an origin.
        On::Displacement => state.each_position(|p| *p *= factor),
    }
}

/// The factor that brings the states `touched` back among the others.
fn mended(
    work: &Work,
    base_from_tracker: &Isometry3<f64>,
    group: &[(usize, usize)],
    touched: &[usize],
    fitted: &Fitted,
    pattern: Pattern,
) -> Option<Entry> {
    let has_load = |at: &(usize, usize)| {
        let state = work.sheet.at(*at);
        state.load.is_some_and(|l| l != 0.0) || state.wrench.is_some()
    };
    let with = |on: On, factor: f64| {
        misfit_with(work, base_from_tracker, group, touched, fitted, on, factor)
    };
    let before = with(On::Load, 1.0)?;
    let mut tried: Vec<(On, Unit, f64)> = Vec::new();
    if group.iter().any(has_load) && pattern != Pattern::Same {
        for unit in ENTRIES {
            tried.extend(with(On::Load, unit.factor).map(|after| (On::Load, unit, after)));
        }
    }
    if work.is_displacements && group.len() == 1 {
        for unit in DISPLACEMENTS {
            let after = with(On::Displacement, unit.factor);
            tried.extend(after.map(|after| (On::Displacement, unit, after)));
        }
    }
    // What states of this name have elsewhere, or the name itself says, decides.
    if let Pattern::Times(factor) = pattern {
        let same = |u: &Unit| (u.factor / factor - 1.0).abs() < SAME;
        let named = tried
            .iter()
            .find(|(on, u, _)| *on == On::Load && same(u))
            .copied();
        return named
            .filter(|(_, _, after)| *after < 0.9 * before)
            .map(|(on, unit, after)| Entry {
                at: group.to_vec(),
                unit,
                on,
                alternatives: Vec::new(),
                before,
                after,
            });
    }
    let best = tried.iter().map(|t| t.2).reduce(f64::min)?;
    let settled = SETTLED[0].max(SETTLED[1] * fitted.level);
    if best > settled || best > FALLEN * before {
        return None;
    }
    tried.retain(|t| t.2 < best + ALIKE);
    // Numbers of a sensor, and all of a posture, are not typed one by one.
    let typed = group.len() == 1 && work.sheet.at(group[0]).wrench.is_none();
    let rare = |u: &Unit| u.rare + if u.is_decimal() && !typed { 2.0 } else { 0.0 };
    sort_by_number(&mut tried, |a| rare(&a.1) + a.2);
    let (on, unit, after) = tried.remove(0);
    Some(Entry {
        at: group.to_vec(),
        unit,
        on,
        alternatives: tried.iter().map(|t| t.1).collect(),
        before,
        after,
    })
}

/// What states of this name have in other postures, or else the name itself, says
/// of the load typed for this state.
fn pattern(sheet: &Sheet, at: (usize, usize)) -> Pattern {
    let state = sheet.at(at);
    let Some(load) = state.load.filter(|l| *l > 0.0) else {
        return Pattern::Open;
    };
    let of_name = |p: &Posture| {
        let mut own = p.states.iter().filter(|s| s.name == state.name);
        own.find_map(|s| s.load)
    };
    let others = (0..sheet.postures.len()).filter(|p| *p != at.0);
    let others: Vec<f64> = others.filter_map(|p| of_name(&sheet.postures[p])).collect();
    let usual = if others.len() >= PATTERN {
        let middle = median(&others);
        let alike = others.iter().filter(|l| (*l / middle - 1.0).abs() < SAME);
        (alike.count() * 4 > others.len() * 3).then_some(middle)
    } else {
        number_in(&state.name)
    };
    let Some(factor) = usual.map(|usual| usual / load) else {
        return Pattern::Open;
    };
    let near = |f: f64| (f / factor - 1.0).abs() < SAME;
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
    let all: Vec<(usize, usize)> = moves.iter().map(|m| (m.posture, m.state)).collect();
    let flagged: Vec<(usize, usize)> = entries.iter().flat_map(|e| e.at.clone()).collect();
    let unit = entries[0].unit;
    let alike = entries
        .iter()
        .all(|e| e.unit.factor == unit.factor && e.on == On::Load);
    let others: Vec<(usize, usize)> = all
        .iter()
        .copied()
        .filter(|at| !flagged.contains(at))
        .collect();
    if !alike || others.is_empty() || (flagged.len() as f64) < MANY * all.len() as f64 {
        return entries;
    }
    // Names first: loads of these states agree with their names.
    let agreeing = |at: &[(usize, usize)]| {
        let own = at.iter().filter(|at| {
            let state = work.sheet.at(**at);
            let number = number_in(&state.name);
            let load = load_of(work, state);
            number
                .zip(load)
                .is_some_and(|(n, l)| (l / n - 1.0).abs() < SAME)
        });
        own.count() as f64 / at.len().max(1) as f64
    };
    let (named, unnamed) = (agreeing(&flagged), agreeing(&others));
    let flip = if named != unnamed {
        named > unnamed
    } else {
        let other = fitted.common + unit.factor.ln();
        other.abs() < fitted.common.abs()
    };
    let inverse = ENTRIES
        .iter()
        .find(|u| (u.factor * unit.factor - 1.0).abs() < 1e-9);
    match inverse.filter(|_| flip) {
        None => entries,
        Some(inverse) => others
            .into_iter()
            .map(|at| Entry {
                at: vec![at],
                unit: *inverse,
                ..entries[0].clone()
            })
            .collect(),
    }
}

/// One finding for each factor.
fn report(work: &mut Work, entries: &[Entry]) {
    let mut done: Vec<(On, f64)> = Vec::new();
    for entry in entries {
        let key = (entry.on, entry.unit.factor);
        if done.contains(&key) {
            continue;
        }
        done.push(key);
        let alike = entries.iter().filter(|e| (e.on, e.unit.factor) == key);
        let alike: Vec<&Entry> = alike.collect();
        let cause = match entry.on {
            On::Load => Cause::LoadEntry,
            On::Displacement => Cause::DisplacementUnits,
        };
        let mut out = Suspicion::new(cause);
        let at: Vec<(usize, usize)> = alike.iter().flat_map(|e| e.at.clone()).collect();
        let postures = work.sheet.postures.len();
        for &(p, s) in &at {
            let posture = &work.sheet.postures[p];
            if !out.postures.contains(&posture.name) {
                out.postures.push(posture.name.clone());
            }
            let state = &posture.states[s].name;
            let whole = posture.states.len() > 1
                && (0..posture.states.len()).all(|other| at.contains(&(p, other)));
            if !whole && !out.states.contains(state) {
                out.states.push(state.clone());
            }
        }
        if out.postures.len() == postures && postures > 1 && !out.states.is_empty() {
            out.postures.clear();
        }
        out.factor = Some(entry.unit.factor);
        let after = alike.iter().map(|e| e.after).fold(0.0, f64::max);
        out.misfits = Some([entry.before, after]);
        out.evidence = Some(Evidence::Readings);
        out.certain = entry.alternatives.is_empty();
        for unit in &entry.alternatives {
            let factor = super::messages::number(unit.factor);
            out.alternatives
                .push(format!("{}, factor {factor}", unit.typed));
        }
        work.found.push(out);
    }
}
