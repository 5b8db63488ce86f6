//! The robot's description against all unloaded readings: what is wrong with
//! every posture alike.

use super::frame::{self, Frame, PLAUSIBLE, fitted, item_pairs, items};
use super::{ALIKE, BELIEVED, Cause, FITTED, Suspicion, Work, moved, tool};
use crate::measure::registration::axis_slips;
use crate::numerics::arrangements::exchanges_first;
use crate::numerics::order::sort_by_number;
use crate::units::{deg_to_rad, rad_to_deg};
use nalgebra::{Isometry3, Matrix3, Rotation3, UnitQuaternion, Vector3};

/// Misfit of most postures above which causes are looked for \[m\].
const SUSPICIOUS: f64 = 2e-3;
/// Misfit that is reported where no cause is found \[m\].
const UNEXPLAINED: f64 = 1e-2;
/// Angles that all lie below this may be radians \[deg\].
const LIKE_RADIANS: f64 = 7.0;
/// Angles one of which lies above this may be degrees read as radians \[deg\].
const LIKE_DEGREES: f64 = 800.0;
/// Steps in which an offset of a joint is looked for \[deg\], and how often the
/// step is then halved.
const OFFSET_STEP: f64 = 15.0;
const HALVINGS: usize = 14;
/// Smallest offset of a joint that is named \[deg\]; a robot that nobody calibrated
/// has smaller ones, which do not matter to Ψ.
const SMALLEST_OFFSET: f64 = 0.3;
/// Of more than twice so many postures a sample is tried first.
const MANY: usize = 100;
/// Joints beyond which not all patterns of signs are tried.
const ALL_SIGNS: usize = 6;

/// What may be wrong with the whole description.
#[derive(Debug, Clone)]
enum Change {
    /// The tracker's axes are mirrored; this undoes it.
    Mirror(Matrix3<f64>),
    /// Points labelled in another order throughout.
    Order(Vec<usize>),
    /// These joints turn the other way, and perhaps axis 3 follows axis 2 by another factor.
    Chain(Vec<usize>, Option<f64>),
    /// The rows are meant in the other convention.
    Rows,
    /// A joint's angle has an offset \[rad\].
    Offset(usize, f64),
    /// The measuring points sit elsewhere on the flange.
    Tool(Isometry3<f64>),
    /// The angles are radians.
    Radians,
    /// The angles are degrees, read as radians.
    Degrees,
}

impl Change {
    /// How much at once this change supposes; simpler causes are believed first.
    fn complexity(&self) -> usize {
        match self {
            Change::Mirror(_) | Change::Rows | Change::Radians | Change::Degrees => 1,
            Change::Order(order) => (0..order.len()).filter(|a| order[*a] != *a).count() - 1,
            Change::Chain(signs, coupling) => signs.len() + usize::from(coupling.is_some()),
            Change::Offset(..) => 2,
            Change::Tool(_) => 6,
        }
    }

    /// Makes the change in `work`.
    fn apply(&self, work: &mut Work) {
        match self {
            Change::Mirror(undo) => work.sheet.each_position(|p| *p = undo * *p),
            Change::Order(order) => {
                for at in work.sheet.states() {
                    work.sheet.at_mut(at).relabel(order);
                }
            }
            Change::Chain(signs, factor) => {
                let mut coupling = work.setup().robot.coupling().clone();
                if let Some(factor) = factor {
                    coupling[(2, 1)] = *factor;
                }
                for j in signs {
                    coupling.column_mut(*j).neg_mut();
                }
                // A chain that cannot be built stays as it was, and explains nothing.
                if let Ok(robot) = work.setup().robot.clone().with_coupling(coupling) {
                    work.cell.setup.robot = robot;
                }
            }
            Change::Rows => {
                if let Some(robot) = work.setup().robot.in_other_convention() {
                    work.cell.setup.robot = robot;
                }
            }
            Change::Offset(j, offset) => {
                each_angle(work, |i, q| if i == *j { q + offset } else { q })
            }
            Change::Tool(motion) => tool::apply(work, motion),
            Change::Radians => each_angle(work, |_, q| rad_to_deg(q)),
            Change::Degrees => each_angle(work, |_, q| deg_to_rad(q)),
        }
    }

    fn suspicion(&self, work: &Work) -> Suspicion {
        match self {
            Change::Mirror(_) => Suspicion::new(Cause::MirroredFrame),
            Change::Tool(motion) => tool::suspicion(motion),
            Change::Rows => Suspicion::new(Cause::DhConvention),
            Change::Radians => Suspicion::new(Cause::Radians),
            Change::Degrees => Suspicion::new(Cause::Degrees),
            Change::Order(order) => exchanged(work, order),
            Change::Chain(signs, None) => {
                Suspicion::new(Cause::JointSign).joints(&work.cell, signs)
            }
            Change::Chain(signs, Some(factor)) => {
                let mut out = Suspicion::new(Cause::Coupling).joints(&work.cell, signs);
                out.factor = Some(*factor);
                out
            }
            Change::Offset(j, offset) => {
                let mut out = Suspicion::new(Cause::JointOffset).joints(&work.cell, &[*j]);
                out.angles_deg = vec![rad_to_deg(*offset)];
                out
            }
        }
    }
}

