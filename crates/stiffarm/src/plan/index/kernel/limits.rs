//! Margins to the cell's limits with an augmented Lagrangian: value, and its
//! derivative gathered as a force and a moment on the tool.
//!
//! Order of the margins: as in [`crate::model::cell::Limits::margins`].

use super::batch::Batch;
use super::lanes::{Lanes, Vec3, WIDTH, ZERO, ZERO3, add, cross, dot, rotate, scale, sub, three};
use super::model::{KernelLoad, Model};
use crate::model::cell::{Measure, PointLimit, Side};

/// One lane's share of Σ [(max(0, λ − μ·margin))² − λ²]/(2μ) and where it pushes.
struct Penalty<'a> {
    weight: f64,
    guard: f64,
    multipliers: &'a [Lanes],
    margins: &'a mut [Lanes],
    at: usize,
    value: Lanes,
    violation: Lanes,
}

impl Penalty<'_> {
    /// Takes the next margin; returns the derivative of the penalty by it.
    #[inline(always)]
    fn slope(&mut self, margin: Lanes) -> Lanes {
        let multiplier = self.multipliers[self.at];
        self.margins[self.at] = margin;
        self.at += 1;
        self.violation = self.violation.max(-margin);
        let inside = margin - Lanes::splat(self.guard);
        let active = (multiplier - inside * self.weight).positive_part();
        self.value += (active * active - multiplier * multiplier) * (0.5 / self.weight);
        -active
    }

    /// The same of a limit; returns the derivative by what it bounds.
    #[inline(always)]
    fn slope_of(&mut self, limit: &PointLimit, bounded: Lanes) -> Lanes {
        let at = Lanes::splat(limit.at);
        match limit.side {
            Side::AtLeast => self.slope(bounded - at),
            Side::AtMost => -self.slope(at - bounded),
        }
    }
}

/// All margins, their penalty, and the force and moment of its derivative.
#[inline(always)]
pub(super) fn forward(model: &Model, batch: &mut Batch) {
    let n = model.joints;
    let flange = add(batch.position, rotate(&batch.rotation, &model.flange));
    let wrist = batch.origins[n.saturating_sub(2)];
    let first_axis = batch.axes[0];
    let first_origin = batch.origins[0];
    let mut penalty = Penalty {
        weight: batch.penalty_weight,
        guard: batch.penalty_guard,
        multipliers: &batch.multipliers,
        margins: &mut batch.margins,
        at: 0,
        value: ZERO,
        violation: ZERO,
    };
    let (mut force, mut moment) = (ZERO3, ZERO3);
    let mut rope_force = ZERO3;
    let (mut wrist_force, mut loading_force) = (ZERO3, ZERO3);
    let count = model.measuring_points.len();
    for s in 0..count + 3 {
        let (point, is_tool_point) = match s {
            0 => (batch.loading_point, true),
            s if s <= count => {
                let local = rotate(&batch.rotation, &model.measuring_points[s - 1]);
                (add(batch.position, local), true)
            }
            s if s == count + 1 => (flange, true),
            _ => (wrist, false),
        };
        let mut push = ZERO3;
        for limit in if is_tool_point { &model.tool_limits } else { &model.wrist_limits } {
            // As in `Limits::visit`, which shows what this searches by.
            match limit.measure {
                Measure::Axis(axis) => {
                    let slope = penalty.slope_of(limit, point[axis]);
                    push = three!(|i| if i == axis { push[i] + slope } else { push[i] });
                }
                Measure::FromAxis1 => {
                    let offset = sub(point, first_origin);
                    let across = sub(offset, scale(first_axis, dot(&first_axis, &offset)));
                    let distance = dot(&across, &across).sqrt();
                    let inverse = penalty.slope_of(limit, distance) / distance.max(Lanes::splat(f64::MIN_POSITIVE));
                    push = add(push, scale(across, inverse));
                }
            }
        }
        if is_tool_point {
            force = add(force, push);
            moment = add(moment, cross(&point, &push));
        } else {
            wrist_force = push;
        }
        if s == 0 {
            loading_force = push;
        }
    }
    if let (Some([shortest, longest]), KernelLoad::Rope { .. }) = (model.rope_length, &model.load) {
        let slope = penalty.slope(batch.rope_length - Lanes::splat(shortest))
            - penalty.slope(Lanes::splat(longest) - batch.rope_length);
        // The rope shortens towards its anchor.
        rope_force = scale(batch.rope_direction, -slope);
        force = add(force, rope_force);
        moment = add(moment, cross(&batch.loading_point, &rope_force));
    }
    let (value, violation) = (penalty.value, penalty.violation);
    batch.penalty = value;
    batch.violation = violation;
    batch.limit_force = force;
    batch.limit_moment = moment;
    batch.loading_force = add(loading_force, rope_force);
    batch.rope_force = rope_force;
    batch.wrist_force = wrist_force;
    batch.wrist = wrist;
}

/// Adds the derivative of the penalty with respect to θ.
#[inline(always)]
pub(super) fn add_gradient(batch: &mut Batch, n: usize) {
    let wrist_joints = n.saturating_sub(2);
    for k in 0..n {
        let origin = batch.origins[k];
        let mut turn: Vec3 = sub(batch.limit_moment, cross(&origin, &batch.limit_force));
        if k < wrist_joints {
            turn = add(turn, cross(&sub(batch.wrist, origin), &batch.wrist_force));
        }
        batch.gradient[k] += dot(&batch.axes[k], &turn);
    }
}

/// Moves the multipliers after a minimisation; returns the largest of
/// |min(margin, λ/μ)|, zero at a solution.
pub(super) fn update_multipliers(batch: &mut Batch, lanes: usize) -> f64 {
    let (weight, guard) = (batch.penalty_weight, batch.penalty_guard);
    let mut worst = 0.0_f64;
    for (multiplier, margin) in batch.multipliers.iter_mut().zip(&batch.margins) {
        for lane in 0..lanes.min(WIDTH) {
            let inside = margin.0[lane] - guard;
            let next = (multiplier.0[lane] - weight * inside).max(0.0);
            worst = worst.max(inside.min(multiplier.0[lane] / weight).abs());
            multiplier.0[lane] = next;
        }
    }
    worst
}
