//! Full turns: controller angles that leave every link where it is.
//!
//! θ + 2πk is the same posture for any integers k, and q = C⁻¹(θ − offset). With
//! integers in C and C⁻¹ each controller angle has its own full turns; else
//! (a wrist whose gears are coupled by a fraction) a turn of one serial joint
//! moves several controller angles, and turns are searched for together.

use super::closed_form::wrapped;
use crate::model::robot::Robot;
use nalgebra::{DMatrix, DVector};
use std::f64::consts::{FRAC_PI_2, TAU};

/// An angle this far outside its limits is still inside \[rad\], as
/// [`Robot::outside_limits`] has it.
const TOLERANCE: f64 = 1e-9;
/// Most combinations of turns that are listed or searched.
const MOST_COMBINATIONS: usize = 1 << 16;
/// Turns to either side of the middle that are looked at.
const MOST_TURNS_ASIDE: f64 = 64.0;

/// The full turns of a robot's joints within its limits.
#[derive(Debug, Clone)]
pub(super) struct Turns {
    limits: Vec<[f64; 2]>,
    /// Middle of the limits, 0 or the limit itself where one has none \[rad\].
    middle: Vec<f64>,
    offset: DVector<f64>,
    coupling: DMatrix<f64>,
    inverse: DMatrix<f64>,
    /// Whether C and C⁻¹ are made of integers.
    separate: bool,
}

impl Turns {
    /// The turns of `robot`.
    pub(super) fn new(robot: &Robot) -> Self {
        let n = robot.joint_count();
        let inverse = robot.coupling().clone().try_inverse();
        // A robot takes no singular C.
        let mut inverse = inverse.unwrap_or_else(|| DMatrix::identity(n, n));
        let whole = |m: &DMatrix<f64>| m.iter().all(|v| (v - v.round()).abs() < 1e-9);
        let separate = whole(robot.coupling()) && whole(&inverse);
        if separate {
            inverse.apply(|v| *v = v.round());
        }
        let middle = |[low, high]: &[f64; 2]| match (low.is_finite(), high.is_finite()) {
            (true, true) => low + (high - low) / 2.0,
            (true, false) => low.max(0.0),
            (false, true) => high.min(0.0),
            (false, false) => 0.0,
        };
        let limits: Vec<[f64; 2]> = robot.joints().iter().map(|j| j.limits).collect();
        Turns {
            middle: limits.iter().map(middle).collect(),
            limits,
            offset: robot.serial_angles(&vec![0.0; n]),
            coupling: robot.coupling().clone(),
            inverse,
            separate,
        }
    }

    /// q of θ \[rad\].
    pub(super) fn controller_angles(&self, theta: &[f64]) -> Vec<f64> {
        // Sums of −0 and more are those of the rest.
        let mut q = vec![-0.0; theta.len()];
        for ((column, theta), offset) in self.inverse.column_iter().zip(theta).zip(&self.offset) {
            let turned = theta - offset;
            q.iter_mut().zip(&column).for_each(|(q, inverse)| *q += inverse * turned);
        }
        q
    }

    /// Middle of the limits, 0 or the limit itself where one has none \[rad\].
    pub(super) fn middle(&self) -> &[f64] {
        &self.middle
    }

    /// Limits with infinite and absurdly wide ones cut to some turns about the
    /// middle.
    pub(super) fn finite_limits(&self, turns: f64) -> Vec<[f64; 2]> {
        let wide = turns * TAU;
        let cut = |(limit, middle): (&[f64; 2], &f64)| [limit[0].max(middle - wide), limit[1].min(middle + wide)];
        self.limits.iter().zip(self.middle()).map(cut).collect()
    }

    /// How far `q` leaves the limits: the joint that does most and its excess
    /// \[rad\], negative inside.
    pub(super) fn excess(&self, q: &[f64]) -> (usize, f64) {
        let mut worst = (0, f64::NEG_INFINITY);
        for (j, (q, limit)) in q.iter().zip(&self.limits).enumerate() {
            let excess = (limit[0] - q).max(q - limit[1]);
            if excess > worst.1 {
                worst = (j, excess);
            }
        }
        worst
    }

    /// Whether `q` is within the limits.
    pub(super) fn contain(&self, q: &[f64]) -> bool {
        self.excess(q).1 <= TOLERANCE
    }

    /// `q` with the turns nearest to `goal`, whatever the limits.
    fn nearest(&self, mut q: Vec<f64>, goal: &[f64]) -> Vec<f64> {
        if self.separate {
            q.iter_mut().zip(goal).for_each(|(q, goal)| *q += ((goal - *q) / TAU).round() * TAU);
            return q;
        }
        let missing = DVector::from_fn(q.len(), |j, _| goal[j] - q[j]);
        let turns = (&self.coupling * missing / TAU).map(f64::round);
        let mut best = DVector::from_column_slice(&q) + &self.inverse * turns * TAU;
        let change = |q: &DVector<f64>| largest_change(q.as_slice(), goal);
        // Rounding is best in θ; single turns more or less may be better in q.
        for _ in 0..MOST_COMBINATIONS.ilog2() {
            let mut better = None;
            for j in 0..q.len() {
                for step in [-TAU, TAU] {
                    let trial = &best + self.inverse.column(j) * step;
                    if change(&trial) < change(better.as_ref().unwrap_or(&best)) - TOLERANCE {
                        better = Some(trial);
                    }
                }
            }
            match better {
                Some(trial) => best = trial,
                None => break,
            }
        }
        best.as_slice().to_vec()
    }

