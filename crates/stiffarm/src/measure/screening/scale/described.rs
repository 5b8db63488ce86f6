//! Slips of the cell and of headings that the directions of the displacements
//! show: load cases exchanged, an anchor or loading point in another unit, angles
//! of a table of displacements in radians. Each is tried; it is believed where
//! everything fits with it and little fits without.

use super::super::motion::displacement;
use super::super::{Cause, Evidence, Suspicion, Work};
use super::fit::{Fitted, clear_moves, fit, scaled};
use super::units::{INCH, RADIAN};
use crate::model::load::{Load, LoadCase};
use crate::numerics::arrangements::orders;
use crate::numerics::order::sort_by_number;
use nalgebra::Isometry3;

/// Mean misfit, over the larger of read and expected, above which causes are tried.
const POOR: f64 = 0.1;
/// What a change must leave of the mean misfit, and least distance to the next best.
const FALLEN: f64 = 0.5;
const DISTINCT: f64 = 0.75;
/// Misfit of a posture that is looked into: at least, and in medians.
const OFF: [f64; 2] = [0.2, 2.0];
/// Share of the displacements that the right case must explain beyond the stated one.
const EXPLAINS: f64 = 0.15;
/// Load cases of which every order is tried.
const MOST_CASES: usize = 5;
/// Angles all below this may be radians, one above may be degrees taken for radians \[rad\].
const LIKE_RADIANS: f64 = 0.122;
const LIKE_DEGREES: f64 = 13.0;
/// A loading point this near to the flange's origin, and not on it, is a metre typed as a
/// millimetre \[m\].
const BESIDE: f64 = 2e-3;
/// Factors that lengths are off by.
const LENGTHS: [f64; 4] = [1e3, 1e-3, INCH, 1.0 / INCH];

/// The change that is tried.
#[derive(Debug, Clone, PartialEq)]
enum Change {
    Cases(Vec<usize>),
    Anchor(f64),
    LoadingPoint(f64),
    Angles(f64),
}

impl Change {
    fn apply(&self, work: &mut Work) {
        match self {
            Change::Cases(order) => {
                let cases = work.setup().load.cases().to_vec();
                for p in 0..work.sheet.postures.len() {
                    relabel(work, p, &cases, order);
                }
            }
            Change::Anchor(factor) => scale_anchors(&mut work.cell.setup.load, *factor),
            Change::LoadingPoint(factor) => work.cell.setup.tool.loading_point *= *factor,
            Change::Angles(factor) => {
                let states = work.sheet.postures.iter_mut().flat_map(|p| &mut p.states);
                states.for_each(|s| s.q.iter_mut().for_each(|q| *q *= *factor));
            }
        }
    }

    fn suspicion(&self, work: &Work) -> Suspicion {
        match self {
            Change::Cases(order) => exchanged(work, order),
            Change::Anchor(factor) => with(Cause::AnchorUnits, *factor),
            Change::LoadingPoint(factor) => with(Cause::LoadingPointUnits, *factor),
            Change::Angles(factor) if *factor > 1.0 => with(Cause::Radians, *factor),
            Change::Angles(factor) => with(Cause::Degrees, *factor),
        }
    }
}

fn with(cause: Cause, factor: f64) -> Suspicion {
    let mut out = Suspicion::new(cause);
    out.factor = Some(factor);
    out
}

fn exchanged(work: &Work, order: &[usize]) -> Suspicion {
    let mut out = Suspicion::new(Cause::ExchangedLoadCases);
    let cases = work.setup().load.cases();
    let moved = (0..order.len()).filter(|c| order[*c] != *c);
    out.states = moved.map(|c| cases[c].name.clone()).collect();
    out
}

/// Files the states of posture `p` under the cases they are taken for.
fn relabel(work: &mut Work, p: usize, cases: &[LoadCase], order: &[usize]) {
    for state in &mut work.sheet.postures[p].states {
        let Some(c) = cases.iter().position(|case| case.is_of(&state.name)) else {
            continue;
        };
        let rest = state.name[cases[c].name.len()..].to_string();
        state.name = format!("{}{rest}", cases[order[c]].name);
    }
}

fn scale_anchors(load: &mut Load, factor: f64) {
    match load {
        Load::Rope { anchor, .. } => *anchor *= factor,
        Load::Cases(cases) => {
            for case in cases {
                scale_anchors(&mut case.load, factor);
            }
        }
        _ => {}
    }
}

fn changes(work: &Work) -> Vec<Change> {
    let mut out = Vec::new();
    let load = &work.setup().load;
    let cases = load.cases().len();
    if (2..=MOST_CASES).contains(&cases) {
        out.extend(orders(cases).into_iter().map(Change::Cases));
    }
    let states = || work.sheet.postures.iter().flat_map(|p| &p.states);
    // A measured wrench knows no anchor.
    if load.has_rope() && states().all(|s| s.wrench.is_none()) {
        out.extend(LENGTHS.map(Change::Anchor));
    }
    if work.setup().tool.loading_point.norm() > 0.0 {
        out.extend(LENGTHS.map(Change::LoadingPoint));
    }
    if work.is_displacements {
        let largest = states()
            .flat_map(|s| &s.q)
            .fold(0.0_f64, |m, q| m.max(q.abs()));
        if largest < LIKE_RADIANS {
            out.push(Change::Angles(RADIAN));
        } else if largest > LIKE_DEGREES {
            out.push(Change::Angles(1.0 / RADIAN));
        }
    }
    out
}

