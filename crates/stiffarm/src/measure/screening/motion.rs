//! Displacements under load: their size, and their sign. A passive arm yields
//! along the load: the work F·δ + M·φ at the loading point is never negative.

use super::rigid::is_spread;
use super::slip::name_states;
use super::{Cause, Suspicion, Work};
use crate::measure::reduction::Motion;
use crate::model::kinematics::Frames;
use crate::model::load::Wrench;
use crate::model::measurement::Role;
use crate::model::observation::PostureTerms;
use crate::numerics::information::Factor;
use crate::numerics::sample::median;
use nalgebra::{DMatrix, DVector, Isometry3, Vector3};

/// Displacements below this many standard deviations say nothing.
pub(super) const CLEAR_STDS: f64 = 10.0;
/// Cosine between force and yield, and between displacement and expectation,
/// that count as a sign.
const YIELDS: f64 = 0.3;
const ALONG_COSINE: f64 = 0.6;
/// Ratio to the prior's displacement, for all alike, that a unit explains.
const UNIT: f64 = 30.0;
/// Ratio to the others that one state's load explains: with and without prior.
const OTHER: [f64; 2] = [10.0, 30.0];
/// Stands in for compliances where only the relative size matters \[rad/(N·m)\].
const SOME_COMPLIANCE: f64 = 1e-6;

/// The displacement of one state against the posture's unloaded state.
pub(super) struct Move {
    pub posture: usize,
    pub state: usize,
    pub reference: usize,
    /// Measuring points, in the order of the rows.
    pub points: Vec<usize>,
    /// Loaded minus unloaded, base axes \[m\], without the motion that reflectors
    /// on the base show: rows for point, x, y, z.
    pub shift: DVector<f64>,
    /// Ψ of these rows.
    pub block: DMatrix<f64>,
    /// Displacement by a known series compliance \[m\].
    pub series_shift: DVector<f64>,
    /// Standard deviation of a component by the cell \[m\].
    pub std: f64,
    /// The wrench, loaded minus unloaded, about the loading point in base axes.
    pub wrench: Wrench,
    /// Points from the loading point, base axes \[m\].
    arms: Vec<Vector3<f64>>,
}

impl Move {
    pub fn is_of(&self, at: (usize, usize)) -> bool {
        self.posture == at.0 && (self.state == at.1 || self.reference == at.1)
    }

    /// The state on the other side of the difference.
    pub fn other_than(&self, at: (usize, usize)) -> (usize, usize) {
        if self.state == at.1 { (self.posture, self.reference) } else { (self.posture, self.state) }
    }

    pub fn is_doubtful(&self, work: &Work) -> bool {
        let doubtful = |s: usize| !work.sheet.at((self.posture, s)).doubtful.is_empty();
        doubtful(self.state) || doubtful(self.reference)
    }

    /// RMS of the components \[m\].
    fn size(&self) -> f64 {
        rms(&self.shift)
    }

    /// Cosine between the load and how the loading point yields: the work over
    /// the product of the sizes. `None` where the points do not tell.
    fn yields(&self) -> Option<f64> {
        let count = self.arms.len();
        let (shift, turn) = if is_spread(&self.arms) {
            // d = δ + φ × arm, by least squares.
            let mut rows = DMatrix::zeros(3 * count, 6);
            for (i, arm) in self.arms.iter().enumerate() {
                rows.fixed_view_mut::<3, 3>(3 * i, 0).fill_with_identity();
                rows.fixed_view_mut::<3, 3>(3 * i, 3).copy_from(&-arm.cross_matrix());
            }
            let motion = Factor::new(&rows).ok()?.solve(&self.shift);
            (motion.fixed_rows::<3>(0).into_owned(), motion.fixed_rows::<3>(3).into_owned())
        } else {
            let mean = (0..count).map(|i| self.shift.fixed_rows::<3>(3 * i).into_owned());
            (mean.sum::<Vector3<f64>>() / count as f64, Vector3::zeros())
        };
        let work = self.wrench.force.dot(&shift) + self.wrench.moment.dot(&turn);
        let sizes = self.wrench.force.norm() * shift.norm() + self.wrench.moment.norm() * turn.norm();
        (sizes > 0.0).then(|| work / sizes)
    }
}

fn rms(values: &DVector<f64>) -> f64 {
    (values.norm_squared() / values.len().max(1) as f64).sqrt()
}

/// Displacements of all loaded states whose wrench is known.
pub(super) fn moves(work: &Work, base_from_tracker: &Isometry3<f64>) -> Vec<Move> {
    let mut out = Vec::new();
    for (p, posture) in work.sheet.postures.iter().enumerate() {
        let Some(&reference) = posture.references().first() else {
            continue;
        };
        for (s, state) in posture.states.iter().enumerate() {
            if s != reference && state.role != Role::Unloaded {
                out.extend(displacement(work, base_from_tracker, p, s, reference));
            }
        }
    }
    out
}

