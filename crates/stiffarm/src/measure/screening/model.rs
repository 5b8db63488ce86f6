//! The robot's description against all unloaded readings: what is wrong with
//! every posture alike.

use super::frame::{self, Frame, PLAUSIBLE, fitted, item_pairs, items};
use super::misfit::best_around;
use super::slip::{Rule, Slip, Undo, settle};
use super::units::of_angles;
use super::{BELIEVED_RATIO, Cause, Suspicion, Work, moved, tool};
use crate::measure::registration::axis_slips;
use crate::numerics::arrangements::exchanges_first;
use crate::units::{deg_to_rad, rad_to_deg};
use nalgebra::{Isometry3, Matrix3, Rotation3, UnitQuaternion, Vector3};

/// Misfit of most postures above which causes are looked for \[m\].
const SUSPICIOUS: f64 = 2e-3;
/// Misfit that is reported where no cause is found \[m\].
const UNEXPLAINED: f64 = 1e-2;
/// Steps of a turn in which an offset of a joint is looked for, and how often the step is then halved.
const STEPS: usize = 24;
const HALVINGS: usize = 14;
/// Smallest offset of a joint that is named \[deg\]; a robot that nobody calibrated
/// has smaller ones, which do not matter to Ψ.
const SMALLEST_OFFSET: f64 = 0.3;
/// Of more than twice so many postures a sample is tried first.
const MANY: usize = 100;
/// Joints beyond which not all patterns of signs are tried.
const ALL_SIGNS: usize = 6;

/// Registration of the unloaded readings; where they disagree throughout, the
/// cause that explains them, which is then undone in `work`.
pub(super) fn explain(work: &mut Work, stated_transform: Option<&Isometry3<f64>>) -> Option<Frame> {
    let Some(before) = fitted(work, stated_transform) else {
        work.suspicions.push(Suspicion::new(Cause::NotChecked));
        return None;
    };
    let noise = 10.0 * work.sheet.typical_std();
    let throughout = before.trimmed > SUSPICIOUS.max(noise) || before.bad_count() > 1;
    if throughout && let Some(after) = undo(work, stated_transform, &before) {
        check_given(work, stated_transform, &after);
        return Some(after);
    }
    if let Some(frame) = moved::explain(work, stated_transform, throughout) {
        check_given(work, stated_transform, &frame);
        return Some(frame);
    }
    let majority = 2 * before.bad_count() < before.bad.len();
    if before.level > UNEXPLAINED || (throughout && !majority && before.trimmed > UNEXPLAINED) {
        let off = before.level.max(before.trimmed);
        work.suspicions.push(Suspicion::new(Cause::UnexplainedModel).off(off));
        return None;
    }
    check_given(work, stated_transform, &before);
    Some(before)
}

/// A given transform that is far from what the readings say.
fn check_given(work: &mut Work, stated_transform: Option<&Isometry3<f64>>, frame: &Frame) {
    let Some(stated_transform) = stated_transform else { return };
    let at = items(work);
    let pairs = item_pairs(work, work.setup(), &at);
    let good: Vec<_> =
        pairs.into_iter().zip(&frame.bad).filter(|(_, bad)| !**bad).flat_map(|(pairs, _)| pairs).collect();
    let (stated, level) = (frame::rms(stated_transform, &good), frame.level);
    if stated > (BELIEVED_RATIO * level).max(SUSPICIOUS) {
        let turn = stated_transform.rotation.angle_to(&frame.base_from_tracker.rotation);
        let mut suspicion = Suspicion::new(Cause::GivenTransform).misfit(stated, level);
        suspicion.angles_deg = vec![rad_to_deg(turn)];
        work.suspicions.push(suspicion);
    }
}

/// The slips of hand that mirror the readings as `mirror` undoes it, registered as `frame`, and leave the tracker as it
/// is `stated_transform` has it, or parallel to the base.
fn axis_slips_of(
    mirror: &Matrix3<f64>,
    frame: &Frame,
    stated_transform: Option<&Isometry3<f64>>,
) -> Vec<(String, Matrix3<f64>)> {
    let rotation = frame.base_from_tracker.rotation.to_rotation_matrix();
    let wanted = stated_transform.map_or_else(UnitQuaternion::identity, |stated_transform| stated_transform.rotation);
    axis_slips(|undo| {
        // What the one undoes and the other does is a rotation.
        let turned = Rotation3::from_matrix_unchecked(rotation.matrix() * mirror * undo);
        UnitQuaternion::from_rotation_matrix(&turned).angle_to(&wanted)
    })
}