/// Tries the changes and makes the one that is believed.
pub(super) fn check(work: &mut Work, base_from_tracker: &Isometry3<f64>, fitted: &Fitted) {
    let all = changes(work);
    best_of(work, base_from_tracker, fitted, all, f64::MAX);
    let told = work
        .found
        .iter()
        .any(|s| s.cause == Cause::LoadingPointUnits);
    let distance = work.setup().tool.loading_point.norm();
    let nearest = work.setup().tool.measuring_points.iter();
    let nearest = nearest.map(|p| p.position.norm()).fold(f64::MAX, f64::min);
    if !told && distance > 0.0 && distance < BESIDE && nearest > 10.0 * BESIDE {
        // The joints take up what little such a slip changes: the number itself tells.
        let mut out = with(Cause::LoadingPointUnits, LENGTHS[0]);
        out.evidence = Some(Evidence::File);
        out.off_m = Some(distance);
        out.certain = false;
        work.found.push(out);
    }
}

/// Load cases exchanged in the whole table, where that leaves much less than `other` does.
pub(super) fn exchange(
    work: &mut Work,
    base_from_tracker: &Isometry3<f64>,
    fitted: &Fitted,
    other: f64,
) {
    let mut all = changes(work);
    all.retain(|change| matches!(change, Change::Cases(_)));
    best_of(work, base_from_tracker, fitted, all, other);
}

fn best_of(
    work: &mut Work,
    base_from_tracker: &Isometry3<f64>,
    fitted: &Fitted,
    changes: Vec<Change>,
    other: f64,
) {
    let before = fitted.mean_misfit();
    if before < POOR {
        return;
    }
    let mut tried: Vec<(Change, f64)> = Vec::new();
    for change in changes {
        let mut copy = work.to_try();
        change.apply(&mut copy);
        let moves = clear_moves(&copy, base_from_tracker);
        if let Some(after) = fit(&copy, &moves) {
            tried.push((change, after.mean_misfit()));
        }
    }
    sort_by_number(&mut tried, |a| a.1);
    let next = tried.get(1).map_or(f64::MAX, |t| t.1).min(other);
    let Some((change, after)) = tried.into_iter().next() else {
        return;
    };
    if after > DISTINCT * next || after > FALLEN * before {
        return;
    }
    let mut out = change.suspicion(work);
    out.misfits = Some([before, after]);
    out.evidence = Some(Evidence::Readings);
    change.apply(work);
    work.found.push(out);
}

/// Single postures whose states are filed under another case than they were taken under.
pub(super) fn cases_of_postures(
    work: &mut Work,
    base_from_tracker: &Isometry3<f64>,
    fitted: &Fitted,
) -> bool {
    let cases = work.setup().load.cases().to_vec();
    if !(2..=MOST_CASES).contains(&cases.len()) {
        return false;
    }
    let limit = OFF[0].max(OFF[1] * fitted.level);
    let mut any = false;
    for p in 0..work.sheet.postures.len() {
        let own = fitted.states.iter().filter(|s| s.at.0 == p);
        if !own.clone().any(|s| s.misfit > limit) {
            continue;
        }
        let states: Vec<usize> = own.map(|s| s.at.1).collect();
        let misfit = |work: &Work| {
            let reference = *work.sheet.postures[p].references().first()?;
            let each = states.iter().map(|s| {
                let one = displacement(work, base_from_tracker, p, *s, reference)?;
                Some(scaled(&one, &fitted.compliance).misfit)
            });
            let all: Option<Vec<f64>> = each.collect();
            Some(all?.iter().sum::<f64>() / states.len() as f64)
        };
        let Some(before) = misfit(work) else { continue };
        let mut best: Option<(Vec<usize>, f64)> = None;
        for order in orders(cases.len()) {
            let mut copy = work.to_try();
            relabel(&mut copy, p, &cases, &order);
            if let Some(after) = misfit(&copy)
                && best.as_ref().is_none_or(|(_, b)| after < *b)
            {
                best = Some((order, after));
            }
        }
        let Some((order, after)) =
            best.filter(|(_, after)| *after < FALLEN * before && before - after > EXPLAINS)
        else {
            continue;
        };
        let mut out = exchanged(work, &order).posture(&work.sheet.postures[p].name.clone());
        // Of states that were not taken nothing is exchanged.
        let taken = &work.sheet.postures[p].states;
        out.states
            .retain(|name| taken.iter().any(|s| s.name.starts_with(name.as_str())));
        out.misfits = Some([before, after]);
        out.evidence = Some(Evidence::Readings);
        relabel(work, p, &cases, &order);
        work.found.push(out);
        any = true;
    }
    any
}
