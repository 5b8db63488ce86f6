//! Slips of the cell and of headings that the directions of the displacements
//! show: load cases exchanged, an anchor or loading point in another unit, angles
//! of a table of displacements in radians. Each is tried; it is believed where
//! everything fits with it and little fits without.

use super::super::motion::Move;
use super::super::slip::{Rule, SettledSlip, Slip, StateIndex, Undo, settle};
use super::super::units::{LENGTHS, of_angles};
use super::super::{Cause, Evidence, Work};
use super::fit::{Fitted, clear_moves, fit, misfit_of};
use crate::numerics::arrangements::orders;
use nalgebra::Isometry3;

/// Mean misfit, over the larger of read and expected, above which causes are tried.
const POOR_MISFIT: f64 = 0.1;
/// What a change must leave of the mean misfit, and least distance to the next best.
const REMAINING_SHARE: f64 = 0.5;
const DISTINCT: f64 = 0.75;
/// Misfit of a posture that is looked into: at least, and in medians.
const SUSPECT_MISFIT: [f64; 2] = [0.2, 2.0];
/// Share of the displacements that the right case must explain beyond the stated one.
const EXPLAINED_SHARE: f64 = 0.15;
/// Load cases of which every order is tried.
const MOST_CASES: usize = 5;
/// A loading point this near to the flange's origin, and not on it, is a metre typed as a
/// millimetre \[m\].
const BESIDE: f64 = 2e-3;

/// All that is tried for the whole table.
fn slips(work: &Work) -> Vec<Slip> {
    let mut out = Vec::new();
    let load = &work.setup().load;
    let cases = load.cases().len();
    if (2..=MOST_CASES).contains(&cases) {
        out.extend(orders(cases).into_iter().map(Undo::Cases));
    }
    let mut states = work.sheet.postures.iter().flat_map(|p| &p.states);
    // A measured wrench knows no anchor.
    if load.has_rope() && states.all(|s| s.wrench.is_none()) {
        out.extend(LENGTHS.map(|unit| Undo::Times(Cause::AnchorUnits, unit)));
    }
    if work.setup().tool.loading_point.norm() > 0.0 {
        out.extend(LENGTHS.map(|unit| Undo::Times(Cause::LoadingPointUnits, unit)));
    }
    if work.is_displacements {
        let unit = of_angles(work.sheet.largest_angle());
        out.extend(unit.map(|(cause, unit)| Undo::Times(cause, unit)));
    }
    out.into_iter().map(Slip::new).collect()
}

/// Tries the slips and undoes the one that is believed.
pub(super) fn check(work: &mut Work, base_from_tracker: &Isometry3<f64>, _: &[Move], fitted: &Fitted) {
    let undone = best_of(work, base_from_tracker, fitted, slips(work), f64::MAX);
    let is_undone = matches!(undone, Some(Undo::Times(Cause::LoadingPointUnits, _)));
    let distance = work.setup().tool.loading_point.norm();
    let nearest = work.setup().tool.measuring_points.iter();
    let nearest = nearest.map(|p| p.position.norm()).fold(f64::MAX, f64::min);
    if !is_undone && distance > 0.0 && distance < BESIDE && nearest > 10.0 * BESIDE {
        // The joints take up what little such a slip changes: the number itself tells.
        let slip = Slip::new(Undo::Times(Cause::LoadingPointUnits, LENGTHS[0]));
        let mut out = slip.suspicion(work).off(distance);
        out.evidence = Some(Evidence::File);
        out.certain = false;
        work.suspicions.push(out);
    }
}

/// Load cases exchanged in the whole table, where that leaves much less than `other` does.
pub(super) fn exchange(work: &mut Work, base_from_tracker: &Isometry3<f64>, fitted: &Fitted, other: f64) {
    let mut all = slips(work);
    all.retain(|slip| matches!(slip.undo, Undo::Cases(_)));
    best_of(work, base_from_tracker, fitted, all, other);
}

/// Undoes the slip that leaves much less than every other.
fn best_of(
    work: &mut Work,
    base_from_tracker: &Isometry3<f64>,
    fitted: &Fitted,
    slips: Vec<Slip>,
    other: f64,
) -> Option<Undo> {
    let before = fitted.mean_misfit();
    if before < POOR_MISFIT {
        return None;
    }
    let tried = slips.into_iter().map(|slip| {
        let copy = work.without(&slip);
        let after = fit(&copy, &clear_moves(&copy, base_from_tracker));
        (slip, after.map(|after| after.mean_misfit()))
    });
    let rule = Rule { most: f64::MAX, alike: [1.0 / DISTINCT, 0.0], beside: f64::MAX };
    let most = (REMAINING_SHARE * before).min(DISTINCT * other);
    let settled = settle(tried, &rule)?;
    (settled.others.is_empty() && settled.after <= most).then(|| note(work, settled, before))
}

/// Says what readings under load show, and goes on without it.
fn note(work: &mut Work, settled: SettledSlip, before: f64) -> Undo {
    let mut out = settled.slip.suspicion(work);
    out.misfits = Some([before, settled.after]);
    out.evidence = Some(Evidence::Readings);
    work.undo(&settled.slip, out);
    settled.slip.undo
}

/// Single postures whose states are filed under another case than they were taken under.
pub(super) fn cases_of_postures(work: &mut Work, base_from_tracker: &Isometry3<f64>, _: &[Move], fitted: &Fitted) {
    let cases = work.setup().load.cases().len();
    if !(2..=MOST_CASES).contains(&cases) {
        return;
    }
    let limit = SUSPECT_MISFIT[0].max(SUSPECT_MISFIT[1] * fitted.level);
    for p in 0..work.sheet.postures.len() {
        let of_posture = fitted.states.iter().filter(|s| s.at.0 == p);
        if !of_posture.clone().any(|s| s.misfit > limit) {
            continue;
        }
        let places: Vec<StateIndex> = of_posture.map(|s| s.at).collect();
        let left = |work: &Work| misfit_of(work, base_from_tracker, &places, fitted);
        let Some(before) = left(work) else { continue };
        let states = 0..work.sheet.postures[p].states.len();
        let rows: Vec<StateIndex> = states.map(|s| (p, s)).collect();
        let tried = orders(cases).into_iter().map(|order| {
            let slip = Slip::new(Undo::Cases(order)).at(&rows);
            let after = left(&work.without(&slip));
            (slip, after)
        });
        let rule =
            Rule { most: (REMAINING_SHARE * before).min(before - EXPLAINED_SHARE), alike: [1.0, 0.0], beside: 0.0 };
        if let Some(settled) = settle(tried, &rule) {
            note(work, settled, before);
        }
    }
}