/// Points exchanged: `order[a]` is where the reading labelled `a` was taken.
pub(super) fn exchanged(work: &Work, order: &[usize]) -> Suspicion {
    let moved = (0..order.len()).filter(|a| order[*a] != *a);
    Suspicion::new(Cause::ExchangedPoints).points(moved.map(|a| work.point_name(a)))
}

fn each_angle(work: &mut Work, change: impl Fn(usize, f64) -> f64) {
    for state in work.sheet.postures.iter_mut().flat_map(|p| &mut p.states) {
        for (j, q) in state.q.iter_mut().enumerate() {
            *q = change(j, *q);
        }
    }
}

/// Registration of the unloaded readings; where they disagree throughout, the
/// cause that explains them, which is then undone in `work`.
pub(super) fn explain(work: &mut Work, given: Option<&Isometry3<f64>>) -> Option<Frame> {
    let Some(before) = fitted(work, given) else {
        work.found.push(Suspicion::new(Cause::NotChecked));
        return None;
    };
    let noise = 10.0 * work.sheet.typical_std();
    let throughout = before.trimmed > SUSPICIOUS.max(noise) || before.bad_count() > 1;
    if throughout && let Some(after) = undo(work, given, &before) {
        check_given(work, given, &after);
        return Some(after);
    }
    if let Some(frame) = moved::explain(work, given, throughout) {
        check_given(work, given, &frame);
        return Some(frame);
    }
    let majority = 2 * before.bad_count() < before.bad.len();
    if before.level > UNEXPLAINED || (throughout && !majority && before.trimmed > UNEXPLAINED) {
        let off = before.level.max(before.trimmed);
        work.found
            .push(Suspicion::new(Cause::UnexplainedModel).off(off));
        return None;
    }
    check_given(work, given, &before);
    Some(before)
}

/// A given transform that is far from what the readings say.
fn check_given(work: &mut Work, given: Option<&Isometry3<f64>>, frame: &Frame) {
    let Some(given) = given else { return };
    let at = items(work);
    let pairs = item_pairs(work, work.setup(), &at);
    let good: Vec<_> = pairs
        .into_iter()
        .zip(&frame.bad)
        .filter(|(_, bad)| !**bad)
        .flat_map(|(pairs, _)| pairs)
        .collect();
    let (stated, own) = (frame::rms(given, &good), frame.level);
    if stated > (BELIEVED * own).max(SUSPICIOUS) {
        let turn = given.rotation.angle_to(&frame.base_from_tracker.rotation);
        let mut suspicion = Suspicion::new(Cause::GivenTransform).misfit(stated, own);
        suspicion.angles_deg = vec![rad_to_deg(turn)];
        work.found.push(suspicion);
    }
}

/// One change with the registration it leads to.
struct Trial {
    change: Change,
    frame: Frame,
}

impl Trial {
    /// The slips of hand that mirror the readings so and leave the tracker as it is `given`, or
    /// parallel to the base; none for other changes.
    fn axis_slips(&self, given: Option<&Isometry3<f64>>) -> Vec<(String, Matrix3<f64>)> {
        let Change::Mirror(mirror) = self.change else {
            return Vec::new();
        };
        let own = self.frame.base_from_tracker.rotation.to_rotation_matrix();
        let wanted = given.map_or_else(UnitQuaternion::identity, |given| given.rotation);
        axis_slips(|undo| {
            // What the one undoes and the other does is a rotation.
            let turned = Rotation3::from_matrix_unchecked(own.matrix() * mirror * undo);
            UnitQuaternion::from_rotation_matrix(&turned).angle_to(&wanted)
        })
    }
}

