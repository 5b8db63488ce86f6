//! A recorded load along a path.

use crate::error::{Code, Error, Result};
use crate::findings::Finding;
use crate::model::cell::Cell;
use crate::model::kinematics::Frames;
use crate::model::path::{PathPoint, PathTarget};
use crate::model::process::{ForceAxes, Process, TipLoad};
use crate::units::m_to_mm;
use nalgebra::{Vector3, Vector6};

/// How far a log may end before the path does, and lies beyond it without a word, relative to the path.
const SLACK: [f64; 2] = [0.005, 0.02];

/// What the rows of a log count from the first point of the path.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CountedBy {
    /// The way of the tip \[m\].
    Length,
    /// Time at the feeds of the path \[s\].
    Time,
}

/// What a log has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Recorded {
    /// Forces and moments on the robot at the tip, in these axes \[N, N·m\].
    Loads(ForceAxes),
    /// Power of the spindle, first component \[W\].
    Power,
}

/// A log: linear between its rows.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadLog {
    by: CountedBy,
    what: Recorded,
    at: Vec<f64>,
    values: Vec<Vector6<f64>>,
    /// Integrals of the values from the first row.
    sums: Vec<Vector6<f64>>,
}

impl LoadLog {
    /// A log of at least two rows, `at` not falling.
    pub fn new(by: CountedBy, what: Recorded, at: Vec<f64>, values: Vec<Vector6<f64>>) -> Self {
        let mut sum = Vector6::zeros();
        let mut sums = vec![sum];
        for (at, values) in at.windows(2).zip(values.windows(2)) {
            sum += (values[0] + values[1]) * (0.5 * (at[1] - at[0]));
            sums.push(sum);
        }
        LoadLog { by, what, at, values, sums }
    }

    /// Gives the points at feed that have no load of their own the mean of the log over half the way to their
    /// neighbours at feed; a power scales the constant force of the cell. Says what became of it.
    ///
    /// # Errors
    /// A log that ends before the path or begins behind its start, one by time where a feed is not known, a power where
    /// the cell does not say at which power its force acts.
    pub fn put_on(&self, cell: &Cell, points: &mut [PathPoint]) -> Result<Vec<Finding>> {
        let stations = self.stations(cell, points)?;
        let end = stations.last().copied().unwrap_or_default();
        let [first, last] = [self.at[0], self.at[self.at.len() - 1]];
        if last < end * (1.0 - SLACK[0]) || first > end * SLACK[0] {
            let message = format!(
                "The log goes from {} to {}, and the path from 0 to {}.",
                self.shown(first),
                self.shown(last),
                self.shown(end)
            );
            let hint =
                "both count from the first point of the path; cut what lies before it, and let the log cover the path";
            return Err(Error::new(Code::Conflict, message).hint(hint));
        }
        let rapid: Vec<bool> = points.iter().map(|point| point.rapid).collect();
        let mut count = 0;
        let mut largest = 0.0_f64;
        for (i, point) in points.iter_mut().enumerate() {
            if point.load.is_some() {
                continue;
            }
            let station = stations[i];
            // A rapid move has the load of none of its ends.
            let to = |is_near: bool, other: usize| {
                if is_near { 0.5 * (station + stations[other]) } else { station }
            };
            let from = to(i > 0 && !rapid[i], i.saturating_sub(1));
            let next = (i + 1).min(rapid.len() - 1);
            let mean = self.mean(from, to(!rapid[next], next));
            let load = self.load(cell, point, &mean)?;
            largest = largest.max(load.force.norm());
            point.load = Some(load);
            count += 1;
        }
        Ok(self.findings(end, last, (count, points.len()), largest))
    }

    fn findings(&self, end: f64, last: f64, (count, all): (usize, usize), largest: f64) -> Vec<Finding> {
        let recorded = self.values.iter().map(|value| value.fixed_rows::<3>(0).norm());
        let recorded = recorded.fold(0.0, f64::max);
        let unit = if self.what == Recorded::Power { "W" } else { "N" };
        let sentence = format!(
            "The log gives {count} of {all} points their load, each the mean over half the way to its neighbours: its \
             largest value is {recorded:.0} {unit}, the largest force at a point {largest:.0} N."
        );
        let mut out = vec![Finding::note("log", "log", sentence)];
        if last > end * (1.0 + SLACK[1]) {
            let sentence = format!(
                "The log goes on to {}, and the path ends at {}: are they of the same run, and do both begin at the \
                 path's first point?",
                self.shown(last),
                self.shown(end)
            );
            out.push(Finding::caution("log-longer", "log", sentence));
        }
        out
    }

