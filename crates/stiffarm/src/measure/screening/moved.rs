//! A tracker that was moved, or a robot that was driven on a rail, while nobody said so: runs of postures, one behind
//! the other, each of which fits the kinematic model in a frame of its own.
//!
//! A run ends where the longest one does that still fits like the best short ones; single postures that fit no run may
//! stand between. Two runs are believed when one frame for all leaves five times as much.

use super::frame::{Frame, PLAUSIBLE, fitted, item_pairs, items, rms, state_pairs};
use super::misfit::give;
use super::{BELIEVED_RATIO, Cause, Suspicion, Work};
use crate::findings::list;
use crate::measure::registration::{Agreement, Pair, moved, rigid_transform, robust};
use crate::model::measurement::Role;
use crate::units::rad_to_deg;
use nalgebra::Isometry3;

/// Unknowns of a frame, and how many more numbers a run must have.
const UNKNOWNS: usize = 6;
const SURPLUS: usize = 6;
/// Misfit below which a frame of its own does not matter to Ψ \[m\].
const SMALL_MISFIT: f64 = 5e-4;
/// Postures of the short runs that say how well the model can fit.
const SHORT: usize = 3;
/// A posture belongs to the run that it fits better by this factor.
const BETTER_RATIO: f64 = 2.0;
/// When a posture is none of its run.
const AGREEMENT: Agreement = Agreement {
    factor: 10.0,
    floor: SMALL_MISFIT,
    floor_few: SMALL_MISFIT,
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
            let posture_station = &work.sheet.postures[p].station;
            stations.iter().position(|name| *name == posture_station)
        };
        let mut at = items(work);
        at.sort_by_key(|(p, s)| (station(*p), *p, *s));
        Order { pairs: item_pairs(work, work.setup(), &at), at }
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
        let fit = robust(&self.pairs[first..end], AGREEMENT)?;
        let strays = fit.bad.iter().filter(|bad| **bad).count();
        let is_whole = fit.bad.first() == Some(&false) && fit.bad.last() == Some(&false);
        (is_whole && 4 * strays <= end - first).then_some(Run {
            first,
            end,
            base_from_tracker: fit.base_from_tracker,
            level: fit.level,
            strays,
        })
    }

    /// How well short runs fit: what the better quarter of them leaves \[m\].
    fn level(&self) -> Option<f64> {
        let short = (0..self.at.len()).filter_map(|first| {
            let end = self.shortest(first)?.max(first + SHORT);
            let run_pairs = self.pairs.get(first..end)?;
            let all: Vec<Pair> = run_pairs.iter().flatten().copied().collect();
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
        let allowed = (BELIEVED_RATIO * self.level()?).clamp(SMALL_MISFIT, PLAUSIBLE);
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
                let [before_rms, after_rms] =
                    [&*before, &*after].map(|run| rms(&run.base_from_tracker, &self.pairs[i]));
                BETTER_RATIO * after_rms < before_rms
            };
            let last_before = (before.first..before.end).rev().find(|i| !better(*i));
            let end = last_before.map_or(before.first, |i| i + 1);
            if end < before.end && self.is_enough(before.first, end) {
                (before.end, after.first) = (end, end);
            }
        }
    }

    /// The pairs of a run that agree with it.
    fn agreeing<'o>(&'o self, run: &'o Run) -> impl Iterator<Item = &'o Vec<Pair>> {
        let limit = AGREEMENT.limit(run.level, run.end - run.first);
        let run_pairs = self.pairs[run.first..run.end].iter();
        run_pairs.filter(move |pairs| rms(&run.base_from_tracker, pairs) <= limit)
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
            let run_pairs: Vec<Pair> = self.pairs[first..end].iter().flatten().copied().collect();
            let transform = rigid_transform(run_pairs.iter().copied())?;
            Some(rms(&transform, &run_pairs).powi(2) * run_pairs.len() as f64)
        };
        let count = self.at.len();
        let Some(one) = square(0, count) else {
            return false;
        };
        let total = self.pairs.iter().map(Vec::len).sum::<usize>() as f64;
        one > total * (SMALL_MISFIT / BELIEVED_RATIO).powi(2)
            && (1..count).any(|b| {
                let both = square(0, b).zip(square(b, count));
                self.is_enough(0, b)
                    && self.is_enough(b, count)
                    && both.is_some_and(|(a, b)| (a + b) * BELIEVED_RATIO.powi(2) < one)
            })
    }
}

