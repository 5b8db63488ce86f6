//! The numeric search: many starts, different postures, and the distance of
//! poses that none of them reaches.

use super::closed_form::Theta;
use super::numeric::{Descent, SOLVED_RESIDUAL};
use super::unreachable::{Region, Unreachable};
use super::{Branch, InverseKinematics, SINGULAR_CONDITION, SLACK, STEPS_OF_A_BRANCH};
use crate::error::{Code, Error, Result};
use nalgebra::Isometry3;
use sobol_burley::sample;
use std::f64::consts::PI;

/// Fewest starts; the search goes on to `PATIENCE` times the last start that
/// found something new.
const STARTS: u32 = 192;
const PATIENCE: u32 = 4;
/// Starts without any posture after which there is none; two of three find one
/// where there are six joints, two of five where seven keep to their limits.
const FUTILE_STARTS: u32 = 64;
/// Most starts.
const MOST_STARTS: u32 = 1024;
/// Starts of the search for the distance of an unreachable pose.
const DISTANT_STARTS: u32 = 48;
/// Those of its ends from which the orientation is held.
const APPROACHES: usize = 8;
/// Most postures of a pose: a general arm of six joints has 16 (D. Manocha,
/// J. F. Canny, IEEE Trans. Robot. Autom. 10(5), 1994, doi:10.1109/70.326569);
/// of more joints it is the size of the sample.
const MOST_BRANCHES: usize = 16;
/// Postures nearer than this, full turns aside, are one \[rad\]: iterations
/// end this far apart where the Jacobian is nearly singular.
const SAME_ANGLE: f64 = 1e-5;
/// The same of a sample, whose postures lie on a curve.
const SAME_ANGLE_OF_SAMPLE: f64 = 1e-2;
/// Condition number from which on others may lie beside a posture.
const NEARLY_SINGULAR: f64 = 100.0;
/// Orientations that differ by less are held \[rad\].
const SAME_ORIENTATION: f64 = 1e-8;

impl InverseKinematics {
    /// Postures found by iterations, of similar arms first, then from starts
    /// spread over the limits.
    pub(super) fn search(&self, flange: &Isometry3<f64>, near: &[f64]) -> Vec<Branch> {
        let mut descent = Descent::new(&self.robot, self.size);
        let mut branches = Vec::new();
        if self.is_far(flange) {
            return branches;
        }
        let similar = self.similar_postures(flange, near);
        // Complete when each posture of the similar arm leads to another of this one.
        let mut complete = !similar.is_empty();
        for q in similar {
            complete &= self.keep(flange, q, &mut descent, None, &mut branches);
        }
        if !complete {
            self.search_everywhere(flange, &mut descent, &mut branches);
        }
        if self.robot.joint_count() == 6 {
            self.search_beside(flange, &mut descent, &mut branches);
        }
        branches
    }

    /// Whether the flange is farther away than the whole chain is long, which
    /// needs no search.
    fn is_far(&self, flange: &Isometry3<f64>) -> bool {
        let first = self.robot.joints().first();
        first.is_some_and(|joint| {
            let way = flange.translation.vector - joint.placement.translation.vector;
            way.norm() > self.size * (1.0 + SLACK)
        })
    }

    /// Iterates from starts spread over the limits.
    fn search_everywhere(&self, flange: &Isometry3<f64>, descent: &mut Descent<'_>, branches: &mut Vec<Branch>) {
        // Free joints can keep to the limits; other postures are marked afterwards.
        if self.robot.joint_count() > 6 {
            let limits = self.turns.finite_limits(1.0);
            self.search_within(flange, Some(&limits), descent, branches);
            if !branches.is_empty() {
                return;
            }
        }
        self.search_within(flange, None, descent, branches);
    }

    fn search_within(
        &self,
        flange: &Isometry3<f64>,
        limits: Option<&[[f64; 2]]>,
        descent: &mut Descent<'_>,
        branches: &mut Vec<Branch>,
    ) {
        let mut last_new = 0;
        for start in 0..MOST_STARTS {
            let in_vain = start >= FUTILE_STARTS && branches.is_empty();
            let done = start >= STARTS.max(PATIENCE * last_new);
            if in_vain || done || branches.len() == MOST_BRANCHES {
                break;
            }
            if self.keep(flange, self.start(start), descent, limits, branches) {
                last_new = start + 1;
            }
        }
    }

    /// Looks for further postures beside nearly singular ones, where several
    /// lie close together along the direction in which the flange hardly moves.
    fn search_beside(&self, flange: &Isometry3<f64>, descent: &mut Descent<'_>, branches: &mut Vec<Branch>) {
        const STEPS: i32 = 6;
        let mut next = 0;
        while next < branches.len() && branches.len() < MOST_BRANCHES {
            let Branch { q, condition, .. } = branches[next].clone();
            next += 1;
            if !(NEARLY_SINGULAR..SINGULAR_CONDITION).contains(&condition) {
                continue;
            }
            let Some(direction) = descent.idle_direction(&q) else {
                continue;
            };
            for step in (-STEPS..=STEPS).filter(|s| *s != 0) {
                let way = f64::from(step) * PI / f64::from(STEPS);
                let pairs = q.iter().zip(&direction);
                let start = pairs.map(|(q, d)| q + way * d).collect();
                self.keep(flange, start, descent, None, branches);
            }
        }
    }

