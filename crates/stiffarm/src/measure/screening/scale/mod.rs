//! Scales: forces, lengths, angles or the prior typed in another unit, a load
//! with a slipped decimal point.
//!
//! Evidence in order of strength, and said as such ([`Evidence`](super::Evidence)):
//! readings against readings (a state against the others, moments against force
//! times lever, directions that fit only with another anchor or load case), the
//! file against itself (numbers in the names of states, the nominal load, sizes
//! that no test has), and last the prior stiffness and that of robots of the
//! class. One fault gives one finding: what was undone is not found again.

mod class;
mod common;
mod described;
mod entries;
mod evidence;
mod fit;
mod moments;

use super::motion::{Move, is_reversed};
use super::{Cause, Work};
use fit::{Fitted, clear_moves, fit};
use nalgebra::Isometry3;

/// Postures that show which of them disagrees.
const FEWEST_POSTURES: usize = 4;

/// Number of postures behind the moves.
fn postures(moves: &[Move]) -> usize {
    let mut all: Vec<usize> = moves.iter().map(|m| m.posture).collect();
    all.sort_unstable();
    all.dedup();
    all.len()
}

impl Cause {
    /// True for a number that is off by a factor, and for what readings under
    /// load say of the cell: what follows from it in a fit is no finding of its own.
    pub fn is_scale(self) -> bool {
        matches!(
            self,
            Cause::Units
                | Cause::ToolUnits
                | Cause::RobotUnits
                | Cause::LoadUnits
                | Cause::LoadEntry
                | Cause::MomentUnits
                | Cause::DisplacementUnits
                | Cause::PriorUnits
                | Cause::AnchorUnits
                | Cause::LoadingPointUnits
                | Cause::ExchangedLoadCases
                | Cause::DisplacementSize
        )
    }
}

/// Checks the scales and undoes in `work` what it finds, but for a common factor,
/// which nothing after this rests on.
pub(super) fn check(work: &mut Work, base_from_tracker: &Isometry3<f64>) {
    let fitted = |work: &Work| -> Option<(Vec<Move>, Fitted)> {
        let all = clear_moves(work, base_from_tracker);
        let scale_fit = fit(work, &all)?;
        Some((all, scale_fit))
    };
    // A sign that is wrong throughout is told elsewhere, and must not hide a factor.
    work.reversed = is_reversed(work, &clear_moves(work, base_from_tracker));
    if work.reversed && work.setup().load.has_cases() {
        // Loads to both sides that are exchanged look reversed too.
        let turned = fitted(work).map(|(_, scale_fit)| scale_fit.mean_misfit());
        work.reversed = false;
        if let Some((_, scale_fit)) = fitted(work) {
            described::exchange(work, base_from_tracker, &scale_fit, turned.unwrap_or(f64::MAX));
        }
        work.reversed = is_reversed(work, &clear_moves(work, base_from_tracker));
    }
    let all = clear_moves(work, base_from_tracker);
    moments::check(work, &all);
    // A few states fit whatever is tried.
    let enough = postures(&all) >= FEWEST_POSTURES;
    for check in [described::check, described::cases_of_postures, entries::check] {
        if let Some((all, scale_fit)) = fitted(work).filter(|_| enough) {
            check(work, base_from_tracker, &all, &scale_fit);
        }
    }
    if let Some((all, scale_fit)) = fitted(work) {
        let suspicion = common::check(work, &all, &scale_fit);
        work.suspicions.extend(suspicion);
    }
    work.reversed = false;
}