/// Finds the simplest change that explains all postures and makes it.
fn undo(work: &mut Work, given: Option<&Isometry3<f64>>, before: &Frame) -> Option<Frame> {
    let mut believed: Vec<Trial> = Vec::new();
    let few = thinned(work);
    let before_few = match &few {
        Some(few) => fitted(few, given)?,
        None => before.clone(),
    };
    let explained = |frame: &Frame, before: &Frame| {
        frame.trimmed * BELIEVED < before.trimmed.max(worst(before))
            && frame.trimmed < PLAUSIBLE
            && 4 * frame.bad_count() <= frame.bad.len()
            && frame.bad_count() < before.bad_count().max(1)
    };
    let consider = |believed: &mut Vec<Trial>, change: Change| {
        // What does not explain a sample of many postures does not explain all.
        if let Some(few) = &few
            && !tried(few, &change, given).is_some_and(|frame| explained(&frame, &before_few))
        {
            return;
        }
        if let Some(frame) = tried(work, &change, given).filter(|f| explained(f, before)) {
            believed.push(Trial { change, frame });
        }
    };
    for change in changes(work) {
        consider(&mut believed, change);
    }
    // An offset is looked for at length, and supposes more than one simple slip.
    if believed.iter().all(|t| t.change.complexity() > 1) {
        for j in 0..work.setup().robot.joint_count() {
            if let Some(change) = offset(few.as_ref().unwrap_or(work), j) {
                consider(&mut believed, change);
            }
        }
    }
    // Six numbers explain much: they are asked where nothing simpler does.
    if believed.is_empty()
        && let Some(motion) = tool::place(few.as_ref().unwrap_or(work))
    {
        consider(&mut believed, Change::Tool(motion));
    }
    let noise = work.sheet.typical_std();
    let weighed = |t: &Trial| match t.change {
        Change::Offset(..) => t.frame.trimmed * FITTED,
        _ => t.frame.trimmed,
    };
    let best = believed.iter().map(weighed).reduce(f64::min)?;
    believed.retain(|t| weighed(t) <= ALIKE * best + FITTED * noise);
    let simplest = believed.iter().map(|t| t.change.complexity()).min()?;
    believed.retain(|t| t.change.complexity() == simplest);
    sort_by_number(&mut believed, |a| a.frame.trimmed);
    let mut trials = believed.into_iter();
    let mut first = trials.next()?;
    let slips = first.axis_slips(given);
    if let Some((_, undo)) = slips.first() {
        first.change = Change::Mirror(*undo);
        first.frame = tried(work, &first.change, given)?;
    }
    let mut suspicion = first
        .change
        .suspicion(work)
        .misfit(before.trimmed.max(before.level), first.frame.trimmed);
    suspicion.axis_slips = slips.into_iter().map(|(said, _)| said).collect();
    for other in trials {
        let phrase = super::messages::cause(&work.cell, &other.change.suspicion(work));
        suspicion.alternatives.push(phrase);
    }
    suspicion.certain = suspicion.alternatives.is_empty();
    first.change.apply(work);
    work.found.push(suspicion);
    Some(first.frame)
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
        let kept = sheet.postures.into_iter().step_by(step);
        sheet.postures = kept.collect();
        Work::new(&work.cell, sheet, Vec::new())
    })
}

fn tried(work: &Work, change: &Change, given: Option<&Isometry3<f64>>) -> Option<Frame> {
    let mut copy = work.to_try();
    change.apply(&mut copy);
    fitted(&copy, given)
}

/// Everything that is tried, but offsets.
fn changes(work: &Work) -> Vec<Change> {
    let n = work.setup().robot.joint_count();
    let mirror = Matrix3::from_diagonal(&Vector3::new(-1.0, 1.0, 1.0));
    let mut out = vec![Change::Mirror(mirror), Change::Rows];
    let largest = work
        .sheet
        .states()
        .into_iter()
        .flat_map(|at| work.sheet.at(at).q.clone())
        .fold(0.0, |m, q| rad_to_deg(q.abs()).max(m));
    if largest < LIKE_RADIANS {
        out.push(Change::Radians);
    } else if largest > LIKE_DEGREES {
        out.push(Change::Degrees);
    }
    let points = work.setup().tool.point_count();
    out.extend(exchanges_first(points).into_iter().map(Change::Order));
    let mut couplings = vec![None];
    if n > 2 {
        let stated = work.setup().robot.coupling()[(2, 1)];
        couplings.extend(
            [0.0, 1.0, -1.0]
                .into_iter()
                .filter(|f| *f != stated)
                .map(Some),
        );
    }
    let most = if n <= ALL_SIGNS { n } else { 2 };
    for pattern in 0_u64..1 << n.min(20) {
        let signs: Vec<usize> = (0..n).filter(|j| pattern >> j & 1 == 1).collect();
        if signs.len() > most {
            continue;
        }
        for factor in &couplings {
            if !(signs.is_empty() && factor.is_none()) {
                out.push(Change::Chain(signs.clone(), *factor));
            }
        }
    }
    out
}

/// The offset of joint `j` that suits the readings best.
fn offset(work: &Work, j: usize) -> Option<Change> {
    let score = |degrees: f64| {
        tried(work, &Change::Offset(j, deg_to_rad(degrees)), None)
            .map_or(f64::INFINITY, |f| f.trimmed)
    };
    let steps = (360.0 / OFFSET_STEP) as i32;
    let mut best = (f64::INFINITY, 0.0);
    for i in 0..steps {
        let degrees = f64::from(i - steps / 2) * OFFSET_STEP;
        let value = score(degrees);
        if value < best.0 {
            best = (value, degrees);
        }
    }
    let mut step = OFFSET_STEP / 2.0;
    for _ in 0..HALVINGS {
        for degrees in [best.1 - step, best.1 + step] {
            let value = score(degrees);
            if value < best.0 {
                best = (value, degrees);
            }
        }
        step /= 2.0;
    }
    (best.1.abs() > SMALLEST_OFFSET).then(|| Change::Offset(j, deg_to_rad(best.1)))
}
