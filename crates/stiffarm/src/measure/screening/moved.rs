//! A tracker that was moved, or a robot that was driven on a rail, while nobody said so: runs of postures, one behind
//! the other, each of which fits the kinematic model in a frame of its own.
//!
//! A run ends where the longest one does that still fits like the best short ones; single postures that fit no run may
//! stand between. Two runs are believed when one frame for all leaves five times as much.

use super::frame::{Frame, item_pairs, items, rms, state_pairs};
use super::misfit::give;
use super::model::{PLAUSIBLE, fitted};
use super::{BELIEVED, Cause, Suspicion, Work};
use crate::findings::list;
use crate::measure::registration::{Agreement, Pair, moved, rigid_transform, robust};
use crate::model::measurement::Role;
use crate::units::rad_to_deg;
use nalgebra::Isometry3;

/// Unknowns of a frame, and how many more numbers a run must have.
const UNKNOWNS: usize = 6;
const SURPLUS: usize = 6;
/// Misfit below which a frame of its own does not matter to Ψ \[m\].
const SMALL: f64 = 5e-4;
/// Postures of the short runs that say how well the model can fit.
const SHORT: usize = 3;
/// A posture belongs to the run that it fits better by this factor.
const BETTER: f64 = 2.0;
/// When a posture is none of its run.
const AGREEMENT: Agreement = Agreement {
    factor: 10.0,
    floor: SMALL,
    floor_few: SMALL,
    many: 0,
    most: |count| count / 2 + 1,
    least: 1,
};

/// A run of items that one frame fits.
struct Run {
    first: usize,
    end: usize,
    base_from_tracker: Isometry3<f64>,
    level: f64,
    strays: usize,
}

/// Items in the order taken, station by station.
struct Order {
    at: Vec<(usize, usize)>,
    pairs: Vec<Vec<Pair>>,
}

impl Order {
    fn new(work: &Work) -> Self {
        let mut stations: Vec<&Option<String>> = Vec::new();
        for posture in &work.sheet.postures {
            if !stations.contains(&&posture.station) {
                stations.push(&posture.station);
            }
        }
        let station = |p: usize| {
            let own = &work.sheet.postures[p].station;
            stations.iter().position(|name| *name == own)
        };
        let mut at = items(work);
        at.sort_by_key(|(p, s)| (station(*p), *p, *s));
        Order {
            pairs: item_pairs(work, work.setup(), &at),
            at,
        }
    }

    /// Numbers that tell of a frame in the items from `first` to `end`: six of a posture at most.
    fn numbers(&self, first: usize, end: usize) -> usize {
        let mut count = 0;
        for i in first..end {
            if i == first || self.at[i].0 != self.at[i - 1].0 {
                count += (3 * self.pairs[i].len()).min(UNKNOWNS);
            }
        }
        count
    }

    fn is_enough(&self, first: usize, end: usize) -> bool {
        self.numbers(first, end) >= UNKNOWNS + SURPLUS
    }

    /// The shortest run from an item on that tells of a frame.
    fn shortest(&self, first: usize) -> Option<usize> {
        (first + 1..=self.at.len()).find(|end| self.is_enough(first, *end))
    }

    /// A frame for the items from `first` to `end`, none of them left out at either end.
    fn run(&self, first: usize, end: usize) -> Option<Run> {
        let found = robust(&self.pairs[first..end], AGREEMENT)?;
        let strays = found.bad.iter().filter(|bad| **bad).count();
        let is_whole = found.bad.first() == Some(&false) && found.bad.last() == Some(&false);
        (is_whole && 4 * strays <= end - first).then_some(Run {
            first,
            end,
            base_from_tracker: found.base_from_tracker,
            level: found.level,
            strays,
        })
    }

    /// How well short runs fit: what the better quarter of them leaves \[m\].
    fn level(&self) -> Option<f64> {
        let short = (0..self.at.len()).filter_map(|first| {
            let end = self.shortest(first)?.max(first + SHORT);
            let own = self.pairs.get(first..end)?;
            let all: Vec<Pair> = own.iter().flatten().copied().collect();
            let transform = rigid_transform(all.iter().copied())?;
            let freedom = (3 * all.len()).saturating_sub(UNKNOWNS).max(1) as f64;
            Some(rms(&transform, &all) * (3.0 * all.len() as f64 / freedom).sqrt())
        });
        let mut levels: Vec<f64> = short.collect();
        levels.sort_by(f64::total_cmp);
        levels.get(levels.len() / 4).copied()
    }