    /// The posture within the limits that iterations from `start` lead to.
    pub(super) fn led_from(&self, flange: &Isometry3<f64>, start: &[f64]) -> Option<Vec<f64>> {
        let limits: Vec<[f64; 2]> = self.robot.joints().iter().map(|j| j.limits).collect();
        let pairs = start.iter().zip(&limits);
        let mut q: Vec<f64> = pairs.map(|(q, l)| q.clamp(l[0], l[1])).collect();
        let mut descent = Descent::new(&self.robot, self.size);
        let residual = descent.solve(flange, &mut q, Some(&limits), STEPS_OF_A_BRANCH);
        (residual <= SOLVED_RESIDUAL).then_some(q)
    }

    /// How far an arm that has no posture for the pose is from it.
    ///
    /// # Errors
    /// Iterations without a finite result.
    pub(super) fn unreachable(&self, flange: &Isometry3<f64>) -> Result<Unreachable> {
        let unreachable = match &self.closed_form {
            Some(closed_form) => Unreachable::closed_form(closed_form.distance(flange)),
            None => self.nearest_found(flange),
        };
        if (unreachable.distance_m + unreachable.rotation_rad).is_finite() {
            return Ok(unreachable);
        }
        Err(Error::new(Code::Numerical, "The inverse kinematics gave no finite distance of the pose."))
    }

    /// The pose nearest to one out of reach, with its orientation where any
    /// posture found has that.
    fn nearest_found(&self, flange: &Isometry3<f64>) -> Unreachable {
        let mut descent = Descent::new(&self.robot, self.size);
        let mut ends: Vec<(f64, Vec<f64>)> = (0..DISTANT_STARTS)
            .map(|start| {
                let mut q = self.start(start);
                let residual = descent.solve(flange, &mut q, None, STEPS_OF_A_BRANCH);
                (residual, q)
            })
            .collect();
        ends.sort_by(|a, b| a.0.total_cmp(&b.0));
        ends.truncate(APPROACHES);
        let nearest = ends.first().map(|(_, q)| descent.missing(flange, q));
        let approached = ends.iter_mut().map(|(_, q)| descent.approach(flange, q));
        let held = approached
            .filter(|(_, rotation)| *rotation <= SAME_ORIENTATION)
            .map(|(distance, _)| (distance, 0.0))
            .min_by(|a, b| a.0.total_cmp(&b.0));
        let (distance_m, rotation_rad) = held.or(nearest).unwrap_or((f64::NAN, f64::NAN));
        Unreachable { distance_m, rotation_rad, region: Region::Outside }
    }

    /// A start of the search: points of a Sobol sequence over the limits.
    fn start(&self, start: u32) -> Vec<f64> {
        let limits = self.turns.finite_limits(1.0);
        let share = |j: usize| f64::from(sample(start, (j % 256) as u32, (j / 256) as u32));
        let spread = limits.iter().enumerate();
        spread.map(|(j, [low, high])| low + share(j) * (high - low)).collect()
    }

    fn similar_postures(&self, flange: &Isometry3<f64>, near: &[f64]) -> Vec<Vec<f64>> {
        let Some(similar) = &self.similar else {
            return Vec::new();
        };
        let near: Theta = self.theta(near);
        // Where the similar arm is just out of reach this one may be in it.
        let postures = similar.solve(flange, &near, 0.01 * self.size);
        let to_q = |theta: &Theta| self.turns.controller_angles(theta);
        postures.iter().map(to_q).collect()
    }

    /// Iterates from `q`; true when that gives a posture not found before.
    fn keep(
        &self,
        flange: &Isometry3<f64>,
        mut q: Vec<f64>,
        descent: &mut Descent<'_>,
        limits: Option<&[[f64; 2]]>,
        branches: &mut Vec<Branch>,
    ) -> bool {
        let residual = descent.solve(flange, &mut q, limits, STEPS_OF_A_BRANCH);
        // Written so that NaN is no solution.
        let solved = residual <= SOLVED_RESIDUAL;
        let same = if self.robot.joint_count() > 6 { SAME_ANGLE_OF_SAMPLE } else { SAME_ANGLE };
        if !solved || branches.iter().any(|b| self.turns.alike(&b.q, &q, same)) {
            return false;
        }
        let condition = self.condition(&q);
        branches.push(self.branch(self.turns.to_middle(q), condition));
        true
    }
}