pub(super) fn displacement(
    work: &Work,
    base_from_tracker: &Isometry3<f64>,
    p: usize,
    s: usize,
    reference: usize,
) -> Option<Move> {
    let (state, before) = (work.sheet.at((p, s)), work.sheet.at((p, reference)));
    let setup = &*work.setup().of_state(&state.name).ok()?;
    let wrench = wrench(work, state, before)?;
    let sign = if work.reversed { -1.0 } else { 1.0 };
    let terms = PostureTerms::new(setup, &before.q, wrench.as_ref()).ok()?;
    let (block, series_shift) = (terms.block(&setup.robot), terms.known_displacement(&setup.tool));
    let points: Vec<usize> =
        (0..state.points.len()).filter(|a| state.points[*a].is_some() && before.points[*a].is_some()).collect();
    let rows: Vec<usize> = points.iter().flat_map(|a| 3 * a..3 * a + 3).collect();
    // What the base itself does under the load is no yielding of the arm.
    let base =
        Motion::between(state.base.iter().filter_map(|(name, now)| Some((*before.base.get(name)?, *now)))).ok()?;
    let (mut shift, mut variance, mut arms) = (Vec::new(), 0.0_f64, Vec::new());
    for a in &points {
        let (now, then) = (state.points[*a]?, before.points[*a]?);
        let read_variance = now.std.powi(2) + then.std.powi(2);
        let (position, added) = match &base {
            Some(base) => (base.removed(&now.position), 0.5 * read_variance * base.added_variance(&now.position)),
            None => (now.position, 0.0),
        };
        let moved = base_from_tracker.rotation * (position - then.position);
        shift.extend(moved.iter().copied());
        variance = variance.max(read_variance + added);
        arms.push(terms.measuring_points()[*a] - terms.loading_point());
    }
    (!points.is_empty()).then(|| Move {
        posture: p,
        state: s,
        reference,
        points,
        shift: DVector::from_vec(shift),
        block: block.select_rows(&rows) * sign,
        series_shift: series_shift.select_rows(&rows) * sign,
        std: variance.sqrt(),
        wrench: terms.wrench().map(|v| v * sign),
        arms,
    })
}

/// The wrench that state `now` has more than `before`, at the loading point in
/// base axes; `Some(None)` for the cell's own load, `None` where nothing tells.
fn wrench(work: &Work, now: &super::sheet::State, before: &super::sheet::State) -> Option<Option<Wrench>> {
    let setup = &*work.setup().of_state(&now.name).ok()?;
    let frames = Frames::new(&setup.robot, &before.q);
    let at = frames.point(&setup.tool.loading_point);
    if let Some(loaded) = now.wrench {
        let zero = Wrench::force(Vector3::zeros());
        let unloaded = before.wrench.unwrap_or(zero);
        let more = Wrench { force: loaded.force - unloaded.force, moment: loaded.moment - unloaded.moment };
        let mut out = match &work.cell.sensor {
            Some(sensor) => sensor.wrench_on_robot(&frames, &more, &at),
            None => more,
        };
        if !work.sheet.has_moments {
            // A force alone is taken to act at the loading point.
            out.moment = Vector3::zeros();
        }
        return Some(Some(out));
    }
    let modelled = setup.load.wrench(&frames, &at)?;
    let full = setup.load.size().filter(|size| *size > 0.0);
    let (Some(load), Some(full)) = (now.load, full) else {
        return Some(None);
    };
    let factor = (load - before.load.unwrap_or(0.0)) / full;
    Some(Some(Wrench { force: modelled.force * factor, moment: modelled.moment * factor }))
}

/// Size of the load of a state as the table or the cell has it \[N\].
pub(super) fn load_of(work: &Work, state: &super::sheet::State) -> Option<f64> {
    let case_size = || work.setup().of_state(&state.name).ok()?.load.size();
    state.load.or_else(case_size)
}

/// One displacement as judged.
struct JudgedDisplacement {
    at: (usize, usize),
    /// Along the load (1), against it (−1), or not clear (0).
    sign: i32,
    /// Size over expected size, where both are clear.
    ratio: Option<f64>,
    still: bool,
}

/// True where more displacements go against their load than along it.
pub(super) fn is_reversed(work: &Work, moves: &[Move]) -> bool {
    let compliance = compliance(work);
    let signs = moves.iter().map(|m| judge(work, m, &compliance).sign);
    signs.sum::<i32>() < 0
}