    /// All items in runs; `None` where too many fit none.
    fn runs(&self) -> Option<Vec<Run>> {
        let count = self.at.len();
        let allowed = (BELIEVED * self.level()?).clamp(SMALL, PLAUSIBLE);
        let (mut runs, mut strays, mut first) = (Vec::new(), 0, 0);
        while first < count {
            let ends = self.shortest(first).map_or(count + 1, |end| end)..=count;
            let mut whole = ends.rev().filter_map(|end| self.run(first, end));
            match whole.find(|run| run.level <= allowed) {
                Some(run) => {
                    first = run.end;
                    strays += run.strays;
                    runs.push(run);
                }
                None => {
                    first += 1;
                    strays += 1;
                }
            }
        }
        self.settle(&mut runs);
        (4 * strays <= count && runs.len() > 1).then_some(runs)
    }

    /// Gives the last items of a run to the next one where they fit it better.
    fn settle(&self, runs: &mut [Run]) {
        for next in 1..runs.len() {
            let (before, after) = runs.split_at_mut(next);
            let (Some(before), Some(after)) = (before.last_mut(), after.first_mut()) else {
                return;
            };
            let better = |i: usize| {
                let [own, other] =
                    [&*before, &*after].map(|run| rms(&run.base_from_tracker, &self.pairs[i]));
                BETTER * other < own
            };
            let kept = (before.first..before.end).rev().find(|i| !better(*i));
            let end = kept.map_or(before.first, |i| i + 1);
            if end < before.end && self.is_enough(before.first, end) {
                (before.end, after.first) = (end, end);
            }
        }
    }

    /// The pairs of a run that agree with it.
    fn agreeing<'o>(&'o self, run: &'o Run) -> impl Iterator<Item = &'o Vec<Pair>> {
        let limit = AGREEMENT.limit(run.level, run.end - run.first);
        let own = self.pairs[run.first..run.end].iter();
        own.filter(move |pairs| rms(&run.base_from_tracker, pairs) <= limit)
    }

    /// What one frame leaves of all runs, and what their own do \[m\].
    fn misfits(&self, runs: &[Run]) -> Option<[f64; 2]> {
        let good = |run| self.agreeing(run).flatten().copied();
        let all: Vec<Pair> = runs.iter().flat_map(good).collect();
        let one = rms(&rigid_transform(all.iter().copied())?, &all);
        let mut squares = 0.0;
        for run in runs {
            squares += run.level.powi(2) * good(run).count() as f64;
        }
        Some([one, (squares / all.len().max(1) as f64).sqrt()])
    }

    /// True where two frames divide what one leaves at once: no need to look further where they do not.
    fn is_suspected(&self) -> bool {
        let square = |first: usize, end: usize| -> Option<f64> {
            let own: Vec<Pair> = self.pairs[first..end].iter().flatten().copied().collect();
            let transform = rigid_transform(own.iter().copied())?;
            Some(rms(&transform, &own).powi(2) * own.len() as f64)
        };
        let count = self.at.len();
        let Some(one) = square(0, count) else {
            return false;
        };
        let total = self.pairs.iter().map(Vec::len).sum::<usize>() as f64;
        one > total * (SMALL / BELIEVED).powi(2)
            && (1..count).any(|b| {
                let both = square(0, b).zip(square(b, count));
                self.is_enough(0, b)
                    && self.is_enough(b, count)
                    && both.is_some_and(|(a, b)| (a + b) * BELIEVED.powi(2) < one)
            })
    }
}

/// Names moves of the tracker, undoes them and registers again; `None` where there are none. They are looked for where
/// the postures disagree throughout, and where two frames are at once much better than one.
pub(super) fn explain(
    work: &mut Work,
    given: Option<&Isometry3<f64>>,
    throughout: bool,
) -> Option<Frame> {
    let order = Order::new(work);
    if !(throughout || order.is_suspected()) {
        return None;
    }
    let runs = order.runs()?;
    let [before, after] = order.misfits(&runs)?;
    if before < (BELIEVED * after).max(SMALL) {
        return None;
    }
    for next in 1..runs.len() {
        let (old, new) = (&runs[next - 1], &runs[next]);
        let mut suspicion = Suspicion::new(Cause::MovedTracker).misfit(before, after);
        let [a, b] = [old, new].map(|run| &run.base_from_tracker);
        let points: Vec<&Pair> = order.agreeing(new).flatten().collect();
        let away = points
            .iter()
            .map(|(p, _)| (moved(a, p) - moved(b, p)).norm());
        suspicion.off_m = Some(away.sum::<f64>() / points.len().max(1) as f64);
        suspicion.angles_deg = vec![rad_to_deg(a.rotation.angle_to(&b.rotation))];
        let (p, s) = order.at[new.first];
        let last = order.at[new.first - 1];
        suspicion
            .station
            .clone_from(&work.sheet.postures[p].station);
        // A posture whose last states lie in the new frame alone was divided, too.
        let divided = if last.0 == p {
            Some(p)
        } else {
            (last.1 + 1..work.sheet.postures[last.0].states.len())
                .any(|s| is_of(work, (last.0, s), [a, b]))
                .then_some(last.0)
        };
        suspicion
            .divided
            .extend(divided.map(|p| work.sheet.postures[p].name.clone()));
        for i in new.first..new.end {
            let name = &work.sheet.postures[order.at[i].0].name;
            if !suspicion.postures.contains(name) && !(last.0 == p && order.at[i].0 == p && s > 0) {
                suspicion.postures.push(name.clone());
            }
        }
        work.found.push(suspicion);
    }
    undo(work, &order, &runs);
    fitted(work, given)
}