/// Names moves of the tracker, undoes them and registers again; `None` where there are none. They are looked for where
/// the postures disagree throughout, and where two frames are at once much better than one.
pub(super) fn explain(work: &mut Work, stated_transform: Option<&Isometry3<f64>>, throughout: bool) -> Option<Frame> {
    let order = Order::new(work);
    if !(throughout || order.is_suspected()) {
        return None;
    }
    let runs = order.runs()?;
    let [before, after] = order.misfits(&runs)?;
    if before < (BELIEVED_RATIO * after).max(SMALL_MISFIT) {
        return None;
    }
    let of_states = runs_of_states(work, &order, &runs);
    for next in 1..runs.len() {
        let (old, new) = (&runs[next - 1], &runs[next]);
        let [before_it, first] = [new.first - 1, new.first].map(|i| &work.sheet.postures[order.at[i].0]);
        if before_it.station != first.station {
            // A station that was moved is not tied well to the others: the table has both names already.
            continue;
        }
        let mut suspicion = Suspicion::new(Cause::MovedTracker).misfit(before, after);
        let [a, b] = [old, new].map(|run| &run.base_from_tracker);
        let points: Vec<&Pair> = order.agreeing(new).flatten().collect();
        let away = points.iter().map(|(p, _)| (moved(a, p) - moved(b, p)).norm());
        suspicion.off_m = Some(away.sum::<f64>() / points.len().max(1) as f64);
        suspicion.angles_deg = vec![rad_to_deg(a.rotation.angle_to(&b.rotation))];
        for (state_runs, posture) in of_states.iter().zip(&work.sheet.postures) {
            if state_runs.contains(&next) && state_runs.contains(&(next - 1)) {
                suspicion.divided.push(posture.name.clone());
            } else if state_runs.contains(&next) && !state_runs.contains(&(next + 1)) {
                suspicion.postures.push(posture.name.clone());
            }
        }
        suspicion.station.clone_from(&first.station);
        suspicion.likely_station = Some(match &first.station {
            Some(station) => unused(work, station),
            None => (next + 1).to_string(),
        });
        work.suspicions.push(suspicion);
    }
    for (p, state_runs) in of_states.iter().enumerate() {
        for (s, run) in state_runs.iter().enumerate().filter(|(_, run)| **run > 0) {
            let change = runs[0].base_from_tracker.inverse() * runs[*run].base_from_tracker;
            let state = work.sheet.at_mut((p, s));
            state.each_position(|position| *position = moved(&change, position));
        }
    }
    fitted(work, stated_transform)
}

/// A name like `station` that the table has not.
fn unused(work: &Work, station: &str) -> String {
    let mut names = (2..).map(|number| format!("{station}-{number}"));
    let is_new = |name: &String| {
        let mut postures = work.sheet.postures.iter();
        postures.all(|posture| posture.station.as_ref() != Some(name))
    };
    names.find(is_new).unwrap_or_default()
}

/// The number of its run for each state of each posture. An unloaded one has that of its item; one under load that of
/// the last item before it, but where the frame changes before the next: then that in which it lies nearer to where the
/// arm has it, within what a load does.
fn runs_of_states(work: &Work, order: &Order, runs: &[Run]) -> Vec<Vec<usize>> {
    let run_of = |i: usize| runs.iter().rposition(|run| run.first <= i).unwrap_or(0);
    let of_posture = |(p, posture): (usize, &super::sheet::Posture)| {
        let posture_items: Vec<usize> = (0..order.at.len()).filter(|i| order.at[*i].0 == p).collect();
        let of_state = |s: usize| {
            let before = posture_items.iter().rev().find(|i| order.at[**i].1 <= s);
            let Some(i) = before.or(posture_items.first()).copied() else {
                return 0;
            };
            let run = run_of(i);
            let next = run_of((i + 1).min(order.at.len() - 1));
            let is_other =
                next != run && is_of(work, (p, s), [run, next].map(|r| &runs[r]), posture_items.contains(&(i + 1)));
            if is_other { next } else { run }
        };
        (0..posture.states.len()).map(of_state).collect()
    };
    work.sheet.postures.iter().enumerate().map(of_posture).collect()
}

/// True where a state under load lies where the arm has it by the second of two runs, and not by the first: nearer
/// where the frame is known to change in its posture, clearly nearer where it may.
fn is_of(work: &Work, at: (usize, usize), runs: [&Run; 2], is_known: bool) -> bool {
    let state = work.sheet.at(at);
    let pairs = state_pairs(&state.points, &work.predicted(&state.q));
    let [first, second] = runs.map(|run| rms(&run.base_from_tracker, &pairs));
    let factor = if is_known { 1.0 } else { BELIEVED_RATIO };
    state.role == Role::Loaded && second <= give(work, at.0) && factor * second < first
}

/// What was found, and how to say it.
pub(super) fn sentence(s: &Suspicion, [before, after, off]: [&str; 3]) -> String {
    let from = match (s.divided.first(), s.postures.first()) {
        (Some(divided), _) => format!("In posture {divided} the tracker's frame changes"),
        (None, first) => {
            format!("From posture {} on the readings fit another tracker frame", first.map_or("", String::as_str))
        }
    };
    let rows = match s.postures.len() {
        0 => "the rows from there on".to_string(),
        1 => format!("the rows of posture {}", s.postures[0]),
        _ => format!("the rows of postures {}", list(&s.postures)),
    };
    let likely = s.likely_station.as_deref().unwrap_or_default();
    let name = match &s.station {
        Some(station) => format!("give {rows} station {likely} in place of {station}"),
        None => format!("add a column station with {likely} in {rows}, and another name in those before"),
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
        "{from}: one for all leaves the unloaded points {before} from the kinematic model, one of its own for each \
         part {after}; they lie {off} apart at the points, with a turn of {turn:.2}°. If the tracker was moved or \
         knocked, {name}.{divided} If the robot was moved, for example on a rail, what stands beside it (anchor, \
         obstacles) is elsewhere, too: identify what was read at each of its places with a cell of its own."
    )
}
