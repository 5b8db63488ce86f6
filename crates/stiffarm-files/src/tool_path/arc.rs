//! Arcs as points on them.

use super::{FARTHEST, TOLERANCE};
use nalgebra::{Rotation3, UnitVector3, Vector3};
use std::f64::consts::TAU;

/// Start and end may be this far from one circle \[m\]; programs are rounded.
pub(super) const ROUNDED: f64 = 0.05e-3;

/// So near where it begins an arc has gone round \[m\].
const FULL_TURN_DISTANCE: f64 = 5e-6;

/// An arc about an axis, counter-clockwise seen against it; with a rise along it a helix.
pub(super) struct Circle {
    centre: Vector3<f64>,
    axis: UnitVector3<f64>,
    start: Vector3<f64>,
    /// Angle of the whole arc \[rad\], above zero.
    pub sweep: f64,
    pub end: Vector3<f64>,
}

impl Circle {
    /// The arc about the axis through `centre`; `None` where start and end are not on one circle. Where
    /// they are the same it is a full circle.
    pub fn about(centre: Vector3<f64>, axis: UnitVector3<f64>, start: Vector3<f64>, end: Vector3<f64>) -> Option<Self> {
        let across = |p: Vector3<f64>| (p - centre) - axis.as_ref() * axis.dot(&(p - centre));
        let (from, to) = (across(start), across(end));
        if from.norm() > FARTHEST {
            return None;
        }
        if (from.norm() - to.norm()).abs() > ROUNDED.max(1e-4 * from.norm()) || from.norm() < ROUNDED {
            return None;
        }
        let angle = axis.cross(&from).dot(&to).atan2(from.dot(&to));
        // What is left of a full turn by rounding is one.
        let is_closed = (to - from).norm() < 1e-9;
        let sweep = if is_closed { TAU } else { angle.rem_euclid(TAU) };
        Some(Circle { centre: centre + axis.as_ref() * axis.dot(&(start - centre)), axis, start, sweep, end })
    }

    /// The same with so many more whole turns.
    pub fn with_turns(self, turns: f64) -> Self {
        Circle { sweep: self.sweep + TAU * turns, ..self }
    }

    /// The arc from `start` through `via` to `end`; `None` where they lie on a line.
    pub fn through(start: Vector3<f64>, via: Vector3<f64>, end: Vector3<f64>) -> Option<Self> {
        let (a, b) = (via - start, end - start);
        let normal = a.cross(&b);
        let axis = UnitVector3::try_new(normal, 1e-12)?;
        let centre =
            (normal.cross(&a) * b.norm_squared() + b.cross(&normal) * a.norm_squared()) / (2.0 * normal.norm_squared());
        Circle::about(start + centre, axis, start, end)
    }

    /// The arc from `start` to where it meets the plane `normal · p = offset` for the `count`th time; `None`
    /// where it does not.
    pub fn until(
        centre: Vector3<f64>,
        axis: UnitVector3<f64>,
        start: Vector3<f64>,
        (normal, offset): (Vector3<f64>, f64),
        count: usize,
    ) -> Option<Self> {
        let centre = centre + axis.as_ref() * axis.dot(&(start - centre));
        let spoke = start - centre;
        let (ahead, aside) = (normal.dot(&spoke), normal.dot(&axis.cross(&spoke)));
        let away = (offset - normal.dot(&centre)) / ahead.hypot(aside);
        if spoke.norm() < ROUNDED || away.is_nan() || away.abs() > 1.0 {
            return None;
        }
        let (middle, half) = (aside.atan2(ahead), away.acos());
        let here = FULL_TURN_DISTANCE / spoke.norm();
        let mut met = [middle - half, middle + half].map(|angle| match angle.rem_euclid(TAU) {
            angle if angle < here || angle > TAU - here => TAU,
            angle => angle,
        });
        met.sort_by(f64::total_cmp);
        let sweep = *met.get(count.checked_sub(1)?)?;
        let end = Rotation3::from_axis_angle(&axis, sweep) * spoke + centre;
        Some(Circle { centre, axis, start, sweep, end })
    }

    /// Directions at its start and at its end, without its rise.
    pub fn tangents(&self) -> [Vector3<f64>; 2] {
        [self.start, self.end].map(|point| self.axis.cross(&(point - self.centre)).normalize())
    }

    /// How far it departs from the straight line between its ends \[m\], seen along the axis.
    pub fn rise(&self) -> f64 {
        (self.start - self.centre).norm() * (1.0 - (0.5 * self.sweep).cos())
    }

    /// Its length \[m\].
    pub fn length(&self) -> f64 {
        let rise = self.axis.dot(&(self.end - self.start));
        (self.sweep * (self.start - self.centre).norm()).hypot(rise)
    }

    /// Share of the arc at which it passes nearest to `point`.
    pub fn share_at(&self, point: Vector3<f64>) -> f64 {
        let (from, to) = (self.start - self.centre, point - self.centre);
        let angle = self.axis.cross(&from).dot(&to).atan2(from.dot(&to));
        angle.rem_euclid(TAU) / self.sweep
    }

    /// Points on it with their shares, the last one its end: chords stay within [`TOLERANCE`].
    pub fn points(&self) -> impl Iterator<Item = (f64, Vector3<f64>)> {
        let spoke = self.start - self.centre;
        let widest = 2.0 * (1.0 - TOLERANCE / spoke.norm()).clamp(-1.0, 1.0).acos();
        let count = (self.sweep / widest).ceil().max(1.0) as usize;
        // From the circle through the start to the end, which may be rounded and higher.
        let turned = move |share: f64| Rotation3::from_axis_angle(&self.axis, share * self.sweep) * spoke + self.centre;
        let off = self.end - turned(1.0);
        (1..=count).map(move |k| {
            let share = k as f64 / count as f64;
            let point = if k == count { self.end } else { turned(share) + off * share };
            (share, point)
        })
    }
}