/// True where a state under load lies where the arm has it by the second of two frames, and not by the first.
fn is_of(work: &Work, at: (usize, usize), [first, second]: [&Isometry3<f64>; 2]) -> bool {
    let state = work.sheet.at(at);
    let pairs = state_pairs(&state.points, &work.predicted(&state.q));
    let [first, second] = [first, second].map(|frame| rms(frame, &pairs));
    state.role == Role::Loaded && second <= give(work, at.0) && BELIEVED * second < first
}

/// Puts the states of all runs into the axes of the first.
fn undo(work: &mut Work, order: &Order, runs: &[Run]) {
    let Some((first, others)) = runs.split_first() else {
        return;
    };
    let run_of = |i: usize| runs.iter().rposition(|run| run.first <= i).unwrap_or(0);
    let mut changes: Vec<((usize, usize), usize)> = Vec::new();
    for (p, posture) in work.sheet.postures.iter().enumerate() {
        for s in 0..posture.states.len() {
            // The last unloaded state up to here says the frame, else the first of the posture.
            let own = (0..order.at.len()).filter(|i| order.at[*i].0 == p);
            let before = own.clone().filter(|i| order.at[*i].1 <= s).last();
            let Some(i) = before.or(own.clone().next()) else {
                continue;
            };
            let mut run = run_of(i);
            if let Some(next) = runs.get(run + 1)
                && own.last().is_some_and(|last| order.at[last].1 < s)
                && is_of(
                    work,
                    (p, s),
                    [&runs[run].base_from_tracker, &next.base_from_tracker],
                )
            {
                run += 1;
            }
            changes.push(((p, s), run));
        }
    }
    let to_first = first.base_from_tracker.inverse();
    for (at, run) in changes {
        if let Some(run) = run.checked_sub(1).and_then(|other| others.get(other)) {
            let change = to_first * run.base_from_tracker;
            work.sheet
                .at_mut(at)
                .each_position(|p| *p = moved(&change, p));
        }
    }
}

/// What was found, and how to say it.
pub(super) fn sentence(s: &Suspicion, mm: fn(f64) -> String) -> String {
    let length = |value: Option<f64>| value.map_or_else(String::new, mm);
    let from = match (s.divided.first(), s.postures.first()) {
        (Some(divided), _) => format!("In posture {divided} the tracker's frame changes"),
        (None, first) => format!(
            "From posture {} on the readings fit another tracker frame",
            first.map_or("", String::as_str)
        ),
    };
    let rows = match s.postures.len() {
        0 => "the rows from there on".to_string(),
        1 => format!("the rows of posture {}", s.postures[0]),
        _ => format!("the rows of postures {}", list(&s.postures)),
    };
    let name = match &s.station {
        Some(station) => format!("give {rows} a station of their own in place of {station}"),
        None => format!("add a column station: 2 for {rows}, 1 for those before"),
    };
    let divided = match s.divided.len() {
        0 => String::new(),
        _ => format!(
            " Posture {} was read partly before and partly after: measure it again, or leave it out.",
            list(&s.divided)
        ),
    };
    let turn = s.angles_deg.first().copied().unwrap_or_default();
    format!(
        "{from}: one for all leaves the unloaded points {} from the kinematic model, one of its own for each part {}; \
         they lie {} apart at the points, with a turn of {turn:.2}°. If the tracker was moved or knocked, {name}.{divided} \
         If the robot was moved, for example on a rail, what stands beside it (anchor, obstacles) is elsewhere, too: \
         identify what was read at each of its places with a cell of its own.",
        length(s.before_m),
        length(s.after_m),
        length(s.off_m),
    )
}