/// By the prior, else equal for all.
fn compliance(work: &Work) -> DVector<f64> {
    let n = work.setup().robot.spring_count();
    match &work.cell.prior {
        Some(prior) => DVector::from_iterator(n, prior.iter().map(|k| 1.0 / k)),
        None => DVector::from_element(n, SOME_COMPLIANCE),
    }
}

/// Checks size and sign of all displacements. Without a frame nothing can be said.
pub(super) fn check(work: &mut Work, frame: Option<&super::frame::Frame>) {
    let Some(frame) = frame else { return };
    let motions = moves(work, &frame.base_from_tracker);
    let compliance = compliance(work);
    let judged: Vec<JudgedDisplacement> = motions.iter().map(|m| judge(work, m, &compliance)).collect();
    still(work, &judged);
    signs(work, &judged);
    sizes(work, &judged);
}

fn judge(work: &Work, one: &Move, compliance: &DVector<f64>) -> JudgedDisplacement {
    let expected = &one.block * compliance + &one.series_shift;
    let has_prior = work.cell.prior.is_some();
    let clear = one.size() > CLEAR_STDS * one.std;
    let expects = !has_prior || rms(&expected) > CLEAR_STDS * one.std;
    let along = one.shift.dot(&expected) / (one.shift.norm() * expected.norm());
    let yields = one.yields().filter(|_| clear).unwrap_or(0.0);
    let along = if clear && expects && has_prior && along.is_finite() { along } else { 0.0 };
    let sign = match () {
        () if yields < -YIELDS || along < -ALONG_COSINE => -1,
        () if yields > YIELDS || along > ALONG_COSINE => 1,
        () => 0,
    };
    JudgedDisplacement {
        at: (one.posture, one.state),
        sign,
        ratio: ((expects || clear) && rms(&expected) > 0.0).then(|| one.size() / rms(&expected)),
        still: one.shift.norm() == 0.0 || (has_prior && expects && one.size() < 2.0 * one.std),
    }
}

/// States in which nothing moved.
fn still(work: &mut Work, judged: &[JudgedDisplacement]) {
    let at: Vec<_> = judged.iter().filter(|j| j.still).map(|j| j.at).collect();
    if at.is_empty() {
        return;
    }
    let mut suspicion = Suspicion::new(Cause::NoDisplacement);
    if at.len() < judged.len() {
        suspicion = name_states(work, suspicion, &at);
    }
    work.suspicions.push(suspicion);
}

/// Displacements against the load: of all states, or of single ones.
fn signs(work: &mut Work, judged: &[JudgedDisplacement]) {
    let with = |sign: i32| -> Vec<(usize, usize)> { judged.iter().filter(|j| j.sign == sign).map(|j| j.at).collect() };
    let (against, along) = (with(-1), with(1));
    if against.is_empty() {
        return;
    }
    if against.len() > along.len() {
        let mut suspicion = Suspicion::new(Cause::ReversedForce);
        // A few that go along are left to be found once the sign is right.
        suspicion.factor = Some(-1.0);
        work.suspicions.push(suspicion);
        return;
    }
    let suspicion = name_states(work, Suspicion::new(Cause::ExchangedStates), &against);
    work.suspicions.push(suspicion);
}

/// Displacements of another size than expected: of all states, or of single ones.
fn sizes(work: &mut Work, judged: &[JudgedDisplacement]) {
    let ratios: Vec<f64> = judged.iter().filter_map(|j| j.ratio).collect();
    if ratios.is_empty() {
        return;
    }
    let middle = median(&ratios);
    let has_prior = work.cell.prior.is_some();
    let is_off = |ratio: f64, limit: f64| ratio > limit || ratio < 1.0 / limit;
    // What has a name is said already.
    let named = work.suspicions.iter().any(|s| {
        let common = matches!(s.cause, Cause::LoadUnits | Cause::PriorUnits);
        common && s.postures.is_empty()
    });
    if has_prior && !named && middle > 0.0 && is_off(middle, UNIT) && !judged.iter().all(|j| j.still) {
        let mut suspicion = Suspicion::new(Cause::DisplacementSize);
        suspicion.factor = Some(middle);
        work.suspicions.push(suspicion);
    }
    let limit = OTHER[usize::from(!has_prior)];
    for one in judged.iter().filter(|j| !j.still) {
        let Some(ratio) = one.ratio.filter(|_| middle > 0.0 && judged.len() > 2) else {
            continue;
        };
        if is_off(ratio / middle, limit) {
            let mut suspicion = name_states(work, Suspicion::new(Cause::OtherLoad), &[one.at]);
            suspicion.factor = Some(ratio / middle);
            work.suspicions.push(suspicion);
        }
    }
}