    /// `q` with the turns nearest to the middle of the limits; within them
    /// where any are.
    pub(super) fn to_middle(&self, q: Vec<f64>) -> Vec<f64> {
        if self.separate {
            return self.nearest(q, &self.middle);
        }
        let central = self.nearest(q.clone(), &self.middle);
        if self.contain(&central) {
            return central;
        }
        self.near(&q, &self.middle).unwrap_or(central)
    }

    /// `q` with the turns within the limits that are nearest to `goal` by the
    /// largest change of an angle.
    pub(super) fn near(&self, q: &[f64], goal: &[f64]) -> Option<Vec<f64>> {
        if self.separate {
            let turned = q.iter().zip(goal).zip(&self.limits).map(|((q, goal), limits)| angle_near(*q, *goal, limits));
            return turned.collect();
        }
        let all = self.within_limits(q);
        all.into_iter().min_by(|a, b| largest_change(a, goal).total_cmp(&largest_change(b, goal)))
    }

    /// The same written to `turned`; its largest change, `None` also where it is `least` or more.
    pub(super) fn turned_near(&self, q: &[f64], goal: &[f64], least: f64, turned: &mut [f64]) -> Option<f64> {
        if !self.separate {
            turned.copy_from_slice(&self.near(q, goal)?);
            return Some(largest_change(turned, goal)).filter(|change| *change < least);
        }
        let mut largest: f64 = 0.0;
        for (((q, goal), limits), turned) in q.iter().zip(goal).zip(&self.limits).zip(turned) {
            *turned = angle_near(*q, *goal, limits)?;
            largest = largest.max((*turned - goal).abs());
            if largest >= least {
                return None;
            }
        }
        Some(largest)
    }

    /// Every combination of turns within the limits, up to [`MOST_COMBINATIONS`] about the
    /// middle.
    pub(super) fn within_limits(&self, q: &[f64]) -> Vec<Vec<f64>> {
        let n = q.len();
        let limits = self.finite_limits(MOST_TURNS_ASIDE);
        let central = self.nearest(q.to_vec(), &self.middle);
        // Range of the whole turns of each joint: of q where they are separate, else of θ.
        let mut ranges: Vec<Vec<f64>> = (0..n)
            .map(|j| {
                let [low, high] = if self.separate {
                    limits[j].map(|limit| limit - central[j])
                } else {
                    // Least and most of Σ C_jk (q_k − central_k).
                    let bound = |below: usize, above: usize| -> f64 {
                        let term = |k: usize| {
                            let c = self.coupling[(j, k)];
                            c * (limits[k][if c < 0.0 { above } else { below }] - central[k])
                        };
                        (0..n).map(term).sum()
                    };
                    [bound(0, 1), bound(1, 0)]
                };
                let first = ((low - TOLERANCE) / TAU).ceil() as i64;
                let last = ((high + TOLERANCE) / TAU).floor() as i64;
                let mut turns: Vec<f64> = (first..=last).map(|m| m as f64).collect();
                turns.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
                turns
            })
            .collect();
        while ranges.iter().map(|r| r.len() as f64).product::<f64>() > MOST_COMBINATIONS as f64 {
            if let Some(longest) = ranges.iter_mut().max_by_key(|r| r.len()) {
                longest.pop();
            }
        }
        for range in &mut ranges {
            range.sort_by(f64::total_cmp);
        }
        let mut combinations = vec![Vec::with_capacity(n)];
        for range in &ranges {
            combinations = combinations
                .iter()
                .flat_map(|combination| range.iter().map(move |m| [combination.as_slice(), &[*m]].concat()))
                .collect();
        }
        let turned = combinations.into_iter().map(|turns| {
            if self.separate {
                let pairs = central.iter().zip(&turns);
                return pairs.map(|(q, m)| q + m * TAU).collect();
            }
            let moved = &self.inverse * DVector::from_vec(turns) * TAU;
            central.iter().zip(&moved).map(|(q, m)| q + m).collect()
        });
        turned.filter(|q: &Vec<f64>| self.contain(q)).collect()
    }

    /// Whether two postures' serial angles differ by less than `tolerance`
    /// \[rad\], full turns aside.
    pub(super) fn alike(&self, a: &[f64], b: &[f64], tolerance: f64) -> bool {
        let serial = |i: usize| -> f64 {
            let terms = a.iter().zip(b).enumerate();
            terms.map(|(j, (a, b))| self.coupling[(i, j)] * (a - b)).sum()
        };
        (0..a.len()).all(|i| wrapped(serial(i)).abs() < tolerance)
    }
}

/// An angle with the turns within its limits that are nearest to `goal`, of turns that are separate.
fn angle_near(q: f64, goal: f64, limits: &[f64; 2]) -> Option<f64> {
    let [low, high] = [limits[0] - TOLERANCE, limits[1] + TOLERANCE];
    if (goal - q).abs() < FRAC_PI_2 && low <= q && q <= high {
        return Some(q);
    }
    let least = ((low - q) / TAU).ceil();
    let most = ((high - q) / TAU).floor();
    let turns = ((goal - q) / TAU).round();
    (least <= most).then(|| q + turns.max(least).min(most) * TAU)
}

/// Largest change of an angle from one posture to another \[rad\].
pub(crate) fn largest_change(from: &[f64], to: &[f64]) -> f64 {
    let changes = from.iter().zip(to).map(|(a, b)| (a - b).abs());
    changes.fold(0.0, f64::max)
}