/// Finds the simplest slip that explains all postures and undoes it.
fn undo(work: &mut Work, stated_transform: Option<&Isometry3<f64>>, before: &Frame) -> Option<Frame> {
    let few = thinned(work);
    let before_few = match &few {
        Some(few) => fitted(few, stated_transform)?,
        None => before.clone(),
    };
    let tried = |work: &Work, slip: &Slip| fitted(&work.without(slip), stated_transform);
    let explained = |frame: &Frame, before: &Frame| {
        frame.trimmed * BELIEVED_RATIO < before.trimmed.max(worst(before))
            && frame.trimmed < PLAUSIBLE
            && 4 * frame.bad_count() <= frame.bad.len()
            && frame.bad_count() < before.bad_count().max(1)
    };
    let left = |slip: Slip| {
        // What does not explain a sample of many postures does not explain all.
        if let Some(few) = &few {
            tried(few, &slip).filter(|frame| explained(frame, &before_few))?;
        }
        let frame = tried(work, &slip).filter(|frame| explained(frame, before))?;
        Some((slip, Some(frame.trimmed)))
    };
    let mut believed: Vec<_> = slips(work).into_iter().filter_map(left).collect();
    // An offset is looked for at length, and supposes more than one simple slip.
    if believed.iter().all(|(slip, _)| slip.cost > 1.0) {
        let offsets = (0..work.setup().robot.joint_count()).filter_map(|j| offset(few.as_ref().unwrap_or(work), j));
        believed.extend(offsets.filter_map(left));
    }
    // Six numbers explain much: they are asked where nothing simpler does.
    if believed.is_empty() {
        let place = tool::place(few.as_ref().unwrap_or(work));
        believed.extend(place.map(Undo::Tool).map(Slip::new).and_then(left));
    }
    let rule = Rule::of_places(work, f64::INFINITY, f64::INFINITY);
    let mut settled = settle(believed, &rule)?;
    let mut frame = tried(work, &settled.slip)?;
    let mut slips = Vec::new();
    if let Undo::Mirror(mirror) = &settled.slip.undo {
        slips = axis_slips_of(mirror, &frame, stated_transform);
    }
    if let Some((_, undo)) = slips.first() {
        settled.slip = Slip::new(Undo::Mirror(*undo));
        frame = tried(work, &settled.slip)?;
    }
    let mut suspicion = settled.suspicion(work);
    suspicion.axis_slips = slips.into_iter().map(|(said, _)| said).collect();
    let before = before.trimmed.max(before.level);
    work.undo(&settled.slip, suspicion.misfit(before, frame.trimmed));
    Some(frame)
}

/// RMS misfit over the postures that disagree, where most agree.
fn worst(frame: &Frame) -> f64 {
    frame.rms.iter().copied().fold(0.0, f64::max)
}

/// A sample of the postures, where they are many.
fn thinned(work: &Work) -> Option<Work> {
    let step = work.sheet.postures.len() / MANY;
    (step > 1).then(|| {
        let mut sheet = work.sheet.clone();
        let sampled = sheet.postures.into_iter().step_by(step);
        sheet.postures = sampled.collect();
        Work::new(&work.cell, sheet, Vec::new())
    })
}

/// Everything that is tried, but offsets.
fn slips(work: &Work) -> Vec<Slip> {
    let n = work.setup().robot.joint_count();
    let mirror = Matrix3::from_diagonal(&Vector3::new(-1.0, 1.0, 1.0));
    let mut out = vec![Undo::Mirror(mirror), Undo::Convention];
    let unit = of_angles(work.sheet.largest_angle());
    out.extend(unit.map(|(cause, unit)| Undo::Times(cause, unit)));
    let points = work.setup().tool.point_count();
    out.extend(exchanges_first(points).into_iter().map(Undo::Order));
    let mut couplings = vec![None];
    if n > 2 {
        let stated = work.setup().robot.coupling()[(2, 1)];
        let others = [0.0, 1.0, -1.0].into_iter().filter(|f| *f != stated);
        couplings.extend(others.map(Some));
    }
    let most = if n <= ALL_SIGNS { n } else { 2 };
    for pattern in 0_u64..1 << n.min(20) {
        let signs: Vec<usize> = (0..n).filter(|j| pattern >> j & 1 == 1).collect();
        if signs.len() > most {
            continue;
        }
        let changed = couplings.iter().filter(|f| !signs.is_empty() || f.is_some());
        out.extend(changed.map(|factor| Undo::Chain(signs.clone(), *factor)));
    }
    out.into_iter().map(Slip::new).collect()
}

/// The offset of joint `j` that suits the readings best.
fn offset(work: &Work, j: usize) -> Option<Slip> {
    let with = |degrees: f64| Slip::new(Undo::Offset(j, deg_to_rad(degrees)));
    let left = |degrees: f64| fitted(&work.without(&with(degrees)), None).map_or(f64::INFINITY, |f| f.trimmed);
    let (degrees, _) = best_around(360.0, STEPS, HALVINGS, left);
    (degrees.abs() > SMALLEST_OFFSET).then(|| with(degrees))
}