    /// Where the points stand, counted as the log does.
    fn stations(&self, cell: &Cell, points: &[PathPoint]) -> Result<Vec<f64>> {
        let tip = cell.work.tip(&cell.setup.tool);
        let places = points.iter().map(|point| match &point.target {
            PathTarget::Angles(q) => {
                let frames = Frames::new(&cell.setup.robot, q);
                (frames.flange() * tip).translation.vector
            }
            PathTarget::Pose(pose) => pose.translation.vector,
            PathTarget::Axis { position, .. } => *position,
        });
        // How the tool gets to the first point at feed, and what it does behind the last, is not recorded.
        let at_feed = |point: &PathPoint| !point.rapid;
        let begin = points.iter().position(at_feed).unwrap_or_default();
        let end = points.iter().rposition(at_feed).unwrap_or_default();
        let timed = begin.max(1)..=end;
        let mut station = 0.0;
        let mut before: Option<Vector3<f64>> = None;
        let mut out = Vec::with_capacity(points.len());
        for (i, (point, place)) in points.iter().zip(places).enumerate() {
            let way = before.map_or(0.0, |before| (place - before).norm());
            before = Some(place);
            station += match self.by {
                CountedBy::Length => way,
                CountedBy::Time if way == 0.0 || !timed.contains(&i) => 0.0,
                CountedBy::Time => match point.feed {
                    Some(feed) => way / feed,
                    None => return Err(no_time(point)),
                },
            };
            out.push(station);
        }
        Ok(out)
    }

    /// Mean from `from` to `to`, or the value there where they are the same.
    fn mean(&self, from: f64, to: f64) -> Vector6<f64> {
        let (value, start) = self.until(from);
        let (_, end) = self.until(to);
        if to - from > 1e-12 {
            // Beyond its ends the log stays as it is there.
            (end - start) / (to - from)
        } else {
            value
        }
    }

    /// The value there, and the integral up to there.
    fn until(&self, at: f64) -> (Vector6<f64>, Vector6<f64>) {
        let last = self.at.len() - 1;
        let next = self.at.partition_point(|sample| *sample <= at);
        if next == 0 || next > last {
            let end = next.min(last);
            let value = self.values[end];
            return (value, self.sums[end] + value * (at - self.at[end]));
        }
        let (way, span) = (at - self.at[next - 1], self.at[next] - self.at[next - 1]);
        let begin = self.values[next - 1];
        let value = begin.lerp(&self.values[next], way / span);
        (value, self.sums[next - 1] + (begin + value) * (0.5 * way))
    }

    fn load(&self, cell: &Cell, point: &PathPoint, mean: &Vector6<f64>) -> Result<TipLoad> {
        let axes = match self.what {
            Recorded::Loads(axes) => axes,
            Recorded::Power => {
                let Some(Process::Constant(load, Some(power))) = cell.work.process_at(point) else {
                    let message = format!(
                        "The log has a power, and the cell does not say at which power the force at point {} acts.",
                        point.name
                    );
                    let hint =
                        "give power_w in [work.force] of the cell: the power of the spindle at which that force acts";
                    return Err(Error::new(Code::MissingKey, message).hint(hint));
                };
                let share = power.share(mean[0]);
                return Ok(TipLoad { force: load.force * share, moment: load.moment * share, ..*load });
            }
        };
        Ok(TipLoad { force: mean.fixed_rows::<3>(0).into_owned(), moment: mean.fixed_rows::<3>(3).into_owned(), axes })
    }

    fn shown(&self, at: f64) -> String {
        match self.by {
            CountedBy::Length => format!("{:.1} mm", m_to_mm(at)),
            CountedBy::Time => format!("{at:.2} s"),
        }
    }
}

fn no_time(point: &PathPoint) -> Error {
    let what = if point.rapid { "the rapid move to" } else { "the move to" };
    let message = format!("The log counts time, and {what} point {} has no feed.", point.name);
    point.at(Error::new(Code::MissingKey, message).hint(
        "give the log the column along_mm, the way of the tip from the first point, in place of time_s; or give the \
         feed",
    ))
}
